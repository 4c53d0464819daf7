//! The words every part of Fissure shares: a [`Scene`] goes into the solver, [`Frame`]s come out, a take keeps them.
//!
//! This crate promises validated input (every number finite and in range, every reference resolved, geometry simple and
//! oriented) and takes that another program can read. It knows no physics and draws nothing.

mod frame;
mod geometry;
mod scene;
mod settings;

pub use frame::*;
pub use geometry::*;
pub use scene::*;
pub use settings::*;
