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
    // A case that fails does not keep the others from their turn.
    let mut first_failure = None;
    let runs = cases.iter().flat_map(|case| runs(case, arguments, cases.len() > 1).map(move |options| (case, options)));
    for (position, (case, options)) in runs.enumerate() {
        let text = match run(case, &options, report) {
            Ok(found) if arguments.markdown => fissure_verify::markdown(&found, threads),
            Ok(found) => fissure_verify::text(&found, threads),
            Err(failure) => {
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

/// How a case is run: at several places, and before that as it is drawn with its standard resolution where that is
/// another one.
fn runs(case: &Case, arguments: &VerifyArguments, is_one_of_many: bool) -> impl Iterator<Item = Options> + use<> {
    let places = usize::from(arguments.places);
    let places = if is_one_of_many && case.is_long { places.div_ceil(4) } else { places };
    let options = Options { cells: arguments.cells, places, seed: arguments.seed, scheme: None };
    let is_coarser = places > 1 && arguments.cells.is_none() && case.family_cells != case.cells.1;
    is_coarser.then_some(Options { places: 1, ..options }).into_iter().chain([options])
}

/// Runs a case and shows what it is at.
fn run(case: &Case, options: &Options, report: &Report) -> Result<fissure_verify::Report, Failure> {
    let bar = report.draws_bars().then(ProgressBar::new_spinner);
    if let Some(bar) = bar.as_ref().filter(|_| threads::are_to_be_had()) {
        bar.enable_steady_tick(Duration::from_millis(200));
    }
    report.set_bar(bar.clone());
    let found = case.run(options, &mut |what| {
        if let Some(bar) = &bar {
            bar.set_message(format!("{}: {what}", case.name));
        }
    });
    report.set_bar(None);
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
    found.map_err(|error| Failure::from(error).during(format!("case `{}`", case.name)))
}

fn list() -> String {
    let line = |case: &Case| {
        let (along, standard) = case.cells;
        let family = if case.family_cells == standard {
            String::new()
        } else {
            format!(", {} at several places", case.family_cells)
        };
        format!("{:<18} {} [{standard} cells {along}{family}]\n", case.name, case.about)
    };
    CASES.iter().map(line).collect()
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
