//! Paths of cracks, smoothed for the eye: tips that turn a little at every step leave a zigzag as wide as a cell.

use crate::edges::crack_of;
use fissure_plane::{bounds, distance_to_segment, orientation};
use fissure_scene::{BoundaryEdge, BranchKind, CrackFrame, Fragments, Frame, Guide, Line, Point, Scene, Vector};
use std::borrow::Cow;

/// Standard deviation of the weights with which places along a crack are averaged, in cells. A wave of 3.3 cells keeps
/// 16 % of its height, an arc of radius r loses 0.5/r cells of it.
const DEVIATION: f64 = 1.0;
/// How far the average reaches, in standard deviations, and how many places it takes on each side.
const REACH: f64 = 2.5;
const PLACES: usize = 10;
/// Points this near to a drawn line are on it, in cells.
const ON_LINE: f64 = 0.02;
/// The direction of a face at a point is that between its points so far off on both sides, in cells.
const TANGENT: f64 = 0.5;
/// Turns of the two faces against each other between which each begins to be smoothed along its own direction [rad].
const APART: [f64; 2] = [0.05, 0.3];

/// Times that points are held where smooth paths would cross, at most.
const ROUNDS: usize = 8;

/// The cracks of a frame with their faces on smoothed paths.
pub(crate) struct SmoothCracks<'a> {
    /// In the order of the frame; positions at rest as they were.
    pub(crate) cracks: Cow<'a, [CrackFrame]>,
    /// How far each point has been moved, at rest [m].
    pub(crate) offsets: Vec<Vec<Vector>>,
}

impl<'a> SmoothCracks<'a> {
    /// Moves the points of cracks by `tolerance` cells at most; 0 leaves them where they are. Both faces move alike, so
    /// that they still match. What was drawn stays: cracks, and what follows guides; so do tips, ends, and places where
    /// other cracks end or cross.
    pub(crate) fn new(scene: &Scene, frame: &'a Frame, fragments: &Fragments, tolerance: f64) -> Self {
        let none = |crack: &CrackFrame| vec![Vector::zeros(); crack.rest.len()];
        let mut smooth =
            Self { cracks: Cow::Borrowed(&frame.cracks), offsets: frame.cracks.iter().map(none).collect() };
        if tolerance <= 0.0 {
            return smooth;
        }
        let lines = drawn_lines(scene);
        let mut is_crossed: Vec<Vec<bool>> = frame.cracks.iter().map(|c| vec![false; c.rest.len()]).collect();
        let mut hold = |edge: &BoundaryEdge, point: usize| {
            if let Line::Above(crack) | Line::Below(crack) = edge.line {
                is_crossed[crack][point] = true;
            }
        };
        for boundary in fragments.list().iter().flat_map(|fragment| &fragment.boundaries) {
            for (edge, next) in boundary.iter().zip(boundary.iter().cycle().skip(1)) {
                if edge.span != [0.0, 1.0] {
                    edge.points.iter().for_each(|&point| hold(edge, point));
                }
                // What ends on a point of another line.
                if crack_of(edge.line) != crack_of(next.line) {
                    hold(edge, edge.points[1]);
                    hold(next, next.points[0]);
                }
            }
        }
        let fixed = |(crack, is_crossed): (&CrackFrame, Vec<bool>)| {
            let rest = &crack.rest;
            let last = rest.len().saturating_sub(1);
            let near = near(&lines, rest, ON_LINE * scene.cell_size);
            let is_drawn = |p: Point| is_on(&near, p, ON_LINE * scene.cell_size);
            let is_joint = |k: usize| (k > 0 && rest[k - 1] == rest[k]) || (k < last && rest[k + 1] == rest[k]);
            (0..rest.len())
                .map(|k| k == 0 || k == last || is_crossed[k] || is_joint(k) || is_drawn(rest[k]))
                .collect::<Vec<bool>>()
        };
        let mut is_fixed: Vec<Vec<bool>> = frame.cracks.iter().zip(is_crossed).map(fixed).collect();
        let mut changed: Vec<usize> = (0..frame.cracks.len()).collect();
        for _ in 0..ROUNDS {
            for i in changed {
                let moves = is_fixed[i].iter().any(|fixed| !fixed);
                let rest = &frame.cracks[i].rest;
                smooth.offsets[i] = if moves {
                    offsets(rest, &is_fixed[i], scene.cell_size, tolerance * scene.cell_size)
                } else {
                    vec![Vector::zeros(); rest.len()]
                };
            }
            changed = hold_crossings(&frame.cracks, &smooth.offsets, &mut is_fixed);
            if changed.is_empty() {
                break;
            }
        }
        for (i, crack) in frame.cracks.iter().enumerate() {
            if smooth.offsets[i].iter().any(|offset| *offset != Vector::zeros()) {
                move_faces(&mut smooth.cracks.to_mut()[i], crack, &smooth.offsets[i], TANGENT * scene.cell_size);
            }
        }
        smooth
    }
}

