//! Loads as forces at places of the material.

use crate::SimulationError;
use crate::boundary::selector::Selector;
use crate::grid::coverage::cuts;
use crate::particles::Particles;
use fissure_scene::{Load, LoadKind, OutlineStretch, Point, Scene, Selection, Vector};

/// Where a force acts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ForcePlace {
    /// On a particle.
    Particle(u32),
    /// On the outline of a body.
    Outline {
        /// The body.
        body: u32,
        /// At rest [m].
        place: Point,
    },
}

/// A force at a place of the material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PointForce {
    pub(crate) place: ForcePlace,
    /// At a curve factor of 1 [N/m].
    pub(crate) force: Vector,
}

/// The forces that make up load number `index` of `scene`; none of a pressure, else never empty.
///
/// # Errors
/// When it selects nothing.
pub(crate) fn forces_of_load(
    scene: &Scene,
    particles: &Particles,
    index: usize,
) -> Result<Vec<PointForce>, SimulationError> {
    let load: &Load = &scene.loads[index];
    let forces = match &load.kind {
        LoadKind::Force(total) => by_volume(scene, particles, &load.selection, *total),
        LoadKind::Traction(traction) => along_outlines(scene, particles.anchor, &load.selection, *traction),
        LoadKind::PerPoint(values) => values
            .iter()
            .filter_map(|&(place, force)| Some((nearest(particles, 0..particles.len() as u32, place)?, force)))
            .map(|(particle, force)| PointForce { place: ForcePlace::Particle(particle), force })
            .collect(),
        LoadKind::Pressure(_) | LoadKind::FacePressure(..) => return Ok(Vec::new()),
    };
    if forces.is_empty() {
        return Err(particles.no_particle("load", index, &load.selection).into());
    }
    Ok(forces)
}

/// A total force on the selected particles, shared out by their volumes.
fn by_volume(scene: &Scene, particles: &Particles, selection: &Selection, total: Vector) -> Vec<PointForce> {
    let selected = particles.select(scene, selection);
    let volume: f64 = selected.iter().map(|&p| particles.volume[p as usize]).sum();
    let force = |p: u32| total * (particles.volume[p as usize] / volume);
    selected.into_iter().map(|p| PointForce { place: ForcePlace::Particle(p), force: force(p) }).collect()
}

/// A traction on the selected pieces of the outlines, by their length: two forces in each cell that an edge passes
/// through, where Gauss' rule has them, so that every node gets the exact load of its hat.
fn along_outlines(scene: &Scene, anchor: Point, selection: &Selection, traction: Vector) -> Vec<PointForce> {
    let mut forces = Vec::new();
    for OutlineStretch { body, from, to } in Selector::new(scene, selection).pieces(scene) {
        let [a, b] = [from, to].map(|p| (p - anchor) / scene.cell_size);
        for cut in cuts(a, b).windows(2) {
            let (middle, half) = (0.5 * (cut[0] + cut[1]), 0.5 * (cut[1] - cut[0]));
            let force = traction * ((to - from).norm() * half);
            let at = |t: f64| ForcePlace::Outline { body: body as u32, place: from + (to - from) * t };
            let off = half / 3.0_f64.sqrt();
            forces.extend([middle - off, middle + off].map(|t| PointForce { place: at(t), force }));
        }
    }
    forces
}

/// The particle of `among` that is nearest to `place` at rest [m]; of several the first.
pub(crate) fn nearest(particles: &Particles, among: impl Iterator<Item = u32>, place: Point) -> Option<u32> {
    let distance = |&p: &u32| (particles.rest[p as usize] - place).norm_squared();
    among.min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::test_scenes::{always, free_body, rectangle};
    use fissure_scene::BoxSide;

    /// Truth: force and moment of the load as the scene says it, on a square of 1.3 m whose edge is no multiple of the
    /// spacing.
    #[test]
    fn forces_add_up_to_their_load() {
        let mut scene = free_body(rectangle([0.0, 0.0], [1.3, 1.3]), 0.05);
        let top = Selection::Edge { side: BoxSide::Top, bodies: None };
        let (total, traction) = (Vector::new(3.0, -2.0), Vector::new(7.0, 5.0));
        for (selection, kind) in [(Selection::All, LoadKind::Force(total)), (top, LoadKind::Traction(traction))] {
            scene.loads.push(Load { selection, kind, curve: always() });
        }
        let particles = Particles::fill(&scene).unwrap();
        let middles = [Point::new(0.65, 0.65), Point::new(0.65, 1.3)];
        for (index, (expected, middle)) in [total, traction * 1.3].into_iter().zip(middles).enumerate() {
            let (mut sum, mut moment) = (Vector::zeros(), 0.0);
            for at in forces_of_load(&scene, &particles, index).unwrap() {
                let place = match at.place {
                    ForcePlace::Particle(p) => particles.rest[p as usize],
                    ForcePlace::Outline { place, .. } => place,
                };
                sum += at.force;
                moment += (place - middle).perp(&at.force);
            }
            assert!((sum - expected).norm() < 1e-12 && moment.abs() < 1e-12, "{index}: {sum} {moment}");
        }
    }
}
