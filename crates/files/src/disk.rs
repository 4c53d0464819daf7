//! The calls to the system that writing takes.

use crate::read_regular;
use std::ffi::OsString;
use std::fmt;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::Path;
use tempfile::{Builder, NamedTempFile};

/// How the names of drafts end, by which what a dead process has left behind is known.
pub(crate) const DRAFT_SUFFIX: &str = ".fissure-part";

/// What a [`crate::Folder`] asks of the system. Each call may fail, and the process may die before, within or after it.
pub trait Disk: fmt::Debug + Send + Sync {
    /// Makes a folder and those above it that are missing, and makes sure that they are still there after a power cut.
    ///
    /// # Errors
    /// As the system's; that it is there already is none.
    fn make_folder(&self, folder: &Path) -> io::Result<()>;

    /// The names in a folder, sorted.
    ///
    /// # Errors
    /// As the system's.
    fn names(&self, folder: &Path) -> io::Result<Vec<OsString>>;

    /// All bytes of a file.
    ///
    /// # Errors
    /// As the system's, and when it is a pipe or a device, which may have no end.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>>;

    /// Length of a file [bytes].
    ///
    /// # Errors
    /// As the system's.
    fn length(&self, path: &Path) -> io::Result<u64>;

    /// Begins a file for `folder` under a name that nobody looks for. It goes when it is dropped before it is
    /// published.
    ///
    /// # Errors
    /// As the system's.
    fn draft<'a>(&'a self, folder: &Path, name: &str) -> io::Result<Box<dyn Draft + 'a>>;

    /// Adds bytes at the end of a file that is there. Some of them may arrive although the call fails.
    ///
    /// # Errors
    /// As the system's.
    fn append(&self, path: &Path, bytes: &[u8]) -> io::Result<()>;

    /// Waits until the content of a file is on the disk.
    ///
    /// # Errors
    /// As the system's.
    fn sync(&self, path: &Path) -> io::Result<()>;

    /// Waits until the names in a folder are on the disk: what was published, made and removed.
    ///
    /// # Errors
    /// As the system's.
    fn sync_folder(&self, folder: &Path) -> io::Result<()>;

    /// Removes a file.
    ///
    /// # Errors
    /// As the system's.
    fn remove(&self, path: &Path) -> io::Result<()>;
}

/// A file in the making.
pub trait Draft {
    /// Adds bytes.
    ///
    /// # Errors
    /// As the system's; a full disk is told here.
    fn write(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Waits until the content is on the disk.
    ///
    /// # Errors
    /// As the system's.
    fn sync(&mut self) -> io::Result<()>;

    /// Gives it its name, in one step; a file that has it is replaced.
    ///
    /// # Errors
    /// As the system's.
    fn publish(self: Box<Self>, path: &Path) -> io::Result<()>;

    /// As [`Draft::publish`], but never over a file that is there.
    ///
    /// # Errors
    /// As the system's; `AlreadyExists` when there is one.
    fn publish_new(self: Box<Self>, path: &Path) -> io::Result<()>;
}

/// The disk of the machine.
#[derive(Debug, Clone, Copy, Default)]
pub struct SystemDisk;

impl Disk for SystemDisk {
    fn make_folder(&self, folder: &Path) -> io::Result<()> {
        if folder.as_os_str().is_empty() || folder.is_dir() {
            return Ok(());
        }
        let above = folder.parent().unwrap_or(Path::new(""));
        self.make_folder(above)?;
        match fs::create_dir(folder) {
            // Somebody else was faster.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && folder.is_dir() => Ok(()),
            made => made.and_then(|()| self.sync_folder(above)),
        }
    }

    fn names(&self, folder: &Path) -> io::Result<Vec<OsString>> {
        let mut names = fs::read_dir(folder)?.map(|entry| Ok(entry?.file_name())).collect::<io::Result<Vec<_>>>()?;
        names.sort();
        Ok(names)
    }

    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        read_regular(path, u64::MAX)
    }

    fn length(&self, path: &Path) -> io::Result<u64> {
        Ok(fs::metadata(path)?.len())
    }

    fn draft<'a>(&'a self, folder: &Path, name: &str) -> io::Result<Box<dyn Draft + 'a>> {
        let prefix = format!(".{name}.");
        let mut builder = Builder::new();
        builder.prefix(&prefix).suffix(DRAFT_SUFFIX);
        // As any other program would make a file: the user's mask decides who may read it.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        Ok(Box::new(builder.tempfile_in(here(folder))?))
    }

    fn append(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        OpenOptions::new().append(true).open(path)?.write_all(bytes)
    }

    fn sync(&self, path: &Path) -> io::Result<()> {
        OpenOptions::new().append(true).open(path)?.sync_all()
    }

    fn sync_folder(&self, folder: &Path) -> io::Result<()> {
        // Elsewhere a folder cannot be opened; there the system keeps names on its own.
        if cfg!(unix) { File::open(here(folder))?.sync_all() } else { Ok(()) }
    }

    fn remove(&self, path: &Path) -> io::Result<()> {
        fs::remove_file(path)
    }
}

impl Draft for NamedTempFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.write_all(bytes)
    }

    fn sync(&mut self) -> io::Result<()> {
        self.as_file().sync_all()
    }

    fn publish(self: Box<Self>, path: &Path) -> io::Result<()> {
        self.persist(path).map(drop).map_err(|refused| refused.error)
    }

    fn publish_new(self: Box<Self>, path: &Path) -> io::Result<()> {
        self.persist_noclobber(path).map(drop).map_err(|refused| refused.error)
    }
}

/// A folder as the system wants it: the one we are in has no name of its own.
fn here(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
}
