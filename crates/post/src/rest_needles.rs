//! Needles of material at rest: cracks that run together leave corners whose sides are nearer to each other, far along
//! them, than readers merge vertices, and than single precision tells apart. Triangles in them fold as soon as the
//! material moves. So they end bluntly, as those of [`crate::needles`] do, but told by the material at rest alone.

use crate::boolean::{Edge, SourceIndex};
use crate::rest_cut::between;
use crate::slot::Slot;
use crate::source::{Carried, SourceEdge};
use crate::two_sides::TwoSides;
use fissure_scene::{Point, Vector};

/// Cosine of the angle below which a corner is sharp: 60 degrees.
const SHARP: f64 = 0.5;
/// A corner may end bluntly already, in so many edges.
const MOST_ENDS: usize = 2;
/// Sides are followed over so many edges, and as long as they turn by less than this cosine says: 60 degrees.
const MOST_EDGES: usize = 256;
const STRAIGHT: f64 = 0.5;

/// Ends sharp corners bluntly where their sides are `least` [m] apart at rest, if corners along them are nearer.
/// Corners that were drawn stay, and so do cracks.
pub(crate) fn blunt_at_rest(boundaries: &mut [Vec<SourceEdge>], least: f64) {
    for number in 0..boundaries.len() {
        // Each takes corners away, but for rounding.
        let (mut i, mut left) = (0, boundaries[number].len());
        while i < boundaries[number].len() && left > 0 {
            let found = |end: usize| needle(&boundaries[number], i, end, least);
            let free = |needle: &Needle| needle.is_free(number, boundaries);
            if let Some(needle) = (0..=MOST_ENDS).filter_map(found).find(free) {
                boundaries[number] = needle.left_of(&boundaries[number]);
                (i, left) = (0, left - 1);
            } else {
                i += 1;
            }
        }
    }
}

/// Where one side of a needle ends.
#[derive(Debug, Clone, Copy)]
struct End {
    /// How many edges away from the corner, and how far along that one from its end nearer to the corner, 0 to 1.
    edges: usize,
    part: f64,
}

/// A sharp corner, at the end of an edge, or as many short edges from there on, and where its sides are to end.
struct Needle {
    corner: usize,
    end: usize,
    back: End,
    forth: End,
    /// The side, 0 or 1, whose edge goes right to the end of the other one.
    joins: Option<usize>,
}

/// The needle at the end of edge `corner` of a boundary and `end` short edges after it; none where that is not sharp or
/// stays, or where its sides do not part.
fn needle(boundary: &[SourceEdge], corner: usize, end: usize, least: f64) -> Option<Needle> {
    let count = boundary.len();
    let is_short = |edge: &SourceEdge| (edge.carried[1].rest - edge.carried[0].rest).norm() < least;
    if count < end + 4 || (1..=end).any(|k| !is_short(&boundary[(corner + k) % count])) {
        return None;
    }
    let side = |k: usize, is_back: bool| {
        let edge = &boundary[(if is_back { corner + count - k } else { corner + end + 1 + k }) % count];
        let [a, b] = [0, 1].map(|end| edge.carried[end].rest);
        if is_back { (b, a) } else { (a, b) }
    };
    let [back, forth] = [side(0, true), side(0, false)];
    let (one, two) = (back.1 - back.0, forth.1 - forth.0);
    // The tip of a crack; and a corner that material lies around.
    let across = if end == 0 { two } else { forth.0 - back.0 };
    if back.1 == forth.1 || one.perp(&across) >= 0.0 || one.dot(&two) < SHARP * one.norm() * two.norm() {
        return None;
    }
    let slots = [corner, (corner + end + 1) % count].map(|k| boundary[k].slot);
    if slots == [Slot::Outside; 2] {
        return None;
    }
    let most = MOST_EDGES.min((count - end - 2) / 2);
    // As far along one side as along the other, from corner to corner of both.
    let mut along = TwoSides::default();
    let mut before: [Point; 2] = [back.0, forth.0];
    loop {
        let k = along.edges;
        let sides = [side(k[0], true), side(k[1], false)];
        let lengths = sides.map(|(a, b)| (b - a).norm());
        let turns = |s: usize, way: Vector| {
            let edge = sides[s].1 - sides[s].0;
            edge.dot(&way) <= STRAIGHT * lengths[s] * way.norm()
        };
        if let Some(s) = (0..2).find(|&s| turns(s, [one, two][s])) {
            // The tip of a crack beside another line: the other side goes on from there.
            let (tip, other) = (k[s].checked_sub(1)?, 1 - s);
            let part = along.part(other, along.reached, lengths);
            let is_whole = (1.0 - part) * lengths[other] < least;
            let mut ends = [End { edges: tip, part: 1.0 }; 2];
            ends[other] = End { edges: k[other], part: if is_whole { 1.0 } else { part } };
            return Some(Needle { corner, end, back: ends[0], forth: ends[1], joins: (!is_whole).then_some(other) });
        }
        let to = along.next(lengths);
        let at = |s: usize| sides[s].0 + along.part(s, to, lengths) * (sides[s].1 - sides[s].0);
        let ahead = [at(0), at(1)];
        let width = (ahead[1] - ahead[0]).norm();
        if width >= least {
            // No corner before that is near to the other side.
            if k == [0, 0] {
                return None;
            }
            let narrow = (before[1] - before[0]).norm();
            let arc = along.reached + (least - narrow) / (width - narrow) * (to - along.reached);
            let side_end = |s: usize| {
                let part = along.part(s, arc, lengths);
                // What would be left of the edge is too short.
                let is_whole = (1.0 - part) * lengths[s] < least;
                End { edges: k[s], part: if is_whole { 1.0 } else { part } }
            };
            return Some(Needle { corner, end, back: side_end(0), forth: side_end(1), joins: None });
        }
        along.go_on(to, lengths);
        if along.edges[0] + along.edges[1] >= 2 * most {
            return None;
        }
        before = ahead;
    }
}

