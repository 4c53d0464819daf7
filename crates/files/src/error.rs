//! What can go wrong with a file, and what to do about it.

use std::io;
use std::path::{Path, PathBuf};

/// The file system refused something.
#[derive(Debug, thiserror::Error)]
#[error("cannot {doing} `{}`: {cause}", path.display())]
pub struct FileError {
    /// What was tried: "read", "write", ...
    pub doing: &'static str,
    /// File or folder.
    pub path: PathBuf,
    /// What the system says.
    pub cause: io::Error,
}

impl FileError {
    /// For `map_err`: the file system refused to do something to `path`.
    pub fn of(doing: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_path_buf();
        move |cause| Self { doing, path, cause }
    }

    /// What the user can do about it.
    pub fn remedy(&self) -> &'static str {
        match self.cause.kind() {
            io::ErrorKind::NotFound => "check the path; relative paths start at the current folder",
            io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
                "choose a folder you may write to with --output, or change its permissions"
            }
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge => {
                "free some space or choose another disk with --output; then run the same command again, it resumes"
            }
            io::ErrorKind::NotADirectory | io::ErrorKind::AlreadyExists | io::ErrorKind::IsADirectory => {
                "a file is in the way of a folder (or the other way round); choose another place with --output"
            }
            io::ErrorKind::InvalidInput => "write only below the folder, under plain file names",
            _ => "check the disk and the path, then run the same command again",
        }
    }
}
