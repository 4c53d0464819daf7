//! The number of threads changes nothing.

use crate::common::{add_crack, plate, rectangle, run, set_velocity};
use fissure_scene::{Scene, Selection};
use fissure_sim::Simulation;

/// A plate of 150 × 150 cells, more nodes than the total formulation takes in one thread, that is torn apart: the crack
/// grows from the second step on.
fn torn_plate() -> Scene {
    let mut scene = plate([15.0, 15.0], 0.1, 5e-4);
    scene.materials[0].fracture_toughness = 1e3;
    add_crack(&mut scene, &[[0.0, 7.53], [4.0, 7.53], [4.9, 7.61]]);
    set_velocity(&mut scene, Selection::Region(rectangle([0.0, 7.5], [15.0, 15.0])), [0.2, 1.0]);
    set_velocity(&mut scene, Selection::Region(rectangle([0.0, 0.0], [15.0, 7.5])), [0.0, -1.0]);
    scene
}

/// Truth: one thread. The whole state, byte for byte, and the frame.
#[test]
fn two_threads_give_the_bytes_of_one() {
    let scene = torn_plate();
    let takes = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut simulation = Simulation::new(&scene).unwrap();
            let length = simulation.frame().tips[0].length;
            let frames: Vec<_> =
                (0..2).map(|_| (run(&mut simulation, 1).unwrap(), simulation.save().unwrap())).collect();
            assert!(frames[1].0.tips[0].length > length + 3.0 * scene.cell_size, "the crack grows");
            frames
        })
    });
    for (one, two) in takes[0].iter().zip(&takes[1]) {
        assert!(one.1 == two.1, "the states differ");
        assert!(one.0 == two.0, "the frames differ");
    }
}
