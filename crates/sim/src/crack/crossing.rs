//! The line-crossing test: does the straight line from a particle to a node cross a crack, and from which side?
//!
//! Nairn 2003 (CRAMP), as in the thesis, section 3.1.1. Signs come from an exact predicate. For a segment a → b, a
//! particle p and a node n the four signs are those of the triangles (p, n, a), (p, n, b), (a, b, p), (a, b, n).
//!
//! | signs | meaning |
//! |---|---|
//! | − + + −, − + + 0, 0 + + 0, − 0 + 0 | crosses, particle above |
//! | + − − +, + − − 0, 0 − − 0, + 0 − 0 | crosses, particle below |
//!
//! Where no sign is 0 every segment is asked by itself. Otherwise what counts is the crack as a whole: the answer is
//! the one for a particle a hair beside where it is, and the table above is what this gives for one segment.
//!
//! - Particle on the crack: it is a hair above it; at a vertex, between the left sides of both segments.
//! - Node on the crack: it is crossed to from either side, and its own field stays empty. Which side the particle is on
//!   is told by the segment there, at a vertex by the sector between the two, and first of all by what was crossed on
//!   the way.
//! - Both on the crack: above, unless the way from above the crack at the particle leads across it.
//! - Vertex on the way: the way passes beside it, so that it crosses just one of two segments that go on there, and
//!   both or none of two that turn back.
//! - End of the crack on the way, or at the particle: the way does not cross there, nor where it turns into the last
//!   segment of the crack.
//! - Way along a segment: it runs beside it, above it for a particle that lies on it.
//!
//! Mirror images and turned pictures of a crack give the mirrored and turned answers in all cases but one: a particle
//! on the crack, and one that looks at a node on it along the crack from ahead of its end, must go to one side, and a
//! crack along an axis of symmetry has no side that is better.

use fissure_plane::{Point, orientation};
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

/// A side of a crack, for one who walks from its start to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) enum Side {
    /// On the left.
    Above,
    /// On the right.
    Below,
}

impl Side {
    /// The other side.
    pub(crate) fn opposite(self) -> Self {
        match self {
            Self::Above => Self::Below,
            Self::Below => Self::Above,
        }
    }

    /// +1 above, −1 below.
    pub(crate) fn sign(self) -> f64 {
        match self {
            Self::Above => 1.0,
            Self::Below => -1.0,
        }
    }
}

/// A segment of a crack, from `a` to `b` as the crack runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Segment {
    pub(crate) number: u32,
    pub(crate) a: Point,
    pub(crate) b: Point,
}

/// What the way from a particle to a node meets of one crack.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Meeting {
    /// The side of the crack the particle is on as seen from the node; none: the same side. An even number of crossings
    /// cancels.
    pub(crate) side: Option<Side>,
    /// Whether the node lies on the crack itself.
    pub(crate) at_node: bool,
    /// Numbers of the segments that are crossed, those at the node included.
    pub(crate) crossed: SmallVec<[u32; 4]>,
}

fn sign(value: f64) -> i32 {
    i32::from(value > 0.0) - i32::from(value < 0.0)
}

fn side_of_sign(sign: i32) -> Option<Side> {
    match sign {
        0 => None,
        1.. => Some(Side::Above),
        _ => Some(Side::Below),
    }
}

/// Whether a place is on the left at a vertex, given the signs of the place beside the segment that comes in and the
/// one that goes out, and of the turn from the one to the other. `least`: 1 where the segments themselves are not left,
/// 0 where they are.
fn is_left_at_vertex(incoming: i32, outgoing: i32, turn: i32, least: i32) -> bool {
    if turn >= 0 { incoming >= least && outgoing >= least } else { incoming >= least || outgoing >= least }
}

/// Whether the bounding boxes of the segments `p`–`q` and `a`–`b` are disjoint. Asked before the exact test, because
/// most segments in the neighbourhood of a particle are far from its line to a node.
#[inline]
pub(crate) fn apart(p: Point, q: Point, a: Point, b: Point) -> bool {
    p.x.max(q.x) < a.x.min(b.x)
        || p.x.min(q.x) > a.x.max(b.x)
        || p.y.max(q.y) < a.y.min(b.y)
        || p.y.min(q.y) > a.y.max(b.y)
}

