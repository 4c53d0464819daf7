//! Why files cannot be written.

use crate::formats::FormatError;
use fissure_files::FileError;
use std::path::PathBuf;

/// Why a mesh or the list of meshes cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The file system refused.
    #[error(transparent)]
    File(#[from] FileError),
    /// There is a file in the way that Fissure has not made.
    #[error("`{}` was not made by Fissure and stays as it is", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// The meshes do not fit into the format.
    #[error("cannot write `{file}`: {cause}")]
    Format {
        /// The file.
        file: String,
        /// Why.
        cause: FormatError,
    },
    /// The list cannot be written as JSON.
    #[error("cannot write the list of meshes: {0}")]
    Json(#[from] serde_json::Error),
}

impl WriteError {
    /// What the user can do about it.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::File(error) => error.remedy(),
            Self::Foreign { .. } => "move it away, or choose another folder with --output",
            Self::Format { cause, .. } => cause.remedy(),
            Self::Json(_) => "please report it with the scene file",
        }
    }
}
