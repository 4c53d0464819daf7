//! Rings and cracks as segments between vertices.

use super::{Line, RestCrack, RestRing};
use crate::frame::CrackEnd;
use fissure_plane::{Point, nearest_on_segment, orientation};
use rustc_hash::FxHashMap;
use std::ops::Range;

/// Two places nearer to each other than this part of the extent of everything are one: half the digits of a number.
const SAME: f64 = 1.5e-8;

/// A segment of a ring or a crack (of its face above).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Segment {
    pub(super) body: u32,
    pub(super) line: Line,
    /// The points of the line that it joins.
    pub(super) points: [usize; 2],
    /// The vertices on it with the part of its length where they lie, in order, its ends included.
    pub(super) stops: Vec<(f64, usize)>,
}

/// All segments, and where their vertices are at rest [m].
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Lines {
    pub(super) places: Vec<Point>,
    pub(super) segments: Vec<Segment>,
}

/// Vertices by body and the bits of their place.
type Known = FxHashMap<(u32, [u64; 2]), usize>;

impl Lines {
    pub(super) fn new(rings: &[RestRing<'_>], cracks: &[RestCrack<'_>]) -> Self {
        let mut lines = Self::default();
        let mut known = Known::default();
        for (i, ring) in rings.iter().enumerate() {
            let count = ring.points.len();
            let pairs = (0..count).map(|k| [k, (k + 1) % count]);
            lines.add(ring.body, Line::Ring(i), ring.points, pairs, &mut known);
        }
        let of_rings = 0..lines.segments.len();
        let add_crack = |(i, crack): (usize, &RestCrack<'_>)| {
            let pairs = (1..crack.points.len()).map(|k| [k - 1, k]);
            let from = lines.segments.len();
            lines.add(crack.body, Line::Above(i), crack.points, pairs, &mut known);
            from..lines.segments.len()
        };
        let of_cracks: Vec<Range<usize>> = cracks.iter().enumerate().map(add_crack).collect();
        lines.join_ends(cracks, &of_rings, &of_cracks);
        lines.cut_where_cracks_cross();
        for segment in &mut lines.segments {
            segment.stops.sort_by(|p, q| p.0.total_cmp(&q.0));
        }
        lines
    }

    fn add(
        &mut self,
        body: u32,
        line: Line,
        points: &[Point],
        pairs: impl Iterator<Item = [usize; 2]>,
        known: &mut Known,
    ) {
        let mut vertex = |place: Point| {
            // Adding zero makes −0 and 0 the same place.
            let bits = [place.x + 0.0, place.y + 0.0].map(f64::to_bits);
            *known.entry((body, bits)).or_insert_with(|| {
                self.places.push(place);
                self.places.len() - 1
            })
        };
        for pair in pairs {
            let [a, b] = pair.map(|k| vertex(points[k]));
            if a != b {
                self.segments.push(Segment { body, line, points: pair, stops: vec![(0.0, a), (1.0, b)] });
            }
        }
    }

