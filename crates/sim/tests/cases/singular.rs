//! The states of a crack in which something vanishes or coincides. Each runs in both formulations and must keep every
//! number finite.

use crate::common::{add_crack, add_traction, finite, guide, plate, pull, run, updated};
use fissure_scene::{BoxSide, CrackEnd, End, Formulation, Frame, Point, Scene, TipRecord, TipState};
use fissure_sim::Simulation;
use std::f64::consts::PI;

/// A plate of 16 × 16 cells of 0.5 m; nodes at multiples of 0.5 m, particles at 0.125 m + multiples of 0.25 m. Frames
/// are about as long as a wave takes across.
fn small_plate() -> Scene {
    let mut scene = plate([8.0, 8.0], 0.5, 5e-3);
    scene.materials[0].fracture_toughness = 8e5;
    scene
}

const STRESS: f64 = 1e6;

/// Runs some frames of a scene in both formulations; the last frames.
fn both(name: &str, scene: &Scene, frames: usize) -> [Frame; 2] {
    [scene.clone(), updated(scene.clone())].map(|scene| {
        let mut simulation = Simulation::new(&scene).unwrap_or_else(|e| panic!("{name}: {e}"));
        let mut last = simulation.frame();
        finite(name, &last);
        for _ in 0..frames {
            last = run(&mut simulation, 1).unwrap_or_else(|e| panic!("{name}, {:?}: {e}", scene.solver.formulation));
            finite(name, &last);
        }
        last
    })
}

fn tip(frame: &Frame, crack: u32, end: End) -> &TipRecord {
    frame.tips.iter().find(|t| t.crack == crack && t.end == end).expect("the tip has a record")
}

/// How many fragments there are.
fn pieces(frame: &Frame) -> usize {
    let mut pieces = frame.particles.piece.clone();
    pieces.sort_unstable();
    pieces.dedup();
    pieces.len()
}

/// Truth: nothing acts, nothing happens.
#[test]
fn nothing_happens_in_the_first_step_and_without_loads() {
    let mut scene = small_plate();
    add_crack(&mut scene, &[[0.0, 4.1], [3.1, 4.2]]);
    for frame in both("rest", &scene, 1) {
        let t = tip(&frame, 0, End::End);
        assert_eq!(t.state, TipState::Resting);
        let all = [t.j_integral, t.mode_1, t.mode_2, t.kink_angle, t.equivalent, t.speed];
        assert_eq!(all.map(f64::to_bits), [0; 6], "{t:?}");
        assert_eq!(t.position, Point::new(3.1, 4.2));
        assert_eq!(frame.particles.position, frame.particles.rest);
    }
}

/// Truth: symmetry, K_II = 0: no shear at rest, and the crack runs straight on. On a grid line (all nodes on the
/// crack), between, and through a row of particles.
#[test]
fn a_symmetric_crack_runs_straight() {
    let lines = [("grid line", 4.0, 3.13), ("node", 4.0, 3.0), ("between", 4.25, 3.13), ("particles", 4.125, 3.125)];
    for (name, y, tip_x) in lines {
        let mut scene = small_plate();
        add_crack(&mut scene, &[[0.0, y], [tip_x, y]]);
        pull(&mut scene, STRESS);
        for scene in [scene.clone(), updated(scene.clone())] {
            let mut simulation = Simulation::new(&scene).unwrap();
            simulation.relax(1e-6, 3000).unwrap();
            let frame = simulation.frame();
            finite(name, &frame);
            let t = tip(&frame, 0, End::End);
            // Measured: 2.2 % where the crack runs a quarter cell above the middle of the plate, less elsewhere.
            assert!(t.mode_1 > 6e6 && (t.mode_2 / t.mode_1).abs() < 0.03, "{name}: {t:?}");
        }
        for frame in both(name, &scene, 5) {
            let t = tip(&frame, 0, End::End);
            assert_eq!(t.state, TipState::LeftBody, "{name}: {t:?}");
            let worst = frame.cracks[0].rest.iter().map(|p| (p.y - y).abs()).fold(0.0, f64::max);
            assert!(worst < 0.5 * scene.cell_size, "{name}: off by {worst} m");
        }
    }
}

