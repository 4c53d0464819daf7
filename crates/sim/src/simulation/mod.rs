//! The simulation as its users see it: steps, what is measured at the tips, growth, frames.

mod account;
mod advance;
mod branching_off;
mod contours;
mod counts;
mod dial;
mod estimate;
#[cfg(test)]
mod far_apart;
mod growing;
mod relaxation;
mod saving;
mod stages;
mod switching;
mod view;
mod watch;

pub use counts::Counts;
pub use dial::DialError;
pub use estimate::{Estimate, TimeParts};
pub use stages::Stage;

use crate::crack::cracks::Cracks;
use crate::crack::fragments;
use crate::formulation::{self, Choice};
use crate::material::elastic::Elastic;
use crate::particles::Particles;
use crate::solver::{Solver, SolverEnergies};
use crate::{SimulationError, foresight, memory};
use branching_off::WaitingBranch;
use contours::ContourWatch;
use fissure_scene::{Formulation, Scene};
use serde::{Deserialize, Serialize};
use stages::StageWatch;
use std::sync::Arc;

/// A simulation in progress.
#[derive(Debug)]
pub struct Simulation {
    scene: Scene,
    elastic: Vec<Elastic>,
    solver: Box<dyn Solver>,
    particles: Arc<Particles>,
    formulation: Formulation,
    state: RunState,
    counts: Counts,
    stages: StageWatch,
    contours: ContourWatch,
    /// See [`Simulation::spare_looks`].
    spares_looks: bool,
    /// Largest stable time step at the last look [s].
    stable_time_step: f64,
    /// What the watch at the end of a frame has found: see [`Simulation::measure`]. None once anything moves on.
    measured: Option<(SolverEnergies, f64)>,
}

/// What a saved state holds besides the solver's own.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct RunState {
    frame_number: i64,
    time: f64,
    steps: u64,
    cracks: Cracks,
    /// Branches of guides that tips have passed, and that have not begun yet.
    waiting: Vec<WaitingBranch>,
    /// ∫ G da [J/m].
    crack_energy: f64,
    /// Kinetic and strain energy at the beginning [J/m].
    first_energy: f64,
    /// The most work that loads, supports, gravity and colliders have done or taken back, at the frames so far [J/m].
    most_work: f64,
    /// Time between the last two frames [s].
    interval: f64,
    /// Force times time of each support until the frame before, along x and y [N s/m].
    impulses: Vec<[f64; 2]>,
    /// Fragment of each particle.
    fragments: Vec<u32>,
}

/// How far a simulation is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Simulated time [s].
    pub time: f64,
    /// Steps done so far.
    pub steps: u64,
    /// Steps done of the current frame.
    pub frame_steps: u64,
    /// Steps the current frame takes.
    pub frame_steps_total: u64,
    /// Number of live tips.
    pub live_tips: usize,
    /// Total crack length at rest [m].
    pub crack_length: f64,
}

impl Simulation {
    /// Lays particles and grid for `scene`; the state is that of the first frame.
    ///
    /// # Errors
    /// When the scene cannot be simulated: see [`SimulationError`].
    pub fn new(scene: &Scene) -> Result<Self, SimulationError> {
        let cracks = Cracks::of_scene(scene);
        let elastic: Vec<Elastic> = scene.materials.iter().map(|m| Elastic::new(m, scene.plane)).collect();
        let Choice { formulation, .. } = formulation::choose(scene, &elastic);
        let scene = &formulation::settle(scene, formulation);
        memory::check(scene, formulation)?;
        let particles = Arc::new(Particles::fill(scene)?);
        foresight::check_layout(scene, &particles, formulation)?;
        let solver = formulation::build(formulation, scene, particles.clone(), &cracks)?;
        let mut simulation = Self {
            scene: scene.clone(),
            elastic,
            solver,
            formulation,
            state: RunState {
                frame_number: scene.frames.first,
                time: 0.0,
                steps: 0,
                cracks,
                waiting: Vec::new(),
                crack_energy: 0.0,
                first_energy: 0.0,
                most_work: 0.0,
                interval: 0.0,
                impulses: vec![[0.0; 2]; scene.supports.len()],
                fragments: fragments::of_bodies(&particles),
            },
            particles,
            counts: Counts::default(),
            stages: StageWatch::default(),
            contours: ContourWatch::default(),
            spares_looks: false,
            stable_time_step: 0.0,
            measured: None,
        };
        simulation.split_fragments();
        let energies = simulation.solver.energies();
        simulation.state.first_energy = energies.kinetic + energies.strain;
        simulation.stable_time_step = simulation.solver.stable_time_step();
        simulation.check_time_step()?;
        Ok(simulation)
    }

    pub(super) fn split_fragments(&mut self) {
        fragments::split(&self.scene, &self.particles, &self.state.cracks, &mut self.state.fragments);
    }
}
