//! The crack-tip equation of motion: how far a crack runs that starts under a step of tension and takes the speed its
//! energy balance asks for.
//!
//! Setup in [`super::stepped_plate`]. The toughness is K_I of the resting crack τ = 0.6 or 0.2 t_c after the step's
//! arrival; the crack starts then and runs straight (`bending` is 0). Reference: g(v(t)) = τ/(t − t_c), g = A_I k² with
//! Freund's universal function k, whatever the history (Freund 1990); integrated here. An own finite element solution
//! driven with this v(t) gives G/G_c = 1.02 to 1.04. 40 cells are h = 0.05 m. Cells are counted over half the height of
//! the plate.

use super::stepped_plate::{LENGTH, SteppedPlate};
use crate::case::{Case, Options};
use crate::report::{Expected, Tally};
use fissure_sim::{Elastic, SimulationError, crack_speed_factors, universal_function};
use std::ops::ControlFlow;

pub(crate) const CASE: Case = Case::new(
    "crack-motion",
    "run of a crack by its own energy balance after a step of tension",
    ("over half the height of the plate", 40.0),
    compute,
)
.family_cells(40.0);

/// τ/t_c, times after the step's begin [t_c], and how near the run should be then, where there is a target. The shorter
/// the delay, the faster the crack.
type Delay = (f64, [(f64, Option<f64>); 4]);
const DELAYS: [Delay; 2] = [
    (0.6, [(2.0, None), (2.2, None), (2.4, Some(0.05)), (2.6, Some(0.05))]),
    (0.2, [(1.6, None), (2.0, None), (2.3, Some(0.05)), (2.6, Some(0.05))]),
];

/// g(v) = A_I(v) k(v)²: energy release rate of the moving crack as a part of that of a resting one at the same place
/// and time.
fn release(elastic: &Elastic, speed: f64) -> f64 {
    crack_speed_factors(elastic, speed)[0] * universal_function(elastic, speed).powi(2)
}

/// v [m/s] at which g has the value `wanted`, 0 to 1: g falls from 1 at rest to 0 at c_R.
fn speed_of(elastic: &Elastic, wanted: f64) -> f64 {
    let (mut low, mut high) = (0.0, elastic.rayleigh_wave_speed());
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if release(elastic, middle) > wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Length run [m] at the time `t`, in delays τ after the arrival; `tau` in s.
fn run(elastic: &Elastic, t: f64, tau: f64) -> f64 {
    const PARTS: usize = 200;
    let step = (t - 1.0) / PARTS as f64;
    // Midpoint rule: g is smooth after the start.
    (0..PARTS).map(|k| speed_of(elastic, 1.0 / (1.0 + step * (k as f64 + 0.5)))).sum::<f64>() * step * tau
}

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    DELAYS.iter().try_for_each(|delay| compute_delay(delay, options, tally))
}

/// The delays one by one: a crack that starts late, and one that starts early and so runs fast.
pub(crate) const LATE: Case = Case::new("crack-motion-late", CASE.about, CASE.cells, compute_late).family_cells(40.0);
pub(crate) const EARLY: Case =
    Case::new("crack-motion-early", CASE.about, CASE.cells, compute_early).family_cells(40.0);

fn compute_late(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    compute_delay(&DELAYS[0], options, tally)
}

fn compute_early(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    compute_delay(&DELAYS[1], options, tally)
}

fn compute_delay((delay, times): &Delay, options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cells = options.cells_or(CASE.cells.1).round();
    let of = format!("τ {delay} t_c");
    tally.say(&of);
    let at_rest = SteppedPlate { cell_size: 2.0 / cells, toughness: 1e30 };
    let arrival = at_rest.arrival();
    let plate = SteppedPlate { toughness: at_rest.mode_1((1.0 + delay) * arrival), ..at_rest };
    let elastic = plate.elastic();
    let mut problem = plate.problem(2.6).growing();
    problem.scene.growth.bending = 0.0;
    let mut placed = tally.set_up(&problem)?;
    let mut history: Vec<(f64, f64)> = vec![(0.0, 0.0)];
    tally.run(&mut placed, |now, _| {
        history.push((now.time(), now.tips()[0].length - LENGTH));
        ControlFlow::Continue(())
    })?;
    let start = history.iter().find(|h| h.1 > 0.0).map_or(f64::NAN, |h| h.0 / arrival);
    tally.absolute(format!("start, {of}"), "t_c", start, 1.0 + delay, 0.05);
    for (t, within) in times {
        let found = crate::interpolate::linear(&history, t * arrival);
        let reference = run(&elastic, (t - 1.0) / delay, delay * arrival);
        tally.relative(format!("Δa at {t} t_c, {of}"), "m", found, reference, *within);
    }
    let fastest = fastest(&history, 4.0 * plate.cell_size) / elastic.rayleigh_wave_speed();
    tally.bound(format!("highest speed over 4 cells, {of}"), "c_R", fastest, Expected::AtMost(1.0));
    Ok(())
}

/// Highest mean speed [m/s] over a length [m] in a history of (time [s], length [m]): the tip moves in increments.
fn fastest(history: &[(f64, f64)], over: f64) -> f64 {
    let mut fastest = 0.0_f64;
    for (i, from) in history.iter().enumerate() {
        if let Some(to) = history[i..].iter().find(|h| h.1 - from.1 >= over) {
            fastest = fastest.max((to.1 - from.1) / (to.0 - from.0));
        }
    }
    fastest
}
