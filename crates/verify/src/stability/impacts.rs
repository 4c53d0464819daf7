//! A square of jelly that is thrown into a corner.

use super::{Parameter, StabilityMap};
use crate::problem::{Problem, material, rectangle};
use fissure_scene::{
    Collider, ColliderShape, Contact, Formulation, InitialVelocity, OnDistortion, PlaneState, Point, Pose, Selection,
    Vector, updated_kernel,
};
use fissure_sim::{Elastic, Simulation, SimulationError};
use std::ops::ControlFlow;

pub(super) const IMPACTS: StabilityMap = StabilityMap {
    name: "impacts",
    title: "Energy that a square of jelly loses (or gains) when it is thrown into a corner",
    across: Parameter::numbers("speed by c_d (10 m/s are 1.2)", &[0.03, 0.1, 0.2, 0.3, 0.5, 0.8, 1.22, 2.0, 3.0]),
    up: Parameter::choices("", &["updated", "total, switches", "total, stops"]),
    limits: [0.02, 0.05, 0.1, 0.2, 0.4, 0.8],
    run: throw,
};

/// Length of a side, and how far it is from both walls [m].
const SIDE: f64 = 0.2;
const GAP: f64 = 0.02;

/// Change of kinetic and strain energy over the throw, without its sign, by what there was before.
fn throw(mach: f64, kind: f64) -> Result<f64, SimulationError> {
    let jelly = material(5e4, 0.3, 1000.0, 1e30);
    let wave = Elastic::new(&jelly, PlaneState::Strain).dilatational_wave_speed();
    let speed = mach * wave;
    let square = rectangle((GAP, GAP), (GAP + SIDE, GAP + SIDE));
    // The way there, and some crossings of waves that the impact takes.
    let end = 3.0 * GAP / speed + 8.0 * SIDE / wave;
    let mut scene = Problem::new("throw", square, jelly, PlaneState::Strain, 0.01).until(end, 20).scene;
    scene.bodies[0].velocities.push(InitialVelocity {
        selection: Selection::All,
        velocity: Vector::new(-speed, -speed) * 0.5_f64.sqrt(),
        angular_velocity: 0.0,
        center: Point::origin(),
    });
    for normal in [Vector::new(1.0, 0.0), Vector::new(0.0, 1.0)] {
        scene.colliders.push(Collider {
            name: "wall".into(),
            shape: ColliderShape::HalfPlane { normal },
            keyframes: vec![(0.0, Pose { position: Point::origin(), angle: 0.0 })],
            contact: Contact::Separate,
            friction: 0.0,
        });
    }
    let solver = &mut scene.solver;
    (solver.formulation, solver.on_distortion) = match kind as u8 {
        0 => (Formulation::Updated, OnDistortion::Stop),
        1 => (Formulation::Total, OnDistortion::Switch),
        _ => (Formulation::Total, OnDistortion::Stop),
    };
    if solver.formulation == Formulation::Updated {
        solver.kernel = updated_kernel();
    }
    let mut simulation = Simulation::new(&scene)?;
    let before = simulation.energy_held();
    while !simulation.is_finished() {
        simulation.advance(&mut |_| ControlFlow::Continue(()))?;
    }
    Ok((simulation.energy_held() / before - 1.0).abs())
}
