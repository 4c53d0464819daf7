//! Where a boundary edge comes from, and what the material there carries.

use crate::slot::Slot;
use crate::snap::GridPoint;
use fissure_scene::{Point, Vector};

/// What the material at a boundary point carries.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Carried {
    /// Position at rest [m].
    pub(crate) rest: Point,
    /// Velocity [m/s].
    pub(crate) velocity: Vector,
    /// Length at rest along the ring or crack, up to here [m].
    pub(crate) arc: f64,
}

/// A boundary edge of the moved body, material on its left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SourceEdge {
    /// Start.
    pub(crate) a: GridPoint,
    /// End.
    pub(crate) b: GridPoint,
    /// What is carried at the start and at the end.
    pub(crate) carried: [Carried; 2],
    /// Material slot of the wall that stands on this edge.
    pub(crate) slot: Slot,
}

impl SourceEdge {
    /// Direction at rest; none without length.
    pub(crate) fn direction_at_rest(&self) -> Option<Vector> {
        (self.carried[1].rest - self.carried[0].rest).try_normalize(0.0)
    }

    /// What is carried at `point` on the edge: linear between the ends, exactly theirs at the ends.
    pub(crate) fn at(&self, point: GridPoint) -> Carried {
        let [start, end] = self.carried;
        if point == self.a {
            return start;
        }
        if point == self.b {
            return end;
        }
        let along = Vector::new((self.b.x - self.a.x) as f64, (self.b.y - self.a.y) as f64);
        let here = Vector::new((point.x - self.a.x) as f64, (point.y - self.a.y) as f64);
        // Intersections are rounded to the grid, so the point may lie beside the edge or just beyond its end.
        let part = (here.dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        Carried {
            rest: start.rest + part * (end.rest - start.rest),
            velocity: start.velocity + part * (end.velocity - start.velocity),
            arc: start.arc + part * (end.arc - start.arc),
        }
    }
}
