//! The edge that a vertex comes to, the gap between them and the normal.

use super::neighbours::{MATCHED, Neighbour};
use super::surface::{Surface, looks};
use fissure_plane::{Point, Vector};

/// A vertex that passes the end of an edge by less than this part of it is still above it: the corners of two things
/// that lie on each other may lie on each other as well.
const PAST_END: f64 = 1e-3;

/// On a round surface the place where the normal points at a vertex may lie beyond the end of the nearest edge by this
/// part of it.
const PAST_ROUND_END: f64 = 0.25;

/// Rounds of Newton's iteration for that place: the equation is nearly linear.
const NEWTON_ROUNDS: usize = 4;

/// Gaps wider than this, in cells, are not looked at; nor is what lies deeper than this within an edge, which is on the
/// other side of a thin part.
pub(super) const WIDEST: f64 = 1.0;

/// A vertex beside an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Meeting {
    /// The ends of the edge.
    pub(crate) ends: [u32; 2],
    /// Where on the edge: 0 at its first end, 1 at the other.
    pub(crate) along: f64,
    /// Distance along the normal, negative where the vertex is inside [m].
    pub(crate) gap: f64,
    /// Unit normal, out of the edge.
    pub(crate) normal: Vector,
}

/// What a vertex meets: the nearest of the edges near it, when that is one it can touch.
///
/// The normal goes on from edge to edge where the surface is round, so that a vertex that slides over it is not kicked;
/// around a corner it points to the vertex.
pub(crate) fn meeting(
    surface: &Surface,
    place: &[Point],
    vertex: u32,
    near: &[Neighbour],
    cell_size: f64,
) -> Option<Meeting> {
    let x = place[vertex as usize];
    let own_normals = surface.normals_around(vertex, place);
    let mut nearest = ((WIDEST * cell_size).powi(2), None);
    for neighbour in near {
        let Some(next) = surface.next(neighbour.edge) else { continue };
        let (a, b) = (place[neighbour.edge as usize], place[next as usize]);
        let beside = (x - a).dot(&(b - a)) / (b - a).norm_squared();
        let along = beside.clamp(0.0, 1.0);
        let away = x - (a + (b - a) * along);
        let distance_squared = away.norm_squared();
        // Most are farther than one before, or too far to be met at all.
        if distance_squared >= nearest.0 {
            continue;
        }
        let Some(flat) = surface.edge_normal(neighbour.edge, place) else { continue };
        let is_beyond = !(-PAST_END..=1.0 + PAST_END).contains(&beside);
        let end = if beside < 0.5 { neighbour.edge } else { next };
        if is_beyond && !surface.faces(end, x, place) {
            continue;
        }
        // Where flat sides lie on each other, a vertex of one that is just beyond the corner of the other is beside it.
        let out = if is_beyond && away.dot(&flat) >= 0.0 { away.try_normalize(0.0).unwrap_or(flat) } else { flat };
        if looks(own_normals, -out) {
            nearest = (distance_squared, Some((neighbour, next, flat, along, is_beyond)));
        }
    }
    let (neighbour, next, flat, along, is_beyond) = nearest.1?;
    let ends = [neighbour.edge, next];
    if !neighbour.can_touch || were_within(surface, vertex, ends, along, MATCHED * cell_size) {
        return None;
    }
    let at_ends = ends.map(|end| surface.round_normal(end, place));
    let away = x - (place[ends[0] as usize] + (place[ends[1] as usize] - place[ends[0] as usize]) * along);
    let end = usize::from(along >= 0.5);
    let normal = match at_ends[end] {
        None if is_beyond => around_corner(away, surface.normal(ends[end], place)?, cell_size),
        _ => {
            let normals = at_ends.map(|normal| normal.unwrap_or(flat));
            return on_round(ends, normals, place, x, along);
        }
    };
    Some(Meeting { ends, along, gap: away.dot(&normal), normal })
}

/// Whether a vertex and the place `along` an edge lie on two pieces of one body, and within `distance` [m] of each
/// other at rest.
pub(crate) fn were_within(surface: &Surface, vertex: u32, ends: [u32; 2], along: f64, distance: f64) -> bool {
    let [own, from, to] = [vertex, ends[0], ends[1]].map(|v| surface.vertex(v));
    let away = from.rest + (to.rest - from.rest) * along - own.rest;
    own.body == from.body && own.piece != from.piece && away.norm_squared() < distance.powi(2)
}

