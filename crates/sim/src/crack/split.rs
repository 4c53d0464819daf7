//! How a crack splits the square that a particle stands for.

use fissure_plane::{Point, Vector, distance_to_segment, orientation, segments_touch};

/// What lies on both sides of a crack of the square of a particle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Split {
    /// Share of the side that the particle stands on [–].
    pub(crate) share: f64,
    /// From the particle to the centre of what is on its side [m].
    pub(crate) near: Vector,
    /// From the particle to the centre of what is on the other side [m].
    pub(crate) far: Vector,
}

/// Lengths as parts of a square below this are round-off.
const ROUND_OFF: f64 = 1e-9;
/// What is smaller, as a part of a square, counts to the other side: a sliver in the corner of a cell sees the node
/// across the cell without any slope, so that nothing would hold the field there.
const LEAST_SHARE: f64 = 1e-2;

impl Split {
    /// Of the square around `center`, `half` [m] to each side, by those `segments` of one crack that run through it,
    /// all from its start to its end. None where there are none, where the crack ends inside, or where the way to the
    /// middle of a part leads through the crack. A particle on the line is on its left.
    pub(crate) fn of_square(center: Point, half: f64, segments: &[(Point, Point)]) -> Option<Self> {
        // Green's theorem about all that lies left of the crack: along the crack forwards, along the edge of the square
        // from where the crack leaves it counter-clockwise to where it comes in.
        let mut left = Moments::default();
        let mut crossings = Vec::with_capacity(2);
        for &(a, b) in segments {
            let [low, high] = within(center, half, (a, b))?;
            let at = |s: f64| a - center + (b - a) * s;
            left.add(at(low), at(high));
            let is_inside = |p: Point| (p - center).amax() < half * (1.0 - ROUND_OFF);
            let has_before = low == 0.0 && segments.iter().any(|before| before.1 == a);
            let has_after = high == 1.0 && segments.iter().any(|after| after.0 == b);
            if !has_before && is_inside(a) || !has_after && is_inside(b) {
                return None;
            }
            if !has_before {
                crossings.push((round(at(low) / half), Crossing::In));
            }
            if !has_after {
                crossings.push((round(at(high) / half), Crossing::Out));
            }
        }
        crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (k, &(from, crossing)) in crossings.iter().enumerate() {
            let (to, next) = crossings[(k + 1) % crossings.len()];
            match (crossing, next) {
                (Crossing::Out, Crossing::In) => left.add_edge(from, to, half),
                (Crossing::In, Crossing::Out) => {}
                _ => return None,
            }
        }
        let whole = 4.0 * half * half;
        let share = left.area / whole;
        if !(LEAST_SHARE..=1.0 - LEAST_SHARE).contains(&share) {
            return None;
        }
        let (left, right) = (left.first / left.area, -left.first / (whole - left.area));
        let is_left = is_left_of(segments, center);
        let (share, near, far) = if is_left { (share, left, right) } else { (1.0 - share, right, left) };
        let is_own = |p: Point| is_left_of(segments, p) == is_left;
        let is_in_sight = segments.iter().all(|&(a, b)| !segments_touch(center, center + near, a, b))
            || segments
                .iter()
                .any(|&(a, b)| orientation(a, b, center) == 0.0 && (center - a).dot(&(center - b)) <= 0.0);
        (is_in_sight && is_own(center + near) && !is_own(center + far)).then_some(Self { share, near, far })
    }
}

/// Where a crack crosses the edge of a square.
#[derive(Debug, Clone, Copy)]
enum Crossing {
    In,
    Out,
}

/// Area and first moment of a region about the origin.
#[derive(Debug, Default)]
struct Moments {
    area: f64,
    first: Vector,
}

impl Moments {
    /// Adds a piece of the border, the region on its left.
    fn add(&mut self, a: Vector, b: Vector) {
        let twice = a.perp(&b);
        self.area += 0.5 * twice;
        self.first += (a + b) * (twice / 6.0);
    }

