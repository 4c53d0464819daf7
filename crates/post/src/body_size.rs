//! How large bodies are: what lengths of meshes are told in parts of.

use fissure_scene::Scene;

/// The longer side of a body at rest [m].
pub(crate) fn body_size(scene: &Scene, body: u32) -> f64 {
    let (low, high) = scene.bodies[body as usize].region.bounds();
    (high - low).amax()
}
