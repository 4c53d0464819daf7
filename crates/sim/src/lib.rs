//! The solver: from a [`Scene`](fissure_scene::Scene) to [`Frame`](fissure_scene::Frame)s by the Material Point Method with explicit cracks.
//!
//! Touches no file and draws nothing. The same scene gives the same bytes for any number of threads.

mod constitutive;
mod elastic;
mod error;
mod kernel;
mod simulation;

pub use constitutive::{
    PlasticStep, cauchy_stress, energy_density, first_piola_stress, hardening_factor, kirchhoff_stress, plastic_step,
    volume_change,
};
pub use elastic::Elastic;
pub use error::SimulationError;
pub use simulation::{Estimate, Progress, Simulation};
