//! Every example, coarse: what its page says of it is true.
#![allow(clippy::unwrap_used)]

use fissure_scene::{CrackEnd, Frame, Point, Scene, TipState};
use fissure_tests::{example, last_frame};

fn run(name: &str, overrides: &[&str]) -> (Scene, Frame) {
    let scene = example(name, overrides).unwrap();
    let frame = last_frame(&scene).unwrap();
    // Whatever else is true of it: the solids can be made.
    fissure_post::post_frame(&scene, &frame, &(&scene.output).into()).unwrap();
    (scene, frame)
}

fn in_state(frame: &Frame, state: TipState) -> usize {
    frame.tips.iter().filter(|t| t.state == state).count()
}

/// Pieces of more than `least` particles.
fn pieces(frame: &Frame, least: usize) -> usize {
    let mut counts = std::collections::BTreeMap::<u32, usize>::new();
    for &piece in &frame.particles.piece {
        *counts.entry(piece).or_default() += 1;
    }
    counts.values().filter(|&&n| n > least).count()
}

fn length(frame: &Frame, crack: usize) -> f64 {
    fissure_scene::polyline_length(&frame.cracks[crack].rest)
}

/// The published experiment (Ingraffea & Grigoriu 1990, specimen II): the crack passes the lowest hole and ends in the middle one.
#[test]
fn the_bent_beam_cracks_into_its_middle_hole() {
    let (_, frame) = run("three-holes", &["grid.particle_spacing=0.003175"]);
    assert_eq!(frame.cracks[0].end, CrackEnd::Mouth);
    let inch = 0.0254;
    let end = frame.cracks[0].rest.last().unwrap();
    let off = (end - Point::new(6.0 * inch, 4.75 * inch)).norm() / inch - 0.25;
    assert!(off.abs() < 0.01, "ends {off} inches off the ring of the middle hole");
}

#[test]
fn the_struck_pane_cracks_and_its_cracks_divide() {
    let (scene, frame) = run("glass-impact", &["grid.particle_spacing=0.003", "frames.range=\"1-21\""]);
    assert!(frame.cracks.len() >= scene.cracks.len() + 3, "{} cracks", frame.cracks.len());
    // None faster than measured in glass.
    let interval = 1.0 / scene.frames.rate;
    let increment = scene.growth.increment * scene.cell_size / interval;
    for tip in &frame.tips {
        assert!(tip.speed <= 1500.0 + 4.0 * increment, "{}", tip.speed);
    }
}

#[test]
fn the_cracks_in_mud_meet_and_leave_polygons() {
    let (_, frame) = run("mud", &["grid.particle_spacing=0.02", "frames.range=\"1-32\""]);
    let (met, left) = (in_state(&frame, TipState::MetCrack), in_state(&frame, TipState::LeftBody));
    assert!(met > 30, "{met} tips met a crack");
    assert!(met > 2 * left, "{left} reached the outline");
    assert!(pieces(&frame, 20) > 8, "{} polygons", pieces(&frame, 20));
}

/// Every new point of the cracks lies where the paint is dark: within the dark half of the toughness.
#[test]
fn painted_cracks_stay_in_the_paint() {
    let (scene, frame) = run("painted", &["grid.particle_spacing=0.002", "frames.range=\"1-36\""]);
    for (drawn, crack) in scene.cracks.iter().zip(&frame.cracks) {
        let added = crack.rest.len() - drawn.points.len();
        assert!(added > 50, "{added} points");
    }
    let start = 0.18 - 2.0 * scene.cell_size;
    let new = frame.cracks.iter().flat_map(|c| &c.rest).filter(|p| p.x.abs() < start);
    let (mut dark, mut all) = (0, 0);
    for &p in new {
        all += 1;
        dark += usize::from(scene.toughness_factor(0, p) < 0.575);
    }
    assert!(dark as f64 > 0.97 * all as f64, "{dark} of {all} points lie in the dark");
}

/// The crack goes below the stiff disc without entering it, then down to the soft one.
#[test]
fn the_crack_shuns_the_stiff_and_seeks_the_soft() {
    let (scene, frame) = run("two-materials", &["grid.particle_spacing=0.0025"]);
    let path = &frame.cracks[0].rest;
    let [stiff, soft] = [0, 1].map(|i| &scene.bodies[0].inclusions[i].region);
    assert!(path.iter().all(|&p| !stiff.contains(p) || p.x < -0.06), "enters the stiff disc");
    let below = path.iter().filter(|p| (-0.04..-0.03).contains(&p.x)).all(|p| p.y < -0.01);
    assert!(below, "goes straight on through the stiff disc");
    assert!(path.iter().any(|&p| soft.contains(p)), "misses the soft disc");
}

#[test]
fn dropped_discs_crack_where_they_land() {
    for name in ["drop-jello", "drop-snow", "drop-pmma", "drop-glass"] {
        let (scene, frame) = run(name, &["grid.particle_spacing=3", "grid.cell_size=6", "frames.range=\"1-30\""]);
        assert!(
            frame.particles.position.iter().all(|p| p.y > -0.5 * scene.cell_size),
            "{name} falls through the floor"
        );
        if name == "drop-glass" || name == "drop-pmma" {
            let grown = length(&frame, 0) - fissure_scene::polyline_length(&scene.cracks[0].points);
            assert!(grown > 4.0 * scene.cell_size, "{name}: the crack grows by {grown} m");
        }
    }
}

#[test]
fn the_letters_crack_along_their_guides() {
    let (scene, frame) = run("logo", &["grid.particle_spacing=0.03", "frames.range=\"1-30\""]);
    for (drawn, crack) in scene.cracks.iter().zip(&frame.cracks) {
        let guide = drawn.start_guide.as_ref().or(drawn.end_guide.as_ref()).unwrap();
        let off = crack.rest.iter().map(|&p| {
            let to = |l: &[Point]| fissure_tests::distance(p, l);
            to(&drawn.points).min(to(&guide.points))
        });
        assert!(off.fold(0.0, f64::max) < 0.5 * scene.cell_size, "{} leaves its guide", drawn.name);
    }
    assert!(in_state(&frame, TipState::LeftBody) >= 2);
}
