//! Scenes in which nothing happens.

use fissure_scene::{KeyPath, LoadKind, Scene, Vector, Warning};

/// That nothing loads the bodies: no force, no gravity, no speed at the start, nothing that moves.
pub(super) fn nothing_loads(scene: &Scene) -> Option<Warning> {
    let acts = |curve: &fissure_scene::Curve| curve.points.is_empty() || curve.points.iter().any(|p| p.1 != 0.0);
    let is_force = |kind: &LoadKind| match kind {
        LoadKind::Force(f) | LoadKind::Traction(f) => *f != Vector::zeros(),
        LoadKind::Pressure(p) | LoadKind::FacePressure(_, p) => *p != 0.0,
        LoadKind::PerPoint(forces) => forces.iter().any(|f| f.1 != Vector::zeros()),
    };
    let forced = scene.loads.iter().any(|load| acts(&load.curve) && is_force(&load.kind));
    let falls = scene.gravity != Vector::zeros();
    let flies = scene
        .bodies
        .iter()
        .flat_map(|b| &b.velocities)
        .any(|v| v.velocity != Vector::zeros() || v.angular_velocity != 0.0);
    let pulled = scene.supports.iter().any(|s| acts(&s.curve) && s.velocity.iter().flatten().any(|&v| v != 0.0));
    let pushed = scene.colliders.iter().any(|c| c.keyframes.windows(2).any(|w| w[0].1 != w[1].1));
    let scheduled = scene
        .cracks
        .iter()
        .any(|c| [&c.start_guide, &c.end_guide].into_iter().flatten().any(|g| !g.schedule.points.is_empty()));
    if forced || falls || flies || pulled || pushed || scheduled {
        return None;
    }
    let (array, message) = match (scene.loads.is_empty(), scene.supports.is_empty()) {
        (false, _) => ("load", "nothing loads the scene: its forces are 0, and nothing moves or falls"),
        (true, false) => (
            "support",
            "nothing loads the scene: its supports hold still, there is no load, and nothing moves or falls",
        ),
        (true, true) => (
            "body",
            "nothing loads the scene: there is no load, no gravity, no moving support or collider, and no speed at the start",
        ),
    };
    let remedy = "add a `[[load]]`, `gravity`, a support or collider that moves, or a velocity";
    Some(Warning::new(KeyPath::item(array, 0), message, remedy))
}
