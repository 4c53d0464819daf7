//! Chords of drawn curves: which way the curve runs at the ends of each, so that walls along it can be shaded as it is.

use fissure_plane::{Point, Region, Vector};
use kurbo::{ParamCurve as _, ParamCurveDeriv as _, PathSeg};
use std::collections::HashMap;
use std::f64::consts::PI;

/// A chord that turns by more than this from its curve is of a cusp or a loop, and tells nothing [rad].
const MOST_TURN: f64 = 1.0;
/// What lies this near to a chord is a part of it, in its lengths: more than rounding to the grid of a drawing.
const NEAR: f64 = 1e-6;
/// Steps of Newton's method to where a curve is nearest to a point of its own.
const MOST_STEPS: usize = 8;
/// Half of the way over which a curve that stands still at a point has its direction there, in its parameter.
const STILL: f64 = 1e-3;

/// A chord of a drawn curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Chord {
    /// Where it begins and ends [m].
    pub(crate) ends: [Point; 2],
    /// The angles from it to the curve at both ends, counter-clockwise [rad].
    pub(crate) turns: [f64; 2],
}

impl Chord {
    /// The chords of a circle, drawn as `ring`.
    pub(crate) fn of_circle(ring: &[Point]) -> Vec<Self> {
        let half = PI / ring.len() as f64;
        let ends = |i: usize| [ring[i], ring[(i + 1) % ring.len()]];
        (0..ring.len()).map(|i| Self { ends: ends(i), turns: [-half, half] }).collect()
    }

    /// The chords between `points` of `curve`, from its start to its end.
    pub(crate) fn of_curve(curve: PathSeg, points: &[Point]) -> Vec<Self> {
        let mut left: f64 = points.windows(2).map(|w| (w[1] - w[0]).norm()).sum();
        let last = points.len().saturating_sub(1);
        let mut before = 0.0;
        let mut tangents = Vec::with_capacity(points.len());
        for (i, &point) in points.iter().enumerate() {
            let at = match i {
                0 => 0.0,
                _ if i == last => 1.0,
                _ => {
                    let step = (point - points[i - 1]).norm();
                    let guess = if left > 0.0 { before + (1.0 - before) * step / left } else { before };
                    left -= step;
                    nearest(&curve, point, guess, before)
                }
            };
            before = at;
            tangents.push(tangent(&curve, at));
        }
        let pairs = points.windows(2).zip(tangents.windows(2));
        let chord = |(ends, tangents): (&[Point], &[Vector])| {
            let along = ends[1] - ends[0];
            let turns = [0, 1].map(|k| along.perp(&tangents[k]).atan2(along.dot(&tangents[k])));
            let is_told = turns.iter().all(|turn| turn.abs() <= MOST_TURN);
            is_told.then_some(Self { ends: [ends[0], ends[1]], turns })
        };
        pairs.filter_map(chord).collect()
    }
}

/// The parameter from `least` to 1 where `curve` is nearest to `point`, which is on it but for the flattening.
fn nearest(curve: &PathSeg, point: Point, guess: f64, least: f64) -> f64 {
    let mut at = guess.clamp(least, 1.0);
    for _ in 0..MOST_STEPS {
        let (place, first, second) = derivatives(curve, at);
        let off = place - point;
        let slope = first.norm_squared() + off.dot(&second);
        if slope <= 0.0 {
            break;
        }
        at = (at - off.dot(&first) / slope).clamp(least, 1.0);
    }
    at
}

/// Place, first and second derivative of a curve.
fn derivatives(curve: &PathSeg, at: f64) -> (Point, Vector, Vector) {
    let vector = |p: kurbo::Point| Vector::new(p.x, p.y);
    let place = Point::from(vector(curve.eval(at)));
    match curve {
        PathSeg::Line(line) => (place, vector((line.p1 - line.p0).to_point()), Vector::zeros()),
        PathSeg::Quad(quad) => {
            let first = quad.deriv();
            (place, vector(first.eval(at)), vector((first.p1 - first.p0).to_point()))
        }
        PathSeg::Cubic(cubic) => {
            let first = cubic.deriv();
            (place, vector(first.eval(at)), vector(first.deriv().eval(at)))
        }
    }
}

/// The direction of a curve, of any length.
fn tangent(curve: &PathSeg, at: f64) -> Vector {
    let (_, first, _) = derivatives(curve, at);
    let place = |at: f64| derivatives(curve, at.clamp(0.0, 1.0)).0;
    let near = (place(at + STILL) - place(at - STILL)) / (2.0 * STILL);
    // Where control points fall together the derivative vanishes, or is rounding.
    if first.norm() > STILL * near.norm() { first } else { near }
}

/// For each ring of `region` and each of its edges the angles from it to the curve that it is a chord of, or a part of
/// one, at both ends; zeros where it is a line. Empty where all are lines.
pub(crate) fn turns(region: &Region, chords: &[Chord]) -> Vec<Vec<[f64; 2]>> {
    let bits = |p: Point| [p.x + 0.0, p.y + 0.0].map(f64::to_bits);
    let mut at = HashMap::<[u64; 2], Vec<usize>>::new();
    for (number, chord) in chords.iter().enumerate() {
        chord.ends.iter().for_each(|&end| at.entry(bits(end)).or_default().push(number));
    }
    let of_edge = |a: Point, b: Point| {
        let mut near = [a, b].into_iter().flat_map(|end| at.get(&bits(end)).into_iter().flatten());
        near.find_map(|&number| part(&chords[number], a, b)).unwrap_or([0.0; 2])
    };
    let of_ring = |ring: &[Point]| (0..ring.len()).map(|i| of_edge(ring[i], ring[(i + 1) % ring.len()])).collect();
    let turns: Vec<Vec<[f64; 2]>> = region.rings().map(of_ring).collect();
    if turns.iter().flatten().all(|turn| *turn == [0.0; 2]) { Vec::new() } else { turns }
}