    /// Adds the edge of a square counter-clockwise, `from` and `to` as [`round`] says.
    fn add_edge(&mut self, from: f64, to: f64, half: f64) {
        let to = if to > from { to } else { to + 8.0 };
        let mut at = from;
        while at < to {
            let corner = 2.0 * (0.5 * at).floor() + 2.0;
            let next = corner.min(to);
            self.add(on_edge(at) * half, on_edge(next) * half);
            at = next;
        }
    }
}

/// How far round the edge of the square of half size 1 a point of it is, counter-clockwise from the corner (−1, −1): 2
/// at the next corner, below 8.
fn round(p: Vector) -> f64 {
    let along = if p.x.abs() > p.y.abs() {
        if p.x > 0.0 { 3.0 + p.y } else { 7.0 - p.y }
    } else if p.y > 0.0 {
        5.0 - p.x
    } else {
        1.0 + p.x
    };
    along.rem_euclid(8.0)
}

/// The point that is so far round.
fn on_edge(round: f64) -> Vector {
    let round = round.rem_euclid(8.0);
    let along = round % 2.0 - 1.0;
    match round {
        ..2.0 => Vector::new(along, -1.0),
        ..4.0 => Vector::new(1.0, along),
        ..6.0 => Vector::new(-along, 1.0),
        _ => Vector::new(-1.0, -along),
    }
}

/// Whether a point is on the left of a crack or on it: of its nearest segment, or where that is a corner, of both or of
/// either, as the crack turns left or right there.
fn is_left_of(segments: &[(Point, Point)], p: Point) -> bool {
    let is_left = |&(a, b): &(Point, Point)| orientation(a, b, p) >= 0.0;
    let distance = |&(a, b): &(Point, Point)| distance_to_segment(p, a, b);
    let Some(nearest) = segments.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))) else { return true };
    let (a, b) = *nearest;
    let along = (p - a).dot(&(b - a));
    let other = if along <= 0.0 {
        segments.iter().find(|before| before.1 == a).map(|before| (before, orientation(before.0, a, b)))
    } else if along >= (b - a).norm_squared() {
        segments.iter().find(|after| after.0 == b).map(|after| (after, orientation(a, b, after.1)))
    } else {
        None
    };
    match other {
        Some((other, turn)) if turn > 0.0 => is_left(nearest) && is_left(other),
        Some((other, _)) => is_left(nearest) || is_left(other),
        None => is_left(nearest),
    }
}

/// Whether a segment has a length within the square around `center`, `half` [m] to each side, and not only on its edge.
pub(crate) fn runs_through(center: Point, half: f64, segment: (Point, Point)) -> bool {
    within(center, half * (1.0 - ROUND_OFF), segment).is_some()
}

