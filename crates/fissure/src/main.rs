//! The program `fissure`: from a scene to cracked mesh sequences. The numbers it ends with are in [`exit::Exit`].

mod args;
mod caution;
mod chart;
mod check;
mod completions;
mod converge;
mod convergence_files;
mod convergence_plot;
mod dial;
mod drawn;
mod exit;
mod failure;
mod folder;
mod frame_set;
mod interrupt;
mod invocation;
mod man;
mod meshes;
mod moved;
mod new;
mod pictures;
mod post;
mod preview;
mod progress;
mod report;
mod richardson;
mod run;
mod scene_file;
mod schema;
mod sim;
mod solve;
mod tables;
mod take_path;
mod threads;
mod verify;
mod workers;

use args::{Arguments, Command};
use clap::Parser;
use exit::Exit;
use failure::Failure;
use interrupt::Interrupt;
use report::Report;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help and version come this way too. Nobody is left to tell when the pipe is closed.
            drop(error.print());
            return if error.use_stderr() { Exit::Usage } else { Exit::Done }.into();
        }
    };
    let interrupt = Interrupt::listen(arguments.talk);
    let report = Report::new(arguments.talk);
    match execute(&arguments.command, &interrupt, &report) {
        Ok(exit) => exit.into(),
        Err(failure) => {
            report.error(&failure);
            failure.exit.into()
        }
    }
}

fn execute(command: &Command, interrupt: &Interrupt, report: &Report) -> Result<Exit, Failure> {
    match command {
        Command::New(arguments) => new::new(arguments, report),
        Command::Check(arguments) => check::check(arguments, report),
        Command::Run(arguments) => run::run(arguments, interrupt, report),
        Command::Sim(arguments) => sim::sim(arguments, interrupt, report),
        Command::Post(arguments) => post::post(arguments, interrupt, report),
        Command::Preview(arguments) => preview::preview(arguments, interrupt, report),
        Command::Verify(arguments) => verify::verify(arguments, report),
        Command::Converge(arguments) => converge::converge(arguments, interrupt, report),
        Command::Chart(arguments) => chart::chart(arguments, report),
        Command::Schema => schema::schema(),
        Command::Completions(arguments) => completions::completions(arguments),
        Command::Man(arguments) => man::man(arguments, report),
    }
}
