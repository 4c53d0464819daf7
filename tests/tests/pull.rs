//! The pull examples: the plate breaks in two, guides are followed, mirrored scenes give mirrored cracks.
#![allow(clippy::unwrap_used)]

use fissure_scene::{CrackEnd, Point, Scene, TipState};
use fissure_tests::{distance, example, last_frame};

/// Coarse enough for every change; the examples' own resolution is finer.
const COARSE: [&str; 2] = ["grid.particle_spacing=0.25", "frames.range=\"1-24\""];

fn mirror(scene: &Scene) -> Scene {
    let flip = |p: &mut Point| p.x = -p.x;
    let mut mirrored = scene.clone();
    for body in &mut mirrored.bodies {
        body.region.exterior.iter_mut().for_each(flip);
        body.region.exterior.reverse();
    }
    for crack in &mut mirrored.cracks {
        crack.points.iter_mut().for_each(flip);
    }
    mirrored
}

#[test]
fn the_crack_crosses_the_plate_and_leaves_two_pieces() {
    let scene = example("pull", &COARSE).unwrap();
    let frame = last_frame(&scene).unwrap();
    assert_eq!(frame.tips[0].state, TipState::LeftBody);
    assert_eq!(frame.cracks[0].end, CrackEnd::Mouth);
    // From the top edge to the bottom edge, exactly.
    assert_eq!(frame.cracks[0].rest.last().unwrap().y, -10.0);
    // And down the axis of symmetry, exactly.
    assert!(frame.cracks[0].rest.iter().all(|p| p.x == 0.0), "{:?}", frame.cracks[0].rest);
    let mut pieces = frame.particles.piece.clone();
    pieces.sort_unstable();
    pieces.dedup();
    let area = |piece: u32| frame.particles.piece.iter().filter(|&&p| p == piece).count();
    let large: Vec<u32> = pieces.into_iter().filter(|&p| area(p) > frame.particles.len() / 4).collect();
    assert_eq!(large.len(), 2, "two halves");
    let solids = fissure_post::post_frame(&scene, &frame, &(&scene.output).into()).unwrap();
    assert!(solids.parts.iter().any(|(_, meshes)| !meshes.is_empty()));
}

/// Truth: symmetry. It is exact as long as the crack rests and not when it runs: what lies exactly on a crack counts as
/// above it, which the mirror image has below, and sums go from left to right. What that makes of the path grows along
/// it. Measured: 0.06 cells down to mid height, 0.47 where the crack leaves the plate.
#[test]
fn a_mirrored_plate_cracks_along_the_mirrored_path() {
    let scene = example("pull-rotated", &COARSE).unwrap();
    let path = last_frame(&scene).unwrap().cracks[0].rest.clone();
    let mirrored: Vec<Point> =
        last_frame(&mirror(&scene)).unwrap().cracks[0].rest.iter().map(|p| Point::new(-p.x, p.y)).collect();
    let drawn = scene.cracks[0].points.len();
    assert_eq!(mirrored[..drawn], path[..drawn]);
    let worst = |above: f64| {
        let points = mirrored.iter().filter(|p| p.y > above);
        points.map(|&p| distance(p, &path)).fold(0.0, f64::max) / scene.cell_size
    };
    assert!(worst(0.0) < 0.1 && worst(-11.0) < 0.5, "the paths differ by {} and {} cells", worst(0.0), worst(-11.0));
}

/// A crack that starts slanted turns perpendicular to the pull: it goes down, not on along its own line.
#[test]
fn a_slanted_crack_turns_across_the_pull() {
    let scene = example("pull-rotated", &COARSE).unwrap();
    let path = last_frame(&scene).unwrap().cracks[0].rest.clone();
    let slant = scene.cracks[0].points[1] - scene.cracks[0].points[0];
    let from = scene.cracks[0].points[1];
    let run = path.last().unwrap() - from;
    let angle = |v: fissure_scene::Vector| v.x.atan2(-v.y).abs().to_degrees();
    assert!(angle(slant) > 20.0, "starts {} degrees off", angle(slant));
    assert!(angle(run) < 10.0, "runs {} degrees off", angle(run));
}

/// Every crack point lies within half a cell of the drawn path.
#[test]
fn a_guided_crack_follows_its_guide() {
    let scene = example("pull-guided", &COARSE[..1]).unwrap();
    let guide = scene.cracks[0].end_guide.clone().or(scene.cracks[0].start_guide.clone()).unwrap();
    let mut drawn = scene.cracks[0].points.clone();
    drawn.extend(guide.points.iter().skip(1));
    let frame = last_frame(&scene).unwrap();
    assert_eq!(frame.tips[0].state, TipState::LeftBody);
    let worst = frame.cracks[0].rest.iter().map(|&p| distance(p, &drawn)).fold(0.0, f64::max);
    assert!(worst <= 0.5 * scene.cell_size, "a point lies {worst} m off the guide");
}
