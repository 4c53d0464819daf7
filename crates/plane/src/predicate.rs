//! Predicates whose answer is exact for any coordinates.

use crate::Point;

/// Sign of the turn a → b → c, exact: positive counter-clockwise, negative clockwise, zero on one line.
///
/// The value approximates twice the signed area of the triangle (thesis eq. 1); its sign is exact (Shewchuk 1997).
#[inline]
pub fn orientation(a: Point, b: Point, c: Point) -> f64 {
    let coord = |p: Point| robust::Coord { x: p.x, y: p.y };
    robust::orient2d(coord(a), coord(b), coord(c))
}

/// Whether the ray from `point` in the direction of x crosses the edge `a`–`b`, decided exactly.
///
/// The lower end of an edge belongs to it, the upper end does not, and a point on an edge that rises along the ring is
/// not to the left of it: a ray through a corner crosses one of two edges that go on, and both or none of two that turn
/// back.
#[inline]
pub fn is_left_of(a: Point, b: Point, point: Point) -> bool {
    if (a.y > point.y) == (b.y > point.y) {
        return false;
    }
    let turn = orientation(a, b, point);
    if b.y > a.y { turn > 0.0 } else { turn < 0.0 }
}

/// Whether the closed segments `a`–`b` and `c`–`d` share a point, decided exactly.
#[inline]
pub fn segments_touch(a: Point, b: Point, c: Point, d: Point) -> bool {
    // Most pairs that are asked about are far from each other.
    let apart = |p: f64, q: f64, r: f64, s: f64| p.max(q) < r.min(s) || p.min(q) > r.max(s);
    if apart(a.x, b.x, c.x, d.x) || apart(a.y, b.y, c.y, d.y) {
        return false;
    }
    let (abc, abd) = (orientation(a, b, c), orientation(a, b, d));
    let (cda, cdb) = (orientation(c, d, a), orientation(c, d, b));
    if abc == 0.0 && abd == 0.0 && cda == 0.0 && cdb == 0.0 {
        let overlap = |p: f64, q: f64, r: f64, s: f64| p.min(q) <= r.max(s) && r.min(s) <= p.max(q);
        return overlap(a.x, b.x, c.x, d.x) && overlap(a.y, b.y, c.y, d.y);
    }
    let straddles = |s: f64, t: f64| (s <= 0.0 && t >= 0.0) || (s >= 0.0 && t <= 0.0);
    straddles(abc, abd) && straddles(cda, cdb)
}
