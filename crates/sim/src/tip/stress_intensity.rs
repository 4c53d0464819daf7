//! Stress intensity factors: from J, and what the speed of the tip changes.

use crate::Elastic;
use fissure_scene::Vector;
use std::f64::consts::PI;

/// Stress intensity factors of a crack tip, in its frame (e1 = growth direction, e2 = e1 turned by +90°).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StressIntensity {
    /// K_I [Pa·√m], positive opening.
    pub mode_1: f64,
    /// K_II [Pa·√m], positive when s12 > 0 ahead of the tip.
    pub mode_2: f64,
}

impl StressIntensity {
    /// Splits J by the ratio of opening and sliding: K_I = d_I/|d| √(E'J), K_II likewise.
    ///
    /// `opening`: upper face minus lower face behind the tip, in the tip frame (x sliding d_II, y opening d_I) [m];
    /// only its direction counts. `j_integral` [J/m²]; `effective_modulus` E' [Pa]. J ≤ 0 or no opening at all: both
    /// zero. d_I < 0: K_I = 0, the crack is closed; K_II keeps its share, so that faces pressed into each other do not
    /// turn the energy of compression into shear.
    pub fn from_opening(j_integral: f64, opening: Vector, effective_modulus: f64) -> Self {
        let size = opening.norm();
        // Written so that a NaN, too, means "nothing known, no growth".
        if !(j_integral > 0.0 && size > 0.0) {
            return Self::default();
        }
        let amplitude = (effective_modulus * j_integral).sqrt();
        Self { mode_1: opening.y.max(0.0) / size * amplitude, mode_2: opening.x / size * amplitude }
    }

    /// Energy release rate of a resting tip, G = (K_I² + K_II²)/E' [J/m²] (Irwin).
    pub fn energy_release_rate(&self, effective_modulus: f64) -> f64 {
        (self.mode_1 * self.mode_1 + self.mode_2 * self.mode_2) / effective_modulus
    }

    /// Energy release rate of a tip that moves at `speed` [m/s], G = (A_I K_I² + A_II K_II²)/E' [J/m²].
    pub fn moving_energy_release_rate(&self, elastic: &Elastic, speed: f64) -> f64 {
        let [a_1, a_2] = crack_speed_factors(elastic, speed);
        // An infinite factor times a vanishing K is a limit of its own, not a number.
        let part = |a: f64, k: f64| if k == 0.0 { 0.0 } else { a * k * k };
        (part(a_1, self.mode_1) + part(a_2, self.mode_2)) / elastic.effective_modulus
    }

    /// Stress intensities of a tip that moves at `speed` [m/s] and releases J [J/m²], with the ratio of modes of
    /// `self`: K_II/K_I = ρ and K_I = √(E'J/(A_I + A_II ρ²)). Zero where nothing is released, and from c_R on.
    ///
    /// Integrals that hold a tip at rest against its fields say too much of one that moves.
    pub fn of_moving_tip(&self, j_integral: f64, elastic: &Elastic, speed: f64) -> Self {
        let released = self.moving_energy_release_rate(elastic, speed);
        // NaN is nothing known.
        if !(j_integral > 0.0 && released > 0.0) {
            return Self::default();
        }
        let factor = (j_integral / released).sqrt();
        Self { mode_1: factor * self.mode_1, mode_2: factor * self.mode_2 }
    }
}

/// A_I(v) and A_II(v) [–] of G = (A_I K_I² + A_II K_II²)/E' for a tip moving at `speed` v [m/s]; 1 at rest, infinite
/// from c_R on.
///
/// A_I = 4 v² α_d / ((κ+1) c_s² D), A_II with α_s for α_d; D = 4 α_d α_s - (1+α_s²)², α² = 1 - v²/c². Source: Freund
/// 1990.
pub fn crack_speed_factors(elastic: &Elastic, speed: f64) -> [f64; 2] {
    let squares = SpeedSquares::new(elastic, speed);
    let scaled = squares.rayleigh_function_over_shear();
    // NaN where α is no longer real.
    if scaled.is_nan() || scaled <= 0.0 {
        return [f64::INFINITY; 2];
    }
    let factor = 4.0 / ((elastic.kolosov + 1.0) * scaled);
    [factor * (1.0 - squares.dilatational).sqrt(), factor * (1.0 - squares.shear).sqrt()]
}

/// v²/c_d² and v²/c_s² of a moving tip.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SpeedSquares {
    pub(crate) dilatational: f64,
    pub(crate) shear: f64,
    /// (c_s/c_d)².
    ratio: f64,
}

impl SpeedSquares {
    pub(crate) fn new(elastic: &Elastic, speed: f64) -> Self {
        let ratio = elastic.mu / (elastic.lambda + 2.0 * elastic.mu);
        let shear = speed * speed * elastic.density / elastic.mu;
        Self { dilatational: ratio * shear, shear, ratio }
    }

    /// D c_s²/v² = [4 α_d α_s - (1+α_s²)²] c_s²/v², which has the limit 2(1 - c_s²/c_d²) at rest, without cancellation
    /// there.
    pub(crate) fn rayleigh_function_over_shear(&self) -> f64 {
        // 4(w - 1) + 4q - q² with w = α_d α_s, q = v²/c_s²; 1 - w² = s, so that w - 1 = -s/(1+w); then all of it over
        // q.
        let w = ((1.0 - self.dilatational) * (1.0 - self.shear)).sqrt();
        let s_over_q = self.ratio + 1.0 - self.dilatational;
        4.0 * (1.0 - s_over_q / (1.0 + w)) - self.shear
    }
}