/// A segment of a smooth path.
struct PlacedSegment {
    /// Its crack and its first point.
    segment: (usize, usize),
    ends: [Point; 2],
    low: Point,
    high: Point,
    /// Whether it lies elsewhere than at rest.
    moves: bool,
}

impl PlacedSegment {
    fn new((crack, k): (usize, usize), rest: &[Point], offsets: &[Vector]) -> Self {
        let ends = [k, k + 1].map(|k| rest[k] + offsets[k]);
        let (low, high) = bounds(&ends);
        let moves = [k, k + 1].iter().any(|&k| offsets[k] != Vector::zeros());
        Self { segment: (crack, k), ends, low, high, moves }
    }

    /// Whether two go through each other.
    fn crosses(&self, other: &Self) -> bool {
        let ([a, b], [c, d]) = (self.ends, other.ends);
        let overlap = |k: usize| self.low[k] <= other.high[k] && other.low[k] <= self.high[k];
        overlap(0)
            && overlap(1)
            && orientation(a, b, c) * orientation(a, b, d) < 0.0
            && orientation(c, d, a) * orientation(c, d, b) < 0.0
    }
}

/// Holds the points of cracks whose smooth paths cross where their own do not. Returns the cracks that are held more
/// than before.
fn hold_crossings(cracks: &[CrackFrame], offsets: &[Vec<Vector>], is_fixed: &mut [Vec<bool>]) -> Vec<usize> {
    // Along the longer side of it all: those that reach as far as where the next one begins are compared with it.
    let mut placed: Vec<PlacedSegment> = (0..cracks.len())
        .flat_map(|crack| (1..cracks[crack].rest.len()).map(move |k| (crack, k - 1)))
        .map(|(crack, k)| PlacedSegment::new((crack, k), &cracks[crack].rest, &offsets[crack]))
        .collect();
    let corners: Vec<Point> = placed.iter().flat_map(|segment| [segment.low, segment.high]).collect();
    let (low, high) = bounds(&corners);
    let axis = usize::from(high.y - low.y > high.x - low.x);
    placed.sort_by(|a, b| a.low[axis].total_cmp(&b.low[axis]));
    let mut held = Vec::new();
    let mut reaching: Vec<&PlacedSegment> = Vec::new();
    for one in &placed {
        reaching.retain(|other| other.high[axis] >= one.low[axis]);
        for other in reaching.iter().filter(|other| one.moves || other.moves) {
            let ((i, k), (j, l)) = (one.segment, other.segment);
            let beside = i == j && k.abs_diff(l) <= 1;
            if cracks[i].body == cracks[j].body && !beside && one.crosses(other) {
                held.extend([one.segment, other.segment]);
            }
        }
        reaching.push(one);
    }
    let mut changed = Vec::new();
    for (i, k) in held {
        for k in [k, k + 1] {
            if !std::mem::replace(&mut is_fixed[i][k], true) {
                changed.push(i);
            }
        }
    }
    changed.sort_unstable();
    changed.dedup();
    changed
}

/// The points of all drawn cracks and guides [m].
fn drawn_lines(scene: &Scene) -> Vec<&[Point]> {
    fn of_guide<'a>(guide: &'a Guide, lines: &mut Vec<&'a [Point]>) {
        lines.push(&guide.points);
        for branch in &guide.branches {
            if let BranchKind::Begins { guide, .. } = &branch.kind {
                of_guide(guide, lines);
            }
        }
    }
    let mut lines = Vec::new();
    for crack in &scene.cracks {
        lines.push(crack.points.as_slice());
        [&crack.start_guide, &crack.end_guide].into_iter().flatten().for_each(|guide| of_guide(guide, &mut lines));
    }
    lines
}

/// Those of some lines that `points` may lie on, `most` [m] off at most.
fn near<'a>(lines: &[&'a [Point]], points: &[Point], most: f64) -> Vec<&'a [Point]> {
    let (low, high) = bounds(points);
    let is_near = |line: &&&[Point]| {
        let (from, to) = bounds(line);
        let beside = |k: usize| from[k] - 1.01 * most <= high[k] && low[k] <= to[k] + 1.01 * most;
        beside(0) && beside(1)
    };
    lines.iter().filter(is_near).copied().collect()
}

