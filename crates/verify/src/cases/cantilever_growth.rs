//! Double cantilever beam opened slowly: how far the crack runs, and where the work goes.
//!
//! Nairn's specimen: arms of 12 mm, crack of 50 mm, E = 2.5 GPa, ν = 0.33, ρ = 1200 kg/m³, plane strain, G_c = 500
//! J/m²; 160 mm long here, so that the ligament stays longer than five arms. The ends of the arms part by D = 5 mm
//! within 25 of the arms' periods. Reference: J = 3 E' h³ D²/(16 (a + χh)⁴) = G_c, so that a(D) = (3 E' h³ D²/(16
//! G_c))^¼ − χh, χ = 0.673 (as for the resting beam), and W = U + T + G_c (a − a₀). Nothing damps.
//! Cells are counted through one arm.

use super::double_cantilever::CORRECTION;
use crate::case::{Case, Options};
use crate::problem::{Problem, material, rectangle, stretch};
use crate::report::{Expected, Tally};
use fissure_scene::{Curve, PlaneState, Support};
use fissure_sim::{Elastic, SimulationError};
use std::ops::ControlFlow;

pub(crate) const CASE: Case = Case::new(
    "cantilever-growth",
    "run of a crack in a double cantilever beam opened slowly, and its energy budget",
    ("through one arm", 8.0),
    compute,
)
.family_cells(4.0)
.long();

const ARM: f64 = 0.012;
const CRACK: f64 = 0.05;
/// G_c [J/m²].
const RELEASE: f64 = 500.0;
/// D at the end [m].
const OPENING: f64 = 0.005;

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cell_size = ARM / options.cells_or(CASE.cells.1).round();
    let mut material = material(2.5e9, 0.33, 1200.0, 0.0);
    let elastic = Elastic::new(&material, PlaneState::Strain);
    material.fracture_toughness = (elastic.effective_modulus * RELEASE).sqrt();
    // Euler and Bernoulli's cantilever: ω a √(ρ/E) = 1.0150 h/a.
    let period = std::f64::consts::TAU * CRACK * CRACK / (1.0150 * ARM) * (1200.0_f64 / 2.5e9).sqrt();
    let time = 25.0 * period;
    // The speed rises over the first tenth.
    let rate = OPENING / (0.95 * time);
    let length = CRACK;
    let mut problem = Problem::new(
        "cantilever-growth",
        rectangle((0.0, 0.0), (0.16, 2.0 * ARM)),
        material,
        PlaneState::Strain,
        cell_size,
    )
    .crack(&[(0.0, ARM), (length, ARM)], [false, true])
    .growing()
    .until(time, 250);
    problem.scene.growth.bending = 0.0;
    // The end faces of the arms, without the cell beside the crack.
    for (low, high, sign) in [(ARM + cell_size, 2.0 * ARM, 1.0), (0.0, ARM - cell_size, -1.0)] {
        problem.scene.supports.push(Support {
            selection: stretch((0.0, high), (0.0, low)),
            velocity: [None, Some(0.5 * sign * rate)],
            curve: Curve { points: vec![(0.0, 0.0), (0.1 * time, 1.0)] },
        });
    }
    let mut placed = tally.set_up(&problem)?;
    let opening = |t: f64| {
        let ramp = 0.1 * time;
        rate * if t < ramp { 0.5 * t * t / ramp } else { t - 0.5 * ramp }
    };
    let expected = |d: f64| {
        (3.0 * elastic.effective_modulus * ARM.powi(3) * d * d / (16.0 * RELEASE)).powf(0.25) - CORRECTION * ARM
    };
    let (mut start, mut lengths, mut release) = (f64::NAN, Vec::new(), (0.0, 0.0));
    let first = placed.now().energies();
    let mut worst = 0.0_f64;
    tally.run(&mut placed, |now, _| {
        let tip = &now.tips()[0];
        let d = opening(now.time());
        if tip.length > length {
            if start.is_nan() {
                start = d;
            }
            if d > 1.15 * start {
                release = (release.0 + tip.j_integral / RELEASE, release.1 + 1.0);
                lengths.push((1e3 * d, 1e3 * tip.length));
            }
        }
        ControlFlow::Continue(())
    })?;
    for (d, a) in &lengths {
        let error = a / (1e3 * expected(1e-3 * d)) - 1.0;
        if error.abs() > worst.abs() {
            worst = error;
        }
    }
    let found = lengths.last().map_or(f64::NAN, |l| l.1);
    let reached = 1e3 * expected(opening(placed.now().time()));
    // D at which J of the drawn crack is G_c.
    let beam = length + CORRECTION * ARM;
    let initiation = (16.0 * RELEASE * beam.powi(4) / (3.0 * elastic.effective_modulus * ARM.powi(3))).sqrt();
    tally.relative("opening D at the start", "mm", 1e3 * start, 1e3 * initiation, 0.03);
    tally.relative("length at the end", "mm", found, reached, 0.03);
    tally.bound("largest error of the length while it runs", "%", 100.0 * worst.abs(), Expected::AtMost(3.0));
    tally.relative("mean of J/G_c while it runs", "", release.0 / release.1, 1.0, 0.03);
    let end = placed.now().energies();
    let grown = found * 1e-3 - length;
    let spent = end.kinetic + end.strain - first.strain + RELEASE * grown;
    tally.relative("U + T + G_c Δa against the work done", "J/m", spent, end.external_work, 0.02);
    let measured = end.kinetic + end.strain - first.strain + end.crack;
    tally.relative("U + T + ∫ G da against the work done", "J/m", measured, end.external_work, None);
    tally.absolute("kinetic energy by the work done", "%", 100.0 * end.kinetic / end.external_work, 0.0, None);
    Ok(())
}