/// The part of a segment within the square around `center`, `half` [m] to each side, 0 to 1 along it, if it has a
/// length (Liang & Barsky 1984).
fn within(center: Point, half: f64, (a, b): (Point, Point)) -> Option<[f64; 2]> {
    let (mut low, mut high) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let (from, way) = (a[axis] - center[axis], b[axis] - a[axis]);
        if way == 0.0 {
            if from.abs() >= half * (1.0 - ROUND_OFF) {
                return None;
            }
            continue;
        }
        let (s, t) = ((-half - from) / way, (half - from) / way);
        low = low.max(s.min(t));
        high = high.min(s.max(t));
    }
    ((high - low) * (b - a).amax() > ROUND_OFF * half).then_some([low, high])
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;

    /// A chain that turns by up to .7 rad at each of its vertices, to one side or to and fro, around the origin.
    fn any_chain() -> impl Strategy<Value = Vec<(Point, Point)>> {
        let turns = prop::collection::vec((0.05_f64..0.7, 0.0_f64..1.0, any::<bool>()), 0..4);
        (turns, -0.9_f64..0.9, -0.9_f64..0.9, 0.0_f64..std::f64::consts::TAU).prop_map(|(turns, x, y, mut angle)| {
            let ahead = |angle: f64| Vector::new(angle.cos(), angle.sin());
            let mut at = Point::new(x, y);
            let mut points = vec![at - ahead(angle) * 4.0, at];
            for (turn, length, left) in turns {
                angle += if left { turn } else { -turn };
                at += ahead(angle) * length;
                points.push(at);
            }
            points.push(at + ahead(angle) * 4.0);
            points.windows(2).map(|w| (w[0], w[1])).filter(|&s| runs_through(Point::origin(), 1.0, s)).collect()
        })
    }

    proptest! {
        /// Truth: brute force. A sample of the square is on the side of the particle if the way to it crosses the crack
        /// an even number of times.
        #[test]
        fn both_parts_are_where_samples_find_them(chain in any_chain(), shift in (-0.9_f64..0.9, -0.9_f64..0.9)) {
            // The same chain seen from a square elsewhere.
            let (center, half) = (Point::new(shift.0, shift.1), 0.8);
            let through: Vec<_> = chain.iter().copied().filter(|&s| runs_through(center, half, s)).collect();
            let Some(split) = Split::of_square(center, half, &through) else { return Ok(()) };
            let crosses = |p: Point, &(a, b): &(Point, Point)| {
                orientation(a, b, p) * orientation(a, b, center) < 0.0
                    && orientation(p, center, a) * orientation(p, center, b) < 0.0
            };
            let (mut near, mut far) = ((0.0, Vector::zeros()), (0.0, Vector::zeros()));
            let samples = 150;
            for (i, j) in (0..samples).flat_map(|i| (0..samples).map(move |j| (i, j))) {
                let along = |k: i32| half * ((2.0 * f64::from(k) + 1.0) / f64::from(samples) - 1.0);
                let arm = Vector::new(along(i), along(j));
                let crossings = chain.iter().filter(|segment| crosses(center + arm, segment)).count();
                let side = if crossings % 2 == 0 { &mut near } else { &mut far };
                side.0 += 1.0;
                side.1 += arm;
            }
            let total = f64::from(samples * samples);
            prop_assert!((split.share - near.0 / total).abs() < 0.01, "{split:?}: {}", near.0 / total);
            for (arm, (count, sum)) in [(split.near, near), (split.far, far)] {
                // A narrow part has few samples.
                if count > 0.01 * total {
                    prop_assert!((arm - sum / count).norm() < 0.02, "{split:?}: {}", sum / count);
                }
            }
        }
    }

    /// Truth: the areas of the parts. A straight crack at a third of the height, seen from both of its ends.
    #[test]
    fn a_straight_crack_leaves_a_third_and_two_thirds() {
        let (a, b) = (Point::new(-5.0, -1.0 / 3.0), Point::new(5.0, -1.0 / 3.0));
        for segment in [(a, b), (b, a)] {
            let split = Split::of_square(Point::origin(), 1.0, &[segment]).unwrap();
            assert!((split.share - 2.0 / 3.0).abs() < 1e-15);
            assert!((split.near - Vector::new(0.0, 1.0 / 3.0)).norm() < 1e-15);
            assert!((split.far - Vector::new(0.0, -2.0 / 3.0)).norm() < 1e-15);
        }
    }

    /// Truth: the drawing. A crack makes an S of three arms around the particle, which is in the highest; the middle of
    /// the S is in the arm below, on the same side of the crack, but the way there leads through the crack twice.
    #[test]
    fn a_part_whose_middle_is_out_of_sight_is_not_taken() {
        let around = [
            (-1.5, 0.15),
            (0.9, 0.15),
            (0.9, -0.55),
            (-0.6, -0.55),
            (-0.6, -0.65),
            (1.5, -0.65),
            (1.5, -0.95),
            (-0.9, -0.95),
            (-0.9, -0.25),
            (0.6, -0.25),
            (0.6, -0.15),
            (-1.5, -0.15),
        ]
        .map(|(x, y)| Point::new(x, y));
        let center = Point::origin();
        let segments: Vec<_> =
            around.windows(2).map(|w| (w[0], w[1])).filter(|&segment| runs_through(center, 1.0, segment)).collect();
        assert_eq!(is_left_of(&segments, center), is_left_of(&segments, Point::new(0.0, -0.4)));
        assert_eq!(Split::of_square(center, 1.0, &segments), None);
    }
}
