//! Which formulation a scene gets, and why.

use crate::SimulationError;
use crate::crack::cracks::Cracks;
use crate::material::elastic::Elastic;
use crate::particles::Particles;
use crate::solver::{Continuation, Solver};
use crate::total::Total;
use crate::updated::Updated;
use fissure_plane::bounds;
use fissure_scene::{Formulation, Kernel, LoadKind, Scene, updated_kernel};
use std::sync::Arc;

/// A formulation and the reason for it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Choice {
    pub(crate) formulation: Formulation,
    pub(crate) reason: String,
}

/// Expected strain above which small-strain scenes end. Glass, stone and hard plastics break at a hundredth of it or
/// less; the total Lagrangian formulation itself stays exact well beyond.
const SMALL_STRAIN: f64 = 0.1;

/// Chooses the formulation of `scene`.
pub(crate) fn choose(scene: &Scene, elastic: &[Elastic]) -> Choice {
    let chosen = |formulation, reason: String| Choice { formulation, reason };
    if scene.solver.formulation != Formulation::Auto {
        return chosen(scene.solver.formulation, "asked for by the scene".into());
    }
    if let Some(m) = scene.materials.iter().find(|m| m.plasticity.is_some()) {
        return chosen(Formulation::Updated, format!("material `{}` flows plastically", m.name));
    }
    let strain = expected_strain(scene, elastic);
    if strain > SMALL_STRAIN {
        return chosen(
            Formulation::Updated,
            format!("strains of about {strain:.1e} are expected, more than {SMALL_STRAIN}"),
        );
    }
    let strains =
        if strain > 0.0 { format!("strains of about {strain:.1e} are") } else { "no strains to speak of are".into() };
    chosen(Formulation::Total, format!("every material is elastic and {strains} expected"))
}

/// The scene with the kernel its formulation needs: a bilinear one, the choice where particles never move through the
/// grid, gives way to a smooth one where the updated formulation is used without the scene having asked for it.
pub(crate) fn settle(scene: &Scene, used: Formulation) -> Scene {
    let mut scene = scene.clone();
    let solver = &mut scene.solver;
    if solver.formulation != Formulation::Updated && used == Formulation::Updated && solver.kernel == Kernel::Bilinear {
        solver.kernel = updated_kernel();
    }
    scene
}

/// Strain that loads and impacts will cause, roughly: traction over modulus, speed over wave speed.
pub(crate) fn expected_strain(scene: &Scene, elastic: &[Elastic]) -> f64 {
    let softest = elastic.iter().map(|e| e.young_modulus).fold(f64::INFINITY, f64::min);
    let slowest = elastic.iter().map(Elastic::dilatational_wave_speed).fold(f64::INFINITY, f64::min);
    let mut size = 0.0_f64;
    for body in &scene.bodies {
        let (low, high) = body.region.bounds();
        size = size.max((high - low).norm());
    }
    let mut strain = 0.0_f64;
    for load in &scene.loads {
        let most = load.curve.points.iter().map(|p| p.1.abs()).fold(0.0, f64::max);
        let factor = if load.curve.points.is_empty() { 1.0 } else { most };
        let stress = match &load.kind {
            LoadKind::Traction(t) => t.norm(),
            LoadKind::Pressure(p) | LoadKind::FacePressure(_, p) => p.abs(),
            LoadKind::Force(f) => f.norm() / size,
            LoadKind::PerPoint(values) => values.iter().map(|v| v.1.norm()).sum::<f64>() / size,
        };
        strain = strain.max(stress * factor / softest);
    }
    strain.max(impact_speed(scene) / slowest)
}

/// Speed at which things are moved or can meet [m/s], roughly.
pub(crate) fn impact_speed(scene: &Scene) -> f64 {
    let mut speed = 0.0_f64;
    // Spinning alone strains little; what counts is the speed at which things can meet.
    for v in scene.bodies.iter().flat_map(|body| &body.velocities) {
        speed = speed.max(v.velocity.norm());
    }
    for support in &scene.supports {
        let most = support.curve.points.iter().map(|p| p.1.abs()).fold(0.0, f64::max);
        let factor = if support.curve.points.is_empty() { 1.0 } else { most };
        speed = speed.max(support.velocity.iter().flatten().fold(0.0_f64, |a, &v| a.max(v.abs())) * factor);
    }
    if !scene.colliders.is_empty() {
        for collider in &scene.colliders {
            for w in collider.keyframes.windows(2) {
                let interval = w[1].0 - w[0].0;
                if interval > 0.0 {
                    speed = speed.max((w[1].1.position - w[0].1.position).norm() / interval);
                }
            }
        }
        // What falls through the scene's own height. How long it is watched does not count: a run may be made longer.
        let g = scene.gravity.norm();
        let all: Vec<_> = scene.bodies.iter().flat_map(|b| b.region.exterior.iter().copied()).collect();
        let (low, high) = bounds(&all);
        speed += (2.0 * g * (high - low).norm()).sqrt();
    }
    speed
}

/// Builds the solver.
///
/// # Errors
/// When the scene cannot be laid out: see [`SimulationError`].
pub(crate) fn build(
    formulation: Formulation,
    scene: &Scene,
    particles: Arc<Particles>,
    cracks: &Cracks,
) -> Result<Box<dyn Solver>, SimulationError> {
    Ok(match formulation {
        Formulation::Updated => Box::new(Updated::new(scene, particles, cracks)?),
        _ => Box::new(Total::new(scene, particles, cracks)?),
    })
}

/// Goes on in the updated formulation with the state of a total one.
///
/// # Errors
/// As [`build`].
pub(crate) fn switch(
    scene: &Scene,
    particles: Arc<Particles>,
    cracks: &Cracks,
    continuation: Continuation,
) -> Result<Box<dyn Solver>, SimulationError> {
    Ok(Box::new(Updated::continued(scene, particles, cracks, continuation)?))
}

/// Builds the solver with a saved state.
///
/// # Errors
/// As [`build`], and when the state is not one of this scene.
pub(crate) fn restore(
    formulation: Formulation,
    scene: &Scene,
    particles: Arc<Particles>,
    cracks: &Cracks,
    state: &[u8],
) -> Result<Box<dyn Solver>, SimulationError> {
    Ok(match formulation {
        Formulation::Updated => Box::new(Updated::restore(scene, particles, cracks, state)?),
        _ => Box::new(Total::restore(scene, particles, cracks, state)?),
    })
}
