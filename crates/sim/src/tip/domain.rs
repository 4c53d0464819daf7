//! J and the interaction integral over a disc around a crack tip, particles as quadrature points.
//!
//! With q = 1 near the tip and 0 at the rim (tip frame, e1 ahead):
//! J = Σ V [(P_iJ u_i,1 − (W + T) δ_1J) q,J + ρ (a_i u_i,1 − v_i v_i,1) q]: the energy release rate of a resting or
//! moving tip. For a resting tip T and the v-term cancel.
//! M = Σ V [(s_ij U_i,1 + S_ij u_i,1 − s_ij U_i,j δ_1j) q,j + ρ a_i U_i,1 q] with Williams' fields (U, S) of one mode,
//! K = E' M / 2: signed, mode by mode.
//! Faces that press on each other or rub take a part of both: ∫ t_i [u_i],1 q ds and ∫ t_i [U_i],1 q ds, with the
//! traction t on the face on the +e2 side and the jump [·] from the other side to it, are taken off (the boundary term
//! of the same integration by parts; of J that of the sliding, since pressed faces have no opening). At a closed crack
//! K_I is then what it is, zero, and K_II is short of what friction carries. So does what presses on the faces from
//! outside, ∫ t_i u_i,1 q ds and ∫ t_i U_i,1 q ds on each face: under a pressure it is most of J.
//! Sources: Li, Shih & Needleman 1985 (domain form of J); Yau, Wang & Corten 1980 (interaction integral); Nakamura,
//! Shih & Freund 1985 (dynamic terms); Shih, Moran & Nakamura 1986 and Walters, Paulino & Dodds 2005 (loaded faces, of
//! J and of the interaction integral).

use crate::crack::crossing::Side;
use crate::material::elastic::Elastic;
use crate::tip::face_terms::FaceTerms;
use crate::tip::face_traction::FaceTraction;
use crate::tip::zone::{FaceContact, QuadraturePoint, TipZone};
use crate::williams_fields;
use fissure_scene::Vector;
use std::f64::consts::PI;

/// J and the two stress intensities.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct DomainIntegrals {
    /// J [J/m²].
    pub(crate) j_integral: f64,
    /// K_I [Pa·√m].
    pub(crate) mode_1: f64,
    /// K_II [Pa·√m].
    pub(crate) mode_2: f64,
    /// Whether the faces press on each other at the tip and nothing but them keeps it from closing further.
    pub(crate) closed: bool,
}

