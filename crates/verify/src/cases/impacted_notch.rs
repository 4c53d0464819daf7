//! Impact between two notches (Kalthoff & Winkler): a notch that closes, shears and breaks out sideways.
//!
//! Half of the 100 × 200 mm plate: 100 × 100 mm, notch of 50 mm at y = 25 mm, symmetry at y = 0; the strip below the
//! notch is driven in at 16.5 m/s, reached within 1 µs. E = 190 GPa, ν = 0.3, ρ = 8000 kg/m³, K_Ic = 68 MPa√m, plane
//! strain. The driven nodes end one cell below the notch.
//!
//! Reference for a sharp notch with frictionless faces: K_I = 0, so that the maximum hoop stress turns the crack by
//! 70.53° and it starts when |K_II| is (√3/2) K_Ic. Own finite elements reach that at 12.87 µs with contact
//! (pipeline/references/impacted_notch.py, element size to zero), at 13.1 µs if the faces go through each other.
//! Experiments (notches 0.3 mm wide) and phase field or extended finite element computations give mean angles of 60 to
//! 72° and start later. These have notches whose faces do not meet: sawn ones are open, and those of the computations
//! go through each other. So the whole way of the crack to the far edge is computed both ways. Computations with open
//! notches say 65 to 70°, and that it leaves near x = 83 mm (a plate of the same numbers: tutorial of
//! Peridynamics.jl). Cells are counted over the strip below the notch.

use crate::case::{Case, Options};
use crate::interpolate::linear;
use crate::problem::{Problem, material, rectangle, stretch};
use crate::report::{Expected, Tally};
use fissure_scene::{BoxSide, Curve, PlaneState, Point, Selection, Support, TipState};
use fissure_sim::SimulationError;
use std::ops::ControlFlow;

pub(crate) const CASE: Case = Case::new(
    "impacted-notch",
    "start and direction of a crack from a notch beside an impact",
    ("over the strip below the notch", 50.0),
    compute,
)
.family_cells(25.0)
.long();

/// Height of the driven strip [m].
const STRIP: f64 = 0.025;
const TOUGHNESS: f64 = 68e6;
/// Time [µs], K_I and K_II [MPa√m] of an own finite element solution of the resting notch, in which its faces go
/// through each other.
const AT_REST: [(f64, f64, f64); 3] = [(12.0, -24.92, -49.09), (13.2, -29.49, -59.75), (14.4, -28.19, -64.39)];
/// Time [µs] and K_II [MPa√m] of finite elements of 0.25 mm whose faces meet without friction.
const CLOSED: [(f64, f64); 3] = [(12.0, -50.15), (13.2, -61.59), (14.4, -69.03)];
/// Length of the path that is judged [m].
const RUN: f64 = 0.025;

/// The half plate and the tip of its notch [m].
fn plate(cell_size: f64, toughness: f64) -> (Problem, Point) {
    let tip = Point::new(0.05, STRIP);
    let driven = stretch((0.0, STRIP - cell_size), (0.0, 0.0));
    let mut problem = Problem::new(
        "impacted-notch",
        rectangle((0.0, 0.0), (0.1, 0.1)),
        material(190e9, 0.3, 8000.0, toughness),
        PlaneState::Strain,
        cell_size,
    )
    .crack(&[(0.0, tip.y), (tip.x, tip.y)], [false, true])
    .support(Selection::Edge { side: BoxSide::Bottom, bodies: None }, [None, Some(0.0)]);
    problem.scene.supports.push(Support {
        selection: driven,
        velocity: [Some(16.5), None],
        curve: Curve { points: vec![(0.0, 0.0), (1e-6, 1.0)] },
    });
    (problem, tip)
}

/// Time [µs] and [K_I, K_II] [MPa√m] of the resting notch.
fn at_rest(cell_size: f64, contact: bool, tally: &mut Tally<'_>) -> Result<[Vec<(f64, f64)>; 2], SimulationError> {
    let (problem, _) = plate(cell_size, 1e30);
    let mut problem = problem.until(15e-6, 15);
    problem.scene.solver.crack_contact = contact;
    let mut placed = tally.set_up(&problem)?;
    let mut curves = [Vec::new(), Vec::new()];
    tally.run(&mut placed, |now, time| {
        let tip = &now.tips()[0];
        curves[0].push((1e6 * time, 1e-6 * tip.mode_1));
        curves[1].push((1e6 * time, 1e-6 * tip.mode_2));
        ControlFlow::Continue(())
    })?;
    Ok(curves)
}

/// Follows |K_II| up to the step in which the crack starts.
#[derive(Debug, Default)]
struct Start {
    /// Time [s] and |K_II| [Pa√m] after the step before.
    before: (f64, f64),
    time: Option<f64>,
}

impl Start {
    /// Takes in a step: its end [s], |K_II| [Pa√m], and whether the crack has grown. What has started has done so where
    /// K_II passed what asks for it, within that step.
    fn pass(&mut self, time: f64, shear: f64, has_grown: bool) {
        if self.time.is_some() {
            return;
        }
        let (from, less) = self.before;
        if has_grown {
            let part = (0.75_f64.sqrt() * TOUGHNESS - less) / (shear - less);
            self.time = Some(from + (time - from) * part.clamp(0.0, 1.0));
        }
        self.before = (time, shear);
    }

    /// When the crack started [µs].
    fn microseconds(&self) -> f64 {
        self.time.map_or(f64::NAN, |time| 1e6 * time)
    }
}