/// Whether a point lies on one of some lines, `most` [m] off at most.
fn is_on(lines: &[&[Point]], point: Point, most: f64) -> bool {
    // Cheaper than distances, with room for rounding.
    let is_near = |a: Point, b: Point| {
        let beside = |p: f64, a: f64, b: f64| p >= a.min(b) - 1.01 * most && p <= a.max(b) + 1.01 * most;
        beside(point.x, a.x, b.x) && beside(point.y, a.y, b.y)
    };
    let mut segments = lines.iter().flat_map(|line| line.windows(2));
    segments.any(|w| is_near(w[0], w[1]) && distance_to_segment(point, w[0], w[1]) <= most)
}

/// From each point to the weighted mean of the path around it, `most` [m] long at most. The mean reaches as far to both
/// sides as the nearest point that stays, so straight paths stay as they are and no corner comes about there.
fn offsets(rest: &[Point], is_fixed: &[bool], cell_size: f64, most: f64) -> Vec<Vector> {
    let mut arcs = vec![0.0; rest.len()];
    for i in 1..rest.len() {
        arcs[i] = arcs[i - 1] + (rest[i] - rest[i - 1]).norm();
    }
    // `near` is a point of which the place at `arc` is not far.
    let along = |arc: f64, near: &mut usize| {
        while *near > 0 && arcs[*near - 1] >= arc {
            *near -= 1;
        }
        while *near < arcs.len() && arcs[*near] < arc {
            *near += 1;
        }
        let next = (*near).clamp(1, rest.len() - 1);
        let length = arcs[next] - arcs[next - 1];
        let part = if length > 0.0 { (arc - arcs[next - 1]) / length } else { 0.0 };
        rest[next - 1] + part * (rest[next] - rest[next - 1])
    };
    let weights: [f64; PLACES] = std::array::from_fn(|k| {
        let deviations = REACH * (k + 1) as f64 / PLACES as f64;
        (-0.5 * deviations * deviations).exp()
    });
    let whole = 1.0 + 2.0 * weights.iter().sum::<f64>();
    let mut room = vec![REACH * DEVIATION * cell_size; rest.len()];
    let mut before = f64::NEG_INFINITY;
    for i in 0..rest.len() {
        before = if is_fixed[i] { arcs[i] } else { before };
        room[i] = room[i].min(arcs[i] - before);
    }
    let mut after = f64::INFINITY;
    for i in (0..rest.len()).rev() {
        after = if is_fixed[i] { arcs[i] } else { after };
        room[i] = room[i].min(after - arcs[i]);
    }
    (0..rest.len())
        .map(|i| {
            let mut near = [i; 2];
            let way = |(k, weight): (usize, &f64)| {
                let step = room[i] * (k + 1) as f64 / PLACES as f64;
                let [back, forth] = &mut near;
                *weight * ((along(arcs[i] - step, back) - rest[i]) + (along(arcs[i] + step, forth) - rest[i]))
            };
            let offset = weights.iter().enumerate().map(way).sum::<Vector>() / whole;
            if room[i] > 0.0 { offset.cap_magnitude(most) } else { Vector::zeros() }
        })
        .collect()
}

/// Moves both faces of a crack by `offsets`, turned and stretched as the faces are within `reach` [m] of each point.
fn move_faces(moved: &mut CrackFrame, crack: &CrackFrame, offsets: &[Vector], reach: f64) {
    let rest = &crack.rest;
    let last = rest.len().saturating_sub(1);
    for i in 1..last {
        if offsets[i] == Vector::zeros() {
            continue;
        }
        let is_near = |k: &usize| (rest[*k] - rest[i]).norm() < reach;
        let first = (1..i).rev().find(|k| !is_near(k)).unwrap_or(0);
        let next = (i + 1..last).find(|k| !is_near(k)).unwrap_or(last);
        let along = |points: &[Point]| points[next] - points[first];
        let [above, below] = [&crack.above, &crack.below].map(|face| turned(along(face), along(rest)));
        let mean = 0.5 * (above + below);
        // Faces that hardly turn against each other move by the very same, so that no crack opens or closes by it.
        let apart = (((above - below).norm() - APART[0]) / (APART[1] - APART[0])).clamp(0.0, 1.0);
        for (points, own) in [(&mut moved.above, above), (&mut moved.below, below)] {
            let way = mean + apart * (own - mean);
            let limited = way.cap_magnitude(2.0);
            points[i] += Vector::new(
                limited.x * offsets[i].x - limited.y * offsets[i].y,
                limited.y * offsets[i].x + limited.x * offsets[i].y,
            );
        }
    }
}

