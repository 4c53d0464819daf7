//! Cracks that are too fast for the frames.

use super::drawn_tip::DrawnTip;
use super::samples::two_digits;
use crate::material::elastic::Elastic;
use fissure_scene::{KeyPath, Scene, Vector, Warning};

/// Frames a crack should be seen to run in, at least.
const FEWEST_FRAMES: f64 = 3.0;
/// Frames that show it well.
const GOOD_FRAMES: f64 = 12.0;

/// That all cracks may be through within three frames. Only where loads or impacts drive them: what is moved slowly
/// opens cracks slowly.
pub(super) fn crosses_at_once(scene: &Scene, elastic: &[Elastic]) -> Option<Warning> {
    let falls = scene.gravity != Vector::zeros() && !scene.colliders.is_empty();
    let flies = scene.bodies.iter().any(|b| !b.velocities.is_empty());
    if !scene.growth.enabled || (scene.loads.is_empty() && !falls && !flies) {
        return None;
    }
    let tips = DrawnTip::all(scene).filter(|tip| !tip.is_scheduled());
    let crossings = tips.map(|tip| (tip, tip.way(scene), tip.speed_limit(scene, elastic)));
    let slowest = crossings.filter(|c| c.1.is_finite() && c.2 > 0.0).max_by(|a, b| (a.1 / a.2).total_cmp(&(b.1 / b.2)));
    let (tip, way, speed) = slowest?;
    let time = way / speed;
    let frames = time * scene.frames.rate;
    if frames >= FEWEST_FRAMES {
        return None;
    }
    let message = format!(
        "at up to {speed:.3e} m/s crack `{}` can cross the {way:.3e} m ahead of it within {frames:.2} frames at {} frames per second",
        tip.crack.name, scene.frames.rate
    );
    let limit = scene.growth.speed_limit * frames / FEWEST_FRAMES;
    let remedy = format!(
        "set `frames.rate` to {} to see it run for {GOOD_FRAMES} frames, or `growth.speed_limit` to {} or less",
        two_digits(GOOD_FRAMES / time, f64::ceil),
        two_digits(limit, f64::floor)
    );
    Some(Warning::new(KeyPath::setting("frames", "rate"), message, remedy))
}
