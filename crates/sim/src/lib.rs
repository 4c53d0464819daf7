//! The solver: from a [`Scene`](fissure_scene::Scene) to [`Frame`](fissure_scene::Frame)s by the Material Point Method
//! with explicit cracks.
//!
//! Touches no file and draws nothing. The same scene gives the same bytes for any number of threads.

#[doc(hidden)]
pub mod bench;
mod boundary;
mod crack;
mod error;
mod faces;
mod foresight;
mod formulation;
mod free_memory;
mod grid;
mod growth;
mod material;
mod memory;
mod particles;
mod saved;
mod simulation;
mod solver;
#[cfg(test)]
mod test_scenes;
mod threads;
mod tip;
mod total;
mod updated;

pub use error::SimulationError;
pub use foresight::warnings;
pub use material::constitutive::{
    PlasticStep, cauchy_stress, energy_density, first_piola_stress, hardening_factor, kirchhoff_stress, plastic_step,
    volume_change,
};
pub use material::elastic::Elastic;
pub use simulation::{Counts, Estimate, Progress, Simulation};
pub use tip::stress_intensity::{StressIntensity, crack_speed_factors, universal_function};
pub use tip::williams::{TipField, moving_tip_fields, williams_fields};
