//! Loads as forces at places of the material.

use crate::SimulationError;
use crate::boundary::selector::Selector;
use crate::particles::Particles;
use fissure_scene::{Load, LoadKind, Point, Scene, Selection, Vector};

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

/// The forces that make up load number `index` of `scene`; never empty.
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
        LoadKind::Traction(traction) => along_outlines(scene, particles.spacing, &load.selection, *traction),
        LoadKind::PerPoint(values) => values
            .iter()
            .filter_map(|&(place, force)| Some((nearest(particles, 0..particles.len() as u32, place)?, force)))
            .map(|(particle, force)| PointForce { place: ForcePlace::Particle(particle), force })
            .collect(),
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

/// So far beside an outline, in cells, is its own body.
const HAIR: f64 = 1e-6;

/// A traction on the selected pieces of the outlines, by their length: a force in the middle of each half cell, so that
/// every node gets the load of its hat.
fn along_outlines(scene: &Scene, spacing: f64, selection: &Selection, traction: Vector) -> Vec<PointForce> {
    let mut forces = Vec::new();
    for [a, b] in Selector::new(scene, selection).pieces(scene) {
        // The material lies to the left, where another body may be as near on the right.
        let inwards = Vector::new(a.y - b.y, b.x - a.x).normalize() * (HAIR * scene.cell_size);
        let beside = nalgebra::center(&a, &b) + inwards;
        let body = scene.bodies.iter().position(|body| body.region.contains(beside)).unwrap_or(0) as u32;
        let pieces = ((b - a).norm() / spacing).round().max(1.0) as usize;
        let force = traction * ((b - a).norm() / pieces as f64);
        let middle = |k: usize| a + (b - a) * ((k as f64 + 0.5) / pieces as f64);
        forces.extend((0..pieces).map(|k| PointForce { place: ForcePlace::Outline { body, place: middle(k) }, force }));
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
