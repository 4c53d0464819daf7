//! Cracks with fewer points: tips go on by a quarter of a cell at a time, and walls show no more than the cells do.

use crate::smooth::SmoothCracks;
use fissure_plane::distance_to_segment;
use fissure_scene::{CrackEnd, CrackFrame, Fragments, Frame, Line, Point, Scene};
use std::borrow::Cow;
use std::collections::HashSet;

/// What is left out lies this near to what is left, in steps.
const MOST_OFF: f64 = 0.04;
/// Within so many steps of a tip all points stay: there the faces of a crack part.
const AT_TIP: f64 = 2.0;

/// For each crack of a frame the points that stay, in order: about one `step` [m] from each other at rest at most,
/// nearer where the path is bent, and all that something depends on: ends, corners that were drawn, places where cracks
/// end or cross.
///
/// They depend on what is at rest alone, so that they stay as they are until a crack grows; and they are counted from
/// where the crack was drawn, so that those along it stay while it grows at both ends.
pub(crate) fn kept_points(
    scene: &Scene,
    frame: &Frame,
    fragments: &Fragments,
    smooth: &SmoothCracks<'_>,
    step: f64,
) -> Vec<Vec<usize>> {
    let bits = |p: Point| [p.x + 0.0, p.y + 0.0].map(f64::to_bits);
    let ends = frame.cracks.iter().flat_map(|c| c.rest.first().into_iter().chain(c.rest.last()));
    let mut needed: HashSet<[u64; 2]> = ends.map(|&p| bits(p)).collect();
    needed.extend(scene.cracks.iter().flat_map(|c| &c.points).map(|&p| bits(p)));
    let mut is_crossed: Vec<HashSet<usize>> = vec![HashSet::new(); frame.cracks.len()];
    for edge in fragments.list().iter().flat_map(|f| f.boundaries.iter().flatten()) {
        if let (Line::Above(crack) | Line::Below(crack), true) = (edge.line, edge.span != [0.0, 1.0]) {
            is_crossed[crack].extend(edge.points);
        }
    }
    let kept = |(i, crack): (usize, &CrackFrame)| {
        let rest = &crack.rest;
        let path: Vec<Point> = rest.iter().zip(&smooth.offsets[i]).map(|(p, offset)| p + offset).collect();
        let last = rest.len().saturating_sub(1);
        let mut arcs = vec![0.0; rest.len()];
        for k in 1..rest.len() {
            arcs[k] = arcs[k - 1] + (rest[k] - rest[k - 1]).norm();
        }
        let is_at_tip = |k: usize| {
            (crack.start == CrackEnd::Tip && arcs[k] < AT_TIP * step)
                || (crack.end == CrackEnd::Tip && arcs[last] - arcs[k] < AT_TIP * step)
        };
        let is_joint = |k: usize| (k > 0 && rest[k - 1] == rest[k]) || (k < last && rest[k + 1] == rest[k]);
        let is_needed =
            |k: usize| is_crossed[i].contains(&k) || is_joint(k) || is_at_tip(k) || needed.contains(&bits(rest[k]));
        let drawn = scene.cracks.get(crack.crack as usize).and_then(|c| c.points.first());
        let begin = drawn.and_then(|first| rest.iter().position(|p| p == first)).unwrap_or(0);
        let mut kept = vec![begin];
        let along = |order: &mut dyn Iterator<Item = usize>, kept: &mut Vec<usize>| {
            let (mut from, mut before) = (begin, begin);
            for k in order {
                let (low, high) = (from.min(k), from.max(k));
                let is_straight =
                    || (low + 1..high).all(|m| distance_to_segment(path[m], path[low], path[high]) <= MOST_OFF * step);
                // What can go on no further ends before this point.
                if before != from && ((arcs[k] - arcs[from]).abs() > step * 1.001 || !is_straight()) {
                    kept.push(before);
                    from = before;
                }
                if k == 0 || k == last || is_needed(k) {
                    kept.push(k);
                    from = k;
                }
                before = k;
            }
        };
        along(&mut (begin + 1..=last), &mut kept);
        along(&mut (0..begin).rev(), &mut kept);
        kept.sort_unstable();
        kept.dedup();
        kept
    };
    frame.cracks.iter().enumerate().map(kept).collect()
}

/// The lines of a frame, without its particles, and its smooth cracks, with the points that are kept.
pub(crate) fn thinned<'a>(frame: &Frame, smooth: &SmoothCracks<'_>, kept: &[Vec<usize>]) -> (Frame, SmoothCracks<'a>) {
    let subset = |cracks: &[CrackFrame]| cracks.iter().zip(kept).map(|(crack, kept)| of_crack(crack, kept)).collect();
    let lines = Frame {
        number: frame.number,
        time: frame.time,
        outlines: frame.outlines.clone(),
        cracks: subset(&frame.cracks),
        ..Frame::default()
    };
    let offsets = smooth.offsets.iter().zip(kept).map(|(offsets, kept)| picked(offsets, kept)).collect();
    (lines, SmoothCracks { cracks: Cow::Owned(subset(&smooth.cracks)), offsets })
}

