//! J and the interaction integral over a disc around a crack tip, particles as quadrature points.
//!
//! With q = 1 near the tip and 0 at the rim (tip frame, e1 ahead):
//! J = Σ V [(P_iJ u_i,1 − (W + T) δ_1J) q,J + ρ (a_i u_i,1 − v_i v_i,1) q]: the energy release rate of a resting or moving tip. For a resting
//! tip T and the v-term cancel.
//! M = Σ V [(s_ij U_i,1 + S_ij u_i,1 − s_ij U_i,j δ_1j) q,j + ρ a_i U_i,1 q] with Williams' fields (U, S) of one mode, K = E' M / 2: signed,
//! mode by mode.
//! Sources: Li, Shih & Needleman 1985 (domain form of J); Yau, Wang & Corten 1980 (interaction integral); Nakamura, Shih & Freund 1985 (dynamic terms).

use crate::crossing::Side;
use crate::elastic::Elastic;
use crate::solver::QuadraturePoint;
use crate::williams_fields;
use fissure_scene::Vector;

/// J and the two stress intensities.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct DomainIntegrals {
    /// J [J/m²].
    pub(crate) j_integral: f64,
    /// K_I [Pa·√m].
    pub(crate) mode_1: f64,
    /// K_II [Pa·√m].
    pub(crate) mode_2: f64,
}

/// q and ∇q at a place: 1 within `inner`, falling to 0 at `outer` [m] with continuous first and second derivative.
///
/// q = 1 − t³ (10 − 15 t + 6 t²). On exact K fields with 200 random offsets of the lattice (2×2 particles per cell, 1 and 4 cells) the largest
/// error of K is 0.1 %; a linear ramp gives 3 %, a cubic one 0.6 %.
fn weight(place: Vector, inner: f64, outer: f64) -> (f64, Vector) {
    let r = place.norm();
    if r <= inner {
        return (1.0, Vector::zeros());
    }
    if r >= outer {
        return (0.0, Vector::zeros());
    }
    let t = (r - inner) / (outer - inner);
    let q = 1.0 - t * t * t * (10.0 - t * (15.0 - 6.0 * t));
    let slope = -30.0 * t * t * (1.0 - t) * (1.0 - t) / (outer - inner);
    (q, place * (slope / r))
}

/// Integrals over the disc of radius `outer`; q is 1 within `inner` [m]. `dynamic`: with the area terms of inertia.
pub(crate) fn domain_integrals(
    points: &[QuadraturePoint],
    elastic: &[Elastic],
    tip_material: &Elastic,
    inner: f64,
    outer: f64,
    dynamic: bool,
) -> DomainIntegrals {
    let mut j = 0.0;
    let mut m = [0.0; 2];
    for p in points {
        let (q, slope) = weight(p.place, inner, outer);
        if q == 0.0 {
            continue;
        }
        let u_1 = p.gradient.column(0);
        let inertia = if dynamic { p.density } else { 0.0 };
        let kinetic = 0.5 * inertia * p.velocity.norm_squared();
        let flux = (p.stress.transpose() * u_1).dot(&slope) - (p.energy + kinetic) * slope.x;
        let area = inertia * (p.acceleration.dot(&u_1) - p.velocity.dot(&p.velocity_slope)) * q;
        j += p.volume * (flux + area);
        let own = &elastic[p.material as usize];
        let place = out_of_core(beside_crack(p.place, p.side), p.volume);
        let strain = (p.gradient + p.gradient.transpose()) * 0.5;
        // Linear stress of the linear auxiliary problem.
        let stress = nalgebra::Matrix2::identity() * (own.lambda * strain.trace()) + strain * (2.0 * own.mu);
        for (mode, auxiliary) in williams_fields(place, tip_material.mu, tip_material.kolosov).iter().enumerate() {
            let big_u_1 = auxiliary.displacement_gradient.column(0);
            let mutual = auxiliary.stress.dot(&strain);
            let flux = (stress * big_u_1 + auxiliary.stress * u_1).dot(&slope) - mutual * slope.x;
            m[mode] += p.volume * (flux + inertia * p.acceleration.dot(&big_u_1) * q);
        }
    }
    let half_modulus = 0.5 * tip_material.effective_modulus;
    DomainIntegrals { j_integral: j, mode_1: half_modulus * m[0], mode_2: half_modulus * m[1] }
}

