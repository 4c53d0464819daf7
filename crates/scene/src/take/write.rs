//! Writing a take.

use super::list::{self, FileEntry, FrameEntry};
use super::tensors::is_frame;
use super::{Manifest, Provenance, TakeError, frame_to_bytes, state, tables};
use crate::frame::Frame;
use crate::scene::Scene;
use fissure_files::Folder;

/// Writes a take, frame by frame. [`TakeWriter::open`] makes one.
#[derive(Debug)]
pub struct TakeWriter {
    folder: Folder,
    entries: Vec<FrameEntry>,
}

impl TakeWriter {
    /// Begins the take of `scene` in `folder` anew: the take that is there goes, whatever its scene, version and state.
    /// What goes are the files that every take has and the frames, which say themselves what they are; other files
    /// stay.
    ///
    /// # Errors
    /// When the folder holds something that is no take, or cannot be written.
    pub fn replace(folder: &Folder, scene: &Scene, provenance: Provenance) -> Result<Self, TakeError> {
        match Manifest::is_there(folder)? {
            None => {}
            // Says what it is instead.
            Some(false) => drop(Manifest::read(folder)?),
            Some(true) => {
                // The manifest goes last: until then the folder is known for a take.
                folder.remove(state::NAME)?;
                for name in folder.names()?.iter().filter(|name| is_frame_name(name)) {
                    if folder.read(name)?.is_some_and(|bytes| is_frame(&bytes)) {
                        folder.remove(name)?;
                    }
                }
                folder.remove(list::NAME)?;
                tables::TABLES.iter().try_for_each(|table| folder.remove(table.name))?;
                folder.sync()?;
                Manifest::remove(folder)?;
            }
        }
        Self::begin(folder, scene, provenance)
    }

    /// Begins a take where there is none.
    pub(super) fn begin(folder: &Folder, scene: &Scene, provenance: Provenance) -> Result<Self, TakeError> {
        // What has no manifest is no take: a file under one of our names is somebody else's, unless there is nothing in
        // it but what a death in the middle of these lines leaves.
        for name in tables::TABLES.iter().map(|table| table.name).chain([list::NAME, state::NAME]) {
            if folder.read(name)?.is_some_and(|bytes| !bytes.is_empty() && !tables::is_fresh(&bytes)) {
                return Err(TakeError::Foreign { path: folder.place(name)? });
            }
        }
        folder.make()?;
        folder.remove_drafts()?;
        Manifest::new(scene, provenance).write(folder)?;
        folder.sync()?;
        tables::create(folder)?;
        list::write(folder, &[])?;
        folder.sync()?;
        Ok(Self::with(folder, Vec::new()))
    }

    /// Goes on after the frames of `entries`.
    pub(super) fn with(folder: &Folder, entries: Vec<FrameEntry>) -> Self {
        Self { folder: folder.clone(), entries }
    }

    /// Writes a frame, its rows of the tables, and the line that lists it; when this returns it outlives a power cut. A
    /// frame that is listed already has to be the same.
    ///
    /// `state`: that of the solver at this frame, for [`TakeWriter::open`]. It is on the disk before the frame is
    /// listed, so that a take with all its frames has its last state, too.
    ///
    /// # Errors
    /// When the folder cannot be written; the frames so far stay readable. When the frame is not the one that is
    /// listed.
    pub fn write_frame(&mut self, frame: &Frame, state: Option<&[u8]>) -> Result<(), TakeError> {
        let bytes = frame_to_bytes(frame).map_err(|cause| TakeError::BadFrame { number: frame.number, cause })?;
        let name = list::file_name(frame.number);
        let file = FileEntry::new(&name, &bytes);
        if let Ok(at) = self.entries.binary_search_by_key(&frame.number, |entry| entry.number) {
            self.compare(at, &file, &bytes)?;
            return state.map_or(Ok(()), |state| self.write_state(state, frame.number));
        }
        if let Some(last) = self.newest().filter(|last| last.checked_add(1) != Some(frame.number)) {
            return Err(TakeError::OutOfOrder { number: frame.number, last });
        }
        // One that is there but not listed was written just before a death.
        if self.folder.read(&name)?.is_some_and(|there| !there.is_empty() && !is_frame(&there)) {
            return Err(TakeError::Foreign { path: self.folder.place(&name)? });
        }
        self.folder.write(&name, &bytes)?;
        self.folder.sync()?;
        if let Some(state) = state {
            self.write_state(state, frame.number)?;
        }
        let rows = tables::append(&self.folder, frame)?;
        let entry = FrameEntry { number: frame.number, time: frame.time, files: vec![file], rows };
        list::append(&self.folder, &entry)?;
        self.entries.push(entry);
        Ok(())
    }

    /// Holds a frame that was computed again against the one that is listed, and mends its file where that was changed.
    fn compare(&self, at: usize, file: &FileEntry, bytes: &[u8]) -> Result<(), TakeError> {
        let entry = &self.entries[at];
        if entry.files.first() != Some(file) {
            return Err(TakeError::OtherFrame { path: self.folder.path().into(), number: entry.number });
        }
        if self.folder.read(&file.name)?.as_deref() != Some(bytes) {
            self.folder.write(&file.name, bytes)?;
            self.folder.sync()?;
        }
        Ok(())
    }

    /// Writes the solver's state at the frame `number`, which is listed.
    ///
    /// # Errors
    /// When the folder cannot be written; the state from before is then still there.
    pub fn write_state(&self, state: &[u8], number: i64) -> Result<(), TakeError> {
        state::write(&self.folder, state, number)
    }

    /// The newest frame that is listed.
    pub fn newest(&self) -> Option<i64> {
        self.entries.last().map(|entry| entry.number)
    }
}

/// Whether a file is called as the file of a frame.
fn is_frame_name(name: &str) -> bool {
    let number = name.strip_prefix("frame.").and_then(|rest| rest.strip_suffix(".safetensors"));
    number.and_then(|number| number.parse().ok()).is_some_and(|number| list::file_name(number) == name)
}
