//! From a scene file to a [`Scene`]: defaults, then the file, then overrides.

mod along;
mod chord;
mod draft;
mod drawing;
mod error;
mod explain;
mod loaded;
mod nearest;
mod output;
mod overrides;
mod picture;
mod place;
mod resolve;
mod scatter;
mod seating;
mod source;
mod split;
mod template;

pub use draft::{Draft, DraftOptions, draft};
pub use error::{LoadError, LoadErrorKind};
pub use loaded::Loaded;
pub use output::with_output;
pub use place::Place;
pub use template::template;

use crate::document::{Document, ToughnessKeys};
use crate::scene::Scene;
use drawing::LoadedDrawing;
use error::SCENE_FILE;
use picture::{Budget, Picture};
use resolve::{Resolution, Resolver};
use source::SceneSource;
use std::path::{Path, PathBuf};

/// Loads a scene file and everything it refers to, with `overrides` such as `body.plate.material=glass` on top.
///
/// The scene passes [`Scene::validate`]. Mouths of cracks are corners of their rings to the bit. A scene that wishes
/// for an accuracy or a time has the default resolution; [`Loaded::wish`] says what it wishes for.
///
/// # Errors
/// [`LoadError`], which says where: file, line, value and remedy.
pub fn load(path: &Path, overrides: &[String]) -> Result<Scene, LoadError> {
    load_with_warnings(path, overrides).map(|loaded| loaded.scene)
}

/// As [`load`], with what will hardly go well and where each key of the scene is written.
///
/// # Errors
/// As [`load`].
pub fn load_with_warnings(path: &Path, overrides: &[String]) -> Result<Loaded, LoadError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    load_text(path, SCENE_FILE.read_text(path)?, overrides, |file| folder.join(file))
}

/// As [`load_with_warnings`], of the `text` of a scene file that is or would be at `path`; `locate` finds the files it
/// names.
fn load_text(
    path: &Path,
    text: String,
    overrides: &[String],
    locate: impl Fn(&Path) -> PathBuf,
) -> Result<Loaded, LoadError> {
    let (source, document) = SceneSource::parse(path, text, overrides)?;
    let drawing = match &document.drawing {
        Some(drawing) => Some(LoadedDrawing::read(drawing, &locate, |fault| source.error(fault))?),
        None => None,
    };
    let mut budget = Budget::of_a_scene();
    let picture =
        |keys: &ToughnessKeys| keys.image.as_ref().map(|file| Picture::read(&locate(file), &mut budget)).transpose();
    let pictures = document.toughness.iter().map(picture).collect::<Result<Vec<_>, _>>()?;
    let resolver = Resolver::new(&document, drawing.as_ref(), &pictures, default_name(path));
    let Resolution { mut scene, wish, origin, warnings } = resolver.resolve().map_err(|fault| source.error(fault))?;
    scene.hash = scene.simulation_hash();
    Ok(Loaded { scene, wish, warnings, source, origin })
}

/// JSON schema of the scene file, for editors and user interfaces.
pub fn schema() -> serde_json::Value {
    schemars::schema_for!(Document).into()
}

/// The folder's name for `folder/scene.toml`, otherwise the file's own without extension.
fn default_name(path: &Path) -> String {
    let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    if stem != "scene" {
        return stem;
    }
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.into());
    let folder = absolute.parent().and_then(Path::file_name).map(|s| s.to_string_lossy().into_owned());
    folder.unwrap_or(stem)
}
