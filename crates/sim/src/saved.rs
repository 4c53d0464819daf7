//! Saved states: compact bytes that give back the very same numbers, and checks of what is read back.
//!
//! The solvers index their arrays by numbers of a state, so a state that was tampered with, or is of another build, has
//! to be looked through before it is used.

use crate::SimulationError;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// What a check of a read state says: it fits, or [`SimulationError::BadState`].
pub(crate) type Fits = Result<(), SimulationError>;

/// Serialises a state.
///
/// # Errors
/// [`SimulationError::NotSaved`] when it cannot be.
pub(crate) fn to_bytes<T: Serialize>(state: &T) -> Result<Vec<u8>, SimulationError> {
    postcard::to_stdvec(state).map_err(|e| SimulationError::NotSaved(e.to_string()))
}

/// Reads a state back.
///
/// # Errors
/// [`SimulationError::BadState`] when the bytes are not such a state.
pub(crate) fn from_bytes<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, SimulationError> {
    let bad = |why: &str| SimulationError::BadState(format!("it is damaged or of another version ({why})"));
    match postcard::take_from_bytes(bytes) {
        Ok((state, [])) => Ok(state),
        Ok((_, rest)) => Err(bad(&format!("{} bytes too many", rest.len()))),
        Err(e) => Err(bad(&e.to_string())),
    }
}

/// Checks that something `fits`. `what`: what it is, in words.
///
/// # Errors
/// [`SimulationError::BadState`]
pub(crate) fn ensure(fits: bool, what: &str) -> Fits {
    if fits { Ok(()) } else { Err(SimulationError::BadState(format!("{what} does not fit the rest of it"))) }
}

/// Checks that all `values` are finite.
///
/// # Errors
/// [`SimulationError::BadState`]
pub(crate) fn finite<'a>(what: &str, values: impl IntoIterator<Item = &'a f64>) -> Fits {
    match values.into_iter().find(|value| !value.is_finite()) {
        Some(value) => Err(SimulationError::BadState(format!("{what} holds the number {value}"))),
        None => Ok(()),
    }
}

/// Checks that all `numbers` count something of which there are `count`.
///
/// # Errors
/// [`SimulationError::BadState`]
pub(crate) fn below(what: &str, numbers: impl IntoIterator<Item = u32>, count: usize) -> Fits {
    match numbers.into_iter().find(|&number| number as usize >= count) {
        Some(number) => Err(SimulationError::BadState(format!("{what} names number {number} of {count}"))),
        None => Ok(()),
    }
}
