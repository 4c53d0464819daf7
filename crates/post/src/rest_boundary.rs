//! Boundaries for tests of what is done at rest.

use crate::slot::Slot;
use crate::snap::GridPoint;
use crate::source::{Carried, SourceEdge};
use fissure_scene::{Point, Vector};

/// A boundary through some corners that has not moved.
pub(crate) fn boundary(corners: &[(f64, f64)]) -> Vec<SourceEdge> {
    let carried = |&(x, y): &(f64, f64)| Carried::within(Point::new(x, y), Vector::zeros());
    let point = |&(x, y): &(f64, f64)| GridPoint::new((1e6 * x).round() as i64, (1e6 * y).round() as i64);
    let pairs = corners.iter().zip(corners.iter().cycle().skip(1));
    let edge = |(a, b)| SourceEdge { a: point(a), b: point(b), carried: [carried(a), carried(b)], slot: Slot::Inside };
    pairs.map(edge).collect()
}

/// The corners of a boundary at rest, after a check that each edge begins where the one before it ends.
pub(crate) fn corners(boundary: &[SourceEdge]) -> Vec<(f64, f64)> {
    for (edge, next) in boundary.iter().zip(boundary.iter().cycle().skip(1)) {
        assert_eq!((edge.b, edge.carried[1].rest), (next.a, next.carried[0].rest));
    }
    boundary.iter().map(|edge| (edge.carried[0].rest.x, edge.carried[0].rest.y)).collect()
}
