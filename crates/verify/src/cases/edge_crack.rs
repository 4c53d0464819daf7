//! Edge crack in a plate under uniform traction at both ends (SENT), at rest.
//!
//! Width W, height H, crack of length a at mid height; nothing is held. With traction alone K does not depend on
//! elastic constants or plane state. Reference: own finite element solution (graded quadratic mesh, domain interaction
//! integral, converged to 1e-4); its column for H/W = 4 agrees with Kaya & Erdogan 1987. Cells are counted along the
//! crack.

use crate::case::{Case, Options};
use crate::interpolate::polynomial;
use crate::placement::Placement;
use crate::problem::{Problem, linear_material, rectangle};
use crate::report::{Expected, Tally};
use fissure_scene::{BoxSide, PlaneState, Scene, SolverPreset};
use fissure_sim::{Elastic, SimulationError};
use std::f64::consts::{FRAC_PI_2, PI};

pub(crate) const CASE: Case =
    Case::new("edge-crack", "K_I of an edge crack in plates under tension", ("along the crack", 16.0), compute);

/// One of its plates, H/W = 2 and a/W = 0.4, for what is computed many times.
pub(crate) const ONE_PLATE: Case =
    Case::new("edge-crack-plate", "K_I of an edge crack in a plate under tension", CASE.cells, compute_one_plate)
        .family_cells(8.0);

/// A plate of width W and height H with an edge crack of length a at mid height, pulled by a traction σ at both ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeCrack {
    /// Nominal a/W; the width is rounded to whole cells. The reference is a table for 0.1 to 0.5.
    pub ratio: f64,
    /// H/W: 1, 2 or 4.
    pub slenderness: u8,
    /// Cells per nominal crack length.
    pub cells: f64,
    /// How far the tip lies from its nominal place, along and across the crack, in cells: the discretisation must not
    /// care.
    pub tip_offset: [f64; 2],
    /// Plane strain or plane stress; the stress intensity is the same.
    pub plane: PlaneState,
}

/// What a run gave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeCrackResult {
    /// K_I [Pa·√m].
    pub mode_1: f64,
    /// K_II [Pa·√m]; zero by symmetry.
    pub mode_2: f64,
    /// √(E'J) [Pa·√m]; equals K_I.
    pub mode_1_of_j: f64,
    /// Number of particles.
    pub particles: usize,
    /// Number of steps to rest.
    pub steps: u64,
}

impl Default for EdgeCrack {
    fn default() -> Self {
        Self { ratio: 0.4, slenderness: 2, cells: 8.0, tip_offset: [0.0, 0.5], plane: PlaneState::Strain }
    }
}

/// Nominal crack length [m].
const LENGTH: f64 = 1.0;
/// (a/W, K_I/(σ√(πa)) for H/W = 1, 2, 4).
const FACTORS: [(f64, [f64; 3]); 4] = [
    (0.1, [1.2292, 1.1894, 1.1892]),
    (0.3, [1.8476, 1.6611, 1.6599]),
    (0.4, [2.3236, 2.1127, 2.1114]),
    (0.5, [3.0088, 2.8254, 2.8246]),
];
/// σ [Pa].
const TRACTION: f64 = 1e3;

impl EdgeCrack {
    /// σ [Pa].
    pub(super) const TRACTION: f64 = TRACTION;

    /// The scene with nothing that loads it, solved by the standard preset.
    pub(super) fn without_load(&self) -> Scene {
        Scene { loads: Vec::new(), ..self.scene(SolverPreset::Standard) }
    }

    fn cell_size(&self) -> f64 {
        LENGTH / self.cells
    }

    fn width(&self) -> f64 {
        (self.cells / self.ratio).round() * self.cell_size()
    }

    fn length(&self) -> f64 {
        LENGTH + self.tip_offset[0] * self.cell_size()
    }

    /// Reference K_I [Pa·√m] for the actual a/W: the table divided by Tada's formula for a long plate is smooth, and a
    /// cubic passes through its four entries.
    pub fn mode_1(&self) -> f64 {
        let column = match self.slenderness {
            1 => 0,
            2 => 1,
            _ => 2,
        };
        let relative = FACTORS.map(|(x, factors)| (x, factors[column] / tada(x)));
        let actual = self.length() / self.width();
        polynomial(&relative, actual) * tada(actual) * TRACTION * (PI * self.length()).sqrt()
    }

    /// The scene, solved by a preset. Free of rigid motion only by symmetry: nothing is held.
    pub fn scene(&self, preset: SolverPreset) -> Scene {
        self.problem(preset).scene
    }

