//! Where the files of a scene go: `out/NAME/NAME.take` for the take, `out/NAME` for the meshes.

use crate::args::TakeArguments;
use fissure_files::Folder;
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
}
