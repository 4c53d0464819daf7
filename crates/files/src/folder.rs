//! A folder that files are written to.

use crate::disk::DRAFT_SUFFIX;
use crate::{Disk, FileError, SystemDisk};
use std::io;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

/// A folder and the disk it lies on. Files in it go by plain names.
#[derive(Debug, Clone)]
pub struct Folder {
    path: PathBuf,
    disk: Arc<dyn Disk>,
}

impl Folder {
    /// A folder of this machine; it may not exist yet.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self::on(Arc::new(SystemDisk), path)
    }

    /// A folder on some other disk.
    pub fn on(disk: Arc<dyn Disk>, path: impl Into<PathBuf>) -> Self {
        Self { path: path.into(), disk }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Where a file in it is.
    ///
    /// # Errors
    /// When `name` is no plain file name: it would reach out of the folder.
    pub fn place(&self, name: &str) -> Result<PathBuf, FileError> {
        let path = self.path.join(name);
        let mut parts = Path::new(name).components();
        let plain = matches!((parts.next(), parts.next()), (Some(Component::Normal(part)), None) if part == name);
        if plain && !name.contains(['/', '\\', '\0']) {
            return Ok(path);
        }
        let cause =
            io::Error::new(io::ErrorKind::InvalidInput, format!("`{}` is no plain file name", name.escape_debug()));
        Err(FileError { doing: "use", path, cause })
    }

    /// Makes the folder, and those above it, where they are missing.
    ///
    /// # Errors
    /// When it cannot be made.
    pub fn make(&self) -> Result<(), FileError> {
        self.disk.make_folder(&self.path).map_err(FileError::of("make the folder", &self.path))
    }

    /// The names in it that are text, sorted; none when there is no such folder.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn names(&self) -> Result<Vec<String>, FileError> {
        match self.disk.names(&self.path) {
            Ok(names) => Ok(names.into_iter().filter_map(|name| name.into_string().ok()).collect()),
            Err(cause) if cause.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
            Err(cause) => Err(FileError::of("read", &self.path)(cause)),
        }
    }

    /// All bytes of a file; none when there is no such file.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn read(&self, name: &str) -> Result<Option<Vec<u8>>, FileError> {
        let path = self.place(name)?;
        missing_is_none(self.disk.read(&path)).map_err(FileError::of("read", &path))
    }

    /// Length of a file [bytes]; none when there is no such file.
    ///
    /// # Errors
    /// When it cannot be looked at.
    pub fn length(&self, name: &str) -> Result<Option<u64>, FileError> {
        let path = self.place(name)?;
        missing_is_none(self.disk.length(&path)).map_err(FileError::of("read", &path))
    }

    /// Writes a file; one of that name is replaced. It has its name only when all of its content is on the disk. That
    /// the name is, too, takes [`Folder::sync`].
    ///
    /// # Errors
    /// When it cannot be written; what was under the name is then still there.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), FileError> {
        let path = self.place(name)?;
        let written = || {
            let mut draft = self.disk.draft(&self.path, name)?;
            draft.write(bytes)?;
            draft.sync()?;
            draft.publish(&path)
        };
        written().map_err(FileError::of("write", &path))
    }

    /// As [`Folder::write`], but without waiting for the disk, for what can be made again: after a power cut such a
    /// file may be empty or hold zeros; after any other death it is whole.
    ///
    /// # Errors
    /// As [`Folder::write`].
    pub fn write_unsynced(&self, name: &str, bytes: &[u8]) -> Result<(), FileError> {
        let path = self.place(name)?;
        let written = || {
            let mut draft = self.disk.draft(&self.path, name)?;
            draft.write(bytes)?;
            draft.publish(&path)
        };
        written().map_err(FileError::of("write", &path))
    }

    /// As [`Folder::write`], but never over a file that is there.
    ///
    /// # Errors
    /// When it cannot be written; of the kind `AlreadyExists` when there is one.
    pub fn write_new(&self, name: &str, bytes: &[u8]) -> Result<(), FileError> {
        let path = self.place(name)?;
        let written = || {
            let mut draft = self.disk.draft(&self.path, name)?;
            draft.write(bytes)?;
            draft.sync()?;
            draft.publish_new(&path)
        };
        written().map_err(FileError::of("write", &path))
    }

    /// Adds bytes at the end of a file that is there.
    ///
    /// # Errors
    /// When it cannot be written; some of the bytes may be there all the same.
    pub fn append(&self, name: &str, bytes: &[u8]) -> Result<(), FileError> {
        let path = self.place(name)?;
        self.disk.append(&path, bytes).map_err(FileError::of("write", &path))
    }

    /// Waits until the content of a file is on the disk.
    ///
    /// # Errors
    /// When the system cannot promise it.
    pub fn sync_file(&self, name: &str) -> Result<(), FileError> {
        let path = self.place(name)?;
        self.disk.sync(&path).map_err(FileError::of("write", &path))
    }

    /// Waits until the names in the folder are on the disk.
    ///
    /// # Errors
    /// When the system cannot promise it.
    pub fn sync(&self) -> Result<(), FileError> {
        self.disk.sync_folder(&self.path).map_err(FileError::of("write", &self.path))
    }

    /// Removes a file; that it is not there is fine.
    ///
    /// # Errors
    /// When it cannot be removed.
    pub fn remove(&self, name: &str) -> Result<(), FileError> {
        let path = self.place(name)?;
        missing_is_none(self.disk.remove(&path)).map(drop).map_err(FileError::of("remove", &path))
    }

    /// Removes the drafts of a process that died while it wrote. Only for who holds the folder's lock: the drafts of a
    /// living process go too.
    ///
    /// # Errors
    /// When one cannot be removed.
    pub fn remove_drafts(&self) -> Result<(), FileError> {
        let drafts = self.names()?;
        drafts
            .iter()
            .filter(|name| name.starts_with('.') && name.ends_with(DRAFT_SUFFIX))
            .try_for_each(|n| self.remove(n))
    }
}

