//! Where files come from.

use fissure_scene::{Frame, Scene};

/// Where a file comes from; written into it.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Provenance {
    /// Name and version of this program.
    pub tool: String,
    /// Name of the scene.
    pub scene: String,
    /// Hash of the scene.
    pub scene_hash: String,
    /// Frame number.
    pub frame: i64,
    /// Time [s].
    pub time: f64,
}

impl Provenance {
    /// Of the meshes that this build makes of `frame`.
    pub(crate) fn new(scene: &Scene, frame: &Frame) -> Self {
        Self {
            tool: concat!("fissure ", env!("CARGO_PKG_VERSION")).to_owned(),
            scene: scene.name.clone(),
            scene_hash: scene.hash.clone(),
            frame: frame.number,
            time: frame.time,
        }
    }
}