/// The angles from the edge from `a` to `b` to the curve, if the edge is a part of the chord, which may run against it.
fn part(chord: &Chord, a: Point, b: Point) -> Option<[f64; 2]> {
    let along = chord.ends[1] - chord.ends[0];
    let square = along.norm_squared();
    let is_near = |p: Point| along.perp(&(p - chord.ends[0])).abs() <= NEAR * square;
    let share = |p: Point| along.dot(&(p - chord.ends[0])) / square;
    let shares = [share(a), share(b)];
    let is_within = shares.iter().all(|share| (-NEAR..=1.0 + NEAR).contains(share));
    let turn = |share: f64| chord.turns[0] + share.clamp(0.0, 1.0) * (chord.turns[1] - chord.turns[0]);
    (square > 0.0 && is_within && is_near(a) && is_near(b) && shares[0] != shares[1]).then(|| shares.map(turn))
}

#[cfg(test)]
mod tests {
    use super::*;
    use fissure_plane::circle_ring;
    use kurbo::{CubicBez, PathEl};

    fn flattened(curve: CubicBez, tolerance: f64) -> Vec<Point> {
        let mut points = vec![Point::new(curve.p0.x, curve.p0.y)];
        kurbo::flatten([PathEl::MoveTo(curve.p0), PathEl::CurveTo(curve.p1, curve.p2, curve.p3)], tolerance, |piece| {
            if let PathEl::LineTo(p) = piece {
                points.push(Point::new(p.x, p.y));
            }
        });
        points
    }

    /// The quarter of the unit circle that drawing programs draw: off by 2.7e-4 of its radius.
    fn quarter() -> CubicBez {
        const K: f64 = 0.552_284_749_830_793_6;
        CubicBez::new((1.0, 0.0), (1.0, K), (K, 1.0), (0.0, 1.0))
    }

    /// Truth: the tangent of the circle, within what the cubic differs by (.0722 degrees), however coarse the chords;
    /// parts of chords and edges that run against them say the same of their ends.
    #[test]
    fn chords_tell_the_tangents_of_their_curve() {
        for tolerance in [0.1, 1e-2, 1e-3, 1e-5] {
            let points = flattened(quarter(), tolerance);
            let chords = Chord::of_curve(PathSeg::Cubic(quarter()), &points);
            assert_eq!(chords.len(), points.len() - 1);
            let off = |a: Point, b: Point, turns: [f64; 2]| {
                let along = b - a;
                let one = |p: Point, turn: f64| {
                    let told = nalgebra::Rotation2::new(turn) * along;
                    told.dot(&p.coords).atan2(told.perp(&p.coords).abs()).abs().to_degrees()
                };
                one(a, turns[0]).max(one(b, turns[1]))
            };
            for chord in &chords {
                let [a, b] = chord.ends;
                assert!(off(a, b, chord.turns) < 0.0723, "{tolerance}: {}", off(a, b, chord.turns));
                let [back, forth] = part(chord, b, a).unwrap_or_default();
                assert!((back - chord.turns[1]).abs() < 1e-12 && (forth - chord.turns[0]).abs() < 1e-12);
                let middle = nalgebra::center(&a, &b);
                let half = part(chord, a, middle).unwrap_or_default();
                assert!((half[1] - 0.5 * (chord.turns[0] + chord.turns[1])).abs() < 1e-12);
                assert_eq!(part(chord, a, middle + 0.01 * Vector::new(a.y - b.y, b.x - a.x)), None);
            }
        }
    }

    /// Truth: by hand. Control points that fall together, at one end or both, leave the direction of the others.
    #[test]
    fn curves_that_stand_still_have_a_direction() {
        let straight = CubicBez::new((0.0, 0.0), (0.0, 0.0), (3.0, 3.0), (3.0, 3.0));
        let bent = CubicBez::new((0.0, 0.0), (0.0, 0.0), (1.0, 0.0), (1.0, 1.0));
        assert!(tangent(&PathSeg::Cubic(straight), 0.0).normalize().perp(&Vector::new(1.0, 1.0)).abs() < 1e-9);
        assert!(tangent(&PathSeg::Cubic(bent), 0.0).normalize().y.abs() < 2e-3);
        assert!(tangent(&PathSeg::Cubic(bent), 1.0).normalize().x.abs() < 1e-9);
    }

    /// Truth: by hand. Rings of lines say nothing; a circle in a square says it of the circle alone.
    #[test]
    fn only_curves_have_turns() {
        let corners = [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)];
        let exterior: Vec<Point> = corners.map(|(x, y)| Point::new(x, y)).to_vec();
        let ring = circle_ring(Point::origin(), 1.0, 0.01);
        let chords = Chord::of_circle(&ring);
        let hole: Vec<Point> = ring.iter().rev().copied().collect();
        assert!(turns(&Region { exterior: exterior.clone(), holes: Vec::new() }, &chords).is_empty());
        let turns = turns(&Region { exterior, holes: vec![hole] }, &chords);
        let half = PI / ring.len() as f64;
        assert_eq!(turns, [vec![[0.0; 2]; 4], vec![[half, -half]; ring.len()]]);
    }
}
