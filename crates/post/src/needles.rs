//! Corners so sharp that both sides are nearer to each other, far along them, than readers merge vertices: needles of
//! material, and cracks that narrow to a point.
//!
//! ```text
//!     ────────╲___            ───────╮
//!     ────────╱      becomes  ───────╯
//! ```

use crate::boolean::{Contour, Edge, Shape, SourceIndex, twice_area};
use crate::short_edges::Growth;
use crate::slot::Slot;
use crate::snap::{GridPoint, turn};
use crate::source::SourceEdge;
use crate::triangulate::inwards;
use crate::two_sides::TwoSides;
use spade::Point2;

/// Corners below this angle are sharp [degrees]: new corners in the middle of the shortest edges beside them would be
/// nearer to each other than half of these.
const SHARP: f64 = 60.0;
/// Sides are followed over so many edges.
const MOST_EDGES: usize = 64;

/// Ends sharp corners bluntly where their sides are `least` grid steps apart. `sources` receives the edges across.
/// Corners that were drawn stay, and those of cracks where polygons may hardly grow. Tells whether there were any.
pub(crate) fn blunt_needles(shapes: &mut [Shape], least: f64, growth: Growth, sources: &mut Vec<SourceEdge>) -> bool {
    let mut any = false;
    for shape in 0..shapes.len() {
        for contour in 0..shapes[shape].len() {
            let mut i = 0;
            while i < shapes[shape][contour].len() {
                let edges = &shapes[shape][contour];
                let found = needle(edges, i, least, growth, sources).filter(|needle| needle.is_free(edges, shapes));
                let Some(needle) = found else {
                    i += 1;
                    continue;
                };
                needle.cut(&mut shapes[shape][contour], sources);
                // What comes before may be sharp now.
                (i, any) = (0, true);
            }
        }
    }
    any
}

/// A sharp corner between two edges of a contour, and where it is to end.
struct Needle {
    /// The edges before and after the corner on which it ends, and where.
    before: usize,
    after: usize,
    ends: [GridPoint; 2],
}

/// The needle at the end of edge `corner` of a contour; none where that is not sharp, where it stays, or where its
/// sides do not part.
fn needle(contour: &Contour, corner: usize, least: f64, growth: Growth, sources: &[SourceEdge]) -> Option<Needle> {
    let count = contour.len();
    let next = (corner + 1) % count;
    let (one, two) = (&contour[corner], &contour[next]);
    let (back, forth) = (way(one.b, one.a), way(two.a, two.b));
    if !is_sharp(back, forth) {
        return None;
    }
    // Going on to the left of the way back encloses nothing: the corner of a crack.
    let is_crack = back.0 * forth.1 - back.1 * forth.0 > 0.0;
    if (is_crack && growth == Growth::Hardly) || is_drawn(one, two, sources) {
        return None;
    }
    let edge = |k: usize, is_back: bool| {
        if is_back {
            let edge = &contour[(corner + count - k) % count];
            (edge.b, edge.a)
        } else {
            let edge = &contour[(next + k) % count];
            (edge.a, edge.b)
        }
    };
    let most = MOST_EDGES.min((count - 1) / 2);
    // As far along one side as along the other, from corner to corner of both.
    let mut along = TwoSides::default();
    let mut places = [one.b; 2].map(|p| (p.x as f64, p.y as f64));
    loop {
        let k = along.edges;
        let sides = [edge(k[0], true), edge(k[1], false)];
        let lengths = sides.map(|(a, b)| length(a, b));
        let to = along.next(lengths);
        let at = |s: usize, arc: f64| {
            let (a, b) = sides[s];
            let (part, way) = (along.part(s, arc, lengths), way(a, b));
            (a.x as f64 + part * way.0, a.y as f64 + part * way.1)
        };
        let ahead = [at(0, to), at(1, to)];
        let width = |p: [(f64, f64); 2]| (p[1].0 - p[0].0, p[1].1 - p[0].1);
        let (from, end) = (width(places), width(ahead));
        if end.0.hypot(end.1) >= least {
            let part = part_with_length(from, end, least);
            let arc = along.reached + part * (to - along.reached);
            let ends = [at(0, arc), at(1, arc)].map(|(x, y)| Point2::new(x, y));
            let (before, after) = ((corner + count - k[0]) % count, (next + k[1]) % count);
            let ends = [inwards(&contour[before], ends[0]), inwards(&contour[after], ends[1])];
            let needle = Needle { before, after, ends };
            return (ends[0] != ends[1] && needle.shortens(contour)).then_some(needle);
        }
        along.go_on(to, lengths);
        if along.edges[0] + along.edges[1] >= 2 * most {
            return None;
        }
        places = ahead;
    }
}

