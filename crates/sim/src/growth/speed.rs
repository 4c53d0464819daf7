//! How fast a tip may run.

use crate::crack::Crack;
use crate::material::elastic::Elastic;
use fissure_scene::{End, Scene};

/// Highest speed of a tip at `time` [m/s]: the scene's fraction of the Rayleigh wave speed of the material at the tip, or the material's own limit.
pub(crate) fn speed_limit(crack: &Crack, end: End, scene: &Scene, elastic: &[Elastic], time: f64) -> f64 {
    let material = scene.bodies[crack.body as usize].material_at(crack.tip_position(end));
    let growth = &scene.growth;
    let directed = growth.speed_limit * growth.speed_curve.value(time) * elastic[material].rayleigh_wave_speed();
    scene.materials[material].limiting_speed.map_or(directed, |own| directed.min(own))
}
