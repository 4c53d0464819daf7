//! Why files cannot be written.

use crate::glb::GlbError;
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
    /// The meshes do not fit into a GLB file.
    #[error("cannot write `{file}`: {cause}")]
    Glb {
        /// The file.
        file: String,
        /// Why.
        cause: GlbError,
    },
    /// The meshes cannot be written as PLY.
    #[error("cannot write `{file}`: {cause}")]
    Ply {
        /// The file.
        file: String,
        /// Why.
        cause: std::io::Error,
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
            Self::Glb { .. } => "write PLY, or use a larger `grid.particle_spacing`",
            Self::Ply { .. } | Self::Json(_) => "please report it with the scene file",
        }
    }
}