/// The place, moved onto the straight crack's own face when a bent crack has it on the other side of the tip's line, or when it lies on that line but for
/// round-off: a particle midway between the two that the line was centred on does.
fn beside_crack(place: Vector, side: Side) -> Vector {
    let distance = place.norm();
    if place.x < 0.0 && place.y * side.sign() < 1e-9 * distance {
        Vector::new(-distance, 0.0_f64.copysign(side.sign()))
    } else {
        place
    }
}

/// The place of a particle of some `volume` at which the auxiliary fields stand for it: at least 0.317 √V from the tip, where 1/√r is as large as its
/// mean over a disc of that area around the tip. At its centre it would be infinite for a particle that the tip hits.
fn out_of_core(place: Vector, volume: f64) -> Vector {
    let (distance, least) = (place.norm(), 0.317 * volume.sqrt());
    if distance >= least {
        place
    } else if distance > 0.0 {
        place * (least / distance)
    } else {
        Vector::new(least, 0.0)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use fissure_scene::{Material, PlaneState};

    /// Truth: the exact K field on a lattice of 2×2 particles per cell gives back K_I, K_II and J = (K_I² + K_II²)/E'. Tolerance: the
    /// quadrature error of at most 0.1 % (K) and 0.1 % (J) at a radius of 4 cells, see [`weight`].
    #[test]
    fn an_exact_field_gives_its_own_stress_intensities() {
        let material = Material {
            name: String::new(),
            young_modulus: 3.0,
            poisson_ratio: 0.3,
            density: 1.0,
            fracture_toughness: 1.0,
            limiting_speed: None,
            plasticity: None,
        };
        for plane in [PlaneState::Strain, PlaneState::Stress] {
            let e = Elastic::new(&material, plane);
            for (k_1, k_2) in [(1.0, 0.0), (0.0, 1.0), (1.0, -0.5)] {
                for offset in [Vector::new(0.1, 0.2), Vector::new(0.33, -0.41), Vector::new(0.0, 0.25)] {
                    let mut points = Vec::new();
                    for j in -12..12 {
                        for i in -12..12 {
                            let place = Vector::new(f64::from(i) + 0.5, f64::from(j) + 0.5) * 0.5 + offset;
                            let f = williams_fields(place, e.mu, e.kolosov);
                            let gradient = f[0].displacement_gradient * k_1 + f[1].displacement_gradient * k_2;
                            let stress = f[0].stress * k_1 + f[1].stress * k_2;
                            points.push(QuadraturePoint {
                                place,
                                side: if place.y >= 0.0 { Side::Above } else { Side::Below },
                                volume: 0.25,
                                stress,
                                gradient,
                                energy: 0.5 * stress.dot(&gradient),
                                density: 1.0,
                                velocity: Vector::zeros(),
                                velocity_slope: Vector::zeros(),
                                acceleration: Vector::zeros(),
                                material: 0,
                            });
                        }
                    }
                    let found = domain_integrals(&points, &[e], &e, 1.0, 4.0, true);
                    let j = (k_1 * k_1 + k_2 * k_2) / e.effective_modulus;
                    assert!((found.mode_1 - k_1).abs() < 1.5e-3, "{found:?}");
                    assert!((found.mode_2 - k_2).abs() < 1.5e-3, "{found:?}");
                    assert!((found.j_integral / j - 1.0).abs() < 1.5e-3, "{found:?} {j}");
                }
            }
        }
    }
}
