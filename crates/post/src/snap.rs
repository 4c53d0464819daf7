//! The power-of-two grid on which all plane geometry is done.

use crate::error::PostError;
use fissure_scene::{Point, Vector};
use i_overlay::i_float::int::point::IntPoint;

/// A place on the grid, in grid steps.
pub(crate) type GridPoint = IntPoint<i64>;

/// Twice the area of the triangle, exact; positive if counter-clockwise.
pub(crate) fn turn(a: GridPoint, b: GridPoint, c: GridPoint) -> i128 {
    i128::from(b.x - a.x) * i128::from(c.y - a.y) - i128::from(b.y - a.y) * i128::from(c.x - a.x)
}

/// Part of the reach by which later stages may go beyond it.
const MARGIN: f64 = 1.0 / 4096.0;
/// Bits of the mantissa of an `f32`, the hidden one included.
const MANTISSA_BITS: i32 = 24;

/// Steps that something shown must be large.
const LEAST_STEPS: f64 = 256.0;

/// A square grid through the origin whose step is a power of two.
///
/// The step is chosen so that every grid point within reach of the points it was made for is exact in `f32`: 2⁻¹⁹ m for
/// a body that reaches 20 m from the origin. What is a valid polygon on the grid is therefore bit for bit the same
/// polygon in a file; rounding to `f32` *after* the triangulation instead made degenerate or flipped triangles in 10 to
/// 37 % of the shapes tried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Grid {
    /// Distance between neighbouring grid points [m], a power of two.
    pub(crate) step: f64,
}

impl Grid {
    /// The finest grid that is exact in `f32` for all `points` (all finite), and `beyond` them by so much [m].
    pub(crate) fn covering<'a>(points: impl IntoIterator<Item = &'a Point>, beyond: f64) -> Self {
        let reach = points.into_iter().fold(0.0_f64, |reach, p| reach.max(p.x.abs()).max(p.y.abs()));
        let reach = (reach + beyond) * (1.0 + MARGIN);
        // The smallest power of two at or above the reach; the step stays a normal f32 whatever the scene.
        let mut power = if reach > 0.0 { reach.log2().ceil() as i32 } else { 0 };
        power = power.clamp(f32::MIN_EXP + MANTISSA_BITS, f32::MAX_EXP - 1);
        if reach > 2.0_f64.powi(power) {
            power += 1;
        }
        Self { step: 2.0_f64.powi(power - MANTISSA_BITS) }
    }

    /// Checks that the grid is fine enough to show `name`, which is `size` [m] large.
    ///
    /// # Errors
    /// [`PostError::TooFar`]
    pub(crate) fn check(self, frame: i64, name: &str, size: f64) -> Result<(), PostError> {
        let reach = self.reach();
        if self.step * LEAST_STEPS <= size {
            return Ok(());
        }
        Err(PostError::TooFar { frame, name: name.to_owned(), reach, step: self.step, size })
    }

    /// How far from the origin grid points are exact in `f32`, along each axis [m].
    pub(crate) fn reach(self) -> f64 {
        self.step * 2.0_f64.powi(MANTISSA_BITS)
    }

    /// The grid point nearest to `point`.
    pub(crate) fn snap(self, point: Point) -> GridPoint {
        GridPoint::new((point.x / self.step).round() as i64, (point.y / self.step).round() as i64)
    }

    /// The way between grid points nearest to `way` [m].
    pub(crate) fn nearest(self, way: Vector) -> Vector {
        way.map(|x| (x / self.step).round() * self.step)
    }

    /// The place of a grid point [m], exact.
    pub(crate) fn place(self, point: GridPoint) -> Point {
        Point::new(point.x as f64 * self.step, point.y as f64 * self.step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_step_follows_the_size_of_the_body() {
        let step = |reach: f64| Grid::covering(&[Point::new(-reach, 0.3 * reach)], 0.0).step;
        assert_eq!(step(20.0), 2.0_f64.powi(-19));
        assert_eq!(step(15.9), 2.0_f64.powi(-20));
        assert_eq!(step(1e-3), 2.0_f64.powi(-33));
        assert_eq!(step(1e4), 2.0_f64.powi(-10));
    }

    proptest! {
        /// Truth: the definition of f32.
        #[test]
        fn grid_points_are_exact_in_f32(reach in 1e-4..1e5_f64, x in -1.0002..1.0002_f64, y in -1.0..1.0_f64) {
            let grid = Grid::covering(&[Point::new(reach, 0.0)], 0.0);
            let there = grid.place(grid.snap(Point::new(x * reach, y * reach)));
            prop_assert_eq!(f64::from(there.x as f32), there.x);
            prop_assert_eq!(f64::from(there.y as f32), there.y);
            prop_assert!((there.x - x * reach).abs() <= 0.5 * grid.step);
        }
    }
}
