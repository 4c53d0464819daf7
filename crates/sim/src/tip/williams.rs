//! The fields around a crack tip, known in closed form: at rest (Williams) and moving steadily (Freund).

use crate::Elastic;
use crate::tip::stress_intensity::SpeedSquares;
use fissure_scene::{Matrix, Vector};
use nalgebra::Complex;
use std::f64::consts::PI;

/// The field of one mode at unit stress intensity (1 Pa·√m), in the tip frame (e1 = growth direction, e2 = e1 turned by
/// +90°).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TipField {
    /// Displacement U [m].
    pub displacement: Vector,
    /// Displacement gradient U_i,j [–].
    pub displacement_gradient: Matrix,
    /// Stress S_ij [Pa].
    pub stress: Matrix,
}

impl TipField {
    /// Velocity of the material [m/s] when the tip moves along e1 at `speed` [m/s]: -v U_,1.
    pub fn velocity(&self, speed: f64) -> Vector {
        -speed * self.displacement_gradient.column(0)
    }
}

/// Modes I and II of a resting tip at `place` [m] from the tip, in its frame.
///
/// `mu` μ [Pa], `kolosov` κ [–]. The faces lie at θ = ±π: a `place` with y = +0 and x < 0 is on the upper one, y = -0
/// on the lower. Singular as 1/√r; not finite at the tip itself. Source: Williams 1957, in the notation of Kolosov and
/// Muskhelishvili.
#[inline]
pub fn williams_fields(place: Vector, mu: f64, kolosov: f64) -> [TipField; 2] {
    let radius = place.norm();
    let (s, c) = half_angle(place, radius);
    let (s3, c3) = (s * (3.0 - 4.0 * s * s), c * (4.0 * c * c - 3.0));
    let size = 1.0 / (2.0 * PI * radius).sqrt();
    let reach = (radius / (2.0 * PI)).sqrt() / (2.0 * mu);

    let stress_1 = size * c * Matrix::new(1.0 - s * s3, s * c3, s * c3, 1.0 + s * s3);
    let shear_2 = c * (1.0 - s * s3);
    let stress_2 = size * Matrix::new(-s * (2.0 + c * c3), shear_2, shear_2, s * c * c3);
    // Rotation (u_2,1 - u_1,2)/2 = (κ+1)/(2μ) Im φ', φ' = K/(2√(2πz)) in mode I and -i times that in mode II.
    let turn = -size * (kolosov + 1.0) / (4.0 * mu);
    [
        TipField {
            displacement: reach * Vector::new(c * (kolosov - 1.0 + 2.0 * s * s), s * (kolosov + 1.0 - 2.0 * c * c)),
            displacement_gradient: gradient(&stress_1, turn * s, mu, kolosov),
            stress: stress_1,
        },
        TipField {
            displacement: reach * Vector::new(s * (kolosov + 1.0 + 2.0 * c * c), -c * (kolosov - 1.0 - 2.0 * s * s)),
            displacement_gradient: gradient(&stress_2, turn * c, mu, kolosov),
            stress: stress_2,
        },
    ]
}

/// Sine and cosine of half the angle from e1 to `place`, which is `radius` away [m]; that of a place with y = -0 and
/// x < 0 is -π/2.
///
/// cos²(θ/2) = (1 + cos θ)/2, sin²(θ/2) = (1 - cos θ)/2: the larger of the two has all its digits, and the other one is
/// sin θ/2 over it.
#[inline]
fn half_angle(place: Vector, radius: f64) -> (f64, f64) {
    let larger = (0.5 + 0.5 * (place.x.abs() / radius)).sqrt();
    let smaller = 0.5 * place.y.abs() / (radius * larger);
    let (s, c) = if place.x < 0.0 { (larger, smaller) } else { (smaller, larger) };
    (s.copysign(place.y), c)
}

/// Displacement gradient from stress (Hooke: 2μ ε = σ - (3-κ)/4 tr σ I) and rotation [rad].
fn gradient(stress: &Matrix, rotation: f64, mu: f64, kolosov: f64) -> Matrix {
    let strain = (stress - 0.25 * (3.0 - kolosov) * stress.trace() * Matrix::identity()) / (2.0 * mu);
    strain + Matrix::new(0.0, -rotation, rotation, 0.0)
}

