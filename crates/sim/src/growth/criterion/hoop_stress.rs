//! Maximum hoop stress (Erdogan & Sih 1963).
//!
//! A crack goes on in the direction in which the hoop stress around its tip is highest, when that stress reaches what
//! mode I at K_Ic has.

use super::Criterion;
use crate::StressIntensity;

impl StressIntensity {
    /// Kink angle θ_c of maximum hoop stress (Erdogan & Sih 1963) [rad], positive counter-clockwise.
    ///
    /// θ = 2 atan2(-2 K_II, K_I + √(K_I² + 8 K_II²)), with K_II scaled by `bending`: 0 straight, 1 physical. Pure shear
    /// gives ∓70.53°. A closed crack (K_I < 0) counts as K_I = 0; without any load the angle is 0.
    pub fn kink_angle(&self, bending: f64) -> f64 {
        let (k_1, k_2) = (self.mode_1.max(0.0), bending * self.mode_2);
        // Adding zero turns -0 into 0.
        2.0 * (-2.0 * k_2).atan2(k_1 + k_1.hypot(8.0_f64.sqrt() * k_2)) + 0.0
    }

    /// Equivalent stress intensity K_eq(θ) = cos(θ/2) [K_I cos²(θ/2) - (3/2) K_II sin θ] [Pa·√m], to be compared with
    /// K_Ic.
    ///
    /// The hoop stress at `angle` [rad] times √(2πr); at the kink angle (bending 1) its maximum. The thesis' eq. 34 has
    /// the opposite sign of K_II, by which a crack under shear never starts. A closed crack (K_I < 0) counts as K_I =
    /// 0.
    pub fn equivalent(&self, angle: f64) -> f64 {
        let half_cosine = (0.5 * angle).cos();
        half_cosine * (self.mode_1.max(0.0) * half_cosine * half_cosine - 1.5 * self.mode_2 * angle.sin())
    }
}

/// The criterion of maximum hoop stress.
#[derive(Debug)]
pub(super) struct HoopStress;

impl Criterion for HoopStress {
    fn kink_angle(&self, load: &StressIntensity, bending: f64) -> f64 {
        load.kink_angle(bending)
    }

    fn equivalent(&self, load: &StressIntensity, angle: f64) -> f64 {
        load.equivalent(angle)
    }

    /// cos³(δ/2): that of mode I, for any mode.
    ///
    /// It is also what K_I of a short kink at δ has of that before it (Cotterell & Rice 1980), 1 % too little at 60°,
    /// 5 at 90°, 17 at 120° (Amestoy & Leblond 1992).
    fn share_beside(&self, angle: f64) -> f64 {
        (0.5 * angle).cos().powi(3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn k(mode_1: f64, mode_2: f64) -> StressIntensity {
        StressIntensity { mode_1, mode_2 }
    }

    /// Truth: maximum of the hoop stress, tabulated to 6 digits: (K_II/K_I, θ [°], K_hoop/K_I).
    #[test]
    fn kink_angle_and_equivalent_agree_with_the_table() {
        let table = [
            (0.01, -1.14565, 1.00015),
            (0.05, -5.69652, 1.00373),
            (0.1, -11.2029, 1.01475),
            (0.2, -21.0888, 1.05631),
            (0.3, -29.1026, 1.11867),
            (0.5, -40.2078, 1.28279),
            (0.75, -48.3032, 1.52619),
            (1.0, -53.1301, 1.78885),
            (2.0, -61.3418, 2.90054),
            (5.0, -66.7596, 6.3369),
            (10.0, -68.6309, 12.1009),
            (1e9, -70.5288, 1.1547e9),
        ];
        for (ratio, degrees, hoop) in table {
            for sign in [1.0, -1.0] {
                let state = k(2e6, sign * ratio * 2e6);
                let angle = state.kink_angle(1.0);
                assert!((angle.to_degrees() - sign * degrees).abs() < 5.1e-5, "{ratio}: {}", angle.to_degrees());
                assert!((state.equivalent(angle) / 2e6 - hoop).abs() < 5.1e-6 * hoop);
            }
        }
    }

    /// Truth: brute force over all angles.
    #[test]
    fn no_angle_has_more_hoop_stress() {
        for i in 0..60 {
            let phase = -0.5 * PI + PI * f64::from(i) / 59.0;
            let state = k(phase.cos(), phase.sin());
            let best = state.equivalent(state.kink_angle(1.0));
            let brute = (-1000..=1000).map(|j| state.equivalent(f64::from(j) * 1e-3 * PI)).fold(f64::MIN, f64::max);
            assert!(best >= brute - 1e-14, "{state:?}: {best} below {brute}");
        }
    }

    #[test]
    fn singular_states_are_quiet() {
        assert_eq!(k(0.0, 0.0).kink_angle(1.0).to_bits(), 0.0_f64.to_bits());
        assert_eq!(k(0.0, 0.0).equivalent(0.3), 0.0);
        assert_eq!(k(3.0, 0.0).kink_angle(1.0).to_bits(), 0.0_f64.to_bits());
        // Closed: no growth by compression, shear as in pure shear.
        assert_eq!(k(-3.0, 0.0).kink_angle(1.0), 0.0);
        assert_eq!(k(-3.0, 0.0).equivalent(0.0), 0.0);
        let closed_shear = k(-3.0, 1.0);
        assert!((closed_shear.kink_angle(1.0) + (1.0_f64 / 3.0).acos()).abs() < 1e-15);
        assert!((closed_shear.equivalent(closed_shear.kink_angle(1.0)) - 2.0 / 3.0_f64.sqrt()).abs() < 1e-15);
        // Bending acts on the direction alone.
        assert_eq!(k(1.0, 1.0).kink_angle(0.0), 0.0);
        assert_eq!(k(1.0, 1.0).kink_angle(2.0), k(1.0, 2.0).kink_angle(1.0));
    }

    /// Truth: K_I of an infinitesimal kink of a crack under mode I (Amestoy & Leblond 1992, series in m = δ/π).
    #[test]
    fn the_share_beside_is_that_of_a_kink() {
        for (degrees, most) in [(30.0_f64, 0.001), (60.0, 0.01), (90.0, 0.05), (120.0, 0.17)] {
            let (m, p) = (degrees / 180.0, PI);
            let terms = [
                1.0,
                -3.0 * p.powi(2) / 8.0,
                p.powi(2) - 5.0 * p.powi(4) / 128.0,
                p.powi(2) / 9.0 - 11.0 * p.powi(4) / 72.0 + 119.0 * p.powi(6) / 15360.0,
                5.07790,
                -2.88312,
                -0.0925,
                2.996,
                -4.059,
                1.63,
                4.1,
            ];
            let kink = terms.iter().rev().fold(0.0, |sum, term| sum * m * m + term);
            let share = HoopStress.share_beside(degrees.to_radians());
            assert!(share < kink && share > kink * (1.0 - most), "{degrees}: {share}, {kink}");
        }
    }

    /// Truth: the hoop stress of mode I itself.
    #[test]
    fn the_share_beside_is_that_of_mode_1() {
        for degrees in [-60.0_f64, -5.0, 0.0, 20.0, 75.0] {
            let angle = degrees.to_radians();
            assert!((HoopStress.share_beside(angle) - k(1.0, 0.0).equivalent(angle)).abs() < 1e-15, "{degrees}");
        }
    }
}
