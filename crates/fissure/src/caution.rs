//! What will hardly go well with a scene, as the user sees it.

use crate::failure::Snippet;
use fissure_scene::{Place, Warning};
use miette::{Diagnostic, LabeledSpan, NamedSource, Severity, SourceCode};
use std::fmt::Display;

/// A warning with the place in the scene file that it is about.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
pub(crate) struct Caution {
    /// What is to be expected, with the value.
    pub(crate) message: String,
    /// What to do.
    pub(crate) remedy: String,
    /// Where in the scene file; none when it is about what the file does not say.
    pub(crate) snippet: Option<Snippet>,
}

impl Caution {
    /// `warning`, which is about `place`.
    pub(crate) fn new(warning: &Warning, place: Place) -> Self {
        let source = NamedSource::new(place.path.display().to_string(), place.text);
        let snippet = place.span.map(|span| Snippet { source, span, other: None });
        Self { message: warning.message.clone(), remedy: warning.remedy.clone(), snippet }
    }
}

impl Diagnostic for Caution {
    fn severity(&self) -> Option<Severity> {
        Some(Severity::Warning)
    }

    fn help<'a>(&'a self) -> Option<Box<dyn Display + 'a>> {
        Some(Box::new(&self.remedy))
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.snippet.as_ref().map(|snippet| &snippet.source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(self.snippet.as_ref()?.labels())
    }
}
