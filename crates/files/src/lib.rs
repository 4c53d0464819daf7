//! Files that appear whole or not at all. Everything that Fissure writes goes through a [`Folder`].
//!
//! - [`Folder::write`] puts a file under its name only when all of it is on the disk: who reads sees the old file or
//!   the new one, also after a kill, on a full disk and after a power cut.
//! - [`Folder::append`] adds to a file; what was there before stays whatever happens. Readers have to expect a last
//!   part that is cut off.
//! - Names are checked: none reaches out of its folder.
//! - A [`Lock`] keeps a second process out of a folder and dies with its owner.
//!
//! A folder lies on a [`Disk`]. [`SystemDisk`] is the real one; [`SimulatedDisk`] fills up, dies or loses power at a
//! chosen call, for tests that try every one of them.

mod disk;
mod error;
mod folder;
mod lock;
mod regular_file;
mod simulated;

pub use disk::{Disk, Draft, SystemDisk};
pub use error::FileError;
pub use folder::Folder;
pub use lock::{Lock, LockError};
pub use regular_file::read_regular;
pub use simulated::{Fault, SimulatedDisk};