/// Freund's universal function k(v) [–]: K_I(t, v) = k(v) K_I(t, 0) for a half-infinite crack; 1 at rest, 0 at and
/// above c_R.
///
/// k = (1 - v/c_R)/√(1 - v/c_d) · exp((1/π) ∫ ϑ(x)/(1/v - x) dx) over 1/c_d ≤ x ≤ 1/c_s, with
/// ϑ = atan[4x² √((x²-a²)(b²-x²)) / (b²-2x²)²], a = 1/c_d, b = 1/c_s. Source: Freund 1990.
pub fn universal_function(elastic: &Elastic, speed: f64) -> f64 {
    let rayleigh = elastic.rayleigh_wave_speed();
    if speed >= rayleigh {
        return 0.0;
    }
    let (a, b) = (1.0 / elastic.dilatational_wave_speed(), 1.0 / elastic.shear_wave_speed());
    // With x on a half circle over [a, b] the integrand becomes smooth and periodic, and the midpoint rule gains digits
    // in proportion to the number of points; the nearest singularity is 1/c_R. 64 points: below 1e-14 for 0 ≤ ν ≤ 0.49.
    const POINTS: usize = 64;
    let step = PI / POINTS as f64;
    let mut integral = 0.0;
    for i in 0..POINTS {
        let (sine, cosine) = ((i as f64 + 0.5) * step).sin_cos();
        let x = 0.5 * (a + b) - 0.5 * (b - a) * cosine;
        // (x-a)(b-x) = ((b-a)/2)² sin².
        let root = 0.5 * (b - a) * sine * ((x + a) * (b + x)).sqrt();
        let angle = (4.0 * x * x * root).atan2((b * b - 2.0 * x * x).powi(2));
        integral += angle * speed / (1.0 - speed * x) * 0.5 * (b - a) * sine * step;
    }
    (1.0 - speed / rayleigh) / (1.0 - speed * a).sqrt() * (integral / PI).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fissure_scene::{Material, PlaneState};

    fn elastic(poisson_ratio: f64, plane: PlaneState) -> Elastic {
        let material = Material {
            name: String::new(),
            young_modulus: 210e9,
            poisson_ratio,
            density: 8000.0,
            fracture_toughness: 1.0,
            limiting_speed: None,
            plasticity: None,
        };
        Elastic::new(&material, plane)
    }

    fn k(mode_1: f64, mode_2: f64) -> StressIntensity {
        StressIntensity { mode_1, mode_2 }
    }

    #[test]
    fn opening_splits_j() {
        let state = StressIntensity::from_opening(8.0, Vector::new(-3e-6, 4e-6), 2.0);
        assert!((state.mode_1 - 3.2).abs() < 1e-14 && (state.mode_2 + 2.4).abs() < 1e-14);
        assert!((state.energy_release_rate(2.0) - 8.0).abs() < 1e-14);
        let none = StressIntensity::default();
        for (j, d) in
            [(-76.0, [1.0, 1.0]), (0.0, [1.0, 1.0]), (8.0, [0.0, 0.0]), (f64::NAN, [1.0, 1.0]), (8.0, [0.0, -1.0])]
        {
            let split = StressIntensity::from_opening(j, Vector::new(d[0], d[1]), 2.0);
            assert_eq!(split, none, "J = {j}, d = {d:?}");
        }
        let closed = StressIntensity::from_opening(8.0, Vector::new(3.0, -4.0), 2.0);
        assert!(closed.mode_1 == 0.0 && (closed.mode_2 - 2.4).abs() < 1e-14);
    }

    /// Truth: an independent adaptive quadrature, printed to 6 digits: (ν, state, v/c_R, k, A_I).
    #[test]
    fn functions_of_speed_agree_with_the_table() {
        use PlaneState::{Strain, Stress};
        let table = [
            (0.2, Strain, 0.1, 0.940701, 1.00644),
            (0.2, Stress, 0.5, 0.657999, 1.20768),
            (0.3, Strain, 0.1, 0.940601, 1.00638),
            (0.3, Strain, 0.3, 0.810615, 1.06187),
            (0.3, Strain, 0.5, 0.659861, 1.20371),
            (0.3, Strain, 0.7, 0.474496, 1.56144),
            (0.3, Strain, 0.9, 0.213529, 3.26347),
            (0.3, Stress, 0.9, 0.210722, 3.31384),
            (0.35, Strain, 0.6, 0.570701, 1.33762),
            (0.35, Stress, 0.2, 0.878039, 1.02627),
        ];
        for (nu, plane, fraction, k, a_1) in table {
            let m = elastic(nu, plane);
            let v = fraction * m.rayleigh_wave_speed();
            let found = universal_function(&m, v);
            assert!((found - k).abs() < 5.1e-7, "k({fraction} c_R) = {found}, table {k}");
            assert!((crack_speed_factors(&m, v)[0] - a_1).abs() < 5.1e-6 * a_1.max(1.0));
        }
    }

    #[test]
    fn functions_of_speed_have_their_limits() {
        let m = elastic(0.3, PlaneState::Strain);
        let c_r = m.rayleigh_wave_speed();
        for factor in crack_speed_factors(&m, 0.0) {
            assert!((factor - 1.0).abs() < 1e-15);
        }
        // A - 1 is of the order of (v/c_s)², far below round-off here: no cancellation is left.
        for factor in crack_speed_factors(&m, 1e-5) {
            assert!((factor - 1.0).abs() < 1e-14);
        }
        assert_eq!(universal_function(&m, 0.0), 1.0);
        assert_eq!(universal_function(&m, c_r), 0.0);
        assert_eq!(crack_speed_factors(&m, 1.001 * c_r), [f64::INFINITY; 2]);
        assert_eq!(crack_speed_factors(&m, 2.0 * c_r), [f64::INFINITY; 2]);
        assert_eq!(k(0.0, 0.0).moving_energy_release_rate(&m, 2.0 * c_r), 0.0);
    }
}
