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
    /// Unit vector ahead of the tip, e1 of its frame.
    ahead: Vector,
    /// Where the crack goes on and on away from the tip along e1, how far it does [m], and between which η it lies [m].
    /// What is beside that sees the face on its side, whatever segment is nearest.
    strip: Option<(f64, [f64; 2])>,
}

/// What two distances have to differ by, as part of them, to differ whatever rounding has done to them.
const SURELY: f64 = 1e-9;

impl LineAround {
    /// Around a tip, for places within `radius` [m] of it: what is nearest to such a place lies within twice that.
    /// `ahead`: e1 of its frame. `place` (crack, number of the point) says where its points are.
    pub(crate) fn new(
        cracks: &Cracks,
        id: TipId,
        ahead: Vector,
        radius: f64,
        place: impl Fn(usize, usize) -> Point,
    ) -> Self {
        Self::of_points(cracks.behind_at(id, 2.0 * radius, place), id.end, ahead)
    }

    /// Along `points`, from the tip on.
    fn of_points(mut points: Vec<Point>, end: End, ahead: Vector) -> Self {
        let strip = strip(&points, ahead);
        let mut ways = vec![0.0];
        ways.extend(points.windows(2).scan(0.0, |way, w| {
            *way += (w[1] - w[0]).norm();
            Some(*way)
        }));
        if end == End::End {
            points.reverse();
        }
        Self { points, ways, end, ahead, strip }
    }

    /// The face that a place sees, as a side of the frame of the tip: that of the nearest segment behind the tip, of
    /// the tip's own line ahead. A place on the crack is above it, as in [`crate::crack::crossing`].
    pub(crate) fn side_of(&self, place: Point) -> Side {
        let tip = if self.end == End::Start { self.points[0] } else { self.points[self.points.len() - 1] };
        let arm = place - tip;
        let (xi, eta) = (arm.dot(&self.ahead), self.ahead.perp(&arm));
        if xi >= 0.0 {
            return if eta >= 0.0 { Side::Above } else { Side::Below };
        }
        match self.strip {
            Some((length, [_, high])) if xi > -length && eta > high => Side::Above,
            Some((length, [low, _])) if xi > -length && eta < low => Side::Below,
            _ => self.side_of_nearest(place),
        }
    }

    fn side_of_nearest(&self, place: Point) -> Side {
        let Self { points, ways, end, .. } = self;
        let n = points.len();
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

/// See [`LineAround::strip`]; `points` from the tip on.
fn strip(points: &[Point], ahead: Vector) -> Option<(f64, [f64; 2])> {
    let tip = *points.first()?;
    let (mut length, mut low, mut high) = (0.0_f64, 0.0_f64, 0.0_f64);
    for w in points.windows(2) {
        let (arm, way) = (w[1] - tip, w[1] - w[0]);
        if way.dot(&ahead) >= -SURELY * way.norm() {
            return None;
        }
        let eta = ahead.perp(&arm);
        (length, low, high) = (-arm.dot(&ahead), low.min(eta), high.max(eta));
    }
    let margin = SURELY * length;
    Some((length - margin, [low - margin, high + margin]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Truth: the segment nearest to each place, looked for among all. Cracks that go straight on, that wind and
        /// that turn back.
        #[test]
        fn a_place_beside_a_crack_sees_the_face_of_its_nearest_segment(
            turns in prop::collection::vec(-0.5_f64..0.5, 0..40), swing in 0.0_f64..2.5, is_start in any::<bool>(),
            angle in 0.0_f64..6.3, tilt in -0.4_f64..0.4,
            places in prop::collection::vec((-6.0_f64..3.0, -4.0_f64..4.0), 60),
        ) {
            let way = |angle: f64| Vector::new(angle.cos(), angle.sin());
            let (tip, mut heading) = (Point::new(0.3, 0.7), angle + std::f64::consts::PI);
            let mut points = vec![tip, tip + way(heading) * 0.2];
            for turn in turns {
                heading += swing * turn;
                points.push(points[points.len() - 1] + way(heading) * 0.2);
            }
            let ahead = way(angle + tilt);
            let end = if is_start { End::Start } else { End::End };
            let line = LineAround::of_points(points, end, ahead);
            for (x, y) in places {
                let place = tip + ahead * x + Vector::new(-ahead.y, ahead.x) * y;
                if x < 0.0 {
                    prop_assert_eq!(line.side_of(place), line.side_of_nearest(place), "{} {}", x, y);
                }
            }
        }
    }
}
