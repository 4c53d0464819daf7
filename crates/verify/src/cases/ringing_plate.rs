//! A free plate whose halves move apart at first, and which then rings: nothing acts on it, and it keeps what it has.
//!
//! Square of side 1 m, E = 1 GPa, ν = 0.3, ρ = 1000 kg/m³, plane strain; the upper half begins at 1 mm/s upwards, the
//! lower half downwards. References: conservation of energy and of momentum. Kinetic and strain energy are half a step
//! apart, so that their sum ripples; compared are means over the first and over the last quarter of the run, some 60
//! crossings long. Cells are counted along a side.

use crate::case::{Case, Options};
use crate::problem::{Problem, material, rectangle};
use crate::report::{Expected, Tally};
use fissure_scene::{InitialVelocity, PlaneState, Point, Selection, Vector};
use fissure_sim::{Elastic, SimulationError};
use std::ops::ControlFlow;

pub(crate) const CASE: Case =
    Case::new("ringing-plate", "what a free plate keeps that rings", ("along a side", 16.0), compute);

/// Speed of the halves [m/s].
const SPEED: f64 = 1e-3;

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cells = options.cells_or(CASE.cells.1).round();
    let material = material(1e9, 0.3, 1000.0, 1e12);
    let crossing = 1.0 / Elastic::new(&material, PlaneState::Strain).dilatational_wave_speed();
    let time = 60.0 * crossing;
    let square = rectangle((0.0, 0.0), (1.0, 1.0));
    let mut problem = Problem::new("ringing-plate", square, material, PlaneState::Strain, 1.0 / cells).until(time, 100);
    for (low, high, sign) in [(0.51, 1.1, 1.0), (-0.1, 0.51, -1.0)] {
        problem.scene.bodies[0].velocities.push(InitialVelocity {
            selection: Selection::Region(rectangle((-0.1, low), (1.1, high))),
            velocity: Vector::new(0.0, sign * SPEED),
            angular_velocity: 0.0,
            center: Point::origin(),
        });
    }
    let mut placed = tally.set_up(&problem)?;
    let momentum = placed.now().momenta().0;
    let (mut sums, mut counts) = ([0.0; 2], [0.0; 2]);
    tally.run(&mut placed, |now, _| {
        let part = now.time() / time;
        if !(0.25..=0.75).contains(&part) {
            let energies = now.energies();
            let slot = usize::from(part > 0.5);
            sums[slot] += energies.kinetic + energies.strain;
            counts[slot] += 1.0;
        }
        ControlFlow::Continue(())
    })?;
    let change = 100.0 * (sums[1] / counts[1] / (sums[0] / counts[0]) - 1.0);
    tally.absolute("change of energy, first to last quarter", "%", change, 0.0, 1.0);
    // The mass times the first speed.
    let moved = (placed.now().momenta().0 - momentum).norm() / (1000.0 * SPEED);
    tally.bound("change of momentum, by mass times speed", "", moved, Expected::AtMost(1e-11));
    Ok(())
}
