//! The list of written files.

use crate::post::Provenance;
use crate::write::{WriteError, write_atomically};
use fissure_scene::{Format, Part};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// One written file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FileRecord {
    /// Name of the file within its folder.
    pub file: String,
    /// Where it lies.
    #[serde(skip)]
    pub path: PathBuf,
    /// What it shows.
    pub part: Part,
    /// Its format.
    pub format: Format,
    /// Frame number.
    pub frame: i64,
    /// Time [s].
    pub time: f64,
    /// Number of objects: fragments, cracks or colliders.
    pub pieces: usize,
    /// Number of vertices in the file's meshes.
    pub vertices: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Area of all solids in the drawing plane [m²].
    pub area: f64,
    /// Thickness of solids [m]; 0 where there are none.
    pub thickness: f64,
    /// Volume of all solids as the file holds them [m³].
    pub volume: f64,
}

/// Collects records in any order and lists them by frame and name.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Manifest {
    records: BTreeMap<(i64, String), FileRecord>,
}

/// The manifest as it is written.
#[derive(Serialize)]
struct Document<'a> {
    tool: &'a str,
    scene: &'a str,
    scene_hash: &'a str,
    files: Vec<&'a FileRecord>,
}

impl Manifest {
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
    /// When the file cannot be written.
    pub fn write(&self, folder: &Path, provenance: &Provenance) -> Result<PathBuf, WriteError> {
        let path = folder.join("manifest.json");
        let document = Document {
            tool: &provenance.tool,
            scene: &provenance.scene,
            scene_hash: &provenance.scene_hash,
            files: self.records().collect(),
        };
        let failed = |source: serde_json::Error| WriteError { path: path.clone(), reason: source.to_string() };
        let text = serde_json::to_string(&document).map_err(failed)?;
        // Records hold no nested objects, so each of these is the border between two of them.
        let lines = text.replace("{\"file\":", "\n{\"file\":");
        write_atomically(&path, format!("{lines}\n").as_bytes())?;
        Ok(path)
    }
}
