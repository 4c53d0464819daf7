//! Everything that is said: results on standard output; messages, progress and errors on standard error.
//!
//! A reader that goes away (`fissure schema | head -1`) is no error.

use crate::args::{LogFormat, TalkArguments};
use crate::caution::Caution;
use crate::exit::Exit;
use crate::failure::{Failure, Snippet};
use indicatif::ProgressBar;
use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme, SourceCode};
use serde::Serialize;
use std::io::{self, IsTerminal, Write};
use std::sync::{Mutex, PoisonError};

/// The voice of the program; shared by all threads.
#[derive(Debug)]
pub(crate) struct Report {
    log: LogFormat,
    quiet: bool,
    terminal: bool,
    /// The bar that is on the screen now: text goes above it.
    bar: Mutex<Option<ProgressBar>>,
}

/// One line of `--log json` besides progress.
#[derive(Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
enum Line<'a> {
    Note {
        message: &'a str,
    },
    Warning {
        message: &'a str,
        #[serde(skip_serializing_if = "Option::is_none")]
        remedy: Option<&'a str>,
        #[serde(flatten)]
        place: Option<LinePlace<'a>>,
    },
    Error {
        exit: u8,
        message: &'a str,
        #[serde(skip_serializing_if = "Option::is_none")]
        remedy: Option<&'a str>,
        #[serde(flatten)]
        place: Option<LinePlace<'a>>,
    },
}

/// A place in a text file as a line of `--log json` tells it; line and column from 1.
#[derive(Serialize)]
struct LinePlace<'a> {
    file: &'a str,
    line: usize,
    column: usize,
    /// Line of the other key, where two do not go together.
    #[serde(skip_serializing_if = "Option::is_none")]
    other_line: Option<usize>,
}

impl<'a> LinePlace<'a> {
    fn of(snippet: &'a Snippet) -> Self {
        let (line, column) = line_and_column(snippet, snippet.span.start);
        let other_line = snippet.other.as_ref().map(|span| line_and_column(snippet, span.start).0);
        Self { file: snippet.source.name(), line, column, other_line }
    }
}

impl Report {
    /// A voice as asked for.
    pub(crate) fn new(talk: TalkArguments) -> Self {
        Self { log: talk.log, quiet: talk.quiet, terminal: io::stderr().is_terminal(), bar: Mutex::new(None) }
    }

    /// A voice that says errors only.
    pub(crate) fn silent(&self) -> Self {
        Self { quiet: true, bar: Mutex::new(None), ..*self }
    }

    /// Whether programs listen.
    pub(crate) fn is_json(&self) -> bool {
        self.log == LogFormat::Json
    }

    /// Whether only errors are wanted.
    pub(crate) fn is_quiet(&self) -> bool {
        self.quiet
    }

    /// Whether a bar can be drawn.
    pub(crate) fn draws_bars(&self) -> bool {
        self.terminal && !self.quiet && !self.is_json()
    }

    /// Says something the user may like to know.
    pub(crate) fn note(&self, message: &str) {
        if self.quiet {
        } else if self.is_json() {
            self.line(&Line::Note { message });
        } else {
            self.write(message);
        }
    }

    /// Says something the user should know.
    pub(crate) fn warn(&self, message: &str) {
        if self.is_json() {
            self.line(&Line::Warning { message, remedy: None, place: None });
        } else {
            self.write(&format!("warning: {message}"));
        }
    }

    /// Says what will hardly go well with a scene.
    pub(crate) fn warn_about(&self, caution: &Caution) {
        if self.is_json() {
            let place = caution.snippet.as_ref().map(LinePlace::of);
            self.line(&Line::Warning { message: &caution.message, remedy: Some(&caution.remedy), place });
        } else {
            self.draw(caution);
        }
    }

    /// Says why a stage stopped.
    pub(crate) fn error(&self, failure: &Failure) {
        if self.is_json() {
            self.line(&Line::Error {
                exit: failure.exit as u8,
                message: &failure.message,
                remedy: failure.remedy.as_deref(),
                place: failure.snippet.as_deref().map(LinePlace::of),
            });
        } else {
            self.draw(failure);
        }
    }

    /// Writes a message with its remedy and the lines of the file that it is about.
    fn draw(&self, diagnostic: &dyn Diagnostic) {
        let theme = if self.terminal { GraphicalTheme::default() } else { GraphicalTheme::unicode_nocolor() };
        // Lines are wrapped for people only: programs that search the text would miss a broken word.
        let handler = GraphicalReportHandler::new_themed(theme).with_wrap_lines(self.terminal).with_context_lines(2);
        let mut text = String::new();
        if handler.render_report(&mut text, diagnostic).is_err() {
            text = diagnostic.to_string();
        }
        self.write(text.trim_end());
    }

    /// Writes one JSON object on one line of standard error.
    pub(crate) fn line(&self, value: &impl Serialize) {
        if let Ok(text) = serde_json::to_string(value) {
            self.write(&text);
        }
    }

    /// Writes text to standard error, above the bar when there is one.
    pub(crate) fn write(&self, text: &str) {
        let bar = self.bar.lock().unwrap_or_else(PoisonError::into_inner);
        // Nobody is left to tell when standard error is closed.
        let print = || drop(writeln!(io::stderr(), "{text}"));
        match bar.as_ref() {
            Some(bar) => bar.suspend(print),
            None => print(),
        }
    }

    /// Puts `bar` on the screen, or takes it away.
    pub(crate) fn set_bar(&self, bar: Option<ProgressBar>) {
        *self.bar.lock().unwrap_or_else(PoisonError::into_inner) = bar;
    }
}

/// Writes a result to standard output.
///
/// # Errors
/// When it cannot be written; a closed pipe is none.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Failure::new(
            Exit::File,
            format!("cannot write to standard output: {error}"),
            "check where the output goes",
        )),
        _ => Ok(()),
    }
}

/// Line and column of a byte of a snippet's source, both from 1.
fn line_and_column(snippet: &Snippet, byte: usize) -> (usize, usize) {
    let span = (byte, 0).into();
    match snippet.source.read_span(&span, 0, 0) {
        Ok(contents) => (contents.line() + 1, contents.column() + 1),
        Err(_) => (1, 1),
    }
}
