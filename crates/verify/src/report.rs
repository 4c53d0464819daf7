//! What a case found, beside what it should have found.

use fissure_sim::Simulation;
use std::ops::ControlFlow;

/// Told now and then what is being computed.
pub type Progress<'a> = &'a mut dyn FnMut(&str);

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
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Name of the case.
    pub name: String,
    /// What it compares.
    pub about: String,
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
    rows: Vec<Row>,
    notes: Vec<String>,
    particles: usize,
    steps: u64,
    looks: u64,
    recuts: u64,
}

impl<'a> Tally<'a> {
    pub(crate) fn new(progress: Progress<'a>) -> Self {
        Self { progress, rows: Vec::new(), notes: Vec::new(), particles: 0, steps: 0, looks: 0, recuts: 0 }
    }

    /// Says what is being computed now.
    pub(crate) fn say(&mut self, what: &str) {
        (self.progress)(what);
    }

    /// Counts a run that was brought to rest: it took `steps`.
    pub(crate) fn count(&mut self, particles: usize, steps: u64) {
        self.particles = self.particles.max(particles);
        self.steps += steps;
    }

    /// Runs to the end of the frames; `sample` looks at the state after each step, and ends the run by breaking. It is
    /// also given the time to which what was measured at the tips belongs [s]: the beginning of the step.
    pub(crate) fn run(
        &mut self,
        simulation: &mut Simulation,
        mut sample: impl FnMut(&Simulation, f64) -> ControlFlow<()>,
    ) -> Result<(), fissure_sim::SimulationError> {
        let mut measured = simulation.time();
        let mut goes_on = true;
        while goes_on && !simulation.is_finished() {
            goes_on = simulation.advance_observed(&mut |now, _| {
                let flow = sample(now, measured);
                measured = now.time();
                flow
            })?;
        }
        self.count(simulation.particles(), simulation.steps());
        self.looks += simulation.counts().looks;
        self.recuts += simulation.counts().recuts;
        Ok(())
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
        self.rows.push(Row { quantity: quantity.into(), unit, computed, expected });
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
        self.rows.push(Row { quantity: quantity.into(), unit, computed, expected });
    }

    /// Adds a number with bounds.
    pub(crate) fn bound(&mut self, quantity: impl Into<String>, unit: &'static str, computed: f64, expected: Expected) {
        self.rows.push(Row { quantity: quantity.into(), unit, computed, expected });
    }

    /// Adds a remark.
    pub(crate) fn note(&mut self, note: impl Into<String>) {
        self.notes.push(note.into());
    }

    pub(crate) fn finish(self, name: &str, about: &str, seconds: f64) -> Report {
        let Self { rows, notes, particles, steps, looks, recuts, .. } = self;
        Report { name: name.into(), about: about.into(), rows, particles, steps, looks, recuts, seconds, notes }
    }
}
