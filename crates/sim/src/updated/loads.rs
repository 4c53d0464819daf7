//! Loads as forces on particles.

use super::beside::Beside;
use super::faces::Faces;
use super::gather::FromGrid;
use super::lattice::Lattice;
use super::nodes::Nodes;
use super::points::Points;
use super::pressure::Pressure;
use super::setup::Setup;
use crate::SimulationError;
use crate::boundary::loads::{ForcePlace, forces_of_load};
use crate::crack::cracks::Cracks;
use fissure_scene::{Load, LoadKind, Vector};

/// The forces of all loads.
#[derive(Debug)]
pub(super) struct Loads {
    /// Per load: (where, force at a curve factor of 1 [N/m]); none of pressures.
    forces: Vec<Vec<(Beside, Vector)>>,
    pressures: Vec<Pressure>,
}

impl Loads {
    /// The forces of the loads of a scene; those along outlines act there, beside the nearest
    /// of the selected particles.
    ///
    /// # Errors
    /// When a load selects nothing.
    pub(super) fn new(setup: &Setup, cracks: &Cracks, faces: &Faces) -> Result<Self, SimulationError> {
        let Setup { scene, particles, .. } = setup;
        let of_load = |(index, load): (usize, &Load)| {
            if matches!(load.kind, LoadKind::Pressure(_) | LoadKind::FacePressure(..)) {
                return Ok(Vec::new());
            }
            let layer = particles.select(scene, &load.selection);
            let beside = |place| match place {
                ForcePlace::Particle(p) => Some(Beside::at(p)),
                ForcePlace::Outline { place, .. } => Beside::nearest(setup, &layer, place),
            };
            let forces = forces_of_load(scene, particles, index)?.into_iter();
            let forces: Vec<(Beside, Vector)> = forces.filter_map(|at| Some((beside(at.place)?, at.force))).collect();
            if forces.is_empty() {
                return Err(particles.no_particle("load", index, &load.selection).into());
            }
            Ok(forces)
        };
        let forces = scene.loads.iter().enumerate().map(of_load).collect::<Result<_, SimulationError>>()?;
        Ok(Self { forces, pressures: Pressure::all(setup, cracks, faces)? })
    }

    /// Follows cracks that have changed.
    pub(super) fn follow(&mut self, setup: &Setup, cracks: &Cracks, faces: &Faces) {
        self.pressures.iter_mut().for_each(|pressure| pressure.follow(setup, cracks, faces));
    }

    /// The pressure of the last step on the faces of a crack [Pa].
    pub(super) fn pressure_on_faces(&self, crack: usize) -> f64 {
        self.pressures.iter().map(|pressure| pressure.on_faces(crack)).sum()
    }

    /// Adds the forces at the time `middle` [s] to those on nodes.
    pub(super) fn add_forces(
        &mut self,
        points: &Points,
        faces: &Faces,
        lattice: &Lattice,
        setup: &Setup,
        middle: f64,
        nodes: &mut Nodes,
    ) {
        for pressure in &mut self.pressures {
            pressure.begin_step(setup, middle);
            pressure.for_each_force(faces, |p, f| {
                lattice.for_each_entry(p, points.point[p].position, |field, w| {
                    nodes.after[0][field] += w * f.x;
                    nodes.after[1][field] += w * f.y;
                });
            });
        }
        let force = &mut nodes.after;
        for (load, forces) in setup.scene.loads.iter().zip(&self.forces) {
            let factor = load.curve.value(middle);
            if factor == 0.0 {
                continue;
            }
            for &(beside, f) in forces {
                let f = f * factor;
                beside.for_each_entry(points, lattice, |field, w| {
                    force[0][field] += w * f.x;
                    force[1][field] += w * f.y;
                });
            }
        }
    }

    /// Power of the forces at the time `middle` [s]: material moves by Σ v_i w_ip Δt, so that Σ f·v Δt is their exact
    /// work [W/m].
    pub(super) fn power(&self, points: &Points, faces: &Faces, from: &FromGrid<'_>, middle: f64) -> f64 {
        let (mut power, h) = (0.0, from.setup.scene.cell_size);
        for (load, forces) in from.setup.scene.loads.iter().zip(&self.forces) {
            let factor = load.curve.value(middle);
            for (beside, f) in forces {
                let gathered = from.gather_one(beside.particle(), &points.point[beside.particle()]);
                power += factor * f.dot(&(gathered.velocity + gathered.gradient * beside.way(points, h)));
            }
        }
        for pressure in &self.pressures {
            pressure.for_each_force(faces, |p, f| power += f.dot(&from.gather_one(p, &points.point[p]).velocity));
        }
        power
    }
}
