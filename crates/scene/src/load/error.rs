//! The error of loading a scene, with all that a report needs.

use super::place::Place;
use crate::fault::SceneFault;
use fissure_files::read_regular;
use std::ops::Range;
use std::path::Path;

/// What kind of mistake it is; decides the exit code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LoadErrorKind {
    /// The scene file is not valid TOML, or asks for something that does not exist or cannot be (exit code 2).
    Scene,
    /// A file is missing or unreadable, or a drawing, font or image is malformed (exit code 3).
    InputFile,
}

/// Why a scene could not be loaded.
#[derive(Debug, Clone, thiserror::Error)]
#[error("{}: {message}; {remedy}", self.place())]
pub struct LoadError {
    /// What kind of mistake it is.
    pub kind: LoadErrorKind,
    /// The file it is in, or the override (`--set a.b=c`).
    pub path: Box<Path>,
    /// The text of that file, if it could be read.
    pub source_text: Option<String>,
    /// Bytes of `source_text` that are meant.
    pub span: Option<Range<usize>>,
    /// What is wrong, with the offending value.
    pub message: String,
    /// What to do about it.
    pub remedy: String,
}

impl LoadError {
    /// Line of the file, from 1.
    pub fn line(&self) -> Option<usize> {
        let (text, span) = (self.source_text.as_ref()?, self.span.as_ref()?);
        Some(1 + text.bytes().take(span.start).filter(|&b| b == b'\n').count())
    }

    /// File and line as `scene.toml:12`.
    pub fn place(&self) -> String {
        match self.line() {
            Some(line) => format!("{}:{line}", self.path.display()),
            None => self.path.display().to_string(),
        }
    }

    /// A file that cannot be used.
    pub(crate) fn file(path: &Path, message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self {
            kind: LoadErrorKind::InputFile,
            path: path.into(),
            source_text: None,
            span: None,
            message: message.into(),
            remedy: remedy.into(),
        }
    }

    /// A malformed file: the mistake is at `span` of `text`.
    pub(crate) fn malformed(
        path: &Path,
        text: &str,
        span: Option<Range<usize>>,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self { source_text: Some(text.into()), span, ..Self::file(path, message, remedy) }
    }

    /// A fault of the scene, whose key is written at `place`.
    pub(crate) fn fault(place: Place, fault: SceneFault) -> Self {
        Self {
            kind: LoadErrorKind::Scene,
            path: place.path.into(),
            source_text: Some(place.text),
            span: place.span,
            message: fault.message,
            remedy: fault.remedy,
        }
    }
}

/// A kind of input file, and how large one may be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct InputFile {
    /// What it is, in words.
    what: &'static str,
    /// Most bytes of it.
    most_bytes: u64,
}

/// The scene file. Its text takes some 60 times as much memory once it is parsed.
pub(crate) const SCENE_FILE: InputFile = InputFile { what: "the scene file", most_bytes: 8 << 20 };
/// The drawing.
pub(crate) const DRAWING: InputFile = InputFile { what: "the drawing", most_bytes: 16 << 20 };
/// A font; the largest in use, with the letters of East Asia, have some 30 MiB.
pub(crate) const FONT: InputFile = InputFile { what: "the font", most_bytes: 128 << 20 };
/// An image that paints values.
pub(crate) const IMAGE: InputFile = InputFile { what: "the image", most_bytes: 128 << 20 };

impl InputFile {
    /// The same with fewer bytes.
    pub(crate) fn at_most(self, bytes: u64) -> Self {
        Self { most_bytes: self.most_bytes.min(bytes), ..self }
    }

    /// Reads it as text.
    pub(crate) fn read_text(self, path: &Path) -> Result<String, LoadError> {
        String::from_utf8(self.read(path)?).map_err(|e| {
            LoadError::file(
                path,
                format!("{} is not UTF-8 text (byte {})", self.what, e.utf8_error().valid_up_to()),
                "save it as plain UTF-8 text (a compressed SVG has to be unpacked first)",
            )
        })
    }

    /// Reads its bytes.
    pub(crate) fn read(self, path: &Path) -> Result<Vec<u8>, LoadError> {
        read_regular(path, self.most_bytes).map_err(|e| {
            let remedy = match e.kind() {
                std::io::ErrorKind::FileTooLarge => "make it smaller",
                std::io::ErrorKind::IsADirectory | std::io::ErrorKind::InvalidInput => "name a regular file",
                _ => "check the path and its permissions",
            };
            LoadError::file(path, format!("cannot read {}: {e}", self.what), remedy)
        })
    }
}
