//! Mesh files of a sequence.

use crate::formats::{Listing, Shot, encode, file_format, is_ours, sequence, sequence_name};
use crate::manifest::Manifest;
use crate::mesh::{Content, Mesh};
use crate::post::FrameMeshes;
use crate::record::{FileRecord, ObjectRecord, SequenceRecord, file_name};
use crate::slot::Slot;
use crate::write_error::WriteError;
use fissure_files::Folder;
use fissure_scene::{Format, Frame, Part, Scene};
use std::path::PathBuf;

/// Writes the meshes of `frame` into `folder`, which must exist, one file per part and format that shows
/// it and has files of frames:
/// `pull.0001.glb` for the cracked body of the scene `pull`, `pull_particles.0001.glb` and so on for other parts, so
/// that each part is a sequence of its own. A part with nothing in it gives a valid file with nothing in it: no
/// sequence has gaps.
/// Each file is there whole or not at all; one that Fissure has not made is never replaced.
///
/// # Errors
/// At the first file that cannot be written.
pub fn write_frame(
    folder: &Folder,
    scene: &Scene,
    frame: &Frame,
    meshes: &FrameMeshes,
    formats: &[Format],
) -> Result<Vec<FileRecord>, WriteError> {
    let mut records = Vec::with_capacity(formats.len() * meshes.parts.len());
    for shot in meshes.shots(scene, frame) {
        let own = |format: &&Format| format.shows(shot.part) && sequence(**format).is_none();
        let solids = shot.objects.iter().filter(|mesh| matches!(mesh.content, Content::Solid { .. }));
        let volume = solids.map(Mesh::volume).sum();
        for &format in formats.iter().filter(own) {
            let file = file_name(&scene.name, shot.part, meshes.provenance.frame, format);
            let path = folder.place(&file)?;
            let bytes = encode(format, &shot).map_err(|cause| WriteError::Format { file: file.clone(), cause })?;
            write(folder, &file, format, &bytes)?;
            let of_cracks = if shot.part == Part::Cracked { [meshes.bevel, meshes.roughness] } else { [0.0; 2] };
            records.push(FileRecord { path, volume, ..record(file, format, of_cracks, &shot) });
        }
    }
    Ok(records)
}

/// Writes the files that go with those of the frames: of each part and format those that all frames refer to, or that
/// play them. They are about all frames that `manifest` lists, and join the list.
///
/// # Errors
/// At the first file that cannot be written.
pub fn write_companions(folder: &Folder, scene: &Scene, tool: &str, manifest: &mut Manifest) -> Result<(), WriteError> {
    for (part, format) in manifest.kinds() {
        let records: Vec<&FileRecord> =
            manifest.records().filter(|record| (record.part, record.format) == (part, format)).collect();
        let (Some(first), Some(last)) = (records.first(), records.last()) else { continue };
        let (first, last, frames) = (first.frame, last.frame, records.len());
        let name = sequence_name(&scene.name, part);
        let files = file_format(format).companions(&Listing { scene, tool, name: &name, records: &records });
        for (file, bytes) in files {
            write(folder, &file, format, &bytes)?;
            manifest.add_sequence(SequenceRecord { file, part, format, first, last, frames });
        }
    }
    Ok(())
}

/// Writes a file, unless there is one that is not ours.
pub(crate) fn write(folder: &Folder, file: &str, format: Format, bytes: &[u8]) -> Result<(), WriteError> {
    if folder.read(file)?.is_some_and(|there| !is_ours(format, &there)) {
        return Err(WriteError::Foreign { path: folder.place(file)? });
    }
    // The take is what outlives a power cut; meshes are made of it again.
    Ok(folder.write_unsynced(file, bytes)?)
}

/// What is said of a file but its place and volume; `of_cracks`: width of bevels and amplitude of roughness [m].
fn record(file: String, format: Format, [bevel, roughness]: [f64; 2], shot: &Shot<'_>) -> FileRecord {
    let objects = shot.objects;
    let solids = || {
        objects.iter().filter_map(|m| {
            if let Content::Solid { area, thickness, .. } = m.content { Some((area, thickness)) } else { None }
        })
    };
    FileRecord {
        file,
        path: PathBuf::new(),
        part: shot.part,
        format,
        frame: shot.provenance.frame,
        time: shot.provenance.time,
        pieces: objects.len(),
        vertices: objects.iter().map(|m| m.vertices.len()).sum(),
        triangles: objects.iter().map(Mesh::triangle_count).sum(),
        area: solids().map(|(area, _)| area).sum(),
        thickness: solids().next().map_or(0.0, |(_, thickness)| thickness),
        bevel,
        roughness,
        volume: 0.0,
        objects: objects.iter().map(object_record).collect(),
    }
}

fn object_record(mesh: &Mesh) -> ObjectRecord {
    let used = Slot::ALL.into_iter().filter(|slot| !mesh.slot(*slot).is_empty());
    let materials = used.map(|slot| slot.name().to_owned()).collect();
    ObjectRecord { name: mesh.name.clone(), piece: mesh.piece, materials }
}
