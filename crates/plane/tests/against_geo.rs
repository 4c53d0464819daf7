//! Our own predicates, distances, areas and crossings against those of the crate `geo`, on coordinates that meet often:
//! a coarse lattice, turned and scaled so that most of them are rounded.

use fissure_plane::{
    Point, Region, clean_ring, distance_to_segment, find_crossing, nearest_on_segment, oriented, segment_distance,
    segments_touch, signed_area,
};
use geo::algorithm::Validation;
use geo::coordinate_position::{CoordPos, CoordinatePosition};
use geo::{Area, Closest, ClosestPoint, Coord, Distance, Euclidean, Intersects, Line, LineString, Polygon};
use proptest::prelude::*;

/// Places of a lattice of 9 by 9 with a spacing that no binary number has.
fn lattice(count: impl Into<prop::collection::SizeRange>) -> impl Strategy<Value = Vec<Point>> {
    let places = prop::collection::vec((0..9_i32, 0..9_i32), count);
    places.prop_map(|places| places.into_iter().map(|(x, y)| place(x, y)).collect())
}

fn place(x: i32, y: i32) -> Point {
    Point::new(0.1 * f64::from(x), 0.3 * f64::from(y))
}

/// Rings around a place within them, so that they do not cross themselves.
fn star() -> impl Strategy<Value = Vec<Point>> {
    lattice(3..10).prop_filter_map("no area", |mut ring| {
        let center = Point::new(0.4137, 1.2219);
        let angle = |p: &Point| (p.y - center.y).atan2(p.x - center.x);
        ring.sort_by(|p, q| angle(p).total_cmp(&angle(q)));
        ring.dedup_by(|p, q| (angle(p) - angle(q)).abs() < 1e-9);
        let is_around = (0..ring.len()).all(|i| {
            let (p, q) = (ring[i] - center, ring[(i + 1) % ring.len()] - center);
            p.perp(&q) > 0.0
        });
        (ring.len() > 2 && is_around).then_some(ring)
    })
}

fn coord(p: Point) -> Coord {
    Coord { x: p.x, y: p.y }
}

fn line_string(ring: &[Point]) -> LineString {
    ring.iter().chain(ring.first()).map(|&p| coord(p)).collect()
}

fn polygon(region: &Region) -> Polygon {
    Polygon::new(line_string(&region.exterior), region.holes.iter().map(|hole| line_string(hole)).collect())
}

/// The ring drawn towards a place in it.
fn shrunk(ring: &[Point], size: f64) -> Vec<Point> {
    let center = Point::new(0.4137, 1.2219);
    ring.iter().map(|p| center + (p - center) * size).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, max_global_rejects: 20_000, failure_persistence: None, ..ProptestConfig::default() })]

    /// A point on an edge may belong to either side here; `geo` tells it apart.
    #[test]
    fn areas_and_containment(exterior in star(), size in 0.1..0.9_f64, points in lattice(20)) {
        let hole = oriented(shrunk(&exterior, size), false);
        let region = Region { exterior, holes: vec![hole] };
        let polygon = polygon(&region);
        prop_assert!((region.area() - polygon.unsigned_area()).abs() <= 1e-14 * polygon.unsigned_area().max(1.0));
        for point in points {
            match polygon.coordinate_position(&coord(point)) {
                CoordPos::Inside => prop_assert!(region.contains(point), "{}", point),
                CoordPos::Outside => prop_assert!(!region.contains(point), "{}", point),
                CoordPos::OnBoundary => {}
            }
        }
    }

    /// Of two regions that abut, one has a point on the edge between them, and only one.
    #[test]
    fn abutting_regions_share_no_point(ring in star(), at in any::<prop::sample::Index>(), points in lattice(20)) {
        prop_assume!(ring.len() > 3);
        let at = 2 + at.index(ring.len() - 3);
        let part = |points: &[Point]| Region { exterior: points.to_vec(), holes: Vec::new() };
        let whole = part(&ring);
        let (one, other) = (part(&ring[..=at]), part(&[&ring[at..], &ring[..1]].concat()));
        // The cut has to run within the ring.
        prop_assume!([&one, &other].iter().all(|part| part.area() > 0.0 && find_crossing(&[&part.exterior], true).is_none()));
        for point in points {
            let count = usize::from(one.contains(point)) + usize::from(other.contains(point));
            prop_assert_eq!(count, usize::from(whole.contains(point)), "{}", point);
        }
    }

    #[test]
    fn segments(ends in lattice(4)) {
        let [a, b, c, d] = [ends[0], ends[1], ends[2], ends[3]];
        let (one, other) = (Line::new(coord(a), coord(b)), Line::new(coord(c), coord(d)));
        prop_assert_eq!(segments_touch(a, b, c, d), one.intersects(&other));
        prop_assert!(segment_distance(a, b, c, d) == 0.0 || !one.intersects(&other));
        prop_assert!((segment_distance(a, b, c, d) - Euclidean.distance(&one, &other)).abs() < 1e-14);
        let point = geo::Point::from(coord(c));
        prop_assert!((distance_to_segment(c, a, b) - Euclidean.distance(&one, &point)).abs() < 1e-14);
        prop_assume!(a != b);
        let nearest = match one.closest_point(&point) {
            Closest::Intersection(p) | Closest::SinglePoint(p) => Point::new(p.x(), p.y()),
            Closest::Indeterminate => return Err(TestCaseError::fail("no closest point")),
        };
        prop_assert!((nearest_on_segment(a, b, c) - nearest).norm() < 1e-14);
    }

    /// A ring that crosses or touches itself anywhere is not valid, any other is.
    #[test]
    fn rings_that_cross_themselves(points in lattice(3..8)) {
        let ring = clean_ring(&points, 0.0);
        prop_assume!(ring.len() > 2 && signed_area(&ring) != 0.0);
        let is_valid = Polygon::new(line_string(&ring), Vec::new()).is_valid();
        prop_assert_eq!(find_crossing(&[&ring], true).is_none(), is_valid, "{:?}", ring);
    }
}
