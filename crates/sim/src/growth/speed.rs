//! How fast a tip may run.

use crate::crack::cracks::{Cracks, TipId};
use crate::material::elastic::Elastic;
use fissure_scene::Scene;

/// Highest speed of a tip at `time` [m/s]: the scene's fraction of the Rayleigh wave speed of the material at the tip,
/// or the material's own limit.
pub(crate) fn speed_limit(cracks: &Cracks, id: TipId, scene: &Scene, elastic: &[Elastic], time: f64) -> f64 {
    let material = scene.bodies[cracks.of(id).body as usize].material_at(cracks.position(id));
    let growth = &scene.growth;
    let directed = growth.speed_limit * growth.speed_curve.value(time) * elastic[material].rayleigh_wave_speed();
    scene.materials[material].limiting_speed.map_or(directed, |own| directed.min(own))
}
