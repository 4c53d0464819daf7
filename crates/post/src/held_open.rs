//! Cracks inside a fragment, held open by a hair so that they have walls.

use crate::snap::Grid;
use crate::widening::Shift;
use fissure_scene::{CrackEnd, CrackFrame, Fragments, Line, Vector};

/// Least width of a crack that is held open, in grid steps: one that narrows to tips right beside its widest point is
/// still twice as wide as what counts as rounding.
const LEAST: f64 = 8.0;

/// For each point of `crack` how far its faces have to move so that the crack is open there. `parted`: the segments
/// that part two fragments, where nothing moves.
pub(crate) fn shifts(crack: &CrackFrame, parted: &[bool], grid: Grid) -> Vec<Shift> {
    let last = crack.rest.len().saturating_sub(1);
    let middle = |i: usize| nalgebra::center(&crack.above[i], &crack.below[i]);
    let shift = |i: usize| {
        let is_tip = (i == 0 && crack.start == CrackEnd::Tip) || (i == last && crack.end == CrackEnd::Tip);
        let beside = [i.saturating_sub(1), i.min(last.saturating_sub(1))];
        if is_tip || beside.iter().any(|&segment| parted.get(segment).is_none_or(|parted| *parted)) {
            return Shift::default();
        }
        let along = middle((i + 1).min(last)) - middle(i.saturating_sub(1));
        let normal = Vector::new(-along.y, along.x).try_normalize(0.0).unwrap_or_default();
        let missing = LEAST * grid.step - (crack.above[i] - crack.below[i]).dot(&normal);
        let above = normal * (0.5 * missing.max(0.0));
        Shift { above, below: -above }
    };
    (0..crack.rest.len()).map(shift).collect()
}

/// For each segment of each of `cracks` whether it parts two fragments that have different numbers.
pub(crate) fn parted_segments(cracks: &[CrackFrame], fragments: &Fragments, numbers: &[u32]) -> Vec<Vec<bool>> {
    let none = || cracks.iter().map(|c| vec![None; c.rest.len().saturating_sub(1)]).collect();
    let mut sides: [Vec<Vec<Option<u32>>>; 2] = [none(), none()];
    for (fragment, &number) in fragments.list().iter().zip(numbers) {
        for edge in fragment.boundaries.iter().flatten() {
            let segment = edge.points[0].min(edge.points[1]);
            match edge.line {
                Line::Ring(_) => {}
                Line::Above(crack) => sides[0][crack][segment] = Some(number),
                Line::Below(crack) => sides[1][crack][segment] = Some(number),
            }
        }
    }
    let [above, below] = sides;
    above.iter().zip(&below).map(|(a, b)| a.iter().zip(b).map(|(a, b)| a != b).collect()).collect()
}
