//! A notch in a square plate that is sheared: the crack kinks at once and runs to the lower edge.
//!
//! The single edge notch under shear of the phase field literature (Miehe, Hofacker & Welschinger 2010): a plate of
//! 1 mm, a notch of half its width at mid height, the lower edge held, the upper one moved along it; steel, K_Ic 24.96
//! MPa√m, here at 1 m/s, which is slow beside waves. Published paths leave the notch at −65 to −70° and bend to the
//! lower edge, which they reach at x = 0.75 to 0.82 mm; the crack starts near 9 µm of shear. Under pure shear, faces
//! open, the maximum hoop stress asks for −70.5°. Cells are counted along the notch.

use crate::case::{Case, Options};
use crate::problem::{Problem, material, rectangle};
use crate::report::{Expected, Tally};
use fissure_scene::{BoxSide, Curve, PlaneState, Selection, Support, TipState};
use fissure_sim::SimulationError;

pub(crate) const CASE: Case = Case::new(
    "shear-notch",
    "path of a crack from a notch in a plate that is sheared, to the edge",
    ("along the notch", 20.0),
    compute,
)
.family_cells(12.5)
.long();

/// Length of the notch [m].
const NOTCH: f64 = 0.5e-3;
/// Part of the path that gives its first direction [m].
const FIRST: f64 = 0.1e-3;

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cell_size = NOTCH / options.cells_or(CASE.cells.1);
    let side = 2.0 * NOTCH;
    let steel = material(210e9, 0.3, 7800.0, 24.96e6);
    let edge = |side| Selection::Edge { side, bodies: None };
    let plate = rectangle((0.0, 0.0), (side, side));
    let mut problem = Problem::new("shear-notch", plate, steel, PlaneState::Strain, cell_size)
        .crack(&[(0.0, NOTCH), (NOTCH, NOTCH)], [false, true])
        .support(edge(BoxSide::Bottom), [Some(0.0), Some(0.0)])
        .growing()
        .until(20e-6, 80);
    let curve = Curve { points: vec![(0.0, 0.0), (1e-6, 1.0)] };
    let velocity = [Some(1.0), Some(0.0)];
    problem.scene.supports.push(Support { selection: edge(BoxSide::Top), velocity, curve });
    let mut placed = tally.set_up(&problem)?;
    let (mut start, mut first, mut state) = (f64::NAN, f64::NAN, TipState::Resting);
    tally.run_frames(&mut placed, |now| {
        let tip = &now.tips()[0];
        let grown = tip.length - NOTCH;
        if start.is_nan() && grown > 1e-6 * NOTCH {
            start = now.time();
        }
        if first.is_nan() && grown > FIRST {
            let points = &now.frame().cracks[0].rest;
            let end = points[points.len() - 1];
            first = (end.y - NOTCH).atan2(end.x - NOTCH).to_degrees();
        }
        state = tip.state;
    })?;
    let points = &placed.now().frame().cracks[0].rest;
    let end = points[points.len() - 1];
    let reached = if state == TipState::LeftBody { 0.0 } else { end.y };
    // The curve of the support takes the first half microsecond.
    tally.bound("shear at the start", "µm", 1e6 * start - 0.5, Expected::Between(8.0, 10.0));
    tally.bound("direction of the first part of the path", "°", first, Expected::Between(-73.0, -62.0));
    tally.bound("height at which the crack stops", "mm", 1e3 * reached, Expected::AtMost(0.0));
    tally.bound("place where it leaves", "mm", 1e3 * end.x, Expected::Between(0.75, 0.82));
    Ok(())
}
