//! Corners that lie apart at rest, or follow particles, and have come to lie on each other: programs that merge
//! vertices by distance would join what is no neighbour.

use crate::parted_corners::{Inwards, MORE};
use crate::snap::GridPoint;
use crate::source::{Carried, SourceEdge};
use crate::triangulate::Cap;
use fissure_scene::Vector;
use rustc_hash::FxHashMap;

/// Times that corners are moved, as they may come to others.
const ROUNDS: usize = 8;

/// Moves corners of closed lines that are nearer to each other than `width` grid steps apart, half of what is missing
/// each: places of one boundary that lie apart at rest and are pressed onto each other. `lengths` as of
/// [`crate::parted_corners::part_corners`].
pub(crate) fn part_pressed(shown: &mut [GridPoint], lengths: &[usize], width: f64) {
    let inwards = Inwards::new(shown, lengths);
    let size = width.ceil().max(1.0) as i64;
    let bin = |place: GridPoint| [place.x.div_euclid(size), place.y.div_euclid(size)];
    for _ in 0..ROUNDS {
        let mut bins = FxHashMap::<[i64; 2], Vec<usize>>::default();
        shown.iter().enumerate().for_each(|(k, &place)| bins.entry(bin(place)).or_default().push(k));
        let mut moves = vec![Vector::zeros(); shown.len()];
        for (k, &place) in shown.iter().enumerate() {
            let [x, y] = bin(place);
            let near = (x - 1..=x + 1).flat_map(|x| (y - 1..=y + 1).map(move |y| [x, y]));
            for &other in near.filter_map(|bin| bins.get(&bin)).flatten().filter(|&&other| other != k) {
                let from = shown[other];
                let way = Vector::new((place.x - from.x) as f64, (place.y - from.y) as f64);
                let missing = (1.0 + MORE) * width + 2.0 - way.norm();
                if way.norm() < width {
                    // What lies in one place goes into its own material.
                    moves[k] += 0.5 * missing * way.try_normalize(0.5).unwrap_or_else(|| inwards.of(k));
                }
            }
        }
        if moves.iter().all(|way| *way == Vector::zeros()) {
            break;
        }
        for (place, way) in shown.iter_mut().zip(moves) {
            *place = GridPoint::new(place.x + way.x.round() as i64, place.y + way.y.round() as i64);
        }
    }
}

/// Moves corners of the boundaries of `caps`, the parts of one object, that are nearer than `width` grid steps apart:
/// those that follow particles may have come to others, and parts may touch.
pub(crate) fn part_caps(caps: &mut [(Cap, Vec<Carried>)], sources: &mut [SourceEdge], width: f64) {
    let contours = || caps.iter().flat_map(|(cap, _)| &cap.shape);
    let mut corners: Vec<GridPoint> = contours().flatten().map(|edge| edge.a).collect();
    let lengths: Vec<usize> = contours().map(Vec::len).collect();
    part_pressed(&mut corners, &lengths, width);
    let mut begin = 0;
    for contour in caps.iter_mut().flat_map(|(cap, _)| &mut cap.shape) {
        let length = contour.len();
        for (i, edge) in contour.iter_mut().enumerate() {
            (edge.a, edge.b) = (corners[begin + i], corners[begin + (i + 1) % length]);
            let source = &mut sources[edge.source.0 as usize];
            (source.a, source.b) = (edge.a, edge.b);
        }
        begin += length;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Truth: what is asked for. The two sides of a slot that is pressed shut, corners of one beside those of the
        /// other: all come to be so far apart, none goes farther than that, and those that were apart stay.
        #[test]
        fn corners_that_are_pressed_come_apart(
            slid in proptest::collection::vec(-40..40_i64, 2..9), gap in 1..120_i64, width in 20.0..80.0_f64,
        ) {
            let count = slid.len() as i64;
            let upper = (0..count).map(|k| GridPoint::new(1000 * k, gap));
            let lower = (0..count).rev().map(|k| GridPoint::new(1000 * k + slid[k as usize], 0));
            let mut shown: Vec<GridPoint> = upper.chain(lower).collect();
            shown.extend([GridPoint::new(-5000, -5000), GridPoint::new(-5000, 5000)]);
            let before = shown.clone();
            part_pressed(&mut shown, &[before.len()], width);
            let distance = |p: GridPoint, q: GridPoint| ((p.x - q.x) as f64).hypot((p.y - q.y) as f64);
            for (k, &place) in shown.iter().enumerate() {
                let others = |of: &[GridPoint]| (0..of.len()).filter(|&j| j != k).map(|j| distance(of[j], of[k])).fold(1e9, f64::min);
                prop_assert!(others(&shown) >= width);
                prop_assert!(distance(place, before[k]) <= width);
                prop_assert!(others(&before) < width || place == before[k]);
            }
        }
    }

    /// Truth: by hand. Two squares that touch at a corner: each corner goes into its own square.
    #[test]
    fn corners_in_one_place_go_into_their_own_material() {
        let square =
            |x: i64, y: i64| [(0, 0), (900, 0), (900, 900), (0, 900)].map(|(u, v)| GridPoint::new(x + u, y + v));
        let mut shown = [square(0, 0), square(-900, -900)].concat();
        part_pressed(&mut shown, &[4, 4], 100.0);
        let [p, q] = [shown[0], shown[6]];
        assert!(p.x == p.y && q.x == q.y && p.x == -q.x && (36..40).contains(&p.x), "{p:?} {q:?}");
    }
}
