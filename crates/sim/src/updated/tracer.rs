//! A vertex of an outline that moves with the material.

use crate::crack::cracks::TipId;
use crate::crack::crossing::Side;
use crate::faces::outlines::Vertex;
use crate::saved::{self, Fits};
use fissure_scene::{Point, Vector};
use serde::{Deserialize, Serialize};

/// The faces of a crack, in the order in which they are kept.
pub(super) const SIDES: [Side; 2] = [Side::Above, Side::Below];

/// A vertex of an outline.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Tracer {
    /// At rest [m].
    pub(super) rest: Point,
    /// [m].
    pub(super) position: Point,
    /// [m/s].
    pub(super) velocity: Vector,
    /// The end of a crack face that this vertex is, 0 above or 1 below.
    pub(super) face: Option<(TipId, usize)>,
}

impl Vertex for Tracer {
    fn rest(&self) -> Point {
        self.rest
    }

    fn is_at_mouth(&self) -> bool {
        self.face.is_some()
    }
}

impl Tracer {
    pub(super) fn at_rest(rest: Point) -> Self {
        Self { rest, position: rest, velocity: Vector::zeros(), face: None }
    }

    /// Checks a tracer that was read: that its numbers are finite and that it names one of so many `cracks`.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(super) fn check(&self, cracks: usize) -> Fits {
        saved::finite("an outline", self.rest.iter().chain(self.position.iter()).chain(&self.velocity))?;
        let Some((id, side)) = self.face else { return Ok(()) };
        id.check(cracks)?;
        saved::ensure(side < SIDES.len(), "an outline")
    }
}
