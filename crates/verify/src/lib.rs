//! Fracture problems with their solutions: the scene that computes each, and the number it should give.
//!
//! Promises: every reference number names where it comes from, and every scene is complete, so that a test, an example or a chart runs the very same
//! problem. Does not promise that a scene meets its reference: that is for the tests to say.
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

mod edge_crack;

pub use edge_crack::{EdgeCrack, EdgeCrackResult};
