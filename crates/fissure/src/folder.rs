//! Where the files of a scene go: `out/NAME/NAME.take` for the take, `out/NAME` for the meshes.

use crate::args::TakeArguments;
use crate::failure::Failure;
use crate::invocation;
use fissure_files::{Folder, Lock};
use fissure_scene::Scene;
use std::path::{Path, PathBuf};

/// The output folder of a scene.
#[derive(Debug, Clone)]
pub(crate) struct OutputFolder {
    /// The folder; meshes go here. It may not exist yet.
    pub(crate) root: Folder,
    /// The take in it.
    pub(crate) take: Folder,
}

impl OutputFolder {
    /// The folder as asked for.
    pub(crate) fn of(scene: &Scene, arguments: &TakeArguments) -> Self {
        let root = arguments.output.clone().unwrap_or_else(|| Path::new("out").join(&scene.name));
        let take: PathBuf = root.join(format!("{}.take", scene.name));
        Self { root: Folder::new(root), take: Folder::new(take) }
    }

    /// Keeps other processes from writing to the take, which must exist.
    ///
    /// # Errors
    /// When one is doing so.
    pub(crate) fn lock_take(&self) -> Result<Lock, Failure> {
        Ok(Lock::take(self.take.path(), &invocation::typed())?)
    }

    /// Keeps other processes from writing meshes into the folder, which must exist.
    ///
    /// # Errors
    /// When one is doing so.
    pub(crate) fn lock_meshes(&self) -> Result<Lock, Failure> {
        Ok(Lock::take(self.root.path(), &invocation::typed())?)
    }
}
