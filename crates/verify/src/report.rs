//! What a case found, beside what it should have found.

use crate::placed::{Moment, Placed};
use crate::placement::Placement;
use crate::problem::Problem;
use crate::scheme::Scheme;
use fissure_sim::SimulationError;
use std::ops::ControlFlow;

/// Told now and then what is being computed.
pub type Progress<'a> = &'a mut (dyn FnMut(&str) + Send);

/// Kinetic energy at rest, as a part of the strain energy: from 1e-8 on, K_I of edge cracks changes by less than 1e-3.
const REST: f64 = 1e-8;
/// Steps to rest at most; long beams need the most, 12000.
const MOST_STEPS: u64 = 20_000;

/// What a computed number is held against.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Expected {
    /// A reference; the error is relative to it. `within`: the target as a fraction of it, where there is one.
    Relative {
        /// Reference, unit of the row.
        reference: f64,
        /// Largest error wanted [–].
        within: Option<f64>,
    },
    /// A reference; the error is the difference.
    Absolute {
        /// Reference, unit of the row.
        reference: f64,
        /// Largest error wanted, unit of the row.
        within: Option<f64>,
    },
    /// A bound that the number should not exceed.
    AtMost(f64),
    /// A bound that the number should not fall below.
    AtLeast(f64),
    /// Two bounds.
    Between(f64, f64),
}

/// One line of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// What was computed.
    pub quantity: String,
    /// Its unit; empty for a pure number.
    pub unit: &'static str,
    /// Its value.
    pub computed: f64,
    /// What it is held against.
    pub expected: Expected,
    /// Where the case was computed at several places: how this came out at all of them. The row is that of the worst.
    pub spread: Option<Spread>,
}

/// One quantity at many places on the grid.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Spread {
    /// How many.
    pub places: usize,
    /// Mean of the error as [`Row::error`] gives it, of the value where there is none.
    pub mean: f64,
    /// Standard deviation of the same.
    pub deviation: f64,
    /// The worst place, in words.
    pub worst: String,
}

impl Row {
    /// Error: relative [–] or the difference [unit of the row]; none for bounds.
    pub fn error(&self) -> Option<f64> {
        match self.expected {
            Expected::Relative { reference, .. } => Some(self.computed / reference - 1.0),
            Expected::Absolute { reference, .. } => Some(self.computed - reference),
            _ => None,
        }
    }

    /// Whether the target is met; none: there is no target. NaN meets none.
    pub fn met(&self) -> Option<bool> {
        match self.expected {
            Expected::Relative { within, .. } | Expected::Absolute { within, .. } => {
                within.map(|w| self.error().is_some_and(|e| e.abs() <= w))
            }
            Expected::AtMost(high) => Some(self.computed <= high),
            Expected::AtLeast(low) => Some(self.computed >= low),
            Expected::Between(low, high) => Some((low..=high).contains(&self.computed)),
        }
    }
}

/// What running a case gave.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    /// Name of the case.
    pub name: String,
    /// What it compares.
    pub about: String,
    /// Resolution: how many cells, and along what.
    pub cells: (f64, &'static str),
    /// The comparison.
    pub rows: Vec<Row>,
    /// Particles of the largest run.
    pub particles: usize,
    /// Steps of all runs.
    pub steps: u64,
    /// Measurements of tips in the runs that were followed step by step.
    pub looks: u64,
    /// Times that a crack which had grown was taken up in these runs.
    pub recuts: u64,
    /// Wall time of all runs [s].
    pub seconds: f64,
    /// Time that the program has computed in the meantime, added up over its threads [s].
    pub cpu_seconds: f64,
    /// What a reader should know besides.
    pub notes: Vec<String>,
}

impl Report {
    /// The rows whose quantity contains `part`.
    pub fn rows_of<'a>(&'a self, part: &'a str) -> impl Iterator<Item = &'a Row> {
        self.rows.iter().filter(move |r| r.quantity.contains(part))
    }
}

/// What a case writes into while it runs.
pub(crate) struct Tally<'a> {
    progress: Progress<'a>,
    placement: Placement,
    scheme: Option<Scheme>,
    report: Report,
    /// Runs that did not come to rest.
    unrested: u64,
}

impl<'a> Tally<'a> {
    /// For a run of the case at one place.
    pub(crate) fn new(placement: Placement, progress: Progress<'a>) -> Self {
        Self { progress, placement, scheme: None, report: Report::default(), unrested: 0 }
    }

    /// With scenes solved by a scheme.
    pub(crate) fn solved_by(self, scheme: Option<Scheme>) -> Self {
        Self { scheme, ..self }
    }

