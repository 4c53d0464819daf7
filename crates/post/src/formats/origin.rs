//! Which files are ours: each says so itself, so that nothing else is ever replaced or removed.

use super::file_format;
use fissure_scene::Format;

/// How [`crate::Provenance::tool`] begins, whatever the version.
pub(crate) const TOOL: &str = "fissure ";

/// Whether the bytes of a file say that Fissure wrote them. A file that is empty or of zeros counts, which a power
/// cut leaves of a mesh: there is nothing to lose.
pub(crate) fn is_ours(format: Format, bytes: &[u8]) -> bool {
    let says_so = file_format(format).maker(bytes).is_some_and(|maker| maker.starts_with(TOOL));
    says_so || bytes.iter().all(|&byte| byte == 0)
}
