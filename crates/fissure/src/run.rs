//! `fissure run`: the solver and the makers of meshes side by side.

use crate::args::{PreviewArguments, RunArguments};
use crate::drawn::Wanted;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::folder::OutputFolder;
use crate::interrupt::Interrupt;
use crate::meshes::{Mesher, must_show};
use crate::report::Report;
use crate::solve::{self, Outcome};
use crate::workers::{Work, stream};
use crate::{preview, scene_file, threads};
use fissure_post::Manifest;
use fissure_scene::Take;

/// Simulates a scene and writes its meshes while the solver goes on.
pub(crate) fn run(arguments: &RunArguments, interrupt: &Interrupt, report: &Report) -> Result<Exit, Failure> {
    let threads = threads::set(arguments.take.threads)?;
    let output = arguments.take.output.as_deref();
    let wanted = Wanted { thickness: arguments.mesh.thickness, written: true, output };
    let file = scene_file::read(&arguments.scene, &wanted, report)?;
    let scene = file.scene();
    let folder = OutputFolder::of(scene, &arguments.take);
    // Told before anything is computed.
    must_show(scene, &arguments.mesh)?;
    Manifest::read(&folder.root, &scene.name, &scene.hash)?;
    let wanted = |number: i64| arguments.frames.as_ref().is_none_or(|frames| frames.contains(number));
    let solve = solve::open(scene, &folder, &arguments.take, arguments.frames.as_ref(), report)
        .map_err(|failure| file.show(failure))?;
    let _lock = folder.lock_meshes()?;
    folder.root.remove_drafts()?;
    let mesher = Mesher::new(scene, &folder.root, &arguments.mesh, report)?;
    // Frames of an earlier run: their meshes may be missing or be of other options.
    let take = Take::read(&folder.take)?;
    let earlier = solve.as_ref().map_or(i64::MAX, |solve| solve.first_new_frame()).min(scene.frames.last + 1);
    let backlog = take.frame_numbers().into_iter().filter(|&number| number < earlier && wanted(number));
    let work = |work: Work| match work {
        Work::New(frame) => mesher.make(frame.number, || Ok(*frame)),
        Work::InTake(_) if interrupt.is_set() => {}
        Work::InTake(number) => mesher.make(number, || Ok(take.frame(number)?)),
    };
    interrupt.finish_cleanly();
    let outcome = stream(threads::mesh_workers(threads), backlog, &work, |send| match solve {
        Some(solve) => solve.run(interrupt, report, &mut |frame| {
            if wanted(frame.number) {
                send(frame);
            }
        }),
        None => Ok(Outcome::Complete),
    })?;
    if matches!(outcome, Ok(Outcome::Complete)) {
        let take = Take::read(&folder.take)?;
        let numbers: Vec<i64> = take.frame_numbers().into_iter().filter(|&number| wanted(number)).collect();
        mesher.make_sequences(&take, &numbers, interrupt);
    }
    // The solver's failure says more than those of the meshes, which have been reported one by one.
    let meshes = mesher.finish();
    let outcome = outcome?;
    meshes?;
    let exit = solve::close(outcome, &folder, interrupt, report);
    if exit == Exit::Done && arguments.preview {
        let everything = PreviewArguments::everything_of(folder.take.path().to_owned());
        return preview::draw(&everything, threads, interrupt, report);
    }
    Ok(exit)
}