    /// Makes the ends of cracks vertices of what they end on; the ranges are those of segments.
    fn join_ends(&mut self, cracks: &[RestCrack<'_>], of_rings: &Range<usize>, of_cracks: &[Range<usize>]) {
        let mut at: Vec<Vec<usize>> = vec![Vec::new(); self.places.len()];
        for (s, segment) in self.segments.iter().enumerate() {
            segment.stops.iter().for_each(|&(_, vertex)| at[vertex].push(s));
        }
        for (crack, own) in cracks.iter().zip(of_cracks).filter(|(_, own)| !own.is_empty()) {
            for (end, segment, stop) in [(crack.ends[0], own.start, 0), (crack.ends[1], own.end - 1, 1)] {
                let hosts = match end {
                    CrackEnd::Tip => None,
                    CrackEnd::Mouth => Some(of_rings),
                    CrackEnd::Junction { crack: number } => {
                        cracks.iter().position(|c| c.crack == number).map(|host| &of_cracks[host])
                    }
                };
                let Some(hosts) = hosts else { continue };
                let is_host = |s: usize| s != segment && self.segments[s].body == crack.body;
                let vertex = self.segments[segment].stops[stop].1;
                if !at[vertex].iter().any(|&s| hosts.contains(&s) && is_host(s)) {
                    let hosts: Vec<usize> = hosts.clone().filter(|&s| is_host(s)).collect();
                    self.lead(segment, stop, &hosts, &mut at);
                }
            }
        }
    }

    /// Leads an end of a segment to the nearest place of the segments `hosts`.
    fn lead(&mut self, segment: usize, stop: usize, hosts: &[usize], at: &mut [Vec<usize>]) {
        let vertex = self.segments[segment].stops[stop].1;
        let place = self.places[vertex];
        let ends = |s: usize| self.ends(s);
        let foot = |&s: &usize| nearest_on_segment(ends(s)[0], ends(s)[1], place);
        let distance = |s: &usize| (foot(s) - place).norm();
        let Some(&host) = hosts.iter().min_by(|s, t| distance(s).total_cmp(&distance(t))) else { return };
        let (foot, [a, b]) = (foot(&host), self.ends(host));
        let near = SAME * self.places.iter().fold(0.0_f64, |extent, p| extent.max((p - place).amax()));
        if let Some(&(_, corner)) = self.segments[host].stops.iter().find(|s| (self.places[s.1] - foot).norm() <= near)
        {
            self.segments[segment].stops[stop].1 = corner;
            at[corner].push(segment);
        } else {
            self.segments[host].stops.push(((foot - a).norm() / (b - a).norm(), vertex));
            at[vertex].push(host);
        }
    }

    fn ends(&self, segment: usize) -> [Point; 2] {
        let stops = &self.segments[segment].stops;
        [self.places[stops[0].1], self.places[stops[1].1]]
    }

    /// Whether two segments are of one body and do not meet in a vertex yet: one that ends on the other may stick
    /// out by rounding.
    fn can_cross(&self, s: usize, t: usize) -> bool {
        let [s, t] = [s, t].map(|i| &self.segments[i]);
        s.body == t.body && !s.stops.iter().any(|p| t.stops.iter().any(|q| p.1 == q.1))
    }

    /// Makes vertices of the places where two cracks of a body cross within a segment of each.
    fn cut_where_cracks_cross(&mut self) {
        /// A segment and the box around it.
        struct Boxed {
            segment: usize,
            low: Point,
            high: Point,
        }
        let of_cracks = (0..self.segments.len()).filter(|&s| matches!(self.segments[s].line, Line::Above(_)));
        let boxed = |segment| {
            let [a, b] = self.ends(segment);
            Boxed { segment, low: a.inf(&b), high: a.sup(&b) }
        };
        let mut order: Vec<Boxed> = of_cracks.map(boxed).collect();
        order.sort_by(|one, other| one.low.x.total_cmp(&other.low.x));
        let mut crossings = Vec::new();
        for (k, one) in order.iter().enumerate() {
            for other in order[k + 1..].iter().take_while(|other| other.low.x <= one.high.x) {
                let (s, t) = (one.segment, other.segment);
                let is_near = other.low.y <= one.high.y && other.high.y >= one.low.y;
                if is_near && self.can_cross(s, t) {
                    crossings.extend(crossing(self.ends(s), self.ends(t)).map(|parts| ([s, t], parts)));
                }
            }
        }
        for (pair, parts) in crossings {
            let [a, b] = self.ends(pair[0]);
            self.places.push(a + (b - a) * parts[0]);
            for (segment, part) in pair.into_iter().zip(parts) {
                self.segments[segment].stops.push((part, self.places.len() - 1));
            }
        }
    }
}

/// Where two segments cross, each on both sides of the other, as parts of their lengths.
fn crossing([a, b]: [Point; 2], [c, d]: [Point; 2]) -> Option<[f64; 2]> {
    let (of_a, of_b) = (orientation(c, d, a), orientation(c, d, b));
    let (of_c, of_d) = (orientation(a, b, c), orientation(a, b, d));
    let cross = of_a * of_b < 0.0 && of_c * of_d < 0.0;
    cross.then(|| [of_a / (of_a - of_b), of_c / (of_c - of_d)])
}
