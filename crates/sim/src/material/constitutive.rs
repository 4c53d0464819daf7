//! Stress from deformation: fixed-corotated elasticity and snow plasticity (Stomakhin et al. 2013), in the plane.
//!
//! Everything starts from the displacement gradient H = F - I rather than from F, and no difference of nearly equal
//! numbers is formed when H is small: a strain of 1e-9 keeps its digits.

use fissure_scene::{Matrix, Plasticity};

/// F - R, with R the rotation of the polar decomposition F = R S, from H = F - I.
///
/// In the plane R = [[a, -b], [b, a]]/r with a = F11+F22, b = F21-F12, r = √(a²+b²). R is not defined when r = 0 (an
/// inversion with equal singular values); it is then taken as the identity.
#[inline(always)]
fn deformation_beyond_rotation(h: &Matrix) -> Matrix {
    let a = 2.0 + h.m11 + h.m22;
    let b = h.m21 - h.m12;
    let r = (a * a + b * b).sqrt();
    if r == 0.0 {
        return *h;
    }
    // 1 - a/r without cancellation: r - a = b²/(r+a) when a > 0; near a half turn r + a vanishes but r - a does not
    // cancel.
    let one_minus_cosine = if a > 0.0 { b * b / (r * (r + a)) } else { (r - a) / r };
    let sine = b / r;
    Matrix::new(h.m11 + one_minus_cosine, h.m12 + sine, h.m21 - sine, h.m22 + one_minus_cosine)
}

/// J - 1 = tr H + det H [–], the relative change of volume.
#[inline(always)]
pub fn volume_change(h: &Matrix) -> f64 {
    h.m11 + h.m22 + (h.m11 * h.m22 - h.m12 * h.m21)
}

/// F = [[e, -g], [g, e]] + [[d, s], [s, -d]], a rotation and a reflection with their sizes; gives [[e, g], [d, s]] [–].
#[inline]
fn rotation_and_reflection(h: &Matrix) -> [[f64; 2]; 2] {
    let rotation = [1.0 + 0.5 * (h.m11 + h.m22), 0.5 * (h.m21 - h.m12)];
    let reflection = [0.5 * (h.m11 - h.m22), 0.5 * (h.m21 + h.m12)];
    [rotation, reflection]
}

/// The principal stretches of F = I + `h`, the largest first [–]: its singular values; the smaller carries the sign of
/// det F.
#[inline]
pub(crate) fn principal_stretches(h: &Matrix) -> [f64; 2] {
    let [q, p] = rotation_and_reflection(h).map(|[x, y]| x.hypot(y));
    [q + p, q - p]
}

/// First Piola–Kirchhoff stress P = 2μ(F - R) + λ(J-1) J F⁻ᵀ [Pa] of the displacement gradient `h` = F - I [–].
///
/// Source: Stomakhin et al. 2013. `lambda` is that of the plane state ([`crate::Elastic`]). Finite for every finite
/// `h`, inverted material included.
#[inline]
pub fn first_piola_stress(h: &Matrix, mu: f64, lambda: f64) -> Matrix {
    // J F⁻ᵀ is the cofactor matrix of F.
    let cofactor = Matrix::new(1.0 + h.m22, -h.m21, -h.m12, 1.0 + h.m11);
    2.0 * mu * deformation_beyond_rotation(h) + lambda * volume_change(h) * cofactor
}

/// Kirchhoff stress τ = P Fᵀ = 2μ(F - R)Fᵀ + λ(J-1) J I [Pa], symmetric.
#[inline(always)]
pub fn kirchhoff_stress(h: &Matrix, mu: f64, lambda: f64) -> Matrix {
    let e = deformation_beyond_rotation(h);
    let jacobian_minus_one = volume_change(h);
    let pressure = lambda * jacobian_minus_one * (1.0 + jacobian_minus_one);
    // (F-R)Fᵀ = E + E Hᵀ with E = F - R, so that a small H is never added to 1. It is symmetric; the halves' mean makes
    // it so to the bit.
    let s11 = e.m11 + e.m11 * h.m11 + e.m12 * h.m12;
    let s22 = e.m22 + e.m21 * h.m21 + e.m22 * h.m22;
    let s12 = 0.5 * (e.m12 + e.m21 + e.m11 * h.m21 + e.m12 * h.m22 + e.m21 * h.m11 + e.m22 * h.m12);
    Matrix::new(2.0 * mu * s11 + pressure, 2.0 * mu * s12, 2.0 * mu * s12, 2.0 * mu * s22 + pressure)
}

