//! Exit codes: part of the interface, because farms act on them.

use std::process::ExitCode;

/// How the program ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Exit {
    /// Everything asked for is there.
    Done = 0,
    /// The command line or the scene is wrong.
    Usage = 2,
    /// A file cannot be read or written.
    File = 3,
    /// The computation failed; trying again gives the same.
    Numerical = 4,
    /// Interrupted; the same command goes on. The number is `EX_TEMPFAIL` of BSD's sysexits.
    Interrupted = 75,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}
