//! Edge crack in a plate under uniform traction at both ends (SENT), at rest.

use fissure_scene::{
    Body, BoxSide, Crack, Curve, FrameSettings, GrowthSettings, Load, LoadKind, Material, OutputSettings, PlaneState,
    Point, Region, Scene, Selection, SolverPreset, UpAxis, Vector, solver_preset,
};
use fissure_sim::{Simulation, SimulationError};
use std::f64::consts::{FRAC_PI_2, PI};

/// A plate of width W and height H = 2 W with an edge crack of length a = 0.4 W at mid height, pulled by a traction σ at both ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeCrack {
    /// Cells per nominal crack length; the plate has 2.5 times as many across.
    pub cells: f64,
    /// How far the tip lies from its nominal place, along and across the crack, in cells: the discretisation must not care.
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
        Self { cells: 8.0, tip_offset: [0.0, 0.5], plane: PlaneState::Strain }
    }
}

/// Nominal crack length [m].
const LENGTH: f64 = 1.0;
/// a/W.
const RATIO: f64 = 0.4;
/// K_I/(σ√(πa)) at a/W = 0.4, H/W = 2: own finite element solution (graded quadratic mesh, domain interaction integral, converged to 1e-4).
const FACTOR: f64 = 2.1127;
/// σ [Pa].
const TRACTION: f64 = 1e3;
/// Young's modulus [Pa]: strains of 1e-6, so that the problem is linear.
const YOUNG: f64 = 1e9;
const POISSON: f64 = 0.3;

impl EdgeCrack {
    fn cell_size(&self) -> f64 {
        LENGTH / self.cells
    }

    fn width(&self) -> f64 {
        (self.cells / RATIO).round() * self.cell_size()
    }

    fn length(&self) -> f64 {
        LENGTH + self.tip_offset[0] * self.cell_size()
    }

    /// Reference K_I [Pa·√m]. The nominal factor is carried to the actual a/W of an offset tip by the ratio of Tada's formula, which is within 0.5 % for any
    /// a/W (Tada, Paris & Irwin); over a fraction of a cell the error of the ratio is far below that.
    pub fn mode_1(&self) -> f64 {
        let actual = self.length() / self.width();
        FACTOR * tada(actual) / tada(RATIO) * TRACTION * (PI * self.length()).sqrt()
    }

    /// The scene, solved by a preset. Free of rigid motion only by symmetry: nothing is held.
    pub fn scene(&self, preset: SolverPreset) -> Scene {
        let (mut solver, growth) = solver_preset(preset);
        // At rest there is no inertia, and an open crack has no contact.
        solver.area_term = false;
        solver.crack_contact = false;
        let (width, height) = (self.width(), 2.0 * self.width());
        let at = 0.5 * height + (self.tip_offset[1] - 0.5) * self.cell_size();
        let corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height), (0.0, at)];
        let pull = |side: BoxSide, traction: f64| Load {
            selection: Selection::Edge { side, body: None },
            kind: LoadKind::Traction(Vector::new(0.0, traction)),
            curve: Curve::default(),
        };
        Scene {
            name: "edge-crack".into(),
            hash: String::new(),
            plane: self.plane,
            materials: vec![Material {
                name: "linear".into(),
                young_modulus: YOUNG,
                poisson_ratio: POISSON,
                density: 1000.0,
                fracture_toughness: 1e12,
                limiting_speed: None,
                plasticity: None,
            }],
            bodies: vec![Body {
                name: "plate".into(),
                region: Region { exterior: corners.map(|(x, y)| Point::new(x, y)).to_vec(), holes: Vec::new() },
                material: 0,
                inclusions: Vec::new(),
                velocities: Vec::new(),
            }],
            cracks: vec![Crack {
                name: "notch".into(),
                body: 0,
                points: vec![Point::new(0.0, at), Point::new(self.length(), at)],
                start_live: false,
                end_live: true,
                start_guide: None,
                end_guide: None,
            }],
            toughness: Vec::new(),
            colliders: Vec::new(),
            gravity: Vector::zeros(),
            loads: vec![pull(BoxSide::Top, TRACTION), pull(BoxSide::Bottom, -TRACTION)],
            supports: Vec::new(),
            particle_spacing: 0.5 * self.cell_size(),
            cell_size: self.cell_size(),
            solver,
            growth: GrowthSettings { enabled: false, ..growth },
            frames: FrameSettings { first: 1, last: 2, rate: 1.0 },
            output: OutputSettings {
                thickness: 1.0,
                formats: Vec::new(),
                parts: Vec::new(),
                up: UpAxis::Z,
                smallest_fragment: 0.0,
            },
        }
    }

    /// Brings the plate to rest and measures its tip.
    ///
    /// # Errors
    /// When the solver fails.
    pub fn run(&self, preset: SolverPreset) -> Result<EdgeCrackResult, SimulationError> {
        let scene = self.scene(preset);
        let mut simulation = Simulation::new(&scene)?;
        let steps = simulation.relax(1e-8, 4000)?;
        let frame = simulation.frame();
        let effective = match self.plane {
            PlaneState::Strain => YOUNG / (1.0 - POISSON * POISSON),
            PlaneState::Stress => YOUNG,
        };
        let tip = &frame.tips[0];
        Ok(EdgeCrackResult {
            mode_1: tip.mode_1,
            mode_2: tip.mode_2,
            mode_1_of_j: (effective * tip.j_integral.max(0.0)).sqrt(),
            particles: frame.particles.len(),
            steps,
        })
    }
}

/// Tada's secant formula for K_I/(σ√(πa)) of a long plate.
fn tada(ratio: f64) -> f64 {
    let angle = FRAC_PI_2 * ratio;
    (angle.tan() / angle).sqrt() * (0.752 + 2.02 * ratio + 0.37 * (1.0 - angle.sin()).powi(3)) / angle.cos()
}
