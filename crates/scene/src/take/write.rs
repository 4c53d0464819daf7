//! Writing a take.

use super::held::{chosen, rounded};
use super::list::{self, FileEntry, FrameEntry};
use super::tensors::is_ours;
use super::{Manifest, ParticlesAtRest, Provenance, TakeError, frame_file, frame_to_bytes, state, tables};
use crate::frame::Frame;
use crate::scene::Scene;
use crate::take_settings::TakeSettings;
use fissure_files::Folder;

/// Writes a take, frame by frame. [`TakeWriter::open`] makes one.
#[derive(Debug)]
pub struct TakeWriter {
    folder: Folder,
    settings: TakeSettings,
    /// Of the scene [m].
    cell_size: f64,
    entries: Vec<FrameEntry>,
    /// What the particles of the first frame are at rest; none until it is needed.
    at_rest: Option<ParticlesAtRest>,
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
                for name in folder.names()?.iter().filter(|name| is_frame_name(name) || *name == frame_file::AT_REST) {
                    if folder.read(name)?.is_some_and(|bytes| is_ours(&bytes)) {
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
        Ok(Self::with(folder, scene, Vec::new()))
    }

    /// Goes on with the take of `scene` after the frames of `entries`.
    pub(super) fn with(folder: &Folder, scene: &Scene, entries: Vec<FrameEntry>) -> Self {
        let (settings, cell_size) = (scene.take, scene.cell_size);
        Self { folder: folder.clone(), settings, cell_size, entries, at_rest: None }
    }

    /// The particles that the take holds of a frame, rising; none: all. How they move does not matter.
    pub fn chosen(&self, frame: &Frame) -> Option<Vec<usize>> {
        chosen(frame, self.settings, self.cell_size)
    }

    /// What the take holds of a frame of [`TakeWriter::chosen`] particles: the frame that can be read of it.
    pub fn held(&self, frame: Frame) -> Frame {
        rounded(frame, self.settings)
    }

    /// Writes what [`TakeWriter::held`] has left of a frame, its rows of the tables, and the line that lists it; when
    /// this returns it outlives a power cut. A frame that is listed already has to be the same.
    ///
    /// `state`: that of the solver at this frame, for [`TakeWriter::open`]. It is on the disk before the frame is
    /// listed, so that a take with all its frames has its last state, too.
    ///
    /// # Errors
    /// When the folder cannot be written; the frames so far stay readable. When the frame is not the one that is
    /// listed.
    pub fn write_frame(&mut self, frame: &Frame, state: Option<&[u8]>) -> Result<(), TakeError> {
        let contents = self.contents(frame)?;
        let files: Vec<_> = contents.iter().map(|(name, bytes)| FileEntry::new(name, bytes)).collect();
        if let Ok(at) = self.entries.binary_search_by_key(&frame.number, |entry| entry.number) {
            self.compare(at, &files, &contents)?;
            return state.map_or(Ok(()), |state| self.write_state(state, frame.number));
        }
        if let Some(last) = self.newest().filter(|last| last.checked_add(1) != Some(frame.number)) {
            return Err(TakeError::OutOfOrder { number: frame.number, last });
        }
        for (name, _) in &contents {
            // One that is there but not listed was written just before a death.
            if self.folder.read(name)?.is_some_and(|there| !there.is_empty() && !is_ours(&there)) {
                return Err(TakeError::Foreign { path: self.folder.place(name)? });
            }
        }
        contents.iter().try_for_each(|(name, bytes)| self.folder.write(name, bytes))?;
        self.folder.sync()?;
        if let Some(state) = state {
            self.write_state(state, frame.number)?;
        }
        let rows = tables::append(&self.folder, frame)?;
        let entry = FrameEntry { number: frame.number, time: frame.time, files, rows };
        list::append(&self.folder, &entry)?;
        self.entries.push(entry);
        Ok(())
    }

    /// The files of a frame, each with its bytes, that of the frame itself first. The first frame has one more, of what
    /// its particles are at rest, which frames with the same particles then leave out.
    fn contents(&mut self, frame: &Frame) -> Result<Vec<(String, Vec<u8>)>, TakeError> {
        let bad = |cause| TakeError::BadFrame { number: frame.number, cause };
        let is_first = self.entries.first().is_none_or(|first| first.number == frame.number);
        if is_first {
            self.at_rest = Some(ParticlesAtRest::of(&frame.particles));
        } else if self.at_rest.is_none() {
            self.at_rest = frame_file::read_at_rest(&self.folder, &self.entries)?;
        }
        let bytes = frame_to_bytes(frame, self.settings.precision, self.at_rest.as_ref()).map_err(bad)?;
        let mut contents = vec![(list::file_name(frame.number), bytes)];
        if let Some(at_rest) = self.at_rest.as_ref().filter(|_| is_first) {
            contents.push((frame_file::AT_REST.to_owned(), at_rest.to_bytes().map_err(bad)?));
        }
        Ok(contents)
    }

    /// Holds a frame that was computed again against the one that is listed, and mends its files where these were
    /// changed.
    fn compare(&self, at: usize, files: &[FileEntry], contents: &[(String, Vec<u8>)]) -> Result<(), TakeError> {
        let entry = &self.entries[at];
        if entry.files != files {
            return Err(TakeError::OtherFrame { path: self.folder.path().into(), number: entry.number });
        }
        for (name, bytes) in contents {
            if self.folder.read(name)?.as_deref() != Some(bytes) {
                self.folder.write(name, bytes)?;
                self.folder.sync()?;
            }
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
