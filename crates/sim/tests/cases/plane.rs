//! Plane strain and plane stress: what loads alone do differs by the effective modulus.

use crate::common::{POISSON, YOUNG, add_crack, plate, pull, updated};
use fissure_scene::{PlaneState, Scene};
use fissure_sim::Simulation;
use std::f64::consts::PI;

const STRESS: f64 = 1e4;

/// A plate of 10 × 20 m, 20 × 40 cells.
fn pulled(plane: PlaneState) -> Scene {
    let mut scene = plate([10.0, 20.0], 0.5, 1.0);
    scene.plane = plane;
    scene.growth.enabled = false;
    pull(&mut scene, STRESS);
    scene
}

/// Opening of the mouth of an edge crack of 4 m at rest [m].
fn mouth_opening(plane: PlaneState, in_updated: bool) -> f64 {
    let mut scene = pulled(plane);
    add_crack(&mut scene, &[[0.0, 10.13], [4.0, 10.13]]);
    let scene = if in_updated { updated(scene) } else { scene };
    let mut simulation = Simulation::new(&scene).unwrap();
    simulation.relax(1e-8, 4000).unwrap();
    let crack = &simulation.frame().cracks[0];
    crack.above[0].y - crack.below[0].y
}

/// Truth: stresses under tractions alone do not depend on the plane state, displacements across a crack go with 1/E',
/// so that their ratio is 1 − ν². Their size: 4 σ a V/E' with V = [1.46 + 3.42 (1 − cos(πa/2W))]/cos²(πa/2W), within 2
/// % (Tada, Paris & Irwin).
#[test]
fn a_crack_opens_by_the_effective_modulus() {
    for in_updated in [false, true] {
        let strain = mouth_opening(PlaneState::Strain, in_updated);
        let stress = mouth_opening(PlaneState::Stress, in_updated);
        let angle = 0.5 * PI * 0.4;
        let v = (1.46 + 3.42 * (1.0 - angle.cos())) / angle.cos().powi(2);
        let reference = 4.0 * STRESS * 4.0 * v / YOUNG;
        // Measured: -0.35 and -0.02 %.
        assert!((strain / stress / (1.0 - POISSON * POISSON) - 1.0).abs() < 5e-3, "{strain} {stress}");
        // Measured: +1.7 %, and +6.4 % for the wide kernel of the updated formulation.
        let most = if in_updated { 0.08 } else { 0.03 };
        assert!((0.0..most).contains(&(stress / reference - 1.0)), "{stress} {reference}");
    }
}

/// Truth: Hooke. A plate without a crack is stretched by σ/E'.
#[test]
fn a_plate_is_stretched_by_the_effective_modulus() {
    for (plane, modulus) in [(PlaneState::Strain, YOUNG / (1.0 - POISSON * POISSON)), (PlaneState::Stress, YOUNG)] {
        let mut simulation = Simulation::new(&pulled(plane)).unwrap();
        simulation.relax(1e-10, 4000).unwrap();
        let frame = simulation.frame();
        let ring = &frame.outlines[0];
        let (low, high) = fissure_plane::bounds(&ring.position);
        let strain = (high.y - low.y) / 20.0 - 1.0;
        assert!((strain * modulus / STRESS - 1.0).abs() < 1e-5, "{plane:?}: {strain}");
    }
}
