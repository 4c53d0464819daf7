//! The frame loop: from a scene to a take, resumable at every frame.

use crate::args::TakeArguments;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::folder::OutputFolder;
use crate::frame_set::FrameSet;
use crate::interrupt::Interrupt;
use crate::progress::SimulationProgress;
use crate::report::Report;
use fissure_scene::{Frame, Provenance, Scene, Take, TakeError, TakeWriter};
use fissure_sim::Simulation;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// The state of the solver goes to disk at most this often: it is as large as a frame, and what a crash loses is
/// computed again.
const STATE_INTERVAL: Duration = Duration::from_secs(10);

/// How a simulation ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// At the last frame asked for.
    Complete,
    /// Before it, because the user asked to stop.
    Interrupted,
}

/// A simulation with its take, ready to go on.
#[derive(Debug)]
pub(crate) struct Solve {
    simulation: Simulation,
    writer: TakeWriter,
    /// The newest frame that is in the take.
    newest: i64,
    /// The frame at which to stop.
    last: i64,
    /// Whether the newest frame is the state at rest, which nobody has seen yet.
    fresh: bool,
}

/// Opens the take of `scene`: goes on with one that is there, or begins one. None: all frames asked for are there.
///
/// # Errors
/// When there is a take of another scene, or a file cannot be used.
pub(crate) fn open(
    scene: &Scene,
    folder: &OutputFolder,
    arguments: &TakeArguments,
    frames: Option<&FrameSet>,
    report: &Report,
) -> Result<Option<Solve>, Failure> {
    let last = last_frame(scene, frames)?;
    let path = folder.take.path();
    if !path.exists() {
        return begin(scene, folder, last).map(Some);
    }
    if arguments.overwrite {
        fissure_post::Manifest::remove_meshes(&folder.root, &scene.name)?;
        return begin(scene, folder, last).map(Some);
    }
    let take = Take::open(path)?;
    if take.scene().hash != scene.hash {
        return Err(Failure::new(
            Exit::Usage,
            format!("`{}` is a take of another scene, or of this one with other settings", path.display()),
            "start afresh with --overwrite, or keep it and write elsewhere with --output",
        ));
    }
    if take.frame_numbers().last().is_some_and(|&newest| newest >= last) {
        report.note(&format!("`{}` holds all frames up to {last} already", path.display()));
        return Ok(None);
    }
    let (writer, saved) = TakeWriter::resume(path, scene, provenance())?;
    let Some(saved) = saved else {
        // The run before ended before its first state was saved, or was one of another version.
        return begin(scene, folder, last).map(Some);
    };
    let simulation = Simulation::restore(scene, &saved.bytes)?;
    report.note(&format!("resuming `{}` after frame {}", path.display(), saved.frame));
    Ok(Some(Solve { simulation, writer, newest: saved.frame, last, fresh: false }))
}

fn begin(scene: &Scene, folder: &OutputFolder, last: i64) -> Result<Solve, Failure> {
    let simulation = Simulation::new(scene)?;
    folder.root.make()?;
    let mut writer = TakeWriter::create(folder.take.path(), scene, provenance())?;
    let frame = simulation.frame();
    writer.write_frame(&frame)?;
    Ok(Solve { simulation, writer, newest: frame.number, last, fresh: true })
}

/// Who writes the take. Nothing is random yet.
fn provenance() -> Provenance {
    Provenance { tool_version: env!("CARGO_PKG_VERSION").to_owned(), seed: 0 }
}

/// The frame at which to stop.
fn last_frame(scene: &Scene, frames: Option<&FrameSet>) -> Result<i64, Failure> {
    let (first, last) = (scene.frames.first, scene.frames.last);
    let Some(frames) = frames else { return Ok(last) };
    if !(first..=last).any(|number| frames.contains(number)) {
        return Err(Failure::new(
            Exit::Usage,
            format!("the scene has none of the frames {frames}"),
            format!("it has the frames {first}-{last}"),
        ));
    }
    Ok(frames.last().min(last))
}

