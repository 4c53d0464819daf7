//! Mesh files of a sequence.

use crate::formats::{Shot, file_format, is_ours};
use crate::mesh::{Content, Mesh};
use crate::post::FrameMeshes;
use crate::record::{FileRecord, file_name};
use crate::write_error::WriteError;
use fissure_files::Folder;
use fissure_scene::{Format, Part};
use std::path::PathBuf;

/// Writes the meshes of one frame into `folder`, which must exist, one file per part and format:
/// `prefix.0001.glb` for the cracked body, `prefix_particles.0001.glb` and so on for other parts, so that each part is
/// a sequence of its own. A part with nothing in it gives a valid file with nothing in it: no sequence has gaps.
/// Each file is there whole or not at all; one that Fissure has not made is never replaced.
///
/// # Errors
/// At the first file that cannot be written.
pub fn write_frame(
    folder: &Folder,
    prefix: &str,
    meshes: &FrameMeshes,
    formats: &[Format],
) -> Result<Vec<FileRecord>, WriteError> {
    let mut records = Vec::with_capacity(formats.len() * meshes.parts.len());
    for (part, objects) in &meshes.parts {
        let shot = Shot { objects, provenance: &meshes.provenance, up: meshes.up };
        for &format in formats {
            let file = file_name(prefix, *part, meshes.provenance.frame, format);
            let path = folder.place(&file)?;
            let bytes =
                file_format(format).frame(&shot).map_err(|cause| WriteError::Format { file: file.clone(), cause })?;
            if folder.read(&file)?.is_some_and(|there| !is_ours(format, &there)) {
                return Err(WriteError::Foreign { path });
            }
            // The take is what outlives a power cut; meshes are made of it again.
            folder.write_unsynced(&file, &bytes)?;
            records.push(record(file, path, *part, format, meshes, objects));
        }
    }
    Ok(records)
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
