//! The pieces of a drawn line that lie in the material of a body.

use fissure_plane::{Point, Region, nearest_on_segment};

/// A piece of a line in the material, from ring to ring or to an end of the line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Piece {
    pub(crate) points: Vec<Point>,
    /// Whether the first and the last point lie on a ring.
    pub(crate) mouths: [bool; 2],
    /// Length of the line before the piece [m].
    pub(crate) from: f64,
}

/// A place where a line meets a ring.
#[derive(Debug, Clone, Copy)]
struct Meeting {
    /// Length of the line before it [m].
    at: f64,
    point: Point,
}

/// The pieces of `line` in the material of `region`, in order. What runs along a ring is outside.
///
/// What comes nearer to a ring than `weld` [m] touches it, so that it does not depend on rounding whether a line
/// touches a corner or runs along an edge. Pieces not longer than `shortest` [m] are left out.
pub(crate) fn pieces_inside(line: &[Point], region: &Region, weld: f64, shortest: f64) -> Vec<Piece> {
    let lengths = lengths_before(line);
    let Some(&whole) = lengths.last() else { return Vec::new() };
    let mut borders = borders(meetings(line, &lengths, region, weld), 2.0 * weld);
    let meets_at = |at: f64, borders: &[[Meeting; 2]]| {
        borders.iter().any(|[first, last]| first.at <= at + 2.0 * weld && last.at >= at - 2.0 * weld)
    };
    // The ends of the line bound pieces too.
    let ends = [(0.0, line[0]), (whole, line[line.len() - 1])].map(|(at, point)| Meeting { at, point });
    let free = ends.map(|end| !meets_at(end.at, &borders));
    if free[0] {
        borders.insert(0, [ends[0]; 2]);
    }
    if free[1] {
        borders.push([ends[1]; 2]);
    }
    let count = borders.len();
    let mut pieces = Vec::new();
    for (i, pair) in borders.windows(2).enumerate() {
        let (start, end) = (pair[0][1], pair[1][0]);
        let middle = place_at(line, &lengths, 0.5 * (start.at + end.at));
        let on_ring = region.nearest(middle).is_some_and(|place| place.distance <= weld);
        if end.at - start.at <= shortest || on_ring || !region.contains(middle) {
            continue;
        }
        let inner = (0..line.len()).filter(|&k| lengths[k] > start.at + weld && lengths[k] < end.at - weld);
        let mut points = vec![start.point];
        points.extend(inner.map(|k| line[k]));
        points.push(end.point);
        let mouths = [!(free[0] && i == 0), !(free[1] && i + 2 == count)];
        pieces.push(Piece { points, mouths, from: start.at });
    }
    pieces
}

/// Length of a line before each of its points [m].
fn lengths_before(line: &[Point]) -> Vec<f64> {
    let mut sum = 0.0;
    let mut lengths = Vec::with_capacity(line.len());
    for (k, &p) in line.iter().enumerate() {
        if k > 0 {
            sum += (p - line[k - 1]).norm();
        }
        lengths.push(sum);
    }
    lengths
}

/// The place on a line with the length `at` before it.
fn place_at(line: &[Point], lengths: &[f64], at: f64) -> Point {
    let next = lengths.partition_point(|&l| l <= at).clamp(1, line.len() - 1);
    let (a, b) = (line[next - 1], line[next]);
    let t = (at - lengths[next - 1]) / (lengths[next] - lengths[next - 1]);
    a + (b - a) * t.clamp(0.0, 1.0)
}

/// Where a line crosses or touches the rings, in order.
fn meetings(line: &[Point], lengths: &[f64], region: &Region, weld: f64) -> Vec<Meeting> {
    let mut found = Vec::new();
    for (k, piece) in line.windows(2).enumerate() {
        let (p, q) = (piece[0], piece[1]);
        let (low, high) = (p.inf(&q), p.sup(&q));
        for ring in region.rings() {
            for i in 0..ring.len() {
                let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
                if (a.inf(&b) - high).max() > weld || (low - a.sup(&b)).max() > weld {
                    continue;
                }
                let mut add = |point: Point| {
                    let along = (nearest_on_segment(p, q, point) - p).norm();
                    found.push(Meeting { at: lengths[k] + along, point });
                };
                let (d, g, u) = (q - p, b - a, a - p);
                let determinant = d.x * g.y - d.y * g.x;
                let (t, s) = ((u.x * g.y - u.y * g.x) / determinant, (u.x * d.y - u.y * d.x) / determinant);
                // Of two that are nearly parallel the quotients are rounding; their ends tell where they touch.
                let point = a + g * s;
                let meets = (0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&s);
                if meets && (nearest_on_segment(p, q, point) - point).norm() <= weld.max(1e-12 * d.norm()) {
                    add(point);
                }
                if (nearest_on_segment(p, q, a) - a).norm() <= weld {
                    add(a);
                }
                for end in [p, q] {
                    let on = nearest_on_segment(a, b, end);
                    if (on - end).norm() <= weld {
                        add(on);
                    }
                }
            }
        }
    }
    found.sort_by(|m, n| m.at.total_cmp(&n.at));
    found
}

