//! Places where a region, or the space around it, is narrower than a given width.

use crate::{Point, Region, Vector, nearest_on_segment, signed_area};
use std::collections::{BTreeSet, HashMap};

/// What is narrow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum NarrowKind {
    /// The material between two parts of the outline.
    Neck,
    /// The space between two parts of the outline.
    Gap,
    /// A hole as a whole.
    Hole,
}

/// A narrow place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NarrowPlace {
    /// What is narrow.
    pub kind: NarrowKind,
    /// Its middle [m].
    pub place: Point,
    /// How wide it is there [m].
    pub width: f64,
}

/// Parts of an outline that face each other are farther apart along it than this, in widths looked for: nearer ones are
/// a rough edge.
const FAR_ALONG: f64 = 6.0;
/// And farther than this, in their own distance: beside a corner the way around it is 1/sin(α/2) of the width, so that
/// corners above 6° are no narrow places.
const CORNER: f64 = 20.0;
/// Narrow places nearer to a narrower one than this, in widths looked for, belong to it.
const ONE_PLACE: f64 = 4.0;

/// A piece of an edge not longer than the width looked for.
#[derive(Debug, Clone, Copy)]
struct Piece {
    a: Point,
    b: Point,
    ring: usize,
    /// Length of the ring before it [m].
    before: f64,
    /// Unit normals into the material at `a` and `b`, the means of those of both edges where these are corners.
    inward: [Vector; 2],
}

/// Pieces that follow on each other, so short together that they are looked at as one.
#[derive(Debug, Clone)]
struct Run {
    pieces: std::ops::Range<usize>,
    low: Point,
    high: Point,
}

/// The places where `region`, a gap in it or a hole is narrower than `width` [m], the narrowest of each neighbourhood,
/// from the narrowest on.
///
/// Corners are not meant, however sharp the angle down to some 6°, nor is what is rough below the width. Time and
/// memory grow with the number of corners and with the length of the rings in widths.
pub fn narrow_places(region: &Region, width: f64) -> Vec<NarrowPlace> {
    let mut found = Vec::new();
    let lengths: Vec<f64> = region.rings().map(perimeter).collect();
    for (hole, length) in region.holes.iter().zip(&lengths[1..]) {
        // The side of a square hole, twice the width of a slot.
        let size = 4.0 * signed_area(hole).abs() / length;
        if size < width {
            let middle = hole.iter().map(|p| p.coords).sum::<Vector>() / hole.len() as f64;
            found.push(NarrowPlace { kind: NarrowKind::Hole, place: Point::from(middle), width: size });
        }
    }
    let pieces = pieces(region, width);
    let runs = runs(&pieces, 0.5 * width);
    let mut cells: HashMap<[i64; 2], Vec<usize>> = HashMap::new();
    let cell = |p: Point| [(p.x / width).floor() as i64, (p.y / width).floor() as i64];
    for (k, run) in runs.iter().enumerate() {
        for_each_cell(cell(run.low), cell(run.high), |c| cells.entry(c).or_default().push(k));
    }
    let reach = Vector::new(width, width);
    for (k, run) in runs.iter().enumerate() {
        let mut near = BTreeSet::new();
        for_each_cell(cell(run.low - reach), cell(run.high + reach), |c| {
            near.extend(cells.get(&c).into_iter().flatten().copied().filter(|&other| other > k));
        });
        found.extend(near.into_iter().filter_map(|other| facing(&pieces, run, &runs[other], &lengths, width)));
    }
    narrowest_of_each(found, ONE_PLACE * width)
}

fn perimeter(ring: &[Point]) -> f64 {
    (0..ring.len()).map(|i| (ring[(i + 1) % ring.len()] - ring[i]).norm()).sum()
}

fn for_each_cell(low: [i64; 2], high: [i64; 2], mut action: impl FnMut([i64; 2])) {
    for x in low[0]..=high[0] {
        (low[1]..=high[1]).for_each(|y| action([x, y]));
    }
}

