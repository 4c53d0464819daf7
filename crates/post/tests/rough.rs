//! Rough walls. Truth: what one face gains the other one loses, and no triangle of a solid goes through another one.
#![allow(clippy::unwrap_used)]

mod common;
#[path = "common/places.rs"]
mod places;

use common::cracked_square::{cracked_square, cross, triangles};
use common::options;
use fissure_post::{Mesh, PostOptions, Slot, post_frame};
use fissure_scene::{Cut, Roughness, Walls};
use nalgebra::Vector3;
use places::mergeable;
use proptest::prelude::*;
use std::collections::BTreeSet;

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

    /// Truth: what the guide promises. No two vertices of a fragment with rough walls are nearer to each other than
    /// programs may merge them by, 1e-4 of the body, or 5e-5 where it is cut at rest, however narrow its cracks are.
    #[test]
    fn rough_walls_may_be_merged_by_distance(
        trunk in proptest::collection::vec(-1.5..1.5_f64, 5..13),
        branch in proptest::collection::vec(-1.0..1.0_f64, 4..9),
        tip in proptest::collection::vec(-0.5..0.5_f64, 3..9),
        opening in 0.0..0.05_f64, amplitude in 0.1..0.5_f64, longer in 4.0..12.0_f64, seed: u64, at_rest: bool,
    ) {
        let (scene, frame) = cracked_square(&trunk, &branch, &tip, opening);
        let roughness = Some(Roughness { amplitude, length: longer * amplitude, seed });
        let (cut, merged) = if at_rest { (Cut::Rest, 5e-5) } else { (Cut::Opening, 1e-4) };
        let options = PostOptions { thickness: 3.0, roughness, cut, ..options(&scene) };
        let (low, high) = scene.bodies[0].region.bounds();
        let merged = merged * (high - low).amax();
        for mesh in post_frame(&scene, &frame, &options).unwrap().parts.remove(0).1 {
            prop_assert_eq!(mergeable(&mesh, merged), None);
        }
    }
}
