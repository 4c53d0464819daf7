//! Two equal notches facing each other in the edges of a long plate under tension, at rest.
//!
//! Notches of length a in a plate of width 2b and height 6b, at mid height. Reference: K_I = σ√(πa) (1.122 − 0.561 x −
//! 0.205 x² + 0.471 x³ − 0.190 x⁴)/√(1 − x), x = a/b (Benthem & Koiter 1972; Tada, Paris & Irwin 2000: 0.5 % for any
//! x). Cells are counted along a notch.

use crate::case::{Case, Options};
use crate::problem::{Problem, linear_material, rectangle};
use crate::report::{Expected, Tally};
use fissure_scene::{BoxSide, PlaneState};
use fissure_sim::SimulationError;
use std::f64::consts::PI;

pub(crate) const CASE: Case = Case::new(
    "double-notch",
    "K_I of two notches that face each other in a plate under tension",
    ("along a notch", 8.0),
    compute,
);

/// σ [Pa].
const TRACTION: f64 = 1e3;

/// K_I/(σ√(πa)).
fn factor(x: f64) -> f64 {
    (1.122 - 0.561 * x - 0.205 * x.powi(2) + 0.471 * x.powi(3) - 0.190 * x.powi(4)) / (1.0 - x).sqrt()
}

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    // In cells, one cell being one metre.
    let length = options.cells_or(CASE.cells.1).round();
    for ratio in [0.25, 0.5] {
        let of = format!("a/b {ratio}");
        tally.say(&of);
        let half_width = length / ratio;
        let (width, height) = (2.0 * half_width, 6.0 * half_width);
        let plate = rectangle((0.0, 0.0), (width, height));
        let at = 0.5 * height;
        let problem = Problem::new("double-notch", plate, linear_material(), PlaneState::Strain, 1.0)
            .at_rest()
            .crack(&[(0.0, at), (length, at)], [false, true])
            .crack(&[(width, at), (width - length, at)], [false, true])
            .traction(BoxSide::Top, 0.0, TRACTION)
            .traction(BoxSide::Bottom, 0.0, -TRACTION);
        let tips = tally.rest(&problem)?.now().tips();
        let unit = TRACTION * (PI * length).sqrt();
        for (name, tip) in ["left", "right"].into_iter().zip(&tips) {
            tally.relative(format!("K_I/(σ√πa), {of}, {name} tip"), "", tip.mode_1 / unit, factor(ratio), 0.015);
        }
        let mode_2 = 100.0 * tips.iter().map(|tip| (tip.mode_2 / tip.mode_1).abs()).fold(0.0, f64::max);
        tally.bound(format!("|K_II|/K_I, {of}"), "%", mode_2, Expected::AtMost(1.0));
    }
    Ok(())
}
