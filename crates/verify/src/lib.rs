//! Problems with known solutions: the scene that computes each, and the numbers it should give.
//!
//! Promises: every reference number names where it comes from, and every scene is complete, so that a test, an example
//! or a chart runs the very same problem. Does not promise that a scene meets its reference: that is for the report to
//! say.
//!
//! A [`Case`] is run with [`Options`] and gives a [`Report`] of [`Row`]s; [`text`] and [`markdown`] print it.
//!
//! # How to write a case
//!
//! A case is a file in `cases`, named in `list.rs`. It builds its scene as it is easiest to think of, with a `Problem`,
//! and knows nothing of where the scene will lie on the grid: `Tally::set_up` mirrors it, turns it, moves it within a
//! cell and changes its spacing, and what is read through the simulation that comes back is in the frame of the case
//! again, K_II and kink angles with the signs they have there. `Tally::rest` brings it to rest, `Tally::run` follows it
//! step by step.
//!
//! - Geometry is written down exactly, so that the reference holds wherever it lies. Round numbers are best: they are
//!   what people draw, and the first place is the one that is written down.
//! - Edges are selected by their side, or by the stretch of the outline that is meant, never by a box of nodes.
//! - A row has the same name at every place. It is one number of one run: worst, mean and deviation come by themselves.
//! - What takes longer than some minutes at 32 places says so: `family_cells` for a coarser grid, in which targets
//!   may be missed that hold as drawn, `long` for fewer places.
//! - Its coarse version goes into `tests/tests/reference_cases.rs`.
//!
//! ```
//! use fissure_scene::SolverPreset;
//! use fissure_verify::EdgeCrack;
//!
//! let problem = EdgeCrack { tip_offset: [0.125, 0.51], ..EdgeCrack::default() };
//! let result = problem.run(SolverPreset::Standard)?;
//! assert!((result.mode_1 / problem.mode_1() - 1.0).abs() < 0.035);
//! # Ok::<(), fissure_sim::SimulationError>(())
//! ```

mod case;
mod cases;
mod cpu_time;
mod dial;
mod family;
mod features;
mod interpolate;
mod list;
mod placed;
mod placement;
mod problem;
mod rates;
mod report;
mod scheme;
mod stability;
mod study;
#[cfg(test)]
mod symmetry;
mod table;

pub use case::{Case, Options};
pub use cases::edge_crack::{EdgeCrack, EdgeCrackResult};
pub use cpu_time::cpu_time;
pub use dial::{DialTrial, dial_trial};
pub use features::{FEATURES, Feature, FeatureCost};
pub use list::{CASES, find};
pub use rates::{Rate, TIMED_PLATES, TimedPlate};
pub use report::{Expected, Progress, Report, Row, Spread};
pub use scheme::Scheme;
pub use stability::{Parameter, STABILITY_MAPS, StabilityMap};
pub use study::{Measure, STUDIES, Studied, Study};
pub use table::{markdown, text};
