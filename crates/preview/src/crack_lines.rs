//! Cracks that are closed, or hardly open: meshes do not show them.

use crate::projection::Projection;
use fissure_scene::{BoundaryEdge, CrackFrame, Fragments, Frame, Line, Point, Vector};
use std::collections::{BTreeMap, BTreeSet};
use tiny_skia::PathBuilder;

/// Openings that the meshes show by themselves [pixels].
const OPEN: f64 = 1.5;

/// Adds the stretches of cracks within fragments, in the plane at height `z`, that are less than [`OPEN`] open, where
/// `moves` take these fragments, known by body and number [m].
pub(crate) fn add_moved(
    path: &mut PathBuilder,
    frame: &Frame,
    moves: &BTreeMap<(u32, u32), Vector>,
    z: f64,
    projection: &Projection,
) {
    let fragments = Fragments::of_frame(frame);
    let numbers = fragments.numbers(&frame.particles);
    for (fragment, number) in fragments.list().iter().zip(numbers) {
        // What holds no particle is too small for lines of its own.
        let Some(number) = number else { continue };
        let way = moves.get(&(fragment.body, number)).copied().unwrap_or_default();
        let edges = || fragment.boundaries.iter().flatten();
        let key = |crack: usize, [a, b]: [Point; 2]| (crack, [a.x, a.y, b.x, b.y].map(f64::to_bits));
        let below = |edge: &BoundaryEdge| match edge.line {
            Line::Below(crack) => Some(key(crack, [edge.rest[1], edge.rest[0]])),
            _ => None,
        };
        let below: BTreeSet<_> = edges().filter_map(below).collect();
        for edge in edges() {
            let Line::Above(crack) = edge.line else { continue };
            if !below.contains(&key(crack, edge.rest)) {
                continue;
            }
            let faces = &frame.cracks[crack];
            let at = |face: &[Point], part: f64| {
                let [from, to] = edge.points.map(|k| face[k]);
                from + part * (to - from)
            };
            let ends = edge.span.map(|part| [at(&faces.above, part), at(&faces.below, part)]);
            if ends.iter().any(|[above, below]| (above - below).norm() * projection.scale >= OPEN) {
                continue;
            }
            let [[x, y, _], [to_x, to_y, _]] = ends.map(|[above, below]| {
                let shown = nalgebra::center(&above, &below) + way;
                projection.pixel([shown.x, shown.y, z])
            });
            path.move_to(x as f32, y as f32);
            path.line_to(to_x as f32, to_y as f32);
        }
    }
}

/// Adds the stretches of a crack, in the plane at height `z`, that are less than [`OPEN`] open.
pub(crate) fn add(path: &mut PathBuilder, crack: &CrackFrame, z: f64, projection: &Projection) {
    let faces = crack.above.iter().zip(&crack.below);
    let points: Vec<([f64; 2], bool)> = faces
        .map(|(above, below)| {
            let [x, y, _] = projection.pixel([0.5 * (above.x + below.x), 0.5 * (above.y + below.y), z]);
            ([x, y], (above - below).norm() * projection.scale < OPEN)
        })
        .collect();
    let mut drawing = false;
    for pair in points.windows(2) {
        let [([x, y], from_closed), ([to_x, to_y], to_closed)] = [pair[0], pair[1]];
        if !(from_closed && to_closed) {
            drawing = false;
            continue;
        }
        if !drawing {
            path.move_to(x as f32, y as f32);
        }
        path.line_to(to_x as f32, to_y as f32);
        drawing = true;
    }
}
