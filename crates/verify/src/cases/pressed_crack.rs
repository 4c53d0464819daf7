//! Cracks with pressure on their faces, come to rest by damping.
//!
//! Reference, by superposition: what presses on the faces loads a tip as the traction does that the faces would carry
//! if there were no crack. In a plate of width 2b and height H the pressure p on a centre crack of length 2a makes the
//! K_I of the plate pulled by p at its ends (own finite elements, those of `center-crack`), on an edge crack that of
//! `edge-crack`. Pressed all around and on its faces alike, a plate is under uniform stress, and a bent crack in it has
//! no K_I, no K_II and no J. Cells are counted along half the centre crack, along the edge crack, and along half the
//! bent one.

use super::center_crack;
use super::edge_crack::EdgeCrack;
use crate::case::{Case, Options};
use crate::problem::{Problem, linear_material, rectangle};
use crate::report::{Expected, Tally};
use fissure_scene::{Curve, Formulation, LoadKind, PlaneState, Selection, TipRecord, updated_kernel};
use fissure_sim::{Elastic, SimulationError};
use std::f64::consts::{PI, TAU};

pub(crate) const CASE: Case = Case::new(
    "pressed-crack",
    "K_I and J of cracks with pressure on their faces",
    ("along the crack or half of it", 16.0),
    compute,
)
.family_cells(8.0);

/// p [Pa].
const PRESSURE: f64 = 1e3;
/// Times that a wave takes through the plate, after which it rests.
const RESTS: f64 = 16.0;

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cells = options.cells_or(CASE.cells.1).round();
    let modulus = Elastic::new(&linear_material(), PlaneState::Strain).effective_modulus;
    for (formulation, name) in [(Formulation::Total, "total"), (Formulation::Updated, "updated")] {
        let within = if formulation == Formulation::Total { 0.02 } else { 0.06 };
        tally.say(&format!("{name}, centre crack"));
        // In cells, one cell being one metre; a/b = 0.5, H/2b = 1.
        let (a, side) = (cells, 4.0 * cells);
        let problem = plate(side, formulation).crack(&[(a, 0.5 * side), (3.0 * a, 0.5 * side)], [true, true]);
        let center = center_crack::factor(1, 0.5) * PRESSURE * (PI * a).sqrt();
        let mut all = vec![("centre crack", problem, center)];
        if formulation == Formulation::Total {
            let edge = EdgeCrack { cells, ratio: 0.3, ..EdgeCrack::default() };
            let problem = Problem { scene: edge.without_load() };
            all.push(("edge crack", problem, edge.mode_1() / EdgeCrack::TRACTION * PRESSURE));
        }
        for (of, problem, exact) in all {
            let what = format!("{of}, {name} formulation");
            tally.say(&what);
            for tip in come_to_rest(pressed(problem), tally)? {
                tally.relative(format!("K_I/(p√πa), {what}"), "", tip.mode_1 / exact, 1.0, within);
                let of_j = (modulus * tip.j_integral).max(0.0).sqrt();
                tally.relative(format!("√(E'J)/(p√πa), {what}"), "", of_j / exact, 1.0, within);
            }
        }
    }
    let what = "a bent crack, pressed like the whole outline";
    tally.say(what);
    let side = 4.0 * cells;
    let bent = [(cells, 1.5 * cells), (2.0 * cells, 2.0 * cells), (3.0 * cells, 1.6 * cells)];
    let problem = pressed(plate(side, Formulation::Total).crack(&bent, [true, true]));
    let problem = problem.load(Selection::All, LoadKind::Pressure(PRESSURE), Curve::default());
    let unit = PRESSURE * (PI * cells).sqrt();
    let tips = come_to_rest(problem, tally)?;
    let most = |of: &dyn Fn(&fissure_scene::TipRecord) -> f64| tips.iter().map(of).fold(0.0_f64, |a, b| a.max(b.abs()));
    let opens = 100.0 * most(&|tip| tip.mode_1) / unit;
    let slides = 100.0 * most(&|tip| tip.mode_2) / unit;
    let releases = 100.0 * most(&|tip| tip.j_integral) * modulus / (unit * unit);
    tally.bound(format!("K_I/(p√πa), {what}"), "%", opens, Expected::AtMost(1.0));
    tally.bound(format!("K_II/(p√πa), {what}"), "%", slides, Expected::AtMost(1.0));
    tally.bound(format!("E'J/(p²πa), {what}"), "%", releases, Expected::AtMost(2.0));
    Ok(())
}

/// A square plate of that many cells on which nothing acts.
fn plate(side: f64, formulation: Formulation) -> Problem {
    let region = rectangle((0.0, 0.0), (side, side));
    let mut problem = Problem::new("pressed-crack", region, linear_material(), PlaneState::Strain, 1.0).at_rest();
    let solver = &mut problem.scene.solver;
    solver.formulation = formulation;
    if formulation == Formulation::Updated {
        solver.kernel = updated_kernel();
    }
    problem
}

/// The tips after some damped time: where a crack is open at an edge its pressure pushes the free plate, ever so
/// little, and the damping that finds rest soonest would let it fly.
fn come_to_rest(mut problem: Problem, tally: &mut Tally<'_>) -> Result<Vec<TipRecord>, SimulationError> {
    let scene = &problem.scene;
    let (low, high) = scene.bodies[0].region.bounds();
    let crossing = (high - low).amax() / Elastic::new(&scene.materials[0], scene.plane).dilatational_wave_speed();
    problem.scene.solver.damping = TAU / crossing;
    let mut placed = tally.set_up(&problem.until(RESTS * crossing, 1))?;
    tally.run_frames(&mut placed, |_| ())?;
    Ok(placed.now().tips())
}

/// With pressure on the faces of its crack.
fn pressed(problem: Problem) -> Problem {
    problem.load(Selection::All, LoadKind::FacePressure(vec![0], PRESSURE), Curve::default())
}
