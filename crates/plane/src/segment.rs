//! Straight segments: the place nearest to a point, and distances.

use crate::{Point, segments_touch};

/// The point of a segment nearest to `point`; an end point to the bit when that is nearest.
#[inline]
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

/// Distance from `point` to the segment `a`–`b` [m].
#[inline]
pub fn distance_to_segment(point: Point, a: Point, b: Point) -> f64 {
    (point - nearest_on_segment(a, b, point)).norm()
}

/// Distance of the closed segments `a`–`b` and `c`–`d` [m]; exactly 0 when they share a point.
pub fn segment_distance(a: Point, b: Point, c: Point, d: Point) -> f64 {
    if segments_touch(a, b, c, d) {
        return 0.0;
    }
    let to = |p: Point, q: Point, point: Point| (nearest_on_segment(p, q, point) - point).norm();
    to(a, b, c).min(to(a, b, d)).min(to(c, d, a)).min(to(c, d, b))
}