fn missing_is_none<T>(found: io::Result<T>) -> io::Result<Option<T>> {
    match found {
        Ok(found) => Ok(Some(found)),
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(cause) => Err(cause),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn names_stay_in_the_folder() {
        let above = tempfile::tempdir().unwrap();
        let folder = Folder::new(above.path().join("inside"));
        folder.make().unwrap();
        for name in ["../evil", "/evil", "..", ".", "", "a/b", "a\\b", "a\0b", "./a", "a/"] {
            assert!(folder.write(name, b"x").is_err(), "{name:?}");
            assert!(folder.append(name, b"x").is_err() && folder.remove(name).is_err(), "{name:?}");
        }
        assert_eq!(std::fs::read_dir(above.path()).unwrap().count(), 1);
        assert!(folder.names().unwrap().is_empty());
    }

    #[test]
    fn a_new_file_never_replaces_one_that_is_there() {
        let above = tempfile::tempdir().unwrap();
        let folder = Folder::new(above.path());
        folder.write_new("a", b"1").unwrap();
        assert_eq!(folder.write_new("a", b"2").unwrap_err().cause.kind(), io::ErrorKind::AlreadyExists);
        assert_eq!(folder.read("a").unwrap().unwrap(), b"1");
        folder.write("a", b"3").unwrap();
        assert_eq!((folder.names().unwrap(), folder.read("a").unwrap().unwrap()), (vec!["a".into()], b"3".to_vec()));
    }

    /// Truth: what any other program makes of the same folder.
    #[cfg(unix)]
    #[test]
    fn files_have_the_rights_that_the_mask_gives() {
        use std::os::unix::fs::PermissionsExt;
        let above = tempfile::tempdir().unwrap();
        let mode = |name: &str| std::fs::metadata(above.path().join(name)).unwrap().permissions().mode();
        std::fs::write(above.path().join("theirs"), b"x").unwrap();
        Folder::new(above.path()).write("ours", b"x").unwrap();
        assert_eq!(mode("ours"), mode("theirs"));
    }

    /// Reading either would never end.
    #[cfg(unix)]
    #[test]
    fn pipes_and_devices_are_no_files() {
        let above = tempfile::tempdir().unwrap();
        let folder = Folder::new(above.path());
        std::os::unix::fs::symlink("/dev/zero", above.path().join("device")).unwrap();
        let made = std::process::Command::new("mkfifo").arg(above.path().join("pipe")).status().unwrap();
        assert!(made.success());
        for name in ["device", "pipe"] {
            assert!(folder.read(name).unwrap_err().to_string().contains("not a regular file"), "{name}");
        }
    }

    #[test]
    fn drafts_of_the_dead_go_and_nothing_else() {
        let above = tempfile::tempdir().unwrap();
        let folder = Folder::new(above.path());
        for name in [".a.x1y2z3.fissure-part", "mine.fissure-part", ".a", "a.part"] {
            folder.write(name, b"x").unwrap();
        }
        folder.remove_drafts().unwrap();
        assert_eq!(folder.names().unwrap(), [".a", "a.part", "mine.fissure-part"]);
    }
}
