//! How much energy appears from nowhere, or goes there, over the length of a step.

use super::{Parameter, StabilityMap};
use crate::problem::{Problem, material, rectangle};
use fissure_scene::{BoxSide, Formulation, PlaneState, Scene, updated_kernel};
use fissure_sim::{Simulation, SimulationError};
use std::ops::ControlFlow;

const STEPS: Parameter = Parameter::numbers(
    "length of a step, by the limit that is predicted",
    &[0.3, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 1.01, 1.3],
);
/// What the plates have, from below: nothing, a crack whose faces may touch, one that grows.
const PLATES: Parameter = Parameter::choices("", &["no crack", "crack with contact", "growing crack"]);
/// Parts of the work done.
const DRIFTS: [f64; 6] = [0.002, 0.005, 0.01, 0.03, 0.1, 0.3];

pub(super) const TOTAL: StabilityMap = StabilityMap {
    name: "time-step-total",
    title: "Energy gained or lost in the total formulation, by the work done",
    across: STEPS,
    up: PLATES,
    limits: DRIFTS,
    run: |part, plate| drift(Formulation::Total, part, plate as u8),
};

pub(super) const UPDATED: StabilityMap = StabilityMap {
    name: "time-step-updated",
    title: "Energy gained or lost in the updated formulation, by the work done",
    across: STEPS,
    up: PLATES,
    limits: DRIFTS,
    run: |part, plate| drift(Formulation::Updated, part, plate as u8),
};

/// A plate of 16 × 24 cells, pulled at two sides while waves cross it some ten times.
fn plate(formulation: Formulation, kind: u8) -> Scene {
    let toughness = if kind == 2 { 4e3 } else { 1e30 };
    let elastic = material(1e9, 0.3, 1000.0, toughness);
    let mut problem = Problem::new("plate", rectangle((0.0, 0.0), (16.0, 24.0)), elastic, PlaneState::Strain, 1.0)
        .traction(BoxSide::Top, 0.0, 1e3)
        .traction(BoxSide::Bottom, 0.0, -1e3)
        .until(0.15, 30);
    if kind > 0 {
        problem = problem.crack(&[(0.0, 12.3), (6.2, 12.3)], [false, true]);
    }
    let scene = &mut problem.scene;
    scene.growth.enabled = kind == 2;
    scene.solver.formulation = formulation;
    if formulation == Formulation::Updated {
        scene.solver.kernel = updated_kernel();
    }
    problem.scene
}

/// Largest difference between the energies there are and the work done, over frames, as a part of the most work done.
fn drift(formulation: Formulation, part: f64, kind: u8) -> Result<f64, SimulationError> {
    let mut scene = plate(formulation, kind);
    scene.solver.time_step = Some(part * Simulation::estimate(&scene)?.stable_time_step);
    let mut simulation = Simulation::new(&scene)?;
    let (mut most, mut work) = (0.0_f64, f64::MIN_POSITIVE);
    while !simulation.is_finished() {
        simulation.advance(&mut |_| ControlFlow::Continue(()))?;
        let energies = simulation.energies();
        work = work.max(energies.external_work.abs());
        most = most.max((simulation.energy_held() + energies.crack - energies.external_work).abs());
    }
    Ok(most / work)
}
