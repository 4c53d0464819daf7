//! What the text of a drawing grows to when it is parsed, told before it is parsed.

use super::limits::{Excess, MOST_ATTRIBUTES, MOST_ENTITY_BYTES};
use std::collections::HashMap;

/// Entities inside each other; the parser refuses more.
const DEEPEST: usize = 10;

/// Checks that entities stay small and that no tag has too many attributes.
pub(super) fn check_text(text: &str) -> Result<(), Excess> {
    let declared = declarations(text);
    let mut sizes = HashMap::new();
    let mut total = 0_u64;
    for (at, name) in references(text) {
        total = total.saturating_add(expanded_size(name, &declared, &mut sizes, 0));
        if total > MOST_ENTITY_BYTES {
            let message = format!(
                "the entities of the drawing grow to more than {MOST_ENTITY_BYTES} bytes, here with `&{name};`"
            );
            return Err(Excess::new(at..at + name.len() + 2, message));
        }
    }
    check_tags(text)
}

/// The values of `<!ENTITY name "value">`; the first declaration of a name counts.
fn declarations(text: &str) -> HashMap<&str, &str> {
    let mut declared = HashMap::new();
    for part in text.split("<!ENTITY").skip(1) {
        let part = part.trim_start();
        let Some((name, rest)) = part.split_once(|c: char| c.is_ascii_whitespace()) else { continue };
        let rest = rest.trim_start();
        let Some(quote) = rest.chars().next().filter(|c| ['"', '\''].contains(c)) else { continue };
        if let Some(value) = rest[1..].split(quote).next() {
            declared.entry(name).or_insert(value);
        }
    }
    declared
}

/// All `&name;` with where they are.
fn references(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.match_indices('&').filter_map(|(at, _)| {
        let name = text[at + 1..].split(';').next()?;
        (!name.starts_with('#') && name.len() < 256).then_some((at, name))
    })
}

/// Bytes that `&name;` becomes; what is deeper than the parser goes counts as endless.
fn expanded_size<'t>(
    name: &'t str,
    declared: &HashMap<&'t str, &'t str>,
    sizes: &mut HashMap<&'t str, u64>,
    depth: usize,
) -> u64 {
    if let Some(&size) = sizes.get(name) {
        return size;
    }
    let Some(&value) = declared.get(name) else { return 0 };
    if depth > DEEPEST || value.matches('=').count() > MOST_ATTRIBUTES {
        return u64::MAX;
    }
    let inner = references(value).map(|(_, name)| expanded_size(name, declared, sizes, depth + 1));
    let size = inner.collect::<Vec<_>>().into_iter().fold(value.len() as u64, u64::saturating_add);
    sizes.insert(name, size);
    size
}

/// Checks how many attributes the tags have: the parser compares them with each other, which takes the square of their
/// number.
fn check_tags(text: &str) -> Result<(), Excess> {
    let mut at = 0;
    while let Some(start) = text[at..].find('<').map(|i| at + i) {
        let tag = &text[start..];
        let end_of = |mark: &str| tag.find(mark).map_or(text.len(), |i| start + i + mark.len());
        at = if tag.starts_with("<!--") {
            end_of("-->")
        } else if tag.starts_with("<![CDATA[") {
            end_of("]]>")
        } else if tag.starts_with("<?") {
            end_of("?>")
        } else {
            let (values, length) = values_in_tag(tag);
            if values > MOST_ATTRIBUTES {
                let message = format!("an element has more than {MOST_ATTRIBUTES} attributes");
                return Err(Excess::new(start..start + 1, message));
            }
            start + length
        };
    }
    Ok(())
}

/// How many quoted values a tag has, and its length in bytes.
fn values_in_tag(tag: &str) -> (usize, usize) {
    let mut quote: Option<u8> = None;
    let mut values = 0;
    for (at, byte) in tag.bytes().enumerate().skip(1) {
        match (byte, quote) {
            (_, Some(open)) if byte == open => quote = None,
            (_, Some(_)) => {}
            (b'>' | b'<', None) => return (values, at),
            (b'"' | b'\'', None) => (quote, values) = (Some(byte), values + 1),
            _ => {}
        }
    }
    (values, tag.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_follow_entities_into_entities() {
        let text = r#"<!DOCTYPE svg [<!ENTITY a "12345"><!ENTITY b '&a;&a;-'>]><svg>&b;&a;&#65;</svg>"#;
        let mut sizes = HashMap::new();
        // The text of the references themselves is counted as well.
        assert_eq!(expanded_size("b", &declarations(text), &mut sizes, 0), 7 + 2 * 5);
        assert_eq!(references(text).map(|(_, name)| name).collect::<Vec<_>>(), ["a", "a", "b", "a"]);
    }

    #[test]
    fn quotes_and_comments_do_not_confuse_the_count() {
        assert_eq!(values_in_tag("<a b='>\"' c=\"'\"> d='1'"), (2, 15));
        let many = (0..=MOST_ATTRIBUTES).map(|i| format!(" a{i}=''")).collect::<String>();
        assert!(check_tags(&format!("<!-- it's --><svg{many}/>")).is_err());
        assert!(check_tags(&format!("<svg><!-- <g{many}/> --></svg>")).is_ok());
    }
}
