//! Ways to solve the scene of a case, to be held against each other.

use fissure_scene::{Formulation, JMethod, Kernel, Scene, SolverPreset, SolverSettings, Transfer, solver_preset};

/// How a scene is solved and how its tips are measured. What the scene says of time steps, damping, contact and the
/// inertia in J stays as it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scheme {
    solver: SolverSettings,
    /// Length of an increment of growth, in cells.
    increment: f64,
}

impl Scheme {
    fn of_preset(preset: SolverPreset) -> Self {
        let (solver, growth) = solver_preset(preset);
        Self { solver, increment: growth.increment }
    }

    /// The total formulation as the standard preset has it, with another kernel.
    pub fn total(kernel: Kernel) -> Self {
        let Self { solver, increment } = Self::of_preset(SolverPreset::Standard);
        Self { solver: SolverSettings { formulation: Formulation::Total, kernel, ..solver }, increment }
    }

    /// The updated formulation as the standard preset has it, with another transfer and kernel.
    pub fn updated(transfer: Transfer, kernel: Kernel) -> Self {
        let Self { solver, increment } = Self::of_preset(SolverPreset::Standard);
        Self { solver: SolverSettings { formulation: Formulation::Updated, transfer, kernel, ..solver }, increment }
    }

    /// The preset `thesis`.
    pub fn thesis() -> Self {
        Self::of_preset(SolverPreset::Thesis)
    }

    /// The same with J from a contour; `area_term`: with the inertia of what lies within it.
    pub fn with_contour(self, area_term: bool) -> Self {
        Self { solver: SolverSettings { j_method: JMethod::Contour, area_term, ..self.solver }, ..self }
    }

    /// `scene` solved so.
    pub(crate) fn solve(&self, scene: &Scene) -> Scene {
        let mut scene = scene.clone();
        let given = scene.solver;
        scene.solver = SolverSettings {
            on_distortion: given.on_distortion,
            time_step: given.time_step,
            courant: given.courant,
            damping: given.damping,
            crack_contact: given.crack_contact,
            crack_friction: given.crack_friction,
            area_term: given.area_term && self.solver.area_term,
            ..self.solver
        };
        scene.growth.increment = self.increment;
        scene
    }
}
