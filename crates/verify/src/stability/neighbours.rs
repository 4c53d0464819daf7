//! K_I of a crack at rest whose tip has something near, and K_II of one that is pressed together.

use super::{ERRORS, Parameter, StabilityMap};
use crate::cases::closed_crack;
use crate::placed::Placed;
use crate::placement::Placement;
use crate::problem::{Problem, linear_material, rectangle};
use fissure_scene::{BoxSide, PlaneState, Point, Vector};
use fissure_sim::SimulationError;
use std::f64::consts::TAU;

pub(super) const NEAR_THINGS: StabilityMap = StabilityMap {
    name: "near-things",
    title: "Error of K_I of a tip that has something near, against cells a third as large",
    across: Parameter::numbers("distance [cells]", &[1.0, 2.0, 3.0, 4.0, 5.0, 7.0, 10.0]),
    up: Parameter::choices("", &["hole ahead", "hole beside", "tip ahead", "crack beside"]),
    limits: ERRORS,
    run: |distance, kind| {
        let [coarse, fine] = [1.0, 1.0 / 3.0].map(|h| mode_1(distance, kind as u8, h));
        Ok((coarse? / fine? - 1.0).abs())
    },
};

pub(super) const PRESSED: StabilityMap = StabilityMap {
    name: "pressed",
    title: "Error of K_II of a crack that is pressed together, by what it is without friction",
    across: Parameter::numbers("friction", &[0.0, 0.1, 0.2, 0.3, 0.4]),
    up: Parameter::numbers("half the crack [cells]", &[2.0, 3.0, 4.0, 6.0]),
    limits: ERRORS,
    run: |friction, cells| {
        let (found, exact) = closed_crack::mode_2_of_pressed(cells, friction)?;
        Ok((found - exact).abs())
    },
};

/// Length of the crack, and radius of a hole, in the larger cells [m].
const CRACK: f64 = 8.0;
const RADIUS: f64 = 3.0;
const STRESS: f64 = 1e3;
const REST: f64 = 1e-8;
const MOST_STEPS: u64 = 30_000;

/// K_I of a crack in a plate of 24 m by 36 m with something so near [m], in cells of `h` [m].
fn mode_1(distance: f64, kind: u8, h: f64) -> Result<f64, SimulationError> {
    let (width, height, at) = (24.0, 36.0, 18.2);
    let mut plate = rectangle((0.0, 0.0), (width, height));
    let mut hole = |middle: Point| {
        let corner = |k: u8| {
            let angle = -TAU * f64::from(k) / 48.0;
            middle + Vector::new(angle.cos(), angle.sin()) * RADIUS
        };
        plate.holes.push((0..48).map(corner).collect());
    };
    match kind {
        0 => hole(Point::new(CRACK + distance + RADIUS, at)),
        1 => hole(Point::new(CRACK, at + distance + RADIUS)),
        _ => {}
    }
    let mut problem = Problem::new("plate", plate, linear_material(), PlaneState::Strain, h)
        .at_rest()
        .crack(&[(0.0, at), (CRACK, at)], [false, true])
        .traction(BoxSide::Top, 0.0, STRESS)
        .traction(BoxSide::Bottom, 0.0, -STRESS);
    match kind {
        2 => problem = problem.crack(&[(width, at), (CRACK + distance, at)], [false, true]),
        3 => problem = problem.crack(&[(CRACK - 4.0, at + distance), (CRACK + 4.0, at + distance)], [true, true]),
        _ => {}
    }
    let mut placed = Placed::new(&problem.scene, Placement::NATURAL)?;
    placed.relax(REST, MOST_STEPS)?;
    Ok(placed.now().tips()[0].mode_1)
}
