//! What is said of a mesh file: its name, and its line in the list.

use crate::formats::file_format;
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
    /// Area of all solids in the drawing plane [m²].
    pub area: f64,
    /// Thickness of solids [m]; 0 where there are none.
    pub thickness: f64,
    /// Volume of all solids as the file holds them [m³].
    pub volume: f64,
}

/// Name of the file of one part, frame and format.
pub fn file_name(prefix: &str, part: Part, frame: i64, format: Format) -> String {
    let suffix = match part {
        Part::Cracked => "",
        Part::Body => "_body",
        Part::Faces => "_faces",
        Part::Collider => "_collider",
        Part::Particles => "_particles",
    };
    let extension = file_format(format).extension(part);
    format!("{prefix}{suffix}.{frame:04}.{extension}")
}