/// What the way from `particle` to `node` meets of the crack that is made of `segments`: all that touch the box around
/// the way, in any order.
pub(crate) fn meeting(particle: Point, node: Point, segments: impl Iterator<Item = Segment> + Clone) -> Meeting {
    let near = segments.filter(|s| !apart(particle, node, s.a, s.b));
    let (mut balance, mut crossed) = (0, SmallVec::new());
    for s in near.clone() {
        let (of_particle, of_node) = (sign(orientation(s.a, s.b, particle)), sign(orientation(s.a, s.b, node)));
        if of_particle * of_node > 0 {
            continue;
        }
        let ends = sign(orientation(particle, node, s.a)) * sign(orientation(particle, node, s.b));
        if of_particle * of_node == 0 || ends == 0 {
            return Coincidence::new(particle, node, near.collect()).meeting();
        }
        if ends < 0 {
            balance += of_particle;
            crossed.push(s.number);
        }
    }
    Meeting { side: side_of_sign(balance), at_node: false, crossed }
}

/// Where on a crack a place lies.
#[derive(Debug, Clone, Copy)]
enum OnCrack {
    /// Not on it.
    No,
    /// Within a segment.
    Within(Segment),
    /// Where one segment ends and another begins.
    Vertex([Segment; 2]),
    /// At an end of the crack.
    End(Segment),
}

impl OnCrack {
    fn of(segments: &[Segment], place: Point) -> Self {
        let is_in_box = |s: &&Segment| !apart(place, place, s.a, s.b);
        let holds = |s: &&Segment| is_in_box(s) && orientation(s.a, s.b, place) == 0.0;
        let incoming = segments.iter().find(|s| s.b == place);
        let outgoing = segments.iter().find(|s| s.a == place);
        match (incoming, outgoing) {
            (Some(incoming), Some(outgoing)) => Self::Vertex([*incoming, *outgoing]),
            (Some(one), None) | (None, Some(one)) => Self::End(*one),
            (None, None) => segments.iter().find(holds).map_or(Self::No, |s| Self::Within(*s)),
        }
    }

    fn segments(&self) -> &[Segment] {
        match self {
            Self::No => &[],
            Self::Within(segment) | Self::End(segment) => std::slice::from_ref(segment),
            Self::Vertex(both) => both,
        }
    }

    fn has(&self, segment: &Segment) -> bool {
        self.segments().iter().any(|s| s.number == segment.number)
    }
}

/// A way of which a particle, a node or a vertex lies on one line with others.
#[derive(Debug)]
struct Coincidence {
    particle: Point,
    node: Point,
    segments: Vec<Segment>,
    /// Where the particle is; an end of the crack does not hold it.
    at_particle: OnCrack,
    at_node: OnCrack,
    /// Side of the way that vertices on it count to: 1 left, −1 right.
    vertices: i32,
}

impl Coincidence {
    fn new(particle: Point, node: Point, segments: Vec<Segment>) -> Self {
        let at_particle = match OnCrack::of(&segments, particle) {
            OnCrack::End(_) => OnCrack::No,
            on => on,
        };
        // The way of a particle on the crack, along the crack, runs above it: to the right of it lies what comes.
        let goes_along = |s: &Segment| orientation(s.a, s.b, node) == 0.0 && (node - particle).dot(&(s.b - s.a)) > 0.0;
        let vertices = if at_particle.segments().iter().any(goes_along) { -1 } else { 1 };
        let at_node = OnCrack::of(&segments, node);
        Self { particle, node, segments, at_particle, at_node, vertices }
    }

    /// Side of a segment that the particle is on, when it is a hair beside where it is.
    fn side_beside(&self, s: &Segment) -> i32 {
        match sign(orientation(s.a, s.b, self.particle)) {
            0 if self.at_particle.has(s) => 1,
            0 => -self.vertices * sign((s.b - s.a).dot(&(self.node - self.particle))),
            side => side,
        }
    }

    /// What is met: where the two sides of the way differ, because it runs along the crack to an end of it, the less.
    fn meeting(self) -> Meeting {
        let mut found = self.met();
        let is_free = self.at_particle.segments().is_empty() && self.at_node.segments().is_empty();
        if found.side.is_some() && is_free {
            let other = Self { vertices: -self.vertices, ..self }.met();
            if other.side.is_none() {
                found = other;
            }
        }
        found
    }

    fn met(&self) -> Meeting {
        let mut crossed: SmallVec<[u32; 4]> =
            self.segments.iter().filter(|s| self.crosses(s)).map(|s| s.number).collect();
        let sides = self.segments.iter().filter(|s| crossed.contains(&s.number)).map(|s| self.side_beside(s));
        let mut balance: i32 = sides.sum();
        if self.leaves_downwards() {
            balance += 1;
            crossed.extend(self.at_particle.segments().iter().map(|s| s.number));
        }
        let at_node = !self.at_node.segments().is_empty();
        crossed.extend(self.at_node.segments().iter().map(|s| s.number));
        let side = side_of_sign(if balance == 0 { self.side_at_node() } else { balance });
        Meeting { side, at_node, crossed }
    }

