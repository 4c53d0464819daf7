//! Why meshes do not fit into a file format.

/// Why a file cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    /// Binary glTF counts bytes in 32 bits.
    #[error("the file would take {0} bytes, more than the 4 GiB a GLB file can hold; write PLY or fewer particles")]
    TooLarge(usize),
    /// A file of a whole sequence without any frame.
    #[error("there are no frames to make a sequence of")]
    NoFrames,
    /// The document could not be written as JSON.
    #[error("the glTF document cannot be written as JSON: {0}")]
    Json(#[from] gltf::json::Error),
    /// The two parts of a binary glTF file could not be joined.
    #[error("the glTF document and its data cannot be joined to a GLB file: {0}")]
    Container(#[from] gltf::Error),
    /// The writer refused, which for a buffer in memory means a mistake of ours.
    #[error("cannot be made: {0}")]
    Writer(#[from] std::io::Error),
}

impl FormatError {
    /// What the user can do about it.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::TooLarge(_) => "write PLY or fewer `--frames`, or use a larger `grid.particle_spacing`",
            Self::NoFrames => "ask for frames that the take has",
            Self::Json(_) | Self::Container(_) | Self::Writer(_) => "please report it with the scene file",
        }
    }
}
