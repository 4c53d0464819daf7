//! `fissure sim`

use crate::args::SimArguments;
use crate::drawn::Wanted;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::folder::OutputFolder;
use crate::interrupt::Interrupt;
use crate::report::Report;
use crate::solve;
use crate::{scene_file, threads};

/// Simulates a scene into a take.
pub(crate) fn sim(arguments: &SimArguments, interrupt: &Interrupt, report: &Report) -> Result<Exit, Failure> {
    threads::set(arguments.take.threads)?;
    let output = arguments.take.output.as_deref();
    let wanted = Wanted { thickness: arguments.thickness, written: true, output };
    let file = scene_file::read(&arguments.scene, &wanted, report)?;
    let folder = OutputFolder::of(file.scene(), &arguments.take);
    let solve = solve::open(file.scene(), &folder, &arguments.take, arguments.frames.as_ref(), report)
        .map_err(|failure| file.show(failure))?;
    let Some(solve) = solve else {
        return Ok(Exit::Done);
    };
    let outcome = solve.run(interrupt, report, &mut |_| ())?;
    Ok(solve::close(outcome, &folder, interrupt, report))
}
