//! Reading the scene that a stage works on, and what goes wrong with it.

use crate::args::SceneArguments;
use crate::caution::Caution;
use crate::exit::Exit;
use crate::failure::{Failure, Snippet};
use crate::report::Report;
use fissure_scene::{LoadError, LoadErrorKind, Scene};
use fissure_sim::SimulationError;
use miette::NamedSource;

/// Reads and validates a scene, and says what will hardly go well with it.
///
/// # Errors
/// When the scene cannot be simulated, or something will hardly go well and the user wants that to count.
pub(crate) fn read(arguments: &SceneArguments, report: &Report) -> Result<Scene, Failure> {
    let loaded = fissure_scene::load_with_warnings(&arguments.scene, &arguments.overrides)?;
    for warning in &loaded.warnings {
        report.warn_about(&Caution::new(warning, loaded.place(&warning.path)));
    }
    match loaded.warnings.len() {
        count @ 1.. if arguments.strict => Err(Failure::new(
            Exit::Usage,
            format!("{count} {}, and --strict does not let them pass", if count == 1 { "warning" } else { "warnings" }),
            "mend what is named above, or leave --strict out",
        )),
        _ => Ok(loaded.scene),
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
            (Some(text), Some(span)) => Self {
                exit,
                message: error.message,
                remedy: Some(error.remedy),
                snippet: Some(Box::new(Snippet { source: NamedSource::new(place, text), span })),
            },
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
        // These messages name their remedy.
        Self { exit, message: error.to_string(), remedy: None, snippet: None }
    }
}