fn pieces(region: &Region, longest: f64) -> Vec<Piece> {
    let mut pieces = Vec::new();
    for (index, ring) in region.rings().enumerate() {
        let n = ring.len();
        let normal = |i: usize| {
            let edge = ring[(i + 1) % n] - ring[i % n];
            Vector::new(-edge.y, edge.x).try_normalize(0.0).unwrap_or_else(Vector::zeros)
        };
        let mut before = 0.0;
        for i in 0..n {
            let (a, b) = (ring[i], ring[(i + 1) % n]);
            let length = (b - a).norm();
            let count = (length / longest).ceil().max(1.0);
            let own = normal(i);
            let corners = [own + normal(i + n - 1), own + normal(i + 1)];
            for k in 0..count as usize {
                let at = |k: usize| if k as f64 == count { b } else { a + (b - a) * (k as f64 / count) };
                let inward =
                    [if k == 0 { corners[0] } else { own }, if (k + 1) as f64 == count { corners[1] } else { own }];
                let before = before + length * (k as f64 / count);
                pieces.push(Piece { a: at(k), b: at(k + 1), ring: index, before, inward });
            }
            before += length;
        }
    }
    pieces
}

fn runs(pieces: &[Piece], longest: f64) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for (k, piece) in pieces.iter().enumerate() {
        let (low, high) = (piece.a.inf(&piece.b), piece.a.sup(&piece.b));
        let end = piece.before + (piece.b - piece.a).norm();
        match runs.last_mut() {
            Some(run)
                if pieces[run.pieces.start].ring == piece.ring && end - pieces[run.pieces.start].before <= longest =>
            {
                run.pieces.end = k + 1;
                (run.low, run.high) = (run.low.inf(&low), run.high.sup(&high));
            }
            _ => runs.push(Run { pieces: k..k + 1, low, high }),
        }
    }
    runs
}

/// Where two runs are nearest, if they face each other there over material or over a gap, nearer than `width`.
fn facing(pieces: &[Piece], one: &Run, other: &Run, lengths: &[f64], width: f64) -> Option<NarrowPlace> {
    let gap = (one.low - other.high).sup(&(other.low - one.high)).sup(&Vector::zeros());
    let (p, q) = (&pieces[one.pieces.start], &pieces[other.pieces.start]);
    let way = |s: f64, t: f64| (s - t).abs().min(lengths[p.ring] - (s - t).abs());
    // Runs are at most one width long.
    let near_along = p.ring == q.ring && way(p.before, q.before) < (FAR_ALONG - 2.0) * width;
    if gap.norm() >= width || near_along {
        return None;
    }
    let mut best: Option<(f64, Place, Place)> = None;
    for v in &pieces[one.pieces.clone()] {
        for w in &pieces[other.pieces.clone()] {
            for (s, t) in [(0.0, None), (1.0, None), (0.0, Some(())), (1.0, Some(()))] {
                // An end of the one and the place on the other nearest to it: edges of sound rings do not cross.
                let (from, on) = if t.is_none() { (v, w) } else { (w, v) };
                let end = if s == 0.0 { from.a } else { from.b };
                let foot = nearest_on_segment(on.a, on.b, end);
                let distance = (foot - end).norm();
                if best.as_ref().is_none_or(|(d, ..)| distance < *d) {
                    best = Some((distance, Place::on(from, end), Place::on(on, foot)));
                }
            }
        }
    }
    let (distance, v, w) = best.filter(|(distance, ..)| *distance < width)?;
    if p.ring == q.ring && way(v.along, w.along) < (FAR_ALONG * width).max(CORNER * distance) {
        return None;
    }
    let across = w.point - v.point;
    let kind = match (v.inward.dot(&across) > 0.0, w.inward.dot(&across) < 0.0) {
        (true, true) => NarrowKind::Neck,
        (false, false) => NarrowKind::Gap,
        // Something else lies between them.
        _ => return None,
    };
    Some(NarrowPlace { kind, place: nalgebra::center(&v.point, &w.point), width: distance })
}

/// A place on a piece.
#[derive(Debug, Clone, Copy)]
struct Place {
    point: Point,
    along: f64,
    inward: Vector,
}

impl Place {
    fn on(piece: &Piece, point: Point) -> Self {
        let inward = match point {
            p if p == piece.a => piece.inward[0],
            p if p == piece.b => piece.inward[1],
            _ => {
                let edge = piece.b - piece.a;
                Vector::new(-edge.y, edge.x)
            }
        };
        Self { point, along: piece.before + (point - piece.a).norm(), inward }
    }
}

