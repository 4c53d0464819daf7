//! Start of growth in the plate of the branching test (Borden et al. 2012): a brittle plate under a step of tension.
//!
//! 100 × 40 mm, edge crack of 50 mm, E = 32 GPa, ν = 0.2, ρ = 2450 kg/m³, G_c = 3 J/m² (K_Ic = 0.316 MPa√m), plane
//! strain, tension σ = 1 MPa on both sides from t = 0. Reference: the two steps of tension give K_I = 2 (2σ/(1−ν))
//! √(c_d (t−t_c)(1−2ν)/π) (Freund 1990), which reaches K_Ic at 10.75 µs; an own finite element solution gives 10.745 µs
//! and the K_I before. Run until the first reflections arrive, 15.75 µs. Cells are counted over half the height.

use crate::case::{Case, Options};
use crate::interpolate::linear;
use crate::problem::{Problem, material, rectangle};
use crate::report::{Expected, Tally};
use fissure_scene::{BoxSide, PlaneState};
use fissure_sim::{Elastic, SimulationError};
use std::ops::ControlFlow;

pub(crate) const CASE: Case = Case::new(
    "branching-plate",
    "start of growth and first run in a brittle plate after a step of tension",
    ("over half the height", 80.0),
    compute,
)
.family_cells(40.0);

const HALF_HEIGHT: f64 = 0.02;
/// K_Ic = √(E' G_c) [Pa·√m].
const TOUGHNESS: f64 = 316_227.766;

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cell_size = HALF_HEIGHT / options.cells_or(CASE.cells.1).round();
    let material = material(32e9, 0.2, 2450.0, TOUGHNESS);
    let elastic = Elastic::new(&material, PlaneState::Strain);
    let (x, y) = (0.05, HALF_HEIGHT);
    let mut problem = Problem::new(
        "branching-plate",
        rectangle((0.0, 0.0), (0.1, 2.0 * HALF_HEIGHT)),
        material,
        PlaneState::Strain,
        cell_size,
    )
    .crack(&[(0.0, y), (x, y)], [false, true])
    .traction(BoxSide::Top, 0.0, 1e6)
    .traction(BoxSide::Bottom, 0.0, -1e6)
    .growing()
    .until(15.75e-6, 30);
    problem.scene.growth.bending = 0.0;
    let mut placed = tally.set_up(&problem)?;
    let (mut intensity, mut run) = (Vec::new(), vec![(0.0, 0.0)]);
    let mut start = f64::NAN;
    tally.run(&mut placed, |now, time| {
        let tip = &now.tips()[0];
        let grown = tip.length - x;
        if grown > 1e-6 * cell_size && start.is_nan() {
            start = 1e6 * now.time();
        }
        intensity.push((1e6 * time, tip.mode_1 / TOUGHNESS));
        run.push((1e6 * now.time(), 1e3 * grown));
        ControlFlow::Continue(())
    })?;
    tally.relative("start of growth", "µs", start, 10.75, 0.03);
    for (time, reference) in [(7.5, 0.640), (9.9, 0.922)] {
        tally.relative(format!("K_I/K_Ic at {time} µs"), "", linear(&intensity, time), reference, None);
    }
    for (time, reference) in [(13.0, 0.74), (14.0, 1.45), (15.0, 2.34), (15.75, 3.10)] {
        tally.relative(format!("run at {time} µs"), "mm", linear(&run, time), reference, None);
    }
    let (from, to) = (linear(&run, 14.0), linear(&run, 15.75));
    let speed = 1e3 * (to - from) / 1.75 / elastic.rayleigh_wave_speed();
    tally.bound("mean speed from 14 to 15.75 µs", "c_R", speed, Expected::AtMost(0.6));
    Ok(())
}
