//! How much of each square of a lattice lies in a region, exactly, along the rings of the region.
//!
//! Area and first moments of a plane region are integrals along its boundary (Green's theorem). Each ring is cut at the
//! lines between the squares; a piece gives its square what lies to its right there, and all squares beyond it in the
//! same row what its height covers of them. Work goes with the length of the rings.

use super::scan::Places;
use fissure_plane::{Region, Vector};
use std::collections::BTreeMap;

/// The part of a square that lies in a region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cover {
    /// Column and row of the square.
    pub(crate) place: [i32; 2],
    /// Part of its area that is covered [–].
    pub(crate) part: f64,
    /// From the middle of the square to the centre of what is covered, in sides of a square.
    pub(crate) center: Vector,
}

/// A part that is off from nothing or all by less comes from rounding [–].
const ROUND_OFF: f64 = 1e-9;

/// What the pieces of rings in a square stand for: of the square itself and of those to its right.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    /// Area, and its moments about the lower left corner.
    own: [f64; 3],
    /// Height, and its moment: what each further square gets.
    beyond: [f64; 2],
}

impl Places {
    /// The squares around places that the rings of `region` pass through and that it covers in part, row by row,
    /// columns rising; of the others it covers all or nothing. The rings do not cross each other.
    pub(crate) fn covers_along(&self, region: &Region) -> Vec<Cover> {
        let mut sums: BTreeMap<(i32, i32), Sums> = BTreeMap::new();
        for ring in region.rings() {
            for k in 0..ring.len() {
                let [a, b] = [ring[k], ring[(k + 1) % ring.len()]].map(|p| (p - self.anchor) / self.spacing);
                add_edge(&mut sums, a, b);
            }
        }
        let mut covers = Vec::new();
        let (mut row, mut height, mut moment) = (i32::MIN, 0.0, 0.0);
        for ((j, i), sums) in sums {
            if j != row {
                (row, height, moment) = (j, 0.0, 0.0);
            }
            let [area, x, y] = sums.own;
            // Where the region lies to the left of an upward edge, what is to the right of it is taken off.
            let [area, x, y] = [-(area + height), -(x + 0.5 * height), -(y + moment)];
            height += sums.beyond[0];
            moment += sums.beyond[1];
            if area > ROUND_OFF && area < 1.0 - ROUND_OFF {
                let center = Vector::new(x / area - 0.5, y / area - 0.5);
                covers.push(Cover { place: [i, j], part: area, center });
            }
        }
        covers
    }
}

/// The parts of the way from `a` to `b`, from 0 to 1, at which it crosses lines of whole numbers, ends included.
pub(crate) fn cuts(a: Vector, b: Vector) -> Vec<f64> {
    let mut cuts = vec![0.0, 1.0];
    for axis in 0..2 {
        let (from, way) = (a[axis], b[axis] - a[axis]);
        let (low, high) = (a[axis].min(b[axis]), a[axis].max(b[axis]));
        let lines = low.floor() as i64 + 1..high.ceil() as i64;
        cuts.extend(lines.map(|line| ((line as f64 - from) / way).clamp(0.0, 1.0)));
    }
    cuts.sort_unstable_by(f64::total_cmp);
    cuts.dedup();
    cuts
}

