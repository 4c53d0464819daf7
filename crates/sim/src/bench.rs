//! The solver without the run around it, for benchmarks and for steps longer than a run allows. Not for use: no promise
//! holds here.

use crate::SimulationError;
use crate::crack::cracks::{Cracks, TipId};
use crate::formulation;
use crate::particles::Particles;
use crate::solver::Solver;
use fissure_plane::Vector;
use fissure_scene::{End, Scene};
use std::sync::Arc;

/// A solver without the run around it: nothing is measured, nothing grows by itself.
#[derive(Debug)]
pub struct Bare {
    solver: Box<dyn Solver>,
    cracks: Cracks,
    time: f64,
    time_step: f64,
    particles: usize,
}

impl Bare {
    /// Lays a scene that says its formulation; steps are half as long as is stable.
    ///
    /// # Errors
    /// As [`Simulation::new`](crate::Simulation::new).
    pub fn new(scene: &Scene) -> Result<Self, SimulationError> {
        let cracks = Cracks::of_scene(scene);
        let particles = Arc::new(Particles::fill(scene)?);
        let solver = formulation::build(scene.solver.formulation, scene, particles.clone(), &cracks)?;
        let time_step = 0.5 * solver.stable_time_step();
        Ok(Self { solver, cracks, time: 0.0, time_step, particles: particles.len() })
    }

    /// As [`Bare::new`], with steps of any part of the predicted limit, be it beyond it.
    ///
    /// # Errors
    /// As [`Bare::new`].
    pub fn with_step(scene: &Scene, part_of_limit: f64) -> Result<Self, SimulationError> {
        let bare = Self::new(scene)?;
        Ok(Self { time_step: part_of_limit * bare.solver.stable_time_step(), ..bare })
    }

    /// Kinetic energy [J/m].
    pub fn kinetic_energy(&self) -> f64 {
        self.solver.kinetic_energy()
    }

    /// Number of particles.
    pub fn particles(&self) -> usize {
        self.particles
    }

    /// One step.
    ///
    /// # Errors
    /// As [`Simulation::advance`](crate::Simulation::advance).
    pub fn step(&mut self) -> Result<(), SimulationError> {
        self.solver.step(&self.cracks, self.time, self.time_step, &mut |_| ())?;
        self.time += self.time_step;
        Ok(())
    }

    /// Lengthens the first crack straight on at its end by `length` [m] and takes that up: division, fields, stencils,
    /// ties, faces.
    pub fn lengthen(&mut self, length: f64) {
        let tip = TipId::new(0, End::End);
        let ahead: Vector = self.cracks.last_direction(tip);
        self.cracks.grow(tip, &[self.cracks.position(tip) + ahead * length]);
        self.solver.recut(&self.cracks, &[tip]);
    }
}
