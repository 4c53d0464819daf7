//! Reading the scene that a stage works on, and what goes wrong with it.

use crate::args::SceneArguments;
use crate::exit::Exit;
use crate::failure::{Failure, Snippet};
use fissure_scene::{LoadError, LoadErrorKind, Scene};
use fissure_sim::SimulationError;
use miette::NamedSource;

/// Reads and validates a scene.
pub(crate) fn read(arguments: &SceneArguments) -> Result<Scene, Failure> {
    Ok(fissure_scene::load(&arguments.scene, &arguments.overrides)?)
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