/// Truth: K_I = 0 and K_II = τ √(π a) of a short central crack in pure shear; the kink at ∓70.53° (maximum hoop
/// stress).
#[test]
fn pure_shear_kinks_by_seventy_degrees() {
    for sign in [1.0, -1.0] {
        for contact in [true, false] {
            let mut scene = small_plate();
            scene.growth.enabled = false;
            scene.solver.crack_contact = contact;
            add_crack(&mut scene, &[[2.6, 4.03], [5.4, 4.03]]);
            for (side, direction) in [
                (BoxSide::Top, [1.0, 0.0]),
                (BoxSide::Bottom, [-1.0, 0.0]),
                (BoxSide::Right, [0.0, 1.0]),
                (BoxSide::Left, [0.0, -1.0]),
            ] {
                add_traction(&mut scene, side, direction.map(|x| x * sign * STRESS));
            }
            for scene in [scene.clone(), updated(scene.clone())] {
                let mut simulation = Simulation::new(&scene).unwrap();
                simulation.relax(1e-6, 3000).unwrap();
                let frame = simulation.frame();
                finite("shear", &frame);
                // A smooth kernel makes the crack act longer: 16 % more with the quadratic one, 9 % without.
                let most = if scene.solver.formulation == Formulation::Total { 1.1 } else { 1.2 };
                for t in &frame.tips {
                    let ratio = sign * t.mode_2 / (STRESS * (PI * 1.4).sqrt());
                    assert!((1.0..most).contains(&ratio), "{t:?}");
                    assert!((t.mode_1 / t.mode_2).abs() < 0.02, "{t:?}");
                    assert!((t.kink_angle.to_degrees() + sign * 70.53).abs() < 0.5, "{t:?}");
                }
            }
        }
    }
}

/// Truth: a crack pressed together does not open and does not grow, with contact and without.
#[test]
fn a_closed_crack_does_not_grow() {
    // Without contact the faces go through each other by .075 m. In the updated formulation material that has passed
    // the crack belongs to its other side, so that rows of particles have to keep more than half of that from it. The
    // crack lies near the middle of the plate: a quarter of a metre off, the waves of the load meet it one after the
    // other, and K_II is 4 % of a K_I of 17 K_Ic.
    for (contact, y) in [(true, 4.13), (true, 4.25), (false, 4.2), (false, 4.25), (false, 4.3)] {
        let mut scene = plate([8.0, 8.5], 0.5, 5e-3);
        scene.materials[0].fracture_toughness = 8e5;
        scene.solver.crack_contact = contact;
        add_crack(&mut scene, &[[0.0, y], [3.1, y]]);
        pull(&mut scene, -STRESS);
        for frame in both(&format!("closed {contact}"), &scene, 6) {
            let t = tip(&frame, 0, End::End);
            assert_eq!(t.state, TipState::Resting, "contact {contact}: {t:?}");
            let overlap = frame.cracks[0].below[0].y - frame.cracks[0].above[0].y;
            if contact {
                assert_eq!(t.mode_1, 0.0, "{t:?}");
                assert!(overlap < 1e-3 * scene.cell_size, "{overlap} m");
            } else {
                assert!(t.mode_1 < -5e6 && overlap > 0.01 * scene.cell_size, "{t:?}");
            }
        }
    }
}

/// Tips exactly where the lattice has something, close to each other, and cracks smaller than a cell: all of them grow
/// under a pull far above toughness.
#[test]
fn tips_stand_anywhere() {
    let cases: [(&str, &[&[[f64; 2]]]); 8] = [
        ("two tips in one cell", &[&[[0.0, 4.13], [3.9, 4.13]], &[[8.0, 4.13], [4.1, 4.13]]]),
        ("two tips side by side", &[&[[0.0, 4.1], [4.2, 4.1]], &[[8.0, 4.3], [4.1, 4.3]]]),
        ("short crack", &[&[[4.1, 4.1], [4.2, 4.13]]]),
        ("short crack on a node", &[&[[3.95, 4.0], [4.05, 4.0]]]),
        ("one cell from the edge", &[&[[0.0, 4.13], [0.5, 4.13]]]),
        ("one cell on a grid line", &[&[[0.0, 4.0], [0.5, 4.0]]]),
        ("tip on a particle", &[&[[0.0, 4.0], [3.125, 4.125]]]),
        ("diagonal through nodes", &[&[[1.0, 1.0], [4.0, 4.0]]]),
    ];
    for (name, cracks) in cases {
        let mut scene = small_plate();
        for points in cracks {
            add_crack(&mut scene, points);
        }
        pull(&mut scene, STRESS);
        for frame in both(name, &scene, 4) {
            assert!(frame.tips.iter().all(|t| t.state != TipState::Resting), "{name}: {:?}", frame.tips);
        }
    }
}

