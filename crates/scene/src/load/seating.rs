//! Seats cracks in their bodies, and guides on crack tips.

use crate::fault::{short, show};
use crate::geometry::{Point, Region, nearest_on_segment};
use crate::outline::{RingPlace, insert_corner, nearest_on_rings};

/// What is wrong, and the remedy.
pub(crate) type Complaint = (String, String);

/// A crack with its ends where they belong.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Seated {
    pub(crate) points: Vec<Point>,
    /// Whether the first and the last point lie on the outline.
    pub(crate) mouths: [bool; 2],
    /// Whether the first and the last point lie on another crack.
    pub(crate) junctions: [bool; 2],
}

/// Cuts off what sticks out of the body at the ends, moves ends within `tolerance` of a ring onto it, and makes each
/// such mouth a corner of its ring, so that both are the same point to the bit.
pub(crate) fn seat_crack(points: &[Point], region: &mut Region, tolerance: f64) -> Result<Seated, Complaint> {
    let mut points = points.to_vec();
    let mut mouths = [false; 2];
    for mouth in &mut mouths {
        if let Some(place) = seat_start(&mut points, region, tolerance)? {
            insert_corner(region, &place);
            *mouth = true;
        }
        points.reverse();
    }
    Ok(Seated { points, mouths, junctions: [false; 2] })
}

/// Moves ends within `tolerance` of another crack of the same body onto it, and makes each such place a vertex of that crack, so that both are the same
/// point to the bit. `bodies`: of each crack. Ends that meet ends stay as they are drawn.
pub(crate) fn seat_on_cracks(cracks: &mut [Seated], bodies: &[usize], tolerance: f64) {
    for guest in 0..cracks.len() {
        for end in 0..2 {
            let Some(&point) = [cracks[guest].points.first(), cracks[guest].points.last()][end] else { continue };
            if cracks[guest].mouths[end] {
                continue;
            }
            let others = (0..cracks.len()).filter(|&other| other != guest && bodies[other] == bodies[guest]);
            let places = others.map(|other| {
                let (piece, place) = nearest_on_polyline(&cracks[other].points, point);
                ((place - point).norm(), other, piece, place)
            });
            let Some((distance, trunk, piece, mut place)) = places.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
            let line = &mut cracks[trunk].points;
            let is_near = |p: &Point, reach: f64| (p - place).norm() <= reach;
            let (first, last) = (line[0], line[line.len() - 1]);
            if distance > tolerance || is_near(&first, tolerance) || is_near(&last, tolerance) {
                continue;
            }
            match [piece, piece + 1].into_iter().find(|&k| is_near(&line[k], tolerance * 1e-3)) {
                Some(vertex) => place = line[vertex],
                None => line.insert(piece + 1, place),
            }
            let own = &mut cracks[guest];
            let at = if end == 0 { 0 } else { own.points.len() - 1 };
            own.points[at] = place;
            own.junctions[end] = true;
        }
    }
}

/// Seats the first point; returns the mouth if it lies on a ring.
fn seat_start(points: &mut Vec<Point>, region: &Region, tolerance: f64) -> Result<Option<RingPlace>, Complaint> {
    let Some(&start) = points.first() else { return Ok(None) };
    let Some(nearest) = nearest_on_rings(region, start) else { return Ok(None) };
    if nearest.distance <= tolerance {
        let place = at_corner(region, nearest, tolerance);
        points[0] = place.point;
        return Ok(Some(place));
    }
    if region.contains(start) {
        return Ok(None);
    }
    let (piece, place) = first_entry(points, region).ok_or_else(|| {
        (
            format!("it lies outside, {} m from the outline at {} m", short(nearest.distance), show(start)),
            "move it into the body".to_owned(),
        )
    })?;
    let place = at_corner(region, place, tolerance);
    points.drain(..=piece);
    points.insert(0, place.point);
    // The rest of the piece that was cut may be shorter than can be told apart.
    while points.len() > 2 && (points[1] - points[0]).norm() <= tolerance * 1e-3 {
        points.remove(1);
    }
    Ok(Some(place))
}

