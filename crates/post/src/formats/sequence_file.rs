//! Formats that make one file of a whole sequence.

use super::gltf_animation::Film;
use super::{FileFormat, FormatError, Shot};
use crate::provenance::Provenance;
use serde::Serialize;

/// A file in the making that takes all frames of one part, by rising number.
pub trait Sequence {
    /// Adds a frame.
    ///
    /// # Errors
    /// When the format cannot hold it.
    fn add(&mut self, shot: &Shot<'_>) -> Result<(), FormatError>;

    /// The bytes of the file.
    ///
    /// # Errors
    /// When there were no frames, or the format cannot hold so many.
    fn finish(self: Box<Self>) -> Result<Vec<u8>, FormatError>;
}

/// The file of a sequence of one frame.
pub(super) fn of_one(format: &dyn FileFormat, shot: &Shot<'_>) -> Result<Vec<u8>, FormatError> {
    let mut sequence = format.sequence().ok_or(FormatError::NoFrames)?;
    sequence.add(shot)?;
    sequence.finish()
}

/// What is said of a sequence.
#[derive(Serialize)]
pub(super) struct About<'a> {
    tool: &'a str,
    scene: &'a str,
    scene_hash: &'a str,
    /// Frame numbers.
    first: i64,
    last: i64,
    /// Frames per second of playback [1/s].
    playback: f64,
}

impl<'a> About<'a> {
    /// Of the frames of `film`, the first of which comes from `origin`.
    pub(super) fn new(origin: &'a Provenance, film: &Film) -> Self {
        let Provenance { tool, scene, scene_hash, frame, .. } = origin;
        let last = film.numbers.last().copied().unwrap_or(*frame);
        Self { tool, scene, scene_hash, first: *frame, last, playback: film.playback }
    }
}
