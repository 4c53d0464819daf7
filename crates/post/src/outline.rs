//! The moved rings of a body as boundary edges.

use crate::drawn_curve::tangents;
use crate::slot::Slot;
use crate::snap::Grid;
use crate::source::{Carried, SourceEdge};
use fissure_scene::{OutlineFrame, Scene};

/// The edges of one ring, in ring order.
pub(crate) fn outline_edges(scene: &Scene, outline: &OutlineFrame, grid: Grid) -> Vec<SourceEdge> {
    let tangents = tangents(scene, outline);
    let count = outline.position.len();
    let mut arc = 0.0;
    (0..count)
        .map(|i| {
            let next = (i + 1) % count;
            let [tangent, to] = tangents.get(i).copied().unwrap_or_default();
            let start = Carried { arc, tangent, ..Carried::within(outline.rest[i], outline.velocity[i]) };
            arc += (outline.rest[next] - outline.rest[i]).norm();
            let end = Carried { arc, tangent: to, ..Carried::within(outline.rest[next], outline.velocity[next]) };
            SourceEdge {
                a: grid.snap(outline.position[i]),
                b: grid.snap(outline.position[next]),
                carried: [start, end],
                slot: Slot::Outside,
            }
        })
        .collect()
}
