//! Centre crack of length 2a in a plate of width 2b and height H under uniform traction at both ends, at rest.
//!
//! Reference: own finite element solution (graded quadratic mesh, domain interaction integral, converged to 1e-4); its
//! long plates agree with Tada's formula for centre cracks to 0.1 %. Cells are counted along half the crack.

use crate::case::{Case, Options};
use crate::interpolate::polynomial;
use crate::problem::{Problem, linear_material, rectangle};
use crate::report::{Expected, Tally};
use fissure_scene::{BoxSide, PlaneState};
use fissure_sim::SimulationError;
use std::f64::consts::{FRAC_PI_2, PI};

pub(crate) const CASE: Case = Case::new(
    "center-crack",
    "K_I at both tips of a centre crack in plates under tension",
    ("along half the crack", 16.0),
    compute,
)
.family_cells(10.0);

/// (a/b, K_I/(σ√(πa)) for H/2b = 0.5, 1, 3).
const FACTORS: [(f64, [f64; 3]); 6] = [
    (0.2, [1.1746, 1.0554, 1.0246]),
    (0.3, [1.3708, 1.1232, 1.0578]),
    (0.4, [1.6293, 1.2161, 1.1094]),
    (0.5, [1.9671, 1.3337, 1.1867]),
    (0.6, [2.4241, 1.4807, 1.3033]),
    (0.7, [3.0395, 1.6771, 1.4883]),
];
/// H/2b of the columns.
const HEIGHTS: [f64; 3] = [0.5, 1.0, 3.0];
/// σ [Pa].
const TRACTION: f64 = 1e3;

/// K_I/(σ√(πa)) for any a/b of the table: divided by Feddersen's √sec the table is smooth, and a polynomial passes
/// through its entries.
pub(super) fn factor(column: usize, ratio: f64) -> f64 {
    let secant = |x: f64| (FRAC_PI_2 * x).cos().sqrt().recip();
    polynomial(&FACTORS.map(|(x, f)| (x, f[column] / secant(x))), ratio) * secant(ratio)
}

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cells = options.cells_or(CASE.cells.1).round();
    for (column, ratio) in [(0, 0.3), (0, 0.5), (1, 0.3), (1, 0.5), (2, 0.5)] {
        let of = format!("H/2b {}, a/b {ratio}", HEIGHTS[column]);
        tally.say(&of);
        // In cells, one cell being one metre.
        let half_width = (cells / ratio).round();
        let (width, height) = (2.0 * half_width, 2.0 * half_width * HEIGHTS[column]);
        let at = 0.5 * height;
        let problem = Problem::new(
            "center-crack",
            rectangle((0.0, 0.0), (width, height)),
            linear_material(),
            PlaneState::Strain,
            1.0,
        )
        .at_rest()
        .crack(&[(half_width - cells, at), (half_width + cells, at)], [true, true])
        .traction(BoxSide::Top, 0.0, TRACTION)
        .traction(BoxSide::Bottom, 0.0, -TRACTION);
        let tips = tally.rest(&problem)?.now().tips();
        let exact = factor(column, cells / half_width);
        let unit = TRACTION * (PI * cells).sqrt();
        for (name, tip) in ["left", "right"].into_iter().zip(&tips) {
            tally.relative(format!("K_I/(σ√πa), {of}, {name} tip"), "", tip.mode_1 / unit, exact, 0.02);
        }
        let differ = 100.0 * (tips[0].mode_1 / tips[1].mode_1 - 1.0).abs();
        tally.bound(format!("difference between the tips, {of}"), "%", differ, Expected::AtMost(1.0));
        let mode_2 = 100.0 * tips.iter().map(|tip| (tip.mode_2 / tip.mode_1).abs()).fold(0.0, f64::max);
        tally.bound(format!("|K_II|/K_I, {of}"), "%", mode_2, Expected::AtMost(1.0));
    }
    Ok(())
}