/// Whether there is a sharp corner between two ways from one place.
fn is_sharp(one: (f64, f64), two: (f64, f64)) -> bool {
    let (sin, cos) = (one.0 * two.1 - one.1 * two.0, one.0 * two.0 + one.1 * two.1);
    sin.atan2(cos).abs() < SHARP.to_radians()
}

/// Whether the corner between two edges was drawn as sharp. Outlines are folded where the corner between them and a
/// crack is pushed along them.
fn is_drawn(one: &Edge, two: &Edge, sources: &[SourceEdge]) -> bool {
    let at = |edge: &Edge, point| sources[edge.source.0 as usize].at(point).rest;
    let (back, forth) = (at(one, one.a) - at(one, one.b), at(two, two.b) - at(two, two.a));
    let is_outline = |edge: &Edge| sources[edge.source.0 as usize].slot == Slot::Outside;
    is_outline(one) && is_outline(two) && is_sharp((back.x, back.y), (forth.x, forth.y))
}

impl Needle {
    /// The corners that go, in order.
    fn corners(&self, contour: &Contour) -> Vec<GridPoint> {
        let count = contour.len();
        let corners = (self.after + count - self.before) % count;
        (0..corners).map(|k| contour[(self.before + k) % count].b).collect()
    }

    /// Whether the way around `contour` is shorter without it, and its corner gone. Where sides are a grid step apart,
    /// rounding may leave the corner as it was; as each cut shortens the contour, cutting comes to an end.
    fn shortens(&self, contour: &Contour) -> bool {
        let (first, last) = (&contour[self.before], &contour[self.after]);
        let corners = self.corners(contour);
        let [p, q] = self.ends;
        let along = |places: &mut dyn Iterator<Item = GridPoint>| {
            let mut before = first.a;
            places.map(|place| length(std::mem::replace(&mut before, place), place)).sum::<f64>()
        };
        let now = along(&mut corners.iter().copied().chain([last.b]));
        let then = along(&mut [p, q, last.b].into_iter());
        then < now && (corners.len() > 1 || !corners.contains(&p) && !corners.contains(&q))
    }

    /// The edges that are left of a contour, the shortened ones and the one across, which has source `across`, first.
    fn left_of(&self, contour: &Contour, across: SourceIndex) -> Contour {
        let (first, last) = (contour[self.before], contour[self.after]);
        let [p, q] = self.ends;
        let mut left = Vec::with_capacity(contour.len() + 1);
        left.extend([Edge { b: p, ..first }, Edge { a: p, b: q, source: across }, Edge { a: q, ..last }]);
        let mut i = (self.after + 1) % contour.len();
        while i != self.before {
            left.push(contour[i]);
            i = (i + 1) % contour.len();
        }
        left
    }

