//! `state.bin`: the solver's state at a frame, whole or not at all.

use super::error::TakeError;
use fissure_files::Folder;
use sha2::{Digest, Sha256};

/// Name of the file.
pub(super) const NAME: &str = "state.bin";
const MAGIC: &[u8; 16] = b"fissure-state-2\n";

/// A state to go on from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SavedState {
    /// The frame it belongs to.
    pub frame: i64,
    /// What the solver saved.
    pub bytes: Vec<u8>,
}

/// Layout: magic, SHA-256 of all that follows, frame number, the state.
pub(super) fn write(folder: &Folder, state: &[u8], frame: i64) -> Result<(), TakeError> {
    let mut bytes = Vec::with_capacity(MAGIC.len() + 32 + 8 + state.len());
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&Sha256::new().chain_update(frame.to_le_bytes()).chain_update(state).finalize());
    bytes.extend_from_slice(&frame.to_le_bytes());
    bytes.extend_from_slice(state);
    folder.write(NAME, &bytes)?;
    Ok(folder.sync()?)
}

/// The saved state; none when there is no file.
pub(super) fn read(folder: &Folder) -> Result<Option<SavedState>, TakeError> {
    let path = folder.place(NAME)?;
    let Some(bytes) = folder.read(NAME)? else { return Ok(None) };
    let damaged = |cause| TakeError::damaged_state(&path, cause);
    let body = bytes.strip_prefix(MAGIC).ok_or_else(|| damaged("it does not begin as a state"))?;
    let (digest, rest) = body.split_first_chunk::<32>().ok_or_else(|| damaged("it is cut off"))?;
    let (frame, state) = rest.split_first_chunk::<8>().ok_or_else(|| damaged("it is cut off"))?;
    if Sha256::digest(rest).as_slice() != digest {
        return Err(damaged("its checksum does not fit"));
    }
    Ok(Some(SavedState { frame: i64::from_le_bytes(*frame), bytes: state.to_vec() }))
}
