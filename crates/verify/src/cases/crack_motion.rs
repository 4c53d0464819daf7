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

/// The way of a crack by its energy balance, for one delay.
struct Motion {
    /// Time after the arrival in delays τ, and the way till then over c_R τ.
    points: Vec<(f64, f64)>,
    /// c_R τ [m].
    unit: f64,
}

impl Motion {
    /// `tau` in s. The balance gives the time of each speed, T = 1/g(v), so that a = ∫ v dT needs no inverse.
    fn new(elastic: &Elastic, tau: f64) -> Self {
        const SPEEDS: usize = 2000;
        let rayleigh = elastic.rayleigh_wave_speed();
        let (mut points, mut run) = (vec![(1.0, 0.0)], 0.0);
        for k in 1..SPEEDS {
            let speed = k as f64 / SPEEDS as f64;
            let time = 1.0 / release(elastic, speed * rayleigh);
            let (before, _) = points[k - 1];
            run += (speed - 0.5 / SPEEDS as f64) * (time - before);
            points.push((time, run));
        }
        Self { points, unit: rayleigh * tau }
    }

    /// Length run [m] at the time `t`, in delays τ after the arrival.
    fn run(&self, t: f64) -> f64 {
        crate::interpolate::linear(&self.points, t) * self.unit
    }
}

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    DELAYS.iter().try_for_each(|delay| compute_delay(delay, options, tally).map(drop))
}

/// The delays one by one: a crack that starts late, and one that starts early and so runs fast. Of these the way as a
/// whole counts, [`LARGEST_DISTANCE`]: at single times a way that began too late and went on too fast is right by
/// chance.
pub(crate) const LATE: Case = Case::new("crack-motion-late", CASE.about, CASE.cells, compute_late).family_cells(40.0);
pub(crate) const EARLY: Case =
    Case::new("crack-motion-early", CASE.about, CASE.cells, compute_early).family_cells(40.0);

fn compute_late(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    compute_whole(&DELAYS[0], options, tally)
}

fn compute_early(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    compute_whole(&DELAYS[1], options, tally)
}

/// Row of the largest difference between way and reference over all the time, from the arrival of the step to
/// [`END`], over the way of the reference till then: a crack that never starts has 1.
pub(crate) const LARGEST_DISTANCE: &str = "largest distance from the way";
/// End of the run [t_c]: just before waves come back.
const END: f64 = 2.6;
/// How many times that distance is taken between the arrival and the end.
const TIMES: usize = 400;

fn compute_whole(delay: &Delay, options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let (history, motion) = compute_delay(delay, options, tally)?;
    let whole = motion.run((END - 1.0) / delay.0);
    let apart = |k: usize| {
        let t = 1.0 + (END - 1.0) * k as f64 / TIMES as f64;
        (crate::interpolate::linear(&history, t) - motion.run((t - 1.0) / delay.0)).abs()
    };
    let largest = (0..=TIMES).map(apart).fold(0.0, f64::max) / whole;
    tally.bound(LARGEST_DISTANCE, "", largest, Expected::AtMost(1.0));
    Ok(())
}

/// Times [t_c] and the way until then [m], and the reference.
type History = (Vec<(f64, f64)>, Motion);

fn compute_delay((delay, times): &Delay, options: &Options, tally: &mut Tally<'_>) -> Result<History, SimulationError> {
    let cells = options.cells_or(CASE.cells.1).round();
    let of = format!("τ {delay} t_c");
    tally.say(&of);
    let at_rest = SteppedPlate { cell_size: 2.0 / cells, toughness: 1e30 };
    let arrival = at_rest.arrival();
    let plate = SteppedPlate { toughness: at_rest.mode_1((1.0 + delay) * arrival), ..at_rest };
    let elastic = plate.elastic();
    let mut problem = plate.problem(END).growing();
    problem.scene.growth.bending = 0.0;
    let mut placed = tally.set_up(&problem)?;
    let mut history: Vec<(f64, f64)> = vec![(0.0, 0.0)];
    tally.run(&mut placed, |now, _| {
        history.push((now.time() / arrival, now.tips()[0].length - LENGTH));
        ControlFlow::Continue(())
    })?;
    let start = history.iter().find(|h| h.1 > 0.0).map_or(f64::NAN, |h| h.0);
    tally.absolute(format!("start, {of}"), "t_c", start, 1.0 + delay, 0.05);
    let motion = Motion::new(&elastic, delay * arrival);
    for (t, within) in times {
        let found = crate::interpolate::linear(&history, *t);
        let reference = motion.run((t - 1.0) / delay);
        tally.relative(format!("Δa at {t} t_c, {of}"), "m", found, reference, *within);
    }
    let fastest = fastest(&history, 4.0 * plate.cell_size) / arrival / elastic.rayleigh_wave_speed();
    tally.bound(format!("highest speed over 4 cells, {of}"), "c_R", fastest, Expected::AtMost(1.0));
    Ok((history, motion))
}

/// Highest mean speed over a length [m] in a history of times and lengths [m]: the tip moves in increments.
fn fastest(history: &[(f64, f64)], over: f64) -> f64 {
    let mut fastest = 0.0_f64;
    for (i, from) in history.iter().enumerate() {
        if let Some(to) = history[i..].iter().find(|h| h.1 - from.1 >= over) {
            fastest = fastest.max((to.1 - from.1) / (to.0 - from.0));
        }
    }
    fastest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the same integral by another program, midpoints in time with the speed from bisection, ν = 0.3.
    #[test]
    fn the_way_is_the_integral_of_the_speed() {
        let motion = Motion::new(&SteppedPlate { cell_size: 0.1, toughness: 1.0 }.elastic(), 1.0);
        for (t, expected) in [(1.0, 0.0), (1.5, 0.0913), (2.0, 0.3114), (3.0, 0.9497), (5.0, 2.552), (8.0, 5.231)] {
            let found = motion.run(t) / motion.unit;
            assert!((found - expected).abs() < 6e-4, "{t}: {found}");
        }
    }
}