impl Needle {
    /// The boundary without it.
    fn left_of(&self, boundary: &[SourceEdge]) -> Vec<SourceEdge> {
        let count = boundary.len();
        let [first, last] = self.ends(count);
        let (one, two) = (&boundary[first], &boundary[last]);
        let ends = [at(one, 1.0 - self.back.part), at(two, self.forth.part)];
        let slot = if one.slot == Slot::Inside { Slot::Inside } else { two.slot };
        let mut carried = [ends[0].1, ends[1].1];
        if one.slot != two.slot {
            // An outline has no history.
            let wall = carried[usize::from(two.slot == Slot::Inside)].history;
            carried.iter_mut().for_each(|carried| carried.history = wall);
        }
        let mut left = Vec::with_capacity(count);
        let to = |end: usize, with: Carried| Carried { rest: ends[end].1.rest, velocity: ends[end].1.velocity, ..with };
        match self.joins {
            None => left.push(SourceEdge { a: ends[0].0, b: ends[1].0, carried, slot }),
            Some(0) => {}
            Some(_) => left.push(SourceEdge { a: ends[0].0, carried: [to(0, ends[1].1), two.carried[1]], ..*two }),
        }
        if self.forth.part < 1.0 && self.joins != Some(1) {
            left.push(SourceEdge { a: ends[1].0, carried: [ends[1].1, two.carried[1]], ..*two });
        }
        let mut k = (last + 1) % count;
        while k != first {
            left.push(boundary[k]);
            k = (k + 1) % count;
        }
        if self.joins == Some(0) {
            left.push(SourceEdge { b: ends[1].0, carried: [one.carried[0], to(1, ends[0].1)], ..*one });
        } else if self.back.part < 1.0 {
            left.push(SourceEdge { b: ends[0].0, carried: [one.carried[0], ends[0].1], ..*one });
        }
        left
    }

    /// The edges on which it ends.
    fn ends(&self, count: usize) -> [usize; 2] {
        [(self.corner + count - self.back.edges) % count, (self.corner + self.end + 1 + self.forth.edges) % count]
    }

    /// Whether something is left of its boundary, the one of this `number`, and no other corner lies in it.
    fn is_free(&self, number: usize, boundaries: &[Vec<SourceEdge>]) -> bool {
        let boundary = &boundaries[number];
        let count = boundary.len();
        let [first, last] = self.ends(count);
        let gone = self.back.edges + self.end + self.forth.edges + 1;
        if gone + 3 > count {
            return false;
        }
        let corner = |edge: &SourceEdge| edge.carried[1].rest;
        let mut around: Vec<Point> = (0..gone).map(|k| corner(&boundary[(first + k) % count])).collect();
        around.extend(
            [(last, self.forth.part), (first, 1.0 - self.back.part)].map(|(k, part)| at(&boundary[k], part).1.rest),
        );
        let mut others = boundaries.iter().flatten().map(corner).filter(|place| !around.contains(place));
        !others.any(|place| contains(&around, place))
    }
}

/// A place on an edge, a part of the way along it, as it is now and what it carries.
fn at(edge: &SourceEdge, part: f64) -> (crate::snap::GridPoint, Carried) {
    let whole = Edge { a: edge.a, b: edge.b, source: SourceIndex(0) };
    match part {
        0.0 => (edge.a, edge.carried[0]),
        1.0 => (edge.b, edge.carried[1]),
        _ => (between(&whole, part), edge.carried[0].between(&edge.carried[1], part)),
    }
}

