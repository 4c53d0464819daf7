//! A disk that fills up, dies or loses power at a chosen call.
//!
//! Every call of [`Disk`] and [`Draft`] is counted and recorded. A test that runs a piece of work once without a fault
//! learns how many calls it takes, and can then let each of them fail in turn.

use crate::{Disk, Draft};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What goes wrong, and at which call (from 0).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// From this call on there is no space: whatever needs some is refused, half of what was to be written arrives.
    Full(usize),
    /// The process dies within this call; what it was to write arrives by half. All later calls do nothing.
    Death(usize),
}

/// A disk in memory that knows which of its content would outlive a power cut. Clones are the same disk.
#[derive(Debug, Clone, Default)]
pub struct SimulatedDisk(Arc<Mutex<Content>>);

#[derive(Debug, Default)]
struct Content {
    folders: BTreeSet<PathBuf>,
    /// Files by number: names move, content stays.
    files: Vec<File>,
    /// Which file each name means, as processes see it.
    names: BTreeMap<PathBuf, usize>,
    /// The same as it would be after a power cut, for what was synced.
    synced_names: BTreeMap<PathBuf, usize>,
    fault: Option<Fault>,
    calls: Vec<String>,
    written: u64,
}

#[derive(Debug, Default)]
struct File {
    bytes: Vec<u8>,
    synced: Vec<u8>,
}

impl SimulatedDisk {
    /// An empty disk.
    pub fn new() -> Self {
        Self::default()
    }

    /// What will go wrong from now on; calls are counted from 0 again.
    pub fn set_fault(&self, fault: Option<Fault>) {
        let mut content = self.lock();
        content.fault = fault;
        content.calls.clear();
        content.written = 0;
    }

    /// The calls since the last [`SimulatedDisk::set_fault`], such as `write .a.fissure-part`, in order.
    pub fn calls(&self) -> Vec<String> {
        self.lock().calls.clone()
    }

    /// The bytes written since the last [`SimulatedDisk::set_fault`].
    pub fn written(&self) -> u64 {
        self.lock().written
    }

    /// The power goes: of what was not synced each name and each content is kept, lost or kept in part, as `seed` has
    /// it.
    pub fn cut_power(&self, seed: u64) {
        let mut content = self.lock();
        let mut random = Pcg64::seed_from_u64(seed);
        let mut draw = |below: u64| random.next_u64() % below;
        let Content { names, synced_names, files, .. } = &mut *content;
        let paths: BTreeSet<PathBuf> = names.keys().chain(synced_names.keys()).cloned().collect();
        let kept = paths.into_iter().filter_map(|path| {
            let from = if draw(2) == 0 { &*names } else { &*synced_names };
            from.get(&path).map(|&file| (path, file))
        });
        let kept: BTreeMap<_, _> = kept.collect();
        for file in files.iter_mut() {
            let common = file.bytes.iter().zip(&file.synced).take_while(|(now, then)| now == then).count();
            let unsynced = (file.bytes.len() - common) as u64;
            match draw(4) {
                0 => file.bytes.clone_from(&file.synced),
                1 => {}
                2 => file.bytes.truncate(common + draw(unsynced + 1) as usize),
                // The length arrived, the content did not.
                _ => file.bytes[common..].fill(0),
            }
            file.synced.clone_from(&file.bytes);
        }
        names.clone_from(&kept);
        *synced_names = kept;
    }

    /// All files below `folder`: path within it and content.
    pub fn files(&self, folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
        let content = self.lock();
        let below = content.names.iter().filter_map(|(path, &file)| {
            Some((path.strip_prefix(folder).ok()?.to_path_buf(), content.files[file].bytes.clone()))
        });
        below.collect()
    }

    fn lock(&self) -> MutexGuard<'_, Content> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// How a call ends.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Fate {
    Done,
    /// What is written arrives by half.
    Half,
    Nothing,
}

impl Content {
    /// Records a call; says how it ends and what is told.
    fn call(&mut self, what: &str, path: &Path, needs_space: bool) -> (Fate, io::Result<()>) {
        let number = self.calls.len();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        self.calls.push(format!("{what} {name}"));
        let dead = || Err(io::Error::other("the process is dead"));
        match self.fault {
            Some(Fault::Death(at)) if number == at => (Fate::Half, dead()),
            Some(Fault::Death(at)) if number > at => (Fate::Nothing, dead()),
            Some(Fault::Full(at)) if number >= at && needs_space => {
                (Fate::Half, Err(io::ErrorKind::StorageFull.into()))
            }
            _ => (Fate::Done, Ok(())),
        }
    }

    /// A call that either happens or does not.
    fn whole(&mut self, what: &str, path: &Path, needs_space: bool) -> io::Result<()> {
        self.call(what, path, needs_space).1
    }

