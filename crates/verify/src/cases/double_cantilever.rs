//! Double cantilever beam, at rest: J and compliance.
//!
//! Two arms of height h, crack of length a from the loaded end, ligament 6 h. The shear forces ±P on the end faces are
//! spread evenly; the opening D is that of the faces of the crack at its mouth. Cells are counted through one arm; a
//! count of n + ½ puts the crack into the middle of a row of cells, a whole count exactly on a grid line.
//!
//! Reference: J = 12 P² (a + χh)²/(E'h³) and D = 8 P (a + χh)³/(E'h³) with χ = 0.6731 from an own finite element
//! solution for a/h = 3 to 20, independent of ν and plane state; it agrees with Foote & Buchwald 1985 (0.673).

use crate::case::{Case, Options};
use crate::problem::{LINEAR_YOUNG, Problem, linear_material, rectangle, stretch};
use crate::report::{Expected, Tally};
use fissure_scene::{Curve, LoadKind, PlaneState, Vector};
use fissure_sim::{Elastic, SimulationError};

pub(crate) const CASE: Case =
    Case::new("double-cantilever", "J and compliance of a double cantilever beam", ("through one arm", 8.0), compute);

/// Beams clamped elastically: they act longer than the crack by this part of their height.
pub(super) const CORRECTION: f64 = 0.6731;

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cells = options.cells_or(CASE.cells.1);
    for (slenderness, height, plane) in [
        (5.0, cells, PlaneState::Strain),
        (5.0, cells + 0.5, PlaneState::Strain),
        (5.0, cells + 0.5, PlaneState::Stress),
        (10.0, cells, PlaneState::Strain),
        (10.0, cells + 0.5, PlaneState::Strain),
    ] {
        let name = match plane {
            PlaneState::Strain => "strain",
            PlaneState::Stress => "stress",
        };
        let of = format!("a/h {slenderness}, h {height} cells, plane {name}");
        tally.say(&of);
        // In cells, one cell being one metre. The tip is a quarter of a cell beyond a grid line.
        let length = (slenderness * height).floor() + 0.25;
        let material = linear_material();
        let elastic = Elastic::new(&material, plane);
        // A stress of 1e-6 E at the root.
        let force = 1e-6 * LINEAR_YOUNG * height * height / (6.0 * length);
        // Of the end face, with the material to the left.
        let arm = |low: f64| stretch((0.0, low + height), (0.0, low));
        let push = |y: f64| LoadKind::Traction(Vector::new(0.0, y / height));
        let beam = rectangle((0.0, 0.0), ((length + 6.0 * height).ceil(), 2.0 * height));
        let problem = Problem::new("double-cantilever", beam, material, plane, 1.0)
            .at_rest()
            .crack(&[(0.0, height), (length, height)], [false, true])
            .load(arm(height), push(force), Curve::default())
            .load(arm(0.0), push(-force), Curve::default());
        let frame = tally.rest(&problem)?.now().frame();
        let (tip, crack) = (&frame.tips[0], &frame.cracks[0]);
        let beam = length + CORRECTION * height;
        let release = 12.0 * (force * beam).powi(2) / (elastic.effective_modulus * height.powi(3));
        let compliance = 8.0 * (beam / height).powi(3) / elastic.effective_modulus;
        tally.relative(format!("J, {of}"), "J/m²", tip.j_integral, release, 0.03);
        let opening = crack.above[0].y - crack.below[0].y;
        tally.relative(format!("D/P, {of}"), "1/Pa", opening / force, compliance, 0.03);
        let mode_2 = 100.0 * (tip.mode_2 / tip.mode_1).abs();
        tally.bound(format!("|K_II|/K_I, {of}"), "%", mode_2, Expected::AtMost(1.0));
    }
    Ok(())
}
