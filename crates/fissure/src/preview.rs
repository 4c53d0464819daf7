//! `fissure preview`

use crate::args::{ColorBy, PictureKind, PreviewArguments, ThemeName};
use crate::exit::Exit;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::invocation;
use crate::pictures::Pictures;
use crate::progress::{Made, TakeProgress};
use crate::report::Report;
use crate::workers::{Work, stream};
use crate::{take_path, threads};
use fissure_files::{Folder, Lock};
use fissure_preview::{Coloring, PreviewOptions, Series, Survey, Table, Theme, View};
use fissure_scene::{HeldParticles, Take};
use std::sync::{Mutex, PoisonError};

/// Folder of the pictures, in that of the take.
pub(crate) const FOLDER: &str = "preview";

/// Draws pictures of a take.
pub(crate) fn preview(arguments: &PreviewArguments, interrupt: &Interrupt, report: &Report) -> Result<Exit, Failure> {
    let threads = threads::set(arguments.threads)?;
    draw(arguments, threads, interrupt, report)
}

/// The same on `threads` threads, of which the program has been told.
///
/// # Errors
/// When there is no take, a frame of it cannot be drawn, or a file cannot be written.
pub(crate) fn draw(
    arguments: &PreviewArguments,
    threads: usize,
    interrupt: &Interrupt,
    report: &Report,
) -> Result<Exit, Failure> {
    let (path, take) = take_path::open(&arguments.run)?;
    let numbers = take_path::chosen_frames(&take, &path, arguments.frames.as_ref())?;
    take.remarks()?.iter().for_each(|remark| report.warn(&remark.to_string()));
    let options = options(arguments);
    must_be_held(take.scene().take.particles, options.coloring)?;
    let kinds = kinds(arguments);
    let (mut survey, mut series) = (Survey::new(options.coloring), Series::default());
    for &number in &numbers {
        let frame = take.frame(number)?;
        survey.add(&frame);
        if arguments.html {
            series.add(take.scene(), &frame);
        }
    }
    if arguments.html {
        take_up_tables(&mut series, &take, &Folder::new(take_path::folder_of(&path)), report)?;
    }
    let explode = take.scene().output.explode.iter().flat_map(|curve| &curve.points);
    survey.spread(explode.map(|&(_, factor)| factor).fold(0.0, f64::max));
    let folder = arguments.output.clone().unwrap_or_else(|| take_path::folder_of(&path).join(FOLDER));
    let folder = Folder::new(folder);
    folder.make()?;
    let _lock = Lock::take(folder.path(), &invocation::typed())?;
    folder.remove_drafts()?;
    let pictures = Pictures::new(take.scene(), &folder, &kinds, &numbers, &survey, options, report);
    pictures.replace_nothing_foreign(&numbers)?;
    let progress = Mutex::new(TakeProgress::new(report, Made::Pictures, numbers.len()));
    let work = |work: Work| {
        let Work::InTake(number) = work else { return };
        // Each frame not begun when the user asks to stop stays undone.
        if !interrupt.is_set() {
            pictures.make(number, || Ok(take.frame(number)?));
            progress.lock().unwrap_or_else(PoisonError::into_inner).frame(number);
        }
    };
    interrupt.finish_cleanly();
    stream(threads, numbers.iter().copied(), &work, |_| ())?;
    drop(progress);
    if interrupt.is_set() {
        report.note("interrupted; run the same command again");
        return Ok(Exit::Interrupted);
    }
    let written = pictures.finish(&series)?;
    report.note(&format!("wrote {written} into `{}`", folder.path().display()));
    Ok(Exit::Done)
}

/// Takes the curves of the tables that the run has written beside its take, where there are any.
fn take_up_tables(series: &mut Series, take: &Take, folder: &Folder, report: &Report) -> Result<(), Failure> {
    for table in Table::ALL {
        let name = format!("{}.{}.csv", take.scene().name, table.word());
        let Some(bytes) = folder.read(&name)? else { continue };
        if let Err(error) = series.take_up(take.scene(), table, &String::from_utf8_lossy(&bytes)) {
            report.warn(&format!(
                "`{}` is not used, {error}; curves are those of the frames. `fissure run --tables` writes it",
                folder.place(&name)?.display()
            ));
        }
    }
    Ok(())
}

/// That a take with these particles can be drawn so.
///
/// # Errors
/// When there is nothing to take the colours from.
fn must_be_held(particles: HeldParticles, coloring: Coloring) -> Result<(), Failure> {
    if particles > HeldParticles::None || coloring == Coloring::Fragment {
        return Ok(());
    }
    let message = "the take holds no particles to take the colours from (`take.particles` is \"none\")";
    Err(Failure::new(
        Exit::Usage,
        message,
        "draw it with --color fragment, or simulate again with `take.particles` \"surface\" or \"full\"",
    ))
}

/// What is to be made.
fn kinds(arguments: &PreviewArguments) -> Vec<PictureKind> {
    let mut kinds = arguments.pictures.clone();
    if arguments.html {
        kinds.push(PictureKind::Page);
    } else if kinds.is_empty() {
        kinds.extend([PictureKind::Frames, PictureKind::Sheet, PictureKind::Gif]);
    }
    kinds
}

/// What was typed, as the crate that draws says it.
fn options(arguments: &PreviewArguments) -> PreviewOptions {
    PreviewOptions {
        width: arguments.size,
        coloring: match arguments.color {
            ColorBy::Fragment => Coloring::Fragment,
            ColorBy::Stress => Coloring::Stress,
            ColorBy::Speed => Coloring::Speed,
        },
        theme: match arguments.theme {
            ThemeName::Light => Theme::Light,
            ThemeName::Dark => Theme::Dark,
        },
        view: View { yaw: arguments.yaw.to_radians(), pitch: arguments.pitch.to_radians() },
    }
}

impl PictureKind {
    /// What is said of it at the end.
    pub(crate) fn told(self, frames: usize) -> String {
        match self {
            Self::Frames => format!("{frames} pictures"),
            Self::Sheet => "a contact sheet".to_owned(),
            Self::Gif => "an animation".to_owned(),
            Self::Page => "a page".to_owned(),
        }
    }
}
