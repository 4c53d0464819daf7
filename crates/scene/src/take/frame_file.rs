//! The file of one frame, and that of what the particles of all frames are at rest.

use super::list::{self, FileEntry, FrameEntry};
use super::{ParticlesAtRest, TakeError, frame_from_bytes};
use crate::frame::Frame;
use fissure_files::Folder;

/// Name of the file of the particles at rest; the first frame lists it beside its own.
pub(super) const AT_REST: &str = "particles.safetensors";

/// The frame of `entry`, held against its checksum.
pub(super) fn read(folder: &Folder, entry: &FrameEntry, at_rest: Option<&ParticlesAtRest>) -> Result<Frame, TakeError> {
    // The list has been read with one file for each frame.
    let path = folder.place(&list::file_name(entry.number))?;
    let bytes = content(folder, &list::file_name(entry.number), entry.files.first())?;
    let frame = frame_from_bytes(&bytes, at_rest).map_err(|cause| TakeError::damaged_frame(&path, cause))?;
    if frame.number != entry.number {
        return Err(TakeError::damaged_frame(&path, format!("it holds frame {}", frame.number)));
    }
    Ok(frame)
}

/// What the particles of the frames of `entries` are at rest, held against its checksum; none where each frame says so
/// itself.
pub(super) fn read_at_rest(folder: &Folder, entries: &[FrameEntry]) -> Result<Option<ParticlesAtRest>, TakeError> {
    let files = entries.first().map_or(&[][..], |first| &first.files);
    let Some(file) = files.iter().find(|file| file.name == AT_REST) else { return Ok(None) };
    let bytes = content(folder, AT_REST, Some(file))?;
    let path = folder.place(AT_REST)?;
    ParticlesAtRest::from_bytes(&bytes).map(Some).map_err(|cause| TakeError::damaged_frame(&path, cause))
}

/// The bytes of a file, which have to be what `entry` says.
fn content(folder: &Folder, name: &str, entry: Option<&FileEntry>) -> Result<Vec<u8>, TakeError> {
    let path = folder.place(name)?;
    let bytes = folder.read(name)?.ok_or_else(|| TakeError::damaged_frame(&path, "it is missing"))?;
    if !entry.is_some_and(|entry| entry.fits(&bytes)) {
        return Err(TakeError::damaged_frame(&path, "its checksum does not fit"));
    }
    Ok(bytes)
}
