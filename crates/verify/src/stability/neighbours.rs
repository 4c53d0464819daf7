//! K_I of a crack at rest whose tip has something near, and K_II of one that is pressed together.

use super::{ERRORS, Parameter, StabilityMap};
use crate::cases::closed_crack;
use crate::placed::Placed;
use crate::placement::Placement;
use crate::problem::{Problem, linear_material, rectangle};
use fissure_scene::{BoxSide, PlaneState, Point, Vector};
use fissure_sim::SimulationError;
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

pub(super) const NEAR_THINGS: StabilityMap = StabilityMap {
    name: "near-things",
    title: "Error of K_I of a tip that has something near, against cells a third as large",
    across: Parameter::numbers("distance [cells]", &[1.0, 2.0, 3.0, 4.0, 5.0, 7.0, 10.0]),
    up: Parameter::choices(
        "",
        &["hole ahead", "hole beside", "tip ahead", "crack beside", "corner of a hole", "corner of the plate"],
    ),
    limits: ERRORS,
    run: |distance, kind| {
        let [coarse, fine] = [1.0, 1.0 / 3.0].map(|h| match kind as u8 {
            5 => mode_1_before_corner(distance, h),
            kind => mode_1(distance, kind, h),
        });
        Ok((coarse? / fine? - 1.0).abs())
    },
};

pub(super) const PRESSED: StabilityMap = StabilityMap {
    name: "pressed",
    title: "Error of K_II of a crack that is pressed together, by what it is without friction; worst of 8 places",
    across: Parameter::numbers("friction", &[0.0, 0.1, 0.2, 0.3, 0.4]),
    up: Parameter::numbers("half the crack [cells]", &[2.0, 3.0, 4.0, 6.0]),
    limits: ERRORS,
    run: |friction, cells| {
        let error = |place| -> Result<f64, SimulationError> {
            let (found, exact) = closed_crack::mode_2_of_pressed(cells, friction, Placement::draw(1, place))?;
            Ok((found - exact).abs())
        };
        (0..PLACES).try_fold(0.0, |worst: f64, place| Ok(worst.max(error(place)?)))
    },
};

/// Places on the grid that a pressed crack is tried at.
const PLACES: usize = 8;
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
    let mut hole = |middle: Point, corners: u8| {
        let corner = |k: u8| {
            let angle = -TAU * f64::from(k) / f64::from(corners);
            middle + Vector::new(angle.cos(), angle.sin()) * RADIUS
        };
        plate.holes.push((0..corners).map(corner).collect());
    };
    match kind {
        0 => hole(Point::new(CRACK + distance + RADIUS, at), 48),
        1 => hole(Point::new(CRACK, at + distance + RADIUS), 48),
        // On its corner, which points at the tip.
        4 => hole(Point::new(CRACK + distance + RADIUS, at), 4),
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
    mode_1_at_rest(&problem)
}

/// K_I of a crack on the diagonal of a plate of 24 m that is pulled to all sides, so far from the corner ahead [m].
fn mode_1_before_corner(distance: f64, h: f64) -> Result<f64, SimulationError> {
    let side = 24.0;
    let [start, end] = [distance + CRACK, distance].map(|way| side - way * FRAC_1_SQRT_2);
    let problem = Problem::new("plate", rectangle((0.0, 0.0), (side, side)), linear_material(), PlaneState::Strain, h)
        .at_rest()
        .crack(&[(start, start), (end, end)], [false, true])
        .traction(BoxSide::Top, 0.0, STRESS)
        .traction(BoxSide::Bottom, 0.0, -STRESS)
        .traction(BoxSide::Right, STRESS, 0.0)
        .traction(BoxSide::Left, -STRESS, 0.0);
    mode_1_at_rest(&problem)
}

/// The largest K_I of all tips of a problem, once that has come to rest: of two tips that face each other the shorter
/// crack is pressed shut at some distance, where its own error says nothing.
fn mode_1_at_rest(problem: &Problem) -> Result<f64, SimulationError> {
    let mut placed = Placed::new(&problem.scene, Placement::NATURAL)?;
    placed.relax(REST, MOST_STEPS)?;
    Ok(placed.now().tips().iter().map(|tip| tip.mode_1).fold(f64::NEG_INFINITY, f64::max))
}
