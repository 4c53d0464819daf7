//! What loads on crack faces take of J and of the interaction integral.
//!
//! ∫ t_i u_i,1 q ds and ∫ t_i U_i,1 q ds along each face, t the traction on it. Sources: Shih, Moran & Nakamura 1986
//! (J), Walters, Paulino & Dodds 2005 (interaction integral).
//!
//! The auxiliary field is known anywhere. The displacement of a face is known but for what the lattice makes of a
//! pressure within a cell of it, which is the same all along the face: its change is right, but not where that comes to
//! its end, at the tip. There the loads feel the series of the tip's own field instead, u_2,1 = ∓(2/E') K_I/√(2πr) ∓ b
//! √r and the same of u_1,1 and K_II, with b from the changes seen farther off. A centre crack of eight cells half long
//! has a √J that is 5.6 % short without.

use crate::material::elastic::Elastic;
use crate::tip::zone::TipZone;
use std::f64::consts::PI;

/// The sums over the loads of a zone.
#[derive(Debug, Default)]
pub(super) struct FaceTerms {
    /// Of the interaction integral of each mode.
    pub(super) mutual: [f64; 2],
    /// Of J, from the loads that are not near the tip [J/m²].
    pub(super) far: f64,
    /// Of J, from the loads near the tip, for each mode per K and per b.
    of_series: [[f64; 2]; 2],
    /// What the b of each mode is fitted to, with weights of length: Σ s β L, Σ κ β L and Σ β² L of the slopes s that
    /// are seen, κ of the field of a K of 1 and β of that of a b of 1.
    fit: [[f64; 3]; 2],
}

/// Means along a piece of a face.
struct Means {
    /// Of q.
    weight: f64,
    /// Of q/√r [1/√m].
    inverse_root: f64,
    /// Of q √r [√m].
    root: f64,
}

impl FaceTerms {
    /// From the loads of a zone; near are those within `near` of the tip, and what lies beyond `outer` [m] does not
    /// count. `q` at a distance behind the tip [m].
    pub(super) fn of(zone: &TipZone, material: &Elastic, near: f64, outer: f64, q: impl Fn(f64) -> f64) -> Self {
        let mut terms = Self::default();
        for load in &zone.face_loads {
            let ends = load.ends.map(|end| (-end.x).max(0.0));
            let length = ends[0] - ends[1];
            if length <= 0.0 || ends[1] >= outer {
                continue;
            }
            let sign = load.side.sign();
            // u_2,1 in mode I and u_1,1 in mode II of one face: half of the jump's, which is (8/E') √(r/2π).
            let per_mode = -2.0 / ((2.0 * PI).sqrt() * material.effective_modulus);
            let means = Means::along(ends, &q);
            let slope = sign * per_mode * means.inverse_root;
            let is_near = 0.5 * (ends[0] + ends[1]) < near;
            let plain = Means::along(ends, |_| 1.0);
            for (mode, axis) in [(0, 1), (1, 0)] {
                terms.mutual[mode] += load.force[axis] * slope;
                if is_near {
                    terms.of_series[mode][0] += load.force[axis] * slope;
                    terms.of_series[mode][1] -= load.force[axis] * sign * means.root;
                } else {
                    let seen = sign * load.stretch[axis] / length;
                    let slopes = [seen, per_mode * plain.inverse_root, -plain.root];
                    (0..3).for_each(|k| terms.fit[mode][k] -= slopes[k] * plain.root * length);
                }
            }
            if !is_near {
                // The displacement of the face goes along the piece towards the tip, as e1 does.
                terms.far += means.weight * load.force.dot(&load.stretch) / length;
            }
        }
        terms
    }

    /// What the loads near the tip take of J, where K_I and K_II are `modes` [J/m²].
    pub(super) fn near(&self, modes: [f64; 2]) -> f64 {
        let of = |mode: usize| {
            let [seen, of_mode, square] = self.fit[mode];
            let next = if square > 0.0 { (seen - modes[mode] * of_mode) / square } else { 0.0 };
            self.of_series[mode][0] * modes[mode] + self.of_series[mode][1] * next
        };
        of(0) + of(1)
    }
}

impl Means {
    /// Along a piece whose ends are behind the tip by two distances, the farther one first [m].
    fn along([far, near]: [f64; 2], q: impl Fn(f64) -> f64) -> Self {
        const PARTS: u32 = 8;
        let (low, high) = (near.sqrt(), far.sqrt());
        let mut means = Self { weight: 0.0, inverse_root: 0.0, root: 0.0 };
        let each = 2.0 * (high - low) / f64::from(PARTS) / (far - near);
        for part in 0..PARTS {
            // With r = x², dr = 2x dx, nothing is singular.
            let x = low + (high - low) * (f64::from(part) + 0.5) / f64::from(PARTS);
            let q = q(x * x) * each;
            means.weight += q * x;
            means.inverse_root += q;
            means.root += q * x * x;
        }
        means
    }
}
