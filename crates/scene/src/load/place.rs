//! A place in what a user has written.

use std::ops::Range;
use std::path::PathBuf;

/// Where a key of a scene is written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file, or the override (`--set a.b=c`).
    pub path: PathBuf,
    /// The text of that file or override.
    pub text: String,
    /// Bytes of `text` that are meant; none when the file says nothing about it.
    pub span: Option<Range<usize>>,
}

impl Place {
    /// Line of the file, from 1.
    pub fn line(&self) -> Option<usize> {
        let start = self.span.as_ref()?.start;
        Some(1 + self.text.bytes().take(start).filter(|&b| b == b'\n').count())
    }
}
