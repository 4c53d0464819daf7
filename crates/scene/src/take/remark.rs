//! What is not as it should be about a take that can be used all the same.

use std::fmt;

/// Something about a take that the user may like to know.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Remark {
    /// A table was not as it was written and has been made anew from the frames.
    TableMadeAnew(&'static str),
    /// A table is not as it was written.
    DamagedTable(&'static str),
    /// The file of a frame is missing or has another length.
    MissingFrame(i64),
    /// The saved state is of no use; the message says why. It is not needed.
    UnusableState(String),
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TableMadeAnew(name) => write!(f, "`{name}` was damaged and has been made anew from the frames"),
            Self::DamagedTable(name) => {
                write!(f, "`{name}` is damaged; `fissure run` of the scene makes it anew from the frames")
            }
            Self::MissingFrame(number) => {
                write!(
                    f,
                    "the file of frame {number} is missing or cut off: all is computed anew from the first frame, and compared"
                )
            }
            Self::UnusableState(cause) => {
                write!(f, "{cause}; it is only needed to simulate further and may be removed")
            }
        }
    }
}
