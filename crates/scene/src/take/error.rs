//! What can go wrong with a take.

use std::io;
use std::path::{Path, PathBuf};

/// Why a take cannot be written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TakeError {
    /// The file system refused.
    #[error("cannot {doing} {}: {cause}; {}", path.display(), remedy_for(cause))]
    Io {
        /// What was tried: read, write, ...
        doing: &'static str,
        /// File or folder.
        path: PathBuf,
        /// What the system says.
        cause: io::Error,
    },
    /// The folder holds no take.
    #[error("{} is not a take: {cause}; name a folder that `fissure sim` or `fissure run` wrote", path.display())]
    NotATake {
        /// Folder or manifest.
        path: PathBuf,
        /// Why not.
        cause: String,
    },
    /// The take is of a version that this program does not read.
    #[error("{} is a take of version {found}, this program reads version {}; use the program that wrote it, or simulate again", path.display(), Manifest::VERSION)]
    Version {
        /// The manifest.
        path: PathBuf,
        /// Its version.
        found: u64,
    },
    /// A file is truncated or changed.
    #[error("{} is damaged: {cause}; simulate again, or copy the take anew", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        cause: String,
    },
    /// The take does not have a frame.
    #[error("{} has no frame {number}, its frames are {have}; choose one of them", path.display())]
    NoFrame {
        /// The take.
        path: PathBuf,
        /// The frame asked for.
        number: i64,
        /// What there is, in words.
        have: String,
    },
    /// A take cannot go on with another scene.
    #[error("{} was made from another scene or other overrides; go on with the same ones, or write to another folder", path.display())]
    OtherScene {
        /// The take.
        path: PathBuf,
    },
}

use super::Manifest;

impl TakeError {
    /// For `map_err`: the file system refused to do something to `path`.
    pub(crate) fn io(doing: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_path_buf();
        move |cause| Self::Io { doing, path, cause }
    }

    pub(crate) fn damaged(path: &Path, cause: impl ToString) -> Self {
        Self::Damaged { path: path.into(), cause: cause.to_string() }
    }
}

fn remedy_for(cause: &io::Error) -> &'static str {
    match cause.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => "free some space; the frames so far are kept",
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => "choose a folder you may write to",
        io::ErrorKind::NotFound => "check the path",
        io::ErrorKind::NotADirectory | io::ErrorKind::AlreadyExists => "a file is in the way: choose another folder",
        _ => "check the path, its permissions and the disk",
    }
}
