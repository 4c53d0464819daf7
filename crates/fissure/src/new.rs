//! `fissure new`

use crate::args::NewArguments;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report::Report;
use crate::schema;
use fissure_files::Folder;
use std::io;

/// Name of the scene file.
const SCENE: &str = "scene.toml";

/// Writes a commented scene that runs and the schema that editors check it by; never over a file that is there.
pub(crate) fn new(arguments: &NewArguments, report: &Report) -> Result<Exit, Failure> {
    let folder = Folder::new(&arguments.directory);
    folder.make()?;
    schema::may_be_written(&folder)?;
    let path = folder.place(SCENE)?;
    folder.write_new(SCENE, fissure_scene::template().as_bytes()).map_err(|error| match error.cause.kind() {
        io::ErrorKind::AlreadyExists => Failure::new(
            Exit::File,
            format!("`{}` is there already", path.display()),
            "name another folder, or move the file away",
        ),
        _ => error.into(),
    })?;
    schema::write(&folder)?;
    folder.sync()?;
    report.note(&format!("wrote {0}\nrun it with: fissure run {0}", path.display()));
    Ok(Exit::Done)
}
