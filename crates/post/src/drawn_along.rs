//! Corners within a cap go along with its boundary where that is not where the material around it is.
//!
//! With `output.opening` faces are shown inside the material, and faces of cracks are told by marks of their own, which
//! particles beside them do not always agree with. How far the boundary is off is spread over the corners within: each
//! goes along as the mean of its neighbours does, so that no triangle folds that need not.

use fissure_scene::{Point, Vector};

/// Rounds of conjugate gradients at most.
const ROUNDS: usize = 200;
/// What is left of the forces when they end, as a part of those at first.
const LEFT: f64 = 1e-4;

/// How far all corners of a cap go along [m], by their numbers, where the `ways` of some are known.
///
/// `places` of all corners at rest [m]. Edges of `triangles` pull like springs whose stiffness falls with their length:
/// conjugate gradients, scaled by the diagonal.
pub(crate) fn drawn_along(ways: &[Option<Vector>], places: &[Point], triangles: &[[u32; 3]]) -> Vec<Vector> {
    let mut springs = Vec::with_capacity(3 * triangles.len());
    for triangle in triangles {
        for k in 0..3 {
            let [p, q] = [triangle[k], triangle[(k + 1) % 3]].map(|corner| corner as usize);
            let length = (places[q] - places[p]).norm();
            if (ways[p].is_none() || ways[q].is_none()) && length > 0.0 {
                springs.push(([p, q], 1.0 / length));
            }
        }
    }
    let forces = |all: &[Vector]| {
        let mut forces = vec![Vector::zeros(); places.len()];
        for &([p, q], stiffness) in &springs {
            let pull = stiffness * (all[q] - all[p]);
            forces[p] += pull;
            forces[q] -= pull;
        }
        forces.iter_mut().zip(ways).filter(|(_, way)| way.is_some()).for_each(|(force, _)| *force = Vector::zeros());
        forces
    };
    let mut diagonal = vec![0.0; places.len()];
    for &([p, q], stiffness) in &springs {
        diagonal[p] += stiffness;
        diagonal[q] += stiffness;
    }
    let scaled = |forces: &[Vector]| -> Vec<Vector> {
        forces.iter().zip(&diagonal).map(|(force, &d)| if d > 0.0 { force / d } else { Vector::zeros() }).collect()
    };
    let dot = |a: &[Vector], b: &[Vector]| -> f64 { a.iter().zip(b).map(|(a, b)| a.dot(b)).sum() };
    let mut all: Vec<Vector> = ways.iter().map(|way| way.unwrap_or_default()).collect();
    let mut left = forces(&all);
    let mut toward = scaled(&left);
    let mut size = dot(&left, &toward);
    let end = size * LEFT * LEFT;
    for _ in 0..ROUNDS {
        if size <= end {
            break;
        }
        let pulled = forces(&toward);
        let step = -size / dot(&toward, &pulled);
        all.iter_mut().zip(&toward).for_each(|(way, toward)| *way += step * toward);
        left.iter_mut().zip(&pulled).for_each(|(left, pulled)| *left += step * pulled);
        let next = scaled(&left);
        let now = dot(&left, &next);
        toward.iter_mut().zip(&next).for_each(|(toward, next)| *toward = next + (now / size) * *toward);
        size = now;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: by hand, and that no mean lies beyond what it is of. The corner in the middle of a hexagon goes the mean
    /// way; all within a disc go no farther than its boundary; where nothing goes, nothing does.
    #[test]
    fn corners_go_as_the_mean_of_their_neighbours() {
        let on_circle = |k: usize, count: usize| {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / count as f64).sin_cos();
            Point::new(cos, sin)
        };
        let way = |k: usize| Vector::new((k * k % 7) as f64, (k % 3) as f64 - 1.0);
        for count in [6, 24] {
            let ways: Vec<Vector> = (0..count).map(way).collect();
            let outer = (0..count).map(|k| on_circle(k, count));
            // Around the middle, and around a ring half way in.
            let rings = if count == 6 { 1 } else { 2 };
            let inner = (0..count * (rings - 1)).map(|k| nalgebra::center(&on_circle(k, count), &Point::origin()));
            let places: Vec<Point> = outer.chain(inner).chain([Point::origin()]).collect();
            let middle = (rings * count) as u32;
            let mut triangles = Vec::new();
            for k in 0..count as u32 {
                let next = (k + 1) % count as u32;
                let last = middle - count as u32;
                triangles.push([last + k, last + next, middle]);
                if rings == 2 {
                    triangles.extend([[k, next, last + k], [next, last + next, last + k]]);
                }
            }
            let known = |ways: &[Vector]| {
                let mut known: Vec<Option<Vector>> = ways.iter().copied().map(Some).collect();
                known.resize(places.len(), None);
                known
            };
            let found = drawn_along(&known(&ways), &places, &triangles);
            assert_eq!(&found[..count], &ways);
            let mean = ways.iter().sum::<Vector>() / count as f64;
            assert!(count > 6 || (found[6] - mean).norm() < 1e-3, "{}", found[6]);
            assert!(found.iter().all(|way| (-1e-3..6.001).contains(&way.x) && way.y.abs() < 1.001));
            assert!(found[count..].iter().all(|way| (0.5..6.0).contains(&way.x)));
            let still = vec![Vector::zeros(); count];
            assert!(drawn_along(&known(&still), &places, &triangles).iter().all(|way| *way == Vector::zeros()));
        }
    }
}