fn narrowest_of_each(mut found: Vec<NarrowPlace>, apart: f64) -> Vec<NarrowPlace> {
    found.sort_by(|a, b| a.width.total_cmp(&b.width).then(a.kind.cmp(&b.kind)));
    let mut cells: HashMap<[i64; 2], Vec<usize>> = HashMap::new();
    let cell = |p: Point| [(p.x / apart).floor() as i64, (p.y / apart).floor() as i64];
    let mut kept: Vec<NarrowPlace> = Vec::new();
    for place in found {
        let [x, y] = cell(place.place);
        let mut is_near = false;
        for_each_cell([x - 1, y - 1], [x + 1, y + 1], |c| {
            let same = |&k: &usize| kept[k].kind == place.kind && (kept[k].place - place.place).norm() < apart;
            is_near |= cells.get(&c).into_iter().flatten().any(same);
        });
        if !is_near {
            cells.entry([x, y]).or_default().push(kept.len());
            kept.push(place);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{circle_ring, oriented};
    use proptest::prelude::*;
    use std::f64::consts::PI;

    fn placed(list: &[(f64, f64)], scale: f64, turn: f64, mirrored: bool, shift: (f64, f64)) -> Vec<Point> {
        let rotation = nalgebra::Rotation2::new(turn);
        let place = |&(x, y): &(f64, f64)| {
            rotation * Point::new(scale * if mirrored { -x } else { x }, scale * y) + Vector::new(shift.0, shift.1)
        };
        oriented(list.iter().map(place).collect(), true)
    }

    /// A dumbbell: two plates joined by a bridge of the given width and length; of length 0 by a place between two
    /// notches.
    fn dumbbell(width: f64, length: f64) -> Vec<(f64, f64)> {
        let (w, l) = (0.5 * width, 0.5 * length);
        if length > 0.0 {
            vec![
                (-10.0, -6.0),
                (-l, -6.0),
                (-l, -w),
                (l, -w),
                (l, -6.0),
                (10.0, -6.0),
                (10.0, 6.0),
                (l, 6.0),
                (l, w),
                (-l, w),
                (-l, 6.0),
                (-10.0, 6.0),
            ]
        } else {
            vec![
                (-10.0, -6.0),
                (-3.0, -6.0),
                (0.0, -w),
                (4.0, -6.0),
                (10.0, -6.0),
                (10.0, 6.0),
                (3.0, 6.0),
                (0.0, w),
                (-4.0, 6.0),
                (-10.0, 6.0),
            ]
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]
        /// Truth: the construction. The neck of a dumbbell is found with its width and place when it is narrower than
        /// what is looked for, at any turn, size and place, and nothing is found when it is wider.
        #[test]
        fn the_neck_of_a_dumbbell_is_found(width in 0.01_f64..2.0, length in prop_oneof![Just(0.0), 1.5_f64..6.0], scale in -6.0_f64..6.0,
                                           turn in -PI..PI, mirrored in any::<bool>(), x in -5.0_f64..5.0) {
            let scale = 10.0_f64.powf(scale);
            let exterior = placed(&dumbbell(width, length), scale, turn, mirrored, (x * scale, 0.0));
            let region = Region { exterior, holes: Vec::new() };
            prop_assert!((width - 1.0).abs() > 1e-9);
            let found = narrow_places(&region, scale);
            if width > 1.0 {
                prop_assert!(found.is_empty(), "{:?}", found);
            } else {
                prop_assert!(!found.is_empty());
                for place in &found {
                    prop_assert_eq!(place.kind, NarrowKind::Neck);
                    prop_assert!((place.width / scale - width).abs() < 1e-6, "{:?}", place);
                    prop_assert!((place.place - Point::new(x * scale, 0.0)).norm() <= (0.5 * length + 1e-6) * scale);
                }
            }
            // Turned inside out it is a gap between two holes: what is left of a frame.
            let frame = placed(&[(-20.0, -20.0), (20.0, -20.0), (20.0, 20.0), (-20.0, 20.0)], scale, turn, mirrored, (x * scale, 0.0));
            let hole = oriented(region.exterior.clone(), false);
            let found = narrow_places(&Region { exterior: frame, holes: vec![hole] }, scale);
            prop_assert_eq!(found.first().map(|p| p.kind), (width < 1.0).then_some(NarrowKind::Gap));
        }

        /// Truth: ordinary drawings. Stars with corners down to 8°, discs, rings and rough plates have no narrow
        /// places.
        #[test]
        fn corners_are_no_narrow_places(points in 3_usize..14, sharp in 8.0_f64..60.0, turn in -PI..PI, rough in 0.0_f64..0.3, seed in any::<u64>()) {
            let width = 1.0;
            // Spikes of the given angle on a disc.
            let radius = 20.0;
            let half = PI / points as f64 * 0.8;
            let deep = radius * half.sin() / (0.5 * sharp.to_radians()).tan() - radius * (1.0 - half.cos());
            let star: Vec<(f64, f64)> = (0..points).flat_map(|k| {
                let a = 2.0 * PI * k as f64 / points as f64;
                [(a - half, radius), (a, radius + deep), (a + half, radius)].map(|(t, r)| (r * t.cos(), r * t.sin()))
            }).collect();
            let region = Region { exterior: placed(&star, 1.0, turn, false, (0.0, 0.0)), holes: Vec::new() };
            prop_assert!(narrow_places(&region, width).is_empty(), "{:?}", narrow_places(&region, width));
            let mut state = seed | 1;
            let mut random = || { state ^= state << 13; state ^= state >> 7; state ^= state << 17; (state >> 11) as f64 / (1_u64 << 53) as f64 };
            let coarse = circle_ring(Point::origin(), radius, 0.001);
            let rough: Vec<Point> = coarse.iter().map(|p| p * (1.0 + rough * (random() - 0.5) / radius)).collect();
            let hole = oriented(circle_ring(Point::new(3.0, 0.0), 15.0, 0.01), false);
            let region = Region { exterior: rough, holes: vec![hole] };
            prop_assert!(narrow_places(&region, width).is_empty());
        }
    }

    /// Truth: brute force over all pairs of sampled places of the outline, for ligaments between holes at random
    /// places.
    #[test]
    fn the_narrowest_ligament_is_that_of_all_pairs() {
        let mut state = 88172645463325252_u64;
        let mut random = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let exterior =
            placed(&[(-20.0, -20.0), (20.0, -20.0), (20.0, 20.0), (-20.0, 20.0)], 1.0, 0.3, false, (0.0, 0.0));
        for _ in 0..40 {
            let mut discs: Vec<(Point, f64)> = Vec::new();
            while discs.len() < 5 {
                let (center, radius) =
                    (Point::new(22.0 * random() - 11.0, 22.0 * random() - 11.0), 1.5 + 2.5 * random());
                if discs.iter().all(|(c, r)| (c - center).norm() > r + radius + 0.05) {
                    discs.push((center, radius));
                }
            }
            let holes = discs.iter().map(|&(c, r)| oriented(circle_ring(c, r, 1e-3), false)).collect();
            let region = Region { exterior: exterior.clone(), holes };
            let rings: Vec<&[Point]> = region.rings().collect();
            let mut truth = f64::INFINITY;
            for (i, ring) in rings.iter().enumerate() {
                for other in rings.iter().take(i) {
                    for p in ring.iter() {
                        for k in 0..other.len() {
                            truth =
                                truth.min((nearest_on_segment(other[k], other[(k + 1) % other.len()], *p) - p).norm());
                        }
                    }
                }
            }
            let found = narrow_places(&region, 1.0).first().map(|p| p.width);
            assert_eq!(found.is_some(), truth < 1.0, "{truth}");
            assert!(found.is_none_or(|width| (width - truth).abs() < 2e-3), "{found:?} {truth}");
        }
    }

    #[test]
    fn small_holes_and_thin_tails_are_found_fast() {
        let tiny = oriented(circle_ring(Point::new(1.0, 2.0), 0.3, 1e-3), false);
        // A disc of 100,000 corners with a tail that ends 0.4 wide after 20.
        let mut exterior: Vec<Point> = (0..100_000)
            .map(|k| 0.02 + (2.0 * PI - 0.04) * f64::from(k) / 99_999.0)
            .map(|t| Point::new(20.0 * t.cos(), 20.0 * t.sin()))
            .collect();
        exterior.extend([Point::new(40.0, -0.2), Point::new(40.0, 0.2)]);
        // The work of this thread, not the time of the clock, which depends on what else the machine does.
        let work = || rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime).tv_sec;
        let start = work();
        let found = narrow_places(&Region { exterior, holes: vec![tiny] }, 1.0);
        assert!(work() - start < 5, "{} s", work() - start);
        assert!(found.iter().any(|p| p.kind == NarrowKind::Hole && (p.place - Point::new(1.0, 2.0)).norm() < 1e-6));
        assert!(found.iter().any(|p| p.kind == NarrowKind::Neck && p.width < 0.5), "{found:?}");
    }
}
