//! A scene as it comes from its file.

use super::place::Place;
use super::resolve::Origin;
use super::source::SceneSource;
use crate::fault::{KeyPath, Warning};
use crate::scene::Scene;
use crate::wish::Wish;

/// A scene, what will hardly go well with it, and where each of its keys is written.
#[derive(Debug)]
pub struct Loaded {
    /// The scene.
    pub scene: Scene,
    /// What the scene wants instead of a resolution: it has the default one until somebody chooses.
    pub wish: Option<Wish>,
    /// What will hardly go well. Paths count items as in the file.
    pub warnings: Vec<Warning>,
    pub(super) source: SceneSource,
    pub(super) origin: Origin,
}

impl Loaded {
    /// Adds warnings whose paths count items as in the scene.
    pub fn warn(&mut self, warnings: impl IntoIterator<Item = Warning>) {
        let origin = &self.origin;
        let in_file = |warning: Warning| Warning { path: origin.in_file(warning.path), ..warning };
        self.warnings.extend(warnings.into_iter().map(in_file));
    }

    /// A path that counts items as in the scene, as one that counts them as in the file: a drawing of several outlines
    /// makes several bodies of one `[[body]]`, and flaws are cracks without a `[[crack]]` of their own.
    pub fn in_file(&self, path: KeyPath) -> KeyPath {
        self.origin.in_file(path)
    }

    /// Where `path`, which counts items as in the file, is written. The deepest part of it that is written counts.
    pub fn place(&self, path: &KeyPath) -> Place {
        self.source.locate(path)
    }
}
