//! What a reference case is and how it is run.

use crate::report::{Progress, Report, Tally};
use fissure_sim::SimulationError;

/// How a case is run.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Options {
    /// Resolution, in cells per characteristic length of the case (its documentation says which); none: that of its
    /// targets.
    pub cells: Option<f64>,
    /// Measure at 16 places of the tip within a cell for every variant, where the case varies the place at all; without
    /// it only the variants whose target says so get all 16, the others 4.
    pub all_offsets: bool,
}

impl Options {
    /// The resolution asked for, or `standard`.
    pub fn cells_or(&self, standard: f64) -> f64 {
        self.cells.unwrap_or(standard)
    }
}

/// A fracture or mechanics problem whose solution is known.
#[derive(Clone, Copy)]
pub struct Case {
    /// Name, as typed.
    pub name: &'static str,
    /// One line: what is compared with what.
    pub about: &'static str,
    /// What [`Options::cells`] counts, and its standard value.
    pub cells: (&'static str, f64),
    compute: fn(&Options, &mut Tally<'_>) -> Result<(), SimulationError>,
}

impl std::fmt::Debug for Case {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Case").field("name", &self.name).finish_non_exhaustive()
    }
}

impl Case {
    pub(crate) const fn new(
        name: &'static str,
        about: &'static str,
        cells: (&'static str, f64),
        compute: fn(&Options, &mut Tally<'_>) -> Result<(), SimulationError>,
    ) -> Self {
        Self { name, about, cells, compute }
    }

    /// Computes the case and compares it with its reference.
    ///
    /// # Errors
    /// When the solver fails. A missed target is no error: the report says so.
    pub fn run(&self, options: &Options, progress: Progress<'_>) -> Result<Report, SimulationError> {
        let started = std::time::Instant::now();
        let mut tally = Tally::new(progress);
        (self.compute)(options, &mut tally)?;
        Ok(tally.finish(self.name, self.about, started.elapsed().as_secs_f64()))
    }
}