/// Cauchy stress σ = τ/J [Pa]; infinite or NaN when the material has no volume left (J = 0).
#[inline]
pub fn cauchy_stress(h: &Matrix, mu: f64, lambda: f64) -> Matrix {
    kirchhoff_stress(h, mu, lambda) / (1.0 + volume_change(h))
}

/// Strain energy Ψ = μ|F - R|² + λ(J-1)²/2 per volume at rest [J/m³].
#[inline]
pub fn energy_density(h: &Matrix, mu: f64, lambda: f64) -> f64 {
    let change = volume_change(h);
    mu * deformation_beyond_rotation(h).norm_squared() + 0.5 * lambda * change * change
}

/// Factor exp(ξ(1 - J_P)) on μ and λ of a plastic material [–]; `plastic_volume_ratio` is J_P = det F_P.
#[inline]
pub fn hardening_factor(plasticity: &Plasticity, plastic_volume_ratio: f64) -> f64 {
    (plasticity.hardening * (1.0 - plastic_volume_ratio)).exp()
}

/// Elastic and plastic parts after a plastic step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlasticStep {
    /// F_E - I [–].
    pub elastic: Matrix,
    /// F_P [–].
    pub plastic: Matrix,
}

/// Clamps the singular values of the trial F_E to [1-θ_c, 1+θ_s] and moves the rest into F_P; none when they are
/// within.
///
/// F_E* = U Σ* Vᵀ, Σ = clamp Σ*, F_E = U Σ Vᵀ, F_P := V Σ⁻¹ Uᵀ F_E* F_P, so that F_E F_P is unchanged. `elastic_trial`
/// is F_E* - I. Source: Stomakhin et al. 2013. The thesis prints Vᵀ for V in its eq. 17. U and V are rotations;
/// inverted material has a negative Σ* and is pushed back to 1-θ_c. Needs θ_c < 1.
pub fn plastic_step(elastic_trial: &Matrix, plastic: &Matrix, plasticity: &Plasticity) -> Option<PlasticStep> {
    let svd = SingularValues::of_identity_plus(elastic_trial);
    let (low, high) = (1.0 - plasticity.critical_compression, 1.0 + plasticity.critical_stretch);
    let clamped = svd.values.map(|s| s.clamp(low, high));
    if clamped == svd.values {
        return None;
    }
    let (u, v_transposed) = (rotation(svd.left), rotation(svd.right));
    let elastic = u * Matrix::new(clamped[0], 0.0, 0.0, clamped[1]) * v_transposed - Matrix::identity();
    // V Σ⁻¹ Uᵀ F_E* = V Σ⁻¹ Σ* Vᵀ.
    let ratio = Matrix::new(svd.values[0] / clamped[0], 0.0, 0.0, svd.values[1] / clamped[1]);
    let plastic = v_transposed.transpose() * ratio * v_transposed * plastic;
    Some(PlasticStep { elastic, plastic })
}

/// F = U Σ Vᵀ with U and Vᵀ rotations by `left` and `right` [rad]; the smaller value carries the sign of det F.
struct SingularValues {
    values: [f64; 2],
    left: f64,
    right: f64,
}

impl SingularValues {
    fn of_identity_plus(h: &Matrix) -> Self {
        let [[e, g], [d, s]] = rotation_and_reflection(h);
        let (turn, axis) = (g.atan2(e), s.atan2(d));
        Self { values: principal_stretches(h), left: 0.5 * (turn + axis), right: 0.5 * (turn - axis) }
    }
}

