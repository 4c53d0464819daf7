//! What benchmarks time by itself. Not for use: no promise holds here.

use crate::boolean::{material, twice_area};
use crate::slot::Slot;
use crate::snap::GridPoint;
use crate::source::{Carried, SourceEdge};
use fissure_scene::{Point, Vector};

/// Twice the area that `rings` enclose, in squared grid steps: places they wind around at least once count.
pub fn twice_enclosed(rings: &[Vec<[i64; 2]>]) -> i128 {
    let carried = [Carried::within(Point::origin(), Vector::zeros()); 2];
    let mut edges = Vec::new();
    for ring in rings {
        let corners = ring.iter().map(|&[x, y]| GridPoint::new(x, y));
        let next = corners.clone().cycle().skip(1);
        edges.extend(corners.zip(next).map(|(a, b)| SourceEdge { a, b, carried, slot: Slot::Outside }));
    }
    material(&edges).iter().flatten().map(|contour| twice_area(contour)).sum()
}
