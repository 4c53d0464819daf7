//! Plane geometry words: places, displacements, matrices, regions.

use serde::{Deserialize, Serialize};

/// A place in the plane [m]; x to the right, y up.
pub type Point = nalgebra::Point2<f64>;
/// A displacement [m], velocity [m/s] or direction in the plane.
pub type Vector = nalgebra::Vector2<f64>;
/// A second-order tensor in the plane.
pub type Matrix = nalgebra::Matrix2<f64>;

/// A plane region: one outer ring and any number of holes.
///
/// Rings are open (the last point does not repeat the first). The exterior runs counter-clockwise, holes clockwise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Region {
    /// Outer ring, counter-clockwise [m].
    pub exterior: Vec<Point>,
    /// Inner rings, clockwise [m].
    pub holes: Vec<Vec<Point>>,
}

impl Region {
    /// All rings: the exterior first, then the holes.
    pub fn rings(&self) -> impl Iterator<Item = &[Point]> {
        std::iter::once(self.exterior.as_slice()).chain(self.holes.iter().map(Vec::as_slice))
    }

    /// Area enclosed, holes taken off [m²].
    pub fn area(&self) -> f64 {
        self.rings().map(signed_area).sum()
    }

    /// Whether `point` lies inside: an odd number of ring crossings to the right, decided by exact predicates.
    ///
    /// A point exactly on an edge belongs to the region on one side only (half-open rule), so abutting regions share no point.
    pub fn contains(&self, point: Point) -> bool {
        let mut inside = false;
        for ring in self.rings() {
            for i in 0..ring.len() {
                let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
                if (a.y > point.y) != (b.y > point.y) {
                    let turn = orientation(a, b, point);
                    if (b.y > a.y && turn > 0.0) || (b.y < a.y && turn < 0.0) {
                        inside = !inside;
                    }
                }
            }
        }
        inside
    }

    /// Smallest axis-parallel rectangle around the region: (lowest x and y, highest x and y) [m].
    pub fn bounds(&self) -> (Point, Point) {
        bounds(&self.exterior)
    }
}

/// Smallest axis-parallel rectangle around `points`; of no points: an inverted infinite one.
pub fn bounds(points: &[Point]) -> (Point, Point) {
    let mut low = Point::new(f64::INFINITY, f64::INFINITY);
    let mut high = Point::new(f64::NEG_INFINITY, f64::NEG_INFINITY);
    for p in points {
        low = low.inf(p);
        high = high.sup(p);
    }
    (low, high)
}

/// Sign of the turn a → b → c, exact: positive counter-clockwise, negative clockwise, zero on one line.
///
/// The value approximates twice the signed area of the triangle (thesis eq. 1); its sign is exact (Shewchuk 1997).
pub fn orientation(a: Point, b: Point, c: Point) -> f64 {
    let coord = |p: Point| robust::Coord { x: p.x, y: p.y };
    robust::orient2d(coord(a), coord(b), coord(c))
}

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

/// Length of an open polyline [m].
pub fn polyline_length(points: &[Point]) -> f64 {
    points.windows(2).map(|w| (w[1] - w[0]).norm()).sum()
}

/// Whether the closed segments `a`–`b` and `c`–`d` share a point, decided exactly.
pub fn segments_touch(a: Point, b: Point, c: Point, d: Point) -> bool {
    let (abc, abd) = (orientation(a, b, c), orientation(a, b, d));
    let (cda, cdb) = (orientation(c, d, a), orientation(c, d, b));
    if abc == 0.0 && abd == 0.0 && cda == 0.0 && cdb == 0.0 {
        let overlap = |p: f64, q: f64, r: f64, s: f64| p.min(q) <= r.max(s) && r.min(s) <= p.max(q);
        return overlap(a.x, b.x, c.x, d.x) && overlap(a.y, b.y, c.y, d.y);
    }
    let straddles = |s: f64, t: f64| (s <= 0.0 && t >= 0.0) || (s >= 0.0 && t <= 0.0);
    straddles(abc, abd) && straddles(cda, cdb)
}

/// The point of a segment nearest to `point`; an end point to the bit when that is nearest.
pub fn nearest_on_segment(a: Point, b: Point, point: Point) -> Point {
    let along = b - a;
    let t = (point - a).dot(&along) / along.norm_squared();
    if t.is_nan() || t <= 0.0 {
        a
    } else if t >= 1.0 {
        b
    } else {
        a + along * t
    }
}

/// Distance of the closed segments `a`–`b` and `c`–`d` [m]; exactly 0 when they share a point.
pub fn segment_distance(a: Point, b: Point, c: Point, d: Point) -> f64 {
    if segments_touch(a, b, c, d) {
        return 0.0;
    }
    let to = |p: Point, q: Point, point: Point| (nearest_on_segment(p, q, point) - point).norm();
    to(a, b, c).min(to(a, b, d)).min(to(c, d, a)).min(to(c, d, b))
}
