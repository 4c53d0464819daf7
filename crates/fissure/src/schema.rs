//! `fissure schema`, and the schema beside a new scene.

use crate::exit::Exit;
use crate::failure::Failure;
use crate::report;
use fissure_files::Folder;

/// Name of the schema beside a scene; the scene that `new` writes names it.
const SCHEMA: &str = "scene.schema.json";

/// Prints the JSON schema of scene files.
pub(crate) fn schema() -> Result<Exit, Failure> {
    report::print(&text())?;
    Ok(Exit::Done)
}

/// Checks that the schema may be written into the folder of a scene.
///
/// # Errors
/// When a file of another kind is there: only an older schema of ours may be replaced.
pub(crate) fn may_be_written(folder: &Folder) -> Result<(), Failure> {
    let Some(bytes) = folder.read(SCHEMA)? else { return Ok(()) };
    let value = serde_json::from_slice::<serde_json::Value>(&bytes).unwrap_or_default();
    if value["title"] == fissure_scene::schema()["title"] {
        return Ok(());
    }
    Err(Failure::new(
        Exit::File,
        format!("`{}` is there already, and is no schema of scenes", folder.path().join(SCHEMA).display()),
        "name another folder, or move the file away",
    ))
}

/// Writes the schema into the folder of a scene.
///
/// # Errors
/// When it cannot be written.
pub(crate) fn write(folder: &Folder) -> Result<(), Failure> {
    Ok(folder.write(SCHEMA, text().as_bytes())?)
}

fn text() -> String {
    format!("{:#}\n", fissure_scene::schema())
}
