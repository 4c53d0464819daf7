//! `fissure post`

use crate::args::PostArguments;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::invocation;
use crate::meshes::{Mesher, must_show};
use crate::progress::{Made, TakeProgress};
use crate::report::Report;
use crate::workers::{Work, stream};
use crate::{take_path, threads};
use fissure_files::{Folder, Lock};
use std::sync::{Mutex, PoisonError};

/// Writes the meshes of a take.
pub(crate) fn post(arguments: &PostArguments, interrupt: &Interrupt, report: &Report) -> Result<Exit, Failure> {
    let threads = threads::set(arguments.threads)?;
    let (path, take) = take_path::open(&arguments.take)?;
    let scene = fissure_scene::with_output(take.scene(), &arguments.overrides)?;
    must_show(&scene, &arguments.mesh)?;
    let numbers = take_path::chosen_frames(&take, &path, arguments.frames.as_ref())?;
    take.remarks()?.iter().for_each(|remark| report.warn(&remark.to_string()));
    if !scene.output.attributes.is_empty() && !take.tells_how_cracks_formed() {
        report.warn("this take is of a version that does not say how cracks formed: meshes lack `output.attributes`; `fissure run --overwrite` simulates it again");
    }
    let folder = match &arguments.output {
        Some(folder) => folder.clone(),
        None => take_path::folder_of(&path),
    };
    let folder = Folder::new(folder);
    folder.make()?;
    let _lock = Lock::take(folder.path(), &invocation::typed())?;
    folder.remove_drafts()?;
    let mesher = Mesher::new(&scene, &folder, &arguments.mesh, report)?;
    let progress = Mutex::new(TakeProgress::new(report, Made::Meshes, numbers.len()));
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
    mesher.make_sequences(&take, &numbers, interrupt);
    mesher.finish()?;
    if interrupt.is_set() {
        report.note("interrupted; run the same command again");
        return Ok(Exit::Interrupted);
    }
    report.note(&format!("wrote the meshes of {} frames into `{}`", numbers.len(), folder.path().display()));
    Ok(Exit::Done)
}
