//! Strip with a centre crack under a step of tension at both ends (Chen 1975): K_I over time, waves and reflections.
//!
//! 20 × 40 mm, crack 2a = 4.8 mm across the middle, E = 200 GPa, ν = 0.3, ρ = 5000 kg/m³, plane strain. σ₀ is 4 MPa,
//! because the reference is linear. Reference: own finite element solution (`assets/reference`); published finite
//! difference and finite element peaks are 2.6 to 2.8. Compared until 11 µs: later on the crack closes. The peak is
//! flat; its time is the middle of the interval in which K_I is above 95 % of it. Cells are counted across the width.

use crate::case::{Case, Options};
use crate::interpolate::{columns, linear};
use crate::problem::{Problem, material, rectangle};
use crate::report::Tally;
use fissure_scene::{BoxSide, PlaneState};
use fissure_sim::SimulationError;
use std::f64::consts::PI;
use std::ops::ControlFlow;

pub(crate) const CASE: Case =
    Case::new("strip", "K_I of a centre crack in a strip after a step of tension", ("across the width", 80.0), compute);

const WIDTH: f64 = 0.02;
const HALF_CRACK: f64 = 0.0024;
/// σ₀ [Pa].
const TRACTION: f64 = 4e6;
/// Before this the first peak is over [µs].
const PEAK_OVER: f64 = 8.0;

/// Height of the first peak and the time of its middle.
fn first_peak(curve: &[(f64, f64)]) -> (f64, f64) {
    let until: Vec<_> = curve.iter().filter(|p| p.0 < PEAK_OVER).collect();
    let height = until.iter().map(|p| p.1).fold(0.0, f64::max);
    // Where the level is passed for the first and for the last time, between samples.
    let level = 0.95 * height;
    let passing = |w: &[&(f64, f64)]| w[0].0 + (w[1].0 - w[0].0) * (level - w[0].1) / (w[1].1 - w[0].1);
    let passes = |w: &&[&(f64, f64)]| (w[0].1 < level) != (w[1].1 < level);
    let rise = until.windows(2).find(passes).map_or(f64::NAN, passing);
    let fall = until.windows(2).rev().find(|w| passes(&&w[..])).map_or(f64::NAN, passing);
    (height, 0.5 * (rise + fall))
}

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cell_size = WIDTH / options.cells_or(CASE.cells.1).round();
    let reference: Vec<(f64, f64)> =
        columns(include_str!("../../../../assets/reference/chen_strip.csv")).iter().map(|c| (c[0], c[1])).collect();
    let (reference_height, reference_time) = first_peak(&reference);
    let unit = TRACTION * (PI * HALF_CRACK).sqrt();
    let (x, y) = (0.5 * WIDTH, WIDTH);
    let problem = Problem::new(
        "strip",
        rectangle((0.0, 0.0), (WIDTH, 2.0 * WIDTH)),
        material(200e9, 0.3, 5000.0, 1e30),
        PlaneState::Strain,
        cell_size,
    )
    .crack(&[(x - HALF_CRACK, y), (x + HALF_CRACK, y)], [true, true])
    .traction(BoxSide::Top, 0.0, TRACTION)
    .traction(BoxSide::Bottom, 0.0, -TRACTION)
    .until(11e-6, 20);
    let mut placed = tally.set_up(&problem)?;
    let mut curves = [Vec::new(), Vec::new()];
    tally.run(&mut placed, |now, time| {
        for (curve, tip) in curves.iter_mut().zip(now.tips()) {
            curve.push((1e6 * time, tip.mode_1 / unit));
        }
        ControlFlow::Continue(())
    })?;
    for (name, curve) in ["left", "right"].into_iter().zip(&curves) {
        let (height, time) = first_peak(curve);
        let of = format!("{name} tip");
        tally.relative(format!("first peak of K_I/(σ₀√πa), {of}"), "", height, reference_height, 0.03);
        tally.absolute(format!("middle of the first peak, {of}"), "µs", time, reference_time, 0.2);
        let late = curve.iter().filter(|p| p.0 > 3.0);
        let squares: Vec<f64> = late.map(|p| (p.1 - linear(&reference, p.0)).powi(2)).collect();
        let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        let quantity = format!("rms difference from 3 to 11 µs by the peak, {of}");
        tally.absolute(quantity, "%", 100.0 * rms / reference_height, 0.0, None);
    }
    Ok(())
}
