//! The simulation as its users see it.

use crate::SimulationError;
use fissure_scene::{Frame, Scene};
use std::ops::ControlFlow;

/// A simulation in progress.
#[derive(Debug)]
pub struct Simulation {
    scene: Scene,
    frame_number: i64,
}

/// What a scene will cost, known before it runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Number of particles.
    pub particles: usize,
    /// Number of grid cells that hold material.
    pub cells: usize,
    /// Time step [s].
    pub time_step: f64,
    /// Largest stable time step [s].
    pub stable_time_step: f64,
    /// Number of steps for all frames.
    pub steps: u64,
    /// Name of the formulation and the reason for it.
    pub formulation: String,
    /// Memory the solver needs [bytes].
    pub memory: u64,
    /// Wall time expected on this machine [s], from a few steps timed by the caller or a rate measured here.
    pub seconds: f64,
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
        Ok(Self { frame_number: scene.frames.first, scene: scene.clone() })
    }

    /// What running `scene` will cost. Lays particles and grid but takes no step beyond a short timing run.
    ///
    /// # Errors
    /// As [`Simulation::new`].
    pub fn estimate(scene: &Scene) -> Result<Estimate, SimulationError> {
        let _ = scene;
        Err(SimulationError::BadState("not there yet".into()))
    }

    /// Whether the last frame has been reached.
    pub fn is_finished(&self) -> bool {
        self.frame_number >= self.scene.frames.last
    }

    /// The current state as a frame.
    pub fn frame(&self) -> Frame {
        Frame { number: self.frame_number, ..Frame::default() }
    }

    /// Runs to the next frame. `watch` is called now and then (some ten times a second at most matters); when it breaks, the run stops
    /// in mid-frame and `false` is returned: the state is then good for nothing but being dropped, a saved state of the last frame goes on.
    ///
    /// # Errors
    /// When the run becomes unstable; the frames so far stay valid.
    pub fn advance(&mut self, watch: &mut dyn FnMut(&Progress) -> ControlFlow<()>) -> Result<bool, SimulationError> {
        let _ = watch;
        self.frame_number += 1;
        Ok(true)
    }

    /// The whole state at a frame boundary, for [`Simulation::restore`].
    pub fn save(&self) -> Vec<u8> {
        Vec::new()
    }

    /// Goes on from a saved state of the same scene: gives bit for bit what an uninterrupted run gives.
    ///
    /// # Errors
    /// [`SimulationError::BadState`] when `state` is of another scene or version.
    pub fn restore(scene: &Scene, state: &[u8]) -> Result<Self, SimulationError> {
        let _ = state;
        Self::new(scene)
    }
}