/// The meeting of `x` with a round surface: the curve through the ends of an edge that has their `normals`, beside
/// `along`, where the edge is nearest.
///
/// In the frame of the edge, in lengths of it, the curve is (t, y(t)) with Hermite's cubic y, zero at its ends
/// and has the slopes that the normals ask for. The foot of `x` is where its tangent is across the way to `x`; the gap
/// is the distance from there. So the normal is the gradient of the gap; with another one, vertices would sink in as
/// they slide and pay nothing, and come out with work.
fn on_round(ends: [u32; 2], normals: [Vector; 2], place: &[Point], x: Point, along: f64) -> Option<Meeting> {
    let [a, b] = ends.map(|end| place[end as usize]);
    let length = (b - a).norm();
    let tangent = (b - a) / length;
    let flat = Vector::new(tangent.y, -tangent.x);
    let at = Vector::new((x - a).dot(&tangent), (x - a).dot(&flat)) / length;
    let [first, last] = normals.map(|normal| -normal.dot(&tangent) / normal.dot(&flat));
    let height = |t: f64| first * t * (1.0 - t).powi(2) - last * t.powi(2) * (1.0 - t);
    let slope = |t: f64| first * (1.0 - t) * (1.0 - 3.0 * t) - last * t * (2.0 - 3.0 * t);
    let bend = |t: f64| first * (6.0 * t - 4.0) + last * (6.0 * t - 2.0);
    let mut t = along;
    for _ in 0..NEWTON_ROUNDS {
        let off = at.y - height(t);
        let step = (at.x - t + off * slope(t)) / (off * bend(t) - 1.0 - slope(t).powi(2));
        // Off the edge by so much the next one goes on much the same.
        t = if step.is_finite() { (t - step).clamp(-PAST_ROUND_END, 1.0 + PAST_ROUND_END) } else { t };
    }
    let normal = (flat - tangent * slope(t)).try_normalize(0.0)?;
    let gap = (x - (a + (tangent * t + flat * height(t)) * length)).dot(&normal);
    // Both impulses on one line, so that angular momentum stays.
    let along = at.x + at.y * slope(t);
    Some(Meeting { ends, along, gap, normal })
}

