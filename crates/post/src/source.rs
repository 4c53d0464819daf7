//! Where a boundary edge comes from, and what the material there carries.

use crate::history::History;
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
    /// How the wall of a crack came about here.
    pub(crate) history: History,
    /// Direction at rest of the curve that was drawn, along the ring; zero on lines and cracks.
    pub(crate) tangent: Vector,
}

impl Carried {
    /// What the material at rest at `rest` carries that no wall stands on.
    pub(crate) fn within(rest: Point, velocity: Vector) -> Self {
        Self { rest, velocity, arc: 0.0, history: History::default(), tangent: Vector::zeros() }
    }

    /// A part of the way, 0 to 1, from here to another point of the same line.
    pub(crate) fn between(&self, other: &Self, part: f64) -> Self {
        Self {
            rest: self.rest + part * (other.rest - self.rest),
            velocity: self.velocity + part * (other.velocity - self.velocity),
            arc: self.arc + part * (other.arc - self.arc),
            history: self.history.between(other.history, part),
            tangent: self.tangent + part * (other.tangent - self.tangent),
        }
    }
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

    /// Angle at rest from the edge to the curve that was drawn, at `point` on it, counter-clockwise [rad]; none where
    /// no curve is told of, or where the edge has come to lie across it.
    pub(crate) fn turn(&self, point: GridPoint) -> Option<f64> {
        /// Chords are nearer to their curves; what takes the place of some of them may turn by more.
        const MOST: f64 = 0.6;
        if self.slot != Slot::Outside {
            return None;
        }
        let tangent = self.at(point).tangent;
        if tangent == Vector::zeros() {
            return None;
        }
        let along = self.direction_at_rest()?;
        Some(along.perp(&tangent).atan2(along.dot(&tangent))).filter(|turn| turn.abs() <= MOST)
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
        start.between(&end, (here.dot(&along) / along.norm_squared()).clamp(0.0, 1.0))
    }
}