/// The corner of the ring near `place`, if there is one.
fn at_corner(region: &Region, place: RingPlace, tolerance: f64) -> RingPlace {
    let Some(ring) = region.rings().nth(place.ring) else { return place };
    let corner = [place.edge, (place.edge + 1) % ring.len()]
        .into_iter()
        .find(|&k| (ring[k] - place.point).norm() <= tolerance * 1e-3);
    corner.map_or(place, |k| RingPlace { edge: k, point: ring[k], ..place })
}

/// Where a polyline that starts outside first meets a ring: the piece, and the place.
fn first_entry(points: &[Point], region: &Region) -> Option<(usize, RingPlace)> {
    points.windows(2).enumerate().find_map(|(piece, w)| {
        let mut first: Option<(f64, RingPlace)> = None;
        for (ring, corners) in region.rings().enumerate() {
            for edge in 0..corners.len() {
                let (a, b) = (corners[edge], corners[(edge + 1) % corners.len()]);
                let (d, g, u) = (w[1] - w[0], b - a, a - w[0]);
                let determinant = d.x * g.y - d.y * g.x;
                let (t, s) = ((u.x * g.y - u.y * g.x) / determinant, (u.x * d.y - u.y * d.x) / determinant);
                let meets = (0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&s);
                if meets && first.is_none_or(|(nearest, _)| t < nearest) {
                    first = Some((t, RingPlace { ring, edge, point: a + g * s, distance: 0.0 }));
                }
            }
        }
        first.map(|(_, place)| (piece, place))
    })
}

/// The part of a guide ahead of a crack tip, beginning exactly at the tip.
///
/// The guide may begin at the tip, or run along the crack first; it may be drawn in either direction.
/// `tolerance`: how far from the crack it may be drawn [m].
pub(crate) fn fit_guide(guide: &[Point], tip: Point, crack: &[Point], tolerance: f64) -> Result<Vec<Point>, Complaint> {
    let backwards: Vec<Point> = guide.iter().rev().copied().collect();
    let forwards = ahead_of_tip(guide, tip, crack, tolerance);
    let ahead = forwards.or_else(|complaint| ahead_of_tip(&backwards, tip, crack, tolerance).map_err(|_| complaint))?;
    if ahead.len() < 2 {
        let message = format!("it ends at the tip {} m", show(tip));
        return Err((message, "draw it on from the tip".into()));
    }
    Ok(ahead)
}

fn ahead_of_tip(guide: &[Point], tip: Point, crack: &[Point], tolerance: f64) -> Result<Vec<Point>, Complaint> {
    let (piece, nearest) = nearest_on_polyline(guide, tip);
    let distance = (nearest - tip).norm();
    let start = guide.first().copied().unwrap_or(tip);
    if distance.is_nan() || distance > tolerance {
        let message = format!(
            "it does not start at the tip {} m: its first point {} m is {} m away, and it comes no nearer than {} m",
            show(tip),
            show(start),
            short((start - tip).norm()),
            short(distance)
        );
        return Err((message, "move its first point to the tip, or draw it along the crack".into()));
    }
    let starts_at_tip = (start - tip).norm() <= tolerance;
    let behind = guide[..=piece].iter().map(|&p| (p, (nearest_on_polyline(crack, p).1 - p).norm()));
    if !starts_at_tip && let Some((p, off)) = behind.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|b| b.1 > tolerance) {
        let message = format!(
            "it does not start at the tip {} m but {} m before it, and leaves the crack by {} m at {} m",
            show(tip),
            short((start - tip).norm()),
            short(off),
            show(p)
        );
        return Err((message, "start it at the tip, or draw it along the crack".into()));
    }
    let mut ahead = vec![tip];
    // Points nearer to the tip than a tenth of the tolerance would only make a kink of it.
    ahead.extend(guide[piece + 1..].iter().copied().skip_while(|p| (p - tip).norm() <= 0.1 * tolerance));
    Ok(ahead)
}

