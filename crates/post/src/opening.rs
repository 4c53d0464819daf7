//! The opening polygon of a crack: the hole that its two faces leave.

use crate::history::History;
use crate::slot::Slot;
use crate::snap::{Grid, GridPoint};
use crate::source::{Carried, SourceEdge};
use fissure_scene::{CrackEnd, CrackFrame, Point, Vector};

/// The edges of the opening polygon of `crack`: along the face above from start to end, back along the face below.
///
/// ```text
///        above  →  →  →
///      ┌───────────────────╲
///    ↑ │      opening       ◇ tip
///      └───────────────────╱
///        ←  ←  ←  below
/// ```
/// At a tip the faces meet halfway between their ends.
///
/// `first`: where the arc length is counted from (a rest position on the crack), so that textures stay put when the
/// crack grows at its start; none: its first point.
///
/// `histories`: how each point came about.
///
/// Returns 2 n edges for n crack points: the n − 1 of the face above, the closing edge at the end, the n − 1 of the
/// face below, the closing edge at the start. Edges whose ends fall on one grid point are among them.
pub(crate) fn opening_edges(
    crack: &CrackFrame,
    first: Option<Point>,
    histories: &[History],
    grid: Grid,
) -> Vec<SourceEdge> {
    let count = crack.rest.len();
    let arcs = arc_lengths(&crack.rest, first);
    let is_tip = |i: usize| (i == 0 && crack.start == CrackEnd::Tip) || (i + 1 == count && crack.end == CrackEnd::Tip);
    let corner = |i: usize, face: &[Point], velocity: &[Vector]| -> (GridPoint, Carried) {
        let (place, velocity) = if is_tip(i) {
            (
                nalgebra::center(&crack.above[i], &crack.below[i]),
                0.5 * (crack.above_velocity[i] + crack.below_velocity[i]),
            )
        } else {
            (face[i], velocity[i])
        };
        let history = histories.get(i).copied().unwrap_or_default();
        (grid.snap(place), Carried { arc: arcs[i], history, ..Carried::within(crack.rest[i], velocity) })
    };
    let corners: Vec<_> = (0..count)
        .map(|i| corner(i, &crack.above, &crack.above_velocity))
        .chain((0..count).rev().map(|i| corner(i, &crack.below, &crack.below_velocity)))
        .collect();
    (0..corners.len())
        .map(|i| {
            let ((a, start), (b, end)) = (corners[i], corners[(i + 1) % corners.len()]);
            SourceEdge { a, b, carried: [start, end], slot: Slot::Inside }
        })
        .collect()
}

/// Length at rest along the crack at each point [m], zero at the point nearest to `first`.
pub(crate) fn arc_lengths(rest: &[Point], first: Option<Point>) -> Vec<f64> {
    let mut arcs = Vec::with_capacity(rest.len());
    let mut arc = 0.0;
    for i in 0..rest.len() {
        if i > 0 {
            arc += (rest[i] - rest[i - 1]).norm();
        }
        arcs.push(arc);
    }
    if let Some(first) = first {
        let distance = |i: &usize| (rest[*i] - first).norm_squared();
        let nearest = (0..rest.len()).min_by(|i, j| distance(i).total_cmp(&distance(j))).unwrap_or(0);
        let shift = arcs.get(nearest).copied().unwrap_or(0.0);
        arcs.iter_mut().for_each(|arc| *arc -= shift);
    }
    arcs
}
