//! Edge crack in a plate under uniform traction at both ends (SENT), at rest.
//!
//! Width W, height H, crack of length a at mid height; nothing is held. With traction alone K does not depend on
//! elastic constants or plane state. Reference: own finite element solution (graded quadratic mesh, domain interaction
//! integral, converged to 1e-4); its column for H/W = 4 agrees with Kaya & Erdogan 1987. Cells are counted along the
//! crack.

use super::{MOST_STEPS, REST, offsets};
use crate::case::{Case, Options};
use crate::interpolate::polynomial;
use crate::problem::{Problem, linear_material, rectangle};
use crate::report::{Expected, Tally};
use fissure_scene::{BoxSide, PlaneState, Scene, SolverPreset};
use fissure_sim::{Elastic, Simulation, SimulationError};
use std::f64::consts::{FRAC_PI_2, PI};

pub(crate) const CASE: Case = Case::new(
    "edge-crack",
    "K_I of an edge crack in plates under tension, the tip anywhere within a cell",
    ("along the crack", 16.0),
    compute,
);

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
        let (width, height) = (self.width(), f64::from(self.slenderness) * self.width());
        let at = 0.5 * height + (self.tip_offset[1] - 0.5) * self.cell_size();
        let region = rectangle((0.0, 0.0), (width, height));
        Problem::new("edge-crack", region, linear_material(), self.plane, self.cell_size())
            .preset(preset)
            .at_rest()
            .crack(&[(0.0, at), (self.length(), at)], [false, true])
            .traction(BoxSide::Top, 0.0, TRACTION)
            .traction(BoxSide::Bottom, 0.0, -TRACTION)
            .scene
    }

    /// Brings the plate to rest and measures its tip.
    ///
    /// # Errors
    /// When the solver fails.
    pub fn run(&self, preset: SolverPreset) -> Result<EdgeCrackResult, SimulationError> {
        let mut simulation = Simulation::new(&self.scene(preset))?;
        let steps = simulation.relax(REST, MOST_STEPS)?;
        let effective = Elastic::new(&linear_material(), self.plane).effective_modulus;
        let tip = &simulation.tips()[0];
        Ok(EdgeCrackResult {
            mode_1: tip.mode_1,
            mode_2: tip.mode_2,
            mode_1_of_j: (effective * tip.j_integral.max(0.0)).sqrt(),
            particles: simulation.particles(),
            steps,
        })
    }
}

/// Tada's secant formula for K_I/(σ√(πa)) of a long plate.
fn tada(ratio: f64) -> f64 {
    let angle = FRAC_PI_2 * ratio;
    (angle.tan() / angle).sqrt() * (0.752 + 2.02 * ratio + 0.37 * (1.0 - angle.sin()).powi(3)) / angle.cos()
}

/// What one geometry gave over all places of the tip. Errors are relative.
struct Spread {
    /// Error of largest magnitude.
    worst: f64,
    /// Root of the mean square error.
    rms: f64,
    /// Largest less smallest error.
    range: f64,
    /// Largest |K_II|/K_I.
    mode_2: f64,
    /// Largest |√(E'J)/K_I − 1|.
    of_j: f64,
}

fn spread(geometry: EdgeCrack, all: bool, tally: &mut Tally<'_>) -> Result<Spread, SimulationError> {
    let mut errors = Vec::new();
    let (mut mode_2, mut of_j) = (0.0_f64, 0.0_f64);
    for tip_offset in offsets(all) {
        let EdgeCrack { ratio, slenderness, cells, .. } = geometry;
        tally.say(&format!("H/W {slenderness}, a/W {ratio}, {cells} cells, tip at {tip_offset:?}"));
        let problem = EdgeCrack { tip_offset, ..geometry };
        let found = problem.run(SolverPreset::Standard)?;
        tally.count(found.particles, found.steps);
        errors.push(found.mode_1 / problem.mode_1() - 1.0);
        // In a square plate K_II is truly not zero where the crack is not at mid height.
        if slenderness > 1 || (tip_offset[1] - 0.5).abs() < 0.02 {
            mode_2 = mode_2.max((found.mode_2 / found.mode_1).abs());
        }
        of_j = of_j.max((found.mode_1_of_j / found.mode_1 - 1.0).abs());
    }
    let worst = errors.iter().copied().fold(0.0, |w: f64, e| if e.abs() > w.abs() { e } else { w });
    let low = errors.iter().copied().fold(f64::INFINITY, f64::min);
    let high = errors.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    Ok(Spread { worst, rms, range: high - low, mode_2, of_j })
}

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cells = options.cells_or(CASE.cells.1);
    for slenderness in [1, 2, 4] {
        for (ratio, factors) in &FACTORS[1..] {
            let geometry = EdgeCrack { ratio: *ratio, slenderness, cells, ..EdgeCrack::default() };
            let found = spread(geometry, options.all_offsets || *ratio == 0.4, tally)?;
            let factor = factors[[0, 0, 1, 2, 2][usize::from(slenderness)]];
            let of = format!("H/W {slenderness}, a/W {ratio}");
            tally.relative(format!("K_I/(σ√πa), {of}, worst"), "", factor * (1.0 + found.worst), factor, 0.015);
            tally.bound(format!("spread of K_I, {of}"), "%", 100.0 * found.range, Expected::AtMost(1.5));
            tally.bound(format!("|K_II|/K_I, {of}, worst"), "%", 100.0 * found.mode_2, Expected::AtMost(1.0));
            tally.bound(format!("√(E'J) against K_I, {of}, worst"), "%", 100.0 * found.of_j, Expected::AtMost(1.0));
        }
    }
    let mut rms = Vec::new();
    for factor in [0.5, 1.0, 2.0] {
        let geometry = EdgeCrack { cells: factor * cells, ..EdgeCrack::default() };
        let found = spread(geometry, options.all_offsets, tally)?;
        tally.relative(
            format!("K_I/(σ√πa), H/W 2, a/W 0.4, {} cells, rms", factor * cells),
            "",
            FACTORS[2].1[1] * (1.0 + found.rms),
            FACTORS[2].1[1],
            None,
        );
        rms.push(found.rms);
    }
    tally.bound(
        "order of the rms error over both halvings",
        "",
        0.5 * (rms[0] / rms[2]).log2(),
        Expected::AtLeast(1.0),
    );
    Ok(())
}
