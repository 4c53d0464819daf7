//! JSON objects that carry their own checksum, as their last key: one flipped bit anywhere in the text is noticed.

use sha2::{Digest, Sha256};

/// How the object is laid out.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    /// Between the last other value and the checksum.
    before: &'static str,
    /// After the checksum.
    after: &'static str,
}

/// On one line.
pub(super) const LINE: Layout = Layout { before: ",\"check\":\"", after: "\"}\n" };
/// One key per line.
pub(super) const PAGE: Layout = Layout { before: ",\n  \"check\": \"", after: "\"\n}\n" };

/// Digits of a checksum.
const DIGITS: usize = 64;

/// SHA-256 in hexadecimal.
pub(super) fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

impl Layout {
    /// A JSON object that has at least one key, with its checksum.
    pub(super) fn seal(self, object: &str) -> String {
        let body = object.trim_end().strip_suffix('}').unwrap_or(object).trim_end();
        format!("{body}{}{}{}", self.before, sha256(body.as_bytes()), self.after)
    }

    /// Whether `text` is an object with its checksum, to the last byte.
    pub(super) fn holds(self, text: &str) -> bool {
        let Some(rest) = text.strip_suffix(self.after) else { return false };
        let Some(at) = rest.len().checked_sub(DIGITS) else { return false };
        let Some((head, check)) = rest.split_at_checked(at) else { return false };
        head.strip_suffix(self.before).is_some_and(|body| sha256(body.as_bytes()) == check)
    }

    /// Whether `text` may be the beginning of a sealed object that was not written to its end, rather than a whole one
    /// that has been changed.
    pub(super) fn is_torn(self, text: &[u8]) -> bool {
        let before = self.before.as_bytes();
        let seal = text.windows(before.len()).rposition(|window| window == before);
        // Where the length of a file arrived on the disk and its content did not, there are zeros.
        let written = text.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
        seal.is_none_or(|at| written < at + before.len() + DIGITS + self.after.len() - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_flipped_bit_shows_and_every_cut() {
        for (layout, object) in [(LINE, r#"{"a":1,"b":{"c":[2]}}"#), (PAGE, "{\n  \"a\": 1,\n  \"b\": {\n  }\n}")] {
            let sealed = layout.seal(object);
            assert!(layout.holds(&sealed), "{sealed}");
            assert!(serde_json::from_str::<serde_json::Value>(&sealed).is_ok_and(|value| value["a"] == 1));
            for bit in 0..8 * sealed.len() {
                let mut bytes = sealed.clone().into_bytes();
                bytes[bit / 8] ^= 1 << (bit % 8);
                assert!(!std::str::from_utf8(&bytes).is_ok_and(|text| layout.holds(text)), "bit {bit}");
            }
            for cut in 0..sealed.len() {
                assert!(!layout.holds(&sealed[..cut]));
                assert_eq!(layout.is_torn(&sealed.as_bytes()[..cut]), cut + 1 < sealed.len(), "{cut}");
            }
        }
    }
}
