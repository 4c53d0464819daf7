//! Rings: closed polylines that do not repeat their first point.

use crate::Point;

/// Signed area of a ring, positive when counter-clockwise [m²].
pub fn signed_area(ring: &[Point]) -> f64 {
    // Relative to the first vertex, so that a small ring far from the origin keeps its digits.
    let Some(&origin) = ring.first() else { return 0.0 };
    let mut twice = 0.0;
    for i in 0..ring.len() {
        let (p, q) = (ring[i] - origin, ring[(i + 1) % ring.len()] - origin);
        twice += p.x * q.y - q.x * p.y;
    }
    0.5 * twice
}

/// Takes off what repeats: points closer than `tolerance` to the one before, and a last point that repeats the first.
pub fn clean_ring(points: &[Point], tolerance: f64) -> Vec<Point> {
    let mut ring: Vec<Point> = Vec::with_capacity(points.len());
    for &p in points {
        if ring.last().is_none_or(|&q| far(p, q, tolerance)) {
            ring.push(p);
        }
    }
    while ring.len() > 1 && !far(ring[0], ring[ring.len() - 1], tolerance) {
        ring.pop();
    }
    ring
}

/// Points that are not finite count as far, so that they stay and are reported.
fn far(p: Point, q: Point, tolerance: f64) -> bool {
    let distance = (p - q).norm();
    distance > tolerance || !distance.is_finite()
}

/// The ring, turned to run counter-clockwise or clockwise.
pub fn oriented(mut ring: Vec<Point>, counter_clockwise: bool) -> Vec<Point> {
    if (signed_area(&ring) > 0.0) != counter_clockwise {
        ring.reverse();
    }
    ring
}

/// Corners of a circle, counter-clockwise, such that chords leave it by at most `tolerance`; a multiple of 4, at least
/// 16.
pub fn circle_ring(center: Point, radius: f64, tolerance: f64) -> Vec<Point> {
    // Sagitta of a chord: r (1 - cos(pi / n)).
    let angle = (1.0 - tolerance / radius).clamp(-1.0, 1.0).acos();
    let quarter = (std::f64::consts::FRAC_PI_4 / angle).ceil();
    let quarter = if quarter.is_finite() { quarter.clamp(4.0, 1024.0) as usize } else { 4 };
    let point = |i: usize| {
        // Whole quarters exactly, so that a circle is as symmetric as its number of corners allows.
        let (s, c) = (std::f64::consts::FRAC_PI_2 * (i % quarter) as f64 / quarter as f64).sin_cos();
        let (x, y) = [(c, s), (-s, c), (-c, -s), (s, -c)][i / quarter];
        Point::new(center.x + radius * x, center.y + radius * y)
    };
    (0..4 * quarter).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn circles_keep_their_tolerance() {
        let ring = circle_ring(Point::new(1.0, 2.0), 3.0, 0.01);
        let sagitta = 3.0 * (1.0 - (std::f64::consts::PI / ring.len() as f64).cos());
        assert!(sagitta <= 0.01 && sagitta > 0.005, "{sagitta}");
        assert!(signed_area(&ring) > 0.0);
    }
}