    fn problem(&self, preset: SolverPreset) -> Problem {
        let (width, height) = (self.width(), f64::from(self.slenderness) * self.width());
        let at = 0.5 * height + (self.tip_offset[1] - 0.5) * self.cell_size();
        let region = rectangle((0.0, 0.0), (width, height));
        Problem::new("edge-crack", region, linear_material(), self.plane, self.cell_size())
            .preset(preset)
            .at_rest()
            .crack(&[(0.0, at), (self.length(), at)], [false, true])
            .traction(BoxSide::Top, 0.0, TRACTION)
            .traction(BoxSide::Bottom, 0.0, -TRACTION)
    }

    /// Brings the plate to rest and measures its tip.
    ///
    /// # Errors
    /// When the solver fails.
    pub fn run(&self, preset: SolverPreset) -> Result<EdgeCrackResult, SimulationError> {
        let mut say = |_: &str| ();
        self.run_in(preset, &mut Tally::new(Placement::NATURAL, &mut say))
    }

    fn run_in(&self, preset: SolverPreset, tally: &mut Tally<'_>) -> Result<EdgeCrackResult, SimulationError> {
        let mut placed = tally.set_up(&self.problem(preset))?;
        let steps = tally.relax(&mut placed)?;
        let effective = Elastic::new(&linear_material(), self.plane).effective_modulus;
        let tip = &placed.now().tips()[0];
        Ok(EdgeCrackResult {
            mode_1: tip.mode_1,
            mode_2: tip.mode_2,
            mode_1_of_j: (effective * tip.j_integral.max(0.0)).sqrt(),
            particles: placed.particles(),
            steps,
        })
    }
}

/// Tada's secant formula for K_I/(σ√(πa)) of a long plate.
pub(crate) fn tada(ratio: f64) -> f64 {
    let angle = FRAC_PI_2 * ratio;
    (angle.tan() / angle).sqrt() * (0.752 + 2.02 * ratio + 0.37 * (1.0 - angle.sin()).powi(3)) / angle.cos()
}

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cells = options.cells_or(CASE.cells.1);
    for slenderness in [1, 2, 4] {
        for (ratio, factors) in &FACTORS[1..] {
            let problem = EdgeCrack { ratio: *ratio, slenderness, cells, ..EdgeCrack::default() };
            let of = format!("H/W {slenderness}, a/W {ratio}");
            tally.say(&of);
            let found = problem.run_in(SolverPreset::Standard, tally)?;
            let factor = factors[[0, 0, 1, 2, 2][usize::from(slenderness)]];
            let computed = factor * found.mode_1 / problem.mode_1();
            tally.relative(format!("K_I/(σ√πa), {of}"), "", computed, factor, 0.015);
            let mode_2 = 100.0 * (found.mode_2 / found.mode_1).abs();
            tally.bound(format!("|K_II|/K_I, {of}"), "%", mode_2, Expected::AtMost(1.0));
            let of_j = 100.0 * (found.mode_1_of_j / found.mode_1 - 1.0).abs();
            tally.bound(format!("√(E'J) against K_I, {of}"), "%", of_j, Expected::AtMost(1.0));
        }
    }
    if tally.is_natural() { convergence(cells, tally) } else { Ok(()) }
}

fn compute_one_plate(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let problem = EdgeCrack { cells: options.cells_or(CASE.cells.1), ..EdgeCrack::default() };
    let found = problem.run_in(SolverPreset::Standard, tally)?;
    tally.relative("K_I", "Pa√m", found.mode_1, problem.mode_1(), None);
    tally.relative("√(E'J)", "Pa√m", found.mode_1_of_j, problem.mode_1(), None);
    Ok(())
}

/// Places of the tip within a cell, along and across the crack, in cells.
const OFFSETS: [[f64; 2]; 4] = [[-0.375, 0.01], [-0.125, 0.26], [0.125, 0.51], [0.375, 0.76]];

/// How the error falls with the size of the cells, over some places of the tip.
fn convergence(cells: f64, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let mut rms = Vec::new();
    for cells in [0.5 * cells, cells, 2.0 * cells] {
        let mut squares = 0.0;
        for tip_offset in OFFSETS {
            tally.say(&format!("{cells} cells, tip at {tip_offset:?}"));
            let problem = EdgeCrack { cells, tip_offset, ..EdgeCrack::default() };
            let found = problem.run_in(SolverPreset::Standard, tally)?;
            squares += (found.mode_1 / problem.mode_1() - 1.0).powi(2) / OFFSETS.len() as f64;
        }
        let error = squares.sqrt();
        let reference = FACTORS[2].1[1];
        let of = format!("K_I/(σ√πa), H/W 2, a/W 0.4, {cells} cells, rms of 4 places of the tip");
        tally.relative(of, "", reference * (1.0 + error), reference, None);
        rms.push(error);
    }
    let order = 0.5 * (rms[0] / rms[2]).log2();
    tally.bound("order of the rms error over both halvings", "", order, Expected::AtLeast(1.0));
    Ok(())
}
