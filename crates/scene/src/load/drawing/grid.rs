//! The integer grid on which areas are put together.

use fissure_plane::Point;
use i_overlay::i_float::int::point::IntPoint;

/// Bits of the grid coordinates of what lies within reach.
const GRID_BITS: i32 = 40;
/// Grid coordinates are held below this; what is cut off there lies a million times farther out than the reach.
const FARTHEST: f64 = (1_u64 << 60) as f64;

/// A place on the grid, in grid steps.
pub(super) type GridPoint = IntPoint<i64>;

/// A square grid through the origin whose step is a power of two, so that places on it are exact in `f64`.
///
/// Curves of a drawing are known to 24 bits of its size; the grid has 16 more.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    /// Distance between neighbouring grid points [m].
    pub(super) step: f64,
}

impl Grid {
    /// The grid for points within `reach` [m] of the origin in x and y.
    pub(super) fn covering(reach: f64) -> Self {
        let power = if reach > 0.0 { reach.log2().ceil() as i32 } else { 0 };
        Self { step: 2.0_f64.powi(power.clamp(-900, 900) - GRID_BITS) }
    }

    /// The grid point nearest to `point`.
    pub(super) fn snap(self, point: Point) -> GridPoint {
        let steps = |x: f64| (x / self.step).round().clamp(-FARTHEST, FARTHEST) as i64;
        GridPoint::new(steps(point.x), steps(point.y))
    }

    /// The place of a grid point [m], exact.
    pub(super) fn place(self, point: GridPoint) -> Point {
        Point::new(point.x as f64 * self.step, point.y as f64 * self.step)
    }
}
