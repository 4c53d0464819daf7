//! Two equal cracks near each other under tension, at rest: collinear and stacked.
//!
//! Half length a. The reference holds in an infinite plate; here the plate is square, 2b wide with b = 14 a. What its
//! edges do is taken from the single crack: a finite element solution for a square plate raises K by 1.39 (a/b)², 0.7
//! %, and the edges see two cracks by their opened volumes, each in proportion to its own K; the reference is raised by
//! that, by 1.1 to 1.6 %. References: Tada, Paris & Irwin 2000 (collinear, elliptic integrals); own integral equation,
//! accurate to 1e-10 (stacked). Cells are counted along half a crack.

use crate::case::{Case, Options};
use crate::problem::{Problem, linear_material, rectangle};
use crate::report::{Expected, Tally};
use fissure_scene::{BoxSide, PlaneState, TipRecord};
use fissure_sim::SimulationError;
use std::f64::consts::PI;

pub(crate) const CASE: Case = Case::new(
    "crack-pairs",
    "K of two cracks near each other in a wide plate, collinear and stacked",
    ("along half a crack", 8.0),
    compute,
);

/// b/a.
const HALF_WIDTH: f64 = 14.0;
/// What the edges add to K of one crack: this times (a/b)².
const EDGES: f64 = 1.39;
/// (gap/a, K_I/(σ√(πa)) of the inner tips, of the outer tips).
const COLLINEAR: [(f64, f64, f64); 2] = [(0.5, 1.2289, 1.0811), (1.0, 1.1125, 1.0517)];
/// (distance/a, K_I/(σ√(πa)), K_II/(σ√(πa)) of the upper crack's right tip).
const STACKED: [(f64, f64, f64); 2] = [(1.0, 0.7734, -0.1165), (2.0, 0.8431, -0.0611)];
/// σ [Pa].
const TRACTION: f64 = 1e3;

/// Rest under tension; the cracks are given by their left ends relative to the centre of the plate, in half lengths.
fn tips(cells: f64, lefts: [(f64, f64); 2], tally: &mut Tally<'_>) -> Result<Vec<TipRecord>, SimulationError> {
    let middle = HALF_WIDTH * cells;
    let plate = rectangle((0.0, 0.0), (2.0 * middle, 2.0 * middle));
    let mut problem = Problem::new("crack-pairs", plate, linear_material(), PlaneState::Strain, 1.0)
        .at_rest()
        .traction(BoxSide::Top, 0.0, TRACTION)
        .traction(BoxSide::Bottom, 0.0, -TRACTION);
    for (x, y) in lefts {
        let (x, y) = (middle + x * cells, middle + y * cells);
        problem = problem.crack(&[(x, y), (x + 2.0 * cells, y)], [true, true]);
    }
    let unit = TRACTION * (PI * cells).sqrt();
    Ok(tally
        .rest(&problem)?
        .now()
        .tips()
        .into_iter()
        .map(|t| TipRecord { mode_1: t.mode_1 / unit, mode_2: t.mode_2 / unit, ..t })
        .collect())
}

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cells = options.cells_or(CASE.cells.1).round();
    let edges = |mean: f64| 1.0 + EDGES / HALF_WIDTH.powi(2) * 2.0 * mean;
    for (gap, inner, outer) in COLLINEAR {
        tally.say(&format!("collinear, gap {gap} a"));
        let found = tips(cells, [(-2.0 - 0.5 * gap, 0.0), (0.5 * gap, 0.0)], tally)?;
        let edges = edges(0.5 * (inner + outer));
        // In the order left crack start, end, right crack start, end.
        for (name, reference, two) in [("inner", inner, [1, 2]), ("outer", outer, [0, 3])] {
            for (side, tip) in ["left", "right"].into_iter().zip(two) {
                let quantity = format!("K_I/(σ√πa), collinear, gap {gap} a, {name} {side} tip");
                tally.relative(quantity, "", found[tip].mode_1, reference * edges, 0.03);
            }
        }
        let mode_2 = found.iter().map(|t| (t.mode_2 / t.mode_1).abs()).fold(0.0, f64::max);
        tally.bound(format!("|K_II|/K_I, collinear, gap {gap} a"), "%", 100.0 * mode_2, Expected::AtMost(1.0));
    }
    for (distance, mode_1, mode_2) in STACKED {
        tally.say(&format!("stacked, {distance} a apart"));
        let found = tips(cells, [(-1.0, 0.5 * distance), (-1.0, -0.5 * distance)], tally)?;
        let edges = edges(mode_1);
        let of = format!("stacked, {distance} a apart");
        // K_II changes its sign from tip to tip: cracks repel each other.
        for (name, tip, sign) in
            [("upper left", 0, -1.0), ("upper right", 1, 1.0), ("lower left", 2, 1.0), ("lower right", 3, -1.0)]
        {
            tally.relative(format!("K_I/(σ√πa), {of}, {name} tip"), "", found[tip].mode_1, mode_1 * edges, 0.03);
            tally.absolute(
                format!("K_II/(σ√πa), {of}, {name} tip"),
                "",
                found[tip].mode_2,
                sign * mode_2 * edges,
                0.03 * mode_1.hypot(mode_2),
            );
        }
    }
    tally.note("K_II is held to 3 % of √(K_I²+K_II²), which is less than its own size: its sign is right where its target is met");
    Ok(())
}
