//! Rings that touch in a point, parted.
//!
//! Where rings pass a place more than once they do not cross there, but a region whose rings touch has no boundary that
//! could be walked along. Every pass is cut short at one small distance from the place, all by the same: the new edges are
//! chords of a circle around it, and since the passes do not cross, neither do their chords.

use crate::geometry::{Point, nearest_on_segment, orientation};
use std::collections::HashMap;

/// The part of the way to the nearest other corner or edge that a notch may take.
const SHARE: f64 = 0.25;

/// Parts all rings that touch in a corner, each corner by a notch of at most `notch` [m], and takes off corners on straight edges.
pub(super) fn part_touching_rings(shapes: &mut [Vec<Vec<Point>>], notch: f64) {
    let mut passes = HashMap::<_, usize>::new();
    shapes.iter().flatten().flatten().for_each(|p| *passes.entry(key(p)).or_default() += 1);
    passes.retain(|_, count| *count > 1);
    let mut radii = HashMap::new();
    if !passes.is_empty() {
        let rings: Vec<&Vec<Point>> = shapes.iter().flatten().collect();
        for &p in rings.iter().copied().flatten().filter(|p| passes.contains_key(&key(p))) {
            radii.entry(key(&p)).or_insert_with(|| notch.min(SHARE * room(p, &rings)));
        }
    }
    shapes.iter_mut().flatten().for_each(|ring| *ring = cut_corners(ring, &radii));
}

/// The bits of a place.
fn key(point: &Point) -> (u64, u64) {
    (point.x.to_bits(), point.y.to_bits())
}

/// Distance from `point` to the nearest corner elsewhere and to the nearest edge that does not end in it.
fn room(point: Point, rings: &[&Vec<Point>]) -> f64 {
    let mut room = f64::INFINITY;
    for ring in rings {
        for (i, &a) in ring.iter().enumerate() {
            let b = ring[(i + 1) % ring.len()];
            let near = match (a == point, b == point) {
                (true, _) => b,
                (_, true) => a,
                _ => nearest_on_segment(a, b, point),
            };
            room = room.min((near - point).norm());
        }
    }
    room
}

/// The ring with two corners, each at the radius of the corner, in place of every corner that has one.
///
/// A corner on a straight edge needs no chord: it is left out.
fn cut_corners(ring: &[Point], radii: &HashMap<(u64, u64), f64>) -> Vec<Point> {
    let mut cut = Vec::with_capacity(ring.len() + 2);
    for (i, &p) in ring.iter().enumerate() {
        let (before, after) = (ring[(i + ring.len() - 1) % ring.len()], ring[(i + 1) % ring.len()]);
        if orientation(before, p, after) == 0.0 {
            continue;
        }
        match radii.get(&key(&p)) {
            Some(radius) => cut.extend([before, after].map(|q| p + (q - p) * (radius / (q - p).norm()))),
            None => cut.push(p),
        }
    }
    cut
}
