//! Why a frame cannot be written as bytes, or bytes are no frame.

use crate::frame_check::FrameFault;
use safetensors::tensor::Dtype;

/// Why a frame cannot be written as bytes, or bytes are no frame.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FrameFileError {
    /// The frame is not sound.
    #[error(transparent)]
    Frame(#[from] FrameFault),
    /// The format does not take it.
    #[error("it cannot be written as safetensors: {0}")]
    NotWritten(String),
    /// The bytes are not of the format, or cut off.
    #[error("it is not a whole safetensors file ({0})")]
    NotWhole(String),
    /// A tensor is missing.
    #[error("it has no tensor `{0}`")]
    Missing(String),
    /// A tensor is of another type.
    #[error("its tensor `{tensor}` is of type {found:?}, not {expected:?}")]
    Type {
        /// Name of the tensor.
        tensor: String,
        /// Its type.
        found: Dtype,
        /// The type it should have.
        expected: Dtype,
    },
    /// A tensor of vectors or matrices has a number of components that does not go up.
    #[error("its tensor `{tensor}` is not in groups of {of}")]
    Groups {
        /// Name of the tensor.
        tensor: String,
        /// Components of one of them.
        of: usize,
    },
    /// A tensor is not a single number.
    #[error("its tensor `{0}` is no single number")]
    NotOne(String),
    /// Offsets do not rise from the first to the last point.
    #[error("its tensor `{tensor}` does not divide {length} points")]
    Division {
        /// Name of the tensor.
        tensor: String,
        /// Number of points.
        length: usize,
    },
    /// Tensors that belong together differ in length.
    #[error("its {0} tensors differ in length")]
    Lengths(&'static str),
    /// A crack has an end that there is not.
    #[error("a crack has the end {0}")]
    CrackEnd(i64),
    /// A tip has a state that there is not.
    #[error("a tip has the state {0}")]
    TipState(u32),
}
