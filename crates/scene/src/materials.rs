//! The materials that come with Fissure.

use crate::scene::{Material, Plasticity};

/// Snow plasticity as published (Stomakhin et al. 2013, "A material point method for snow simulation", table 2).
pub(crate) const SNOW_PLASTICITY: Plasticity =
    Plasticity { critical_compression: 2.5e-2, critical_stretch: 7.5e-3, hardening: 10.0 };

/// The materials that come with Fissure: snow, pmma, glass, jello.
///
/// Young's modulus, Poisson's ratio, density and fracture toughness are those of table 1 of Fumoto 2022. Its header
/// gives the toughness in MPa·√m, but the entries (1.2M, 0.75M, 10, 10) are Pa·√m.
pub fn material_presets() -> Vec<Material> {
    let material = |name: &str, [young_modulus, poisson_ratio, density, fracture_toughness]: [f64; 4]| Material {
        name: name.into(),
        young_modulus,
        poisson_ratio,
        density,
        fracture_toughness,
        limiting_speed: None,
        plasticity: None,
    };
    vec![
        Material { plasticity: Some(SNOW_PLASTICITY), ..material("snow", [140e3, 0.2, 400.0, 10.0]) },
        material("pmma", [2.94e9, 0.3, 1190.0, 1.2e6]),
        material("glass", [70e9, 0.22, 2500.0, 0.75e6]),
        material("jello", [50.0, 0.4, 2.0, 10.0]),
    ]
}

/// A material that comes with Fissure.
pub fn material_preset(name: &str) -> Option<Material> {
    material_presets().into_iter().find(|m| m.name == name)
}
