//! File formats: each one is a file here that implements [`FileFormat`], and has one arm in [`file_format`].

mod error;
mod glb;
#[cfg(feature = "files")]
mod origin;
mod ply;

pub use error::FormatError;
pub use glb::to_glb;
#[cfg(feature = "files")]
pub(crate) use origin::{TOOL, is_ours};
pub use ply::to_ply;

use crate::mesh::Mesh;
use crate::provenance::Provenance;
use fissure_scene::{Format, Part, UpAxis};

/// One part of one frame, to be written.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shot<'a> {
    /// Its objects; may be none.
    pub(crate) objects: &'a [Mesh],
    /// Where they come from.
    pub(crate) provenance: &'a Provenance,
    /// Up axis, where the format does not fix it.
    pub(crate) up: UpAxis,
}

/// What a file format can do. All of it works in memory: files are made by `write`.
pub(crate) trait FileFormat: Sync {
    /// Extension of the files of a part, without its dot.
    fn extension(&self, part: Part) -> &'static str;

    /// The bytes of the file of one part of one frame. A part without objects gives a valid file without objects: no
    /// sequence has gaps.
    ///
    /// # Errors
    /// When the format cannot hold it.
    fn frame(&self, shot: &Shot<'_>) -> Result<Vec<u8>, FormatError>;

    /// What the bytes of a file of this format name as their maker; none where they name nobody.
    #[cfg(feature = "files")]
    fn maker(&self, bytes: &[u8]) -> Option<String>;
}

/// What implements a format.
pub(crate) fn file_format(format: Format) -> &'static dyn FileFormat {
    match format {
        Format::Glb => &glb::BinaryGltf,
        Format::Ply => &ply::Polygons,
    }
}
