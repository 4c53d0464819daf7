//! Rings that touch in a point, parted.
//!
//! Where rings pass a place more than once they do not cross there, but a region whose rings touch has no boundary that
//! could be walked along. Every pass is cut short at one small distance from the place, all by the same: the new edges
//! are chords of a circle around it, and since the passes do not cross, neither do their chords.

use fissure_plane::{Point, nearest_on_segment, orientation};
use std::collections::HashMap;

/// The part of the way to the nearest other corner or edge that a notch may take.
const SHARE: f64 = 0.25;

/// Parts all rings that touch in a corner, each corner by a notch of at most `notch` [m], and takes off corners on
/// straight edges.
pub(super) fn part_touching_rings(shapes: &mut [Vec<Vec<Point>>], notch: f64) {
    let mut passes = HashMap::<_, usize>::new();
    shapes.iter().flatten().flatten().for_each(|p| *passes.entry(key(p)).or_default() += 1);
    let mut pinches: Vec<Point> = shapes.iter().flatten().flatten().filter(|p| passes[&key(p)] > 1).copied().collect();
    pinches.sort_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
    pinches.dedup();
    let radii = radii(&pinches, shapes, notch);
    shapes.iter_mut().flatten().for_each(|ring| *ring = cut_corners(ring, &radii));
}

/// The bits of a place.
fn key(point: &Point) -> (u64, u64) {
    (point.x.to_bits(), point.y.to_bits())
}

/// Radius of the notch at each of the `pinches`, which are sorted by x: at most `notch`, and a part of the way to the
/// nearest corner elsewhere and to the nearest edge that does not end there.
fn radii(pinches: &[Point], shapes: &[Vec<Vec<Point>>], notch: f64) -> HashMap<(u64, u64), f64> {
    let reach = notch / SHARE;
    let mut room = vec![reach; pinches.len()];
    for ring in shapes.iter().flatten() {
        for (i, &a) in ring.iter().enumerate() {
            let b = ring[(i + 1) % ring.len()];
            let (left, right) = (a.x.min(b.x) - reach, a.x.max(b.x) + reach);
            let first = pinches.partition_point(|p| p.x < left);
            for (p, room) in pinches[first..].iter().zip(&mut room[first..]).take_while(|(p, _)| p.x <= right) {
                let near = match (a == *p, b == *p) {
                    (true, _) => b,
                    (_, true) => a,
                    _ => nearest_on_segment(a, b, *p),
                };
                *room = room.min((near - p).norm());
            }
        }
    }
    pinches.iter().zip(room).map(|(p, room)| (key(p), SHARE * room)).collect()
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
