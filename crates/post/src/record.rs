//! What is said of a mesh file: its name, and its line in the list.

use crate::formats::{file_format, sequence_name};
use fissure_scene::{Format, Part};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// One written file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
    /// How wide edges between walls of cracks and caps are bevelled [m]; 0: not at all.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub bevel: f64,
    /// How far walls of cracks are moved to be rough, at most [m]; 0: not at all.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub roughness: f64,
    /// Area of all solids in the drawing plane [m²].
    pub area: f64,
    /// Thickness of solids [m]; 0 where there are none.
    pub thickness: f64,
    /// Volume of all solids as the file holds them [m³].
    pub volume: f64,
    /// The objects, in the order of the file.
    #[serde(default)]
    pub objects: Vec<ObjectRecord>,
}

/// What is not there is not listed.
fn is_zero(length: &f64) -> bool {
    *length == 0.0
}

/// One object of a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ObjectRecord {
    /// Its name.
    pub name: String,
    /// Fragment number of the simulation, or index of the crack or collider.
    pub piece: u32,
    /// Names of the materials of its triangles; none for points.
    pub materials: Vec<String>,
}

/// One written file that is about the whole sequence of a part.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SequenceRecord {
    /// Name of the file within its folder.
    pub file: String,
    /// What it shows.
    pub part: Part,
    /// Its format.
    pub format: Format,
    /// Number of the first frame in it.
    pub first: i64,
    /// Number of the last frame in it.
    pub last: i64,
    /// How many frames are in it.
    pub frames: usize,
}

/// Name of the file of one part, frame and format.
pub fn file_name(prefix: &str, part: Part, frame: i64, format: Format) -> String {
    let extension = file_format(format).extension(part);
    format!("{}.{frame:04}.{extension}", sequence_name(prefix, part))
}