/// Meetings not farther than `gap` [m] from the next are one border: its first and its last.
fn borders(meetings: Vec<Meeting>, gap: f64) -> Vec<[Meeting; 2]> {
    let mut borders: Vec<[Meeting; 2]> = Vec::new();
    for meeting in meetings {
        match borders.last_mut() {
            Some([_, last]) if meeting.at - last.at <= gap => *last = meeting,
            _ => borders.push([meeting; 2]),
        }
    }
    borders
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use fissure_plane::{oriented, polyline_length};
    use proptest::prelude::*;
    use std::f64::consts::PI;

    pub(crate) const WELD: f64 = 1e-5;
    pub(crate) const SHORTEST: f64 = 1e-2;

    /// A plate of 8 x 6 m with a square hole, a slanted one, a triangle and a notch in its right side.
    fn plate() -> Vec<Vec<(f64, f64)>> {
        vec![
            vec![(-4.0, -3.0), (4.0, -3.0), (4.0, -1.0), (3.0, 0.0), (4.0, 1.0), (4.0, 3.0), (-4.0, 3.0)],
            vec![(-3.0, -1.0), (-1.0, -1.0), (-1.0, 1.0), (-3.0, 1.0)],
            vec![(1.0, -1.0), (2.0, 0.0), (1.0, 1.0), (0.0, 0.0)],
            vec![(-2.0, 2.0), (0.0, 1.5), (0.0, 2.5)],
        ]
    }

    pub(crate) fn placed(list: &[(f64, f64)], angle: f64, mirrored: bool) -> Vec<Point> {
        let turn = nalgebra::Rotation2::new(angle);
        list.iter().map(|&(x, y)| turn * Point::new(if mirrored { -x } else { x }, y)).collect()
    }

    pub(crate) fn region(angle: f64, mirrored: bool) -> Region {
        let mut rings = plate().into_iter().enumerate().map(|(k, r)| oriented(placed(&r, angle, mirrored), k == 0));
        Region { exterior: rings.next().unwrap_or_default(), holes: rings.collect() }
    }

    /// Any place, and often one of those that matter: corners, and places on edges and beside corners.
    pub(crate) fn place() -> impl Strategy<Value = (f64, f64)> {
        let rings = plate();
        let corners: Vec<(f64, f64)> = rings.iter().flatten().copied().collect();
        let middles = rings.iter().flat_map(|r| {
            (0..r.len()).map(|i| (0.5 * (r[i].0 + r[(i + 1) % r.len()].0), 0.5 * (r[i].1 + r[(i + 1) % r.len()].1)))
        });
        let special: Vec<(f64, f64)> = corners.iter().copied().chain(middles).collect();
        prop_oneof![
            (-5.0_f64..5.0, -4.0_f64..4.0),
            prop::sample::select(special.clone()),
            // Level with a corner: lines along edges, through corners and tangent to holes.
            (prop::sample::select(special), -5.0_f64..5.0, any::<bool>()).prop_map(|((x, y), other, level)| if level {
                (other, y)
            } else {
                (x, other)
            }),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        /// Truth: brute force. The pieces are as long as the part of the line whose sampled places lie inside and off
        /// the rings, their middles lie inside, and every end that is no end of the line lies on a ring.
        #[test]
        fn pieces_are_what_lies_inside(line in prop::collection::vec(place(), 2..5), angle in prop_oneof![Just(0.0), Just(PI / 2.0), -PI..PI],
                                       mirrored in any::<bool>(), backwards in any::<bool>()) {
            let region = region(angle, mirrored);
            let mut line = placed(&line, angle, mirrored);
            if backwards { line.reverse(); }
            prop_assume!(line.windows(2).all(|w| (w[1] - w[0]).norm() > 2.0 * SHORTEST));
            let pieces = pieces_inside(&line, &region, WELD, SHORTEST);
            // Stretches of sampled places inside.
            let corners: Vec<Point> = region.rings().flatten().copied().collect();
            let (mut stretches, mut step, mut faint) = (vec![0.0], 0.0_f64, 0.0_f64);
            for w in line.windows(2) {
                let sample = (w[1] - w[0]) / 4000.0;
                step = step.max(sample.norm());
                for k in 0..4000 {
                    let p = w[0] + sample * (f64::from(k) + 0.5);
                    let off = region.nearest(p).map_or(0.0, |place| place.distance);
                    let inside = region.contains(p) && off > 1e-9;
                    if inside && off <= WELD {
                        faint += sample.norm();
                    }
                    // A corner that the line only touches parts it, though no sample lies on it.
                    let (from, to) = (p - sample * 0.5, p + sample * 0.5);
                    if corners.iter().any(|&c| (nearest_on_segment(from, to, c) - c).norm() <= WELD) {
                        stretches.push(0.0);
                    }
                    match stretches.last_mut() {
                        Some(last) if inside => *last += sample.norm(),
                        Some(last) if *last > 0.0 => stretches.push(0.0),
                        _ => {}
                    }
                }
            }
            let truth: f64 = stretches.iter().sum();
            let short = stretches.iter().filter(|&&l| l > 0.0 && l < 2.0 * SHORTEST).sum::<f64>();
            let found: f64 = pieces.iter().map(|p| polyline_length(&p.points)).sum();
            // What may be left out, what is so near to a ring that it may count as on it, and a sample at each border.
            let allowed = short + faint + step * (stretches.len() + 1) as f64;
            prop_assert!((found - truth).abs() <= allowed, "{} instead of {}", found, truth);
            for piece in &pieces {
                for (end, point) in [piece.points[0], piece.points[piece.points.len() - 1]].into_iter().enumerate() {
                    let off = region.nearest(point).map_or(f64::INFINITY, |place| place.distance);
                    prop_assert_eq!(piece.mouths[end], off <= 2.0 * WELD, "{}", point);
                }
                for w in piece.points.windows(2) {
                    prop_assert!(region.contains(nalgebra::center(&w[0], &w[1])));
                }
            }
            // The same line read backwards has the same pieces.
            let mut reverse = line.clone();
            reverse.reverse();
            let count = pieces_inside(&reverse, &region, WELD, SHORTEST).len();
            prop_assert_eq!(count, pieces.len());
        }
    }
}
