//! Binary glTF 2.0, a file per frame.

use super::gltf_document::Document;
#[cfg(feature = "files")]
use super::gltf_document::made_by;
use super::{FileFormat, FormatError, Shot};
use fissure_scene::Part;

/// Binary glTF: y up, one node per mesh, one primitive per material slot.
///
/// Attributes: `POSITION`, `NORMAL`, `TEXCOORD_0` and `_VELOCITY` [m per second of playback]; points have no normals
/// and texture coordinates. What a whole object has in common, its `piece`, is in the extras of its node. Materials:
/// `outside` and `inside`, those that are used. `asset.extras` says where the file comes from. No meshes give a scene
/// with one node without a mesh.
pub(crate) struct BinaryGltf;

impl FileFormat for BinaryGltf {
    fn extension(&self, _: Part) -> &'static str {
        "glb"
    }

    fn frame(&self, shot: &Shot<'_>) -> Result<Vec<u8>, FormatError> {
        let mut document = Document::new(shot.scene.frames.time_scale());
        let mut nodes = Vec::new();
        for mesh in shot.objects {
            nodes.extend(document.node(mesh)?);
        }
        document.finish(nodes, shot.provenance, shot.provenance)
    }

    #[cfg(feature = "files")]
    fn maker(&self, bytes: &[u8]) -> Option<String> {
        made_by(bytes)
    }
}
