//! What the named presets of solver and materials stand for.

use crate::document::MaterialKeys;
use crate::scene::{Curve, Material, Plasticity};
use crate::settings::*;
use serde::Deserialize;

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
                transfer: Transfer::Apic,
                time_step: None,
                courant: 0.9,
                damping: 0.0,
                crack_contact: true,
                crack_friction: 0.0,
                tip_division: TipDivision::PartlyCut,
                j_method: JMethod::Domain,
                j_radius: 4.0,
                area_term: true,
                mode_split: ModeSplit::Interaction,
            },
            GrowthSettings {
                enabled: true,
                increment: 0.25,
                bending: 1.0,
                speed_limit: 0.95,
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
                j_radius: 2.0,
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

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MaterialFile {
    material: Vec<MaterialKeys>,
}

/// The materials that come with Fissure: snow, pmma, glass, jello.
///
/// # Panics
/// Never: the file is part of the program and a test reads it.
#[allow(clippy::expect_used, reason = "the file is compiled in")]
pub fn material_presets() -> Vec<Material> {
    let file: MaterialFile = toml::from_str(include_str!("../../../assets/materials/materials.toml"))
        .expect("materials.toml is compiled in and tested");
    let none = Plasticity { critical_compression: f64::NAN, critical_stretch: f64::NAN, hardening: f64::NAN };
    file.material
        .into_iter()
        .map(|keys| Material {
            young_modulus: keys.young_modulus.unwrap_or(f64::NAN),
            poisson_ratio: keys.poisson_ratio.unwrap_or(f64::NAN),
            density: keys.density.unwrap_or(f64::NAN),
            fracture_toughness: keys.fracture_toughness.unwrap_or(f64::NAN),
            limiting_speed: keys.limiting_speed,
            plasticity: keys.plasticity.and_then(|p| p.resolve(none)),
            name: keys.name,
        })
        .collect()
}

/// A material that comes with Fissure.
pub fn material_preset(name: &str) -> Option<Material> {
    material_presets().into_iter().find(|m| m.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: table 1 of the thesis, and that all values of all materials are finite.
    #[test]
    fn material_presets_are_complete() {
        let materials = material_presets();
        let names: Vec<_> = materials.iter().map(|m| m.name.as_str()).collect();
        assert_eq!(names, ["snow", "pmma", "glass", "jello"]);
        for m in &materials {
            let sum = m.young_modulus + m.poisson_ratio + m.density + m.fracture_toughness;
            assert!(sum.is_finite(), "{m:?}");
            assert_eq!(m.plasticity.is_some(), m.name == "snow");
        }
        assert_eq!(materials[1].fracture_toughness, 1.2e6);
    }
}