/// A crack that begins on an edge or a corner, exactly, and one that ends there.
#[test]
fn cracks_end_on_edges_and_corners() {
    let cases: [(&str, [[f64; 2]; 2]); 5] = [
        ("edge to edge", [[0.0, 4.1], [8.0, 4.1]]),
        ("edge to edge on a grid line", [[0.0, 4.0], [8.0, 4.0]]),
        ("edge to edge through particles", [[0.0, 4.125], [8.0, 4.125]]),
        ("corner to corner", [[0.0, 0.0], [8.0, 8.0]]),
        ("corner to edge", [[0.0, 0.0], [8.0, 4.1]]),
    ];
    for (name, points) in cases {
        for reverse in [false, true] {
            let mut scene = small_plate();
            let mut points = points;
            if reverse {
                points.reverse();
            }
            add_crack(&mut scene, &points);
            pull(&mut scene, 0.1 * STRESS);
            for frame in both(name, &scene, 2) {
                assert_eq!((frame.cracks[0].start, frame.cracks[0].end), (CrackEnd::Mouth, CrackEnd::Mouth), "{name}");
                assert!(frame.tips.is_empty());
                assert_eq!(pieces(&frame), 2, "{name}, reverse {reverse}");
                let opening =
                    if reverse { -1.0 } else { 1.0 } * (frame.cracks[0].above[3].y - frame.cracks[0].below[3].y);
                assert!(opening > 1e-3, "{name}: {opening}");
            }
        }
    }
    for (name, points) in [("from a corner", [[0.0, 0.0], [3.0, 3.1]]), ("to a corner", [[3.0, 3.1], [0.0, 0.0]])] {
        let mut scene = small_plate();
        add_crack(&mut scene, &points);
        pull(&mut scene, STRESS);
        for frame in both(name, &scene, 4) {
            assert_eq!(frame.tips.len(), 1);
        }
    }
}

/// A ligament of less than half a cell: the crack goes through.
#[test]
fn a_tip_within_half_a_cell_of_the_edge_leaves() {
    let mut scene = small_plate();
    add_crack(&mut scene, &[[0.0, 4.1], [7.8, 4.1]]);
    pull(&mut scene, STRESS);
    for frame in both("ligament", &scene, 2) {
        let t = tip(&frame, 0, End::End);
        assert_eq!(t.state, TipState::LeftBody, "{t:?}");
        assert_eq!(frame.cracks[0].end, CrackEnd::Mouth);
        assert_eq!(frame.cracks[0].rest.last().unwrap().x, 8.0);
        assert_eq!(pieces(&frame), 2);
    }
}

/// Cracks that cross, or of which one ends on the other.
#[test]
fn cracks_meet_in_a_point() {
    let cases: [(&str, [[[f64; 2]; 2]; 2]); 6] = [
        ("X", [[[2.0, 4.1], [6.0, 4.1]], [[4.1, 2.0], [4.1, 6.0]]]),
        ("X on a node", [[[2.0, 4.0], [6.0, 4.0]], [[4.0, 2.0], [4.0, 6.0]]]),
        ("X through particles", [[[2.0, 4.125], [6.0, 4.125]], [[4.125, 2.0], [4.125, 6.0]]]),
        ("X slanted", [[[2.0, 3.0], [6.0, 5.3]], [[4.1, 2.0], [3.9, 6.0]]]),
        ("T", [[[2.0, 4.1], [6.0, 4.1]], [[4.1, 1.0], [4.1, 4.1]]]),
        ("T on a node", [[[2.0, 4.0], [6.0, 4.0]], [[4.0, 1.0], [4.0, 4.0]]]),
    ];
    for (name, cracks) in cases {
        let mut scene = small_plate();
        for points in &cracks {
            add_crack(&mut scene, points);
        }
        pull(&mut scene, STRESS);
        for frame in both(name, &scene, 4) {
            assert!(frame.tips.iter().any(|t| t.state != TipState::Resting), "{name}: {:?}", frame.tips);
        }
    }
}

