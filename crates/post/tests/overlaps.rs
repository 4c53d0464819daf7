//! Fragments beside each other. Truth: areas by brute force, of what boundaries enclose and of what triangles share.
#![allow(clippy::unwrap_used)]

mod common;
#[path = "common/winding.rs"]
mod winding;

use common::{Opened, frame, options, path, scene, square};
use fissure_post::{Mesh, Slot, post_frame};
use fissure_scene::{CrackEnd, Cut, Frame, Point, Scene, Vector};
use proptest::prelude::*;
use winding::covered_area;

const SIZE: f64 = 20.0;

/// The triangles of the front cap, in the plane.
fn cap(mesh: &Mesh) -> Vec<Vec<Point>> {
    let corner = |i: u32| mesh.vertices[i as usize];
    let is_front = |t: &&[u32; 3]| t.iter().all(|&i| corner(i).normal[2] == 1.0);
    let place = |i: u32| Point::new(corner(i).position[0], corner(i).position[1]);
    mesh.slot(Slot::Outside).iter().filter(is_front).map(|t| t.map(place).to_vec()).collect()
}

fn areas(triangles: &[Vec<Point>]) -> f64 {
    triangles.iter().map(|t| 0.5 * (t[1] - t[0]).perp(&(t[2] - t[0]))).sum()
}

/// What two sets of triangles have in common.
fn common_area(some: &[Vec<Point>], others: &[Vec<Point>]) -> f64 {
    let bounds = |t: &[Point]| (t[0].inf(&t[1]).inf(&t[2]), t[0].sup(&t[1]).sup(&t[2]));
    let mut common = 0.0;
    for a in some {
        let (low, high) = bounds(a);
        for b in others {
            let (from, to) = bounds(b);
            if low.x < to.x && from.x < high.x && low.y < to.y && from.y < high.y {
                let pair = [a.clone(), b.clone()];
                common += areas(&pair) - covered_area(&pair);
            }
        }
    }
    common
}

fn motions(count: usize) -> impl Strategy<Value = Vec<Vector>> {
    proptest::collection::vec((-0.1..0.1_f64, -0.1..0.1_f64).prop_map(|(x, y)| Vector::new(x, y)), count)
}

/// Path of a crack, and how far its two faces have moved.
type Moved = (Vec<f64>, Vec<Vector>, Vec<Vector>);

/// A square with a crack from side to side and one that ends on it, their faces moved, and what its three fragments
/// lie within.
fn cracked(trunk: Moved, branch: Moved) -> (Scene, Frame, [Vec<Point>; 3]) {
    let region = square(SIZE);
    let scene = scene(region.clone());
    let rest = path(Point::new(10.0, 0.0), Point::new(10.0, SIZE), &trunk.0);
    let junction = rest[4];
    let trunk = Opened { rest, above: trunk.1, below: trunk.2, start: CrackEnd::Mouth, end: CrackEnd::Mouth };
    let rest = path(junction, Point::new(SIZE, junction.y), &branch.0);
    let start = CrackEnd::Junction { crack: 0 };
    let branch = Opened { rest, above: branch.1, below: branch.2, start, end: CrackEnd::Mouth };
    let mut frame = frame(&region, 2, &[trunk.clone(), branch.clone()]);
    let piece = |x: Point| u32::from(x.x > 10.0) + u32::from(x.x > 10.0 && x.y > junction.y);
    frame.particles.piece = frame.particles.rest.iter().map(|&x| piece(x)).collect();
    let [left, right] = [trunk.face(&trunk.above), trunk.face(&trunk.below)];
    let [top, bottom] = [branch.face(&branch.above), branch.face(&branch.below)];
    let corner = |x: f64, y: f64| vec![Point::new(x, y)];
    let reversed = |points: &[Point]| points.iter().rev().copied().collect::<Vec<_>>();
    let rings = [
        [corner(0.0, 0.0), left, corner(0.0, SIZE)].concat(),
        [corner(SIZE, 0.0), reversed(&bottom), reversed(&right[..4])].concat(),
        [top, corner(SIZE, SIZE), reversed(&right[5..])].concat(),
    ];
    (scene, frame, rings)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    /// A crack from side to side and one that ends on it; the faces of both have moved a tenth of a cell, anyhow: no
    /// two fragments share more than a 1e-5th of the smaller one, and together they cover what their boundaries do.
    #[test]
    fn faces_that_sink_into_each_other_share_the_middle(
        trunk in (proptest::collection::vec(-0.3..0.3_f64, 9), motions(9), motions(9)),
        branch in (proptest::collection::vec(-0.3..0.3_f64, 6), motions(6), motions(6)),
    ) {
        let (scene, frame, rings) = cracked(trunk, branch);
        let covered = covered_area(&rings);
        for shortest_edge in [0.0, 2e-4] {
            let options = fissure_post::PostOptions { shortest_edge, ..options(&scene) };
            let meshes = post_frame(&scene, &frame, &options).unwrap().parts.remove(0).1;
            prop_assert_eq!(meshes.len(), 3);
            let caps: Vec<_> = meshes.iter().map(cap).collect();
            let found: f64 = caps.iter().map(|triangles| areas(triangles)).sum();
            // All three may lose what they have all in common.
            prop_assert!((found - covered).abs() < 0.04, "{} of {}", found, covered);
            for (i, k) in [(0, 1), (0, 2), (1, 2)] {
                let common = common_area(&caps[i], &caps[k]);
                prop_assert!(common < 1e-5 * areas(&caps[i]).min(areas(&caps[k])), "{} and {}: {}", i, k, common);
            }
        }
    }

    /// The same cut at rest: no two fragments share more than a 1e-4th of the smaller one, no triangle is folded, and
    /// triangles are those of a square whose faces have not moved.
    #[test]
    fn what_is_cut_at_rest_makes_room_and_keeps_its_triangles(
        trunk in (proptest::collection::vec(-0.3..0.3_f64, 9), motions(9), motions(9)),
        branch in (proptest::collection::vec(-0.3..0.3_f64, 6), motions(6), motions(6)),
    ) {
        let still = |(path, above, _): &Moved| {
            let moves = vec![Vector::zeros(); above.len()];
            (path.clone(), moves.clone(), moves)
        };
        let meshes = |trunk: Moved, branch: Moved| {
            let (scene, frame, _) = cracked(trunk, branch);
            let options = fissure_post::PostOptions { cut: Cut::Rest, ..options(&scene) };
            post_frame(&scene, &frame, &options).unwrap().parts.remove(0).1
        };
        let at_rest = meshes(still(&trunk), still(&branch));
        let found = meshes(trunk, branch);
        prop_assert_eq!(found.len(), 3);
        let caps: Vec<_> = found.iter().map(cap).collect();
        for (i, k) in [(0, 1), (0, 2), (1, 2)] {
            let common = common_area(&caps[i], &caps[k]);
            prop_assert!(common < 1e-4 * areas(&caps[i]).min(areas(&caps[k])), "{} and {}: {}", i, k, common);
        }
        prop_assert!(caps.iter().flatten().all(|triangle| areas(std::slice::from_ref(triangle)) > 0.0));
        for (mesh, still) in found.iter().zip(&at_rest) {
            prop_assert_eq!(mesh.slot(Slot::Outside), still.slot(Slot::Outside));
        }
    }
}
