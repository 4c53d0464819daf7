//! Places, displacements and tensors of the plane.

/// A place in the plane [m]; x to the right, y up.
pub type Point = nalgebra::Point2<f64>;
/// A displacement [m], velocity [m/s] or direction in the plane.
pub type Vector = nalgebra::Vector2<f64>;
/// A second-order tensor in the plane.
pub type Matrix = nalgebra::Matrix2<f64>;

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
