//! `fissure verify`

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
    for (position, case) in cases.iter().enumerate() {
        let bar = report.draws_bars().then(ProgressBar::new_spinner);
        if let Some(bar) = &bar {
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
        let found = found.map_err(|error| Failure::from(error).during(format!("case `{}`", case.name)))?;
        let text = if arguments.markdown {
            fissure_verify::markdown(&found, threads)
        } else {
            fissure_verify::text(&found, threads)
        };
        let gap = if position > 0 && !arguments.markdown { "\n" } else { "" };
        report::print(&format!("{gap}{text}"))?;
    }
    Ok(Exit::Done)
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
