//! Which files are ours: each says so itself, so that nothing else is ever replaced.

use std::io::Cursor;

/// Name and version of this program, as it is written into files.
pub(crate) const TOOL: &str = concat!("fissure ", env!("CARGO_PKG_VERSION"));
/// How that begins, whatever the version.
const BEGINNING: &str = "fissure ";

/// What a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A picture as PNG.
    Png,
    /// An animation as GIF.
    Gif,
    /// A page as HTML.
    Html,
}

/// Whether the bytes of a file say that Fissure wrote it. A file that is empty or of zeros counts, which a power cut
/// leaves of a picture: there is nothing to lose.
pub fn is_ours(kind: Kind, bytes: &[u8]) -> bool {
    let says_so = match kind {
        Kind::Png => png_software(bytes).is_some_and(|software| software.starts_with(BEGINNING)),
        Kind::Gif => gif_begins_with_comment(bytes),
        Kind::Html => html_generator(bytes),
    };
    says_so || bytes.iter().all(|&byte| byte == 0)
}

/// The text `Software` of a PNG file.
fn png_software(bytes: &[u8]) -> Option<String> {
    let reader = png::Decoder::new(Cursor::new(bytes)).read_info().ok()?;
    let texts = &reader.info().uncompressed_latin1_text;
    texts.iter().find(|text| text.keyword == "Software").map(|text| text.text.clone())
}

/// Whether the first block of a GIF file is a comment of ours.
fn gif_begins_with_comment(bytes: &[u8]) -> bool {
    // Signature and screen take 13 bytes; the eleventh says how long a table of colours follows (GIF89a, 18).
    let Some((screen, rest)) = bytes.split_first_chunk::<13>() else { return false };
    let colors = if screen[10] & 0x80 == 0 { 0 } else { 3 << ((screen[10] & 7) + 1) };
    // Then the mark of an extension, that of a comment, and a length.
    let comment = rest.get(colors..).and_then(|rest| rest.strip_prefix(&[0x21, 0xfe]));
    let text = comment.and_then(|rest| rest.get(1..));
    screen.starts_with(b"GIF89a") && text.is_some_and(|text| text.starts_with(BEGINNING.as_bytes()))
}

/// Whether the first lines of a page name this program as what made it.
fn html_generator(bytes: &[u8]) -> bool {
    let mut lines = bytes.split(|&byte| byte == b'\n').take(8);
    let mark = format!("<meta name=\"generator\" content=\"{BEGINNING}");
    lines.any(|line| line.starts_with(mark.as_bytes()))
}
