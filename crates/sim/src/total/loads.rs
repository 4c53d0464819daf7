//! Loads: forces at places of the material.

use super::lattice::Lattice;
use super::motion::Motion;
use super::near::Near;
use super::pressure::{Pressed, Pressure};
use super::probe::Probe;
use crate::SimulationError;
use crate::boundary::loads::{self, ForcePlace};
use crate::crack::cracks::{Cracks, TipId};
use fissure_plane::Vector;
use fissure_scene::{Load, Scene};

/// A force at a place of the material.
#[derive(Debug, Clone)]
struct ProbeForce {
    probe: Probe,
    /// At a curve factor of 1 [N/m].
    force: Vector,
}

/// The loads of the scene.
#[derive(Debug)]
pub(super) struct Loads {
    /// The forces of each, none of pressures.
    forces: Vec<Vec<ProbeForce>>,
    pressures: Vec<Pressure>,
    /// Factors of the pressures in the last step, at the beginning those of the start.
    factors: Vec<f64>,
}

impl Loads {
    /// The forces of the loads of `scene`, on cracks as they are now.
    ///
    /// # Errors
    /// When a load selects nothing.
    pub(super) fn new(scene: &Scene, lattice: &Lattice, cracks: &Cracks) -> Result<Self, SimulationError> {
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
        let forces = (0..scene.loads.len()).map(of_load).collect::<Result<_, SimulationError>>()?;
        let pressures = Pressure::all(scene, lattice, cracks)?;
        let factors = pressures.iter().map(|pressure| scene.loads[pressure.load].curve.value(0.0)).collect();
        Ok(Self { forces, pressures, factors })
    }

    /// Lays the places of loads anew where something has changed.
    pub(super) fn refresh(&mut self, near: &Near, scene: &Scene, lattice: &Lattice, cracks: &Cracks) {
        for force in self.forces.iter_mut().flatten().filter(|force| near.contains(force.probe.rest)) {
            force.probe = lattice.probe(force.probe.body, force.probe.rest, force.probe.nudged);
        }
        self.pressures.iter_mut().for_each(|pressure| pressure.refresh(near, scene, lattice, cracks));
    }

    /// Follows a tip that has moved on along its segment.
    pub(super) fn slide(&mut self, id: TipId, scene: &Scene, lattice: &Lattice, cracks: &Cracks) {
        self.pressures.iter_mut().for_each(|pressure| pressure.slide(id, scene, lattice, cracks));
    }

    /// The forces of each of `loads` with its factor at `time` [s]; loads that are zero are left out.
    fn acting<'a>(&'a self, loads: &'a [Load], time: f64) -> impl Iterator<Item = (f64, &'a [ProbeForce])> {
        let factors = loads.iter().map(move |load| load.curve.value(time));
        factors
            .zip(&self.forces)
            .filter(|(factor, _)| *factor != 0.0)
            .map(|(factor, forces)| (factor, forces.as_slice()))
    }

    /// The pressures with their factors in the last step.
    fn pressing(&self) -> impl Iterator<Item = (f64, &Pressure)> {
        self.factors.iter().copied().zip(&self.pressures).filter(|(factor, _)| *factor != 0.0)
    }

    /// Adds the loads of a step around the time `time` [s] to the forces.
    pub(super) fn add_forces(&mut self, loads: &[Load], time: f64, motion: &mut Motion) {
        let Motion { displacement, force, .. } = motion;
        for (factor, forces) in self.acting(loads, time) {
            for point in forces {
                let f = point.force * factor;
                for &(field, w) in &point.probe.entries {
                    force[0][field as usize] += f.x * w;
                    force[1][field as usize] += f.y * w;
                }
            }
        }
        for (factor, pressure) in self.factors.iter_mut().zip(&self.pressures) {
            *factor = loads[pressure.load].curve.value(time);
        }
        self.pressing().for_each(|(factor, pressure)| pressure.add_forces(factor, displacement, force));
    }

    /// Work that the loads of the last step, around the time `time` [s], do at the present velocities, per time [W/m].
    pub(super) fn power(&self, loads: &[Load], time: f64, motion: &Motion) -> f64 {
        let mut power = 0.0;
        for (factor, forces) in self.acting(loads, time) {
            power += factor * forces.iter().map(|p| p.force.dot(&p.probe.value(&motion.velocity))).sum::<f64>();
        }
        power + self.pressing().map(|(factor, pressure)| pressure.power(factor, motion)).sum::<f64>()
    }

    /// The pieces of the faces of a crack that are pressed on, with the pressure now [Pa].
    pub(super) fn on_faces(&self, crack: usize) -> impl Iterator<Item = (f64, &Pressed)> {
        let is_of = move |pressed: &&Pressed| pressed.piece.face.is_some_and(|(of, _)| of as usize == crack);
        self.pressing().flat_map(move |(factor, pressure)| {
            let now = factor * pressure.pressure;
            pressure.pieces.iter().filter(is_of).map(move |pressed| (now, pressed))
        })
    }
}
