//! Cracks inside a fragment, held open by a hair so that they have walls.

use crate::widening::Shift;
use fissure_scene::{BoundaryEdge, CrackEnd, CrackFrame, Fragments, Line, Point, Vector};
use rustc_hash::FxHashMap;

/// Least width of a crack that is held open, in grid steps: one that narrows to tips right beside its widest point is
/// still twice as wide as what counts as rounding.
pub(crate) const LEAST: f64 = 8.0;

/// For each point of `crack` how far its faces have to move so that the crack is open by `width` [m] there. `parted`:
/// the points that part two fragments, where nothing moves.
pub(crate) fn shifts(crack: &CrackFrame, parted: &[bool], width: f64) -> Vec<Shift> {
    let last = crack.rest.len().saturating_sub(1);
    let middle = |i: usize| nalgebra::center(&crack.above[i], &crack.below[i]);
    let shift = |i: usize| {
        let is_tip = (i == 0 && crack.start == CrackEnd::Tip) || (i == last && crack.end == CrackEnd::Tip);
        if is_tip || parted[i] {
            return Shift::default();
        }
        let along = middle((i + 1).min(last)) - middle(i.saturating_sub(1));
        let normal = Vector::new(-along.y, along.x).try_normalize(0.0).unwrap_or_default();
        let missing = width - (crack.above[i] - crack.below[i]).dot(&normal);
        let above = normal * (0.5 * missing.max(0.0));
        Shift { above, below: -above }
    };
    (0..crack.rest.len()).map(shift).collect()
}

/// For each point of each of `cracks` whether it is an end of something that parts two fragments of different numbers.
pub(crate) fn parted_points(cracks: &[CrackFrame], fragments: &Fragments, numbers: &[u32]) -> Vec<Vec<bool>> {
    // A stretch of a crack is known by its ends, in the direction of its face above.
    let key = |[a, b]: [Point; 2]| [a.x, a.y, b.x, b.y].map(f64::to_bits);
    let edges: Vec<(&BoundaryEdge, u32)> = fragments
        .list()
        .iter()
        .zip(numbers)
        .flat_map(|(fragment, &number)| fragment.boundaries.iter().flatten().map(move |edge| (edge, number)))
        .collect();
    let stretch = |edge: &BoundaryEdge| match edge.line {
        Line::Ring(_) => None,
        Line::Above(crack) => Some((crack, 0, (crack, key(edge.rest)))),
        Line::Below(crack) => Some((crack, 1, (crack, key([edge.rest[1], edge.rest[0]])))),
    };
    let mut sides = FxHashMap::<_, [Option<u32>; 2]>::default();
    for &(edge, number) in &edges {
        if let Some((_, side, stretch)) = stretch(edge) {
            sides.entry(stretch).or_default()[side] = Some(number);
        }
    }
    let mut parted: Vec<Vec<bool>> = cracks.iter().map(|crack| vec![false; crack.rest.len()]).collect();
    for (edge, _) in edges {
        let Some((crack, _, stretch)) = stretch(edge) else { continue };
        if sides.get(&stretch).is_some_and(|[above, below]| above != below) {
            for (point, span) in edge.points.into_iter().zip([0.0, 1.0]) {
                parted[crack][point] |= edge.span.contains(&span);
            }
        }
    }
    parted
}