    /// Whether the needle of `contour`, one of `shapes`, can go: it holds no other corner, something is left, and the
    /// new edges touch nothing. They may although the old ones do not, where something is nearer than a grid step, as
    /// their ends are rounded.
    fn is_free(&self, contour: &Contour, shapes: &[Shape]) -> bool {
        let left = self.left_of(contour, contour[self.before].source);
        let new: Vec<Edge> = left[..3].iter().filter(|edge| edge.a != edge.b).copied().collect();
        let gone = self.corners(contour);
        let mut around = gone.clone();
        around.extend([self.ends[1], self.ends[0]]);
        let points = || around.iter().chain([&left[0].a, &left[2].b]);
        let low = points().fold((i64::MAX, i64::MAX), |low, p| (low.0.min(p.x), low.1.min(p.y)));
        let high = points().fold((i64::MIN, i64::MIN), |high, p| (high.0.max(p.x), high.1.max(p.y)));
        let is_near = |edge: &Edge| {
            let Edge { a, b, .. } = edge;
            a.x.max(b.x) >= low.0 && a.x.min(b.x) <= high.0 && a.y.max(b.y) >= low.1 && a.y.min(b.y) <= high.1
        };
        let [p, q] = self.ends;
        let is_blocked = |edge: &Edge| {
            let is_in = !around.contains(&edge.a) && contains(&around, edge.a);
            let is_passed = (edge.a == p && p != left[0].a) || (edge.a == q && q != left[2].b);
            is_in || is_passed || new.iter().any(|new| touches(new, edge))
        };
        let near = shapes.iter().flatten().flatten().filter(|edge| is_near(edge));
        let mut kept = near.filter(|edge| !gone.contains(&edge.a) && !gone.contains(&edge.b));
        let is_as_before = twice_area(&left).signum() == twice_area(contour).signum();
        is_as_before
            && !kept.any(is_blocked)
            && (1..new.len()).all(|i| !new[..i].iter().any(|old| touches(&new[i], old)))
    }

    /// Takes the needle off a contour.
    fn cut(&self, contour: &mut Contour, sources: &mut Vec<SourceEdge>) {
        let of = |edge: usize| sources[contour[edge].source.0 as usize];
        let (first, last) = (of(self.before), of(self.after));
        let [p, q] = self.ends;
        let slot = if first.slot == Slot::Inside { Slot::Inside } else { last.slot };
        let mut carried = [first.at(p), last.at(q)];
        if first.slot != last.slot {
            // An outline has no history.
            let wall = carried[usize::from(last.slot == Slot::Inside)].history;
            carried.iter_mut().for_each(|carried| carried.history = wall);
        }
        let across = SourceEdge { a: p, b: q, carried, slot };
        let source = SourceIndex(sources.len() as u32);
        sources.push(across);
        *contour = self.left_of(contour, source);
        contour.retain(|edge| edge.a != edge.b);
    }
}

/// Whether a point that is no corner of a polygon lies in it.
fn contains(polygon: &[GridPoint], point: GridPoint) -> bool {
    let sides = polygon.iter().zip(polygon.iter().cycle().skip(1));
    let crossed =
        sides.filter(|(a, b)| (a.y > point.y) != (b.y > point.y) && ((turn(**a, **b, point) > 0) == (b.y > a.y)));
    crossed.count() % 2 == 1
}

/// Whether two edges have more in common than an end.
fn touches(one: &Edge, two: &Edge) -> bool {
    let overlap = |p: [i64; 2], q: [i64; 2]| p[0].max(p[1]) >= q[0].min(q[1]) && q[0].max(q[1]) >= p[0].min(p[1]);
    let is_near = overlap([one.a.x, one.b.x], [two.a.x, two.b.x]) && overlap([one.a.y, one.b.y], [two.a.y, two.b.y]);
    let sides = |edge: &Edge, other: &Edge| [other.a, other.b].map(|p| turn(edge.a, edge.b, p).signum());
    let [[c, d], [a, b]] = [sides(one, two), sides(two, one)];
    let ends = [
        (one.a, one.b, two.a, two.b),
        (one.a, one.b, two.b, two.a),
        (one.b, one.a, two.a, two.b),
        (one.b, one.a, two.b, two.a),
    ];
    match ends.into_iter().find(|(here, _, same, _)| here == same) {
        Some((here, there, _, other)) => {
            let (to, from) = (way(here, there), way(here, other));
            c == 0 && d == 0 && to.0 * from.0 + to.1 * from.1 > 0.0
        }
        None => is_near && c * d <= 0 && a * b <= 0,
    }
}

fn way(a: GridPoint, b: GridPoint) -> (f64, f64) {
    ((b.x - a.x) as f64, (b.y - a.y) as f64)
}

