//! The list of written files.

use crate::formats::{TOOL, is_ours, sequence_name};
use crate::provenance::Provenance;
use crate::record::{FileRecord, SequenceRecord, file_name};
use crate::write_error::WriteError;
use fissure_files::Folder;
use fissure_scene::{Format, Part};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Name of the list.
const NAME: &str = "manifest.json";

/// Collects records in any order and lists them by frame and name.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Manifest {
    records: BTreeMap<(i64, String), FileRecord>,
    /// By file name.
    sequences: BTreeMap<String, SequenceRecord>,
}

/// The manifest as it is written.
#[derive(Serialize)]
struct Document<'a> {
    tool: &'a str,
    scene: &'a str,
    scene_hash: &'a str,
    files: Vec<&'a FileRecord>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    sequences: Vec<&'a SequenceRecord>,
}

/// The manifest as it is read.
#[derive(Deserialize)]
struct OldDocument {
    tool: String,
    scene: String,
    scene_hash: String,
    files: Vec<FileRecord>,
    #[serde(default)]
    sequences: Vec<SequenceRecord>,
}

impl Manifest {
    /// The list in `folder` of meshes of this scene that are still there; an empty one when there is none or it is of
    /// another scene.
    ///
    /// # Errors
    /// When there is a `manifest.json` that Fissure has not made, or it cannot be read.
    pub fn read(folder: &Folder, scene: &str, scene_hash: &str) -> Result<Self, WriteError> {
        let mut manifest = Self::default();
        let Some(old) = read(folder)?.filter(|old| old.scene == scene && old.scene_hash == scene_hash) else {
            return Ok(manifest);
        };
        for mut record in old.files {
            // A name that is no plain one is not of ours either.
            let Ok(path) = folder.place(&record.file) else { continue };
            if folder.length(&record.file)?.is_some() {
                record.path = path;
                manifest.add([record]);
            }
        }
        for record in old.sequences {
            if folder.place(&record.file).is_ok() && folder.length(&record.file)?.is_some() {
                manifest.add_sequence(record);
            }
        }
        Ok(manifest)
    }

    /// Removes the meshes of the scene `scene` that the list in `folder` holds and that say themselves that Fissure
    /// made them, and the list. All other files stay.
    ///
    /// # Errors
    /// When the list is not one of Fissure's, or a file cannot be removed.
    pub fn remove_meshes(folder: &Folder, scene: &str) -> Result<(), WriteError> {
        let Some(old) = read(folder)? else { return Ok(()) };
        for record in old.files {
            let name = file_name(scene, record.part, record.frame, record.format);
            if name == record.file && folder.read(&name)?.is_some_and(|there| is_ours(record.format, &there)) {
                folder.remove(&name)?;
            }
        }
        for record in old.sequences {
            let name = sequence_name(scene, record.part);
            let is_named_so = record.file.strip_prefix(&name).is_some_and(|rest| rest.starts_with('.'));
            let is_plain = folder.place(&record.file).is_ok();
            let is_there = || folder.read(&record.file);
            if is_named_so && is_plain && is_there()?.is_some_and(|there| is_ours(record.format, &there)) {
                folder.remove(&record.file)?;
            }
        }
        Ok(folder.remove(NAME)?)
    }

    /// Adds a file about the whole sequence; one of the same name replaces the earlier.
    pub(crate) fn add_sequence(&mut self, record: SequenceRecord) {
        self.sequences.insert(record.file.clone(), record);
    }

    /// Parts and formats of all files, each pair once.
    pub(crate) fn kinds(&self) -> Vec<(Part, Format)> {
        let mut kinds = Vec::new();
        for record in self.records.values() {
            if !kinds.contains(&(record.part, record.format)) {
                kinds.push((record.part, record.format));
            }
        }
        kinds
    }

    /// Adds records; one of the same frame and file name replaces the earlier.
    pub fn add(&mut self, records: impl IntoIterator<Item = FileRecord>) {
        self.records.extend(records.into_iter().map(|record| ((record.frame, record.file.clone()), record)));
    }

    /// All records, by frame, then by file name.
    pub fn records(&self) -> impl Iterator<Item = &FileRecord> {
        self.records.values()
    }

    /// Writes `manifest.json` into `folder`: the same bytes whatever order the records came in. One line per file.
    ///
    /// # Errors
    /// When there is one that Fissure has not made, or the file cannot be written.
    pub fn write(&self, folder: &Folder, provenance: &Provenance) -> Result<PathBuf, WriteError> {
        read(folder)?;
        let document = Document {
            tool: &provenance.tool,
            scene: &provenance.scene,
            scene_hash: &provenance.scene_hash,
            files: self.records().collect(),
            sequences: self.sequences.values().collect(),
        };
        let text = serde_json::to_string(&document)?;
        // What records hold does not begin so: each of these is the border between two of them.
        let lines = text.replace("{\"file\":", "\n{\"file\":");
        folder.write(NAME, format!("{lines}\n").as_bytes())?;
        folder.sync()?;
        Ok(folder.place(NAME)?)
    }
}

/// The list that is in `folder`; none when there is none, or an empty file.
fn read(folder: &Folder) -> Result<Option<OldDocument>, WriteError> {
    let bytes = folder.read(NAME)?.filter(|bytes| !bytes.is_empty());
    let foreign = |path| WriteError::Foreign { path };
    let of = |bytes: Vec<u8>| {
        let document: Option<OldDocument> = serde_json::from_slice(&bytes).ok();
        document
            .filter(|document| document.tool.starts_with(TOOL))
            .ok_or_else(|| folder.path().join(NAME))
            .map_err(foreign)
    };
    bytes.map(of).transpose()
}
