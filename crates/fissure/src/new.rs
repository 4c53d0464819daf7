//! `fissure new`

use crate::args::NewArguments;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report::Report;
use std::fs::OpenOptions;
use std::io::{self, Write};

/// Writes a commented scene that runs; never over a file that is there.
pub(crate) fn new(arguments: &NewArguments, report: &Report) -> Result<Exit, Failure> {
    let directory = &arguments.directory;
    std::fs::create_dir_all(directory).map_err(|error| Failure::file("make the folder", directory, &error))?;
    let path = directory.join("scene.toml");
    let mut file = OpenOptions::new().write(true).create_new(true).open(&path).map_err(|error| match error.kind() {
        io::ErrorKind::AlreadyExists => Failure::new(
            Exit::File,
            format!("`{}` is there already", path.display()),
            "name another folder, or move the file away",
        ),
        _ => Failure::file("write", &path, &error),
    })?;
    file.write_all(fissure_scene::template().as_bytes()).map_err(|error| Failure::file("write", &path, &error))?;
    report.note(&format!("wrote {0}\nrun it with: fissure run {0}", path.display()));
    Ok(Exit::Done)
}
