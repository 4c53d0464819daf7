//! What a reference case is and how it is run.

use crate::cpu_time::cpu_time;
use crate::family;
use crate::report::{Progress, Report, Tally};
use crate::scheme::Scheme;
use fissure_sim::SimulationError;

/// How a case is run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Resolution, in cells per characteristic length of the case (its documentation says which); none: that of its
    /// targets, or those for several places (`--list` tells both).
    pub cells: Option<f64>,
    /// At how many places on the grid the case is computed. The first is as it is drawn.
    pub places: usize,
    /// Which places the others are.
    pub seed: u64,
    /// How the scenes of the case are solved; none: as the case says, which is as the standard preset does.
    pub scheme: Option<Scheme>,
}

impl Default for Options {
    fn default() -> Self {
        Self { cells: None, places: 1, seed: 1, scheme: None }
    }
}

impl Options {
    /// The resolution asked for, or `standard`.
    pub fn cells_or(&self, standard: f64) -> f64 {
        self.cells.unwrap_or(standard)
    }
}

/// Computes a case at one place, which the tally knows.
pub(crate) type Compute = fn(&Options, &mut Tally<'_>) -> Result<(), SimulationError>;

/// A fracture or mechanics problem whose solution is known.
#[derive(Clone, Copy)]
pub struct Case {
    /// Name, as typed.
    pub name: &'static str,
    /// One line: what is compared with what.
    pub about: &'static str,
    /// What [`Options::cells`] counts, and its standard value.
    pub cells: (&'static str, f64),
    /// The resolution at several places; coarser than the standard one where that takes too long.
    pub family_cells: f64,
    /// Whether one place takes so long that a table of all cases has fewer of it.
    pub is_long: bool,
    compute: Compute,
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
        compute: Compute,
    ) -> Self {
        Self { name, about, cells, family_cells: cells.1, is_long: false, compute }
    }

    /// At several places, computed with so many cells.
    pub(crate) const fn family_cells(self, family_cells: f64) -> Self {
        Self { family_cells, ..self }
    }

    /// A case of which a table has a quarter of the places of others.
    pub(crate) const fn long(self) -> Self {
        Self { is_long: true, ..self }
    }

    /// Computes the case and compares it with its reference.
    ///
    /// # Errors
    /// When the solver fails at the one place, or at all. A missed target is no error: the report says so.
    pub fn run(&self, options: &Options, progress: Progress<'_>) -> Result<Report, SimulationError> {
        let (started, cpu) = (std::time::Instant::now(), cpu_time());
        let standard = if options.places > 1 { self.family_cells } else { self.cells.1 };
        let cells = options.cells_or(standard);
        let report = family::run(self.compute, &Options { cells: Some(cells), ..*options }, progress)?;
        Ok(Report {
            name: self.name.into(),
            about: self.about.into(),
            cells: (cells, self.cells.0),
            seconds: started.elapsed().as_secs_f64(),
            cpu_seconds: (cpu_time() - cpu).as_secs_f64(),
            ..report
        })
    }
}
