//! Reading a take.

use super::{Manifest, SavedState, TakeError, frame_from_bytes, state};
use crate::frame::Frame;
use crate::scene::Scene;
use std::path::{Path, PathBuf};

/// A take on disk.
#[derive(Debug, Clone)]
pub struct Take {
    folder: PathBuf,
    manifest: Manifest,
}

impl Take {
    /// Opens the take in `folder`.
    ///
    /// # Errors
    /// When there is none, it is of another version, or its manifest is damaged.
    pub fn open(folder: &Path) -> Result<Self, TakeError> {
        Ok(Self { folder: folder.into(), manifest: Manifest::read(folder)? })
    }

    /// The scene it was made from.
    pub fn scene(&self) -> &Scene {
        &self.manifest.scene
    }

    /// What it is.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// Whether all frames of the scene are there.
    pub fn is_complete(&self) -> bool {
        self.manifest.complete
    }

    /// Numbers of the frames there are, rising.
    pub fn frame_numbers(&self) -> Vec<i64> {
        self.manifest.frames.iter().map(|f| f.number).collect()
    }

    /// One frame, bit for bit as it was written.
    ///
    /// # Errors
    /// When there is no such frame, or its file is missing, cut off or changed.
    pub fn frame(&self, number: i64) -> Result<Frame, TakeError> {
        let entry = self.manifest.frames.iter().find(|f| f.number == number).ok_or_else(|| {
            let numbers = self.frame_numbers();
            let have = match (numbers.first(), numbers.last()) {
                (Some(first), Some(last)) => format!("{first} to {last}"),
                _ => "none".into(),
            };
            TakeError::NoFrame { path: self.folder.clone(), number, have }
        })?;
        let path = self.folder.join(&entry.file);
        let bytes = std::fs::read(&path).map_err(TakeError::io("read", &path))?;
        let frame = frame_from_bytes(&bytes).map_err(|cause| TakeError::damaged(&path, cause))?;
        if frame.number != number {
            return Err(TakeError::damaged(&path, format!("it holds frame {}", frame.number)));
        }
        Ok(frame)
    }

    /// The solver's saved state, if there is one.
    ///
    /// # Errors
    /// When it is cut off or changed.
    pub fn state(&self) -> Result<Option<SavedState>, TakeError> {
        state::read(&self.folder)
    }
}
