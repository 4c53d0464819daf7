//! Seats cracks in their bodies, and guides on crack tips.

use super::split::{Piece, pieces_inside};
use crate::fault::{short, show};
use fissure_plane::{Point, Region, RingPlace, Vector, nearest_on_segment};

/// What is wrong, and the remedy.
pub(crate) type Complaint = (String, String);

/// What comes this near to a ring, in tolerances, touches it: more than rounding, less than anybody draws.
const WELD: f64 = 1e-3;

/// How far mouths that fall together are moved apart, in tolerances: less where something else is as near to the crack.
const PARTS_OF_TOLERANCE: [f64; 4] = [1.0, 0.1, 0.01, 2.0 * WELD];

/// A crack, or a piece of one, with its ends where they belong.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Seated {
    pub(crate) points: Vec<Point>,
    /// Whether the first and the last point lie on the outline.
    pub(crate) mouths: [bool; 2],
    /// Whether the first and the last point lie on another crack.
    pub(crate) junctions: [bool; 2],
    /// Length of the drawn line before it [m].
    pub(crate) from: f64,
}

impl Seated {
    /// Whether the first and the last point lie on the outline or on another crack.
    pub(crate) fn opens(&self) -> [bool; 2] {
        [0, 1].map(|end| self.mouths[end] || self.junctions[end])
    }
}

/// The pieces of a drawn crack in the material of a body, in order: one, or several where it runs across holes or out
/// and in again.
///
/// Ends of the line within `tolerance` [m] of a ring are moved onto it, and each mouth becomes a corner of its ring, so
/// that both are the same point to the bit. Pieces not longer than the tolerance are left out.
pub(crate) fn seat_crack(line: &[Point], region: &mut Region, tolerance: f64) -> Vec<Seated> {
    let mut line = line.to_vec();
    for _ in 0..2 {
        let near = line.first().and_then(|&start| region.nearest(start));
        if let Some(place) = near.filter(|place| place.distance <= tolerance) {
            line[0] = at_corner(region, place, tolerance).point;
        }
        line.reverse();
    }
    let mut pieces: Vec<Seated> = Vec::new();
    for Piece { mut points, mouths, from } in pieces_inside(&line, region, WELD * tolerance, tolerance) {
        for (is_mouth, at) in mouths.into_iter().zip([0, points.len() - 1]) {
            if is_mouth && let Some(place) = region.nearest(points[at]) {
                let place = at_corner(region, RingPlace { point: points[at], ..place }, tolerance);
                region.insert_corner(&place);
                points[at] = place.point;
            }
        }
        if let Some(before) = pieces.last_mut().filter(|before| before.points.last() == points.first()) {
            part_mouths(region, &mut before.points, &mut points, tolerance);
        }
        pieces.push(Seated { points, mouths, junctions: [false; 2], from });
    }
    pieces
}

/// Parts two pieces of a line that only touches a ring, in the corner where the one ends and the next begins: one of
/// them gets a mouth of its own, a little along the edge beside it.
fn part_mouths(region: &mut Region, before: &mut [Point], after: &mut [Point], tolerance: f64) {
    let corner = after[0];
    let found = region.rings().enumerate().find_map(|(r, ring)| Some((r, ring.iter().position(|&p| p == corner)?)));
    let Some((ring, at)) = found else { return };
    let points = if ring == 0 { &mut region.exterior } else { &mut region.holes[ring - 1] };
    let count = points.len();
    let (next, previous) = (points[(at + 1) % count] - corner, points[(at + count - 1) % count] - corner);
    let turn = |from: Vector, to: Vector| {
        (from.x * to.y - from.y * to.x).atan2(from.dot(&to)).rem_euclid(std::f64::consts::TAU)
    };
    let (arm_before, arm_after) = (before[before.len() - 2] - corner, after[1] - corner);
    // The material lies counter-clockwise of the edge after the corner, as far as the one before it: each piece is
    // beside one of them.
    let before_is_first = turn(next, arm_before) < turn(next, arm_after);
    let (first, second) = if before_is_first { (arm_before, arm_after) } else { (arm_after, arm_before) };
    // The smaller angle is below half a turn, so that nothing is in the way.
    let slides_on = turn(next, first) <= turn(second, previous);
    let edge = if slides_on { next } else { previous };
    let moves_before = before_is_first == slides_on;
    let whole = points.clone();
    for part in PARTS_OF_TOLERANCE {
        let mouth = corner + edge * (part * tolerance / edge.norm()).min(0.25);
        let points = if ring == 0 { &mut region.exterior } else { &mut region.holes[ring - 1] };
        points.clone_from(&whole);
        points.insert(if slides_on { at + 1 } else { at }, mouth);
        match before.last_mut() {
            Some(last) if moves_before => *last = mouth,
            _ => after[0] = mouth,
        }
        if crate::validate::leaves(region, if moves_before { before } else { after }).is_none() {
            return;
        }
    }
}

