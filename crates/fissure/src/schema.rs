//! `fissure schema`

use crate::exit::Exit;
use crate::failure::Failure;
use crate::report;

/// Prints the JSON schema of scene files.
pub(crate) fn schema() -> Result<Exit, Failure> {
    report::print(&format!("{:#}\n", fissure_scene::schema()))?;
    Ok(Exit::Done)
}
