//! How a take goes on, from whatever is there.
//!
//! | what is there | what happens |
//! |---|---|
//! | no folder, an empty one, one in which no manifest has been written yet | it begins |
//! | something else's files | error, nothing is touched |
//! | another scene, another version of the program with frames still to come | error, nothing is touched |
//! | all frames that are wanted | nothing is left to do |
//! | a saved state | the solver goes on with its frame; those from it on are computed again and compared |
//! | no saved state yet, or a frame whose file is missing | as from the first frame; what is there is compared |
//! | a saved state that is damaged, or of a frame that is not there | error, nothing is touched |
//! | a last line of the list that was not written to its end | it goes |
//! | tables that are torn or changed | they are made anew from the frames |
//! | an edited scene that computes the same | the manifest gets the scene as it is now |

use super::list::{self, List};
use super::remark::Remark;
use super::write::TakeWriter;
use super::{Manifest, Provenance, SavedState, TakeError, state, tables};
use crate::scene::Scene;
use fissure_files::Folder;

/// A take that is ready to be written.
#[derive(Debug)]
pub struct Opened {
    /// Writes it.
    pub writer: TakeWriter,
    /// Where the solver begins.
    pub start: Start,
    /// What was found and is worth telling.
    pub remarks: Vec<Remark>,
}

/// Where the solver begins.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Start {
    /// With the first frame.
    First,
    /// With the frame of a saved state, which is listed or is the next to be.
    At(SavedState),
    /// Nowhere: all frames that are wanted are there.
    Complete,
}

impl TakeWriter {
    /// Opens the take of `scene` in `folder` to write the frames up to `last`: goes on with what is there, or begins
    /// it. For who is the only one to write to the folder; see [`fissure_files::Lock`].
    ///
    /// # Errors
    /// When the folder holds something that is no take or cannot go on as it is; nothing has been touched then. When
    /// the folder cannot be written.
    pub fn open(folder: &Folder, scene: &Scene, provenance: Provenance, last: i64) -> Result<Opened, TakeError> {
        if Manifest::is_there(folder)?.is_none() {
            let writer = Self::begin(folder, scene, provenance)?;
            return Ok(Opened { writer, start: Start::First, remarks: Vec::new() });
        }
        let mut manifest = Manifest::read(folder)?;
        if manifest.version != Manifest::VERSION {
            return Err(TakeError::Version { path: folder.path().into(), found: manifest.version });
        }
        if manifest.scene_hash != scene.hash || manifest.seed != provenance.seed {
            return Err(TakeError::OtherScene { path: folder.path().into() });
        }
        let List { entries, torn } = list::read(folder, scene.frames.first)?;
        let mut remarks = Vec::new();
        let missing = first_missing(folder, &entries, last)?;
        let complete = missing.is_none() && entries.last().is_some_and(|newest| newest.number >= last);
        if !complete && manifest.tool_version != provenance.tool_version {
            return Err(TakeError::OtherTool {
                path: folder.path().into(),
                theirs: manifest.tool_version,
                ours: provenance.tool_version,
            });
        }
        let start = match (complete, state::read(folder)) {
            (true, Err(error @ TakeError::DamagedState { .. })) => {
                remarks.push(Remark::UnusableState(error.to_string()));
                Start::Complete
            }
            (true, saved) => saved.map(|_| Start::Complete)?,
            (false, saved) => start(folder, scene.frames.first, saved?, &entries, missing)?,
        };

        // All that can be refused has been: from here on the folder is written to.
        folder.remove_drafts()?;
        // It may also have been lost with the power before its first line came.
        if torn || entries.is_empty() {
            list::write(folder, &entries)?;
        }
        if manifest.scene != *scene {
            manifest.scene = scene.clone();
            manifest.write(folder)?;
        }
        match missing {
            // Tables are made of frames: they have to wait until all of these are back.
            Some(number) => remarks.push(Remark::MissingFrame(number)),
            None => remarks.extend(tables::repair(folder, &entries)?.into_iter().map(Remark::TableMadeAnew)),
        }
        folder.sync()?;
        Ok(Opened { writer: Self::with(folder, scene, entries), start, remarks })
    }
}

/// Where the solver begins when frames are to come. `missing`: the first frame that has no file.
fn start(
    folder: &Folder,
    first: i64,
    saved: Option<SavedState>,
    entries: &[list::FrameEntry],
    missing: Option<i64>,
) -> Result<Start, TakeError> {
    let Some(saved) = saved else { return Ok(Start::First) };
    let newest = entries.last().map_or(first - 1, |newest| newest.number);
    if !(first..=newest + 1).contains(&saved.frame) {
        let (path, have) = (folder.place(state::NAME)?, list::in_words(entries));
        return Err(TakeError::StrayState { path, frame: saved.frame, have });
    }
    let is_missing = missing.is_some_and(|missing| missing <= saved.frame);
    Ok(if is_missing { Start::First } else { Start::At(saved) })
}

/// The first frame up to `last` that has a file which is missing or has another length.
fn first_missing(folder: &Folder, entries: &[list::FrameEntry], last: i64) -> Result<Option<i64>, TakeError> {
    for entry in entries.iter().take_while(|entry| entry.number <= last) {
        for file in &entry.files {
            if folder.length(&file.name)? != Some(file.bytes) {
                return Ok(Some(entry.number));
            }
        }
    }
    Ok(None)
}
