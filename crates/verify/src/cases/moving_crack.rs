//! A crack that is driven at a given speed: K_I before and after it starts.
//!
//! Setup in [`super::stepped_plate`]. The crack rests until 1.5 t_c and then runs at 1500 m/s (0.51 c_R), by a guide
//! with a schedule. Reference (Freund 1990): G = g(v) K_I²/E' with the K_I the resting crack would have, g = A_I k²;
//! that is, J falls by the factor 0.5165 at once, and K_I by k = 0.652. They are compared while the crack runs, from
//! the time on at which the domain has been crossed by waves, to 2.4 t_c. Cells are counted over half the height of the
//! plate.

use super::stepped_plate::{HEIGHT, LENGTH, SteppedPlate};
use crate::case::{Case, Options};
use crate::report::Tally;
use fissure_scene::{Curve, Guide, Point};
use fissure_sim::{SimulationError, StressIntensity, crack_speed_factors, universal_function};
use std::ops::ControlFlow;

pub(crate) const CASE: Case = Case::new(
    "moving-crack",
    "energy release rate of a crack driven at 1500 m/s after a step of tension",
    ("over half the height of the plate", 40.0),
    compute,
)
.family_cells(30.0);

/// Speed [m/s].
const SPEED: f64 = 1500.0;
/// Start and end of the comparison [t_c].
const START: f64 = 1.5;
/// Radius of the domain of J, in cells.
const WIDEST: f64 = 6.0;
const END: f64 = 2.4;

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cells = options.cells_or(CASE.cells.1).round();
    let plate = SteppedPlate { cell_size: 2.0 / cells, toughness: 1e9 };
    let elastic = plate.elastic();
    let arrival = plate.arrival();
    let length = SPEED * (END + 0.1 - START) * arrival;
    let mut problem = plate.problem(END).growing();
    problem.scene.solver.j_radius = Some(WIDEST);
    problem.scene.cracks[0].end_guide = Some(Guide {
        name: "line".into(),
        points: vec![Point::new(LENGTH, HEIGHT), Point::new(LENGTH + length, HEIGHT)],
        strength: 1.0,
        schedule: Curve { points: vec![(START * arrival, 0.0), ((END + 0.1) * arrival, 1.0)] },
        branches: Vec::new(),
    });
    let mut placed = tally.set_up(&problem)?;
    // Until waves have crossed the domain and come back.
    let settled = START * arrival + 2.0 * WIDEST * plate.cell_size / elastic.shear_wave_speed();
    let k = universal_function(&elastic, SPEED);
    let g = crack_speed_factors(&elastic, SPEED)[0] * universal_function(&elastic, SPEED).powi(2);
    let release = |t: f64| plate.mode_1(t).powi(2) / elastic.effective_modulus;
    let mut taken = (f64::NAN, 0.0, 0.0, f64::NAN);
    // Sums of K_I by that of the resting crack: as measured, and as of a tip that moves.
    let mut modes = [0.0; 2];
    let (mut before, mut moving, mut squares) = ((0.0, 0.0), (0.0, 0.0), 0.0);
    tally.run(&mut placed, |now, time| {
        let ratio = now.tips()[0].j_integral / release(time);
        if time > 1.3 * arrival && time < START * arrival {
            before = (before.0 + ratio, before.1 + 1.0);
        } else if time > settled {
            moving = (moving.0 + ratio, moving.1 + 1.0);
            squares += (ratio - g) * (ratio - g);
            let tip = &now.tips()[0];
            let measured = StressIntensity { mode_1: tip.mode_1, mode_2: tip.mode_2 };
            let of_moving = measured.of_moving_tip(tip.j_integral, &elastic, SPEED);
            modes[0] += measured.mode_1 / plate.mode_1(time);
            modes[1] += of_moving.mode_1 / plate.mode_1(time);
            let energies = now.energies();
            if taken.0.is_nan() {
                taken = (energies.crack, 0.0, now.tips()[0].length, energies.crack);
            }
            let length = now.tips()[0].length;
            taken.1 += g * release(time) * (length - taken.2);
            taken.2 = length;
            taken.3 = energies.crack;
        }
        ControlFlow::Continue(())
    })?;
    tally.relative("mean J E'/K_I² at rest", "", before.0 / before.1, 1.0, None);
    tally.relative("mean J E'/K_I² at 1500 m/s", "", moving.0 / moving.1, g, 0.1);
    tally.relative("mean K_I/K_I at rest at 1500 m/s, of J with A_I", "", modes[1] / moving.1, k, 0.05);
    tally.relative("mean K_I/K_I at rest at 1500 m/s, of fields at rest", "", modes[0] / moving.1, k, None);
    let scatter = 100.0 * (squares / moving.1).sqrt() / g;
    tally.absolute("rms of J against the reference at 1500 m/s", "%", scatter, 0.0, None);
    tally.relative("energy taken by ∫G da", "", (taken.3 - taken.0) / taken.1, 1.0, None);
    let run = placed.now().tips()[0].length - LENGTH;
    let asked = SPEED * (END - START) * arrival;
    tally.relative("length run at the end", "m", run, asked, None);
    Ok(())
}
