//! The solver: from a [`Scene`](fissure_scene::Scene) to [`Frame`](fissure_scene::Frame)s by the Material Point Method with explicit cracks.
//!
//! Touches no file and draws nothing. The same scene gives the same bytes for any number of threads.

mod error;
mod simulation;

pub use error::SimulationError;
pub use simulation::{Estimate, Progress, Simulation};
