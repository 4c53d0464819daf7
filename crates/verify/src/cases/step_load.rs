//! Resting edge crack under a step of tension: K_I over time.
//!
//! Setup in [`super::stepped_plate`]. Reference: K_I = (2σ₀/(1−ν)) √(c_d (t−t_c)(1−2ν)/π) (Freund 1990), compared from
//! 1.2 to 2.64 t_c; an own finite element solution of the same plate agrees with it to 0.3 % there. 40 cells are h =
//! 0.05 m. Cells are counted over half the height of the plate.

use super::stepped_plate::{SteppedPlate, TRACTION};
use crate::case::{Case, Options};
use crate::report::Tally;
use fissure_sim::SimulationError;
use std::ops::ControlFlow;

pub(crate) const CASE: Case = Case::new(
    "step-load",
    "K_I of a resting crack after a step of tension",
    ("over half the height of the plate", 40.0),
    compute,
);

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cells = options.cells_or(CASE.cells.1).round();
    // A stiff normaliser for what should be zero.
    let unit = TRACTION * 2.0_f64.sqrt();
    let plate = SteppedPlate { cell_size: 2.0 / cells, toughness: 1e30 };
    let mut placed = tally.set_up(&plate.problem(2.7))?;
    let arrival = plate.arrival();
    let effective = plate.elastic().effective_modulus;
    let (mut squares, mut squares_of_j) = (0.0, 0.0);
    let (mut sum, mut count, mut mode_2, mut early) = (0.0, 0.0, 0.0_f64, 0.0_f64);
    tally.run(&mut placed, |now, time| {
        let tip = &now.tips()[0];
        if time < arrival {
            early = early.max(tip.mode_1.abs() / unit);
        }
        if (1.2..=2.64).contains(&(time / arrival)) {
            let error = tip.mode_1 / plate.mode_1(time) - 1.0;
            squares += error * error;
            let of_j = (effective * tip.j_integral.max(0.0)).sqrt() / plate.mode_1(time) - 1.0;
            squares_of_j += of_j * of_j;
            sum += error;
            count += 1.0;
            mode_2 = mode_2.max((tip.mode_2 / tip.mode_1).abs());
        }
        ControlFlow::Continue(())
    })?;
    let of = "1.2 to 2.64 t_c";
    tally.absolute(format!("rms error of K_I, {of}"), "%", 100.0 * (squares / count).sqrt(), 0.0, 1.0);
    tally.absolute(format!("rms error of √(E'J), {of}"), "%", 100.0 * (squares_of_j / count).sqrt(), 0.0, None);
    tally.absolute(format!("mean error of K_I, {of}"), "%", 100.0 * sum / count, 0.0, None);
    tally.absolute(format!("largest |K_II|/K_I, {of}"), "%", 100.0 * mode_2, 0.0, None);
    tally.absolute("largest K_I/(σ₀√h) before t_c", "", early, 0.0, None);
    Ok(())
}
