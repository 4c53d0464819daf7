//! What can go wrong in a simulation.

use fissure_scene::{KeyPath, SceneFault};

/// Why a simulation cannot start or go on.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// The user's own time step is above the stability limit.
    #[error(
        "time step {time_step:e} s is above the stability limit {limit:e} s; leave `solver.time_step` out or set it to at most the limit"
    )]
    TimeStepTooLarge {
        /// What was asked for [s].
        time_step: f64,
        /// Largest stable step [s].
        limit: f64,
    },
    /// Something in the scene that shows when particles are laid. Paths count items as in the scene.
    #[error("{}; {}", .0.message, .0.remedy)]
    Scene(SceneFault),
    /// More memory than the machine has would be needed.
    #[error(
        "{particles} particles need about {needed} MiB, more than the {available} MiB that are free; make `grid.particle_spacing` larger{}",
        fitting.map_or(String::new(), |spacing| format!(": {spacing} m fits"))
    )]
    TooManyParticles {
        /// Number of particles.
        particles: u64,
        /// Memory needed [MiB].
        needed: u64,
        /// Memory available [MiB].
        available: u64,
        /// A particle spacing that fits [m].
        fitting: Option<f64>,
    },
    /// Bodies reach too far for their particles and nodes to be counted.
    #[error(
        "the bodies reach over {width} m, too many cells of {cell_size} m to count; move them closer together or make \
         `grid.particle_spacing` larger"
    )]
    TooWide {
        /// Larger side of the box around all bodies [m].
        width: f64,
        /// Distance between nodes [m].
        cell_size: f64,
    },
    /// The simulation became unstable or left the range of the method.
    #[error("the simulation failed at t = {time:e} s near ({x}, {y}) m: {cause}")]
    Unstable {
        /// When [s].
        time: f64,
        /// Where, x [m].
        x: f64,
        /// Where, y [m].
        y: f64,
        /// What happened, and the remedy.
        cause: String,
    },
    /// Material is deformed more than the total Lagrangian formulation can follow.
    #[error(
        "at t = {time:e} s near ({x}, {y}) m {cause}; set `solver.formulation = \"updated\"`, or `solver.on_distortion = \"switch\"` to go on \
         with it from there"
    )]
    OutOfRange {
        /// When [s].
        time: f64,
        /// Where, x [m].
        x: f64,
        /// Where, y [m].
        y: f64,
        /// What happened.
        cause: String,
    },
    /// The state cannot be saved.
    #[error("the state cannot be saved: {0}; the frames so far stay valid")]
    NotSaved(String),
    /// A saved state does not belong to this scene or version.
    #[error("the saved state cannot be used: {0}")]
    BadState(String),
}

impl SimulationError {
    /// The key of the scene that is the cause, and another that it does not go together with. Paths count items as in
    /// the scene.
    pub fn keys(&self) -> Vec<KeyPath> {
        match self {
            Self::Scene(fault) => std::iter::once(&fault.path).chain(&fault.other).cloned().collect(),
            Self::TimeStepTooLarge { .. } => vec![KeyPath::setting("solver", "time_step")],
            Self::TooManyParticles { .. } => vec![KeyPath::setting("grid", "particle_spacing")],
            _ => Vec::new(),
        }
    }
}

impl From<SceneFault> for SimulationError {
    fn from(fault: SceneFault) -> Self {
        Self::Scene(fault)
    }
}
