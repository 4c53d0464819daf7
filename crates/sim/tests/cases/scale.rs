//! Small and large alike: a problem has no length of its own.

use crate::common::{add_crack, plate, pull, run};
use fissure_scene::{Point, Scene};
use fissure_sim::Simulation;

/// A plate with a slanted edge crack that turns across the pull, `factor` times as large. Speeds, strains and stresses
/// are the same at any size, so times go with the size and toughness with its root.
fn slanted(factor: f64) -> Scene {
    let mut scene = plate([20.0 * factor, 20.0 * factor], 0.5 * factor, 2e-3 * factor);
    scene.materials[0].fracture_toughness = 2e6 * factor.sqrt();
    let crack = [[0.0, 8.03], [4.03, 10.37]].map(|p| p.map(|x| x * factor));
    add_crack(&mut scene, &crack);
    pull(&mut scene, 1e6);
    scene
}

/// The path after some frames, in units of the size.
fn path(factor: f64) -> Vec<Point> {
    let mut simulation = Simulation::new(&slanted(factor)).unwrap();
    let frame = run(&mut simulation, 40).unwrap();
    frame.cracks[0].rest.iter().map(|p| p / factor).collect()
}

/// Truth: dimensional analysis. Powers of two scale without any rounding: to the bit. Others to round-off.
#[test]
fn a_thousand_times_as_small_or_large_gives_the_same_path() {
    let reference = path(1.0);
    let straight = Point::new(4.03, 10.37) - Point::new(0.0, 8.03);
    let end = reference.last().unwrap();
    assert!(reference.len() > 40, "the crack grows");
    assert!((end - Point::new(0.0, 8.03)).perp(&straight).abs() > 2.0, "and turns");
    for power in [-10, 10] {
        assert_eq!(path(2.0_f64.powi(power)), reference, "2^{power}");
    }
    for factor in [1e-3, 1e3] {
        let scaled = path(factor);
        assert_eq!(scaled.len(), reference.len());
        let worst = scaled.iter().zip(&reference).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        // Relative to the plate of 20 m; measured: 1e-10. Waves reflected at a running crack make round-off grow.
        assert!(worst < 20.0 * 1e-9, "{factor}: {worst:e}");
    }
}
