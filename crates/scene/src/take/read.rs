//! Reading a take, also while it is being written.

use super::list::{self, FrameEntry};
use super::remark::Remark;
use super::tables::TABLES;
use super::{Manifest, TakeError, frame_file, state};
use crate::frame::Frame;
use crate::scene::Scene;
use fissure_files::Folder;
use std::path::Path;

/// A take on disk, as it was when it was opened.
#[derive(Debug, Clone)]
pub struct Take {
    folder: Folder,
    manifest: Manifest,
    entries: Vec<FrameEntry>,
}

impl Take {
    /// Opens the take in a folder of this machine.
    ///
    /// # Errors
    /// When there is none, it is of another version, or its manifest or its list of frames is damaged.
    pub fn open(folder: &Path) -> Result<Self, TakeError> {
        Self::read(&Folder::new(folder))
    }

    /// Opens the take in `folder`.
    ///
    /// # Errors
    /// As [`Take::open`].
    pub fn read(folder: &Folder) -> Result<Self, TakeError> {
        let manifest = Manifest::read(folder)?;
        let entries = list::read(folder, manifest.scene.frames.first)?.entries;
        Ok(Self { folder: folder.clone(), manifest, entries })
    }

    /// The scene it was made from.
    pub fn scene(&self) -> &Scene {
        &self.manifest.scene
    }

    /// What it is.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// The frames there are, by rising number.
    pub fn frames(&self) -> &[FrameEntry] {
        &self.entries
    }

    /// Whether all frames of the scene are there.
    pub fn is_complete(&self) -> bool {
        self.entries.last().is_some_and(|last| last.number >= self.scene().frames.last)
    }

    /// Numbers of the frames there are, rising.
    pub fn frame_numbers(&self) -> Vec<i64> {
        self.entries.iter().map(|entry| entry.number).collect()
    }

    /// One frame, bit for bit as it was written.
    ///
    /// # Errors
    /// When there is no such frame, or its file is missing, cut off or changed.
    pub fn frame(&self, number: i64) -> Result<Frame, TakeError> {
        match self.entries.binary_search_by_key(&number, |entry| entry.number) {
            Ok(at) => frame_file::read(&self.folder, &self.entries[at]),
            Err(_) => {
                let have = list::in_words(&self.entries);
                Err(TakeError::NoFrame { path: self.folder.path().into(), number, have })
            }
        }
    }

    /// What is wrong with the files that no frame needs: the tables and the saved state.
    ///
    /// # Errors
    /// When one cannot be read at all.
    pub fn remarks(&self) -> Result<Vec<Remark>, TakeError> {
        let mut remarks = Vec::new();
        for table in TABLES {
            let text = self.folder.read(table.name)?.unwrap_or_default();
            if table.sound_length(&text, &self.entries).is_none() {
                remarks.push(Remark::DamagedTable(table.name));
            }
        }
        match state::read(&self.folder) {
            Err(error @ TakeError::DamagedState { .. }) => remarks.push(Remark::UnusableState(error.to_string())),
            other => drop(other?),
        }
        Ok(remarks)
    }
}
