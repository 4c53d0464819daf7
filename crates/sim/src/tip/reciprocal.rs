//! K_I and K_II of a tip behind which the crack is bent, by the reciprocal theorem (Betti).
//!
//! The auxiliary state (U, S) of a mode is the derivative of Williams' field along e1, as singular as r^-½ in its
//! displacement; it is in equilibrium without body force, and K is the work of each state's forces on the displacements
//! of the other, through any line around the tip. With q = 1 near the tip and 0 at the rim (frame of the tip):
//!
//! K = (E'/2) { Σ V [(s_ij U_i − S_ij u_i) q,j + ρ a_i U_i q] + ∫ S_ij m_j u_i q ds − Σ F_i (U_i⁺ − U_i⁻) q }
//!
//! with ∫ over both faces, m out of the material, and F what the faces do to the left one; what presses on a face from
//! outside takes −F_i U_i of that face. The field is continued along
//! the crack as it is: on the left of it the angle grows beyond π, on the right below −π. On a straight crack the face
//! term is 0; where the crack is bent it takes what the auxiliary state has of tractions there. So the sum does not
//! depend on the rim and a kink within it does no harm, which it does to J and to the interaction integral: these take
//! for energy of the tip what the singular corner of the kink holds. Of a tip that moves, J here is that of a resting
//! one with the same K.
//!
//! Sources: Stern, Becker & Dunham 1976 (reciprocal work contour integral); the domain form is that of
//! [`domain`](super::domain).

use super::bend::Bend;
use super::domain::{DomainIntegrals, INNER_RADIUS, OF_TIP, out_of_core, weight};
use super::zone::{QuadraturePoint, TipZone};
use crate::crack::crossing::Side;
use crate::material::elastic::Elastic;
use crate::tip::williams::dual_fields;
use fissure_plane::{Point, Vector};

/// Length of the pieces of a face, in cells.
const PIECE: f64 = 0.125;
/// Faces nearer to the tip, in cells, or before the first kink are free of auxiliary tractions, or nearly.
const STRAIGHT: f64 = 1.0;
/// Particles so near, in cells, tell how a face moves.
const FACE_REACH: f64 = 1.5;
/// What two distances have to differ by, as part of them, to differ whatever rounding has done to them.
const ROUND_OFF: f64 = 1e-9;

/// A quadrature point with the face that it sees.
struct Sided<'a> {
    point: &'a QuadraturePoint,
    side: Option<Side>,
}

/// What an integral needs to know besides the zone.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Setting<'a> {
    /// All materials.
    pub(crate) elastic: &'a [Elastic],
    /// That of the tip.
    pub(crate) tip: &'a Elastic,
    /// [m].
    pub(crate) cell_size: f64,
    /// Whether inertia counts.
    pub(crate) dynamic: bool,
}

/// K_I and K_II, and J = (K_I² + K_II²)/E', from the disc of radius `outer` [m]; `to_kink`: way from the tip to the
/// first kink [m].
pub(crate) fn reciprocal_integrals(
    zone: &TipZone,
    bend: &Bend,
    to_kink: f64,
    setting: &Setting<'_>,
    outer: f64,
) -> DomainIntegrals {
    let Setting { elastic, tip: tip_material, cell_size, dynamic } = *setting;
    let inner = INNER_RADIUS * cell_size;
    let q_at = |place: Point| weight(place.coords, inner, outer).0;
    let fields = |place: Vector, side: Option<Side>| {
        dual_fields(place, Bend::is_beyond(place, side), tip_material.mu, tip_material.kolosov)
    };
    let face_reach = FACE_REACH * cell_size;
    let mut points: Vec<Sided<'_>> = Vec::with_capacity(zone.points.len());
    // Those near each face, left and right.
    let mut beside: [Vec<&QuadraturePoint>; 2] = Default::default();
    for point in &zone.points {
        let seen = bend.side(point.place.into(), point.side);
        points.push(Sided { point, side: seen.map(|of| of.0) });
        if let Some((side, _)) = seen.filter(|of| of.1 < face_reach * (1.0 + ROUND_OFF)) {
            beside[usize::from(side == Side::Below)].push(point);
        }
    }
    let shift = tip_displacement(zone, cell_size);
    let mut m = [0.0; 2];
    for Sided { point: p, side } in &points {
        let (q, slope) = weight(p.place, inner, outer);
        if q == 0.0 {
            continue;
        }
        let own = &elastic[p.material as usize];
        let strain = (p.gradient + p.gradient.transpose()) * 0.5;
        let stress = nalgebra::Matrix2::identity() * (own.lambda * strain.trace()) + strain * (2.0 * own.mu);
        let inertia = if dynamic { p.density } else { 0.0 };
        for (mode, dual) in fields(out_of_core(p.place, p.volume), *side).iter().enumerate() {
            let flux = (stress * dual.displacement - dual.stress * (p.displacement - shift)).dot(&slope);
            m[mode] += p.volume * (flux + inertia * p.acceleration.dot(&dual.displacement) * q);
        }
    }
    for stretch in bend.stretches(to_kink.min(STRAIGHT * cell_size), PIECE * cell_size) {
        let (place, q) = (stretch.foot.place, q_at(stretch.foot.place));
        if q == 0.0 {
            continue;
        }
        let out_of_left = Vector::new(stretch.toward.y, -stretch.toward.x);
        for (side, beside) in [Side::Above, Side::Below].into_iter().zip(&beside) {
            let Some(moved) = face_displacement(beside, place, face_reach) else { continue };
            let outward = out_of_left * (side.sign() * q * stretch.length);
            for (mode, dual) in fields(place.coords, Some(side)).iter().enumerate() {
                m[mode] += (dual.stress * outward).dot(&(moved - shift));
            }
        }
    }
    for load in &zone.face_loads {
        let [far, near] = load.ends.map(|end| bend.foot(end.into()).way.max(0.0));
        if far > near {
            let mean = mean_of_face(bend, [near, far], |place| {
                let q = q_at(place);
                fields(place.coords, Some(load.side)).map(|dual| dual.displacement * q)
            });
            (0..2).for_each(|mode| m[mode] -= load.force.dot(&mean[mode]));
        }
    }
    let opened = m[0] > 0.0;
    let mut pressed = false;
    for contact in &zone.contacts {
        let foot = bend.foot(contact.place.into());
        // Nothing of the crack is nearer to a node ahead of the tip.
        let way = if foot.way > 0.0 { foot.way } else { contact.behind.min(0.0) };
        if way <= -cell_size || way >= outer + cell_size {
            continue;
        }
        pressed |= way < OF_TIP * cell_size && contact.force.y > 0.0;
        let jumps = mean_jumps(bend, way, cell_size, |place, side| {
            let q = q_at(place);
            fields(place.coords, Some(side)).map(|dual| dual.displacement * q)
        });
        (0..2).for_each(|mode| m[mode] -= contact.force.dot(&jumps[mode]));
    }
    let [mode_1, mode_2] = m.map(|m| 0.5 * tip_material.effective_modulus * m);
    let j_integral = (mode_1 * mode_1 + mode_2 * mode_2) / tip_material.effective_modulus;
    DomainIntegrals { j_integral, mode_1, mode_2, closed: pressed && !opened }
}

