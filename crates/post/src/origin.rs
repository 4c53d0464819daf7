//! Which files are ours: each says so itself, so that nothing else is ever replaced or removed.

use fissure_scene::Format;
use serde::Deserialize;

/// How [`crate::Provenance::tool`] begins, whatever the version.
pub(crate) const TOOL: &str = "fissure ";

/// Whether the bytes of a mesh file say that Fissure wrote them. A file that is empty or of zeros counts, which a power
/// cut leaves of a mesh: there is nothing to lose.
pub(crate) fn is_ours(format: Format, bytes: &[u8]) -> bool {
    let says_so = match format {
        Format::Glb => glb_generator(bytes).is_some_and(|generator| generator.starts_with(TOOL)),
        Format::Ply => ply_comments(bytes).any(|comment| comment.starts_with(TOOL.as_bytes())),
    };
    says_so || bytes.iter().all(|&byte| byte == 0)
}

/// `asset.generator` of a binary glTF file: magic, version, length; then length, type and text of the JSON chunk.
fn glb_generator(bytes: &[u8]) -> Option<String> {
    #[derive(Deserialize)]
    struct Document {
        asset: Asset,
    }
    #[derive(Deserialize)]
    struct Asset {
        generator: String,
    }
    let (head, rest) = bytes.split_first_chunk::<12>()?;
    let (length, rest) = rest.split_first_chunk::<4>()?;
    let text = rest.strip_prefix(b"JSON")?.get(..u32::from_le_bytes(*length) as usize)?;
    let document: Document = serde_json::from_slice(text).ok()?;
    head.starts_with(b"glTF").then_some(document.asset.generator)
}

/// The comments in the header of a PLY file.
fn ply_comments(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    let lines = bytes.split(|&byte| byte == b'\n').take_while(|line| *line != b"end_header");
    let is_ply = bytes.starts_with(b"ply\n");
    lines.filter_map(move |line| line.strip_prefix(b"comment ").filter(|_| is_ply))
}
