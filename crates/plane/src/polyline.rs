//! Open polylines.

use crate::Point;

/// Length of an open polyline [m].
pub fn polyline_length(points: &[Point]) -> f64 {
    points.windows(2).map(|w| (w[1] - w[0]).norm()).sum()
}
