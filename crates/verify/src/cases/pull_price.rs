//! What a crack through a plate that is pulled apart takes: G_c for its length, at any length of steps.
//!
//! The example `pull`: 20 × 20 m of PMMA (E = 2.94 GPa, ν = 0.3, ρ = 1190 kg/m³, K_Ic = 1.2 MPa√m), plane strain, an
//! edge crack of 4 m from the top, pulled by 20 MN/m at the left and the right. Reference: the energy balance, energy
//! taken = ∫ G_c da (Griffith 1921), and symmetry, by which the crack leaves in the middle of the lower edge. Cells are
//! counted over the height.

use crate::case::{Case, Options};
use crate::problem::{Problem, material, rectangle};
use crate::report::{Expected, Tally};
use fissure_scene::{BoxSide, Curve, LoadKind, PlaneState, Selection, TipState, Vector};
use fissure_sim::{Elastic, SimulationError};

pub(crate) const CASE: Case = Case::new(
    "pull-price",
    "energy taken by a crack through a plate against G_c for its length",
    ("over the height of the plate", 80.0),
    compute,
)
.family_cells(40.0);

const HALF: f64 = 10.0;
const TOUGHNESS: f64 = 1.2e6;

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cell_size = 2.0 * HALF / options.cells_or(CASE.cells.1);
    let pmma = material(2.94e9, 0.3, 1190.0, TOUGHNESS);
    let elastic = Elastic::new(&pmma, PlaneState::Strain);
    let critical = TOUGHNESS * TOUGHNESS / elastic.effective_modulus;
    for courant in [0.5, 0.25, 0.125] {
        let of = format!("courant {courant}");
        tally.say(&of);
        let plate = rectangle((-HALF, -HALF), (HALF, HALF));
        let mut problem = Problem::new("pull-price", plate, pmma.clone(), PlaneState::Strain, cell_size)
            .crack(&[(0.0, HALF), (0.0, 6.0)], [false, true])
            .growing()
            .until(0.096, 48);
        for (side, force) in [(BoxSide::Left, -20e6), (BoxSide::Right, 20e6)] {
            let force = LoadKind::Force(Vector::new(force, 0.0));
            problem = problem.load(Selection::Edge { side, bodies: None }, force, Curve::default());
        }
        problem.scene.solver.courant = courant;
        let mut placed = tally.set_up(&problem)?;
        tally.run_frames(&mut placed, |_| ())?;
        let (tip, taken) = (placed.now().tips()[0], placed.now().energies().crack);
        let has_left = f64::from(tip.state == TipState::LeftBody);
        tally.bound(format!("crack through the plate, {of}"), "", has_left, Expected::AtLeast(1.0));
        let price = critical * (tip.length - (HALF - 6.0));
        tally.relative(format!("energy taken by ∫G_c da, {of}"), "", taken / price, 1.0, 0.02);
        let end = placed.now().frame().cracks[0].rest.last().map_or(f64::NAN, |p| p.x / cell_size);
        tally.absolute(format!("end of the crack off the middle, {of}"), "cells", end, 0.0, None);
    }
    Ok(())
}
