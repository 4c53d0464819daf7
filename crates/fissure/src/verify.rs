//! `fissure verify`: a missed target is a result and no failure; only a run that fails is.

use crate::args::VerifyArguments;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report::{self, Report};
use crate::threads;
use fissure_verify::{CASES, Case, Options};
use indicatif::ProgressBar;
use std::time::Duration;

/// Runs reference cases and prints what they gave beside what they should.
pub(crate) fn verify(arguments: &VerifyArguments, report: &Report) -> Result<Exit, Failure> {
    if arguments.list {
        report::print(&list())?;
        return Ok(Exit::Done);
    }
    let cases = chosen(arguments)?;
    let threads = threads::set(arguments.threads)?;
    let options = Options { cells: arguments.cells, all_offsets: arguments.all_offsets };
    // A case that fails does not keep the others from their turn.
    let mut first_failure = None;
    for (position, case) in cases.iter().enumerate() {
        let bar = report.draws_bars().then(ProgressBar::new_spinner);
        if let Some(bar) = bar.as_ref().filter(|_| threads::are_to_be_had()) {
            bar.enable_steady_tick(Duration::from_millis(200));
        }
        report.set_bar(bar.clone());
        let found = case.run(&options, &mut |what| {
            if let Some(bar) = &bar {
                bar.set_message(format!("{}: {what}", case.name));
            }
        });
        report.set_bar(None);
        if let Some(bar) = bar {
            bar.finish_and_clear();
        }
        let text = match found {
            Ok(found) if arguments.markdown => fissure_verify::markdown(&found, threads),
            Ok(found) => fissure_verify::text(&found, threads),
            Err(error) => {
                let failure = Failure::from(error).during(format!("case `{}`", case.name));
                if cases.len() == 1 {
                    return Err(failure);
                }
                report.error(&failure);
                let text =
                    format!("{}{}: {}\n", if arguments.markdown { "## " } else { "" }, case.name, failure.message);
                first_failure.get_or_insert(failure);
                text
            }
        };
        let gap = if position > 0 && !arguments.markdown { "\n" } else { "" };
        report::print(&format!("{gap}{text}"))?;
    }
    match first_failure {
        Some(failure) => Err(failure.during("not every case ran to its end")),
        None => Ok(Exit::Done),
    }
}

fn list() -> String {
    CASES.iter().map(|c| format!("{:<18} {} [{} cells {}]\n", c.name, c.about, c.cells.1, c.cells.0)).collect()
}

fn chosen(arguments: &VerifyArguments) -> Result<Vec<&'static Case>, Failure> {
    let name = arguments.name.as_deref();
    if arguments.all || name == Some("all") {
        return Ok(CASES.iter().collect());
    }
    let Some(name) = name else {
        return Err(Failure::new(
            Exit::Usage,
            "no case named",
            "name one of `fissure verify --list`, or run them all with `fissure verify all`",
        ));
    };
    let found = fissure_verify::find(name).ok_or_else(|| {
        Failure::new(
            Exit::Usage,
            format!("there is no case `{name}`"),
            format!("the cases are: {}, all", CASES.iter().map(|c| c.name).collect::<Vec<_>>().join(", ")),
        )
    })?;
    Ok(vec![found])
}
