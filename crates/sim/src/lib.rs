//! The solver: from a [`Scene`](fissure_scene::Scene) to [`Frame`](fissure_scene::Frame)s by the Material Point Method with explicit cracks.
//!
//! Touches no file and draws nothing. The same scene gives the same bytes for any number of threads.

mod collider;
mod constitutive;
mod contour;
mod crack;
mod crossing;
mod division;
mod domain;
mod elastic;
mod error;
mod fields;
mod foresight;
mod formulation;
mod grid;
mod growth;
mod guide;
mod kernel;
mod look;
mod measure;
mod memory;
mod particles;
mod pieces;
mod saved;
mod scan;
mod selector;
mod simulation;
mod solver;
mod spans;
mod stress_intensity;
#[cfg(test)]
mod test_scenes;
mod total;
mod updated;
mod williams;

pub use constitutive::{
    PlasticStep, cauchy_stress, energy_density, first_piola_stress, hardening_factor, kirchhoff_stress, plastic_step,
    volume_change,
};
pub use elastic::Elastic;
pub use error::SimulationError;
pub use foresight::warnings;
pub use simulation::{Estimate, Progress, Simulation};
pub use stress_intensity::{StressIntensity, crack_speed_factors, universal_function};
pub use williams::{TipField, moving_tip_fields, williams_fields};
