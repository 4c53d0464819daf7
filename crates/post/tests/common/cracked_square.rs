//! A square with cracks, and what its solids are held against.

use super::{Opened, frame, path, scene, square};
use fissure_post::{Mesh, Slot};
use fissure_scene::{CrackEnd, Frame, Point, Scene, Vector};
use nalgebra::Vector3;

/// Side of the square [m].
pub const SIZE: f64 = 20.0;
/// A triangle by its corners.
pub type Triangle = [Vector3<f64>; 3];

/// A square with a crack from side to side, one that ends on it, and one that ends in the material; `opening` of the
/// last one at its mouth [m].
pub fn cracked_square(trunk: &[f64], branch: &[f64], tip: &[f64], opening: f64) -> (Scene, Frame) {
    let still = |rest: Vec<Point>, start, end| {
        let moved = vec![Vector::zeros(); rest.len()];
        Opened { rest, above: moved.clone(), below: moved, start, end }
    };
    let trunk = path(Point::new(10.0, 0.0), Point::new(10.0, SIZE), trunk);
    let junction = trunk[trunk.len() / 2];
    let right = path(junction, Point::new(SIZE, junction.y), branch);
    let left = path(Point::new(0.0, 12.0), Point::new(5.0, 12.0), tip);
    let profile: Vec<f64> = (0..left.len()).map(|k| opening * (1.0 - k as f64 / (left.len() - 1) as f64)).collect();
    let cracks = [
        still(trunk, CrackEnd::Mouth, CrackEnd::Mouth),
        still(right, CrackEnd::Junction { crack: 0 }, CrackEnd::Mouth),
        Opened::symmetric(left, &profile, CrackEnd::Mouth, CrackEnd::Tip),
    ];
    let region = square(SIZE);
    let mut frame = frame(&region, 2, &cracks);
    let piece = |x: Point| u32::from(x.x > 10.0) + u32::from(x.x > 10.0 && x.y > junction.y);
    frame.particles.piece = frame.particles.rest.iter().map(|&x| piece(x)).collect();
    (scene(region), frame)
}

/// The triangles of a slot.
pub fn triangles(mesh: &Mesh, slot: Slot) -> Vec<Triangle> {
    let corner = |i: u32| Vector3::from(mesh.vertices[i as usize].position);
    mesh.slot(slot).iter().map(|t| t.map(corner)).collect()
}

/// Whether an edge of one of two triangles without a common corner goes through the other.
pub fn cross(p: &Triangle, q: &Triangle) -> bool {
    let bounds = |t: &Triangle| (t[0].inf(&t[1]).inf(&t[2]), t[0].sup(&t[1]).sup(&t[2]));
    let ((low, high), (from, to)) = (bounds(p), bounds(q));
    if (0..3).any(|k| low[k] > to[k] || from[k] > high[k]) || p.iter().any(|corner| q.contains(corner)) {
        return false;
    }
    let volume =
        |a: Vector3<f64>, b: Vector3<f64>, c: Vector3<f64>, d: Vector3<f64>| (b - a).cross(&(c - a)).dot(&(d - a));
    let pierces = |t: &Triangle, a: Vector3<f64>, b: Vector3<f64>| {
        let sides = [volume(t[0], t[1], t[2], a), volume(t[0], t[1], t[2], b)];
        let around = [0, 1, 2].map(|k| volume(a, b, t[k], t[(k + 1) % 3]));
        sides[0] * sides[1] < 0.0 && (around.iter().all(|v| *v > 0.0) || around.iter().all(|v| *v < 0.0))
    };
    (0..3).any(|k| pierces(q, p[k], p[(k + 1) % 3]) || pierces(p, q[k], q[(k + 1) % 3]))
}
