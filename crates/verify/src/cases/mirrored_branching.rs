//! Two branches of a crack on an axis of symmetry: each is the other's image to the end.
//!
//! 100 × 40 mm of soda glass (E = 72 GPa, ν = 0.3333, ρ = 2440 kg/m³, K_Ic = 0.523 MPa√m), plane stress, edge crack of
//! 50 mm, tension of 2 MPa at top and bottom from t = 0, after the example of crack branching of PDMATLAB2D (Jafarzadeh
//! et al.). Reference: symmetry. At five spacings within 10 %, all with as many particles above the axis as below, the
//! tip of the crack lies at five places within a cell; the case goes over places by itself, and others it is not moved
//! to. Rounding grows with every reflection of a wave. Cells are counted over half the height.

use crate::case::{Case, Options};
use crate::placed::Placed;
use crate::placement::Placement;
use crate::problem::{Problem, material, rectangle};
use crate::report::{Expected, Tally};
use fissure_scene::{BoxSide, Branching, PlaneState, TipState};
use fissure_sim::SimulationError;

pub(crate) const CASE: Case = Case::new(
    "mirrored-branching",
    "symmetry of the two branches of a crack on an axis of symmetry",
    ("over half the height", 20.0),
    compute,
);

const HALF_HEIGHT: f64 = 0.02;
/// Spacing of the case over that of a run, and place of the tip within a cell.
const PLACES: [(f64, f64); 5] = [(1.0, 0.0), (0.925, 0.62), (1.05, 0.24), (0.975, 0.85), (1.1, 0.47)];

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    if !tally.is_natural() {
        return Ok(());
    }
    let cells = options.cells_or(CASE.cells.1);
    for (factor, place) in PLACES {
        // A whole number of particles over half the height.
        let rows = (2.0 * cells * factor).round();
        let cell_size = 2.0 * HALF_HEIGHT / rows;
        let of = format!("{} cells, tip at {place} cells", 0.5 * rows);
        tally.say(&of);
        let plate = rectangle((-0.05, -HALF_HEIGHT), (0.05, HALF_HEIGHT));
        let glass = material(72e9, 0.3333, 2440.0, 0.523e6);
        let tip = (0.05 / cell_size).floor() * cell_size - 0.05 + place * cell_size;
        let mut problem = Problem::new("mirrored-branching", plate, glass, PlaneState::Stress, cell_size)
            .crack(&[(-0.05, 0.0), (tip, 0.0)], [false, true])
            .traction(BoxSide::Top, 0.0, 2e6)
            .traction(BoxSide::Bottom, 0.0, -2e6)
            .growing()
            .until(5e-5, 50);
        problem.scene.growth.branching =
            Some(Branching { release_ratio: 3.0, half_angle: 0.47, spacing: 8.0 * cell_size });
        let mut placed = Placed::new(&problem.scene, Placement::NATURAL)?;
        tally.run_frames(&mut placed, |_| ())?;
        // From top to bottom.
        let mut tips = placed.now().tips();
        tips.sort_by(|a, b| b.position.y.total_cmp(&a.position.y));
        let images = tips.iter().zip(tips.iter().rev());
        let apart = images.map(|(a, b)| (a.position.x - b.position.x).hypot(a.position.y + b.position.y));
        let apart = apart.fold(0.0, f64::max) / cell_size;
        let left = tips.iter().filter(|tip| tip.state == TipState::LeftBody).count();
        tally.bound(format!("tips, {of}"), "", tips.len() as f64, Expected::AtLeast(2.0));
        tally.bound(format!("tips that have left, {of}"), "", left as f64, Expected::AtLeast(2.0));
        tally.bound(format!("tips and their images apart, {of}"), "cells", apart, Expected::AtMost(1e-6));
    }
    Ok(())
}
