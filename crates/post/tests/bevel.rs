//! Bevelled edges. Truth: closed form of what they take off, and no triangle of a solid goes through another one.
#![allow(clippy::unwrap_used)]

mod common;
#[path = "common/places.rs"]
mod places;

use common::cracked_square::{SIZE, cracked_square, cross, triangles};
use common::{Opened, frame, options, path, scene, square};
use fissure_post::{Mesh, PostOptions, Slot, post_frame};
use fissure_scene::{CrackEnd, Cut, Frame, Point, Scene, Vector};
use nalgebra::Vector3;
use places::mergeable;
use proptest::prelude::*;

/// Of the grid on which all that reaches 20 m from the origin is exact in single precision [m]: `f32` has 24 bits.
const STEP: f64 = 32.0 / 16_777_216.0;

/// The solids with sharp and with bevelled edges.
fn solids(scene: &Scene, frame: &Frame, bevel: f64) -> [Vec<Mesh>; 2] {
    cut_solids(scene, frame, bevel, Cut::Opening)
}

/// The same, cut where `cut` says.
fn cut_solids(scene: &Scene, frame: &Frame, bevel: f64, cut: Cut) -> [Vec<Mesh>; 2] {
    let sharp = PostOptions { thickness: 3.0, cut, ..options(scene) };
    let bevelled = PostOptions { bevel, ..sharp.clone() };
    [sharp, bevelled].map(|options| post_frame(scene, frame, &options).unwrap().parts.remove(0).1)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// Any bevel that may be asked for: solids are closed, as they are checked; walls that were drawn stay as they are;
    /// no triangle goes through another one; and normals point out of the strips.
    #[test]
    fn bevelled_solids_do_not_cross(
        trunk in proptest::collection::vec(-0.4..0.4_f64, 10..40),
        branch in proptest::collection::vec(-0.3..0.3_f64, 6..24),
        tip in proptest::collection::vec(-0.2..0.2_f64, 4..16),
        opening in 0.1..0.6_f64, bevel in 0.01..0.75_f64,
    ) {
        let (scene, frame) = cracked_square(&trunk, &branch, &tip, opening);
        let [before, after] = solids(&scene, &frame, bevel);
        for (before, after) in before.iter().zip(&after) {
            prop_assert!(after.triangle_count() > before.triangle_count() && after.volume() < before.volume());
            let is_wall = |t: &[Vector3<f64>; 3]| t.iter().any(|p| p.z < 0.0) && t.iter().any(|p| p.z > 0.0);
            // They may have other corners than before.
            let drawn = |mesh| {
                let walls = triangles(mesh, Slot::Outside).into_iter().filter(is_wall);
                walls.map(|[a, b, c]| 0.5 * (b - a).cross(&(c - a)).norm()).sum::<f64>()
            };
            prop_assert!((drawn(before) - drawn(after)).abs() < 1e-3, "{} {}", drawn(before), drawn(after));
            let places = |mesh| {
                let walls = triangles(mesh, Slot::Outside).into_iter().filter(is_wall);
                walls.flatten().fold([f64::INFINITY, 0.0], |[low, high], p| [low.min(p.x), f64::max(high, p.y)])
            };
            prop_assert_eq!(places(before), places(after));
            let all = [Slot::Inside, Slot::Outside].map(|slot| triangles(after, slot)).concat();
            for (i, p) in triangles(after, Slot::Inside).iter().enumerate() {
                for q in &all[i + 1..] {
                    prop_assert!(!cross(p, q), "{:?} {:?}", p, q);
                }
            }
            for triangle in after.slot(Slot::Inside) {
                let [a, b, c] = triangle.map(|i| Vector3::from(after.vertices[i as usize].position));
                let normal = (b - a).cross(&(c - a)).normalize();
                for i in *triangle {
                    prop_assert!(normal.dot(&Vector3::from(after.vertices[i as usize].normal)) > 0.0);
                }
            }
        }
    }

    /// Truth: what is promised of caps. Bevelled ones have hardly a narrower angle than sharp ones.
    #[test]
    fn caps_within_bevels_have_no_needles(
        trunk in proptest::collection::vec(-0.4..0.4_f64, 10..40), bevel in 0.05..0.3_f64, is_at_rest: bool,
    ) {
        let rest = path(Point::new(10.0, 0.0), Point::new(10.0, SIZE), &trunk);
        let moved = |x: f64| vec![Vector::new(x, 0.0); rest.len()];
        let crack = Opened {
            above: moved(-0.1), below: moved(0.1), start: CrackEnd::Mouth, end: CrackEnd::Mouth, rest: rest.clone(),
        };
        let region = square(SIZE);
        let frame = frame(&region, 2, &[crack]);
        let sharpest = |meshes: &[Mesh]| {
            let caps = meshes.iter().flat_map(|mesh| triangles(mesh, Slot::Outside));
            let front = caps.filter(|t| t.iter().all(|p| p.z == 1.5));
            let angles = front.flat_map(|[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]]);
            angles.map(|[a, b, c]| (b - a).angle(&(c - a)).to_degrees()).fold(180.0, f64::min)
        };
        let cut = if is_at_rest { Cut::Rest } else { Cut::Opening };
        let [before, after] = cut_solids(&scene(region), &frame, bevel, cut).map(|meshes| sharpest(&meshes));
        prop_assert!(after > 15.0 || after > before - 3.0, "{} {}", before, after);
    }

    /// Truth: what the guide promises of what is cut at rest. Bevelled cracks, closed or hardly open, with tips and
    /// branches: vertices within 5e-5 of the body may be merged.
    #[test]
    fn bevels_of_what_is_cut_at_rest_may_be_merged_by_distance(
        trunk in proptest::collection::vec(-1.5..1.5_f64, 5..13),
        branch in proptest::collection::vec(-1.0..1.0_f64, 4..9),
        tip in proptest::collection::vec(-0.5..0.5_f64, 3..9),
        opening in 0.0..0.01_f64, bevel in 0.01..0.3_f64,
    ) {
        let (scene, frame) = cracked_square(&trunk, &branch, &tip, opening);
        let [_, bevelled] = cut_solids(&scene, &frame, bevel, Cut::Rest);
        for mesh in bevelled {
            prop_assert_eq!(mergeable(&mesh, 5e-5 * SIZE), None);
        }
    }

    /// Truth: closed form. Along a straight wall of length L in segments of length s, bevels of width w take off two
    /// prisms of area w²/2, which end in pyramids within the first and the last segment: w² (L − 4 s/3). In the plane
    /// strips end on the grid, so one of both widths is a whole number of its steps, which in a bevel of 16 mm on 20 m
    /// is up to 6e-5 of what they take off.
    #[test]
    fn bevels_take_off_two_prisms(parts in 10_usize..30, part_of_segment in 0.01..0.2_f64) {
        let rest = path(Point::new(10.0, 0.0), Point::new(10.0, SIZE), &vec![0.0; parts + 1]);
        let moved = |x: f64| vec![Vector::new(x, 0.0); rest.len()];
        let crack = Opened {
            above: moved(-0.1), below: moved(0.1), start: CrackEnd::Mouth, end: CrackEnd::Mouth, rest: rest.clone(),
        };
        let region = square(SIZE);
        let mut frame = frame(&region, 2, &[crack]);
        frame.particles.piece = frame.particles.rest.iter().map(|x| u32::from(x.x > 10.0)).collect();
        let segment = SIZE / parts as f64;
        let bevel = part_of_segment * segment;
        let on_grid = (bevel / STEP).round() * STEP;
        let [before, after] = solids(&scene(region), &frame, bevel);
        prop_assert_eq!(after.len(), 2);
        for (before, after) in before.iter().zip(&after) {
            let removed = (before.volume() - after.volume()) / (bevel * on_grid);
            // Segments are halved at most where caps need it. New corners in the first and last ones, where strips
            // become narrow, go to the grid inwards.
            let rounding = segment * STEP / bevel;
            let range = SIZE - 4.0 / 3.0 * segment - rounding..SIZE - 2.0 / 3.0 * segment + rounding;
            prop_assert!(range.contains(&removed), "{} in {:?}", removed, range);
        }
    }
}