/// Adds the edge from `a` to `b`, in sides of a square.
fn add_edge(sums: &mut BTreeMap<(i32, i32), Sums>, a: Vector, b: Vector) {
    for cut in cuts(a, b).windows(2) {
        let at = |t: f64| a + (b - a) * t;
        let corner = at(0.5 * (cut[0] + cut[1])).map(f64::floor);
        let ([x0, y0], [x1, y1]) = ((at(cut[0]) - corner).into(), (at(cut[1]) - corner).into());
        let height: f64 = y1 - y0;
        let middle = 0.5 * (y0 + y1);
        let sums = sums.entry((corner.y as i32, corner.x as i32)).or_default();
        // ∫ (1 − x) dy, ∫ ½ (1 − x²) dy and ∫ y (1 − x) dy along the piece.
        sums.own[0] += height * (1.0 - 0.5 * (x0 + x1));
        sums.own[1] += height * (0.5 - (x0 * x0 + x0 * x1 + x1 * x1) / 6.0);
        sums.own[2] += height * (middle - (2.0 * (x0 * y0 + x1 * y1) + x0 * y1 + x1 * y0) / 6.0);
        sums.beyond[0] += height;
        sums.beyond[1] += height * middle;
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use fissure_plane::Point;
    use proptest::prelude::*;

    /// A ring clipped by the half-plane where `keep` is positive or zero (Sutherland & Hodgman).
    fn clipped(ring: &[Point], keep: impl Fn(Point) -> f64) -> Vec<Point> {
        let mut out = Vec::new();
        for k in 0..ring.len() {
            let (a, b) = (ring[k], ring[(k + 1) % ring.len()]);
            let (at_a, at_b) = (keep(a), keep(b));
            if at_a >= 0.0 {
                out.push(a);
            }
            if at_a * at_b < 0.0 {
                out.push(a + (b - a) * (at_a / (at_a - at_b)));
            }
        }
        out
    }

    /// Area and centre of a ring, by its triangles with the origin.
    fn area_and_center(ring: &[Point]) -> (f64, Vector) {
        let (mut area, mut moment) = (0.0, Vector::zeros());
        for k in 0..ring.len() {
            let (a, b) = (ring[k].coords, ring[(k + 1) % ring.len()].coords);
            let twice = a.perp(&b);
            area += 0.5 * twice;
            moment += (a + b) * (twice / 6.0);
        }
        (area, moment / area)
    }

    proptest! {
        /// Truth: each square clipped out of a star-shaped ring by half-planes, its corners on lattice lines or not.
        #[test]
        fn covers_are_those_of_clipped_squares(
            radii in prop::collection::vec(1.0..6.0_f64, 3..12),
            middle in [-0.5..0.5_f64, -0.5..0.5_f64],
            snaps in any::<bool>(),
        ) {
            let places = Places { anchor: Point::new(-1.3, 0.7), spacing: 0.25 };
            let corner = |(k, r): (usize, &f64)| {
                let (s, c) = (std::f64::consts::TAU * k as f64 / radii.len() as f64).sin_cos();
                let p = Vector::new(middle[0] + r * c, middle[1] + r * s);
                places.anchor + if snaps { p.map(f64::round) } else { p } * places.spacing
            };
            let ring: Vec<Point> = radii.iter().enumerate().map(corner).collect();
            prop_assume!(fissure_plane::signed_area(&ring) > 0.1 * places.spacing * places.spacing);
            prop_assume!(fissure_plane::find_crossing(&[&ring], true).is_none());
            let covers = places.covers_along(&Region { exterior: ring.clone(), holes: Vec::new() });
            prop_assert!(covers.is_sorted_by_key(|c| (c.place[1], c.place[0])));
            for j in -8..8 {
                for i in -8..8 {
                    let center = places.at(i, j);
                    let low = center - Vector::repeat(0.125);
                    let part = clipped(&ring, |p| p.x - low.x);
                    let part = clipped(&part, |p| low.x + 0.25 - p.x);
                    let part = clipped(&part, |p| p.y - low.y);
                    let part = clipped(&part, |p| low.y + 0.25 - p.y);
                    let (area, middle) = area_and_center(&part);
                    let area = area / 0.0625;
                    match covers.iter().find(|c| c.place == [i, j]) {
                        Some(cover) => {
                            prop_assert!((cover.part - area).abs() < 1e-9, "{:?} {area}", cover);
                            let off = (cover.center * 0.25 - (middle - center.coords)).norm();
                            prop_assert!(off * area < 1e-9, "{:?} {middle} {center}", cover);
                        }
                        None => prop_assert!(part.len() < 3 || !(1e-8..=1.0 - 1e-8).contains(&area), "{i} {j} {area}"),
                    }
                }
            }
        }
    }
}