/// Moves ends within `tolerance` of another crack of the same body onto it, and makes each such place a vertex of that
/// crack, so that both are the same point to the bit. `bodies`: of each crack. Ends that meet ends stay as they are
/// drawn.
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

/// The corner of the ring near `place`, if there is one.
fn at_corner(region: &Region, place: RingPlace, tolerance: f64) -> RingPlace {
    let Some(ring) = region.rings().nth(place.ring) else { return place };
    let corner = [place.edge, (place.edge + 1) % ring.len()]
        .into_iter()
        .find(|&k| (ring[k] - place.point).norm() <= WELD * tolerance);
    corner.map_or(place, |k| RingPlace { edge: k, point: ring[k], ..place })
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
pub(crate) fn nearest_on_polyline(line: &[Point], point: Point) -> (usize, Point) {
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
    use crate::load::split::tests as split;
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

    /// Truth: what a crack must be. A line that turns back in a corner of the outline passes a hole by a tenth of what
    /// its mouths are parted by.
    #[test]
    fn mouths_are_parted_beside_holes() {
        let mut region = split::region(0.0, false);
        let line = points(&[(4.5338866253006955, -1.2705009125372981), (-4.0, 3.0), (0.0, -0.5)]);
        let pieces = seat_crack(&line, &mut region, split::SHORTEST);
        assert!(pieces.iter().all(|piece| crate::validate::leaves(&region, &piece.points).is_none()), "{pieces:?}");
        assert!(pieces.windows(2).all(|pair| pair[0].points.last() != pair[1].points.first()), "{pieces:?}");
    }

    /// Truth: the construction. The bar of a T, drawn a little short of the trunk and a little beyond it, ends on a
    /// vertex of the trunk to the bit.
    #[test]
    fn the_bar_of_a_t_ends_on_its_trunk() {
        for short in [0.01, 0.0, -0.01] {
            let seated = |list: &[(f64, f64)]| seat_crack(&points(list), &mut square(), 1e-3).swap_remove(0);
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
        /// Truth: a mouth is a corner of the ring to the bit, the region keeps its area, and what is left of the crack
        /// is inside.
        #[test]
        fn mouths_become_corners(x in 1.5_f64..3.0, y in -0.9_f64..0.9, tip in -0.5_f64..0.5) {
            let mut region = square();
            let seated = seat_crack(&points(&[(x, y), (0.0, tip)]), &mut region, 1e-3).swap_remove(0);
            prop_assert_eq!(seated.mouths, [true, false]);
            prop_assert!(region.exterior.contains(&seated.points[0]));
            prop_assert!((region.area() - 4.0).abs() < 1e-12);
            prop_assert_eq!(seated.points[1], Point::new(0.0, tip));
            prop_assert!(crate::validate::leaves(&region, &seated.points).is_none());
        }

        /// Truth: what a crack must be, as the validation has it. However a line runs over holes, along edges and
        /// through corners, at any turn, each piece is inside with its mouths on corners of the rings, apart from the
        /// others, and the region keeps its area.
        #[test]
        fn pieces_are_sound_cracks(line in prop::collection::vec(split::place(), 2..4), angle in prop_oneof![Just(0.0), -3.0_f64..3.0],
                                   mirrored in any::<bool>()) {
            let mut region = split::region(angle, mirrored);
            let area = region.area();
            let line = split::placed(&line, angle, mirrored);
            prop_assume!(line.windows(2).all(|w| (w[1] - w[0]).norm() > 0.1));
            prop_assume!(fissure_plane::find_crossing(&[&line], false).is_none());
            // Nor does anybody draw a needle as wide as what is moved onto a ring; the validation says where its sides
            // meet.
            let is_needle = |w: &[Point]| {
                let (there, back) = (w[1] - w[0], w[2] - w[1]);
                there.dot(&back) < 0.0 && there.perp(&back).abs() < 0.1 * there.norm() * back.norm()
            };
            prop_assume!(!line.windows(3).any(is_needle));
            let pieces = seat_crack(&line, &mut region, split::SHORTEST);
            prop_assert!((region.area() - area).abs() < 1e-9);
            for (k, piece) in pieces.iter().enumerate() {
                for (end, point) in [piece.points[0], piece.points[piece.points.len() - 1]].iter().enumerate() {
                    prop_assert_eq!(piece.mouths[end], region.rings().any(|ring| ring.contains(point)));
                }
                prop_assert!(crate::validate::leaves(&region, &piece.points).is_none(), "{:?} {:?}", piece, line);
                for other in &pieces[..k] {
                    let meets = other.points.windows(2).any(|v| piece.points.windows(2).any(|w| {
                        fissure_plane::segments_touch(v[0], v[1], w[0], w[1])
                    }));
                    prop_assert!(!meets, "{:?} {:?}", other, piece);
                }
            }
        }
    }
}
