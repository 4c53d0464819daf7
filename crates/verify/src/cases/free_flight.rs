//! A cracked disc that flies and one that spins: what must not change.
//!
//! Radius a, a slit of length a from the rim to the centre. Flight at 1 % of c_d, 2000 steps; spin at a rim speed of 1
//! % of c_d for ten turns. References: conservation of momentum, angular momentum (to round-off) and energy. Kinetic
//! and strain energy of the solver are half a step apart, so that their sum ripples; energy is therefore compared
//! between the first and the last turn, each as a mean. Strain energy is compared in the same way: after ten turns it
//! is what it was (objectivity). Without contact of the faces; with it, the slit claps as the disc breathes, which
//! costs strain energy, and its impulses act at two places that lie apart by the gap.
//! Cells are counted over the radius.

use crate::case::{Case, Options};
use crate::problem::{Problem, disc, material};
use crate::report::{Expected, Tally};
use fissure_scene::{InitialVelocity, PlaneState, Point, Selection, Vector};
use fissure_sim::{Elastic, SimulationError};
use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

pub(crate) const FLIGHT: Case =
    Case::new("free-flight", "what a flying disc with a slit keeps", ("over the radius", 10.0), flight);
pub(crate) const TURNS: Case =
    Case::new("ten-turns", "what a disc with a slit keeps over ten turns", ("over the radius", 10.0), turns)
        .family_cells(5.0)
        .long();

/// Speed of flight or of the rim as a part of c_d.
const SPEED: f64 = 0.01;

/// The disc, radius 1 m, moving; and its wave speed c_d [m/s].
fn moving(cells: f64, velocity: [f64; 2], angular: f64, contact: bool) -> (Problem, f64) {
    let material = material(1e9, 0.3, 1000.0, 1e30);
    let speed = Elastic::new(&material, PlaneState::Strain).dilatational_wave_speed();
    let mut problem = Problem::new("disc", disc(1.0), material, PlaneState::Strain, 1.0 / cells)
        // Along no line of the grid.
        .crack(&[(-1.0, 0.0), (0.01, 0.013)], [false, true]);
    problem.scene.solver.crack_contact = contact;
    problem.scene.bodies[0].velocities.push(InitialVelocity {
        selection: Selection::All,
        velocity: Vector::new(velocity[0], velocity[1]) * speed,
        angular_velocity: angular * speed,
        center: Point::origin(),
    });
    (problem, speed)
}

fn flight(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cells = options.cells_or(FLIGHT.cells.1).round();
    let (problem, speed) = moving(cells, [0.8 * SPEED, 0.6 * SPEED], 0.0, true);
    // About 2000 steps of half a cell.
    let mut placed = tally.set_up(&problem.until(1000.0 / (cells * speed), 10))?;
    let (before, energy) = (placed.now().momenta(), placed.now().energies());
    tally.run(&mut placed, |_, _| ControlFlow::Continue(()))?;
    let (after, now) = (placed.now().momenta(), placed.now().energies());
    let change = (after.0 - before.0).norm() / before.0.norm();
    tally.bound("change of momentum, relative", "", change, Expected::AtMost(1e-11));
    let change = (now.kinetic + now.strain) / energy.kinetic - 1.0;
    tally.bound("change of energy, relative", "", change.abs(), Expected::AtMost(1e-11));
    let spin = after.1 - before.1;
    let scale = before.0.norm();
    tally.bound("angular momentum gained, by momentum times radius", "", spin.abs() / scale, Expected::AtMost(1e-11));
    Ok(())
}

fn turns(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cells = options.cells_or(TURNS.cells.1).round();
    for contact in [false, true] {
        let of = if contact { "with contact" } else { "without contact" };
        tally.say(of);
        let within = |limit: f64| (!contact).then_some(limit);
        let (problem, speed) = moving(cells, [0.0; 2], SPEED, contact);
        let turn = TAU / (SPEED * speed);
        let mut placed = tally.set_up(&problem.until(10.0 * turn, 10))?;
        let before = placed.now().momenta();
        let (mut energies, mut strains) = ([0.0; 2], [0.0; 2]);
        let (mut counts, mut momentum) = ([0.0; 2], 0.0_f64);
        tally.run(&mut placed, |now, _| {
            let slot = usize::from(now.time() > turn);
            if slot == 0 || now.time() > 9.0 * turn {
                let e = now.energies();
                energies[slot] += e.kinetic + e.strain;
                strains[slot] += e.strain;
                counts[slot] += 1.0;
                momentum = momentum.max(now.momenta().0.norm());
            }
            ControlFlow::Continue(())
        })?;
        let of_last = |sums: [f64; 2]| sums[1] / counts[1] / (sums[0] / counts[0]) - 1.0;
        let turned = placed.now().momenta().1 / before.1 - 1.0;
        tally.absolute(format!("change of angular momentum, relative, {of}"), "", turned, 0.0, within(1e-10));
        // The mass times the rim's speed: what a whole disc moving so fast would have.
        let scale = PI * 1000.0 * SPEED * speed;
        tally.absolute(format!("momentum by mass times rim speed, {of}"), "", momentum / scale, 0.0, within(1e-11));
        let drift = of_last(energies);
        tally.absolute(format!("change of energy, first to tenth turn, relative, {of}"), "", drift, 0.0, within(1e-6));
        let drift = 100.0 * of_last(strains);
        tally.absolute(format!("change of strain energy, first to tenth turn, {of}"), "%", drift, 0.0, within(2.0));
    }
    Ok(())
}
