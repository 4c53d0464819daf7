//! The material that is left ahead of a tip.

use crate::{Point, Vector, nearest_on_segment};
use nalgebra::Rotation2;
use std::f64::consts::FRAC_PI_4;

/// A tip with what it sees: the wedge of 45° to both sides of its direction. Wider, it would see the
/// sides of every strip that it runs along the middle of.
#[derive(Debug, Clone, Copy)]
pub struct Outlook {
    tip: Point,
    /// Unit normals of the two sides of the wedge, into it.
    inward: [Vector; 2],
}

impl Outlook {
    /// The outlook from `tip` in the direction `ahead`; none where that is no direction.
    pub fn new(tip: Point, ahead: Vector) -> Option<Self> {
        let ahead = ahead.try_normalize(0.0)?;
        // The sides are 45° off, their normals 90° off those.
        Some(Self { tip, inward: [-FRAC_PI_4, FRAC_PI_4].map(|turn| Rotation2::new(turn) * ahead) })
    }

    /// The point of the segment `a`–`b` nearest to the tip within the wedge; none where the segment is outside of it.
    fn nearest(&self, a: Point, b: Point) -> Option<Point> {
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for inward in self.inward {
            let (at_a, at_b) = (inward.dot(&(a - self.tip)), inward.dot(&(b - self.tip)));
            match (at_a < 0.0, at_b < 0.0) {
                (true, true) => return None,
                (true, false) => from = from.max(at_a / (at_a - at_b)),
                (false, true) => to = to.min(at_a / (at_a - at_b)),
                (false, false) => {}
            }
        }
        let along = b - a;
        (from <= to).then(|| nearest_on_segment(a + along * from, a + along * to, self.tip))
    }

    /// Distance from the tip to the nearest of `segments` within the wedge [m], and which that is; none where it sees
    /// none within `reach` [m].
    pub fn clearance<T>(&self, segments: impl Iterator<Item = (T, Point, Point)>, mut reach: f64) -> Option<(f64, T)> {
        let mut nearest = None;
        for (which, a, b) in segments {
            let (low, high) = (a.inf(&b), a.sup(&b));
            if (low - self.tip).max() > reach || (self.tip - high).max() > reach {
                continue;
            }
            let distance = self.nearest(a, b).map(|place| (place - self.tip).norm());
            if let Some(distance) = distance.filter(|&distance| distance < reach) {
                reach = distance;
                nearest = Some((distance, which));
            }
        }
        nearest
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    fn points(count: usize) -> impl Strategy<Value = Vec<Point>> {
        prop::collection::vec((-1.0_f64..1.0, -1.0_f64..1.0), count)
            .prop_map(|places| places.into_iter().map(|(x, y)| Point::new(x, y)).collect())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(500))]
        /// Truth: brute force. Rays from the tip, a five-hundredth of the wedge apart, meet none of the lines before
        /// the clearance, and somewhere in the wedge a place of the lines is that far.
        #[test]
        fn the_clearance_is_the_shortest_ray_ahead(line in points(6), direction in -PI..PI, size in -6.0_f64..6.0, reach in 0.1_f64..3.0) {
            const RAYS: i32 = 250;
            let size = 10.0_f64.powf(size);
            let tip = Point::new(3.0 * size, -size);
            let line: Vec<Point> = line.iter().map(|p| tip + p.coords * size).collect();
            let toward = |angle: f64| Vector::new(angle.cos(), angle.sin());
            let segments = || line.windows(2).map(|w| (w[0], w[1]));
            let found = Outlook::new(tip, toward(direction)).unwrap().clearance(segments().map(|(a, b)| ((), a, b)), reach * size).map(|f| f.0);
            let ray = |angle: f64| {
                let met = |(a, b): (Point, Point)| {
                    let (along, to) = (b - a, a - tip);
                    let turn = toward(angle).perp(&along);
                    let (distance, part) = (to.perp(&along) / turn, to.perp(&toward(angle)) / turn);
                    (distance >= 0.0 && (0.0..=1.0).contains(&part)).then_some(distance)
                };
                segments().filter_map(met).fold(f64::INFINITY, f64::min)
            };
            let rays = (-RAYS..=RAYS).map(|k| ray(direction + FRAC_PI_4 * f64::from(k) / f64::from(RAYS)));
            let shortest = rays.fold(f64::INFINITY, f64::min);
            let clear = found.unwrap_or(reach * size);
            prop_assert!(shortest >= clear * (1.0 - 1e-9), "{shortest} {clear}");
            if let Some(clear) = found {
                // A witness: some segment has its nearest place in the wedge there, or crosses a side of it there.
                let corner = |p: &Point| ((p - tip).norm() - clear).abs() < 1e-9 * size && toward(direction).angle(&(p - tip)) < FRAC_PI_4 + 1e-9;
                let foot = |(a, b): (Point, Point)| {
                    let normal = Vector::new(a.y - b.y, b.x - a.x).normalize();
                    let foot = normal * normal.dot(&(a - tip));
                    (foot.norm() - clear).abs() < 1e-9 * size && toward(direction).angle(&foot) < FRAC_PI_4 + 1e-9
                };
                let side = |angle: f64| (ray(direction + angle) - clear).abs() < 1e-6 * size;
                let sides = [-1.0, 1.0].map(|sign| sign * FRAC_PI_4 * (1.0 - 1e-9));
                prop_assert!(line.iter().any(corner) || segments().any(foot) || sides.into_iter().any(side), "{clear}");
            }
        }
    }
}