/// Displacement and stress of an auxiliary field of one mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DualField {
    /// U.
    pub(crate) displacement: Vector,
    /// S.
    pub(crate) stress: Matrix,
}

/// The derivatives along e1 of Williams' fields of modes I and II at unit stress intensity, at `place` [m] from the
/// tip. `is_beyond`: the angle from e1 goes on beyond ±π, and the field is continued there.
///
/// With z = r e^(iθ), φ' = c/(2√(2πz)) of the fields, (c, s) = (1, 1) for mode I and (−i, −1) for mode II:
/// f = φ', g = ψ' = s f − z f'; 2μ (U_1 + i U_2) = κ f − z conj(f') − conj(g);
/// S_11 + S_22 = 4 Re f', S_22 − S_11 + 2i S_12 = 2 (conj(z) f'' + g'). Source: Muskhelishvili 1953.
pub(crate) fn dual_fields(place: Vector, is_beyond: bool, mu: f64, kolosov: f64) -> [DualField; 2] {
    let radius = place.norm();
    let z = Complex::new(place.x, place.y);
    // A whole turn changes the sign of √z.
    let size = (if is_beyond { -0.5 } else { 0.5 }) / (2.0 * PI * radius).sqrt();
    let (s, c) = half_angle(place, radius);
    let root = Complex::new(size * c, -size * s);
    [(Complex::new(1.0, 0.0), 1.0), (Complex::new(0.0, -1.0), -1.0)].map(|(c, s)| {
        let f = c * root;
        let f_1 = -f / (z * 2.0);
        let f_2 = -f_1 * 3.0 / (z * 2.0);
        let g = f * s - z * f_1;
        let g_1 = f_1 * (s - 1.0) - z * f_2;
        let u = (f * kolosov - z * f_1.conj() - g.conj()) / (2.0 * mu);
        let (sum, difference) = (4.0 * f_1.re, (z.conj() * f_2 + g_1) * 2.0);
        let (s_11, s_22) = (0.5 * (sum - difference.re), 0.5 * (sum + difference.re));
        let s_12 = 0.5 * difference.im;
        DualField { displacement: Vector::new(u.re, u.im), stress: Matrix::new(s_11, s_12, s_12, s_22) }
    })
}