    /// Whether the way crosses a segment that neither the particle nor the node lies on.
    fn crosses(&self, s: &Segment) -> bool {
        let (particle, node) = (self.particle, self.node);
        let sides = sign(orientation(s.a, s.b, particle)) * sign(orientation(s.a, s.b, node));
        if sides >= 0 || self.at_particle.has(s) || self.at_node.has(s) {
            return false;
        }
        let ends = [s.a, s.b].map(|end| match sign(orientation(particle, node, end)) {
            0 if self.is_end_of_crack(end) => None,
            0 => Some(self.vertices),
            side => Some(side),
        });
        matches!(ends, [Some(a), Some(b)] if a * b < 0)
    }

    fn is_end_of_crack(&self, place: Point) -> bool {
        matches!(OnCrack::of(&self.segments, place), OnCrack::End(_))
    }

    /// Whether the way of a particle on the crack leads across the crack where it begins.
    fn leaves_downwards(&self) -> bool {
        let side = |s: &Segment| sign(orientation(s.a, s.b, self.node));
        match &self.at_particle {
            OnCrack::Within(s) => side(s) < 0,
            OnCrack::Vertex([s, t]) => !is_left_at_vertex(side(s), side(t), sign(orientation(s.a, s.b, t.b)), 0),
            OnCrack::No | OnCrack::End(_) => false,
        }
    }

    /// Side of the crack at the node that the way comes from; 0 where the node is not on the crack.
    fn side_at_node(&self) -> i32 {
        match &self.at_node {
            OnCrack::No => 0,
            OnCrack::Within(s) | OnCrack::End(s) => self.side_beside(s),
            OnCrack::Vertex([s, t]) => {
                let turn = sign(orientation(s.a, s.b, t.b));
                if is_left_at_vertex(self.side_beside(s), self.side_beside(t), turn, 1) { 1 } else { -1 }
            }
        }
    }
}

