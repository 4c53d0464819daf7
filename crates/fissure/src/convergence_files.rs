//! The files that `fissure converge` writes. They are looked at before the runs, which may take long.

use crate::args::ConvergeArguments;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report::Report;
use fissure_files::Folder;
use std::path::Path;

/// The first line of a table.
pub(crate) const COLUMNS: &str = "quantity,unit,coarse,middle,fine,trend,order,extrapolated,uncertainty";
/// The title of a figure.
pub(crate) const TITLE: &str = "What changes with the size of cells";

/// Refuses one file for both, and what cannot be written without the loss of what is there: folders, and files that are
/// no table or figure of `converge`, as the scene and its drawing.
pub(crate) fn check(arguments: &ConvergeArguments) -> Result<(), Failure> {
    if let (Some(csv), Some(svg)) = (&arguments.csv, &arguments.svg)
        && csv == svg
    {
        let message = format!("`--csv` and `--svg` are one file, `{}`", csv.display());
        return Err(Failure::new(Exit::Usage, message, "give each a name of its own"));
    }
    let files = [("--csv", &arguments.csv, COLUMNS), ("--svg", &arguments.svg, TITLE)];
    for (flag, path, mark) in files.into_iter().filter_map(|(flag, path, mark)| Some((flag, path.as_deref()?, mark))) {
        let refuse = |why: &str| {
            let message = format!("`{flag} {}` would write over {why}", path.display());
            Failure::new(Exit::Usage, message, "name a file that is not there yet, or one of `fissure converge`")
        };
        if path.is_dir() {
            return Err(refuse("a folder"));
        }
        let (folder, name) = parts(path);
        if folder.read(name)?.is_some_and(|bytes| !String::from_utf8_lossy(&bytes).contains(mark)) {
            return Err(refuse("a file that `fissure converge` has not written"));
        }
    }
    Ok(())
}

/// Writes a file whose folder may be missing.
pub(crate) fn write(path: &Path, text: &str, report: &Report) -> Result<(), Failure> {
    let (folder, name) = parts(path);
    folder.make()?;
    folder.write(name, text.as_bytes())?;
    report.note(&format!("wrote `{}`", path.display()));
    Ok(())
}

fn parts(path: &Path) -> (Folder, &str) {
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    (Folder::new(parent.unwrap_or_else(|| Path::new("."))), name)
}
