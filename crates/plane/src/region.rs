//! Regions: a ring with holes.

use crate::{Point, bounds, is_left_of, nearest_on_segment, signed_area};
use serde::{Deserialize, Serialize};

/// A plane region: one outer ring and any number of holes.
///
/// Rings are open (the last point does not repeat the first). The exterior runs counter-clockwise, holes clockwise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Region {
    /// Outer ring, counter-clockwise [m].
    pub exterior: Vec<Point>,
    /// Inner rings, clockwise [m].
    pub holes: Vec<Vec<Point>>,
}

impl Region {
    /// All rings: the exterior first, then the holes.
    pub fn rings(&self) -> impl Iterator<Item = &[Point]> {
        std::iter::once(self.exterior.as_slice()).chain(self.holes.iter().map(Vec::as_slice))
    }

    /// Area enclosed, holes taken off [m²].
    pub fn area(&self) -> f64 {
        self.rings().map(signed_area).sum()
    }

    /// Whether `point` lies inside: to the left of an odd number of edges, decided exactly ([`is_left_of`]).
    ///
    /// A point exactly on an edge belongs to the region on one side only, so abutting regions share no point.
    pub fn contains(&self, point: Point) -> bool {
        let mut inside = false;
        for ring in self.rings() {
            for i in 0..ring.len() {
                inside ^= is_left_of(ring[i], ring[(i + 1) % ring.len()], point);
            }
        }
        inside
    }

    /// Smallest axis-parallel rectangle around the region: (lowest x and y, highest x and y) [m].
    pub fn bounds(&self) -> (Point, Point) {
        bounds(&self.exterior)
    }

    /// The place on the rings nearest to `point`; of several the first. None of a region without rings.
    pub fn nearest(&self, point: Point) -> Option<RingPlace> {
        let mut best: Option<RingPlace> = None;
        for (ring, points) in self.rings().enumerate() {
            for edge in 0..points.len() {
                let on = nearest_on_segment(points[edge], points[(edge + 1) % points.len()], point);
                let distance = (on - point).norm();
                if best.is_none_or(|b| distance < b.distance) {
                    best = Some(RingPlace { ring, edge, point: on, distance });
                }
            }
        }
        best
    }

    /// Distance from `point` to the nearest ring [m]; infinite without rings.
    pub fn distance_to_rings(&self, point: Point) -> f64 {
        self.nearest(point).map_or(f64::INFINITY, |place| place.distance)
    }

    /// Makes `place` a corner of its ring, unless it is one already; the corner is `place.point` to the bit.
    pub fn insert_corner(&mut self, place: &RingPlace) {
        let ring = if place.ring == 0 { &mut self.exterior } else { &mut self.holes[place.ring - 1] };
        if !ring.contains(&place.point) {
            ring.insert(place.edge + 1, place.point);
        }
    }
}

/// A place on a ring of a region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingPlace {
    /// Ring: 0 the exterior, then the holes.
    pub ring: usize,
    /// Edge of the ring, by its first point.
    pub edge: usize,
    /// Where.
    pub point: Point,
    /// Distance from the point asked for.
    pub distance: f64,
}