/// Modes I and II of a tip that moves steadily along e1 at `speed` [m/s], at `place` [m] from the tip, in its frame.
///
/// With z_d = x + iα_d y, z_s = x + iα_s y, α² = 1 - v²/c², D = 4α_dα_s - (1+α_s²)², C = 2/(μ D √(2π)):
/// mode I: u = C [(1+α_s²) (Re, -α_d Im) √z_d - 2α_dα_s (Re, -Im/α_s) √z_s];
/// mode II: u = C α_s [2 (Im, α_d Re) √z_d - (1+α_s²) (Im, Re/α_s) √z_s].
/// Normalised so that s22 (mode I) and s12 (mode II) ahead of the tip are 1/√(2πr). Source: Freund 1990; derived anew
/// from the two wave equations and traction-free faces. Needs `speed` below c_R. Below a speed of 1e-4 c_s the resting
/// fields are returned: they differ by (v/c_s)² = 1e-8, as much as the round-off of the differences above.
pub fn moving_tip_fields(place: Vector, elastic: &Elastic, speed: f64) -> [TipField; 2] {
    let squares = SpeedSquares::new(elastic, speed);
    if squares.shear < 1e-8 {
        return williams_fields(place, elastic.mu, elastic.kolosov);
    }
    let (alpha_d, alpha_s) = ((1.0 - squares.dilatational).sqrt(), (1.0 - squares.shear).sqrt());
    let scale = 2.0 / (elastic.mu * squares.shear * squares.rayleigh_function_over_shear() * (2.0 * PI).sqrt());
    let (d, s) = (Root::new(place.x, alpha_d * place.y), Root::new(place.x, alpha_s * place.y));
    let shear_sum = 1.0 + alpha_s * alpha_s;

    let field = |displacement: Vector, by_x: Vector, by_y: Vector| {
        let displacement_gradient = Matrix::from_columns(&[by_x, by_y]);
        let strain = 0.5 * (displacement_gradient + displacement_gradient.transpose());
        let stress = 2.0 * elastic.mu * strain + elastic.lambda * strain.trace() * Matrix::identity();
        TipField { displacement, displacement_gradient, stress }
    };
    // ∂/∂x √z = z^-½/2, ∂/∂y √z = iα z^-½/2; "Re" of i w is -Im w, "Im" of i w is Re w.
    let mode_1 = {
        let (p, q) = (scale * shear_sum, -2.0 * scale * alpha_d * alpha_s);
        field(
            Vector::new(p * d.re + q * s.re, -p * alpha_d * d.im - q / alpha_s * s.im),
            Vector::new(p * d.slope_re + q * s.slope_re, -p * alpha_d * d.slope_im - q / alpha_s * s.slope_im),
            Vector::new(
                -p * alpha_d * d.slope_im - q * alpha_s * s.slope_im,
                -p * alpha_d * alpha_d * d.slope_re - q * s.slope_re,
            ),
        )
    };
    let mode_2 = {
        let (p, q) = (2.0 * scale * alpha_s, -scale * alpha_s * shear_sum);
        field(
            Vector::new(p * d.im + q * s.im, p * alpha_d * d.re + q / alpha_s * s.re),
            Vector::new(p * d.slope_im + q * s.slope_im, p * alpha_d * d.slope_re + q / alpha_s * s.slope_re),
            Vector::new(
                p * alpha_d * d.slope_re + q * alpha_s * s.slope_re,
                -p * alpha_d * alpha_d * d.slope_im - q * s.slope_im,
            ),
        )
    };
    [mode_1, mode_2]
}

/// √z and its derivative z^-½/2, cut along the negative real axis.
struct Root {
    re: f64,
    im: f64,
    slope_re: f64,
    slope_im: f64,
}

