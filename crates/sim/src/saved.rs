//! Saved states: compact bytes that give back the very same numbers.

use crate::SimulationError;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Serialises a state.
pub(crate) fn to_bytes<T: Serialize>(state: &T) -> Vec<u8> {
    // Plain data of known length always serialises; an empty state is refused when it is read.
    postcard::to_stdvec(state).unwrap_or_default()
}

/// Reads a state back.
///
/// # Errors
/// [`SimulationError::BadState`] when the bytes are not such a state.
pub(crate) fn from_bytes<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, SimulationError> {
    postcard::from_bytes(bytes)
        .map_err(|e| SimulationError::BadState(format!("it is damaged or of another version ({e})")))
}
