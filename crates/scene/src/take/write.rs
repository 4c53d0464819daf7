//! Writing a take.

use super::manifest::file_name;
use super::{FrameEntry, Manifest, Provenance, SavedState, TakeError, files, frame_to_bytes, state, tables};
use crate::frame::Frame;
use crate::scene::Scene;
use std::path::{Path, PathBuf};

/// Writes a take, frame by frame.
#[derive(Debug)]
pub struct TakeWriter {
    folder: PathBuf,
    manifest: Manifest,
}

impl TakeWriter {
    /// Starts a take in `folder`, which is made if it is not there. A take that is there already is replaced.
    ///
    /// # Errors
    /// When the folder cannot be written, or holds a `manifest.json` that is not of a take.
    pub fn create(folder: &Path, scene: &Scene, provenance: Provenance) -> Result<Self, TakeError> {
        std::fs::create_dir_all(folder).map_err(TakeError::io("make the folder", folder))?;
        if Manifest::path(folder).exists() {
            // A take of another version or a damaged one is replaced as well, but its frames are not known and stay.
            match Manifest::read(folder) {
                Ok(old) => old.frames.iter().try_for_each(|f| files::remove(&folder.join(&f.file)))?,
                Err(TakeError::Version { .. } | TakeError::Damaged { .. }) => {}
                Err(other) => return Err(other),
            }
        }
        files::remove(&folder.join("state.bin"))?;
        let writer = Self { folder: folder.into(), manifest: Manifest::new(scene, provenance) };
        writer.manifest.write(folder)?;
        tables::create(folder)?;
        Ok(writer)
    }

    /// Goes on with the take in `folder` from its saved state. Frames after the state are dropped; without a usable state
    /// all are, and none is returned: begin with the first frame.
    ///
    /// # Errors
    /// When there is no take of this version, it is of another scene, or the folder cannot be written.
    pub fn resume(
        folder: &Path,
        scene: &Scene,
        provenance: Provenance,
    ) -> Result<(Self, Option<SavedState>), TakeError> {
        let mut manifest = Manifest::read(folder)?;
        if manifest.scene != *scene || manifest.seed != provenance.seed {
            return Err(TakeError::OtherScene { path: folder.into() });
        }
        if manifest.tool_version != provenance.tool_version {
            // Another version may compute other numbers: one take is the work of one version.
            return Ok((Self::create(folder, scene, provenance)?, None));
        }
        let saved = match state::read(folder) {
            Err(TakeError::Damaged { .. }) => None,
            other => other?,
        };
        let saved = saved.filter(|s| manifest.frames.iter().any(|f| f.number == s.frame));
        let last = saved.as_ref().map_or(i64::MIN, |s| s.frame);
        let (kept, dropped): (Vec<_>, Vec<_>) = manifest.frames.into_iter().partition(|f| f.number <= last);
        manifest.frames = kept;
        manifest.complete = manifest.complete && dropped.is_empty();
        manifest.write(folder)?;
        dropped.iter().try_for_each(|f| files::remove(&folder.join(&f.file)))?;
        tables::truncate(folder, last)?;
        Ok((Self { folder: folder.into(), manifest }, saved))
    }

    /// Writes a frame, its rows of the tables, and the manifest that names it.
    ///
    /// # Errors
    /// When the folder cannot be written; the frames so far stay readable.
    pub fn write_frame(&mut self, frame: &Frame) -> Result<(), TakeError> {
        let file = file_name(frame.number);
        let path = self.folder.join(&file);
        let bytes = frame_to_bytes(frame).map_err(|cause| TakeError::damaged(&path, cause))?;
        files::write_whole(&path, &bytes)?;
        if self.manifest.frames.iter().any(|f| f.number >= frame.number) {
            tables::truncate(&self.folder, frame.number - 1)?;
            self.manifest.frames.retain(|f| f.number < frame.number);
        }
        tables::append(&self.folder, frame)?;
        self.manifest.frames.push(FrameEntry { number: frame.number, time: frame.time, file });
        self.manifest.write(&self.folder)
    }

    /// Writes the solver's state at the frame `number`, for [`TakeWriter::resume`].
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub fn write_state(&self, state: &[u8], number: i64) -> Result<(), TakeError> {
        state::write(&self.folder, state, number)
    }

    /// Says in the manifest that all frames are there.
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub fn finish(&mut self) -> Result<(), TakeError> {
        self.manifest.complete = true;
        self.manifest.write(&self.folder)
    }

    /// The folder of the take.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// What has been written so far.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }
}
