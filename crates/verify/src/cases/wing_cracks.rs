//! Wing cracks: a slanted crack that is pressed together slides and sends out wings that turn to the load.
//!
//! A plate of 120 mm (PMMA, plane strain) with a crack of 30 mm at 45° in its middle, faces without friction, between
//! supports that approach at 1 m/s. The faces are closed, so that the tips are in pure shear and the hoop stress sends
//! the wings out at −70.5°; they turn into the direction of the load and are stable: a longer wing needs more load. So
//! at every moment K_I of a wing that runs is K_Ic, as far as the waves that it sends out let it, and none rests with
//! more. Cells are counted along half the crack.

use crate::case::{Case, Options};
use crate::problem::{Problem, material, rectangle};
use crate::report::{Expected, Tally};
use fissure_scene::{BoxSide, Curve, PlaneState, Selection, Support, TipState};
use fissure_sim::SimulationError;

pub(crate) const CASE: Case = Case::new(
    "wing-cracks",
    "K_I of wings that grow from a crack that is pressed together",
    ("along half the crack", 12.0),
    compute,
)
.family_cells(8.0)
.long();

/// Half the length of the crack [m].
const HALF: f64 = 0.015;
/// K_Ic [Pa√m].
const TOUGHNESS: f64 = 1.2e6;

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cell_size = HALF / options.cells_or(CASE.cells.1);
    let (side, arm) = (8.0 * HALF, HALF / 2.0_f64.sqrt());
    let (low, high) = (0.5 * side - arm, 0.5 * side + arm);
    let edge = |side| Selection::Edge { side, bodies: None };
    let plate = rectangle((0.0, 0.0), (side, side));
    let pmma = material(3.24e9, 0.35, 1190.0, TOUGHNESS);
    let mut problem = Problem::new("wing-cracks", plate, pmma, PlaneState::Strain, cell_size)
        .crack(&[(low, low), (high, high)], [true, true])
        .support(edge(BoxSide::Bottom), [None, Some(0.0)])
        .growing()
        .until(1e-3, 50);
    let curve = Curve { points: vec![(0.0, 0.0), (1e-4, 1.0)] };
    problem.scene.supports.push(Support { selection: edge(BoxSide::Top), velocity: [None, Some(-1.0)], curve });
    let mut placed = tally.set_up(&problem)?;
    let (mut resting, mut running) = (0.0_f64, Vec::new());
    tally.run_frames(&mut placed, |now| {
        for tip in now.tips() {
            match tip.state {
                TipState::Resting | TipState::Arrested => resting = resting.max(tip.mode_1 / TOUGHNESS),
                // Wings of half a crack and more.
                TipState::Growing if tip.length > 2.5 * HALF => running.push(tip.mode_1 / TOUGHNESS),
                _ => {}
            }
        }
    })?;
    let mean = running.iter().sum::<f64>() / running.len() as f64;
    let points = &placed.now().frame().cracks[0].rest;
    let way = points[points.len() - 1] - points[points.len() - 1 - points.len() / 8];
    let slant = way.x.abs().atan2(way.y.abs()).to_degrees();
    tally.bound("K_I/K_Ic of a wing that rests", "", resting, Expected::AtMost(1.0));
    tally.relative("K_I/K_Ic of wings that run, mean", "", mean, 1.0, 0.05);
    tally.bound("slant of the upper wing to the load at its end", "°", slant, Expected::AtMost(15.0));
    Ok(())
}
