//! A take: the folder that keeps a simulation.
//!
//! ```text
//! take/manifest.json            format, version, tool, seed, the whole resolved scene; written once
//! take/frames.jsonl             a line per frame: number, time, files and table rows with their checksums; grows only
//! take/particles.safetensors    what the particles of all frames are at rest
//! take/frame.0001.safetensors   one frame; names and shapes of its tensors: see `tensors`
//! take/tips.csv                 one row per crack tip and frame
//! take/energy.csv               one row per frame
//! take/supports.csv             one row per support and frame
//! take/state.bin                the solver's state at some frame, to go on from
//! ```
//! A frame is in the take when its line is in the list, and its line is added only when its file is on the disk. So a
//! take is sound at every moment, for readers too, and [`TakeWriter::open`] goes on from whatever a death has left:
//! `opening` says how. Each byte is under some checksum: `sealed` for the two JSON files, the list for frames and
//! tables, its own for the state. Writing n frames writes O(n) bytes.
//!
//! Equal frames give equal bytes; nothing in a take depends on the time of day.

mod error;
mod frame_file;
mod held;
mod list;
mod manifest;
mod opening;
mod read;
mod remark;
mod sealed;
mod state;
mod tables;
mod tensors;
mod write;

pub use error::TakeError;
pub use list::{FileEntry, FrameEntry};
pub use manifest::{Manifest, Provenance};
pub use opening::{Opened, Start};
pub use read::Take;
pub use remark::Remark;
pub use state::SavedState;
pub use tensors::{FrameFileError, ParticlesAtRest, frame_from_bytes, frame_to_bytes};
pub use write::TakeWriter;