/// Truth: what is promised of the cut at rest. Faces that are straight at rest go to and fro as the crack opens, up to
/// where their corners are too sharp for a bevel: vertex n is vertex n all the same, and solids are closed.
#[test]
fn bevels_of_what_is_cut_at_rest_stay_the_same() {
    let region = square(20.0);
    let scene = scene(region.clone());
    let rest: Vec<Point> = (0..=40).map(|k| Point::new(0.25 * f64::from(k), 10.0)).collect();
    let triangles = |height: f64| {
        let opening: Vec<f64> = (0..=40)
            .map(|k| {
                let tooth = if k % 2 == 1 { 1.0 } else { 0.1 };
                height * tooth * f64::from(40 - k) / 40.0
            })
            .collect();
        let crack = Opened::symmetric(rest.clone(), &opening, CrackEnd::Mouth, CrackEnd::Tip);
        let options = PostOptions { bevel: 0.2, cut: Cut::Rest, thickness: 3.0, ..options(&scene) };
        let frame = frame(&region, 40, &[crack]);
        let mesh = post_frame(&scene, &frame, &options).unwrap().parts.remove(0).1.remove(0);
        (mesh.vertices.len(), mesh.all_triangles().collect::<Vec<_>>())
    };
    let first = triangles(0.02);
    for height in [0.0, 0.3, 0.9, 1.4] {
        assert!(triangles(height) == first, "{height}");
    }
}