/// The turn and stretch that makes `now` of `rest`, as the complex number now/rest; 1 where `rest` has no length.
fn turned(now: Vector, rest: Vector) -> Vector {
    let square = rest.norm_squared();
    if square > 0.0 { Vector::new(now.dot(&rest), rest.perp(&now)) / square } else { Vector::x() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: closed form. A zigzag of 3.3 cells on a circle of radius 50 cells keeps 16 % of its height (the transform
    /// of the weights), the circle its radius to 0.5/50 cells; ends and fixed points stay, and nothing moves by more
    /// than allowed.
    #[test]
    fn zigzags_go_and_arcs_stay() {
        let (radius, height, wave) = (50.0, 0.14, 3.3);
        let place = |k: usize| {
            let arc = 0.25 * k as f64;
            let out = radius + height * (std::f64::consts::TAU * arc / wave).cos();
            Point::new(out * (arc / radius).cos(), out * (arc / radius).sin())
        };
        let rest: Vec<Point> = (0..400).map(place).collect();
        let is_fixed: Vec<bool> = (0..400).map(|k| k == 0 || k == 200 || k == 399).collect();
        let moved = offsets(&rest, &is_fixed, 1.0, 0.5);
        let out = |k: usize| (rest[k] + moved[k]).coords.norm() - radius;
        let all: Vec<f64> = (15..185).chain(215..385).map(out).collect();
        let (low, high) = all.iter().fold((1.0_f64, -1.0_f64), |(low, high), x| (low.min(*x), high.max(*x)));
        let kept = (high - low) / (2.0 * height);
        assert!((0.10..0.22).contains(&kept), "{kept}");
        assert!((0.5 * (high + low)).abs() < 0.02, "{low} {high}");
        assert!([0, 200, 399].iter().all(|&k| moved[k] == Vector::zeros()));
        let limited = offsets(&rest, &is_fixed, 1.0, 0.05);
        assert!(limited.iter().all(|v| v.norm() <= 0.05 + 1e-12) && limited.iter().any(|v| v.norm() > 0.049));
    }

    /// Truth: the drawing. A path that follows a guide has points anywhere on it, not only at its corners.
    #[test]
    fn all_of_a_guided_path_is_drawn() {
        let guide = [Point::new(0.0, 0.0), Point::new(1.0, 1.0), Point::new(0.0, 2.0)];
        for k in 0..=40 {
            let arc = 0.05 * f64::from(k);
            let on = Point::new(1.0 - (1.0 - arc).abs(), arc);
            assert!(is_on(&[&guide], on, 1e-9) && !is_on(&[&guide], on + Vector::new(0.1, 0.0), 0.05), "{on}");
            let elsewhere = guide.map(|p| p + Vector::new(3.0, 0.0));
            assert_eq!(near(&[&elsewhere, &guide], &[on], 1e-9), [&guide[..]], "{on}");
        }
        assert!(!is_on(&[], guide[0], 1.0));
    }

    /// Truth: a rigid motion of each face moves its smoothed path along, and faces that touch still do.
    #[test]
    fn both_faces_move_alike() {
        let rest: Vec<Point> = (0..40).map(|k| Point::new(f64::from(k), f64::from(k % 2))).collect();
        let turn = nalgebra::Rotation2::new(1.2);
        let face = |shift: Vector| rest.iter().map(|p| turn * p + shift).collect::<Vec<Point>>();
        let (above, below) = (face(Vector::new(3.0, 1.0)), face(Vector::new(3.0, 1.0)));
        let crack = CrackFrame { rest: rest.clone(), above, below, ..CrackFrame::default() };
        let is_fixed: Vec<bool> = (0..40).map(|k| k == 0 || k == 39).collect();
        let offsets = offsets(&rest, &is_fixed, 1.0, 0.5);
        let mut moved = crack.clone();
        move_faces(&mut moved, &crack, &offsets, 0.5);
        assert_eq!(moved.above, moved.below);
        for ((now, rest), offset) in moved.above.iter().zip(&rest).zip(&offsets) {
            assert!((now - (turn * (rest + offset) + Vector::new(3.0, 1.0))).norm() < 1e-12);
        }
    }
}
