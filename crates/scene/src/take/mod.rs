//! A take: the folder that keeps a simulation. One safetensors file per frame, a manifest, two tables, the solver's state.
//!
//! ```text
//! take/manifest.json            format, version, tool, seed, the whole resolved scene, the frames there are
//! take/frame.0001.safetensors   one frame; names and shapes of its tensors: see `tensors`
//! take/tips.csv                 one row per crack tip and frame
//! take/energy.csv               one row per frame
//! take/state.bin                the solver's state at the last frame, to go on from
//! ```
//! Every file but the tables is written under a temporary name and renamed, so that a reader never sees half of one.
//! Equal frames give equal bytes; nothing in a take depends on the time of day.

mod error;
mod files;
mod manifest;
mod read;
mod state;
mod tables;
mod tensors;
mod write;

pub use error::TakeError;
pub use manifest::{FrameEntry, Manifest, Provenance};
pub use read::Take;
pub use state::SavedState;
pub use tensors::{frame_from_bytes, frame_to_bytes};
pub use write::TakeWriter;
