//! Corners of one fragment that lie in one place at rest, kept apart as the fragment is shown: programs that merge
//! vertices by distance would join the faces of a closed crack corner by corner.
//!
//! ```text
//!     ────────╮     ╭─────────
//!       a     │hair │     b         each corner goes into its own material, so that nothing comes to overlap
//!     ────────╯     ╰─────────
//! ```
//! A tip is one corner and stays; the corners beside it, also those that are new in the edges there, are kept apart.

use crate::snap::{Grid, GridPoint};
use fissure_scene::{Point, Vector};
use rustc_hash::FxHashMap;

/// Corners that are pushed apart across their faces go so much farther, as a part of the width: more than rounding.
pub(crate) const MORE: f64 = 0.02;
/// Times that corners where cracks meet are moved farther.
const ROUNDS: usize = 6;
/// By how much farther.
const FARTHER: f64 = 1.4;
/// Corners of narrow wedges go so many widths into them at most.
const DEEPEST: f64 = 3.0;

/// Moves corners of closed lines that lie in one place at `rest` [m], told by `rest_grid`, to be at least `width` grid
/// steps apart. `shown`: where they are, line after line; `lengths`: how many corners each line has, the material on
/// its left.
pub(crate) fn part_corners(shown: &mut [GridPoint], rest: &[Point], lengths: &[usize], width: f64, rest_grid: Grid) {
    let inwards = Inwards::new(shown, lengths);
    let mut at = FxHashMap::<(i64, i64), Vec<usize>>::default();
    for (k, rest) in rest.iter().enumerate() {
        let place = rest_grid.snap(*rest);
        at.entry((place.x, place.y)).or_default().push(k);
    }
    for k in 0..rest.len() {
        let place = rest_grid.snap(rest[k]);
        let group = &at[&(place.x, place.y)];
        if group.len() > 1 && group[0] == k {
            part(shown, group, width, &inwards);
        }
    }
}

/// Parts corners that lie in one place at rest.
fn part(shown: &mut [GridPoint], group: &[usize], width: f64, inwards: &Inwards) {
    if !group.iter().enumerate().any(|(i, &p)| group[..i].iter().any(|&q| distance(shown[p], shown[q]) < width)) {
        return;
    }
    let ways: Vec<Vector> = group.iter().map(|&corner| inwards.of(corner)).collect();
    let starts: Vec<GridPoint> = group.iter().map(|&corner| shown[corner]).collect();
    let moved =
        |start: GridPoint, way: Vector| GridPoint::new(start.x + way.x.round() as i64, start.y + way.y.round() as i64);
    if let ([p, q], [a, b]) = (group, starts.as_slice())
        && let Some(across) = (ways[0] - ways[1]).try_normalize(0.1)
    {
        // Both faces of a crack: half of what is missing across them, overlaps taken back.
        let apart = Vector::new((a.x - b.x) as f64, (a.y - b.y) as f64).dot(&across);
        let half = 0.5 * ((1.0 + MORE) * width + 2.0 - apart).max(0.0);
        (shown[*p], shown[*q]) = (moved(*a, half * across), moved(*b, -half * across));
        return;
    }
    let mut far = std::f64::consts::FRAC_1_SQRT_2 * width + 2.0;
    for _ in 0..ROUNDS {
        for ((&corner, &start), way) in group.iter().zip(&starts).zip(&ways) {
            shown[corner] = moved(start, far * way.cap_magnitude(DEEPEST));
        }
        if (0..group.len()).all(|i| (0..i).all(|j| distance(shown[group[i]], shown[group[j]]) >= width)) {
            break;
        }
        far *= FARTHER;
    }
}

/// The ways from corners into the material.
pub(crate) struct Inwards {
    /// Of the edge that ends at each corner, and of that which begins there: to its left, of unit length.
    left: Vec<[Vector; 2]>,
}