impl Root {
    fn new(x: f64, y: f64) -> Self {
        let radius = x.hypot(y);
        let (sine, cosine) = (0.5 * y.atan2(x)).sin_cos();
        let root = radius.sqrt();
        let slope = 0.5 / root;
        Self { re: root * cosine, im: root * sine, slope_re: slope * cosine, slope_im: -slope * sine }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crack_speed_factors;
    use fissure_scene::{Material, PlaneState};

    fn elastic(poisson_ratio: f64, plane: PlaneState) -> Elastic {
        let material = Material {
            name: String::new(),
            young_modulus: 2.5,
            poisson_ratio,
            density: 1.2,
            fracture_toughness: 1.0,
            limiting_speed: None,
            plasticity: None,
        };
        Elastic::new(&material, plane)
    }

    type Fields = Box<dyn Fn(Vector) -> [TipField; 2]>;

    /// (speed, material, fields): both plane states, at rest and moving.
    fn cases() -> Vec<(f64, Elastic, Fields)> {
        let mut cases: Vec<(f64, Elastic, Fields)> = Vec::new();
        for plane in [PlaneState::Strain, PlaneState::Stress] {
            let m = elastic(0.3, plane);
            cases.push((0.0, m, Box::new(move |x| williams_fields(x, m.mu, m.kolosov))));
            for fraction in [0.2, 0.5, 0.9] {
                let v = fraction * m.rayleigh_wave_speed();
                cases.push((v, m, Box::new(move |x| moving_tip_fields(x, &m, v))));
            }
        }
        cases
    }

    fn places() -> impl Iterator<Item = Vector> {
        (0..23).map(|i| {
            let angle = -3.1 + 6.2 * f64::from(i) / 22.0;
            (0.5 + 0.07 * f64::from(i)) * Vector::new(angle.cos(), angle.sin())
        })
    }

    /// Central differences at r ≥ 0.5 with step 1e-5: error step²·|u'''|/6 + round-off/step; the round-off of a slow
    /// tip is (c_s/v)² ε, 30 ε at .2 c_R, which makes 1e-9 of the fields (of order 1) in all.
    const STEP: f64 = 1e-5;

    fn central<T: std::ops::Sub<Output = T> + std::ops::Div<f64, Output = T>>(
        f: impl Fn(Vector) -> T,
        x: Vector,
        axis: usize,
    ) -> T {
        let mut step = Vector::zeros();
        step[axis] = STEP;
        (f(x + step) - f(x - step)) / (2.0 * STEP)
    }

    #[test]
    fn gradient_is_that_of_the_displacement() {
        for (speed, _, fields) in cases() {
            for x in places() {
                for mode in 0..2 {
                    let size = fields(x)[mode].displacement_gradient.norm();
                    for axis in 0..2 {
                        let slope = central(|y| fields(y)[mode].displacement, x, axis);
                        let error = (slope - fields(x)[mode].displacement_gradient.column(axis)).norm();
                        assert!(error < 1e-8 * (1.0 + size), "v = {speed}, mode {mode}, axis {axis} at {x}: {error}");
                    }
                }
            }
        }
    }

    #[test]
    fn stress_obeys_hookes_law_and_the_equation_of_motion() {
        for (speed, m, fields) in cases() {
            for x in places() {
                for mode in 0..2 {
                    let field = fields(x)[mode];
                    let h = field.displacement_gradient;
                    let hooke = m.mu * (h + h.transpose()) + m.lambda * h.trace() * Matrix::identity();
                    assert!((hooke - field.stress).norm() < 1e-12 * (1.0 + field.stress.norm()));
                    // div σ = ρ v² u,11 in the frame of the tip.
                    let divergence = central(|y| fields(y)[mode].stress, x, 0).column(0)
                        + central(|y| fields(y)[mode].stress, x, 1).column(1);
                    let inertia =
                        m.density * speed * speed * central(|y| fields(y)[mode].displacement_gradient, x, 0).column(0);
                    let error = (divergence - inertia).norm();
                    assert!(error < 1e-8 * (1.0 + field.stress.norm()), "v = {speed}, mode {mode} at {x}: {error}");
                }
            }
        }
    }

    #[test]
    fn faces_are_free_and_stress_ahead_is_normalised() {
        for (speed, _, fields) in cases() {
            for r in [1e-3, 0.7] {
                let size = 1.0 / (2.0 * PI * r).sqrt();
                let tolerance = 1e-10 * size;
                for face in [0.0, -0.0] {
                    for field in fields(Vector::new(-r, face)) {
                        assert!(field.stress.column(1).norm() < tolerance, "v = {speed}: {}", field.stress);
                    }
                }
                let [one, two] = fields(Vector::new(r, 0.0));
                assert!((one.stress.m22 - size).abs() < tolerance && one.stress.m12.abs() < tolerance);
                assert!((two.stress.m12 - size).abs() < tolerance && two.stress.m22.abs() < tolerance);
                // Mode I opens; positive mode II moves the upper face forwards.
                let jump: Vec<Vector> = fields(Vector::new(-r, 0.0))
                    .iter()
                    .zip(fields(Vector::new(-r, -0.0)))
                    .map(|(upper, lower)| upper.displacement - lower.displacement)
                    .collect();
                assert!(jump[0].y > 0.0 && jump[0].x.abs() < 1e-10 && jump[1].x > 0.0 && jump[1].y.abs() < 1e-10);
            }
        }
    }

    /// Truth: the difference quotient, and a turn by 2π, after which a field with √z has changed its sign.
    #[test]
    fn dual_fields_are_the_slopes_of_williams_fields() {
        let m = elastic(0.3, PlaneState::Strain);
        let fields = |x: Vector| williams_fields(x, m.mu, m.kolosov);
        for x in places() {
            for is_beyond in [false, true] {
                let sign = if is_beyond { -1.0 } else { 1.0 };
                let found = dual_fields(x, is_beyond, m.mu, m.kolosov);
                for mode in 0..2 {
                    let by_x = fields(x)[mode].displacement_gradient.column(0) * sign;
                    assert!((found[mode].displacement - by_x).norm() < 1e-12, "{x} {mode}");
                    let stress = central(|y| fields(y)[mode].stress, x, 0) * sign;
                    assert!((found[mode].stress - stress).norm() < 1e-8 * (1.0 + stress.norm()), "{x} {mode}");
                }
            }
        }
    }

    /// Truth: the sine and cosine of half the angle, on both faces and so near to them that one of the two is next to
    /// nothing too.
    #[test]
    fn half_an_angle_has_all_its_digits() {
        let near = [0.0, -0.0, 1e-200, -1e-200, 1e-20, -1e-20, 1e-9, -1e-9, 1e-3, -1e-3].map(|y| (-1.0, y));
        let around = (0..1000).map(|k| (0.0063 * f64::from(k)).sin_cos());
        for (x, y) in near.into_iter().chain(near.map(|(x, y)| (-x, y))).chain(around) {
            for size in [1e-9, 1.0, 3e4] {
                let place = Vector::new(x * size, y * size);
                let (s, c) = half_angle(place, place.norm());
                let (sine, cosine) = (0.5 * y.atan2(x)).sin_cos();
                assert!((s - sine).abs() <= 4e-16 && (c - cosine).abs() <= 4e-16, "{x} {y}: {s} {c}");
                assert_eq!(s.is_sign_negative(), y.is_sign_negative(), "{x} {y}");
                // What the angle itself is rounded to is all of what is left of a cosine next to nothing.
                let least = if x < 0.0 { 0.5 * (y / x).abs() } else { cosine };
                assert!(y.abs() > 1e-8 || (c - least).abs() <= 1e-15 * least, "{x} {y}: {c}");
            }
        }
    }

    #[test]
    fn slow_tip_is_a_resting_one() {
        let m = elastic(0.3, PlaneState::Strain);
        let x = Vector::new(-0.4, 0.3);
        let resting = williams_fields(x, m.mu, m.kolosov);
        for fraction in [0.5e-4, 2e-4, 1e-3, 1e-2] {
            let moving = moving_tip_fields(x, &m, fraction * m.shear_wave_speed());
            for mode in 0..2 {
                // The difference is (v/c_s)² times a number of order 1, plus the round-off of 2e-16 over (v/c_s)².
                let allowed = 4.0 * fraction * fraction + 1e-15 / (fraction * fraction).max(1e-8);
                assert!((moving[mode].stress - resting[mode].stress).norm() < allowed);
                assert!((moving[mode].displacement_gradient - resting[mode].displacement_gradient).norm() < allowed);
            }
        }
    }

    /// Truth: Freund's closed form A(v). The flux through a circle is a smooth periodic integrand: the midpoint rule
    /// converges quickly.
    #[test]
    fn energy_flux_into_the_tip_gives_the_speed_factors() {
        for (speed, m, fields) in cases() {
            let expected = crack_speed_factors(&m, speed);
            for mode in 0..2 {
                for radius in [0.01, 2.0] {
                    const POINTS: usize = 400;
                    let mut flux = 0.0;
                    for i in 0..POINTS {
                        let angle = -PI + (i as f64 + 0.5) * 2.0 * PI / POINTS as f64;
                        let normal = Vector::new(angle.cos(), angle.sin());
                        let field = fields(radius * normal)[mode];
                        let along = field.displacement_gradient.column(0);
                        let strain = 0.5 * field.stress.dot(&field.displacement_gradient);
                        let kinetic = 0.5 * m.density * field.velocity(speed).norm_squared();
                        flux +=
                            ((strain + kinetic) * normal.x - (field.stress * normal).dot(&along)) * radius * 2.0 * PI
                                / POINTS as f64;
                    }
                    let factor = flux * m.effective_modulus;
                    assert!(
                        (factor - expected[mode]).abs() < 1e-9 * expected[mode],
                        "v = {speed}, mode {mode}: {factor} {expected:?}"
                    );
                }
            }
        }
    }
}