/// The normal of a corner towards what is `away` from it.
fn around_corner(away: Vector, corner: Vector, cell_size: f64) -> Vector {
    let outside = away.dot(&corner) > 0.0;
    away.try_normalize(1e-9 * cell_size).filter(|_| outside).unwrap_or(corner)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::neighbours::{MOST_MOVED, Neighbours, Scenery};
    use super::*;

    /// A ring of points as a body of its own.
    fn add_ring(surface: &mut Surface, body: u32, points: &[Point]) {
        let first = surface.len() as u32;
        let count = points.len() as u32;
        points.iter().for_each(|&p| {
            surface.push(p, body, 0, false);
        });
        (0..count).for_each(|k| surface.link(first + k, first + (k + 1) % count));
    }

    /// What may touch before the next look.
    fn due(surface: &Surface, place: &[Point], cell_size: f64) -> Neighbours {
        let scenery = Scenery { surface, place, cell_size, most_moved: MOST_MOVED, cracks_touch: true };
        let mut found = Neighbours::find(&scenery);
        // Everything may have come as near as it may.
        let apart = |v: u32| Vector::new(f64::from(v % 2) * MOST_MOVED * cell_size, 0.0);
        found.foresee(&scenery, &(0..surface.len() as u32).map(apart).collect::<Vec<_>>(), 1.0);
        found.choose(&scenery);
        found
    }

    fn regular(center: Point, radius: f64, count: usize, turn: f64) -> Vec<Point> {
        let at = |k: usize| turn + std::f64::consts::TAU * k as f64 / count as f64;
        (0..count).map(|k| center + Vector::new(at(k).cos(), at(k).sin()) * radius).collect()
    }

    /// Truth: the drawing. Two circles 0.1 apart, in any direction: the least gap is that, along the line of centres,
    /// and what is on the far sides meets nothing.
    #[test]
    fn circles_meet_along_the_line_of_their_centres() {
        for k in 0..24 {
            let turn = 0.1 + 0.27 * f64::from(k);
            let direction = Vector::new(turn.cos(), turn.sin());
            let mut surface = Surface::default();
            add_ring(&mut surface, 0, &regular(Point::origin(), 3.0, 96, 0.3));
            add_ring(&mut surface, 1, &regular(Point::origin() + direction * 6.1, 3.0, 96, turn));
            let place = surface.places_at_rest();
            let near = due(&surface, &place, 0.4);
            let found: Vec<(u32, Meeting)> =
                near.iter().filter_map(|(v, edges)| Some((v, meeting(&surface, &place, v, edges, 0.4)?))).collect();
            let least = found.iter().map(|(_, m)| m.gap).fold(f64::INFINITY, f64::min);
            // Chords of 96 lie up to 0.0016 within their circles.
            assert!((least - 0.1).abs() < 0.004, "{turn} {least}");
            for (vertex, m) in &found {
                let sign = if surface.vertex(*vertex).body == 1 { 1.0 } else { -1.0 };
                assert!(m.normal.dot(&direction) * sign > 0.9, "{turn} {m:?}");
            }
        }
    }

    /// Truth: the difference quotient. Whatever slides over an arc, with edges of any lengths, does no work.
    #[test]
    fn the_normal_is_the_gradient_of_the_gap() {
        let angles = [0.0, 0.1, 0.13, 0.22, 0.4, 0.45, 0.6, 0.8];
        let arc = |angle: f64| Point::new(-3.0 * angle.sin(), 3.0 * angle.cos());
        let mut points: Vec<Point> = angles.into_iter().map(arc).collect();
        points.extend([Point::new(-5.0, -5.0), Point::new(5.0, -5.0)]);
        let gap_at = |place: Point| {
            let mut surface = Surface::default();
            add_ring(&mut surface, 0, &points);
            add_ring(&mut surface, 1, &[place, place + Vector::new(0.4, 2.0), place + Vector::new(-0.4, 2.0)]);
            let all = surface.places_at_rest();
            let near = due(&surface, &all, 0.4);
            let vertex = points.len() as u32;
            near.iter()
                .find(|(v, _)| *v == vertex)
                .and_then(|(v, edges)| meeting(&surface, &all, v, edges, 0.4))
                .unwrap()
        };
        for k in 0..60 {
            let angle = 0.12 + 0.01 * f64::from(k);
            let place = arc(angle) * (1.0 + 0.02 * f64::from(k % 5));
            let found = gap_at(place);
            let quotient = |by: Vector| (gap_at(place + by * 1e-5).gap - gap_at(place - by * 1e-5).gap) / 2e-5;
            let gradient = Vector::new(quotient(Vector::x()), quotient(Vector::y()));
            assert!((gradient - found.normal).norm() < 1e-4, "{angle} {gradient} {found:?}");
        }
    }

    /// Truth: the drawing. A triangle's corner points down at the corner of a square from outside, at its top from
    /// above, and into its side.
    #[test]
    fn corners_meet_what_they_point_at() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Point::from);
        let cases = [
            ([0.5, 1.1], [0.0, 1.0], 0.1),
            ([0.5, 0.99], [0.0, 1.0], -0.01),
            ([1.0, 1.1], [0.0, 1.0], 0.1),
            ([1.03, 1.04], [0.6, 0.8], 0.05),
        ];
        for (corner, normal, expected_gap) in cases {
            let mut surface = Surface::default();
            add_ring(&mut surface, 0, &square);
            let tip = Point::from(corner);
            add_ring(&mut surface, 1, &[tip, tip + Vector::new(0.4, 0.9), tip + Vector::new(-0.4, 0.9)]);
            let place = surface.places_at_rest();
            let near = due(&surface, &place, 0.2);
            let found = near.iter().find(|(v, _)| *v == 4).and_then(|(v, e)| meeting(&surface, &place, v, e, 0.2));
            let m = found.unwrap();
            let (gap, n, expected) = (m.gap, m.normal, Vector::from(normal));
            assert!((gap - expected_gap).abs() < 1e-12 && (n - expected).norm() < 1e-12, "{corner:?} {gap} {n}");
        }
    }

    /// Truth: the drawing. Nothing of a thin wedge, of an L and of a wide notch is anything else's neighbour; the two
    /// sides of a narrow slot are, and so are the arms of a horseshoe.
    #[test]
    fn one_piece_does_not_touch_itself() {
        let divided = |corners: &[[f64; 2]]| {
            let mut points = Vec::new();
            for k in 0..corners.len() {
                let (a, b) = (Point::from(corners[k]), Point::from(corners[(k + 1) % corners.len()]));
                let pieces = ((b - a).norm() / 0.1).ceil() as usize;
                points.extend((0..pieces).map(|i| a + (b - a) * (i as f64 / pieces as f64)));
            }
            let mut surface = Surface::default();
            add_ring(&mut surface, 0, &points);
            due(&surface, &surface.places_at_rest(), 0.2)
        };
        let slot = |width: f64, depth: f64| {
            let (left, right, root) = (2.0 - 0.5 * width, 2.0 + 0.5 * width, 3.0 - depth);
            divided(&[
                [0.0, 0.0],
                [4.0, 0.0],
                [4.0, 3.0],
                [right, 3.0],
                [right, root],
                [left, root],
                [left, 3.0],
                [0.0, 3.0],
            ])
        };
        assert!(!divided(&[[0.0, 0.0], [4.0, 0.0], [4.0, 0.4]]).are_due());
        assert!(!divided(&[[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]]).are_due());
        let notch = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [2.6, 3.0], [2.0, 2.0], [1.4, 3.0], [0.0, 3.0]];
        assert!(!divided(&notch).are_due());
        assert!(slot(0.1, 2.0).are_due());
        assert!(!slot(1.0, 2.0).are_due());
    }
}
