//! Cracks that are closed, or hardly open: meshes do not show them.

use crate::projection::Projection;
use fissure_scene::CrackFrame;
use tiny_skia::PathBuilder;

/// Openings that the meshes show by themselves [pixels].
const OPEN: f64 = 1.5;

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
