//! What can go wrong with a take.

use super::Manifest;
use super::tensors::FrameFileError;
use fissure_files::FileError;
use std::path::{Path, PathBuf};

/// Why a take cannot be written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TakeError {
    /// The file system refused.
    #[error(transparent)]
    File(#[from] FileError),
    /// The folder holds no take.
    #[error("`{}` is not a take: {cause}", path.display())]
    NotATake {
        /// Folder or manifest.
        path: PathBuf,
        /// Why not.
        cause: String,
    },
    /// The take is of a version that this program does not read, or does not go on with.
    #[error(
        "`{}` is a take of version {found}, this program reads the versions {} to {} and goes on with {}",
        path.display(),
        Manifest::OLDEST,
        Manifest::VERSION,
        Manifest::VERSION
    )]
    Version {
        /// The take or its manifest.
        path: PathBuf,
        /// Its version.
        found: u64,
    },
    /// The manifest or the list of frames is not as it was written.
    #[error("`{}` is damaged: {cause}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        cause: String,
    },
    /// The file of a frame is not as it was written.
    #[error("`{}` is damaged: {cause}", path.display())]
    DamagedFrame {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        cause: String,
    },
    /// The saved state is not as it was written.
    #[error("`{}` is damaged: {cause}", path.display())]
    DamagedState {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        cause: String,
    },
    /// The saved state belongs to a frame that the take does not have.
    #[error("`{}` is the state at frame {frame}, but the take holds {have}", path.display())]
    StrayState {
        /// The file.
        path: PathBuf,
        /// Its frame.
        frame: i64,
        /// What there is, in words.
        have: String,
    },
    /// The take does not have a frame.
    #[error("`{}` has no frame {number}, it holds {have}", path.display())]
    NoFrame {
        /// The take.
        path: PathBuf,
        /// The frame asked for.
        number: i64,
        /// What there is, in words.
        have: String,
    },
    /// A take cannot go on with another scene.
    #[error("`{}` is a take of another scene, or of this one with other settings", path.display())]
    OtherScene {
        /// The take.
        path: PathBuf,
    },
    /// A take cannot go on with another version of the program, which may compute other numbers.
    #[error("`{}` was begun by version {theirs} of this program, which is version {ours} and may compute other numbers", path.display())]
    OtherTool {
        /// The take.
        path: PathBuf,
        /// The version that began it.
        theirs: String,
        /// The version that was to go on.
        ours: String,
    },
    /// A frame that was computed again is not the one that is there.
    #[error("frame {number} is not the one that `{}` holds: it was computed by another build of the program or on a machine that rounds otherwise", path.display())]
    OtherFrame {
        /// The take.
        path: PathBuf,
        /// The frame.
        number: i64,
    },
    /// A file that is no part of a take has the name that one would get.
    #[error("`{}` is in the way: it is not of this take", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// A frame that no take can hold.
    #[error("frame {number} cannot be written: {cause}")]
    BadFrame {
        /// The frame.
        number: i64,
        /// Why.
        cause: FrameFileError,
    },
    /// A frame that does not follow the last one.
    #[error("frame {number} cannot be written: it does not follow frame {last}")]
    OutOfOrder {
        /// The frame.
        number: i64,
        /// The newest frame of the take.
        last: i64,
    },
}

impl TakeError {
    /// What the user can do about it.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::File(error) => error.remedy(),
            Self::NotATake { .. } => {
                "name a folder that `fissure sim` or `fissure run` wrote; to write a take, choose another --output"
            }
            Self::Version { .. } => "use the program that wrote it, or simulate again with --overwrite",
            Self::Damaged { .. } => "copy the take anew, or simulate again with --overwrite",
            Self::DamagedFrame { .. } => {
                "copy it anew, or remove this file and `fissure run` the scene again: what is missing is computed anew"
            }
            Self::DamagedState { .. } | Self::StrayState { .. } => {
                "the frames are still there; remove the state and run again: all is computed anew from the first frame and compared \
                 with the frames that are there. Or start afresh with --overwrite"
            }
            Self::NoFrame { .. } => "choose among them",
            Self::OtherScene { .. } => "start afresh with --overwrite, or keep it and write elsewhere with --output",
            Self::OtherTool { .. } => {
                "go on with that version, or start afresh with --overwrite; `fissure post` makes meshes of the frames that are there"
            }
            Self::OtherFrame { .. } => {
                "keep the take and write elsewhere with --output, or start afresh with --overwrite"
            }
            Self::Foreign { .. } => "move it away, or choose another folder with --output",
            Self::BadFrame { .. } | Self::OutOfOrder { .. } => "please report it with the scene file",
        }
    }

    pub(super) fn damaged(path: &Path, cause: impl ToString) -> Self {
        Self::Damaged { path: path.into(), cause: cause.to_string() }
    }

    pub(super) fn damaged_frame(path: &Path, cause: impl ToString) -> Self {
        Self::DamagedFrame { path: path.into(), cause: cause.to_string() }
    }

    pub(super) fn damaged_state(path: &Path, cause: impl ToString) -> Self {
        Self::DamagedState { path: path.into(), cause: cause.to_string() }
    }
}
