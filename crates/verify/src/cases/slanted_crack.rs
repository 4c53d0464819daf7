//! Slanted centre crack in a square plate under vertical tension, at rest: all slants on one grid.
//!
//! Half length a, plate 2b × 2b, a/b = 0.5, the crack turned by β from the horizontal, counter-clockwise. A grid that
//! has a direction of its own would show in the errors growing with β. K_I and K_II are means over both tips, which see
//! the same by symmetry. Reference: own finite element solution (as for the centre crack). Cells are counted along half
//! the crack.

use crate::case::{Case, Options};
use crate::problem::{Problem, linear_material, rectangle};
use crate::report::{Expected, Tally};
use fissure_scene::{BoxSide, PlaneState};
use fissure_sim::SimulationError;
use std::f64::consts::PI;

pub(crate) const CASE: Case = Case::new(
    "slanted-crack",
    "K_I and K_II of slanted centre cracks, all slants on one grid",
    ("along half the crack", 16.0),
    compute,
);

/// (β [°], K_I/(σ√(πa)), K_II/(σ√(πa))) for a/b = 0.5.
pub(super) const FACTORS: [(f64, f64, f64); 4] =
    [(15.0, 1.2484, 0.3058), (30.0, 1.0069, 0.5354), (45.0, 0.6691, 0.6168), (60.0, 0.3339, 0.5283)];
/// σ [Pa].
pub(super) const TRACTION: f64 = 1e3;

/// The plate with `cells` cells (of one metre) along half the crack.
pub(super) fn problem(degrees: f64, cells: f64) -> Problem {
    let width = 4.0 * cells;
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let (x, y) = (2.0 * cells, 2.0 * cells);
    let (dx, dy) = (cells * cosine, cells * sine);
    let square = rectangle((0.0, 0.0), (width, width));
    Problem::new("slanted-crack", square, linear_material(), PlaneState::Strain, 1.0)
        .at_rest()
        .crack(&[(x - dx, y - dy), (x + dx, y + dy)], [true, true])
        .traction(BoxSide::Top, 0.0, TRACTION)
        .traction(BoxSide::Bottom, 0.0, -TRACTION)
}

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cells = options.cells_or(CASE.cells.1).round();
    let unit = TRACTION * (PI * cells).sqrt();
    for (degrees, mode_1, mode_2) in FACTORS {
        tally.say(&format!("slant {degrees}°"));
        let exact = mode_1.hypot(mode_2);
        let tips = tally.rest(&problem(degrees, cells))?.now().tips();
        let one = 0.5 * (tips[0].mode_1 + tips[1].mode_1) / unit;
        let two = 0.5 * (tips[0].mode_2 + tips[1].mode_2) / unit;
        tally.relative(format!("√(K_I²+K_II²)/(σ√πa), β {degrees}°"), "", one.hypot(two), exact, 0.02);
        let (angle, found) = (mode_2.atan2(mode_1).to_degrees(), two.atan2(one).to_degrees());
        tally.absolute(format!("mode angle, β {degrees}°"), "°", found, angle, 1.0);
        let apart = (tips[0].mode_1 - tips[1].mode_1).hypot(tips[0].mode_2 - tips[1].mode_2) / (unit * exact);
        tally.bound(format!("difference between the tips, β {degrees}°"), "%", 100.0 * apart, Expected::AtMost(2.0));
    }
    Ok(())
}
