//! Corners at rest that are so near to each other that readers would merge them become one.

use crate::snap::Grid;
use crate::source::{Carried, SourceEdge};
use std::collections::{BTreeMap, BTreeSet};

/// Times that corners are joined, at most.
const ROUNDS: usize = 16;

/// Where a corner is at rest, on a grid.
type Place = (i64, i64);

/// The boundaries of a fragment without edges that are shorter than `least` [m] at rest, as far as they are not drawn:
/// one of the ends of each takes the place of the other on all boundaries that meet there, so that both faces of a
/// crack lose the same. Edges stay where that would join others, or leave a boundary with no area.
pub(crate) fn joined(
    boundaries: &[Vec<SourceEdge>],
    least: f64,
    grid: Grid,
    is_drawn: impl Fn(&SourceEdge) -> bool,
) -> Vec<Vec<SourceEdge>> {
    let mut boundaries = boundaries.to_vec();
    // Where corners have gone there may be others beside them.
    for _ in 0..ROUNDS {
        let Some(joined) = joined_once(&boundaries, least, grid, &is_drawn) else { break };
        boundaries = joined;
    }
    boundaries
}

/// The boundaries without some of their short edges, no two of which have an end in common; none where all stay.
fn joined_once(
    boundaries: &[Vec<SourceEdge>],
    least: f64,
    grid: Grid,
    is_drawn: impl Fn(&SourceEdge) -> bool,
) -> Option<Vec<Vec<SourceEdge>>> {
    let place = |carried: &Carried| {
        let place = grid.snap(carried.rest);
        (place.x, place.y)
    };
    let mut neighbours = BTreeMap::<Place, BTreeSet<Place>>::new();
    let (mut short, mut drawn) = (BTreeSet::<(Place, Place)>::new(), BTreeSet::new());
    for edge in boundaries.iter().flatten() {
        let [a, b] = [0, 1].map(|end| place(&edge.carried[end]));
        neighbours.entry(a).or_default().insert(b);
        neighbours.entry(b).or_default().insert(a);
        if is_drawn(edge) {
            drawn.extend([a, b]);
        }
        if (edge.carried[1].rest - edge.carried[0].rest).norm() < least {
            short.insert((a.min(b), a.max(b)));
        }
    }
    let (mut gone, mut seen) = (BTreeMap::<Place, Place>::new(), BTreeSet::new());
    for (a, b) in short {
        let (Some(around_a), Some(around_b)) = (neighbours.get(&a), neighbours.get(&b)) else { continue };
        // Tips, places where lines meet and ends of drawn edges stay.
        let may_go = |at: &Place, around: &BTreeSet<Place>| around.len() == 2 && !drawn.contains(at);
        let (kept, lost) = match [may_go(&a, around_a), may_go(&b, around_b)] {
            [_, true] => (a, b),
            [true, false] => (b, a),
            [false, false] => continue,
        };
        if a == b || !around_a.is_disjoint(around_b) || seen.contains(&a) || seen.contains(&b) {
            continue;
        }
        seen.extend(around_a | around_b);
        gone.insert(lost, kept);
    }
    if gone.is_empty() {
        return None;
    }
    let shown =
        boundaries.iter().map(|boundary| without(boundary, |carried| gone.get(&place(carried)).copied(), place));
    Some(shown.collect())
}

/// A boundary without the corners that are `gone`.
fn without(
    boundary: &[SourceEdge],
    gone: impl Fn(&Carried) -> Option<Place>,
    place: impl Fn(&Carried) -> Place,
) -> Vec<SourceEdge> {
    let count = boundary.len();
    let mut left: Vec<Option<SourceEdge>> = boundary.iter().copied().map(Some).collect();
    for i in 0..count {
        let (j, edge) = ((i + 1) % count, boundary[i]);
        // The edge goes from what is kept to what is gone, or back.
        if gone(&edge.carried[1]) == Some(place(&edge.carried[0])) {
            let Some(next) = left[j] else { return boundary.to_vec() };
            let start = Carried { rest: edge.carried[0].rest, velocity: edge.carried[0].velocity, ..next.carried[0] };
            left[j] = Some(SourceEdge { a: edge.a, carried: [start, next.carried[1]], ..next });
        } else if gone(&edge.carried[0]) == Some(place(&edge.carried[1])) {
            let before = (i + count - 1) % count;
            let Some(previous) = left[before] else { return boundary.to_vec() };
            let end = Carried { rest: edge.carried[1].rest, velocity: edge.carried[1].velocity, ..previous.carried[1] };
            left[before] = Some(SourceEdge { b: edge.b, carried: [previous.carried[0], end], ..previous });
        } else {
            continue;
        }
        left[i] = None;
    }
    let left: Vec<SourceEdge> = left.into_iter().flatten().collect();
    if left.len() < 3 { boundary.to_vec() } else { left }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rest_boundary::{boundary, corners};

    /// Truth: by hand. A slit with short edges in its middle and at its tip, beside a drawn short edge: both faces lose
    /// the corners in the middle, the tip and what was drawn stay.
    #[test]
    fn both_faces_lose_the_same_corners() {
        let slit = [(1.0, 1.0), (1.4, 1.0), (1.401, 1.0), (1.402, 1.001), (1.8, 1.0)];
        let tip = (1.801, 1.0);
        let ring = [(3.0, 0.0), (3.001, 0.0), (4.0, 0.0), (4.0, 3.0), (1.0, 3.0)];
        let whole: Vec<(f64, f64)> = ring
            .into_iter()
            .chain(slit)
            .chain([tip])
            .chain(slit.into_iter().skip(1).rev())
            .chain([(1.0, 1.0), (1.0, 0.0)])
            .collect();
        let is_drawn = |edge: &SourceEdge| edge.carried.iter().all(|carried| carried.rest.y == 0.0);
        let grid = Grid { step: 1e-6 };
        let found = joined(&[boundary(&whole)], 0.01, grid, is_drawn);
        let kept = corners(&found[0]);
        assert!(ring.iter().chain([&tip]).all(|corner| kept.contains(corner)), "{kept:?}");
        let of_slit: Vec<(f64, f64)> = kept.iter().copied().filter(|c| c.1 > 0.5 && c.1 < 2.0).collect();
        let back: Vec<(f64, f64)> = of_slit.iter().rev().copied().collect();
        assert_eq!(of_slit, back);
        assert_eq!(of_slit.len(), 5, "{of_slit:?}");
        let all = joined(&[boundary(&whole)], 0.0, grid, is_drawn);
        assert_eq!(all, [boundary(&whole)]);
    }
}
