//! Pieces that a crack has cut off go on sliding along it.

use crate::common::{add_crack, hold, plate, run};
use fissure_scene::{BoxSide, Selection, Vector};
use fissure_sim::Simulation;

/// Truth: Coulomb and Newton. The upper part of a plate slides down the crack through it by g (sin θ − μ cos θ) t²/2,
/// with the friction of crack faces, from the first half cell, in which faces meet, to the second whole one, in which
/// surfaces do; with enough friction it stays.
#[test]
fn a_piece_slides_down_the_crack_that_cut_it_off() {
    let (cell_size, slope) = (0.1, 20_f64.to_radians());
    for (height, friction) in [(0.6, 0.1), (0.633, 0.1), (0.61, 0.6)] {
        let mut scene = plate([2.0, 2.2], cell_size, 0.2);
        add_crack(&mut scene, &[[0.0, height], [2.0, height + 2.0 * slope.tan()]]);
        (scene.cracks[0].start_live, scene.cracks[0].end_live) = (false, false);
        scene.gravity = Vector::new(0.0, -9.81);
        scene.solver.crack_friction = friction;
        hold(&mut scene, Selection::Edge { side: BoxSide::Bottom, bodies: None }, [Some(0.0); 2]);
        let mut simulation = Simulation::new(&scene).unwrap();
        let down = Vector::new(-slope.cos(), -slope.sin());
        for frame in 1..=2 {
            let now = run(&mut simulation, 1).unwrap();
            let crack = &now.cracks[0];
            let slid = (crack.above[0] - crack.below[0]).dot(&down);
            let time = 0.2 * f64::from(frame);
            let exact = 0.5 * 9.81 * (slope.sin() - friction * slope.cos()).max(0.0) * time * time;
            assert!((slid - exact).abs() < 0.01 * cell_size, "{height} {friction}: {slid} for {exact} m");
        }
    }
}
