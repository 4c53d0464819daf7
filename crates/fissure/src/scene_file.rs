//! Reading the scene that a stage works on, and what goes wrong with it.

use crate::args::SceneArguments;
use crate::caution::Caution;
use crate::dial;
use crate::drawn::{self, Wanted};
use crate::exit::Exit;
use crate::failure::{Failure, Snippet};
use crate::report::Report;
use fissure_scene::{LoadError, LoadErrorKind, Loaded, Scene, Wish};
use fissure_sim::SimulationError;
use miette::NamedSource;
use std::path::{Path, PathBuf};

/// A scene with the file it comes from.
#[derive(Debug)]
pub(crate) struct SceneFile(Loaded);

impl SceneFile {
    /// The scene.
    pub(crate) fn scene(&self) -> &Scene {
        &self.0.scene
    }

    /// The same failure, with the lines of the file that are its cause.
    pub(crate) fn show(&self, failure: Failure) -> Failure {
        let mut places = failure.keys.iter().map(|key| self.0.place(&self.0.in_file(key.clone())));
        let Some(place) = places.next() else { return failure };
        let Some(span) = place.span else { return failure };
        let other = places.next().filter(|other| other.path == place.path).and_then(|other| other.span);
        let source = NamedSource::new(place.path.display().to_string(), place.text);
        Failure { snippet: Some(Box::new(Snippet { source, span, other })), ..failure }
    }
}

/// Reads and validates a scene, and says what will hardly go well with it.
///
/// # Errors
/// When the scene cannot be simulated, or something will hardly go well and the user wants that to count.
pub(crate) fn read(arguments: &SceneArguments, wanted: &Wanted<'_>, report: &Report) -> Result<SceneFile, Failure> {
    let mut loaded = match arguments.wish() {
        None => load(arguments, &arguments.overrides, wanted, report)?,
        Some(wish) => {
            // Nothing is written and said but of the scene that is run.
            let first = Wanted { written: false, ..*wanted };
            let as_it_is = load(arguments, &arguments.overrides, &first, &report.silent())?;
            load(arguments, &as_wished(arguments, as_it_is, wish, report)?, wanted, report)?
        }
    };
    if let Some(wish) = loaded.wish {
        loaded = load(arguments, &as_wished(arguments, loaded, wish, report)?, wanted, &report.silent())?;
    }
    let foreseen = fissure_sim::warnings(&loaded.scene);
    loaded.warn(foreseen);
    for warning in &loaded.warnings {
        report.warn_about(&Caution::new(warning, loaded.place(&warning.path)));
    }
    match loaded.warnings.len() {
        count @ 1.. if arguments.strict => Err(Failure::new(
            Exit::Usage,
            format!("{count} {}, and --strict does not let them pass", if count == 1 { "warning" } else { "warnings" }),
            "mend what is named above, or leave --strict out",
        )),
        _ => Ok(SceneFile(loaded)),
    }
}

/// All overrides of a scene with what its wish comes to, which is told. `as_it_is`: without that.
///
/// # Errors
/// When the wish is not to be had; shown where it is written.
fn as_wished(
    arguments: &SceneArguments,
    as_it_is: Loaded,
    wish: Wish,
    report: &Report,
) -> Result<Vec<String>, Failure> {
    let chosen = dial::overrides(&as_it_is.scene, wish).map_err(|mut failure| {
        if failure.keys.is_empty() && arguments.wish().is_none() {
            failure.keys.push(dial::key(wish));
        }
        SceneFile(as_it_is).show(failure)
    })?;
    report.note(&format!("chosen: {}", chosen.join(", ")));
    Ok([&arguments.overrides[..], &chosen].concat())
}

/// Loads a scene with `overrides` on top, or makes that of a drawing.
fn load(
    arguments: &SceneArguments,
    overrides: &[String],
    wanted: &Wanted<'_>,
    report: &Report,
) -> Result<Loaded, Failure> {
    if drawn::is_drawing(&arguments.scene) {
        return drawn::load(arguments, overrides, wanted, report);
    }
    drawn::refuse_options(arguments)?;
    let thickness = wanted.thickness.map(|thickness| format!("output.thickness={thickness:?}"));
    let overrides: Vec<String> = overrides.iter().cloned().chain(thickness).collect();
    Ok(fissure_scene::load_with_warnings(&scene_in(&arguments.scene)?, &overrides)?)
}

/// The scene file meant by `path`: itself, or the scene in a folder.
fn scene_in(path: &Path) -> Result<PathBuf, Failure> {
    if !path.is_dir() {
        return Ok(path.to_owned());
    }
    let usual = path.join("scene.toml");
    if usual.is_file() {
        return Ok(usual);
    }
    let entries = std::fs::read_dir(path).map_err(|error| {
        let message = format!("cannot read the folder `{}`: {error}", path.display());
        Failure::new(Exit::File, message, "check its permissions, or name the scene file itself")
    })?;
    let is_scene = |file: &PathBuf| file.extension().is_some_and(|e| e == "toml") && file.is_file();
    let mut scenes: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).filter(is_scene).collect();
    scenes.sort();
    let name = |file: &PathBuf| format!("`{}`", file.display());
    match scenes.as_slice() {
        [only] => Ok(only.clone()),
        [] => Err(Failure::new(
            Exit::File,
            format!("there is no scene in the folder `{}`", path.display()),
            "name a scene file, or write one to start from with `fissure new`",
        )),
        several => Err(Failure::new(
            Exit::Usage,
            format!("the folder `{}` has {} scenes and no `scene.toml`", path.display(), several.len()),
            format!("name one of them: {}", several.iter().take(6).map(name).collect::<Vec<_>>().join(", ")),
        )),
    }
}

impl From<LoadError> for Failure {
    fn from(error: LoadError) -> Self {
        let exit = match error.kind {
            LoadErrorKind::Scene => Exit::Usage,
            LoadErrorKind::InputFile => Exit::File,
        };
        let place = error.path.display().to_string();
        match (error.source_text, error.span) {
            (Some(text), Some(span)) => {
                let snippet = Snippet { source: NamedSource::new(place, text), span, other: None };
                Self { snippet: Some(Box::new(snippet)), ..Self::new(exit, error.message, error.remedy) }
            }
            _ => Self::new(exit, format!("{place}: {}", error.message), error.remedy),
        }
    }
}

impl From<SimulationError> for Failure {
    fn from(error: SimulationError) -> Self {
        let exit = match error {
            SimulationError::Unstable { .. } | SimulationError::OutOfRange { .. } => Exit::Numerical,
            _ => Exit::Usage,
        };
        let keys = error.keys();
        match error {
            SimulationError::Scene(fault) => Self { keys, ..Self::new(exit, fault.message, fault.remedy) },
            // The other messages name their remedy.
            _ => Self { keys, ..Self::of(exit, error) },
        }
    }
}
