//! The words every part of Fissure shares: a [`Scene`] goes into the solver, [`Frame`]s come out, a take keeps them.
//!
//! This crate promises validated input (every number finite and in range, every reference resolved, geometry simple and
//! oriented) and takes that another program can read. It knows no physics and draws nothing.
//!
//! [`load`] reads a scene file and its drawing, [`load_with_warnings`] also says what will hardly go well; scenes made
//! in code call [`Scene::validate`].
//!
//! Reading scene files is the feature `load`, takes are the feature `take`; both are on by default. What is left
//! without them touches no file.

mod curve;
#[cfg(feature = "load")]
pub mod document;
mod fault;
mod fragments;
mod frame;
mod frame_check;
mod infinite;
#[cfg(feature = "load")]
mod load;
mod materials;
mod presets;
mod range;
mod scene;
mod settings;
#[cfg(feature = "hash")]
mod simulation_hash;
#[cfg(feature = "take")]
mod take;
mod take_settings;
mod toughness;
mod validate;
mod wish;

pub use fissure_plane::{Matrix, Point, Region, Vector};

pub use curve::Curve;
pub use fault::{Key, KeyPath, SceneFault, Warning};
pub use fragments::{Boundary, BoundaryEdge, Fragment, Fragments, Line, RestCrack, RestRing};
pub use frame::*;
pub use frame_check::{FrameFault, FramePart};
#[cfg(feature = "load")]
pub use load::{
    Draft, DraftOptions, LoadError, LoadErrorKind, Loaded, Place, draft, load, load_with_warnings, schema, template,
    with_output,
};
pub use materials::{material_preset, material_presets};
pub use presets::{solver_preset, updated_kernel};
pub use scene::*;
pub use settings::*;
#[cfg(feature = "take")]
pub use take::*;
pub use take_settings::*;
pub use toughness::*;
pub use wish::{Wish, WishError};
