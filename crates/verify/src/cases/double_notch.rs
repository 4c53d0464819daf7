//! Two equal notches facing each other in the edges of a long plate under tension, at rest.
//!
//! Notches of length a in a plate of width 2b and height 6b, at mid height. Reference: own finite elements
//! (pipeline/references/double_notch.py; with elements of half the size it prints the same). The two formulas of Tada,
//! Paris & Irwin 2000 for an endless strip, of .5 % each by what they say, differ by up to 1.8 %: at a/b .25 they have
//! 1.1265 and 1.1183, at .5 1.1841 and 1.1628. Cells are counted along a notch.

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

/// a/b, and K_I/(σ√(πa)).
const FACTORS: [(f64, f64); 2] = [(0.25, 1.1120), (0.5, 1.1693)];

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    // In cells, one cell being one metre.
    let length = options.cells_or(CASE.cells.1).round();
    for (ratio, factor) in FACTORS {
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
            tally.relative(format!("K_I/(σ√πa), {of}, {name} tip"), "", tip.mode_1 / unit, factor, 0.015);
        }
        let mode_2 = 100.0 * tips.iter().map(|tip| (tip.mode_2 / tip.mode_1).abs()).fold(0.0, f64::max);
        tally.bound(format!("|K_II|/K_I, {of}"), "%", mode_2, Expected::AtMost(1.0));
    }
    Ok(())
}
