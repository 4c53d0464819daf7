//! Strain energy of a bar between moved ends, wherever these lie in a cell.
//!
//! A bar of n to n + 1 cells by 8 cells, free at its sides, is stretched by d from both ends and comes to rest.
//! Reference (closed form): U = ½ E' (d/L)² L W, E' = E/(1 − ν²) in plane strain. Shown is the height, of 33, at which
//! U is farthest off; upright and lying. Cells are counted along the bar.

use crate::case::{Case, Options};
use crate::problem::{Problem, linear_material, rectangle};
use crate::report::Tally;
use fissure_scene::{BoxSide, Curve, Formulation, PlaneState, Selection, Support, updated_kernel};
use fissure_sim::{Elastic, SimulationError};

pub(crate) const CASE: Case = Case::new(
    "bar-between-supports",
    "strain energy of a bar between moved ends that lie anywhere in a cell",
    ("along the bar, and up to one more", 16.0),
    compute,
);

/// Heights from n to n + 1 cells.
const HEIGHTS: u32 = 33;
/// d/L.
const STRAIN: f64 = 1e-6;
/// Width of the bar, in cells.
const WIDTH: f64 = 8.0;

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cells = options.cells_or(CASE.cells.1).round();
    let modulus = Elastic::new(&linear_material(), PlaneState::Strain).effective_modulus;
    for (formulation, name) in [(Formulation::Total, "total"), (Formulation::Updated, "updated")] {
        for (is_lying, direction) in [(false, "upright"), (true, "lying")] {
            tally.say(&format!("{name}, {direction}"));
            let mut worst = 1.0_f64;
            for k in 0..HEIGHTS {
                let length = cells + f64::from(k) / f64::from(HEIGHTS - 1);
                let mut placed = tally.set_up(&stretched(length, is_lying, formulation))?;
                tally.run_frames(&mut placed, |_| ())?;
                let part = placed.now().energies().strain / (0.5 * modulus * STRAIN * STRAIN * length * WIDTH);
                if (part - 1.0).abs() > (worst - 1.0).abs() {
                    worst = part;
                }
            }
            tally.relative(format!("U by its reference, {name} formulation, {direction}"), "", worst, 1.0, 0.005);
        }
    }
    Ok(())
}

/// A bar whose ends move apart until a third of the time and then rest.
fn stretched(length: f64, is_lying: bool, formulation: Formulation) -> Problem {
    let (size, axis, ends) = match is_lying {
        false => ((WIDTH, length), 1, [BoxSide::Top, BoxSide::Bottom]),
        true => ((length, WIDTH), 0, [BoxSide::Right, BoxSide::Left]),
    };
    let material = linear_material();
    let crossing = length / Elastic::new(&material, PlaneState::Strain).dilatational_wave_speed();
    let time = 12.0 * crossing;
    let name = "bar-between-supports";
    let mut problem = Problem::new(name, rectangle((0.0, 0.0), size), material, PlaneState::Strain, 1.0).until(time, 3);
    let solver = &mut problem.scene.solver;
    // Twice the frequency of the first mode: it comes to rest soonest.
    solver.damping = std::f64::consts::TAU / crossing;
    solver.formulation = formulation;
    if formulation == Formulation::Updated {
        solver.kernel = updated_kernel();
    }
    let moving = time / 3.0;
    for (side, sign) in ends.into_iter().zip([1.0, -1.0]) {
        let mut velocity = [None; 2];
        velocity[axis] = Some(0.5 * sign * STRAIN * length / moving);
        problem.scene.supports.push(Support {
            selection: Selection::Edge { side, bodies: None },
            velocity,
            curve: Curve { points: vec![(0.0, 1.0), (moving, 1.0), (moving * (1.0 + 1e-9), 0.0)] },
        });
    }
    problem
}
