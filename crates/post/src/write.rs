//! Mesh files of a sequence.

use crate::glb::to_glb;
use crate::manifest::FileRecord;
use crate::mesh::{Content, Mesh};
use crate::ply::to_ply;
use crate::post::FrameMeshes;
use fissure_scene::{Format, Part};
use std::path::{Path, PathBuf};

/// Why a file could not be written.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("cannot write {}: {reason}", path.display())]
pub struct WriteError {
    /// Which file.
    pub path: PathBuf,
    /// Why.
    pub reason: String,
}

/// Writes the meshes of one frame into `folder`, which must exist, one file per part and format:
/// `prefix.0001.glb` for the cracked body, `prefix_particles.0001.glb` and so on for other parts, so that each part is
/// a sequence of its own. A part with nothing in it gives a valid file with nothing in it: no sequence has gaps.
/// Each file is written to a temporary name and renamed.
///
/// # Errors
/// At the first file that cannot be written.
pub fn write_frame(
    folder: &Path,
    prefix: &str,
    meshes: &FrameMeshes,
    formats: &[Format],
) -> Result<Vec<FileRecord>, WriteError> {
    let mut records = Vec::with_capacity(formats.len() * meshes.parts.len());
    for (part, objects) in &meshes.parts {
        for &format in formats {
            let file = file_name(prefix, *part, meshes.provenance.frame, format);
            let path = folder.join(&file);
            let failed = |reason: String| WriteError { path: path.clone(), reason };
            let bytes = match format {
                Format::Glb => to_glb(objects, &meshes.provenance).map_err(|e| failed(e.to_string()))?,
                Format::Ply => to_ply(objects, &meshes.provenance, meshes.up).map_err(|e| failed(e.to_string()))?,
            };
            write_atomically(&path, &bytes)?;
            records.push(record(file, path, *part, format, meshes, objects));
        }
    }
    Ok(records)
}

/// Name of the file of one part, frame and format.
pub fn file_name(prefix: &str, part: Part, frame: i64, format: Format) -> String {
    let part = match part {
        Part::Cracked => "",
        Part::Body => "_body",
        Part::Faces => "_faces",
        Part::Collider => "_collider",
        Part::Particles => "_particles",
    };
    let extension = match format {
        Format::Glb => "glb",
        Format::Ply => "ply",
    };
    format!("{prefix}{part}.{frame:04}.{extension}")
}

fn record(
    file: String,
    path: PathBuf,
    part: Part,
    format: Format,
    meshes: &FrameMeshes,
    objects: &[Mesh],
) -> FileRecord {
    let solids = || {
        objects.iter().filter_map(|m| {
            if let Content::Solid { area, thickness } = m.content { Some((area, thickness, m)) } else { None }
        })
    };
    FileRecord {
        file,
        path,
        part,
        format,
        frame: meshes.provenance.frame,
        time: meshes.provenance.time,
        pieces: objects.len(),
        vertices: objects.iter().map(|m| m.vertices.len()).sum(),
        triangles: objects.iter().map(Mesh::triangle_count).sum(),
        area: solids().map(|(area, _, _)| area).sum(),
        thickness: solids().next().map_or(0.0, |(_, thickness, _)| thickness),
        volume: solids().map(|(_, _, mesh)| mesh.volume()).sum(),
    }
}

/// Writes `bytes` beside `path` and renames, so that nobody ever sees half a file.
pub(crate) fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    let temporary = path.with_file_name(name);
    let failed = |source: std::io::Error| WriteError { path: path.to_owned(), reason: source.to_string() };
    std::fs::write(&temporary, bytes).and_then(|()| std::fs::rename(&temporary, path)).map_err(|source| {
        // What is left of the attempt is of no use; that it may not exist is no second error.
        let _ = std::fs::remove_file(&temporary);
        failed(source)
    })
}
