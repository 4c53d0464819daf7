//! What is read of the solver: particles, outlines and cracks as frames hold them, energies and momenta.

use super::field_vectors::FieldVectors;
use super::internal_forces;
use super::lattice::Lattice;
use super::motion::Motion;
use super::probe::Probe;
use super::probes::{Faces, Probes};
use super::ties::Ties;
use crate::crack::Crack;
use crate::crack::cracks::Cracks;
use crate::faces::crack_frame::crack_frame;
use crate::particles::{ParticleNow, Particles};
use crate::threads::ranges;
use fissure_plane::{Matrix, Point, Vector};
use fissure_scene::{CrackFrame, OutlineFrame, ParticleFrame, Scene};
use std::ops::Range;

/// Adds to `frame`, which has what some particles are at rest, how these move.
pub(super) fn add_motions(lattice: &Lattice, motion: &Motion, frame: &mut ParticleFrame) {
    Particles::add_motions(frame, |numbers| {
        let mut reader = lattice.reader();
        let of = |p: usize| {
            let (e, now) = (lattice.material(p), reader.motion(p, motion));
            ParticleNow {
                position: lattice.particles.rest[p] + now.displacement,
                velocity: now.velocity,
                gradient: now.strain,
                cauchy_stress: crate::cauchy_stress(&now.strain, e.mu, e.lambda),
            }
        };
        numbers.map(of).collect()
    });
}

/// Of each particle: position [m], velocity [m/s], displacement gradient H = F − I [–].
pub(super) fn places_and_motions(lattice: &Lattice, motion: &Motion) -> Vec<(Point, Vector, Matrix)> {
    let mut reader = lattice.reader();
    let mut of = |p: usize| {
        let now = reader.motion(p, motion);
        (lattice.particles.rest[p] + now.displacement, now.velocity, now.strain)
    };
    (0..lattice.particles.len()).map(&mut of).collect()
}

/// The rings of all bodies of `scene`.
pub(super) fn outline_frames(scene: &Scene, probes: &Probes, motion: &Motion) -> Vec<OutlineFrame> {
    let now = |probe: &Probe| (probe.moved(&motion.displacement), probe.value(&motion.velocity));
    probes.outlines.frames(scene, now)
}

/// The cracks with both faces.
pub(super) fn crack_frames(cracks: &Cracks, probes: &Probes, motion: &Motion) -> Vec<CrackFrame> {
    let frame = |(index, (crack, faces)): (usize, (&Crack, &Faces))| {
        let places = faces.each_ref().map(|face| face.iter().map(|p| p.moved(&motion.displacement)).collect());
        let velocities = faces.each_ref().map(|face| face.iter().map(|p| p.value(&motion.velocity)).collect());
        crack_frame(index, crack, places, velocities)
    };
    cracks.iter().zip(&probes.faces).enumerate().map(frame).collect()
}

/// Kinetic energy [J/m].
pub(super) fn kinetic_energy(lattice: &Lattice, ties: &Ties, motion: &Motion) -> f64 {
    let (mass, v) = (lattice.mass(), &motion.velocity);
    let twice: f64 = (0..mass.len()).map(|d| mass[d] * (v[0][d] * v[0][d] + v[1][d] * v[1][d])).sum();
    0.5 * twice + ties.kinetic_energy(v)
}

/// Strain energy of the material and of the ties [J/m].
pub(super) fn strain_energy(lattice: &Lattice, ties: &Ties, motion: &Motion) -> f64 {
    let of_block = |particles: Range<usize>| {
        let mut reader = lattice.reader();
        particles.map(|p| lattice.particles.volume[p] * reader.energy_density(p, &motion.displacement)).sum::<f64>()
    };
    ranges(lattice.particles.len(), of_block).iter().sum::<f64>() + ties.energy(&motion.displacement)
}

/// What the sum of kinetic and strain energy lacks because velocities are those of half a step before [J/m].
///
/// What the leapfrog keeps is ½ v(t − Δt/2) · M v(t + Δt/2) + U(t). The later velocity is the earlier one after a kick
/// by the forces of now, so what is missing is half the work that these do over a step.
pub(super) fn energy_of_lag(lattice: &Lattice, ties: &Ties, motion: &Motion) -> f64 {
    let mut force = FieldVectors::default();
    internal_forces(lattice, ties, &motion.displacement, &mut force);
    let power: f64 =
        motion.velocity.iter().flatten().zip(force.iter().flatten()).map(|(speed, force)| speed * force).sum();
    motion.lag() * power
}

/// Linear [N s/m] and angular momentum about the origin [N s].
pub(super) fn momenta(lattice: &Lattice, ties: &Ties, motion: &Motion) -> (Vector, f64) {
    let (mut linear, mut angular) = (Vector::zeros(), 0.0);
    for ((d, &mass), place) in lattice.mass().iter().enumerate().zip(lattice.places_of_fields()) {
        let place = lattice.grid.place(place).coords + motion.displacement(d);
        let momentum = motion.velocity(d) * mass;
        linear += momentum;
        angular += place.perp(&momentum);
    }
    angular += ties.spin(&motion.displacement, &motion.velocity);
    (linear, angular)
}
