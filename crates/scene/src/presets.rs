//! What the named presets of the solver stand for.

use crate::curve::Curve;
use crate::settings::*;

/// The settings a solver preset stands for.
///
/// `Standard` has the kernel of the total formulation; a scene that is known to run in the updated one gets
/// [`updated_kernel`] instead.
pub fn solver_preset(preset: SolverPreset) -> (SolverSettings, GrowthSettings) {
    match preset {
        SolverPreset::Standard => (
            SolverSettings {
                formulation: Formulation::Auto,
                on_distortion: OnDistortion::Stop,
                kernel: Kernel::Bilinear,
                transfer: Transfer::Aflip,
                time_step: None,
                courant: 0.9,
                damping: 0.0,
                crack_contact: true,
                crack_friction: 0.0,
                tip_division: TipDivision::PartlyCut,
                j_method: JMethod::Domain,
                j_radius: None,
                area_term: true,
                mode_split: ModeSplit::Interaction,
            },
            GrowthSettings {
                enabled: true,
                increment: 0.25,
                bending: 1.0,
                speed_limit: 0.99,
                speed_curve: Curve::default(),
                branching: None,
            },
        ),
        SolverPreset::Thesis => (
            SolverSettings {
                formulation: Formulation::Updated,
                on_distortion: OnDistortion::Stop,
                kernel: Kernel::Cubic,
                transfer: Transfer::Pic,
                time_step: None,
                courant: 0.9,
                damping: 0.0,
                crack_contact: true,
                crack_friction: 0.0,
                tip_division: TipDivision::LineCrossing,
                j_method: JMethod::Contour,
                j_radius: Some(2.0),
                area_term: false,
                mode_split: ModeSplit::OpeningDisplacement,
            },
            GrowthSettings {
                enabled: true,
                increment: 0.5,
                bending: 1.0,
                speed_limit: 0.95,
                speed_curve: Curve::default(),
                branching: None,
            },
        ),
    }
}

/// Kernel of the standard preset where particles move through the grid: smooth enough to cross cells without noise.
pub fn updated_kernel() -> Kernel {
    Kernel::Quadratic
}