    fn write(&mut self, what: &str, path: &Path, bytes: &[u8]) -> io::Result<()> {
        let file = self.file(path);
        let (fate, told) = self.call(what, path, true);
        let arriving = match fate {
            Fate::Done => bytes,
            Fate::Half => &bytes[..bytes.len() / 2],
            Fate::Nothing => &[],
        };
        self.files[file?].bytes.extend_from_slice(arriving);
        self.written += arriving.len() as u64;
        told
    }

    fn file(&self, path: &Path) -> io::Result<usize> {
        self.names.get(path).copied().ok_or_else(|| io::ErrorKind::NotFound.into())
    }

    fn sync(&mut self, path: &Path) -> io::Result<()> {
        self.whole("sync", path, false)?;
        let file = self.file(path)?;
        let file = &mut self.files[file];
        file.synced.clone_from(&file.bytes);
        Ok(())
    }
}

impl Disk for SimulatedDisk {
    fn make_folder(&self, folder: &Path) -> io::Result<()> {
        let mut content = self.lock();
        let is_there = content.folders.contains(folder);
        content.whole("make", folder, !is_there)?;
        content.folders.extend(folder.ancestors().map(Path::to_path_buf));
        Ok(())
    }

    fn names(&self, folder: &Path) -> io::Result<Vec<OsString>> {
        let mut content = self.lock();
        content.whole("list", folder, false)?;
        if !content.folders.contains(folder) {
            return Err(io::ErrorKind::NotFound.into());
        }
        let inside = content.names.keys().filter(|path| path.parent() == Some(folder));
        Ok(inside.filter_map(|path| path.file_name().map(Into::into)).collect())
    }

    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let mut content = self.lock();
        content.whole("read", path, false)?;
        let file = content.file(path)?;
        Ok(content.files[file].bytes.clone())
    }

    fn length(&self, path: &Path) -> io::Result<u64> {
        let mut content = self.lock();
        content.whole("look at", path, false)?;
        let file = content.file(path)?;
        Ok(content.files[file].bytes.len() as u64)
    }

    fn draft<'a>(&'a self, folder: &Path, name: &str) -> io::Result<Box<dyn Draft + 'a>> {
        let path = folder.join(format!(".{name}{}", crate::disk::DRAFT_SUFFIX));
        let mut content = self.lock();
        content.whole("create", &path, true)?;
        if !content.folders.contains(folder) {
            return Err(io::ErrorKind::NotFound.into());
        }
        content.files.push(File::default());
        let number = content.files.len() - 1;
        content.names.insert(path.clone(), number);
        Ok(Box::new(SimulatedDraft { disk: self, path: Some(path) }))
    }

    fn append(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        self.lock().write("append", path, bytes)
    }

    fn sync(&self, path: &Path) -> io::Result<()> {
        self.lock().sync(path)
    }

    fn sync_folder(&self, folder: &Path) -> io::Result<()> {
        let mut content = self.lock();
        content.whole("sync folder", folder, false)?;
        let Content { names, synced_names, .. } = &mut *content;
        synced_names.retain(|path, _| path.parent() != Some(folder));
        let inside = names.iter().filter(|(path, _)| path.parent() == Some(folder));
        synced_names.extend(inside.map(|(path, &file)| (path.clone(), file)));
        Ok(())
    }

    fn remove(&self, path: &Path) -> io::Result<()> {
        let mut content = self.lock();
        content.whole("remove", path, false)?;
        content.names.remove(path).map(drop).ok_or_else(|| io::ErrorKind::NotFound.into())
    }
}

struct SimulatedDraft<'d> {
    disk: &'d SimulatedDisk,
    /// None once it is published.
    path: Option<PathBuf>,
}

impl SimulatedDraft<'_> {
    fn rename(&mut self, to: &Path, replace: bool) -> io::Result<()> {
        let mut content = self.disk.lock();
        content.whole("publish", to, true)?;
        if !replace && content.names.contains_key(to) {
            return Err(io::ErrorKind::AlreadyExists.into());
        }
        let file = self.path.take().and_then(|path| content.names.remove(&path));
        content.names.extend(file.map(|file| (to.to_path_buf(), file)));
        Ok(())
    }
}

impl Draft for SimulatedDraft<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.disk.lock().write("write", self.path.as_deref().unwrap_or(Path::new("")), bytes)
    }

    fn sync(&mut self) -> io::Result<()> {
        self.disk.lock().sync(self.path.as_deref().unwrap_or(Path::new("")))
    }

    fn publish(mut self: Box<Self>, path: &Path) -> io::Result<()> {
        self.rename(path, true)
    }

    fn publish_new(mut self: Box<Self>, path: &Path) -> io::Result<()> {
        self.rename(path, false)
    }
}

impl Drop for SimulatedDraft<'_> {
    fn drop(&mut self) {
        // The dead tidy nothing up.
        if let Some(path) = self.path.take() {
            let mut content = self.disk.lock();
            if content.whole("remove", &path, false).is_ok() {
                content.names.remove(&path);
            }
        }
    }
}