impl Inwards {
    pub(crate) fn new(shown: &[GridPoint], lengths: &[usize]) -> Self {
        let mut left = Vec::with_capacity(shown.len());
        let mut begin = 0;
        for &length in lengths {
            let of_edge = |i: usize| {
                let (a, b) = (shown[begin + i % length], shown[begin + (i + 1) % length]);
                Vector::new((a.y - b.y) as f64, (b.x - a.x) as f64).try_normalize(0.0).unwrap_or_default()
            };
            left.extend((0..length).map(|i| [of_edge(i + length - 1), of_edge(i)]));
            begin += length;
        }
        Self { left }
    }

    /// Into the wedge at a corner, of unit length.
    pub(crate) fn of(&self, corner: usize) -> Vector {
        let [before, after] = self.left[corner];
        (before + after).try_normalize(1e-3).unwrap_or(after)
    }
}

fn distance(p: GridPoint, q: GridPoint) -> f64 {
    ((p.x - q.x) as f64).hypot((p.y - q.y) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Truth: what is asked for. Cracks that meet in a place leave wedges, each with a corner there; some are
        /// pressed into others. They come to be so far apart, each in its own wedge as far as they were there.
        #[test]
        fn corners_of_wedges_are_apart(
            steps in proptest::collection::vec(0.2..1.0_f64, 2..6), turned in 0.0..6.0_f64, width in 20.0..400.0_f64,
            sunk in proptest::collection::vec(-0.3..0.3_f64, 12),
        ) {
            let all: f64 = steps.iter().sum();
            let mut angles = vec![turned];
            for step in &steps {
                angles.push(angles[angles.len() - 1] + step / all * std::f64::consts::TAU);
            }
            let ray = |angle: f64| GridPoint::new((1e5 * angle.cos()).round() as i64, (1e5 * angle.sin()).round() as i64);
            let (mut shown, mut rest) = (Vec::new(), Vec::new());
            for (k, pair) in angles.windows(2).enumerate() {
                // The wedge to the left of the way in along its second side and out along the first.
                let [out, back] = [ray(pair[0]), ray(pair[1])];
                let off = [sunk[2 * k], sunk[2 * k + 1]].map(|part| (part * width) as i64);
                shown.extend([back, GridPoint::new(off[0], off[1]), out]);
                rest.extend([back, GridPoint::new(0, 0), out].map(|p| Point::new(p.x as f64, p.y as f64 + 0.25)));
            }
            let before = shown.clone();
            part_corners(&mut shown, &rest, &vec![3; steps.len()], width, Grid { step: 1.0 });
            let corners: Vec<GridPoint> = shown.iter().skip(1).step_by(3).copied().collect();
            for (i, p) in corners.iter().enumerate() {
                for q in &corners[i + 1..] {
                    prop_assert!(distance(*p, *q) >= width, "{:?}", corners);
                }
                prop_assert!(distance(*p, before[3 * i + 1]) < 12.0 * width);
            }
        }
    }

    /// Truth: by hand. Both faces of a crack that are pressed into each other come apart in their middle; what is
    /// apart stays, and so do tips.
    #[test]
    fn faces_come_apart_in_their_middle() {
        let slit = |y: i64| {
            let row = [
                (0, y),
                (1000, y),
                (2000, 0),
                (1000, -y),
                (0, -y),
                (-3000, -3000),
                (3000, -3000),
                (3000, 3000),
                (-3000, 3000),
            ];
            row.map(|(x, y)| GridPoint::new(x, y)).to_vec()
        };
        // The material lies around the slit: its upper side is passed forth, its lower one back.
        let at_rest: Vec<Point> = slit(0).iter().map(|p| Point::new(p.x as f64, p.y as f64)).collect();
        let parted = |y: i64| {
            let mut shown = slit(y);
            part_corners(&mut shown, &at_rest, &[9], 100.0, Grid { step: 1.0 });
            shown
        };
        assert_eq!(parted(60), slit(60));
        for y in [0, 20, -30] {
            let shown = parted(y);
            assert_eq!(shown[2], GridPoint::new(2000, 0));
            let heights = [shown[1].y, shown[3].y];
            assert!((50..=54).contains(&heights[0]) && heights[1] == -heights[0], "{heights:?}");
        }
    }
}
