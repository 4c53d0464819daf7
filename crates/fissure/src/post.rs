//! `fissure post`

use crate::args::PostArguments;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::meshes::Mesher;
use crate::progress::MeshProgress;
use crate::report::Report;
use crate::threads;
use crate::workers::{Work, stream};
use fissure_files::Folder;
use fissure_scene::Take;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Writes the meshes of a take.
pub(crate) fn post(arguments: &PostArguments, report: &Report) -> Result<Exit, Failure> {
    let threads = threads::set(arguments.threads)?;
    let take = Take::open(&arguments.take)?;
    let wanted = |number: &i64| arguments.frames.as_ref().is_none_or(|frames| frames.contains(*number));
    let numbers: Vec<i64> = take.frame_numbers().into_iter().filter(wanted).collect();
    if let (true, Some(frames)) = (numbers.is_empty(), &arguments.frames) {
        return Err(Failure::new(
            Exit::Usage,
            format!("the take has none of the frames {frames}"),
            format!("it has the frames {}", extent(&take.frame_numbers())),
        ));
    }
    let folder = match &arguments.output {
        Some(folder) => folder.clone(),
        None => {
            arguments.take.canonicalize().ok().and_then(|path| path.parent().map(Path::to_owned)).unwrap_or_default()
        }
    };
    let folder = Folder::new(folder);
    folder.make()?;
    let interrupt = Interrupt::listen();
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
    stream(threads, numbers.iter().copied(), &work, |_| ());
    drop(progress);
    mesher.finish()?;
    if interrupt.is_set() {
        report.note("interrupted; run the same command again");
        return Ok(Exit::Interrupted);
    }
    report.note(&format!("wrote the meshes of {} frames into `{}`", numbers.len(), folder.path().display()));
    Ok(Exit::Done)
}

/// First and last of a list.
fn extent(frames: &[i64]) -> String {
    match frames {
        [] => "none".to_owned(),
        [only] => only.to_string(),
        [first, .., last] => format!("{first}-{last}"),
    }
}
