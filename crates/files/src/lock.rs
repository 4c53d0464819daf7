//! One process at a time.

use crate::FileError;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Name of the file that is locked.
const NAME: &str = ".fissure.lock";
/// How its text begins.
const SIGNATURE: &str = "process ";

/// Keeps other processes that take the same lock out of a folder, as long as it lives. The system frees it when its
/// process ends, however that comes about. On file systems without locks it keeps nobody out.
#[derive(Debug)]
pub struct Lock {
    file: File,
    path: PathBuf,
}

/// Why a folder cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum LockError {
    /// Another process has it.
    #[error("`{}` is being written by {holder}", folder.display())]
    Held {
        /// The folder.
        folder: PathBuf,
        /// The process, as it named itself.
        holder: String,
    },
    /// The file system refused.
    #[error(transparent)]
    File(#[from] FileError),
}

impl Lock {
    /// Takes the lock of `folder`, which must exist, without waiting. `command` is what others are told who come later.
    ///
    /// # Errors
    /// [`LockError::Held`] when another process has it.
    pub fn take(folder: &Path, command: &str) -> Result<Self, LockError> {
        let path = folder.join(NAME);
        let refused = |cause| FileError::of("lock", folder)(cause);
        loop {
            ours(&path).map_err(refused)?;
            let file =
                OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path).map_err(refused)?;
            match file.try_lock() {
                Err(TryLockError::WouldBlock) => {
                    let named = fs::read_to_string(&path).ok().filter(|text| !text.is_empty());
                    let holder = named.unwrap_or_else(|| "another process".into());
                    return Err(LockError::Held { folder: folder.into(), holder });
                }
                Err(TryLockError::Error(cause)) if cause.kind() != io::ErrorKind::Unsupported => {
                    return Err(refused(cause).into());
                }
                _ => {}
            }
            // Who had it before removes the file: then this is the lock of a file that nobody else will find.
            if is_at(&file, &path).map_err(refused)? {
                let mut lock = Self { file, path };
                // Only for the message: on a full disk the lock holds all the same.
                let _ = lock.sign(command);
                return Ok(lock);
            }
        }
    }

    fn sign(&mut self, command: &str) -> io::Result<()> {
        self.file.set_len(0)?;
        write!(self.file, "{SIGNATURE}{} (`{command}`)", std::process::id())
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // While it is still locked: nobody can have begun to use it. A file that stays is no harm.
        if cfg!(unix) && is_at(&self.file, &self.path).unwrap_or(false) {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// That the file at `path`, if there is one, may be written over: it is a lock, and no way to some other place.
fn ours(path: &Path) -> io::Result<()> {
    match fs::symlink_metadata(path) {
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(cause) => Err(cause),
        // Others may not read what is locked on some systems; then it is a lock for sure.
        Ok(found) if found.is_file() => match fs::read(path) {
            Ok(text) if !text.is_empty() && !text.starts_with(SIGNATURE.as_bytes()) => Err(foreign()),
            _ => Ok(()),
        },
        Ok(_) => Err(foreign()),
    }
}

fn foreign() -> io::Error {
    io::Error::new(io::ErrorKind::AlreadyExists, format!("its `{NAME}` is not one of Fissure's"))
}

/// Whether `file` is the one that is found at `path` now.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt;
    let ours = file.metadata()?;
    match fs::metadata(path) {
        Ok(found) => Ok((ours.dev(), ours.ino()) == (found.dev(), found.ino())),
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(cause) => Err(cause),
    }
}

#[cfg(not(unix))]
fn is_at(_: &File, _: &Path) -> io::Result<bool> {
    Ok(true)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn the_holder_is_named_and_the_lock_ends_with_it() {
        let folder = tempfile::tempdir().unwrap();
        let lock = Lock::take(folder.path(), "fissure run plate.toml").unwrap();
        let told = Lock::take(folder.path(), "fissure sim").unwrap_err().to_string();
        let process = format!("process {} (`fissure run plate.toml`)", std::process::id());
        assert!(told.contains(&process) && told.contains(&folder.path().display().to_string()), "{told}");
        drop(lock);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        Lock::take(folder.path(), "again").unwrap();
    }

    #[test]
    fn a_file_of_somebody_else_is_no_lock() {
        let folder = tempfile::tempdir().unwrap();
        let (lock, precious) = (folder.path().join(NAME), folder.path().join("precious"));
        fs::write(&lock, "years of work").unwrap();
        assert!(Lock::take(folder.path(), "fissure").is_err());
        assert_eq!(fs::read(&lock).unwrap(), b"years of work");
        #[cfg(unix)]
        {
            fs::rename(&lock, &precious).unwrap();
            std::os::unix::fs::symlink(&precious, &lock).unwrap();
            assert!(Lock::take(folder.path(), "fissure").is_err());
            assert_eq!(fs::read(&precious).unwrap(), b"years of work");
        }
    }

    /// Truth: a counter that would be two if two had the lock at once, while the file comes and goes.
    #[test]
    fn never_two_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let (inside, taken) = (AtomicUsize::new(0), AtomicUsize::new(0));
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    for _ in 0..500 {
                        if let Ok(_lock) = Lock::take(folder.path(), "one of four") {
                            assert_eq!(inside.fetch_add(1, Ordering::SeqCst), 0);
                            taken.fetch_add(1, Ordering::SeqCst);
                            inside.fetch_sub(1, Ordering::SeqCst);
                        }
                    }
                });
            }
        });
        assert!(taken.into_inner() > 100);
    }
}
