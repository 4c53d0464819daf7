//! Corners within a cap make room where faces of cracks are moved into the material.
//!
//! With `output.opening` faces are not where the material is. The nearer to a face a corner within is, the more of its
//! way it goes along: all of it right there, nothing at four times the length of the way, so that no triangle folds.

use fissure_scene::{Point, Vector};

/// Corners so many lengths of the way off stay.
const REACH: f64 = 4.0;
/// Edges that a way spreads over: where triangles are finer than that, nobody sees them.
const ROUNDS: usize = 64;

/// How far each corner of a cap goes along [m], by its number: those on the boundary, the first, go their own `ways`.
///
/// `places` of all corners at rest [m]; distances are those along edges of `triangles`, so never across a crack.
pub(crate) fn drawn_along(ways: &[Vector], places: &[Point], triangles: &[[u32; 3]]) -> Vec<Vector> {
    // Distance to the corner of the boundary that is nearest along edges, and that.
    let mut nearest: Vec<Option<(f64, usize)>> = (0..places.len()).map(|_| None).collect();
    (0..ways.len()).for_each(|k| nearest[k] = Some((0.0, k)));
    for _ in 0..ROUNDS {
        let mut is_done = true;
        for triangle in triangles {
            for k in 0..3 {
                let [p, q] = [triangle[k], triangle[(k + 1) % 3]].map(|corner| corner as usize);
                for [from, to] in [[p, q], [q, p]] {
                    let Some((before, source)) = nearest[from] else { continue };
                    let distance = before + (places[to] - places[from]).norm();
                    let is_near = distance < REACH * ways[source].norm();
                    if is_near && nearest[to].is_none_or(|(known, _)| distance < known) {
                        nearest[to] = Some((distance, source));
                        is_done = false;
                    }
                }
            }
        }
        if is_done {
            break;
        }
    }
    let along = |found: &Option<(f64, usize)>| {
        let Some((distance, source)) = *found else { return Vector::zeros() };
        let way = ways[source];
        way * (1.0 - distance / (REACH * way.norm())).max(0.0)
    };
    let mut all = ways.to_vec();
    all.extend(nearest[ways.len()..].iter().map(along));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: by hand. A row of corners above two of a boundary that move up by 1: so far in, so much less; what
    /// no edge leads to stays.
    #[test]
    fn corners_go_along_the_less_the_farther_they_are() {
        let places: Vec<Point> = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (0.0, 3.0), (0.0, 5.0), (9.0, 9.0)]
            .map(|(x, y)| Point::new(x, y))
            .to_vec();
        let way = Vector::new(0.0, 1.0);
        let triangles = [[0, 1, 2], [1, 3, 2], [2, 3, 4], [4, 3, 5]];
        let found = drawn_along(&[way, way], &places, &triangles);
        let expected = [1.0, 1.0, 0.75, 0.75, 0.25, 0.0, 0.0];
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - way * expected).norm() < 1e-12, "{found} {expected}");
        }
        assert!(drawn_along(&[Vector::zeros(); 2], &places, &triangles).iter().all(|way| *way == Vector::zeros()));
    }
}
