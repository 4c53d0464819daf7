//! The parts of outlines that a line is drawn on.

use crate::scene::OutlineStretch;
use fissure_plane::{Point, Region};

/// An edge that turns away from a drawn line by more than this crosses it and does not run along it: the cosine of 45°.
const LEAST_COSINE: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Ends this near to a corner, in tolerances, are meant to be there.
const CORNER: f64 = 0.5;
/// Stretches shorter than this, in tolerances, are rounding at an end of the line.
const SHORTEST: f64 = 1e-3;

/// The stretches of the rings of `region` that run along `line`: not farther than `tolerance` [m] from it, beside one
/// of its pieces, and turned from that by less than 45°. In the order of the rings, the material to their left.
pub(crate) fn stretches_along(line: &[Point], region: &Region, body: usize, tolerance: f64) -> Vec<OutlineStretch> {
    let mut stretches = Vec::new();
    for ring in region.rings() {
        for i in 0..ring.len() {
            let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
            let length = (b - a).norm();
            let place = |t: f64| if t >= 1.0 { b } else { a + (b - a) * t };
            for [start, end] in united(beside(line, a, b, tolerance)) {
                if (end - start) * length < SHORTEST * tolerance {
                    continue;
                }
                let start = if start * length < CORNER * tolerance { 0.0 } else { start };
                let end = if (1.0 - end) * length < CORNER * tolerance { 1.0 } else { end };
                stretches.push(OutlineStretch { body, from: place(start), to: place(end) });
            }
        }
    }
    stretches
}

/// For each piece of `line` the part of the edge from `a` to `b` beside it, as fractions of the edge.
fn beside(line: &[Point], a: Point, b: Point, tolerance: f64) -> Vec<[f64; 2]> {
    let mut parts = Vec::new();
    let edge = b - a;
    for (k, piece) in line.windows(2).enumerate() {
        let along = piece[1] - piece[0];
        let length = along.norm();
        if along.dot(&edge).abs() < LEAST_COSINE * length * edge.norm() || length == 0.0 {
            continue;
        }
        let direction = along / length;
        let (low, high) = (piece[0].inf(&piece[1]), piece[0].sup(&piece[1]));
        if (a.inf(&b) - high).max() > tolerance || (low - a.sup(&b)).max() > tolerance {
            continue;
        }
        // Outside of a joint of the line there is a gap between what lies beside its two pieces.
        let before = if k == 0 { 0.0 } else { tolerance };
        let after = if k + 2 == line.len() { 0.0 } else { tolerance };
        let across = |v: nalgebra::Vector2<f64>| direction.x * v.y - direction.y * v.x;
        let start = a - piece[0];
        let lengthwise = where_between(direction.dot(&start), direction.dot(&edge), -before, length + after);
        let sideways = where_between(across(start), across(edge), -tolerance, tolerance);
        let part = [lengthwise[0].max(sideways[0]).max(0.0), lengthwise[1].min(sideways[1]).min(1.0)];
        if part[0] < part[1] {
            parts.push(part);
        }
    }
    parts
}

/// For which t `start` + `slope` t lies from `low` to `high`.
fn where_between(start: f64, slope: f64, low: f64, high: f64) -> [f64; 2] {
    if slope == 0.0 {
        let inside = low <= start && start <= high;
        return if inside { [f64::NEG_INFINITY, f64::INFINITY] } else { [f64::INFINITY, f64::NEG_INFINITY] };
    }
    let (s, t) = ((low - start) / slope, (high - start) / slope);
    [s.min(t), s.max(t)]
}

/// Intervals that overlap, united.
fn united(mut parts: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    parts.sort_by(|p, q| p[0].total_cmp(&q[0]));
    let mut whole: Vec<[f64; 2]> = Vec::new();
    for part in parts {
        match whole.last_mut() {
            Some(last) if part[0] <= last[1] => last[1] = last[1].max(part[1]),
            _ => whole.push(part),
        }
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    fn turned(list: &[(f64, f64)], angle: f64, shift: (f64, f64), mirrored: bool) -> Vec<Point> {
        let turn = nalgebra::Rotation2::new(angle);
        let place = |&(x, y): &(f64, f64)| turn * Point::new(if mirrored { -x } else { x }, y);
        list.iter().map(|p| place(p) + nalgebra::Vector2::new(shift.0, shift.1)).collect()
    }

    proptest! {
        /// Truth: the construction. A line from one place of the outline of an L to another, drawn off it by less than
        /// the tolerance, selects the way along the outline between the two, whatever the turn.
        #[test]
        fn a_line_on_the_outline_selects_what_it_is_drawn_on(
            start in 0.1_f64..0.9, end in 0.1_f64..0.9, first in 0_usize..6, corners in 0_usize..4, off in -0.005_f64..0.005,
            angle in -PI..PI, x in -9.0_f64..9.0, mirrored in any::<bool>(), backwards in any::<bool>(),
        ) {
            let outline = [(0.0, 0.0), (4.0, 0.0), (4.0, 2.0), (2.0, 2.0), (2.0, 4.0), (0.0, 4.0)];
            let side = |k: usize, t: f64| {
                let ((a, b), (c, d)) = (outline[k % 6], outline[(k + 1) % 6]);
                (a + t * (c - a), b + t * (d - b))
            };
            let (start, end) = if corners == 0 { (0.5 * start, 0.5 + 0.5 * end) } else { (start, end) };
            let mut line = vec![side(first, start)];
            line.extend((1..=corners).map(|k| outline[(first + k) % 6]));
            line.push(side(first + corners, end));
            let truth: f64 = line.windows(2).map(|w| (w[1].0 - w[0].0).hypot(w[1].1 - w[0].1)).sum();
            // Off to one side.
            line.iter_mut().for_each(|p| *p = (p.0 + off, p.1 + off));
            if backwards { line.reverse(); }
            let exterior = fissure_plane::oriented(turned(&outline, angle, (x, 1.0), mirrored), true);
            let line = turned(&line, angle, (x, 1.0), mirrored);
            let region = Region { exterior, holes: Vec::new() };
            let found = stretches_along(&line, &region, 3, 0.01);
            let length: f64 = found.iter().map(|s| (s.to - s.from).norm()).sum();
            prop_assert!((length - truth).abs() < 0.011, "{} instead of {}", length, truth);
            for s in &found {
                let inward = nalgebra::Rotation2::new(PI / 2.0) * (s.to - s.from).normalize();
                prop_assert!(region.contains(nalgebra::center(&s.from, &s.to) + inward * 1e-6));
            }
        }
    }
}
