//! How well a motion is that of a rigid body.

use fissure_scene::{Frame, ParticleFrame, Point, Vector};
use nalgebra::Rotation2;

/// A motion in the plane: a turn about the origin, then a shift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RigidMotion {
    /// [rad], counter-clockwise.
    pub(crate) angle: f64,
    /// [m].
    pub(crate) shift: Vector,
}

impl RigidMotion {
    /// Where it brings `point`.
    pub(crate) fn apply(&self, point: Point) -> Point {
        Rotation2::new(self.angle) * point + self.shift
    }

    /// The motion that brings `from` nearest to `to` in the mean square, and the farthest that a point is off [m].
    ///
    /// In the plane the turn has a closed form (S. Umeyama, 1991, without its scale): its tangent is the ratio of the
    /// sums of the cross and the dot products of both, about their means. `from` and `to` have as many points; none
    /// give no motion.
    pub(crate) fn fit(from: &[Point], to: &[Point]) -> (Self, f64) {
        // Sums of nothing are −0, and the angle of (−0, −0) is −π.
        if from.is_empty() {
            return (Self { angle: 0.0, shift: Vector::zeros() }, 0.0);
        }
        let mean = |points: &[Point]| points.iter().map(|p| p.coords).sum::<Vector>() / points.len() as f64;
        let (from_mean, to_mean) = (mean(from), mean(to));
        let pairs = || from.iter().zip(to).map(|(p, q)| (p.coords - from_mean, q.coords - to_mean));
        let cross: f64 = pairs().map(|(p, q)| p.perp(&q)).sum();
        let dot: f64 = pairs().map(|(p, q)| p.dot(&q)).sum();
        let angle = cross.atan2(dot);
        let motion = Self { angle, shift: to_mean - Rotation2::new(angle) * from_mean };
        let off = |(p, q): (&Point, &Point)| (motion.apply(*p) - q).norm();
        (motion, from.iter().zip(to).map(off).fold(0.0, f64::max))
    }
}

/// The corners of the squares that the particles of one fragment stand for, moved and deformed with them. Particles are
/// in the order of the take.
pub(crate) fn corners(frame: &Frame, body: u32, piece: u32, spacing: f64) -> (Vec<u32>, Vec<Point>) {
    let ParticleFrame { id, position, deformation_gradient, .. } = &frame.particles;
    let particles = &frame.particles;
    let own = (0..particles.len()).filter(|&p| particles.body[p] == body && particles.piece[p] == piece);
    let half = 0.5 * spacing;
    let mut ids = Vec::new();
    let mut corners = Vec::new();
    for p in own {
        ids.push(id[p]);
        for (x, y) in [(-half, -half), (half, -half), (half, half), (-half, half)] {
            corners.push(position[p] + deformation_gradient[p] * Vector::new(x, y));
        }
    }
    (ids, corners)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Truth: the motion that was made, and the displacement that was added to it.
        #[test]
        fn a_motion_is_found_with_what_it_is_off(
            angle in -3.1..3.1_f64, x in -10.0..10.0_f64, y in -10.0..10.0_f64, error in 0.0..0.01_f64,
        ) {
            let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| Point::new(5.0 + x, y - 3.0));
            let made = RigidMotion { angle, shift: Vector::new(x, y) };
            // A stretch along a diagonal turns nothing and shifts nothing.
            let stretched = |i: usize| square[i] + error * [-1.0, 0.0, 1.0, 0.0][i] * Vector::new(1.0, 1.0).normalize();
            let there: Vec<Point> = (0..4).map(|i| made.apply(stretched(i))).collect();
            let (found, off) = RigidMotion::fit(&square, &there);
            prop_assert!((found.angle - angle).abs() < 1e-12);
            prop_assert!((found.apply(square[2]) - made.apply(square[2])).norm() < 1e-12);
            prop_assert!((off - error).abs() < 1e-12);
        }
    }

    #[test]
    fn nothing_does_not_move() {
        assert_eq!(RigidMotion::fit(&[], &[]), (RigidMotion { angle: 0.0, shift: Vector::zeros() }, 0.0));
    }
}