fn rotation(angle: f64) -> Matrix {
    let (s, c) = angle.sin_cos();
    Matrix::new(c, -s, s, c)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{PI, TAU};

    const MU: f64 = 1.3;
    const LAMBDA: f64 = 2.1;

    fn any_gradient(size: f64) -> impl Strategy<Value = Matrix> {
        prop::array::uniform4(-size..size).prop_map(|[a, b, c, d]| Matrix::new(a, b, c, d))
    }

    fn snow() -> Plasticity {
        Plasticity { critical_compression: 2.5e-2, critical_stretch: 7.5e-3, hardening: 10.0 }
    }

    proptest! {
        /// Truth: σ₁ σ₂ = det F and σ₁² + σ₂² = |F|². Terms of order 1, some ten of them.
        #[test]
        fn principal_stretches_are_the_singular_values(h in any_gradient(3.0)) {
            let [large, small] = principal_stretches(&h);
            let f = Matrix::identity() + h;
            prop_assert!(large >= small.abs());
            prop_assert!((large * small - f.determinant()).abs() < 1e-13 * f.norm_squared());
            prop_assert!((large * large + small * small - f.norm_squared()).abs() < 1e-14 * f.norm_squared());
        }

        /// Central difference with step d: error d²·|Ψ'''|/6 + ε|Ψ|/d, about 1e-9 at d = 1e-5 with moduli of order 1.
        #[test]
        fn stress_is_the_derivative_of_energy(h in any_gradient(0.4), angle in -PI..PI) {
            let h = rotation(angle) * (Matrix::identity() + h) - Matrix::identity();
            let stress = first_piola_stress(&h, MU, LAMBDA);
            let step = 1e-5;
            for k in 0..4 {
                let (mut plus, mut minus) = (h, h);
                plus[k] += step;
                minus[k] -= step;
                let slope = (energy_density(&plus, MU, LAMBDA) - energy_density(&minus, MU, LAMBDA)) / (2.0 * step);
                prop_assert!((slope - stress[k]).abs() < 2e-8, "entry {k}: {slope} against {}", stress[k]);
            }
        }

        #[test]
        fn stress_measures_agree(h in any_gradient(0.4)) {
            let f = Matrix::identity() + h;
            let kirchhoff = first_piola_stress(&h, MU, LAMBDA) * f.transpose();
            prop_assert!((kirchhoff - kirchhoff_stress(&h, MU, LAMBDA)).norm() < 1e-13);
            prop_assert!((kirchhoff / f.determinant() - cauchy_stress(&h, MU, LAMBDA)).norm() < 1e-12);
        }

        /// Turning the body turns the stress: P(QF) = Q P(F), σ(QF) = Q σ(F) Qᵀ.
        #[test]
        fn stress_is_objective(h in any_gradient(0.4), angle in -10.0 * TAU..10.0 * TAU) {
            let q = rotation(angle);
            let turned = q * (Matrix::identity() + h) - Matrix::identity();
            let difference = first_piola_stress(&turned, MU, LAMBDA) - q * first_piola_stress(&h, MU, LAMBDA);
            prop_assert!(difference.norm() < 1e-13, "{difference}");
            let cauchy = cauchy_stress(&turned, MU, LAMBDA) - q * cauchy_stress(&h, MU, LAMBDA) * q.transpose();
            prop_assert!(cauchy.norm() < 1e-12, "{cauchy}");
        }

        /// Truth: an independent singular value decomposition. Material yields if and only if a singular value of the
        /// trial F_E is out of bounds, and then to the nearest bounds; the whole deformation stays what it was.
        #[test]
        fn plastic_step_yields_to_the_bounds_and_keeps_the_whole_deformation(
            h in prop_oneof![any_gradient(0.9), any_gradient(0.02)],
            p in any_gradient(0.3),
        ) {
            let trial = Matrix::identity() + h;
            let plastic = Matrix::identity() + p;
            // The smaller one with the sign of the determinant: inverted material is pushed back.
            let signed = trial.svd(false, false).singular_values;
            let signed = [signed.max(), signed.min() * trial.determinant().signum()];
            let clamped = signed.map(|s| s.clamp(0.975, 1.0075));
            let yields = signed.iter().zip(&clamped).any(|(s, c)| (s - c).abs() > 1e-12);
            let step = plastic_step(&h, &plastic, &snow());
            prop_assert!(step.is_some() || !yields, "{signed:?} should yield");
            if let Some(step) = step {
                prop_assert!(signed != clamped, "{signed:?} should not yield");
                let elastic = Matrix::identity() + step.elastic;
                prop_assert!((elastic * step.plastic - trial * plastic).norm() < 1e-12);
                let values = elastic.svd(false, false).singular_values;
                prop_assert!((values.max() - clamped[0]).abs() < 1e-12, "{values} {clamped:?}");
                prop_assert!((values.min() - clamped[1]).abs() < 1e-12, "{values} {clamped:?}");
                prop_assert!(elastic.determinant() > 0.0);
                // Once back inside, nothing more flows beyond round-off.
                if let Some(again) = plastic_step(&step.elastic, &step.plastic, &snow()) {
                    prop_assert!((again.elastic - step.elastic).norm() < 1e-14);
                }
            }
        }
    }

    /// Ten full turns in steps: no stress may build up; the tolerance is the rounding of sine and cosine.
    #[test]
    fn rigid_turns_give_no_stress() {
        for i in 0..=1000 {
            let h = rotation(10.0 * TAU * f64::from(i) / 1000.0) - Matrix::identity();
            assert!(first_piola_stress(&h, MU, LAMBDA).norm() < 1e-14);
            assert!(energy_density(&h, MU, LAMBDA) < 1e-30);
        }
    }

    /// A half turn makes r + a vanish: to the bit and on both sides of it.
    #[test]
    fn half_turn_is_not_special() {
        let half_turn = Matrix::new(-2.0, 0.0, 0.0, -2.0);
        assert_eq!(first_piola_stress(&half_turn, MU, LAMBDA), Matrix::zeros());
        for angle in [PI - 1e-12, PI + 1e-12, PI - 1e-5, PI + 1e-5, -PI + 1e-8] {
            let stretched = rotation(angle) * Matrix::new(1.1, 0.02, 0.02, 0.95) - Matrix::identity();
            let h = Matrix::new(0.1, 0.02, 0.02, -0.05);
            let difference =
                first_piola_stress(&stretched, MU, LAMBDA) - rotation(angle) * first_piola_stress(&h, MU, LAMBDA);
            assert!(difference.norm() < 1e-14, "{difference}");
        }
        // An inversion with equal singular values has no rotation at all; the stress is still finite.
        let mirror = Matrix::new(0.0, 0.0, 0.0, -2.0);
        assert!(first_piola_stress(&mirror, MU, LAMBDA).iter().all(|s| s.is_finite()));
    }

    /// Truth: Hooke's law, from which the finite law differs by terms of the relative size of H itself. The third-order
    /// terms of a rotation w are relative to w too; its second-order strain w²/2 is part of the truth.
    #[test]
    fn tiny_strains_keep_their_digits() {
        let shape = Matrix::new(0.2, 1.1, -0.4, 1.0);
        let spin = Matrix::new(0.0, -1.0, 1.0, 0.0);
        for (h, tolerance) in [
            (1e-9 * shape, 1e-8),
            (1e-14 * shape, 1e-12),
            // A rotation a thousand times the strain.
            (1e-9 * shape + 1e-6 * spin, 1e-5),
            // A rotation whose w²/2 = 8e-16 is as large as the strain: the least rounding of 1 - cos would be an error
            // of 10 %.
            (1e-15 * shape + 4e-8 * spin, 1e-6),
        ] {
            let w = 0.5 * (h.m21 - h.m12);
            let strain = 0.5 * (h + h.transpose()) + 0.5 * w * w * Matrix::identity();
            let hooke = 2.0 * MU * strain + LAMBDA * strain.trace() * Matrix::identity();
            let energy = 0.5 * hooke.dot(&strain);
            for stress in [kirchhoff_stress(&h, MU, LAMBDA), cauchy_stress(&h, MU, LAMBDA)] {
                assert!((stress - hooke).norm() < tolerance * hooke.norm(), "{stress} against {hooke}");
            }
            assert!((energy_density(&h, MU, LAMBDA) - energy).abs() < tolerance * energy);
        }
    }

    #[test]
    fn small_deformation_stays_elastic() {
        assert_eq!(plastic_step(&Matrix::new(0.005, 0.001, -0.001, -0.02), &Matrix::identity(), &snow()), None);
        assert_eq!(hardening_factor(&snow(), 1.0), 1.0);
        assert!((hardening_factor(&snow(), 0.9) - 1.0_f64.exp()).abs() < 1e-14);
    }

    /// Inverted material comes back with positive volume; F_E F_P still is what it was.
    #[test]
    fn inverted_material_is_pushed_back() {
        let inverted = Matrix::new(0.0, 0.0, 0.0, -1.5);
        let step = plastic_step(&inverted, &Matrix::identity(), &snow());
        assert!(step.is_some_and(|s| {
            let elastic = Matrix::identity() + s.elastic;
            (elastic.m22 - 0.975).abs() < 1e-15
                && (elastic * s.plastic - Matrix::new(1.0, 0.0, 0.0, -0.5)).norm() < 1e-15
        }));
    }
}
