//! Rough walls. Truth: what one face gains the other one loses, and no triangle of a solid goes through another one.
#![allow(clippy::unwrap_used)]

mod common;

use common::{Opened, frame, options, scene, square};
use fissure_post::{Mesh, PostOptions, Slot, post_frame};
use fissure_scene::{CrackEnd, Cut, Frame, Point, Roughness, Scene, Vector, Walls};
use nalgebra::Vector3;
use proptest::prelude::*;
use std::collections::BTreeSet;

const SIZE: f64 = 20.0;
type Triangle = [Vector3<f64>; 3];

/// Points from `a` to `b`, those between moved by `wander` across.
fn path(a: Point, b: Point, wander: &[f64]) -> Vec<Point> {
    let last = wander.len() - 1;
    let across = Vector::new(a.y - b.y, b.x - a.x).normalize();
    let place = |(k, off): (usize, &f64)| {
        let off = if k == 0 || k == last { 0.0 } else { *off };
        a + (k as f64 / last as f64) * (b - a) + off * across
    };
    wander.iter().enumerate().map(place).collect()
}

/// A square with a crack from side to side, one that ends on it, and one that ends in the material; `opening` of the
/// last one at its mouth [m].
fn cracked_square(trunk: &[f64], branch: &[f64], tip: &[f64], opening: f64) -> (Scene, Frame) {
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

fn triangles(mesh: &Mesh, slot: Slot) -> Vec<Triangle> {
    let corner = |i: u32| Vector3::from(mesh.vertices[i as usize].position);
    mesh.slot(slot).iter().map(|t| t.map(corner)).collect()
}

/// Whether an edge of one of two triangles without a common corner goes through the other.
fn cross(p: &Triangle, q: &Triangle) -> bool {
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

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// Any relief that may be asked for: solids are closed, as they are checked; caps and outlines stay; no wall goes
    /// through another one; and the faces of a crack fit, so that all solids together fill the square.
    #[test]
    fn rough_walls_fit_and_do_not_cross(
        trunk in proptest::collection::vec(-1.5..1.5_f64, 5..13),
        branch in proptest::collection::vec(-1.0..1.0_f64, 4..9),
        tip in proptest::collection::vec(-0.5..0.5_f64, 3..9),
        opening in 0.1..0.6_f64, amplitude in 0.1..0.5_f64, longer in 4.0..12.0_f64, seed: u64,
    ) {
        let (scene, frame) = cracked_square(&trunk, &branch, &tip, opening);
        let plain = PostOptions { thickness: 3.0, ..options(&scene) };
        let roughness = Some(Roughness { amplitude, length: longer * amplitude, seed });
        let rough = PostOptions { roughness, ..plain.clone() };
        let [before, after] = [plain, rough].map(|o| post_frame(&scene, &frame, &o).unwrap().parts.remove(0).1);
        let volume = |meshes: &[Mesh]| meshes.iter().map(Mesh::volume).sum::<f64>();
        let (mut moved, mut area) = (0.0, 0.0);
        for (before, after) in before.iter().zip(&after) {
            prop_assert_eq!(triangles(before, Slot::Outside), triangles(after, Slot::Outside));
            moved += (before.volume() - after.volume()).abs();
            area += triangles(before, Slot::Inside).iter().map(|[a, b, c]| 0.5 * (b - a).cross(&(c - a)).norm()).sum::<f64>();
            let walls = triangles(after, Slot::Inside);
            for (i, p) in walls.iter().enumerate() {
                for q in &walls[i + 1..] {
                    prop_assert!(!cross(p, q), "{:?} {:?}", p, q);
                }
            }
            for triangle in &after.triangles[Slot::Inside as usize] {
                let [a, b, c] = triangle.map(|i| Vector3::from(after.vertices[i as usize].position));
                let normal = (b - a).cross(&(c - a)).normalize();
                for i in *triangle {
                    prop_assert!(normal.dot(&Vector3::from(after.vertices[i as usize].normal)) > 0.0);
                }
            }
        }
        let all: BTreeSet<_> = after.iter().map(|mesh| mesh.name.clone()).collect();
        prop_assert_eq!(all.len(), 3);
        // The wedge that is open is a little larger or smaller; corners of one face lie on edges of the other.
        let off = (volume(&before) - volume(&after)).abs();
        prop_assert!(off < 0.01 * amplitude * area, "{} of {}", off, amplitude * area);
        prop_assert!(moved > 2.0 * off);
    }

    /// Cracks that are held open by a few grid steps only: all solids pass their check, rough or not.
    #[test]
    fn closed_cracks_with_rough_walls_are_solids(
        tip in proptest::collection::vec(-0.5..0.5_f64, 3..9), amplitude in 0.1..0.5_f64, seed: u64, at_rest: bool,
    ) {
        let (scene, frame) = cracked_square(&[0.0; 5], &[0.0; 4], &tip, 0.0);
        let roughness = Some(Roughness { amplitude, length: 4.0 * amplitude, seed });
        let cut = if at_rest { Cut::Rest } else { Cut::Opening };
        let options = PostOptions { thickness: 3.0, roughness, walls: Walls::All, cut, ..options(&scene) };
        let meshes = post_frame(&scene, &frame, &options).unwrap().parts.remove(0).1;
        prop_assert_eq!(meshes.len(), 3);
        prop_assert!(meshes.iter().all(|mesh| mesh.check().is_ok()));
    }
}
