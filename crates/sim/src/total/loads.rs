//! Loads: forces at places of the material.

use super::field_vectors::FieldVectors;
use super::lattice::Lattice;
use super::motion::Motion;
use super::near::Near;
use super::probe::Probe;
use crate::SimulationError;
use crate::boundary::loads::{self, ForcePlace};
use fissure_plane::Vector;
use fissure_scene::{Load, Scene};

/// A force at a place of the material.
#[derive(Debug, Clone)]
struct ProbeForce {
    probe: Probe,
    /// At a curve factor of 1 [N/m].
    force: Vector,
}

/// The forces of each load of the scene.
#[derive(Debug)]
pub(super) struct Loads(Vec<Vec<ProbeForce>>);

impl Loads {
    /// The forces of the loads of `scene`.
    ///
    /// # Errors
    /// When a load selects nothing.
    pub(super) fn new(scene: &Scene, lattice: &Lattice) -> Result<Self, SimulationError> {
        let on_probe = |at: loads::PointForce| {
            let (body, place) = match at.place {
                ForcePlace::Particle(p) => (lattice.particles.body[p as usize], lattice.particles.rest[p as usize]),
                ForcePlace::Outline { body, place } => (body, place),
            };
            ProbeForce { probe: lattice.probe(body, place, place), force: at.force }
        };
        let of_load = |index| {
            let forces = loads::forces_of_load(scene, &lattice.particles, index)?;
            Ok(forces.into_iter().map(on_probe).collect())
        };
        (0..scene.loads.len()).map(of_load).collect::<Result<_, _>>().map(Self)
    }

    /// Lays the places of loads anew where something has changed.
    pub(super) fn refresh(&mut self, near: &Near, lattice: &Lattice) {
        for force in self.0.iter_mut().flatten().filter(|force| near.contains(force.probe.rest)) {
            force.probe = lattice.probe(force.probe.body, force.probe.rest, force.probe.nudged);
        }
    }

    /// The forces of each of `loads` with its factor at `time` [s]; loads that are zero are left out.
    fn acting<'a>(&'a self, loads: &'a [Load], time: f64) -> impl Iterator<Item = (f64, &'a [ProbeForce])> {
        let factors = loads.iter().map(move |load| load.curve.value(time));
        factors.zip(&self.0).filter(|(factor, _)| *factor != 0.0).map(|(factor, forces)| (factor, forces.as_slice()))
    }

    /// Adds the loads at the time `time` [s] to the forces.
    pub(super) fn add_forces(&self, loads: &[Load], time: f64, force: &mut FieldVectors) {
        for (factor, forces) in self.acting(loads, time) {
            for point in forces {
                let f = point.force * factor;
                for &(field, w) in &point.probe.entries {
                    force[0][field as usize] += f.x * w;
                    force[1][field as usize] += f.y * w;
                }
            }
        }
    }

    /// Work that the loads do at the time `time` [s] and the present velocities, per time [W/m].
    pub(super) fn power(&self, loads: &[Load], time: f64, motion: &Motion) -> f64 {
        let mut power = 0.0;
        for (factor, forces) in self.acting(loads, time) {
            power += factor * forces.iter().map(|p| p.force.dot(&p.probe.value(&motion.velocity))).sum::<f64>();
        }
        power
    }
}
