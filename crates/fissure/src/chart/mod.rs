//! `fissure chart`: what is measured goes into tables, row by row, and figures are drawn of these. The same command
//! goes on where it was interrupted.

mod accuracy;
mod dial;
mod examples;
mod features;
mod origin;
mod shape;
mod speed;
mod stability;
mod stages;
mod table;
mod thesis;
mod visual;

use crate::args::{ChartArguments, ChartName};
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report::Report;
use crate::threads;
use fissure_files::Folder;
use indicatif::ProgressBar;
use origin::Origin;
use std::time::Duration;

/// What all charts are made with.
struct Charting<'a> {
    folder: Folder,
    origin: Origin,
    /// Few and coarse runs, which show the shape.
    quick: bool,
    report: &'a Report,
}

/// Measures and draws the charts asked for.
pub(crate) fn chart(arguments: &ChartArguments, report: &Report) -> Result<Exit, Failure> {
    let threads = threads::set(arguments.threads)?;
    let folder = Folder::new(&arguments.output);
    folder.make()?;
    let charting =
        Charting { folder, origin: Origin::of_now(threads, arguments.quick), quick: arguments.quick, report };
    for chart in ChartName::ALL {
        if arguments.name.is_none_or(|name| name == chart) {
            match chart {
                ChartName::Accuracy => accuracy::chart(&charting)?,
                ChartName::Features => features::chart(&charting)?,
                ChartName::Dial => dial::chart(&charting)?,
                ChartName::Stability => stability::chart(&charting)?,
                ChartName::Speed => speed::chart(&charting)?,
                ChartName::Stages => stages::chart(&charting, &arguments.examples)?,
                ChartName::Visual => visual::chart(&charting, &arguments.examples)?,
                ChartName::Thesis => thesis::chart(&charting, &arguments.examples)?,
            }
        }
    }
    report.note(&format!("done: `{}`", charting.folder.path().display()));
    Ok(Exit::Done)
}

impl Charting<'_> {
    /// Shows what is measured while `work` goes on; `work` is given what says it.
    fn showing<T>(&self, task: &str, work: impl FnOnce(&mut (dyn FnMut(&str) + Send)) -> T) -> T {
        let bar = self.report.draws_bars().then(ProgressBar::new_spinner);
        if let Some(bar) = bar.as_ref().filter(|_| threads::are_to_be_had()) {
            bar.enable_steady_tick(Duration::from_millis(200));
        }
        self.report.set_bar(bar.clone());
        let done = work(&mut |what| {
            if let Some(bar) = &bar {
                bar.set_message(format!("{task}: {what}"));
            }
        });
        self.report.set_bar(None);
        if let Some(bar) = bar {
            bar.finish_and_clear();
        }
        done
    }

    /// Writes a figure beside its table.
    fn draw(&self, name: &str, figure: &fissure_chart::Figure) -> Result<(), Failure> {
        self.folder.write(&format!("{name}.svg"), figure.to_svg().as_bytes())?;
        self.report.note(&format!("drew {name}.svg"));
        Ok(())
    }
}
