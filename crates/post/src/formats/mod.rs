//! File formats: each one is a file here that implements [`FileFormat`], and has one arm in [`file_format`].

mod error;
mod glb;
mod glb_rigid;
mod glb_sequence;
mod gltf_animation;
mod gltf_document;
mod numbers;
mod obj;
#[cfg(feature = "files")]
mod origin;
mod palette;
mod ply;
mod sequence_file;
mod svg;
mod usda;
mod vtk;

pub use error::FormatError;
#[cfg(feature = "files")]
pub(crate) use origin::{TOOL, is_ours};
pub use sequence_file::Sequence;

use crate::mesh::Mesh;
use crate::packed::Convention;
use crate::provenance::Provenance;
use fissure_scene::{Attribute, Format, Frame, Part, Scene, UpAxis};

/// One part of one frame, to be written.
#[derive(Debug, Clone, Copy)]
pub struct Shot<'a> {
    /// Which part.
    pub part: Part,
    /// Its objects; may be none.
    pub objects: &'a [Mesh],
    /// Where they come from.
    pub provenance: &'a Provenance,
    /// Up axis, where the format does not fix it.
    pub up: UpAxis,
    /// Thickness of solids [m].
    pub thickness: f64,
    /// What was simulated.
    pub scene: &'a Scene,
    /// What came out at this moment.
    pub frame: &'a Frame,
}

/// The bytes of the file of one part of one frame. A part without objects gives a valid file without objects: no
/// sequence has gaps. Of a format that makes one file of a whole sequence it is one of a single frame.
///
/// # Errors
/// When the format cannot hold it.
pub fn encode(format: Format, shot: &Shot<'_>) -> Result<Vec<u8>, FormatError> {
    file_format(format).frame(shot)
}

/// A file of the whole sequence of a part in the making; none for formats that have a file per frame.
pub fn sequence(format: Format) -> Option<Box<dyn Sequence>> {
    file_format(format).sequence()
}

impl Shot<'_> {
    /// `up` up, velocities per second of playback.
    pub(crate) fn played(&self, up: UpAxis) -> Convention {
        Convention { up, time_scale: self.scene.frames.time_scale() }
    }
}

/// The files that were written of a part in one format, one per frame.
#[derive(Debug, Clone, Copy)]
#[cfg(feature = "files")]
pub(crate) struct Listing<'a> {
    /// What was simulated.
    pub(crate) scene: &'a Scene,
    /// Name and version of this program.
    pub(crate) tool: &'a str,
    /// What the names of all files of the part begin with.
    pub(crate) name: &'a str,
    /// The files, by rising frame; at least one.
    pub(crate) records: &'a [&'a crate::record::FileRecord],
}

/// What a file format can do. All of it works in memory: files are made by `write`.
pub(crate) trait FileFormat: Sync {
    /// Extension of the files of a part, without its dot.
    #[cfg_attr(not(feature = "files"), allow(dead_code, reason = "only files have names"))]
    fn extension(&self, part: Part) -> &'static str;

    /// See [`encode`].
    fn frame(&self, shot: &Shot<'_>) -> Result<Vec<u8>, FormatError>;

    /// A file of the whole sequence to be made; none for formats that have a file per frame.
    fn sequence(&self) -> Option<Box<dyn Sequence>> {
        None
    }

    /// Files about the whole sequence that go with those of its frames, name and bytes: what they all refer to, or what
    /// plays them.
    #[cfg(feature = "files")]
    fn companions(&self, _listing: &Listing<'_>) -> Vec<(String, Vec<u8>)> {
        Vec::new()
    }

    /// What the bytes of a file of this format, of a frame or a companion, name as their maker; none where they name
    /// nobody.
    #[cfg(feature = "files")]
    fn maker(&self, bytes: &[u8]) -> Option<String>;
}

/// What implements a format.
pub(crate) fn file_format(format: Format) -> &'static dyn FileFormat {
    match format {
        Format::Glb => &glb::BinaryGltf,
        Format::Ply => &ply::Polygons,
        Format::Obj => &obj::WavefrontObj,
        Format::Usda => &usda::UsdText,
        Format::Vtk => &vtk::VtkXml,
        Format::Svg => &svg::Drawing,
        Format::GlbSequence => &glb_sequence::GltfSequence,
        Format::GlbRigid => &glb_rigid::RigidGltf,
    }
}

/// Whether any of some objects tells an attribute of its crack walls.
fn has(objects: &[Mesh], attribute: Attribute) -> bool {
    objects.iter().any(|mesh| mesh.attributes.contains(&attribute))
}

/// What the names of all files of a part begin with.
pub(crate) fn sequence_name(scene: &str, part: Part) -> String {
    let suffix = match part {
        Part::Cracked => "",
        Part::Body => "_body",
        Part::Faces => "_faces",
        Part::Collider => "_collider",
        Part::Particles => "_particles",
    };
    format!("{scene}{suffix}")
}

/// Where a file comes from, in one line: the program first, which is how our files are known.
fn origin_line(provenance: &Provenance) -> String {
    let Provenance { tool, scene, scene_hash, frame, time } = provenance;
    format!("{tool}, scene {scene} {scene_hash}, frame {frame}, time {time} s")
}

/// What follows `mark` in the first lines of a text file.
#[cfg(feature = "files")]
fn after_mark(bytes: &[u8], mark: &str) -> Option<String> {
    const HEAD: usize = 512;
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(HEAD)]).into_owned();
    let (_, after) = head.split_once(mark)?;
    after.lines().next().map(str::to_owned)
}