/// A crack that runs into another one ends exactly on it, and its faces there are apart.
#[test]
fn a_crack_ends_on_the_one_it_meets() {
    for (name, x) in [("between", 5.1), ("on a grid line", 5.0), ("through particles", 5.125)] {
        let mut scene = small_plate();
        add_crack(&mut scene, &[[0.0, 4.13], [3.1, 4.13]]);
        add_crack(&mut scene, &[[x, 2.0], [x, 6.5]]);
        scene.cracks[1].start_live = false;
        scene.cracks[1].end_live = false;
        pull(&mut scene, STRESS);
        for frame in both(name, &scene, 5) {
            let t = tip(&frame, 0, End::End);
            assert_eq!((t.state, frame.cracks[0].end), (TipState::MetCrack, CrackEnd::Junction { crack: 1 }), "{name}");
            assert_eq!(frame.cracks[0].rest.last().unwrap().x, x, "{name}");
            let apart = frame.cracks[0].above.last().unwrap() - frame.cracks[0].below.last().unwrap();
            assert!(apart.y > 1e-3, "{name}: {apart}");
        }
    }
}

/// Truth: two cracks that meet tip to tip are one, wherever a hair lies; half a cell off, the tip stays by itself.
#[test]
fn a_crack_that_runs_into_a_tip_ends_with_it() {
    for (offset, meets) in [(-0.1, true), (-1e-9, true), (0.0, true), (1e-9, true), (0.1, true), (0.6, false)] {
        let name = format!("{offset} m above the tip");
        let mut scene = small_plate();
        add_crack(&mut scene, &[[0.0, 4.13 + offset], [3.1, 4.13 + offset]]);
        add_crack(&mut scene, &[[5.1, 4.13], [5.1, 6.5]]);
        scene.cracks[1].start_live = false;
        pull(&mut scene, STRESS);
        for frame in both(&name, &scene, 5) {
            let (first, second) = (&frame.cracks[0], &frame.cracks[1]);
            let met = (TipState::MetCrack, CrackEnd::Junction { crack: 1 });
            assert_eq!((tip(&frame, 0, End::End).state, first.end), met, "{name}");
            assert_eq!(first.rest.last() == second.rest.first(), meets, "{name}");
            let end = if meets { CrackEnd::Junction { crack: 0 } } else { CrackEnd::Tip };
            assert_eq!(second.start, end, "{name}");
        }
    }
}

/// Truth: counted by hand. A crack drawn to one that parts the plate makes three pieces of it, and opens where it ends.
#[test]
fn a_crack_drawn_to_another_ends_on_it() {
    for (name, x) in [("between", 5.1), ("on a grid line", 5.0), ("through particles", 5.125)] {
        let mut scene = small_plate();
        add_crack(&mut scene, &[[0.0, 4.13], [x, 4.13]]);
        add_crack(&mut scene, &[[x, 0.0], [x, 4.13], [x, 8.0]]);
        for crack in &mut scene.cracks {
            (crack.start_live, crack.end_live) = (false, false);
        }
        pull(&mut scene, STRESS);
        for frame in both(name, &scene, 2) {
            let crack = &frame.cracks[0];
            assert_eq!((crack.start, crack.end), (CrackEnd::Mouth, CrackEnd::Junction { crack: 1 }), "{name}");
            assert_eq!(pieces(&frame), 3, "{name}");
            let apart = crack.above.last().unwrap() - crack.below.last().unwrap();
            assert!(apart.y > 1e-3, "{name}: {apart}");
        }
    }
}

/// Truth: the drawing. The crack follows its guide to the outline and ends there.
#[test]
fn a_guide_ends_exactly_on_the_outline() {
    for (name, path) in [
        ("guide to an edge", [[3.1, 4.13], [5.0, 4.5], [8.0, 4.7]]),
        ("guide to a corner", [[3.1, 4.13], [5.0, 4.5], [8.0, 8.0]]),
    ] {
        let mut scene = small_plate();
        scene.materials[0].fracture_toughness = 4e5;
        add_crack(&mut scene, &[[0.0, 4.13], [3.1, 4.13]]);
        scene.cracks[0].end_guide = Some(guide(&path));
        pull(&mut scene, STRESS);
        for frame in both(name, &scene, 8) {
            let t = tip(&frame, 0, End::End);
            assert_eq!((t.state, frame.cracks[0].end), (TipState::LeftBody, CrackEnd::Mouth), "{name}: {t:?}");
            assert_eq!(frame.cracks[0].rest.last(), Some(&Point::from(path[2])), "{name}");
            assert_eq!(pieces(&frame), 2, "{name}");
        }
    }
}
