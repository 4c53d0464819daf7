//! Slanted centre crack in a square plate under vertical tension, at rest: all slants on one grid.
//!
//! Half length a, plate 2b × 2b, a/b = 0.5, the crack turned by β from the horizontal, counter-clockwise. A grid that
//! has a direction of its own would show in the errors growing with β. K_I and K_II are means over both tips, which see
//! the same by symmetry. Reference: own finite element solution (as for the centre crack). Cells are counted along half
//! the crack.

use super::{REST, offsets};
use crate::case::{Case, Options};
use crate::problem::{Problem, linear_material, rectangle};
use crate::report::{Expected, Tally};
use fissure_scene::{BoxSide, PlaneState, Scene};
use fissure_sim::{Simulation, SimulationError, StressIntensity};
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

/// The plate with `cells` cells (of one metre) along half the crack, its centre moved by a part of a cell.
pub(super) fn problem(degrees: f64, cells: f64, offset: [f64; 2]) -> Problem {
    let width = 4.0 * cells;
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let (x, y) = (2.0 * cells + offset[0], 2.0 * cells + offset[1] - 0.5);
    let (dx, dy) = (cells * cosine, cells * sine);
    let square = rectangle((0.0, 0.0), (width, width));
    Problem::new("slanted-crack", square, linear_material(), PlaneState::Strain, 1.0)
        .at_rest()
        .crack(&[(x - dx, y - dy), (x + dx, y + dy)], [true, true])
        .traction(BoxSide::Top, 0.0, TRACTION)
        .traction(BoxSide::Bottom, 0.0, -TRACTION)
}

/// Brings a scene to rest and gives the stress intensities of its two tips.
fn rest(scene: &Scene, tally: &mut Tally<'_>) -> Result<[StressIntensity; 2], SimulationError> {
    let mut simulation = Simulation::new(scene)?;
    let steps = simulation.relax(REST, super::MOST_STEPS)?;
    tally.count(simulation.particles(), steps);
    let tips = simulation.tips();
    Ok([0, 1].map(|t| StressIntensity { mode_1: tips[t].mode_1, mode_2: tips[t].mode_2 }))
}

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cells = options.cells_or(CASE.cells.1).round();
    let unit = TRACTION * (PI * cells).sqrt();
    for (degrees, mode_1, mode_2) in FACTORS {
        let exact = mode_1.hypot(mode_2);
        let angle = mode_2.atan2(mode_1).to_degrees();
        let (mut amplitude, mut mode_angle, mut differ) = (exact, angle, 0.0_f64);
        for offset in offsets(options.all_offsets) {
            tally.say(&format!("slant {degrees}°, centre at {offset:?}"));
            let tips = rest(&problem(degrees, cells, offset).scene, tally)?;
            let [one, two] = [0, 1].map(|mode| {
                let of = |t: &StressIntensity| if mode == 0 { t.mode_1 } else { t.mode_2 };
                0.5 * (of(&tips[0]) + of(&tips[1])) / unit
            });
            if (one.hypot(two) - exact).abs() > (amplitude - exact).abs() {
                amplitude = one.hypot(two);
            }
            let found = two.atan2(one).to_degrees();
            if (found - angle).abs() > (mode_angle - angle).abs() {
                mode_angle = found;
            }
            let apart = (tips[0].mode_1 - tips[1].mode_1).hypot(tips[0].mode_2 - tips[1].mode_2);
            differ = differ.max(apart / (unit * exact));
        }
        tally.relative(format!("√(K_I²+K_II²)/(σ√πa), β {degrees}°, worst"), "", amplitude, exact, 0.02);
        tally.absolute(format!("mode angle, β {degrees}°, worst"), "°", mode_angle, angle, 1.0);
        tally.bound(format!("difference between the tips, β {degrees}°"), "%", 100.0 * differ, Expected::AtMost(2.0));
    }
    Ok(())
}