/// When the crack starts [µs], the angle of the line from the notch to where it leaves [°], and that place [mm].
fn way_out(cell_size: f64, contact: bool, tally: &mut Tally<'_>) -> Result<[f64; 3], SimulationError> {
    let (problem, tip) = plate(cell_size, TOUGHNESS);
    let mut problem = problem.growing().until(100e-6, 100);
    problem.scene.solver.crack_contact = contact;
    let mut placed = tally.set_up(&problem)?;
    let (mut start, mut end) = (Start::default(), tip);
    tally.run(&mut placed, |now, time| {
        let of = &now.tips()[0];
        start.pass(time, of.mode_2.abs(), of.length > tip.x);
        if of.state.is_live() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    })?;
    let points = &placed.now().frame().cracks[0].rest;
    if placed.now().tips()[0].state == TipState::LeftBody {
        end = points[points.len() - 1];
    }
    let way = end - tip;
    Ok([start.microseconds(), way.y.atan2(way.x).to_degrees(), 1e3 * end.x])
}

/// The whole way of the crack, of a notch whose faces meet and of one whose faces do not.
fn compare_ways_out(cell_size: f64, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let [start, angle, place] = way_out(cell_size, false, tally)?;
    tally.relative("start, open notch", "µs", start, 13.1, 0.01);
    tally.bound("angle from the notch to the far edge, open notch", "°", angle, Expected::Between(64.0, 69.0));
    tally.bound("where it leaves, open notch", "mm", place, Expected::Between(81.5, 84.5));
    let [_, angle, place] = way_out(cell_size, true, tally)?;
    tally.bound("angle from the notch to the far edge, closed notch", "°", angle, Expected::Between(64.0, 69.0));
    tally.absolute("where it leaves, closed notch", "mm", place, 83.0, None);
    Ok(())
}

/// K of the resting notch beside finite elements, without contact and with it.
fn compare_at_rest(cell_size: f64, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let [opening, sliding] = at_rest(cell_size, false, tally)?;
    for (time, mode_1, mode_2) in AT_REST {
        let of = format!("at {time} µs without contact");
        tally.absolute(format!("K_I {of}"), "MPa√m", linear(&opening, time), mode_1, None);
        tally.relative(format!("K_II {of}"), "MPa√m", linear(&sliding, time), mode_2, 0.02);
    }
    let [_, sliding] = at_rest(cell_size, true, tally)?;
    for (time, mode_2) in CLOSED {
        tally.relative(format!("K_II at {time} µs with contact"), "MPa√m", linear(&sliding, time), mode_2, 0.02);
    }
    Ok(())
}

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cell_size = STRIP / options.cells_or(CASE.cells.1).round();
    compare_at_rest(cell_size, tally)?;
    let (problem, tip) = plate(cell_size, TOUGHNESS);
    let (x, y) = (tip.x, tip.y);
    let problem = problem.growing().until(80e-6, 80);
    let mut placed = tally.set_up(&problem)?;
    let (mut start, mut opening, mut shear, mut path) = (Start::default(), 0.0_f64, 0.0, Vec::new());
    let notch = x;
    tally.run(&mut placed, |now, time| {
        let tip = &now.tips()[0];
        let grown = tip.length - notch;
        start.pass(time, tip.mode_2.abs(), grown > 0.0);
        if grown <= 0.0 {
            if now.time() > 10e-6 {
                opening = opening.max((tip.mode_1 / TOUGHNESS).abs());
            }
            shear = tip.mode_2;
        }
        path.push((grown, tip.position));
        if grown >= RUN || !tip.state.is_live() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    let cracks = placed.now().frame().cracks;
    let points = &cracks[0].rest;
    let end = points[points.len() - 1];
    let angle = (end.y - y).atan2(end.x - x).to_degrees();
    let grown = path.last().map_or(0.0, |p| p.0);
    let first = path.iter().position(|p| p.0 >= 3.0 * cell_size).map_or(f64::NAN, |_| {
        // The rest positions beyond the notch, up to three cells.
        let mut length = 0.0;
        let begin = points.iter().position(|p| p.x >= x - 1e-9 * cell_size).unwrap_or(0);
        let mut last = points[begin];
        for p in &points[begin + 1..] {
            length += (p - last).norm();
            last = *p;
            if length >= 3.0 * cell_size {
                break;
            }
        }
        (last.y - y).atan2(last.x - x).to_degrees()
    });
    tally.note(
        "A notch without width closes, and faces that press on each other hand on a part of the impact: such a notch reaches the K_II of the start at 12.87 µs \
         instead of 13.1, and its crack leaves at 64° instead of 66. Experiments, and the computations that the angles are from, have notches whose faces do \
         not meet. With that, all are as they say; with faces that meet the angle does not change with cells, steps or increments (64.0° with cells of 0.6 mm).",
    );
    tally.relative("start, closed notch", "µs", start.microseconds(), 12.87, 0.01);
    tally.bound("mean angle of the path", "°", angle, Expected::Between(60.0, 72.0));
    tally.absolute("angle of the first three cells", "°", first, 70.53, None);
    tally.absolute("largest |K_I|/K_Ic from 10 µs to the start", "", opening, 0.0, 0.05);
    tally.relative("K_II/K_Ic at the start", "", -shear / TOUGHNESS, 0.75_f64.sqrt(), None);
    tally.absolute("length of the path that is judged", "mm", 1e3 * grown, 1e3 * RUN, None);
    compare_ways_out(cell_size, tally)
}
