//! The frame loop: from a scene to a take, resumable at every frame.

use crate::args::TakeArguments;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::folder::OutputFolder;
use crate::frame_set::FrameSet;
use crate::interrupt::Interrupt;
use crate::invocation;
use crate::moved::Moved;
use crate::pictures::remove_pictures;
use crate::preview;
use crate::progress::SimulationProgress;
use crate::report::Report;
use crate::tables::Tables;
use fissure_files::{Folder, Lock, LockError};
use fissure_post::Manifest;
use fissure_scene::{Frame, Opened, Provenance, Scene, Start, TakeError, TakeWriter};
use fissure_sim::{Simulation, SimulationError};
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
    /// The newest frame that has been computed.
    newest: i64,
    /// The frame at which to stop.
    last: i64,
    /// Whether that frame is not in the take yet: nobody has seen it.
    fresh: bool,
    /// The tables that are wanted.
    tables: Tables,
    /// No other process writes to the take as long as this lives.
    _lock: Lock,
}

/// Opens the take of `scene`: goes on with one that is there, or begins one. None: all frames asked for are there.
///
/// # Errors
/// When there is a take that cannot go on, another process writes to it, or a file cannot be used.
pub(crate) fn open(
    scene: &Scene,
    folder: &OutputFolder,
    arguments: &TakeArguments,
    frames: Option<&FrameSet>,
    report: &Report,
) -> Result<Option<Solve>, Failure> {
    let last = last_frame(scene, frames)?;
    // A scene that cannot be simulated leaves nothing behind.
    let begins = arguments.overwrite || !folder.take.path().exists();
    let begun = if begins { Some(Simulation::new(scene)?) } else { None };
    folder.take.make()?;
    let lock = folder.lock_take()?;
    let (writer, start) = if arguments.overwrite {
        let _meshes = folder.lock_meshes()?;
        Manifest::remove_meshes(&folder.root, &scene.name)?;
        remove_pictures(&Folder::new(folder.root.path().join(preview::FOLDER)), scene)?;
        (TakeWriter::replace(&folder.take, scene, provenance())?, Start::First)
    } else {
        let Opened { writer, start, remarks } = TakeWriter::open(&folder.take, scene, provenance(), last)?;
        remarks.iter().for_each(|remark| report.warn(&remark.to_string()));
        (writer, start)
    };
    let take = folder.take.path().display();
    let solve = |mut simulation: Simulation, writer, fresh| {
        let newest = simulation.frame_number();
        let tables = Tables::open(&arguments.tables, &folder.root, &mut simulation)?;
        Ok(Some(Solve { simulation, writer, newest, last, fresh, tables, _lock: lock }))
    };
    match start {
        Start::Complete => {
            report.note(&format!("`{take}` holds all frames up to {last} already"));
            Ok(None)
        }
        Start::First => {
            if let Some(newest) = writer.newest() {
                report.note(&format!(
                    "`{take}` holds the frames up to {newest} but no state to go on from: they are computed again and compared"
                ));
            }
            solve(begun.map_or_else(|| Simulation::new(scene), Ok)?, writer, true)
        }
        Start::At(saved) => {
            report.note(&format!("resuming `{take}` after frame {}", saved.frame));
            let simulation = Simulation::restore(scene, &saved.bytes).map_err(|error| useless_state(error, folder))?;
            let is_listed = writer.newest().is_some_and(|newest| newest >= saved.frame);
            solve(simulation, writer, !is_listed)
        }
    }
}

/// A state that is whole but none of this scene and program.
fn useless_state(error: SimulationError, folder: &OutputFolder) -> Failure {
    match error {
        SimulationError::BadState(cause) => {
            TakeError::DamagedState { path: folder.take.path().join("state.bin"), cause }.into()
        }
        other => other.into(),
    }
}

/// Who writes the take. Nothing is random yet.
fn provenance() -> Provenance {
    Provenance { tool_version: env!("CARGO_PKG_VERSION").to_owned(), seed: 0 }
}

