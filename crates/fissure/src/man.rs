//! `fissure man`

use crate::args::{Arguments, ManArguments};
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report::Report;
use clap::CommandFactory;
use fissure_files::Folder;

/// Writes the manual pages, one of the program and one of each command, into a folder that is made when missing.
pub(crate) fn man(arguments: &ManArguments, report: &Report) -> Result<Exit, Failure> {
    let folder = Folder::new(&arguments.directory);
    folder.make()?;
    let mut program = Arguments::command().disable_help_subcommand(true).version(env!("CARGO_PKG_VERSION"));
    program.build();
    let mut count = 0;
    for command in program.get_subcommands().chain([&program]) {
        let page = clap_mangen::Man::new(command.clone());
        let name = page.get_filename();
        let mut text = Vec::new();
        let failed = |error| Failure::new(Exit::File, format!("cannot make the page `{name}`: {error}"), "report it");
        page.render(&mut text).map_err(failed)?;
        folder.write(&name, &text)?;
        count += 1;
    }
    report.note(&format!("wrote {count} pages; read one with: man -l {}", folder.path().join("fissure.1").display()));
    Ok(Exit::Done)
}