/// Whether a place lies within a ring, by how often a ray to the right crosses it.
fn contains(ring: &[Point], place: Point) -> bool {
    let mut is_in = false;
    for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
        if (a.y > place.y) != (b.y > place.y) && place.x < a.x + (place.y - a.y) / (b.y - a.y) * (b.x - a.x) {
            is_in = !is_in;
        }
    }
    is_in
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rest_boundary::{boundary, corners};
    use proptest::prelude::*;

    fn area(corners: &[(f64, f64)]) -> f64 {
        let next = corners.iter().cycle().skip(1);
        0.5 * corners.iter().zip(next).map(|(a, b)| a.0 * b.1 - b.0 * a.1).sum::<f64>()
    }

    proptest! {
        /// Truth: closed form. A needle on a block, pointed or with a short edge at its end, ends where it is
        /// `least` wide or at the corner after that.
        #[test]
        fn needles_end_where_they_are_wide_enough(
            angle in 1e-6..0.01_f64, is_blunt: bool, stops in proptest::collection::vec(0.01..0.9_f64, 1..6),
        ) {
            let (length, least) = (1.0, 2e-4);
            let mut parts = stops;
            parts.sort_by(f64::total_cmp);
            parts.dedup_by(|a, b| (*a - *b).abs() < 1e-3);
            let at = |part: f64, side: f64| (-length * part, side * 0.5 * angle * length * part);
            let mut ring = vec![(-2.0, 1.0), (-2.0, -1.0), (-1.0, -1.0)];
            ring.push(at(1.0, -1.0));
            ring.extend(parts.iter().rev().map(|&part| at(part, -1.0)));
            ring.extend(if is_blunt { vec![at(1e-5, -1.0), at(1e-5, 1.0)] } else { vec![(0.0, 0.0)] });
            ring.extend(parts.iter().map(|&part| at(part, 1.0)));
            ring.extend([at(1.0, 1.0), (-1.0, 1.0)]);
            let mut found = vec![boundary(&ring)];
            blunt_at_rest(&mut found, least);
            let left = corners(&found[0]);
            let point = left.iter().map(|corner| corner.0).fold(f64::MIN, f64::max);
            let wide = least / angle;
            if wide >= length {
                // The sides part at the block.
                prop_assert!(point < -0.99 * length, "{}", point);
            } else if wide > parts[0] {
                prop_assert!(point <= -0.999 * wide && point >= -wide - 0.99 * length, "{} {}", point, wide);
            } else {
                prop_assert_eq!(&left, &ring);
            }
            prop_assert!(area(&ring) - area(&left) <= 0.51 * least * length);
            let before = left.len();
            blunt_at_rest(&mut found, least);
            prop_assert_eq!(corners(&found[0]).len(), before);
        }
    }

    /// Truth: by hand. A crack in a block that ends on the side of this, beside it all along: the strip between goes,
    /// and the side leads on along the other face of the crack. Cracks by themselves stay, as does what was drawn.
    #[test]
    fn what_lies_between_a_crack_and_the_line_that_it_ends_on_goes() {
        let ring = [(4.0, -3.0), (4.0, 0.0), (0.0, 0.0), (2.0, 1e-5), (0.0, 0.0), (-1.0, 0.0), (-1.0, -3.0)];
        // The way comes along y = 0 from the right; the crack goes back from (0, 0) below it, to its tip at 2.
        let below = |(x, y): (f64, f64)| if y == 1e-5 { (x, -1e-5) } else { (x, y) };
        let ring = ring.map(below);
        let mut found = vec![boundary(&ring)];
        blunt_at_rest(&mut found, 2e-4);
        let left = [(2.0, -1e-5), (0.0, 0.0), (-1.0, 0.0), (-1.0, -3.0), (4.0, -3.0), (4.0, 0.0)];
        assert_eq!(corners(&found[0]), left);
        let mut drawn = vec![boundary(&ring)];
        drawn[0].iter_mut().for_each(|edge| edge.slot = Slot::Outside);
        let before = drawn.clone();
        blunt_at_rest(&mut drawn, 2e-4);
        assert_eq!(drawn, before);
        let slit = [
            (0.0, 0.0),
            (9.0, 0.0),
            (9.0, 9.0),
            (0.0, 9.0),
            (0.0, 5.0),
            (3.0, 5.0),
            (4.0, 5.0),
            (3.0, 5.0),
            (0.0, 5.0),
        ];
        let mut found = vec![boundary(&slit)];
        blunt_at_rest(&mut found, 2e-4);
        assert_eq!(corners(&found[0]), slit);
    }
}