    /// Whether the case is computed as it is drawn: what need not be done at every place is done there.
    pub(crate) fn is_natural(&self) -> bool {
        self.placement == Placement::NATURAL
    }

    /// Says what is being computed now.
    pub(crate) fn say(&mut self, what: &str) {
        (self.progress)(what);
    }

    /// The simulation of a problem at the place of this run.
    pub(crate) fn set_up(&self, problem: &Problem) -> Result<Placed, SimulationError> {
        match &self.scheme {
            Some(scheme) => Placed::new(&scheme.solve(&problem.scene), self.placement),
            None => Placed::new(&problem.scene, self.placement),
        }
    }

    /// Sets a problem up and brings it to rest.
    pub(crate) fn rest(&mut self, problem: &Problem) -> Result<Placed, SimulationError> {
        let mut placed = self.set_up(problem)?;
        self.relax(&mut placed)?;
        Ok(placed)
    }

    /// Brings a simulation to rest. Returns the number of steps.
    pub(crate) fn relax(&mut self, placed: &mut Placed) -> Result<u64, SimulationError> {
        self.relax_to(REST, placed)
    }

    /// Brings a simulation to rest, up to a kinetic energy given as a part of the strain energy.
    pub(crate) fn relax_to(&mut self, tolerance: f64, placed: &mut Placed) -> Result<u64, SimulationError> {
        let steps = placed.relax(tolerance, MOST_STEPS)?;
        self.unrested += u64::from(steps >= MOST_STEPS);
        self.count(placed.particles(), steps);
        Ok(steps)
    }

    /// Counts a run that took `steps`.
    pub(crate) fn count(&mut self, particles: usize, steps: u64) {
        self.report.particles = self.report.particles.max(particles);
        self.report.steps += steps;
    }

    /// Runs to the end of the frames; `sample` looks at the state after each step, and ends the run by breaking. It is
    /// also given the time to which what was measured at the tips belongs [s]: the beginning of the step.
    pub(crate) fn run(
        &mut self,
        placed: &mut Placed,
        mut sample: impl FnMut(Moment<'_>, f64) -> ControlFlow<()>,
    ) -> Result<(), SimulationError> {
        let mut measured = placed.now().time();
        let mut goes_on = true;
        while goes_on && !placed.is_finished() {
            goes_on = placed.advance_observed(&mut |now| {
                let flow = sample(now, measured);
                measured = now.time();
                flow
            })?;
        }
        self.count_run(placed);
        Ok(())
    }

    /// Runs to the end of the frames; `sample` looks at the state after each frame.
    pub(crate) fn run_frames(
        &mut self,
        placed: &mut Placed,
        mut sample: impl FnMut(Moment<'_>),
    ) -> Result<(), SimulationError> {
        while !placed.is_finished() {
            placed.advance()?;
            sample(placed.now());
        }
        self.count_run(placed);
        Ok(())
    }

    /// Counts all that a run has done besides coming to rest.
    pub(crate) fn count_run(&mut self, placed: &Placed) {
        self.count(placed.particles(), placed.steps());
        self.report.looks += placed.counts().looks;
        self.report.recuts += placed.counts().recuts;
    }

    /// Adds a number with a reference and a target for its relative error.
    pub(crate) fn relative(
        &mut self,
        quantity: impl Into<String>,
        unit: &'static str,
        computed: f64,
        reference: f64,
        within: impl Into<Option<f64>>,
    ) {
        let expected = Expected::Relative { reference, within: within.into() };
        self.push(quantity.into(), unit, computed, expected);
    }

    /// Adds a number with a reference and a target for the difference.
    pub(crate) fn absolute(
        &mut self,
        quantity: impl Into<String>,
        unit: &'static str,
        computed: f64,
        reference: f64,
        within: impl Into<Option<f64>>,
    ) {
        let expected = Expected::Absolute { reference, within: within.into() };
        self.push(quantity.into(), unit, computed, expected);
    }

    /// Adds a number with bounds.
    pub(crate) fn bound(&mut self, quantity: impl Into<String>, unit: &'static str, computed: f64, expected: Expected) {
        self.push(quantity.into(), unit, computed, expected);
    }

    fn push(&mut self, quantity: String, unit: &'static str, computed: f64, expected: Expected) {
        self.report.rows.push(Row { quantity, unit, computed, expected, spread: None });
    }

    /// Adds a remark.
    pub(crate) fn note(&mut self, note: impl Into<String>) {
        self.report.notes.push(note.into());
    }

    /// What was found.
    pub(crate) fn finish(mut self) -> Report {
        if self.unrested > 0 {
            self.bound("runs that did not come to rest", "", self.unrested as f64, Expected::AtMost(0.0));
        }
        self.report
    }
}
