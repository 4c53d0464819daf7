//! A crack that is not drawn across the pull: it turns across it and runs to the far edge, once.
//!
//! The example `pull-rotated` in glass: 20 × 20 m (E = 70 GPa, ν = 0.22, ρ = 2500 kg/m³, K_Ic = 0.75 MPa√m), plane
//! strain, an edge crack of 4 m from the middle of the top, turned from the vertical, pulled at the left and the right
//! from the first moment on: by 6 MN/m, at rest some twice the toughness, at 15, 30 and 45°, and as in the example by
//! 20 MN/m, some seven times the toughness, at 30°. Waves cross the plate several times while the crack runs, and reach
//! it from ahead where it leaves. Truth: pulled from side to side the plate parts from the top to the bottom, so that
//! the crack never goes back up, and what it runs is hardly longer than the straight line from the drawn tip to where
//! it leaves; it takes ∫ G_c da (Griffith 1921). Cells are counted over the height.

use crate::case::{Case, Options};
use crate::problem::{Problem, material, rectangle};
use crate::report::{Expected, Tally};
use fissure_scene::{BoxSide, Curve, LoadKind, PlaneState, Point, Selection, TipState, Vector};
use fissure_sim::{Elastic, SimulationError};

pub(crate) const CASE: Case = Case::new(
    "turned-notch",
    "a crack turned from the way across the pull: it turns, runs to the far edge and not back",
    ("over the height of the plate", 80.0),
    compute,
);

const HALF: f64 = 10.0;
/// Length of the drawn crack [m].
const NOTCH: f64 = 4.0;
const TOUGHNESS: f64 = 0.75e6;
/// Forces [N/m], angles [degrees], and by how much the way may be longer than a straight line [%].
const PLATES: [(f64, f64, f64); 4] = [(6e6, 15.0, 5.0), (6e6, 30.0, 5.0), (6e6, 45.0, 5.0), (20e6, 30.0, 10.0)];
/// A way that goes no farther back up does not turn back [cells].
const LEVEL: f64 = 0.1;

fn problem(force: f64, degrees: f64, cell_size: f64) -> Problem {
    let glass = material(70e9, 0.22, 2500.0, TOUGHNESS);
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let plate = rectangle((-HALF, -HALF), (HALF, HALF));
    let mut problem = Problem::new("turned-notch", plate, glass, PlaneState::Strain, cell_size)
        .crack(&[(0.0, HALF), (NOTCH * sine, HALF - NOTCH * cosine)], [false, true])
        .growing()
        .until(0.096, 48);
    for (side, force) in [(BoxSide::Left, -force), (BoxSide::Right, force)] {
        let force = LoadKind::Force(Vector::new(force, 0.0));
        problem = problem.load(Selection::Edge { side, bodies: None }, force, Curve::default());
    }
    problem
}

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cell_size = 2.0 * HALF / options.cells_or(CASE.cells.1);
    for (force, degrees, longer) in PLATES {
        let of = format!("{degrees}°, {} MN/m", 1e-6 * force);
        tally.say(&of);
        let problem = problem(force, degrees, cell_size);
        let elastic = Elastic::new(&problem.scene.materials[0], PlaneState::Strain);
        let critical = TOUGHNESS * TOUGHNESS / elastic.effective_modulus;
        let mut placed = tally.set_up(&problem)?;
        tally.run_frames(&mut placed, |_| ())?;
        let (tip, taken) = (placed.now().tips()[0], placed.now().energies().crack);
        let way = &placed.now().frame().cracks[0].rest;
        let end = way.last().copied().unwrap_or_else(Point::origin);
        let has_left = tip.state == TipState::LeftBody && end.y < -HALF + 0.5 * cell_size;
        tally.bound(format!("leaves through the lower edge, {of}"), "", f64::from(has_left), Expected::AtLeast(1.0));
        let back = climbed(way) / cell_size;
        tally.bound(format!("largest way back up, {of}"), "cells", back, Expected::AtMost(LEVEL));
        let drawn = problem.scene.cracks[0].points[1];
        let detour = 100.0 * ((tip.length - NOTCH) / (end - drawn).norm() - 1.0);
        tally.bound(format!("longer than straight, {of}"), "%", detour, Expected::AtMost(longer));
        let price = critical * (tip.length - NOTCH);
        tally.relative(format!("energy taken by ∫G_c da, {of}"), "", taken / price, 1.0, 0.02);
    }
    Ok(())
}

/// How far a way from the top to the bottom goes back up at most [m].
fn climbed(way: &[Point]) -> f64 {
    let mut lowest = f64::INFINITY;
    let mut most = 0.0_f64;
    for point in way {
        lowest = lowest.min(point.y);
        most = most.max(point.y - lowest);
    }
    most
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: by hand. From 3 down to 1, up to 2.5, down to 0 and up to 1 is 1.5 back at most.
    #[test]
    fn a_way_back_up_is_seen() {
        let way = [3.0, 1.0, 2.5, 0.0, 1.0].map(|y| Point::new(0.0, y));
        assert_eq!(climbed(&way), 1.5);
        assert_eq!(climbed(&way[..2]), 0.0);
    }
}
