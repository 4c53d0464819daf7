//! How near polylines keep to the curves that were drawn.

use super::Resolved;
use crate::document::GridKeys;
use crate::fault::{KeyPath, SceneFault};
use crate::range::LENGTH;

/// Curves are flattened to this part of a cell,
const OF_CELL: f64 = 0.02;
/// or of the larger side of what is drawn, if that is less: what an eye sees that looks at all of it.
const OF_SIDE: f64 = 0.25e-3;

/// How far polylines may be off curves.
#[derive(Debug, Clone, Copy)]
pub(super) enum ChordError {
    /// As the scene says [m].
    Given(f64),
    /// As the scene can tell that has cells of this size [m].
    OfCell(f64),
}

impl ChordError {
    pub(super) fn new(keys: &GridKeys, particle_spacing: f64, cell_size: f64) -> Resolved<Self> {
        let Some(error) = keys.chord_error else { return Ok(Self::OfCell(cell_size)) };
        let path = KeyPath::setting("grid", "chord_error");
        LENGTH.check(path.clone(), "the chord error", error)?;
        if error > particle_spacing {
            let message = format!("a chord error of {error} m is more than the particle spacing, {particle_spacing} m");
            let remedy = "give a smaller one, or leave it out: it is then a fiftieth of a cell or a quarter of a \
                millimetre per metre of the body, whichever is less";
            return Err(SceneFault::new(path, message, remedy));
        }
        Ok(Self::Given(error))
    }

    /// That of curves of something with this larger side [m].
    pub(super) fn within(self, side: f64) -> f64 {
        match self {
            Self::Given(error) => error,
            Self::OfCell(cell) => (OF_CELL * cell).min(OF_SIDE * side),
        }
    }
}
