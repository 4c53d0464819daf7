//! Problems with known solutions: the scene that computes each, and the numbers it should give.
//!
//! Promises: every reference number names where it comes from, and every scene is complete, so that a test, an example
//! or a chart runs the very same problem. Does not promise that a scene meets its reference: that is for the report to
//! say.
//!
//! A [`Case`] is run with [`Options`] and gives a [`Report`] of [`Row`]s; [`text`] and [`markdown`] print it.
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
mod interpolate;
mod list;
mod problem;
mod report;
mod table;

pub use case::{Case, Options};
pub use cases::edge_crack::{EdgeCrack, EdgeCrackResult};
pub use list::{CASES, find};
pub use report::{Expected, Progress, Report, Row};
pub use table::{markdown, text};
