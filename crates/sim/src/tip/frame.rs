//! The frame of a tip: where it is, where it points, and which face of its crack a place sees.

use crate::crack::cracks::{Cracks, TipId};
use crate::crack::crossing::{Side, side_of_crack};
use crate::crack::{DIRECTION_LENGTH, chord_start};
use fissure_plane::{Matrix, Point, Vector};
use fissure_scene::End;

/// A turn by the angle whose tangent is `sine`/`cosine`, and what it differs from the identity, without cancellation.
pub(crate) fn turn(cosine: f64, sine: f64) -> (Matrix, Matrix) {
    let r = cosine.hypot(sine);
    let (c, s) = if r > 0.0 { (cosine / r, sine / r) } else { (1.0, 0.0) };
    let c_minus_one = if c > 0.0 { -s * s / (1.0 + c) } else { c - 1.0 };
    (Matrix::new(c, -s, s, c), Matrix::new(c_minus_one, -s, s, c_minus_one))
}

/// `vector` turned counter-clockwise by `angle` [rad].
pub(crate) fn turned(vector: Vector, angle: f64) -> Vector {
    let (sine, cosine) = angle.sin_cos();
    Vector::new(cosine * vector.x - sine * vector.y, sine * vector.x + cosine * vector.y)
}

/// One end of a crack of which the points are at `points` now, and the direction ahead of it (unit vector); that at
/// rest where they all coincide.
pub(crate) fn tip_of(cracks: &Cracks, id: TipId, points: &[Point], cell_size: f64) -> (Point, Vector) {
    let over = cracks.chord_length(id, DIRECTION_LENGTH * cell_size);
    let tip = if id.end == End::Start { points[0] } else { points[points.len() - 1] };
    let ahead = tip - chord_start(points, id.end, over);
    let length = ahead.norm();
    (tip, if length > 0.0 { ahead / length } else { cracks.ahead(id, DIRECTION_LENGTH * cell_size) })
}

/// A crack around one of its tips, to tell which of its faces places near the tip see.
#[derive(Debug, Clone)]
pub(crate) struct LineAround {
    /// As the crack runs.
    points: Vec<Point>,
    /// Way along the crack from the tip to each of them, the tip first [m].
    ways: Vec<f64>,
    end: End,
}

/// What two distances have to differ by, as part of them, to differ whatever rounding has done to them.
const SURELY: f64 = 1e-9;

impl LineAround {
    /// Around a tip, for places within `radius` [m] of it: what is nearest to such a place lies within twice that.
    /// `place` (crack, number of the point) says where its points are.
    pub(crate) fn new(cracks: &Cracks, id: TipId, radius: f64, place: impl Fn(usize, usize) -> Point) -> Self {
        let mut points = cracks.behind_at(id, 2.0 * radius, place);
        let mut ways = vec![0.0];
        ways.extend(points.windows(2).scan(0.0, |way, w| {
            *way += (w[1] - w[0]).norm();
            Some(*way)
        }));
        if id.end == End::End {
            points.reverse();
        }
        Self { points, ways, end: id.end }
    }

    /// The face that a place sees, as a side of the frame of the tip (`ahead`: e1): that of the nearest segment behind
    /// the tip, of the tip's own line ahead. A place on the crack is above it, as in [`crate::crack::crossing`].
    pub(crate) fn side_of(&self, ahead: Vector, place: Point) -> Side {
        let Self { points, ways, end } = self;
        let n = points.len();
        let tip = if *end == End::Start { points[0] } else { points[n - 1] };
        let arm = place - tip;
        if arm.dot(&ahead) >= 0.0 {
            return if ahead.perp(&arm) >= 0.0 { Side::Above } else { Side::Below };
        }
        let mut nearest = (f64::INFINITY, 0);
        let mut k = 0;
        while k < n - 1 {
            let segment = if *end == End::End { n - 2 - k } else { k };
            let distance = fissure_plane::distance_to_segment(place, points[segment], points[segment + 1]);
            if distance < nearest.0 {
                nearest = (distance, segment);
            }
            // No part of the crack is nearer than this one is, less the way there.
            let reached = ways[k] + (distance - nearest.0) - SURELY * distance;
            k += 1;
            while k < n - 1 && ways[k + 1] < reached {
                k += 1;
            }
        }
        let side = side_of_crack(points, nearest.1, place);
        if *end == End::End { side } else { side.opposite() }
    }
}
