//! The solver: from a [`Scene`](fissure_scene::Scene) to [`Frame`](fissure_scene::Frame)s by the Material Point Method
//! with explicit cracks. Touches no file and draws nothing.
//!
//! # A run
//!
//! ```
//! use fissure_scene::{CrackEnd, TipState};
//! use fissure_sim::Simulation;
//! use std::ops::ControlFlow;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // A plate of 20 m × 20 m with a crack from its upper edge, pulled to both sides. Coarse, so that it is quick.
//! # let file = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/pull/scene.toml"));
//! let scene = fissure_scene::load(file, &["grid.particle_spacing=0.25".into(), "frames.range=\"1-24\"".into()])?;
//!
//! // What a run would take, without running it; what is likely to go wrong.
//! let estimate = Simulation::estimate(&scene)?;
//! assert_eq!((estimate.particles, estimate.cells), (6400, 1600));
//!
//! // Particles and grid are laid; the state is that of the first frame.
//! let mut simulation = Simulation::new(&scene)?;
//! let drawn = simulation.tips()[0].length;
//!
//! // From frame to frame. After each step the run can be watched, and ended.
//! while !simulation.is_finished() {
//!     simulation.advance(&mut |progress| {
//!         assert!(progress.crack_length >= drawn, "cracks do not heal");
//!         ControlFlow::Continue(())
//!     })?;
//! }
//!
//! // A frame: particles, outlines, both faces of each crack, what was measured at the tips, energies. The crack has
//! // cut the plate clean through, and what that took is in the budget.
//! let frame = simulation.frame();
//! assert_eq!((frame.cracks[0].end, frame.tips[0].state), (CrackEnd::Mouth, TipState::LeftBody));
//! assert!(frame.energies.crack > 0.0 && frame.energies.crack < frame.energies.external_work);
//!
//! // The state at a frame can be kept, and a run goes on from it as if nothing had been.
//! let restored = Simulation::restore(&scene, &simulation.save()?)?;
//! assert_eq!(restored.frame(), frame);
//! # Ok(())
//! # }
//! ```
//!
//! # Two formulations
//!
//! A scene gets the *total* Lagrangian one where strains stay small: glass, stone, hard plastics. Nodes keep
//! displacements and velocities on the lattice of the body at rest, nothing is lost in transfers, and a step costs a
//! tenth or less of one of the other. What flows plastically or is strained by more than a tenth gets the *updated*
//! Lagrangian one: particles carry everything, through a grid that is made anew in each step. `formulation` chooses and
//! says why; a run may change from the first to the second on its way.
//!
//! # Cracks
//!
//! A crack is a line in the body at rest. Each pair of a particle and a node that it parts meets in a field of its own
//! (`crack::division`), so that faces move apart freely, and touch by contact. Near a tip of the total formulation the
//! two sides are held together by ties that soften as the tip passes (`total::ties`): a tip moves through a cell
//! without jumps, and the energy that the ties give up is what growth takes.
//!
//! In every step, or less often while it is far from growing, a tip is looked at (`tip`): J from an integral over the
//! domain around it with inertia, K_I and K_II from the interaction with Williams' fields. Growth (`growth`) follows
//! from them: direction and load by the criterion of maximum hoop stress, or along a guide; as fast as the energy pays
//! for, below a part of the Rayleigh wave speed; arrest, branches, the end at an outline or another crack.
//!
//! # What is promised
//!
//! - The same scene gives the same bytes for any number of threads.
//! - Every quantity of a frame belongs to its time; units are SI, per unit thickness where a plane problem has one.
//! - A run that becomes unsound ends with an error that names the place, the cause and a remedy; the frames before
//!   stay.
//! - How right it is: `fissure verify`, with closed forms and published numbers.
//!
//! Not promised: the same bytes from another version of the program.
//!
//! # Features
//!
//! `threads` shares the work out, `wide` chooses the widest instructions as the program runs, `system` asks how much
//! memory is free before it is taken; without them nothing but arithmetic is needed.

#[doc(hidden)]
pub mod bench;
mod boundary;
mod contact;
mod crack;
mod error;
mod faces;
mod foresight;
mod formulation;
mod free_memory;
mod grid;
mod growth;
mod loose;
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
mod wide;

pub use error::SimulationError;
pub use foresight::{Accuracy, Limit, dispensable, warnings};
pub use material::constitutive::{
    PlasticStep, cauchy_stress, energy_density, first_piola_stress, hardening_factor, kirchhoff_stress, plastic_step,
    volume_change,
};
pub use material::elastic::Elastic;
pub use simulation::{Counts, DialError, Estimate, Progress, Simulation, Stage, TimeParts};
pub use tip::contours::ContourReading;
pub use tip::stress_intensity::{StressIntensity, crack_speed_factors, universal_function};
pub use tip::williams::{TipField, moving_tip_fields, williams_fields};
pub use wide::widest_instructions;