impl Solve {
    /// The first frame that will be handed on.
    pub(crate) fn first_new_frame(&self) -> i64 {
        if self.fresh { self.newest } else { self.newest + 1 }
    }

    /// Runs to the last frame asked for, writes the take and hands on each new frame.
    ///
    /// # Errors
    /// When the simulation fails or the take cannot be written; the frames so far stay valid.
    pub(crate) fn run(
        mut self,
        interrupt: &Interrupt,
        report: &Report,
        hand_on: &mut dyn FnMut(Frame),
    ) -> Result<Outcome, Failure> {
        let mut progress = SimulationProgress::new(report, self.newest, self.last);
        let frame = self.simulation.frame();
        progress.frame(frame.number, &frame.tips);
        if self.fresh {
            hand_on(frame);
        }
        // The state at the newest frame: what goes on after an interrupt in the middle of the next.
        let mut state = self.simulation.save();
        let mut state_written = Instant::now();
        let mut formulation = self.simulation.formulation();
        while self.newest < self.last {
            let mut watch = |now: &fissure_sim::Progress| {
                progress.step(self.newest + 1, now);
                if interrupt.is_set() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            };
            let goes_on = if interrupt.is_set() { Ok(false) } else { self.simulation.advance(&mut watch) };
            if !matches!(goes_on, Ok(true)) {
                // After a failure too: the same command then fails again at once instead of after the whole way.
                self.writer.write_state(&state, self.newest)?;
                return goes_on.map(|_| Outcome::Interrupted).map_err(Failure::from);
            }
            let frame = self.simulation.frame();
            if self.simulation.formulation() != formulation {
                formulation = self.simulation.formulation();
                progress.note(&format!(
                    "frame {}: material is deformed beyond the total Lagrangian formulation; the run goes on in the updated one",
                    frame.number
                ));
            }
            self.writer.write_frame(&frame)?;
            self.newest = frame.number;
            progress.frame(frame.number, &frame.tips);
            hand_on(frame);
            state = self.simulation.save();
            if state_written.elapsed() >= STATE_INTERVAL {
                self.writer.write_state(&state, self.newest)?;
                state_written = Instant::now();
            }
        }
        // At the end too: the take is then the same whether and when states were written on the way.
        self.writer.write_state(&state, self.newest)?;
        if self.simulation.is_finished() {
            self.writer.finish()?;
        }
        Ok(Outcome::Complete)
    }
}

/// Says where things are, and how to go on if there is more to do.
pub(crate) fn close(outcome: Outcome, folder: &OutputFolder, interrupt: &Interrupt, report: &Report) -> Exit {
    if outcome == Outcome::Interrupted || interrupt.is_set() {
        report.warn(&format!(
            "interrupted; `{}` is readable. To go on: {}",
            folder.take.path().display(),
            same_command()
        ));
        return Exit::Interrupted;
    }
    report.note(&format!("done: `{}`", folder.root.path().display()));
    Exit::Done
}

/// The command line as it was typed, quoted for a shell.
fn same_command() -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+@%".contains(c);
    let quote = |word: String| {
        let bare = !word.is_empty() && word.chars().all(plain);
        if bare { word } else { format!("'{}'", word.replace('\'', r"'\''")) }
    };
    let words = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned());
    // Starting afresh again is not going on.
    let typed = words.filter(|word| word != "--overwrite").map(quote);
    std::iter::once("fissure".to_owned()).chain(typed).collect::<Vec<_>>().join(" ")
}

impl From<TakeError> for Failure {
    fn from(error: TakeError) -> Self {
        let exit = match error {
            TakeError::OtherScene { .. } | TakeError::NoFrame { .. } => Exit::Usage,
            _ => Exit::File,
        };
        // These messages name the file and the remedy.
        Self { exit, message: error.to_string(), remedy: None, snippet: None }
    }
}
