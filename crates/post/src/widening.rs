//! Cracks shown wider, or less wide, than they are.

use crate::opening::arc_lengths;
use fissure_scene::{CrackEnd, CrackFrame, OpeningSettings, Point, Scene, Vector};
use std::ops::Add;

/// How far the two faces of a crack are moved at one of its points [m].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Shift {
    /// The face above.
    pub(crate) above: Vector,
    /// The face below.
    pub(crate) below: Vector,
}

impl Add for Shift {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { above: self.above + other.above, below: self.below + other.below }
    }
}

/// How far the corner moves between two faces that move by `a` and `b`, each across itself [m]: to where the moved
/// faces meet, or by the mean of both where they are nearly one line.
pub(crate) fn both(a: Vector, b: Vector) -> Vector {
    /// Sine of the angle below which faces are one line.
    const STRAIGHT: f64 = 0.35;
    let (Some(m), Some(n)) = (a.try_normalize(0.0), b.try_normalize(0.0)) else { return a + b };
    let sine = m.perp(&n);
    if sine.abs() < STRAIGHT {
        return 0.5 * (a + b);
    }
    // x · m = |a| and x · n = |b|.
    let left = |v: Vector| Vector::new(-v.y, v.x);
    (b.norm() * left(m) - a.norm() * left(n)) / sine
}

/// How wide cracks are shown at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Widening {
    factor: f64,
    /// Least width [m], and from how far from a tip on [m].
    least: f64,
    falloff: f64,
    /// Openings above this grow no further [m].
    reach: f64,
}

/// [`Widening`]'s reach in cells.
const REACH: f64 = 2.0;

impl Widening {
    /// What `settings` say of `time`.
    pub(crate) fn new(settings: &OpeningSettings, scene: &Scene, time: f64) -> Self {
        let OpeningSettings { factor, least, falloff } = settings;
        let reach = (REACH * scene.cell_size).max(*least);
        Self { factor: factor.value(time), least: *least, falloff: *falloff, reach }
    }

    /// How far the faces of `crack` are moved at each of its points: along the mean of their
    /// normals, each by half of what the width changes, see [`OpeningSettings`]. At a tip nothing moves.
    pub(crate) fn shifts(&self, crack: &CrackFrame) -> Vec<Shift> {
        let arcs = arc_lengths(&crack.rest, None);
        let length = arcs.last().copied().unwrap_or(0.0);
        let from_tip = |i: usize| {
            let start = if crack.start == CrackEnd::Tip { arcs[i] } else { f64::INFINITY };
            let end = if crack.end == CrackEnd::Tip { length - arcs[i] } else { f64::INFINITY };
            start.min(end)
        };
        let shift = |i: usize| {
            let (above, below) = (normal(&crack.above, i), normal(&crack.below, i));
            let across = (above + below).try_normalize(0.0).unwrap_or(above);
            let width = (crack.above[i] - crack.below[i]).dot(&across);
            let near_tip = (from_tip(i) / self.falloff).clamp(0.0, 1.0).sqrt();
            let half = 0.5 * self.change(width, near_tip);
            Shift { above: half * across, below: -half * across }
        };
        (0..crack.rest.len()).map(shift).collect()
    }

    /// How much wider a crack of `width` is shown where the least width is reached to the part `near_tip` [m].
    fn change(&self, width: f64, near_tip: f64) -> f64 {
        if near_tip == 0.0 {
            return 0.0;
        }
        let visible = width.max(self.least * near_tip);
        visible - width + (self.factor - 1.0) * visible.clamp(0.0, self.reach)
    }
}

/// Unit normal of a face at a point, to the left of the way along the crack.
pub(crate) fn normal(face: &[Point], i: usize) -> Vector {
    let along = face[(i + 1).min(face.len() - 1)] - face[i.saturating_sub(1)];
    Vector::new(-along.y, along.x).try_normalize(0.0).unwrap_or_default()
}

/// `crack` with its faces moved.
pub(crate) fn widened(crack: &CrackFrame, shifts: &[Shift]) -> CrackFrame {
    let above = crack.above.iter().zip(shifts).map(|(p, shift)| p + shift.above).collect();
    let below = crack.below.iter().zip(shifts).map(|(p, shift)| p + shift.below).collect();
    CrackFrame { above, below, ..crack.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn crack(opening: f64) -> CrackFrame {
        let rest: Vec<Point> = (0..=10).map(|i| Point::new(0.1 * f64::from(i), 0.0)).collect();
        let face = |side: f64| rest.iter().map(|p| p + Vector::new(0.0, 0.5 * side * opening * (1.0 - p.x))).collect();
        let (above, below) = (face(1.0), face(-1.0));
        CrackFrame { above, below, start: CrackEnd::Mouth, end: CrackEnd::Tip, rest, ..CrackFrame::default() }
    }

    /// Width of a straight crack with `widening` at each point.
    fn widths(crack: &CrackFrame, widening: Widening) -> Vec<f64> {
        let shown = widened(crack, &widening.shifts(crack));
        shown.above.iter().zip(&shown.below).map(|(a, b)| a.y - b.y).collect()
    }

    /// Truth: a corner that is moved lies on both lines that are moved.
    #[test]
    fn a_corner_moves_with_both_faces() {
        for (angle, other) in [(0.3, 1.9), (2.0, 0.5), (-1.0, 1.0)] {
            let direction = |angle: f64| Vector::new(angle.cos(), angle.sin());
            let (a, b) = (0.2 * direction(angle), 0.5 * direction(other));
            let moved = both(a, b);
            assert!((moved.dot(&direction(angle)) - 0.2).abs() < 1e-12, "{angle}, {other}");
            assert!((moved.dot(&direction(other)) - 0.5).abs() < 1e-12, "{angle}, {other}");
        }
        let (still, one) = (Vector::zeros(), Vector::new(0.1, 0.0));
        assert_eq!((both(one, still), both(still, one), both(one, one)), (one, one, one));
    }

    /// Truth: the formula by hand, for a crack that opens as a wedge and for one that is closed.
    #[test]
    fn widths_are_what_was_asked_for() {
        let plain = Widening { factor: 1.0, least: 0.0, falloff: 0.4, reach: 10.0 };
        let close = |found: Vec<f64>, expected: &dyn Fn(f64) -> f64| {
            for (i, width) in found.iter().enumerate() {
                let x = 0.1 * i as f64;
                assert!((width - expected(x)).abs() < 1e-4, "{width} at {x} instead of {}", expected(x));
            }
        };
        close(widths(&crack(0.01), plain), &|x| 0.01 * (1.0 - x));
        close(widths(&crack(0.01), Widening { factor: 3.0, ..plain }), &|x| 0.03 * (1.0 - x));
        close(widths(&crack(0.01), Widening { factor: 0.0, ..plain }), &|_| 0.0);
        let least = Widening { least: 0.02, ..plain };
        let root = |x: f64| ((1.0 - x) / 0.4).clamp(0.0, 1.0).sqrt();
        close(widths(&crack(0.0), least), &|x| 0.02 * root(x));
        close(widths(&crack(0.0), Widening { factor: 0.5, ..least }), &|x| 0.01 * root(x));
        // Faces that overlap are parted.
        close(widths(&crack(-0.01), least), &|x| 0.02 * root(x));
        // What has flown apart is moved by no more than the reach.
        close(widths(&crack(100.0), Widening { factor: 2.0, reach: 0.5, ..plain }), &|x| {
            100.0 * (1.0 - x) + (100.0 * (1.0 - x)).min(0.5)
        });
    }
}
