//! Elastic constants of a material in the plane, and the speeds of its waves.

use fissure_scene::{Material, PlaneState};

/// Elastic constants as the plane problem sees them: one set of formulas then serves plane strain and plane stress.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastic {
    /// Young's modulus E [Pa].
    pub young_modulus: f64,
    /// Poisson's ratio ν [–].
    pub poisson_ratio: f64,
    /// Density ρ [kg/m³].
    pub density: f64,
    /// Shear modulus μ [Pa].
    pub mu: f64,
    /// Lamé's λ in the plane [Pa]: λ in plane strain, 2λμ/(λ+2μ) in plane stress.
    pub lambda: f64,
    /// E' [Pa] of Irwin's G = (K_I² + K_II²)/E': E/(1-ν²) in plane strain, E in plane stress.
    pub effective_modulus: f64,
    /// Kolosov's κ [–]: 3-4ν in plane strain, (3-ν)/(1+ν) in plane stress.
    pub kolosov: f64,
    /// See [`Elastic::rayleigh_wave_speed`].
    rayleigh_wave_speed: f64,
}

impl Elastic {
    /// Constants of `material` in the given plane state. Needs E > 0, ρ > 0, -1 < ν < 1/2, as a loaded scene promises.
    pub fn new(material: &Material, plane: PlaneState) -> Self {
        let (e, nu) = (material.young_modulus, material.poisson_ratio);
        let mu = e / (2.0 * (1.0 + nu));
        let lambda = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
        let (lambda, effective_modulus, kolosov) = match plane {
            PlaneState::Strain => (lambda, e / (1.0 - nu * nu), 3.0 - 4.0 * nu),
            PlaneState::Stress => (2.0 * lambda * mu / (lambda + 2.0 * mu), e, (3.0 - nu) / (1.0 + nu)),
        };
        let density = material.density;
        let rayleigh_wave_speed = rayleigh_part(mu / (lambda + 2.0 * mu)) * (mu / density).sqrt();
        Self {
            young_modulus: e,
            poisson_ratio: nu,
            density,
            mu,
            lambda,
            effective_modulus,
            kolosov,
            rayleigh_wave_speed,
        }
    }

    /// Speed of dilatational waves in the plane, c_d = √((λ+2μ)/ρ) [m/s].
    pub fn dilatational_wave_speed(&self) -> f64 {
        ((self.lambda + 2.0 * self.mu) / self.density).sqrt()
    }

    /// Speed of shear waves, c_s = √(μ/ρ) [m/s].
    pub fn shear_wave_speed(&self) -> f64 {
        (self.mu / self.density).sqrt()
    }

    /// Speed of Rayleigh waves c_R [m/s], the limit of a crack in mode I: 4√(1-c²/c_d²)√(1-c²/c_s²) = (2-c²/c_s²)².
    pub fn rayleigh_wave_speed(&self) -> f64 {
        self.rayleigh_wave_speed
    }
}

/// Speed of Rayleigh waves over that of shear waves, c_R/c_s, where k = (c_s/c_d)².
fn rayleigh_part(k: f64) -> f64 {
    // Squared and divided by z = (c/c_s)², which removes the root at rest, the equation of the speed is a cubic with
    // one root between 0 and 1: it is -16(1-k) at 0 and 1 at 1.
    let cubic = |z: f64| ((z - 8.0) * z + 8.0 * (3.0 - 2.0 * k)) * z - 16.0 * (1.0 - k);
    let (mut low, mut high) = (0.0, 1.0);
    // Each halving gains a bit; a double has 53 of them.
    for _ in 0..54 {
        let middle = 0.5 * (low + high);
        if cubic(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    (0.5 * (low + high)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use PlaneState::{Strain, Stress};

    fn elastic(young_modulus: f64, poisson_ratio: f64, density: f64, plane: PlaneState) -> Elastic {
        let material = Material {
            name: String::new(),
            young_modulus,
            poisson_ratio,
            density,
            fracture_toughness: 1.0,
            limiting_speed: None,
            plasticity: None,
        };
        Elastic::new(&material, plane)
    }

    /// Truth: roots of the Rayleigh equation found independently (arbitrary bracket on the irrational form), printed to
    /// 0.05 m/s.
    #[test]
    fn wave_speeds_agree_with_the_table() {
        let table = [
            (210e9, 0.3, 8000.0, Strain, 5944.5, 3177.4, 2946.8),
            (210e9, 0.3, 8000.0, Stress, 5370.9, 3177.4, 2911.2),
            (190e9, 0.3, 8000.0, Strain, 5654.3, 3022.4, 2803.0),
            (32e9, 0.2, 2450.0, Strain, 3809.5, 2332.8, 2125.2),
            (32e9, 0.2, 2450.0, Stress, 3688.6, 2332.8, 2111.7),
            (72e9, 0.22, 2440.0, Stress, 5568.6, 3477.6, 3156.2),
            (3.24e9, 0.35, 1190.0, Stress, 1761.5, 1004.2, 924.8),
            (31.37e9, 0.2, 2400.0, Stress, 3689.9, 2333.7, 2112.4),
        ];
        for (e, nu, rho, plane, c_d, c_s, c_r) in table {
            let m = elastic(e, nu, rho, plane);
            let speeds = [m.dilatational_wave_speed(), m.shear_wave_speed(), m.rayleigh_wave_speed()];
            for (speed, truth) in speeds.into_iter().zip([c_d, c_s, c_r]) {
                assert!((speed - truth).abs() < 0.0501, "{speed} is not {truth} (E = {e}, {plane:?})");
            }
        }
    }

    #[test]
    fn rayleigh_speed_solves_the_equation_as_written() {
        for nu in [-0.5, 0.0, 0.25, 0.45, 0.499] {
            for plane in [Strain, Stress] {
                let m = elastic(1.0, nu, 1.0, plane);
                let c = m.rayleigh_wave_speed();
                let (p, q) = ((c / m.dilatational_wave_speed()).powi(2), (c / m.shear_wave_speed()).powi(2));
                let residual = 4.0 * ((1.0 - p) * (1.0 - q)).sqrt() - (2.0 - q).powi(2);
                assert!(residual.abs() < 1e-13, "{nu} {plane:?}: {residual}");
            }
        }
    }

    /// Truth: E' = 8μ/(κ+1), an identity of plane elasticity in both states.
    #[test]
    fn effective_modulus_and_kolosov_agree() {
        for plane in [Strain, Stress] {
            let m = elastic(3.0, 0.3, 1.0, plane);
            assert!((m.effective_modulus - 8.0 * m.mu / (m.kolosov + 1.0)).abs() < 1e-14);
            // Uniaxial stress in the plane strains by σ/E' along itself.
            let uniaxial = 4.0 * m.mu * (m.lambda + m.mu) / (m.lambda + 2.0 * m.mu);
            assert!((m.effective_modulus - uniaxial).abs() < 1e-14);
        }
    }
}