fn of_crack(crack: &CrackFrame, kept: &[usize]) -> CrackFrame {
    CrackFrame {
        rest: picked(&crack.rest, kept),
        above: picked(&crack.above, kept),
        below: picked(&crack.below, kept),
        above_velocity: picked(&crack.above_velocity, kept),
        below_velocity: picked(&crack.below_velocity, kept),
        formed: crack.formed.as_ref().map(|formed| picked(formed, kept)),
        ..*crack
    }
}

/// Those of `all` that are kept.
pub(crate) fn picked<T: Copy>(all: &[T], kept: &[usize]) -> Vec<T> {
    kept.iter().map(|&k| all[k]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::{scene, square};
    use fissure_scene::Vector;

    const CELL: f64 = 1.0;

    /// A crack along an arc of radius 40 cells, from `from` to `to` [rad], in steps of an eighth of a cell.
    fn arc(from: i32, to: i32, start: CrackEnd) -> CrackFrame {
        let at =
            |k: i32| Point::from(40.0 * CELL * Vector::new((f64::from(k) / 320.0).sin(), (f64::from(k) / 320.0).cos()));
        let rest: Vec<Point> = (from..=to).map(at).collect();
        let zeros = vec![Vector::zeros(); rest.len()];
        CrackFrame {
            above: rest.clone(),
            below: rest.clone(),
            above_velocity: zeros.clone(),
            below_velocity: zeros,
            rest,
            start,
            ..CrackFrame::default()
        }
    }

    fn kept(cracks: Vec<CrackFrame>, step: f64) -> Vec<Vec<Point>> {
        let mut scene = scene(square(200.0));
        scene.cell_size = CELL;
        let drawn = cracks[0].rest.iter().position(|p| p.x == 0.0).unwrap_or(0);
        scene.cracks = vec![fissure_scene::Crack { points: vec![cracks[0].rest[drawn]], ..crack() }];
        let frame = Frame { cracks, ..Frame::default() };
        let fragments = Fragments::of_frame(&frame);
        let smooth = SmoothCracks::new(&scene, &frame, &fragments, 0.0);
        let kept = kept_points(&scene, &frame, &fragments, &smooth, step);
        frame.cracks.iter().zip(&kept).map(|(crack, kept)| picked(&crack.rest, kept)).collect()
    }

    /// A drawn crack; its points are replaced.
    fn crack() -> fissure_scene::Crack {
        fissure_scene::Crack {
            name: "arc".to_owned(),
            body: 0,
            points: Vec::new(),
            start_live: true,
            end_live: true,
            start_guide: None,
            end_guide: None,
            crosses: false,
        }
    }

    /// Truth: by hand. Steps of half a cell but at tips, nothing farther off than told, the end of another crack kept;
    /// and what is kept away from tips stays as the crack grows at both ends.
    #[test]
    fn points_stay_where_they_are_needed() {
        for step in [0.25, 0.5, 1.0, 2.0] {
            let joint = CrackFrame {
                rest: vec![Point::new(0.0, 90.0), arc(0, 7, CrackEnd::Tip).rest[3]],
                ..CrackFrame::default()
            };
            let joint = CrackFrame { above: joint.rest.clone(), below: joint.rest.clone(), ..joint };
            let before = kept(vec![arc(-80, 80, CrackEnd::Tip), joint.clone()], step * CELL);
            let all = arc(-80, 80, CrackEnd::Tip).rest;
            assert!(before[0].contains(&joint.rest[1]), "the end of another crack");
            assert_eq!([before[0][0], before[0][before[0].len() - 1]], [all[0], all[160]]);
            for w in before[0].windows(2) {
                assert!((w[1] - w[0]).norm() <= 1.001 * step, "{step}");
            }
            let off = |p: &Point| {
                let segments = before[0].windows(2).map(|w| distance_to_segment(*p, w[0], w[1]));
                segments.fold(f64::INFINITY, f64::min)
            };
            assert!(all.iter().all(|p| off(p) <= MOST_OFF * step));
            // Twenty cells in steps of an arc that allows them, all points at both tips, and four for rounding up.
            let longest = step.min((8.0 * 40.0 * MOST_OFF * step).sqrt());
            let most = 20.0 / (longest - 0.125) + 2.0 * (AT_TIP * step / 0.125 + 2.0) + 4.0;
            assert!((before[0].len() as f64) <= most, "{} of {most}", before[0].len());
            let after = kept(vec![arc(-120, 140, CrackEnd::Tip), joint], step * CELL);
            let is_inner =
                |p: &&Point| [all[0], all[160]].iter().all(|tip| (**p - tip).norm() > (AT_TIP + 1.0) * step + 0.2);
            let inner = |points: &[Point]| {
                points.iter().filter(is_inner).filter(|p| p.x.abs() < 9.9).copied().collect::<Vec<_>>()
            };
            let stays = inner(&before[0]);
            assert!(!stays.is_empty() && stays.iter().all(|p| after[0].contains(p)), "{step}");
        }
    }
}
