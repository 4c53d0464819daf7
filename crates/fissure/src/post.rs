//! `fissure post`

use crate::args::PostArguments;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::invocation;
use crate::meshes::Mesher;
use crate::progress::MeshProgress;
use crate::report::Report;
use crate::threads;
use crate::workers::{Work, stream};
use fissure_files::{Folder, Lock};
use fissure_scene::Take;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Writes the meshes of a take.
pub(crate) fn post(arguments: &PostArguments, interrupt: &Interrupt, report: &Report) -> Result<Exit, Failure> {
    let threads = threads::set(arguments.threads)?;
    let path = take_in(&arguments.take)?;
    let take = Take::open(&path)?;
    let held = take.frame_numbers();
    let (Some(&first), Some(&last)) = (held.first(), held.last()) else {
        return Err(Failure::new(
            Exit::File,
            format!("`{}` holds no frames yet", arguments.take.display()),
            "wait for the first one, or `fissure run` its scene again",
        ));
    };
    if let Some(frames) = &arguments.frames {
        frames.must_be_in(first, last, "the take")?;
    }
    let wanted = |number: &i64| arguments.frames.as_ref().is_none_or(|frames| frames.contains(*number));
    let numbers: Vec<i64> = held.into_iter().filter(wanted).collect();
    take.remarks()?.iter().for_each(|remark| report.warn(&remark.to_string()));
    let folder = match &arguments.output {
        Some(folder) => folder.clone(),
        None => path.canonicalize().ok().and_then(|path| path.parent().map(Path::to_owned)).unwrap_or_default(),
    };
    let folder = Folder::new(folder);
    folder.make()?;
    let _lock = Lock::take(folder.path(), &invocation::typed())?;
    folder.remove_drafts()?;
    let mesher = Mesher::new(take.scene(), &folder, &arguments.mesh, report)?;
    let progress = Mutex::new(MeshProgress::new(report, numbers.len()));
    let work = |work: Work| {
        let Work::InTake(number) = work else { return };
        // Each frame not begun when the user asks to stop stays undone.
        if !interrupt.is_set() {
            mesher.make(number, || Ok(take.frame(number)?));
            progress.lock().unwrap_or_else(PoisonError::into_inner).frame(number);
        }
    };
    interrupt.finish_cleanly();
    stream(threads, numbers.iter().copied(), &work, |_| ())?;
    drop(progress);
    mesher.finish()?;
    if interrupt.is_set() {
        report.note("interrupted; run the same command again");
        return Ok(Exit::Interrupted);
    }
    report.note(&format!("wrote the meshes of {} frames into `{}`", numbers.len(), folder.path().display()));
    Ok(Exit::Done)
}

/// The take meant by `path`: itself, or the one in a folder of meshes.
fn take_in(path: &Path) -> Result<PathBuf, Failure> {
    let is_take = |path: &Path| path.extension().is_some_and(|extension| extension == "take") && path.is_dir();
    let Ok(entries) = std::fs::read_dir(path) else { return Ok(path.to_owned()) };
    if is_take(path) {
        return Ok(path.to_owned());
    }
    let mut takes: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|p| is_take(p)).collect();
    takes.sort();
    match takes.as_slice() {
        // Whatever it is called, it may be a take.
        [] => Ok(path.to_owned()),
        [only] => Ok(only.clone()),
        several => {
            let names: Vec<String> = several.iter().take(6).map(|take| format!("`{}`", take.display())).collect();
            let message = format!("the folder `{}` holds {} takes", path.display(), several.len());
            Err(Failure::new(Exit::Usage, message, format!("name one of them: {}", names.join(", "))))
        }
    }
}
