//! Where the files of a scene go: `out/NAME/NAME.take` for the take, `out/NAME` for the meshes.

use crate::args::TakeArguments;
use crate::failure::Failure;
use fissure_scene::Scene;
use std::path::{Path, PathBuf};

/// The output folder of a scene.
#[derive(Debug, Clone)]
pub(crate) struct Folder {
    /// The folder; meshes go here.
    pub(crate) root: PathBuf,
    /// Prefix of all files.
    name: String,
}

impl Folder {
    /// The folder as asked for; it may not exist yet.
    pub(crate) fn of(scene: &Scene, arguments: &TakeArguments) -> Self {
        let root = arguments.output.clone().unwrap_or_else(|| Path::new("out").join(&scene.name));
        Self { root, name: scene.name.clone() }
    }

    /// Makes the folder where it is missing.
    pub(crate) fn make(&self) -> Result<(), Failure> {
        std::fs::create_dir_all(&self.root).map_err(|error| Failure::file("make the output folder", &self.root, &error))
    }

    /// The take.
    pub(crate) fn take(&self) -> PathBuf {
        self.root.join(format!("{}.take", self.name))
    }
}
