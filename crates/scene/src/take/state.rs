//! `state.bin`: the solver's state at a frame, whole or not at all.

use super::{TakeError, files};
use sha2::{Digest, Sha256};
use std::path::Path;

const MAGIC: &[u8; 16] = b"fissure-state-1\n";
const HEAD: usize = MAGIC.len() + 8 + 32;

/// A state to go on from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SavedState {
    /// The frame it belongs to.
    pub frame: i64,
    /// What the solver saved.
    pub bytes: Vec<u8>,
}

/// Layout: magic, frame number, SHA-256 of the state, the state.
pub(crate) fn write(folder: &Path, state: &[u8], frame: i64) -> Result<(), TakeError> {
    let mut bytes = Vec::with_capacity(HEAD + state.len());
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&frame.to_le_bytes());
    bytes.extend_from_slice(&Sha256::digest(state));
    bytes.extend_from_slice(state);
    files::write_whole(&folder.join("state.bin"), &bytes)
}

/// The saved state; none when there is no file.
pub(crate) fn read(folder: &Path) -> Result<Option<SavedState>, TakeError> {
    let path = folder.join("state.bin");
    let bytes = match std::fs::read(&path) {
        Ok(bytes) => bytes,
        Err(cause) if cause.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(cause) => return Err(TakeError::io("read", &path)(cause)),
    };
    let body = bytes.strip_prefix(MAGIC).ok_or_else(|| TakeError::damaged(&path, "it does not begin as a state"))?;
    let (Some((frame, rest)), true) = (body.split_first_chunk::<8>(), bytes.len() >= HEAD) else {
        return Err(TakeError::damaged(&path, "it is cut off"));
    };
    let (digest, state) = rest.split_at(32);
    if Sha256::digest(state).as_slice() != digest {
        return Err(TakeError::damaged(&path, "its checksum does not fit"));
    }
    Ok(Some(SavedState { frame: i64::from_le_bytes(*frame), bytes: state.to_vec() }))
}
