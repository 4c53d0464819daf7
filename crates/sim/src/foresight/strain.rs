//! Materials that are too soft for what acts on them.

use super::samples::{Samples, two_digits};
use super::width::width;
use crate::formulation::impact_speed;
use crate::material::elastic::Elastic;
use fissure_scene::{BoxSide, KeyPath, Load, LoadKind, Scene, Selection, Vector, Warning, material_preset};

/// Strain from which on a load is a slip of the pen, or the modulus is: what cracks breaks long before.
const MOST_STRAIN: f64 = 0.1;
/// The same for impacts, as speed over wave speed: jelly that falls from high up has a few.
const MOST_IMPACT: f64 = 10.0;

/// Loads that strain a material by more than a tenth, and impacts at many times its wave speed.
pub(super) fn soft_materials(scene: &Scene, elastic: &[Elastic]) -> Vec<Warning> {
    let mut found = Vec::new();
    let strained = scene.loads.iter().enumerate().filter_map(|(index, load)| {
        let (material, stress) = nominal_stress(scene, elastic, load)?;
        Some((index, material, stress, stress / elastic[material].effective_modulus))
    });
    // The first of several that strain alike.
    let worst = strained.reduce(|a, b| if b.3 > a.3 { b } else { a });
    if let Some((index, material, stress, strain)) = worst.filter(|s| s.3 > MOST_STRAIN) {
        let m = &scene.materials[material];
        let fits = two_digits(stress / MOST_STRAIN, f64::ceil);
        let message = format!(
            "load {} makes stresses of about {stress:.1e} Pa, which strain `{}` (Young's modulus {:e} Pa) by {strain:.1e}, more than {MOST_STRAIN}",
            index + 1,
            m.name,
            m.young_modulus
        );
        let weaker = two_digits(MOST_STRAIN / strain, f64::floor);
        let remedy = format!(
            "multiply the load by {weaker} or less, or use a material with a modulus of {fits:e} Pa or more (1 GPa is 1e9)"
        );
        // Who makes a material of their own may have missed the unit; otherwise it is the load.
        let own = material_preset(&m.name).is_none_or(|preset| preset.young_modulus != m.young_modulus);
        let path =
            if own { KeyPath::item("material", material).then("young_modulus") } else { KeyPath::item("load", index) };
        found.push(Warning::new(path, message, remedy));
    }
    let speed = impact_speed(scene);
    let slowest = scene
        .bodies
        .iter()
        .map(|b| b.material)
        .min_by(|&a, &b| elastic[a].dilatational_wave_speed().total_cmp(&elastic[b].dilatational_wave_speed()));
    if let Some(material) = slowest.filter(|&m| speed > MOST_IMPACT * elastic[m].dilatational_wave_speed()) {
        let (m, c) = (&scene.materials[material], elastic[material].dilatational_wave_speed());
        let message = format!(
            "things meet or are moved at up to {speed:.3} m/s, {:.1e} times the speed of waves in `{}` ({c:.3} m/s, Young's modulus {:e} Pa)",
            speed / c,
            m.name,
            m.young_modulus
        );
        let fits = two_digits(m.young_modulus * (speed / c).powi(2), f64::ceil);
        let remedy = format!("a modulus above {fits:e} Pa has faster waves (1 GPa is 1e9), or let things move slower");
        found.push(Warning::new(KeyPath::item("material", material).then("young_modulus"), message, remedy));
    }
    found
}

/// The cause of a run that fails because loads or impacts are far too much for its materials, and what to do.
pub(crate) fn overload(scene: &Scene, elastic: &[Elastic]) -> Option<String> {
    let Warning { message, remedy, .. } = soft_materials(scene, elastic).into_iter().next()?;
    Some(format!("{message}; {remedy}"))
}

/// Stress that a load makes in what it acts on [Pa], and the softest material there; force over the length it is spread
/// along.
fn nominal_stress(scene: &Scene, elastic: &[Elastic], load: &Load) -> Option<(usize, f64)> {
    let body = match &load.selection {
        Selection::Bodies(bodies) | Selection::Edge { bodies: Some(bodies), .. } => *bodies.first()?,
        _ if scene.bodies.len() == 1 => 0,
        _ => {
            let alone = Scene { loads: vec![load.clone()], supports: Vec::new(), ..scene.clone() };
            Samples::of(&alone)?.loads.first()?.first()?.body
        }
    };
    let region = &scene.bodies[body].region;
    let (low, high) = region.bounds();
    let factor = greatest_factor(load, scene.frames.time(scene.frames.last));
    let along_y = |force: Vector| match load.selection {
        Selection::Edge { side, .. } => matches!(side, BoxSide::Left | BoxSide::Right),
        _ => force.x.abs() > force.y.abs(),
    };
    let across = |force: Vector| if along_y(force) { high.y - low.y } else { high.x - low.x };
    let stress = match &load.kind {
        LoadKind::Traction(t) => t.norm(),
        LoadKind::Pressure(p) | LoadKind::FacePressure(_, p) => p.abs(),
        LoadKind::Force(f) => f.norm() / across(*f),
        LoadKind::PerPoint(forces) => {
            let total: Vector = forces.iter().map(|f| f.1).sum();
            total.norm() / across(total).max(width(region))
        }
    };
    let parts = scene.bodies[body].inclusions.iter().map(|i| i.material).chain([scene.bodies[body].material]);
    let softest = parts.min_by(|&a, &b| elastic[a].young_modulus.total_cmp(&elastic[b].young_modulus))?;
    Some((softest, stress * factor))
}

/// The greatest factor of a load's curve until `end` [s].
fn greatest_factor(load: &Load, end: f64) -> f64 {
    let times = load.curve.points.iter().map(|p| p.0.clamp(0.0, end)).chain([0.0, end]);
    times.map(|time| load.curve.value(time).abs()).fold(0.0, f64::max)
}
