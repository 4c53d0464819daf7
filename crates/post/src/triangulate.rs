//! Triangles of a polygon on the grid.

use crate::boolean::{Edge, Shape};
use crate::snap::GridPoint;
use i_triangle::int::triangulation::IntTriangulation;
use i_triangle::int::unchecked::IntUncheckedTriangulatable;
use std::collections::HashMap;

/// Delaunay triangles of `shape`, counter-clockwise, as indices into its vertices (contour after contour).
///
/// `shape` must be valid and without pinch points, as [`crate::boolean`] and [`crate::pinch`] make it. No vertex is
/// added.
pub(crate) fn triangulate(shape: &Shape) -> Vec<[u32; 3]> {
    let contours: Vec<Vec<GridPoint>> = shape.iter().map(|contour| contour.iter().map(|e| e.a).collect()).collect();
    let found: IntTriangulation<i64, u32> = contours.uncheck_triangulate().into_delaunay().into_triangulation();
    let starts = shape.iter().flatten().map(|edge: &Edge| edge.a);
    let index: HashMap<(i64, i64), u32> = starts.zip(0..).map(|(p, i)| ((p.x, p.y), i)).collect();
    let vertex = |i: u32| {
        let p = found.points[i as usize];
        index[&(p.x, p.y)]
    };
    found.indices.chunks_exact(3).map(|t| [vertex(t[0]), vertex(t[1]), vertex(t[2])]).collect()
}
