//! The file of one frame.

use super::list::{self, FrameEntry};
use super::{TakeError, frame_from_bytes};
use crate::frame::Frame;
use fissure_files::Folder;

/// The frame of `entry`, held against its checksum.
pub(super) fn read(folder: &Folder, entry: &FrameEntry) -> Result<Frame, TakeError> {
    // The list has been read with one file for each frame.
    let (file, name) = (entry.files.first(), list::file_name(entry.number));
    let path = folder.place(&name)?;
    let bytes = folder.read(&name)?.ok_or_else(|| TakeError::damaged_frame(&path, "it is missing"))?;
    if !file.is_some_and(|file| file.fits(&bytes)) {
        return Err(TakeError::damaged_frame(&path, "its checksum does not fit"));
    }
    let frame = frame_from_bytes(&bytes).map_err(|cause| TakeError::damaged_frame(&path, cause))?;
    if frame.number != entry.number {
        return Err(TakeError::damaged_frame(&path, format!("it holds frame {}", frame.number)));
    }
    Ok(frame)
}