/// q and ∇q at a place: 1 within `inner`, falling to 0 at `outer` [m] with continuous first and second derivative.
///
/// q = 1 − t³ (10 − 15 t + 6 t²). On exact K fields with 200 random offsets of the lattice (2×2 particles per cell, 1
/// and 4 cells) the largest error of K is 0.1 %; a linear ramp gives 3 %, a cubic one 0.6 %.
pub(super) fn weight(place: Vector, inner: f64, outer: f64) -> (f64, Vector) {
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

/// q is 1 within this radius, in cells.
pub(super) const INNER_RADIUS: f64 = 1.0;
/// Contacts so near to the tip, in cells, feel the jump of the tip's own field; those farther off that of the particles
/// beside them.
pub(super) const OF_TIP: f64 = 1.5;
/// Particles within this distance, in cells, tell how the jump across the crack changes.
pub(super) const JUMP_REACH: f64 = 0.75;

/// Integrals over the disc of radius `outer` [m]. `dynamic`: with the area terms of inertia.
pub(crate) fn domain_integrals(
    zone: &TipZone,
    elastic: &[Elastic],
    tip_material: &Elastic,
    cell_size: f64,
    outer: f64,
    dynamic: bool,
) -> DomainIntegrals {
    let inner = INNER_RADIUS * cell_size;
    let mut j = 0.0;
    let mut m = [0.0; 2];
    for p in &zone.points {
        let (q, slope) = weight(p.place, inner, outer);
        if q == 0.0 {
            continue;
        }
        let u_1 = p.gradient.column(0);
        let inertia = if dynamic { p.density } else { 0.0 };
        j += release_of(p, (q, slope), inertia);
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
    let q_behind = |r: f64| weight(Vector::new(-r, 0.0), inner, outer).0;
    let faces = FaceTerms::of(zone, tip_material, OF_TIP * cell_size, outer, q_behind);
    j -= faces.far;
    (0..2).for_each(|mode| m[mode] -= faces.mutual[mode]);
    let opened = m[0] > 0.0;
    let reach = JUMP_REACH * cell_size;
    let slope = |behind: f64| slope_of_sliding(&zone.points, behind, reach);
    let taken = take_contacts(&zone.contacts, tip_material, [cell_size, outer], (&mut j, &mut m), slope);
    let half_modulus = 0.5 * tip_material.effective_modulus;
    let [mode_1, mode_2] = m.map(|m| half_modulus * m);
    j -= taken.of_tip * mode_2 + faces.near([mode_1, mode_2]);
    DomainIntegrals { j_integral: j, mode_1, mode_2, closed: taken.pressed && !opened }
}

/// What contacts take at the tip.
pub(super) struct TakenByContacts {
    /// Of J, by K_II [√m].
    pub(super) of_tip: f64,
    /// Whether faces press on each other there.
    pub(super) pressed: bool,
}

/// Takes what contacts do off J, but for that at the tip, and off the interaction integrals; `slope_of_sliding`: at a
/// distance behind the tip.
pub(super) fn take_contacts(
    contacts: &[FaceContact],
    tip_material: &Elastic,
    [cell_size, outer]: [f64; 2],
    (j, m): (&mut f64, &mut [f64; 2]),
    slope_of_sliding: impl Fn(f64) -> f64,
) -> TakenByContacts {
    let inner = INNER_RADIUS * cell_size;
    let q_behind = |r: f64| weight(Vector::new(-r, 0.0), inner, outer).0;
    // Across Williams' faces the jump is (8/E') √(r/2π), of u_2 in mode I and of u_1 in mode II.
    let per_root = -4.0 / ((2.0 * PI).sqrt() * tip_material.effective_modulus);
    let traction = FaceTraction::of(contacts, cell_size, outer);
    let shut = traction.mean * (per_root * traction.inverse_root(q_behind));
    m[0] -= shut.y;
    m[1] -= shut.x;
    // What the contacts nearest to the tip feel of the jump is that of the tip's own field.
    let mut taken = TakenByContacts { of_tip: shut.x, pressed: false };
    for contact in contacts.iter().filter(|c| c.behind > -cell_size && c.behind < outer + cell_size) {
        let spread = spread(contact.behind, cell_size, q_behind);
        let force = contact.force * (1.0 - traction.part(contact.behind));
        let slope = per_root * spread.inverse_root;
        m[0] -= force.y * slope;
        m[1] -= force.x * slope;
        if contact.behind < OF_TIP * cell_size {
            taken.of_tip += force.x * slope;
            taken.pressed |= contact.force.y > 0.0;
        } else {
            *j -= spread.weight * force.x * slope_of_sliding(contact.behind);
        }
    }
    taken
}

/// What a point adds to J [J/m], where q and ∇q are `weight`; `inertia`: its density, or none [kg/m³].
fn release_of(p: &QuadraturePoint, (q, slope): (f64, Vector), inertia: f64) -> f64 {
    let u_1 = p.gradient.column(0);
    let kinetic = 0.5 * inertia * p.velocity.norm_squared();
    let flux = (p.stress.transpose() * u_1).dot(&slope) - (p.energy + kinetic) * slope.x;
    let area = inertia * (p.acceleration.dot(&u_1) - p.velocity.dot(&p.velocity_slope)) * q;
    p.volume * (flux + area)
}

/// What a node's force on a face is spread over.
struct Spread {
    /// Mean of q.
    weight: f64,
    /// Mean of q/√r [1/√m].
    inverse_root: f64,
}

/// Means over the part with r > 0 of the hat of a node at the distance `center` from the tip, which reaches a cell to
/// both sides [m].
fn spread(center: f64, cell_size: f64, q: impl Fn(f64) -> f64) -> Spread {
    const PARTS: u32 = 16;
    let (low, high) = ((center - cell_size).max(0.0).sqrt(), (center + cell_size).sqrt());
    let (mut length, mut weight, mut inverse_root) = (0.0, 0.0, 0.0);
    for part in 0..PARTS {
        // With r = x², dr = 2x dx, nothing is singular.
        let x = low + (high - low) * (f64::from(part) + 0.5) / f64::from(PARTS);
        let hat = (1.0 - (x * x - center).abs() / cell_size).max(0.0);
        let q = q(x * x);
        length += hat * x;
        weight += hat * q * x;
        inverse_root += hat * q;
    }
    // Too short a part for its hat to be seen between two places: nothing is spread there.
    if length == 0.0 {
        return Spread { weight: 0.0, inverse_root: 0.0 };
    }
    Spread { weight: weight / length, inverse_root: inverse_root / length }
}

/// How the sliding of the faces, [u_1], changes along e1 at a distance `behind` the tip [–], from the particles on the
/// two sides within a `reach` [m].
fn slope_of_sliding(points: &[QuadraturePoint], behind: f64, reach: f64) -> f64 {
    let place = Vector::new(-behind, 0.0);
    let mean = |side: Side| {
        let near = points.iter().filter(|p| p.side == side && (p.place - place).norm_squared() < reach * reach);
        let (sum, volume) =
            near.fold((0.0, 0.0), |(sum, volume), p| (sum + p.gradient.m11 * p.volume, volume + p.volume));
        (volume > 0.0).then(|| sum / volume)
    };
    match (mean(Side::Above), mean(Side::Below)) {
        (Some(above), Some(below)) => above - below,
        _ => 0.0,
    }
}

/// The place, moved onto the straight crack's own face when a bent crack has it on the other side of the tip's line, or
/// when it lies on that line but for round-off: a particle midway between the two that the line was centred on does.
fn beside_crack(place: Vector, side: Side) -> Vector {
    let distance = place.norm();
    if place.x < 0.0 && place.y * side.sign() < 1e-9 * distance {
        Vector::new(-distance, 0.0_f64.copysign(side.sign()))
    } else {
        place
    }
}

/// So far from the tip, in roots of an area, 1/√r is as large as its mean over a disc of that area around the tip [–].
pub(super) const CORE: f64 = 0.317;

/// The place of a particle of some `volume` at which the auxiliary fields stand for it: not nearer to the tip than its
/// core. At its centre the fields would be infinite for a particle that the tip hits.
pub(super) fn out_of_core(place: Vector, volume: f64) -> Vector {
    let (distance, least) = (place.norm(), CORE * volume.sqrt());
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
    use crate::tip::bend::Bend;
    use crate::tip::reciprocal::{Setting, reciprocal_integrals};
    use crate::tip::zone::FaceLoad;
    use fissure_scene::{Material, Matrix, PlaneState, Point};

    fn elastic(plane: PlaneState) -> Elastic {
        let material = Material {
            name: String::new(),
            young_modulus: 3.0,
            poisson_ratio: 0.3,
            density: 1.0,
            fracture_toughness: 1.0,
            limiting_speed: None,
            plasticity: None,
        };
        Elastic::new(&material, plane)
    }

    /// The field of K_I and K_II with a uniform stress besides, which the faces hand on, on a lattice of 2×2 particles
    /// per cell of length 1.
    fn zone(e: &Elastic, k: [f64; 2], uniform: Matrix, offset: Vector) -> TipZone {
        let mut points = Vec::new();
        let strain =
            (uniform - Matrix::identity() * (e.lambda / (2.0 * (e.lambda + e.mu)) * uniform.trace())) / (2.0 * e.mu);
        for j in -12..12 {
            for i in -12..12 {
                let place = Vector::new(f64::from(i) + 0.5, f64::from(j) + 0.5) * 0.5 + offset;
                let f = williams_fields(place, e.mu, e.kolosov);
                let gradient = f[0].displacement_gradient * k[0] + f[1].displacement_gradient * k[1] + strain;
                let stress = f[0].stress * k[0] + f[1].stress * k[1] + uniform;
                points.push(QuadraturePoint {
                    place,
                    displacement: f[0].displacement * k[0] + f[1].displacement * k[1] + strain * place,
                    side: if place.y >= 0.0 { Side::Above } else { Side::Below },
                    volume: 0.25,
                    stress,
                    gradient,
                    energy: 0.5 * stress.dot(&(gradient + gradient.transpose())) * 0.5,
                    density: 1.0,
                    velocity: Vector::zeros(),
                    velocity_slope: Vector::zeros(),
                    acceleration: Vector::zeros(),
                    material: 0,
                });
            }
        }
        // What nodes one apart gather from the face.
        let traction = -uniform.column(1);
        let kink = |r: f64| 0.5 * r.max(0.0).powi(2);
        let contacts = (-1..6).map(|i| {
            let behind = f64::from(i) - offset.x;
            let length = kink(behind + 1.0) - 2.0 * kink(behind) + kink(behind - 1.0);
            FaceContact { place: Vector::new(-behind, 0.0), behind, force: traction * length }
        });
        TipZone { points, contacts: contacts.filter(|c| c.force != Vector::zeros()).collect(), ..TipZone::default() }
    }

    /// A straight crack, as one that is bent somewhere far off.
    fn straight() -> Bend {
        Bend::new(vec![Point::new(-20.0, 0.0), Point::origin()])
    }

    fn setting(e: &Elastic) -> Setting<'_> {
        Setting { elastic: std::slice::from_ref(e), tip: e, cell_size: 1.0, dynamic: true }
    }

    const OFFSETS: [Vector; 3] = [Vector::new(0.1, 0.2), Vector::new(0.33, -0.41), Vector::new(0.0, 0.25)];

    /// Truth: the exact K field gives back K_I, K_II and J = (K_I² + K_II²)/E'. Tolerance: the quadrature error of at
    /// most 0.1 % (K) and 0.1 % (J) at a radius of 4 cells, see [`weight`].
    #[test]
    fn an_exact_field_gives_its_own_stress_intensities() {
        for e in [PlaneState::Strain, PlaneState::Stress].map(elastic) {
            for [k_1, k_2] in [[1.0, 0.0], [0.0, 1.0], [1.0, -0.5]] {
                for offset in OFFSETS {
                    let zone = zone(&e, [k_1, k_2], Matrix::zeros(), offset);
                    let found = domain_integrals(&zone, &[e], &e, 1.0, 4.0, true);
                    let j = (k_1 * k_1 + k_2 * k_2) / e.effective_modulus;
                    assert!((found.mode_1 - k_1).abs() < 1.5e-3, "{found:?}");
                    assert!((found.mode_2 - k_2).abs() < 1.5e-3, "{found:?}");
                    assert!((found.j_integral / j - 1.0).abs() < 1.5e-3, "{found:?} {j}");
                    assert!(!found.closed, "{found:?}");
                    let found = reciprocal_integrals(&zone, &straight(), 9.0, &setting(&e), 4.0);
                    assert!((found.mode_1 - k_1).abs() < 1.5e-3, "{found:?}");
                    assert!((found.mode_2 - k_2).abs() < 1.5e-3, "{found:?}");
                }
            }
        }
    }

    /// Truth: a uniform stress that a load on the faces holds in balance has no stress intensities (superposition), and
    /// J is that of K. Without the part of the faces both would be off by more than 1.
    #[test]
    fn what_presses_on_open_faces_is_taken_off() {
        for e in [PlaneState::Strain, PlaneState::Stress].map(elastic) {
            for offset in OFFSETS.map(|offset| Vector::new(offset.x, 0.0)) {
                let uniform = Matrix::new(0.0, 0.3, 0.3, -1.0);
                let mut zone = zone(&e, [1.0, 0.5], uniform, offset);
                zone.contacts.clear();
                let strain = (uniform - Matrix::identity() * (e.lambda / (2.0 * (e.lambda + e.mu)) * uniform.trace()))
                    / (2.0 * e.mu);
                let pieces: Vec<(f64, f64)> = (0..12).map(|k| (0.5 * f64::from(k), 0.5 * f64::from(k + 1))).collect();
                for side in [Side::Above, Side::Below] {
                    let moved = |r: f64| {
                        let f = williams_fields(Vector::new(-r, 0.0_f64.copysign(side.sign())), e.mu, e.kolosov);
                        let of_tip = f[0].displacement + f[1].displacement * 0.5;
                        of_tip * f64::from(u8::from(r > 0.0)) + strain * Vector::new(-r, 0.0)
                    };
                    zone.face_loads.extend(pieces.iter().map(|&(near, far)| FaceLoad {
                        ends: [far, near].map(|r| Vector::new(-r, 0.0)),
                        side,
                        // Out of the material is down for the upper face.
                        force: uniform * Vector::new(0.0, -side.sign()) * (far - near),
                        stretch: if near > 0.0 { moved(near) - moved(far) } else { -moved(far) },
                    }));
                }
                let found = domain_integrals(&zone, &[e], &e, 1.0, 4.0, true);
                assert!((found.mode_1 - 1.0).abs() < 0.01 && (found.mode_2 - 0.5).abs() < 0.01, "{found:?}");
                assert!((found.j_integral * e.effective_modulus - 1.25).abs() < 0.02, "{found:?}");
                assert!(!found.closed, "{found:?}");
                let found = reciprocal_integrals(&zone, &straight(), 9.0, &setting(&e), 4.0);
                assert!((found.mode_1 - 1.0).abs() < 0.01 && (found.mode_2 - 0.5).abs() < 0.01, "{found:?}");
                zone.face_loads.clear();
                let found = domain_integrals(&zone, &[e], &e, 1.0, 4.0, true);
                assert!(found.mode_1 < 0.0, "{found:?}");
            }
        }
    }

    /// Truth: a uniform stress that closed faces hand on has no stress intensities (superposition). Without the part of
    /// the faces both would be off by more than 1.
    #[test]
    fn what_closed_faces_hand_on_does_not_load_the_tip() {
        for e in [PlaneState::Strain, PlaneState::Stress].map(elastic) {
            // Zones are centred between the rows of particles that the crack parts.
            for offset in OFFSETS.map(|offset| Vector::new(offset.x, 0.0)) {
                let zone = zone(&e, [0.0, 1.0], Matrix::new(0.0, 0.5, 0.5, -1.0), offset);
                let found = domain_integrals(&zone, &[e], &e, 1.0, 4.0, true);
                assert!(found.mode_1.abs() < 0.01 && (found.mode_2 - 1.0).abs() < 0.01, "{found:?}");
                assert!((found.j_integral * e.effective_modulus - 1.0).abs() < 0.05, "{found:?}");
                assert!(found.closed, "{found:?}");
                let found = reciprocal_integrals(&zone, &straight(), 9.0, &setting(&e), 4.0);
                assert!(found.mode_1.abs() < 0.01 && (found.mode_2 - 1.0).abs() < 0.01, "{found:?}");
                let bare = TipZone { contacts: Vec::new(), ..zone };
                let found = domain_integrals(&bare, &[e], &e, 1.0, 4.0, true);
                assert!(found.mode_1 < -1.0 && found.mode_2 > 1.5 && !found.closed, "{found:?}");
            }
        }
    }
}