fn length(a: GridPoint, b: GridPoint) -> f64 {
    let (x, y) = way(a, b);
    x.hypot(y)
}

/// The part of the way from `from`, a vector shorter than `length`, to `to`, one that is not, where they are as long.
fn part_with_length(from: (f64, f64), to: (f64, f64), length: f64) -> f64 {
    let change = (to.0 - from.0, to.1 - from.1);
    // |from + part change|² = length².
    let a = change.0 * change.0 + change.1 * change.1;
    let b = from.0 * change.0 + from.1 * change.1;
    let c = from.0 * from.0 + from.1 * from.1 - length * length;
    ((-b + (b * b - a * c).max(0.0).sqrt()) / a).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boolean::material;
    use crate::pinch::part_pinches;
    use crate::short_edges::without_short_edges;
    use crate::source::Carried;
    use fissure_scene::{Point, Vector};
    use proptest::prelude::*;

    fn shapes(ring: &[(f64, f64)], slot: Slot) -> (Vec<Shape>, Vec<SourceEdge>) {
        let point = |&(x, y): &(f64, f64)| GridPoint::new(x.round() as i64, y.round() as i64);
        let carried = |(x, y): (f64, f64)| Carried::within(Point::new(x, y), Vector::zeros());
        let edges = ring.iter().zip(ring.iter().cycle().skip(1));
        let source = |(p, q)| SourceEdge { a: point(p), b: point(q), carried: [carried(*p), carried(*q)], slot };
        let sources: Vec<SourceEdge> = edges.map(source).collect();
        (material(&sources), sources)
    }

    fn area(shapes: &[Shape]) -> f64 {
        0.5 * shapes.iter().flatten().map(|contour| twice_area(contour)).sum::<i128>() as f64
    }

    proptest! {
        /// Truth: another implementation, the boolean, says what the edges enclose. Stars of a few grid steps, where
        /// all that is new is rounded past corners beside it, stay polygons whose edges do not cross and that pass
        /// each corner once.
        #[test]
        fn polygons_stay_valid(
            stars in proptest::collection::vec(
                (proptest::collection::vec(0.05..1.0_f64, 3..14), -30.0..30.0_f64, -30.0..30.0_f64), 1..4
            ),
            size in 8.0..60.0_f64, least in 0.3..12.0_f64, hardly: bool,
        ) {
            let corner = |radii: &[f64], i: usize| {
                let (sin, cos) = (std::f64::consts::TAU * i as f64 / radii.len() as f64).sin_cos();
                (size * radii[i] * cos, size * radii[i] * sin)
            };
            let (mut all, mut sources) = (Vec::new(), Vec::new());
            for (radii, x, y) in &stars {
                let star = (0..radii.len()).map(|i| corner(radii, i)).map(|(u, v)| (u + x, v + y));
                all.extend(shapes(&star.collect::<Vec<_>>(), Slot::Inside).1);
            }
            let Ok(mut shapes) = part_pinches(material(&all), { sources.extend(all); &mut sources }, 0.0) else {
                return Ok(());
            };
            let growth = if hardly { Growth::Hardly } else { Growth::Allowed };
            for _ in 0..2 {
                blunt_needles(&mut shapes, least, growth, &mut sources);
                without_short_edges(&mut shapes, least, growth, &mut sources, |_, _| false);
            }
            let edges: Vec<SourceEdge> =
                shapes.iter().flatten().flatten().map(|e| SourceEdge { a: e.a, b: e.b, ..sources[0] }).collect();
            prop_assert_eq!(area(&material(&edges)), area(&shapes));
            let mut corners: Vec<(i64, i64)> = edges.iter().map(|edge| (edge.a.x, edge.a.y)).collect();
            corners.sort_unstable();
            corners.dedup();
            prop_assert_eq!(corners.len(), edges.len());
        }

        /// Truth: closed form. An isosceles needle on a block, or in it, with corners anywhere along its sides, ends
        /// where it is `least` wide: t = least/(2 sin(angle/2)) from its point, t² sin(angle)/2 of its area are gone.
        #[test]
        fn needles_end_where_they_are_wide_enough(
            degrees in 2.0..55.0_f64, heading in -3.0..3.0_f64, is_crack: bool,
            stops in proptest::collection::vec(0.05..0.99_f64, 0..6),
        ) {
            let (length, least, half) = (1e8, 2e5, 0.5 * degrees.to_radians());
            // The point lies at the origin, the needle to the left of it, or the crack to the right.
            let side = |sign: f64, part: f64| (-length * part * half.cos(), sign * length * part * half.sin());
            let mut ring = vec![(0.0, 0.0)];
            let mut parts = stops;
            parts.sort_by(f64::total_cmp);
            parts.push(1.0);
            let (depth, height) = (2.0 * length, 2.0 * length);
            let x = side(1.0, 1.0).0;
            if is_crack {
                ring.extend(parts.iter().map(|&part| side(1.0, part)));
                ring.extend([(x, height), (depth, height), (depth, -height), (x, -height)]);
                ring.extend(parts.iter().rev().map(|&part| side(-1.0, part)));
                ring.reverse();
            } else {
                ring.extend(parts.iter().map(|&part| side(1.0, part)));
                ring.extend([(x, height), (-depth, height), (-depth, -height), (x, -height)]);
                ring.extend(parts.iter().rev().map(|&part| side(-1.0, part)));
            }
            let (sin, cos) = heading.sin_cos();
            ring.iter_mut().for_each(|p| *p = (cos * p.0 - sin * p.1, sin * p.0 + cos * p.1));
            let (whole, mut sources) = shapes(&ring, Slot::Inside);
            let mut blunt = whole.clone();
            blunt_needles(&mut blunt, least, Growth::Allowed, &mut sources);
            let way = least / (2.0 * half.sin());
            let expected = 0.5 * way * way * (2.0 * half).sin() * if is_crack { 1.0 } else { -1.0 };
            let found = area(&blunt) - area(&whole);
            // Where the sides end is rounded to the grid, by a step and a half of it at most.
            prop_assert!((found - expected).abs() < 1.5 * (length + least), "{} for {}", found, expected);
            for contour in blunt.iter().flatten() {
                for (edge, next) in contour.iter().zip(contour.iter().cycle().skip(1)) {
                    prop_assert_eq!(edge.b, next.a);
                    let carried = sources[edge.source.0 as usize].at(edge.a).rest;
                    let off = (carried.x - edge.a.x as f64).hypot(carried.y - edge.a.y as f64);
                    prop_assert!(off < 4.0, "{}", off);
                }
            }
            // What holds something stays: a speck in the middle of the needle.
            let speck: Vec<(f64, f64)> = [(0.0, 0.0), (9.0, 0.0), (0.0, 9.0)]
                .map(|(x, y)| (x - 0.5 * way * cos, y - 0.5 * way * sin))
                .to_vec();
            let mut held = whole.clone();
            held.extend(shapes(&speck, Slot::Inside).0);
            let before = held.clone();
            blunt_needles(&mut held, least, Growth::Allowed, &mut sources.clone());
            prop_assert!(held == before);
            // Drawn corners stay, and cracks where neighbours may be near.
            for (slot, growth) in [(Slot::Outside, Growth::Allowed), (Slot::Inside, Growth::Hardly)] {
                let (whole, mut sources) = shapes(&ring, slot);
                let mut kept = whole.clone();
                blunt_needles(&mut kept, least, growth, &mut sources);
                prop_assert!(kept == whole || (slot == Slot::Inside && !is_crack));
            }
            // Outlines that were straight at rest are folded, not drawn.
            let (mut folded, mut sources) = shapes(&ring, Slot::Outside);
            for (source, along) in sources.iter_mut().zip(0_u32..) {
                source.carried = [along, along + 1].map(|x| Carried::within(Point::new(f64::from(x), 0.0), Vector::zeros()));
            }
            blunt_needles(&mut folded, least, Growth::Allowed, &mut sources);
            prop_assert_eq!(area(&folded), area(&blunt));
        }
    }
}