/// The frame at which to stop.
///
/// # Errors
/// When frames are asked for that the scene does not have.
fn last_frame(scene: &Scene, frames: Option<&FrameSet>) -> Result<i64, Failure> {
    let (first, last) = (scene.frames.first, scene.frames.last);
    let Some(frames) = frames else { return Ok(last) };
    frames.must_be_in(first, last, "the scene")?;
    Ok(frames.last())
}

impl Solve {
    /// The present frame, as the take holds it.
    fn frame(&self) -> Frame {
        self.writer.held(self.simulation.frame_of(|frame| self.writer.chosen(frame)))
    }

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
        interrupt.finish_cleanly();
        let mut progress = SimulationProgress::new(report, self.newest, self.last);
        let frame = self.frame();
        // The state at the newest frame: what goes on after an interrupt in the middle of the next.
        let mut state = self.simulation.save()?;
        // A frame that is there already is held against what was restored.
        self.writer.write_frame(&frame, (self.newest == self.last).then_some(state.as_slice()))?;
        progress.frame(frame.number, &frame.tips);
        if self.fresh {
            hand_on(frame);
        }
        let mut state_written = Instant::now();
        let mut formulation = self.simulation.formulation();
        let mut moved = Moved::default();
        while self.newest < self.last {
            let (next, tables) = (self.newest + 1, &mut self.tables);
            let mut watch = |simulation: &Simulation, now: &fissure_sim::Progress| {
                progress.step(next, now);
                tables.step(simulation, next, now);
                if interrupt.is_set() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            };
            let goes_on = if interrupt.is_set() { Ok(false) } else { self.simulation.advance_observed(&mut watch) };
            if !matches!(goes_on, Ok(true)) {
                // After a failure too: the same command then fails again at once instead of after the whole way.
                self.writer.write_state(&state, self.newest)?;
                return goes_on.map(|_| Outcome::Interrupted).map_err(Failure::from);
            }
            let frame = self.frame();
            if self.simulation.formulation() != formulation {
                formulation = self.simulation.formulation();
                progress.note(&format!(
                    "frame {}: material is deformed beyond the total Lagrangian formulation; the run goes on in the updated one",
                    frame.number
                ));
            }
            // The one before is of no use any more, and large.
            drop(std::mem::take(&mut state));
            state = self.simulation.save()?;
            // At the end too: the take is then the same whether and when states were written on the way.
            let due = frame.number == self.last || state_written.elapsed() >= STATE_INTERVAL;
            self.writer.write_frame(&frame, due.then_some(state.as_slice()))?;
            if due {
                state_written = Instant::now();
            }
            self.tables.frame()?;
            self.newest = frame.number;
            progress.frame(frame.number, &frame.tips);
            moved.frame(&frame.tips);
            hand_on(frame);
        }
        drop(progress);
        if let Some(verdict) = moved.verdict(self.simulation.scene()).filter(|_| self.simulation.is_finished()) {
            report.warn(&verdict);
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
            invocation::to_go_on()
        ));
        return Exit::Interrupted;
    }
    let root = folder.root.path().to_string_lossy();
    report.note(&format!("done: `{root}`. To look at it: fissure preview {}", invocation::quoted(&root)));
    Exit::Done
}

impl From<TakeError> for Failure {
    fn from(error: TakeError) -> Self {
        let exit = match error {
            TakeError::OtherScene { .. } | TakeError::NoFrame { .. } => Exit::Usage,
            _ => Exit::File,
        };
        Self::new(exit, error.to_string(), error.remedy())
    }
}

impl From<LockError> for Failure {
    fn from(error: LockError) -> Self {
        match error {
            LockError::File(error) => error.into(),
            held => Self::new(
                Exit::File,
                held.to_string(),
                "wait until it has finished, stop it, or write elsewhere with --output",
            ),
        }
    }
}
