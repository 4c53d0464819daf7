//! Why a stage stopped, with what the user can do about it.

use crate::exit::Exit;
use fissure_files::FileError;
use fissure_scene::KeyPath;
use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};
use std::fmt::Display;
use std::ops::Range;

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
    /// Keys of the scene that are the cause, counted as in the scene;
    /// [`SceneFile::show`](crate::scene_file::SceneFile::show) makes a snippet of them.
    pub(crate) keys: Vec<KeyPath>,
}

/// A place in a text file.
#[derive(Debug)]
pub(crate) struct Snippet {
    pub(crate) source: NamedSource<String>,
    /// Bytes of the source.
    pub(crate) span: Range<usize>,
    /// Bytes of the source that these do not go together with.
    pub(crate) other: Option<Range<usize>>,
}

impl Snippet {
    /// All bytes that are meant, as labels.
    pub(crate) fn labels(&self) -> Box<dyn Iterator<Item = LabeledSpan> + '_> {
        let spans = std::iter::once(&self.span).chain(&self.other);
        Box::new(spans.map(|span| LabeledSpan::new_with_span(None, span.clone())))
    }
}

impl Failure {
    /// A failure without a place in a file.
    pub(crate) fn new(exit: Exit, message: impl Into<String>, remedy: impl Into<String>) -> Self {
        let message: String = message.into();
        Self { remedy: Some(remedy.into()), ..Self::of(exit, message) }
    }

    /// A failure whose message names its remedy.
    pub(crate) fn of(exit: Exit, message: impl ToString) -> Self {
        Self { exit, message: message.to_string(), remedy: None, snippet: None, keys: Vec::new() }
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
        Some(self.snippet.as_ref()?.labels())
    }
}
