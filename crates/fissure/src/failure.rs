//! Why a stage stopped, with what the user can do about it.

use crate::exit::Exit;
use fissure_files::FileError;
use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};
use std::fmt::Display;

/// An error as the user sees it.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
pub(crate) struct Failure {
    /// How the program ends because of it.
    pub(crate) exit: Exit,
    /// What is wrong, with the offending value.
    pub(crate) message: String,
    /// What to do.
    pub(crate) remedy: Option<String>,
    /// Where in a text file.
    pub(crate) snippet: Option<Box<Snippet>>,
}

/// A place in a text file.
#[derive(Debug)]
pub(crate) struct Snippet {
    pub(crate) source: NamedSource<String>,
    /// Bytes of the source.
    pub(crate) span: std::ops::Range<usize>,
}

impl Failure {
    /// A failure without a place in a file.
    pub(crate) fn new(exit: Exit, message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { exit, message: message.into(), remedy: Some(remedy.into()), snippet: None }
    }

    /// The same failure, said of a larger task.
    pub(crate) fn during(mut self, task: impl Display) -> Self {
        self.message = format!("{task}: {}", self.message);
        self
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        Self::new(Exit::File, error.to_string(), error.remedy())
    }
}

impl Diagnostic for Failure {
    fn help<'a>(&'a self) -> Option<Box<dyn Display + 'a>> {
        self.remedy.as_ref().map(|remedy| Box::new(remedy) as Box<dyn Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.snippet.as_ref().map(|snippet| &snippet.source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let span = self.snippet.as_ref()?.span.clone();
        Some(Box::new(std::iter::once(LabeledSpan::new_with_span(None, span))))
    }
}
