//! The longest step with which a plate stays at peace, beside the one that is predicted; and very many steps.

use super::{Parameter, StabilityMap};
use crate::placement::Placement;
use crate::problem::{LINEAR_YOUNG, Problem, material, rectangle};
use fissure_scene::{Formulation, InitialVelocity, PlaneState, Point, Scene, Selection, Vector, updated_kernel};
use fissure_sim::bench::Bare;
use fissure_sim::{Simulation, SimulationError};
use std::ops::ControlFlow;

pub(super) const REAL_LIMIT: StabilityMap = StabilityMap {
    name: "real-limit",
    title: "By how much the longest stable step is longer than the predicted one",
    across: Parameter::choices(
        "",
        &["square", "turned by 20°", "crack", "crack, no contact", "crack, damped", "stiff inclusion"],
    ),
    up: Parameter::choices("", &["updated", "total"]),
    limits: [0.02, 0.05, 0.1, 0.15, 0.3, 0.6],
    run: |plate, formulation| real_limit(&in_flight(plate_of(plate as u8, formulation > 0.5))),
};

pub(super) const MANY_STEPS: StabilityMap = StabilityMap {
    name: "many-steps",
    title: "Change of the energy of a plate that rings freely in the total formulation",
    across: Parameter::numbers("steps", &[1e3, 1e4, 1e5, 1e6]),
    up: Parameter::choices("", &["square", "crack with contact"]),
    limits: [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1],
    run: |steps, kind| energy_after(&plate_of(if kind < 0.5 { 0 } else { 2 }, true), steps),
};

/// Cells along a side of the plates, and how much stiffer an inclusion is.
const SIDE: f64 = 10.0;
const STIFFER: f64 = 9.0;
/// Steps that a plate is watched for, in which it flies by a cell: particles lie everywhere in their cells. Steps that
/// are too long by a hundredth make more of round-off in them than there are numbers for.
const STEPS: u32 = 3000;
/// Kinetic energy by that of the beginning from which on a plate is not at peace.
const UNSTABLE: f64 = 1e3;
/// The limit is sought up to so many times the predicted one, in so many halvings.
const FARTHEST: f64 = 2.6;
const HALVINGS: u32 = 8;

/// A plate in cells of 1 m, one half of which moves off.
fn plate_of(kind: u8, is_total: bool) -> Scene {
    let elastic = material(LINEAR_YOUNG, 0.3, 1000.0, 1e30);
    let square = rectangle((0.0, 0.0), (SIDE, SIDE));
    let mut problem = Problem::new("plate", square, elastic.clone(), PlaneState::Strain, 1.0).until(1.0, 1);
    if (2..=4).contains(&kind) {
        problem = problem.crack(&[(0.0, 5.3), (4.6, 5.3)], [false, true]);
    }
    let mut scene = problem.scene;
    scene.bodies[0].velocities.push(InitialVelocity {
        selection: Selection::Region(rectangle((-1.0, -1.0), (0.4 * SIDE, SIDE + 1.0))),
        velocity: Vector::new(-1e-3, 0.5e-3),
        angular_velocity: 0.0,
        center: Point::origin(),
    });
    scene.solver.formulation = Formulation::Total;
    if !is_total {
        (scene.solver.formulation, scene.solver.kernel) = (Formulation::Updated, updated_kernel());
    }
    match kind {
        1 => scene = Placement::by_angle(20_f64.to_radians()).place(&scene),
        3 => scene.solver.crack_contact = false,
        4 => scene.solver.damping = 1.0,
        5 => {
            let stiff = fissure_scene::Material { young_modulus: STIFFER * LINEAR_YOUNG, ..elastic };
            scene.materials.push(stiff);
            let region = rectangle((3.0, 3.0), (7.0, 7.0));
            scene.bodies[0].inclusions.push(fissure_scene::Inclusion { region, material: 1 });
        }
        _ => {}
    }
    scene
}

/// The same while all of it flies by a cell within all steps.
fn in_flight(mut scene: Scene) -> Scene {
    // Steps are about half as long as a wave takes for a cell.
    let speed = (LINEAR_YOUNG / 1000.0_f64).sqrt() * 2.0 / f64::from(STEPS);
    scene.bodies[0].velocities.push(InitialVelocity {
        selection: Selection::All,
        velocity: Vector::new(speed, 0.7 * speed),
        angular_velocity: 0.0,
        center: Point::origin(),
    });
    scene
}

/// By what part of the predicted limit the real one is longer [–]; below 0 it is shorter.
fn real_limit(scene: &Scene) -> Result<f64, SimulationError> {
    let is_at_peace = |part: f64| -> Result<bool, SimulationError> {
        let mut solver = Bare::with_step(scene, part)?;
        let first = solver.kinetic_energy();
        for _ in 0..STEPS {
            // What is refused in mid-run has blown up.
            if solver.step().is_err() || solver.kinetic_energy().total_cmp(&(UNSTABLE * first)).is_gt() {
                return Ok(false);
            }
        }
        Ok(true)
    };
    let (mut stable, mut unstable) = (0.0, FARTHEST);
    for _ in 0..HALVINGS {
        let middle = if stable == 0.0 { 1.0 } else { 0.5 * (stable + unstable) };
        if is_at_peace(middle)? {
            stable = middle;
        } else if stable == 0.0 {
            return Ok(-1.0);
        } else {
            unstable = middle;
        }
    }
    Ok(stable - 1.0)
}

/// Change of kinetic and strain energy over so many steps, without its sign, by what there was after the first hundred.
fn energy_after(scene: &Scene, steps: f64) -> Result<f64, SimulationError> {
    const SETTLED: u64 = 100;
    let mut scene = scene.clone();
    // Nobody asks for its K.
    scene.cracks.iter_mut().for_each(|crack| crack.end_live = false);
    let step = 0.9 * Simulation::estimate(&scene)?.stable_time_step;
    scene.solver.time_step = Some(step);
    let frames = 10;
    scene.frames.last = frames;
    scene.frames.rate = frames as f64 / (steps * step);
    let mut simulation = Simulation::new(&scene)?;
    let mut first = None;
    while !simulation.is_finished() {
        simulation.advance_observed(&mut |simulation, now| {
            if now.steps == SETTLED {
                first = Some(simulation.energy_held());
            }
            ControlFlow::Continue(())
        })?;
    }
    Ok((simulation.energy_held() / first.unwrap_or(f64::NAN) - 1.0).abs())
}