/// Displacement of the tip [m]. A shift of the whole cancels in the integral, but for the error of the sum.
///
/// For a field like √r it is H x = u/2: what u − 2 H x leaves of it is nothing, so that the mean does not depend on how
/// many particles lie on which side.
fn tip_displacement(zone: &TipZone, cell_size: f64) -> Vector {
    let near = zone.points.iter().filter(|p| p.place.norm_squared() < cell_size * cell_size);
    let (sum, count) = near.fold((Vector::zeros(), 0.0), |(sum, count), p| {
        (sum + p.displacement - p.gradient * p.place * 2.0, count + 1.0)
    });
    sum / f64::max(count, 1.0)
}

/// How the face of one side moves at a place on the crack [m], from the particles `beside` it within `reach` [m]; none
/// where there are none.
fn face_displacement(beside: &[&QuadraturePoint], place: Point, reach: f64) -> Option<Vector> {
    let (mut sum, mut volume) = (Vector::zeros(), 0.0);
    for point in beside {
        let arm = point.place - place.coords;
        let nearness = 1.0 - arm.norm() / reach;
        if nearness > 0.0 {
            let w = point.volume * nearness.powi(4);
            sum += (point.displacement - point.gradient * arm) * w;
            volume += w;
        }
    }
    (volume > 0.0).then(|| sum / volume)
}

/// Means of what `of` gives for both modes over the ways between two from the tip [m].
fn mean_of_face(bend: &Bend, ways: [f64; 2], of: impl Fn(Point) -> [Vector; 2]) -> [Vector; 2] {
    const PARTS: u32 = 8;
    let [low, high] = ways.map(f64::sqrt);
    let mut sums = [Vector::zeros(); 2];
    for part in 0..PARTS {
        // As in `mean_jumps`.
        let x = low + (high - low) * (f64::from(part) + 0.5) / f64::from(PARTS);
        let values = of(bend.at(x * x));
        (0..2).for_each(|mode| sums[mode] += values[mode] * x);
    }
    sums.map(|sum| sum * (2.0 * (high - low) / f64::from(PARTS) / (ways[1] - ways[0])))
}

/// Means of the jumps, left less right, of the auxiliary displacements of both modes, over the hat of a node at the way
/// `center` to the tip [m], negative ahead of it, which reaches a cell to both sides along the crack.
fn mean_jumps(
    bend: &Bend,
    center: f64,
    cell_size: f64,
    displacements: impl Fn(Point, Side) -> [Vector; 2],
) -> [Vector; 2] {
    const PARTS: u32 = 16;
    let (low, high) = ((center - cell_size).max(0.0).sqrt(), (center + cell_size).sqrt());
    let (mut length, mut jumps) = (0.0, [Vector::zeros(); 2]);
    for part in 0..PARTS {
        // With the way x², of length 2x dx, nothing is singular.
        let x = low + (high - low) * (f64::from(part) + 0.5) / f64::from(PARTS);
        let part = (1.0 - (x * x - center).abs() / cell_size).max(0.0) * x;
        let place = bend.at(x * x);
        let [left, right] = [Side::Above, Side::Below].map(|side| displacements(place, side));
        length += part;
        (0..2).for_each(|mode| jumps[mode] += (left[mode] - right[mode]) * part);
    }
    if length > 0.0 { jumps.map(|jump| jump / length) } else { [Vector::zeros(); 2] }
}