/// The piece of a polyline that is nearest to `point` (the first of several), and the place on it.
fn nearest_on_polyline(line: &[Point], point: Point) -> (usize, Point) {
    let mut best = (0, line.first().copied().unwrap_or(point));
    for (piece, w) in line.windows(2).enumerate() {
        let on = nearest_on_segment(w[0], w[1], point);
        if (on - point).norm() < (best.1 - point).norm() {
            best = (piece, on);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;

    fn points(list: &[(f64, f64)]) -> Vec<Point> {
        list.iter().map(|&(x, y)| Point::new(x, y)).collect()
    }

    fn square() -> Region {
        Region { exterior: points(&[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]), holes: vec![] }
    }

    #[test]
    fn a_guide_along_the_crack_is_cut_at_the_tip_in_either_direction() {
        let crack = points(&[(-1.0, 0.0), (0.0, 0.0)]);
        let tip = crack[1];
        let ahead = points(&[(0.0, 0.0), (0.5, 0.2), (1.0, 0.0)]);
        let along = points(&[(-1.0, 0.0), (-0.5, 0.0), (0.0, 0.005), (0.5, 0.2), (1.0, 0.0)]);
        let mut backwards = along.clone();
        backwards.reverse();
        for guide in [&ahead, &along, &backwards] {
            assert_eq!(fit_guide(guide, tip, &crack, 0.01).unwrap()[..1], [tip]);
            assert_eq!(fit_guide(guide, tip, &crack, 0.02).unwrap().last(), Some(&Point::new(1.0, 0.0)));
        }
        assert_eq!(fit_guide(&ahead, tip, &crack, 0.01).unwrap(), ahead);
        assert!(fit_guide(&points(&[(0.3, 0.0), (1.0, 0.0)]), tip, &crack, 0.01).unwrap_err().0.contains("0.3 m away"));
        assert!(fit_guide(&points(&[(-1.0, 0.5), (0.0, 0.0), (1.0, 0.0)]), tip, &crack, 0.01).is_err());
        assert!(
            fit_guide(&points(&[(-0.5, 0.0), (0.0, 0.0)]), tip, &crack, 0.01)
                .unwrap_err()
                .0
                .contains("ends at the tip")
        );
    }

    /// Truth: the construction. The bar of a T, drawn a little short of the trunk and a little beyond it, ends on a vertex of the trunk to the bit.
    #[test]
    fn the_bar_of_a_t_ends_on_its_trunk() {
        for short in [0.01, 0.0, -0.01] {
            let seated = |list: &[(f64, f64)]| seat_crack(&points(list), &mut square(), 1e-3).unwrap();
            let mut cracks = [seated(&[(-0.5, short), (-0.5, 0.7)]), seated(&[(-0.8, 0.0), (0.8, 0.0)])];
            seat_on_cracks(&mut cracks, &[0, 0], 0.02);
            assert_eq!((cracks[0].junctions, cracks[1].junctions), ([true, false], [false, false]));
            assert_eq!(cracks[1].points, points(&[(-0.8, 0.0), (-0.5, 0.0), (0.8, 0.0)]));
            assert_eq!(cracks[0].points[0], cracks[1].points[1]);
            // In another body, or end to end, there is nothing to end on.
            let mut apart = [seated(&[(-0.5, short), (-0.5, 0.7)]), seated(&[(-0.8, 0.0), (0.8, 0.0)])];
            seat_on_cracks(&mut apart, &[0, 1], 0.02);
            let mut ends = [seated(&[(-0.79, short), (-0.5, 0.7)]), seated(&[(-0.8, 0.0), (0.8, 0.0)])];
            seat_on_cracks(&mut ends, &[0, 0], 0.02);
            assert!(apart.iter().chain(&ends).all(|crack| crack.junctions == [false; 2]));
        }
    }

    proptest! {
        /// Truth: a mouth is a corner of the ring to the bit, the region keeps its area, and what is left of the crack is inside.
        #[test]
        fn mouths_become_corners(x in 1.5_f64..3.0, y in -0.9_f64..0.9, tip in -0.5_f64..0.5) {
            let mut region = square();
            let seated = seat_crack(&points(&[(x, y), (0.0, tip)]), &mut region, 1e-3).unwrap();
            prop_assert_eq!(seated.mouths, [true, false]);
            prop_assert!(region.exterior.contains(&seated.points[0]));
            prop_assert!((region.area() - 4.0).abs() < 1e-12);
            prop_assert_eq!(seated.points[1], Point::new(0.0, tip));
            prop_assert!(crate::validate::leaves(&region, &seated.points).is_none());
        }
    }
}
