//! Numbers in text files.

use std::fmt::{Display, Write};

/// Adds `values` with `between` between them. Numbers have as many digits as it takes to read the same one again.
pub(super) fn join<T: Display>(text: &mut String, values: impl IntoIterator<Item = T>, between: &str) {
    for (i, value) in values.into_iter().enumerate() {
        let between = if i == 0 { "" } else { between };
        // Writing into a string cannot fail.
        let _ = write!(text, "{between}{value}");
    }
}

/// Adds tuples, `(1, 2, 3), (4, 5, 6)`.
pub(super) fn join_tuples<T: Display, const N: usize>(text: &mut String, tuples: impl IntoIterator<Item = [T; N]>) {
    for (i, tuple) in tuples.into_iter().enumerate() {
        text.push_str(if i == 0 { "(" } else { ", (" });
        join(text, tuple, ", ");
        text.push(')');
    }
}

/// `text` as it may stand in XML, in an attribute or between tags.
pub(super) fn xml(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            c => escaped.push(c),
        }
    }
    escaped
}

/// `text` as it may stand in an XML comment, which must not hold two dashes or end with one.
pub(super) fn xml_comment(text: &str) -> String {
    format!("<!-- {} -->", text.replace("--", "- -"))
}