/// The side of a crack through `points` that a place near its segment number `nearest` is on; above for a place on it.
///
/// Where what is nearest is a vertex, the sector between both its segments decides.
pub(crate) fn side_of_crack(points: &[Point], nearest: usize, place: Point) -> Side {
    let beside = |k: usize| sign(orientation(points[k], points[k + 1], place));
    let along = |k: usize, from: usize| (points[k + 1] - points[k]).dot(&(place - points[from]));
    let vertex = if along(nearest, nearest + 1) >= 0.0 {
        nearest + 1
    } else if along(nearest, nearest) <= 0.0 {
        nearest
    } else {
        0
    };
    let is_left = if vertex == 0 || vertex + 1 == points.len() {
        beside(nearest) >= 0
    } else {
        let turn = sign(orientation(points[vertex - 1], points[vertex], points[vertex + 1]));
        is_left_at_vertex(beside(vertex - 1), beside(vertex), turn, 0)
    };
    if is_left { Side::Above } else { Side::Below }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use fissure_plane::{Region, Vector, find_crossing};
    use proptest::prelude::*;

    fn point(x: f64, y: f64) -> Point {
        Point::new(x, y)
    }

    fn meets(particle: Point, node: Point, line: &[Point]) -> Meeting {
        let segments = line.windows(2).enumerate().map(|(k, w)| Segment { number: k as u32, a: w[0], b: w[1] });
        meeting(particle, node, segments)
    }

    fn side(particle: Point, node: Point, line: &[Point]) -> Option<Side> {
        meets(particle, node, line).side
    }

    /// Truth: the table of the thesis, for one segment on the x axis.
    #[test]
    fn every_row_of_the_sign_table() {
        let (a, b) = (point(0.0, 0.0), point(1.0, 0.0));
        let (above, below) = (Some(Side::Above), Some(Side::Below));
        let cases = [
            (point(0.5, 1.0), point(0.5, -1.0), [-1, 1, 1, -1], above),
            (point(0.5, 1.0), point(0.5, 0.0), [-1, 1, 1, 0], above),
            (point(0.5, 1.0), point(0.0, 0.0), [0, 1, 1, 0], above),
            (point(0.5, 1.0), point(1.0, 0.0), [-1, 0, 1, 0], above),
            (point(0.5, -1.0), point(0.5, 1.0), [1, -1, -1, 1], below),
            (point(0.5, -1.0), point(0.5, 0.0), [1, -1, -1, 0], below),
            (point(0.5, -1.0), point(0.0, 0.0), [0, -1, -1, 0], below),
            (point(0.5, -1.0), point(1.0, 0.0), [1, 0, -1, 0], below),
            // Past an end.
            (point(1.0, 1.0), point(1.0, -1.0), [-1, 0, 1, -1], None),
            (point(0.0, -1.0), point(0.0, 1.0), [0, -1, -1, 1], None),
            (point(0.0, 1.0), point(0.0, -1.0), [0, 1, 1, -1], None),
            (point(1.0, -1.0), point(1.0, 1.0), [1, 0, -1, 1], None),
            // The particle on the crack counts as above, also for a node on it.
            (point(0.5, 0.0), point(0.5, -1.0), [-1, 1, 0, -1], above),
            (point(0.5, 0.0), point(0.5, 1.0), [1, -1, 0, 1], None),
            (point(0.5, 0.0), point(0.75, 0.0), [0, 0, 0, 0], above),
            (point(0.5, 0.0), point(0.25, 0.0), [0, 0, 0, 0], above),
            (point(0.5, 0.0), point(1.5, 0.0), [0, 0, 0, 0], None),
            // Misses: beside the segment, before it, along it.
            (point(1.5, 1.0), point(1.5, -1.0), [-1, -1, 1, -1], None),
            (point(0.5, 2.0), point(0.5, 1.0), [-1, 1, 1, 1], None),
            (point(-1.0, 0.0), point(2.0, 0.0), [0, 0, 0, 0], None),
        ];
        for (p, n, signs, expected) in cases {
            let [pna, pnb] = [a, b].map(|end| sign(orientation(p, n, end)));
            assert_eq!([pna, pnb, sign(orientation(a, b, p)), sign(orientation(a, b, n))], signs, "signs at {p} {n}");
            assert_eq!(side(p, n, &[a, b]), expected, "from {p} to {n}");
        }
    }

    #[test]
    fn a_hair_beside_the_crack_is_still_decided() {
        let line = [point(0.1, 0.1), point(0.7, 0.7)];
        let hair = 0.4_f64;
        let next = f64::from_bits(hair.to_bits() + 1);
        assert_eq!(side(point(hair, next), point(0.6, 0.1), &line), Some(Side::Above));
        assert_eq!(side(point(next, hair), point(0.6, 0.1), &line), None);
    }

    /// A ring around the origin, counter-clockwise, whose corners lie at distances of 0.3 to 1.
    fn any_ring() -> impl Strategy<Value = Vec<Point>> {
        prop::collection::vec(0.3_f64..1.0, 3..12).prop_map(|radii| {
            let turn = std::f64::consts::TAU / radii.len() as f64;
            let corner = |(k, r): (usize, &f64)| point(r * (turn * k as f64).cos(), r * (turn * k as f64).sin());
            radii.iter().enumerate().map(corner).collect()
        })
    }

    fn any_point() -> impl Strategy<Value = Point> {
        (-1.2_f64..1.2, -1.2_f64..1.2).prop_map(|(x, y)| point(x, y))
    }

    /// A place of a lattice so coarse that places and lines through them coincide more often than not.
    fn lattice_point() -> impl Strategy<Value = Point> {
        (0_i32..5, 0_i32..5).prop_map(|(x, y)| point(f64::from(x), f64::from(y)))
    }

    /// A crack through places of the lattice that does not touch itself.
    fn any_crack() -> impl Strategy<Value = Vec<Point>> {
        prop::collection::vec(lattice_point(), 2..7).prop_filter("touches itself", |line| {
            line.windows(2).all(|w| w[0] != w[1]) && find_crossing(&[line], false).is_none()
        })
    }

    fn is_on(line: &[Point], p: Point) -> bool {
        line.windows(2).any(|w| !apart(p, p, w[0], w[1]) && orientation(w[0], w[1], p) == 0.0)
    }

    /// A hair to the left (1) or right (−1) of a place on a crack; the place itself where it is not on it.
    fn beside(line: &[Point], p: Point, to: f64) -> Point {
        let along: Vector = line
            .windows(2)
            .filter(|w| !apart(p, p, w[0], w[1]) && orientation(w[0], w[1], p) == 0.0)
            .map(|w| (w[1] - w[0]).normalize())
            .sum();
        // However sharp the turn of a vertex.
        let along = along.try_normalize(0.0).unwrap_or_default();
        p + Vector::new(-along.y, along.x) * (to * 1e-6)
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 4096, max_global_rejects: 1 << 20, ..ProptestConfig::default() })]

        /// Truth: the same a hair beside, where no two places coincide. A particle on the crack is as one a hair to its
        /// left, one elsewhere as all around it, a node on the crack as the face of it that the particle sees.
        #[test]
        fn what_coincides_is_as_a_hair_beside(
            line in any_crack(), particle in lattice_point(), node in lattice_point(), turn in 0.0_f64..6.3,
        ) {
            let ends = [line[0], line[line.len() - 1]];
            let passes = |end: &Point| !apart(particle, node, *end, *end) && orientation(particle, node, *end) == 0.0;
            prop_assume!(particle != node && !ends.iter().any(passes));
            // Off any line of the lattice, and of any other hair.
            let hair = |size: f64| Vector::new(turn.cos(), turn.sin()) * size;
            let p = beside(&line, particle, 1.0) + hair(1e-9);
            let found = side(particle, node, &line);
            if is_on(&line, node) {
                // Of a node beside the crack, particles on its own side have crossed nothing, or come round an end.
                let seen = [1.0, -1.0].map(|to| side(p, beside(&line, node, to) + hair(-2e-9), &line));
                let (above, below) = (Some(Side::Above), Some(Side::Below));
                let expected = if seen[1] == above { above } else { below };
                prop_assert!(seen == [None, above] || seen == [below, None] || seen == [expected; 2], "{seen:?}");
                prop_assert_eq!(found, expected);
            } else {
                prop_assert_eq!(found, side(p, node + hair(-2e-9), &line));
            }
        }

        /// Truth: the picture. Mirrored, turned by a quarter, or with the crack drawn from its other end, every answer
        /// is the mirrored, turned, or renamed one, unless a particle lies on the crack or looks along it from ahead of
        /// its end.
        #[test]
        fn a_mirrored_picture_has_the_mirrored_answer(
            line in any_crack(), particle in lattice_point(), node in lattice_point(),
        ) {
            let ends = [line[0], line[line.len() - 1]];
            let passes = |end: &Point| !apart(particle, node, *end, *end) && orientation(particle, node, *end) == 0.0;
            let looks_along = is_on(&line, node) && ends.iter().any(passes);
            prop_assume!(!is_on(&line, particle) && !looks_along);
            let found = side(particle, node, &line);
            let seen = |view: &dyn Fn(Point) -> Point| {
                side(view(particle), view(node), &line.iter().map(|&p| view(p)).collect::<Vec<_>>())
            };
            prop_assert_eq!(seen(&|p| point(-p.y, p.x)), found);
            prop_assert_eq!(seen(&|p| point(-p.x, p.y)), found.map(Side::opposite));
            let reversed: Vec<Point> = line.iter().rev().copied().collect();
            prop_assert_eq!(side(particle, node, &reversed), found.map(Side::opposite));
        }

        /// Truth: the even-odd rule, which counts along another line. A crack that closes parts inside and outside, and
        /// inside is on its left; coarse places, so that many lines run through vertices.
        #[test]
        fn a_closed_crack_parts_inside_and_outside(
            ring in any_ring(), particle in any_point(), node in any_point(), coarse in any::<bool>(),
        ) {
            let place = |p: Point| if coarse { point((4.0 * p.x).round() / 4.0, (4.0 * p.y).round() / 4.0) } else { p };
            let ring: Vec<Point> = ring.into_iter().map(place).collect();
            let (particle, node) = (place(particle), place(node));
            let closed: Vec<Point> = ring.iter().copied().chain([ring[0]]).collect();
            // A place on the crack itself belongs to neither; rings that coarse places fold are no rings.
            prop_assume!(!is_on(&closed, particle) && !is_on(&closed, node) && find_crossing(&[&ring], true).is_none());
            let region = Region { exterior: ring, holes: Vec::new() };
            let expected = match [particle, node].map(|p| region.contains(p)) {
                [true, false] => Some(Side::Above),
                [false, true] => Some(Side::Below),
                _ => None,
            };
            prop_assert_eq!(side(particle, node, &closed), expected);
        }

        /// Truth: the crossing test. The side of a place is the one from which a way from the crack's own left comes
        /// without crossing it.
        #[test]
        fn the_side_of_a_place_is_that_of_what_is_nearest(line in any_crack(), place in lattice_point()) {
            let distance = |k: usize| fissure_plane::distance_to_segment(place, line[k], line[k + 1]);
            let nearest = (0..line.len() - 1).min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap();
            let foot = fissure_plane::nearest_on_segment(line[nearest], line[nearest + 1], place);
            let ends = [line[0], line[line.len() - 1]];
            prop_assume!(!ends.contains(&foot) && is_on(&line, foot));
            let found = side_of_crack(&line, nearest, place);
            prop_assert_eq!(Some(found), side(place, foot, &line));
        }
    }
}
