//! The J-integral over a circle around a crack tip.

use fissure_scene::{Matrix, Point, Vector};
use std::f64::consts::{PI, TAU};

/// Number of segments of the circle.
pub(crate) const SEGMENTS: usize = 16;

/// Which face of the crack a part of the circle belongs to; "above" is to the left when looking in the growth
/// direction. At the start of a crack, which grows against the crack's own direction, this is the opposite of the
/// crack's own above.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ContourHalf {
    /// From the lower face to ahead of the tip: fields are those of the material below the crack.
    Below,
    /// From ahead of the tip to the upper face: fields are those of the material above the crack.
    Above,
}

/// The state of the material at a point of the contour, world frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ContourSample {
    /// Strain energy density W [J/m³].
    pub(crate) strain_energy_density: f64,
    /// Kinetic energy density ρ v·v/2 [J/m³].
    pub(crate) kinetic_energy_density: f64,
    /// Cauchy stress σ [Pa].
    pub(crate) cauchy_stress: Matrix,
    /// Displacement gradient ∂u_i/∂x_k [–].
    pub(crate) displacement_gradient: Matrix,
}

/// A circle around a crack tip, from the lower face counter-clockwise to the upper one.
///
/// ```text
///          . - ~ - .
///   upper /   above  \
///   ======*--- tip    |  growth direction →
///   lower \   below  /
///          ' - . - '
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Contour {
    center: Point,
    radius: f64,
    /// Direction of the point on the lower face, from the x axis [rad].
    start: f64,
    /// Angle run through, counter-clockwise [rad].
    sweep: f64,
}

impl Contour {
    /// The circle around `tip` between the points where it meets the lower and the upper face [m]; only their
    /// directions from the tip count.
    ///
    /// A closed crack, whose points coincide, gives the full circle, faces that overlap a little more than that. The
    /// opening may be up to a half turn.
    pub(crate) fn new(tip: Point, radius: f64, lower: Point, upper: Point) -> Self {
        let angle = |p: Point| (p.y - tip.y).atan2(p.x - tip.x);
        let start = angle(lower);
        // The two points lie close to each other, on either side of the crack: their difference is the short way round.
        let mut opening = start - angle(upper);
        if opening > PI {
            opening -= TAU;
        } else if opening <= -PI {
            opening += TAU;
        }
        Self { center: tip, radius, start, sweep: TAU - opening }
    }

    /// The J-integral [J/m²] as a vector in the world frame; its component along the growth direction is J.
    ///
    /// J_k = ∫ [(W + K) n_k - σ_ij n_j ∂u_i/∂x_k] ds, by the midpoint rule on true arcs: exact on the K field around a
    /// closed crack. Source: Guo & Nairn 2004 by way of the thesis' eq. 28, with the kinetic energy of the velocity. No
    /// area term: for dynamics see the domain form.
    ///
    /// `sample` gives the state at a point, from the material of one half.
    /// # Errors
    /// Whatever `sample` returns, at the first point it fails at.
    pub(crate) fn j_integral<E>(
        &self,
        mut sample: impl FnMut(Point, ContourHalf) -> Result<ContourSample, E>,
    ) -> Result<Vector, E> {
        let step = self.sweep / SEGMENTS as f64;
        let mut sum = Vector::zeros();
        for segment in 0..SEGMENTS {
            let (sine, cosine) = (self.start + (segment as f64 + 0.5) * step).sin_cos();
            let normal = Vector::new(cosine, sine);
            let half = if segment < SEGMENTS / 2 { ContourHalf::Below } else { ContourHalf::Above };
            let state = sample(self.center + self.radius * normal, half)?;
            let energy = state.strain_energy_density + state.kinetic_energy_density;
            sum += energy * normal - state.displacement_gradient.transpose() * (state.cauchy_stress * normal);
        }
        Ok(sum * (self.radius * step))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::williams_fields;
    use std::convert::Infallible;

    const MU: f64 = 1.25;
    const KOLOSOV: f64 = 1.8;

    /// The K field of a tip at `tip` growing along `angle`, in the world frame. The half decides the side of the cut.
    fn k_field(tip: Point, angle: f64, k: [f64; 2], at: Point, half: ContourHalf) -> ContourSample {
        let turn = Matrix::new(angle.cos(), -angle.sin(), angle.sin(), angle.cos());
        let place = turn.transpose() * (at - tip);
        // Only a point on the crack itself could be taken for the wrong side.
        assert!(place.x > 0.0 || (place.y > 0.0) == (half == ContourHalf::Above));
        let fields = williams_fields(place, MU, KOLOSOV);
        let stress = turn * (k[0] * fields[0].stress + k[1] * fields[1].stress) * turn.transpose();
        let gradient =
            turn * (k[0] * fields[0].displacement_gradient + k[1] * fields[1].displacement_gradient) * turn.transpose();
        ContourSample {
            strain_energy_density: 0.5 * stress.dot(&gradient),
            kinetic_energy_density: 0.0,
            cauchy_stress: stress,
            displacement_gradient: gradient,
        }
    }

    /// Truth: J_1 = (K_I²+K_II²)/E', J_2 = -2 K_I K_II/E'. The integrand is a trigonometric polynomial of degree 6, so
    /// 16 midpoints are exact.
    #[test]
    fn k_field_gives_irwins_j_on_any_circle() {
        let effective_modulus = 8.0 * MU / (KOLOSOV + 1.0);
        let tip = Point::new(-3.0, 7.0);
        for angle in [0.0, 0.8, 2.9, PI, -1.7] {
            let (e1, e2) = (Vector::new(angle.cos(), angle.sin()), Vector::new(-angle.sin(), angle.cos()));
            for k in [[1.0, 0.0], [0.0, 1.0], [2.0, -0.7]] {
                for radius in [0.05, 1.0, 4.0] {
                    let mouth = tip - radius * e1;
                    let j = Contour::new(tip, radius, mouth, mouth)
                        .j_integral(|at, half| Ok::<_, Infallible>(k_field(tip, angle, k, at, half)))
                        .unwrap();
                    let size = (k[0] * k[0] + k[1] * k[1]) / effective_modulus;
                    assert!(
                        (j.dot(&e1) - size).abs() < 1e-13 * size / radius.min(1.0),
                        "{angle} {k:?} {radius}: {}",
                        j.dot(&e1)
                    );
                    assert!(
                        (j.dot(&e2) + 2.0 * k[0] * k[1] / effective_modulus).abs() < 1e-13 * size / radius.min(1.0)
                    );
                }
            }
        }
    }

    /// Constant W and no stress leaves ∫ W n ds: the chord from the lower to the upper face, turned by -90 degrees. The
    /// midpoint rule on arcs of angle s gives it but for the factor (s/2)/sin(s/2).
    #[test]
    fn open_and_overlapping_faces_change_the_sweep() {
        let tip = Point::new(1.0, 2.0);
        let radius = 0.5;
        let at = |angle: f64| tip + radius * Vector::new(angle.cos(), angle.sin());
        let constant = |_, _| {
            Ok::<_, Infallible>(ContourSample {
                strain_energy_density: 3.0,
                kinetic_energy_density: 4.0,
                cauchy_stress: Matrix::zeros(),
                displacement_gradient: Matrix::identity(),
            })
        };
        // Growth along 0 puts the jump of atan2 between the faces, to be crossed in either sense; along -2 it lies on
        // the circle.
        for (growth, gap) in [(0.0, 0.3), (0.0, -0.1), (-2.0, 0.3), (-2.0, 0.0), (-2.0, -0.1), (0.0, 2.0)] {
            let (upper, lower) = (at(growth + PI - 0.5 * gap), at(growth - PI + 0.5 * gap));
            let contour = Contour::new(tip, radius, lower, upper);
            let segment = (TAU - gap) / SEGMENTS as f64;
            let chord = upper - lower;
            let expected = 7.0 * Vector::new(chord.y, -chord.x) * (0.5 * segment) / (0.5 * segment).sin();
            assert!((contour.j_integral(constant).unwrap() - expected).norm() < 1e-13, "growth {growth}, gap {gap}");
        }
    }

    #[test]
    fn first_half_is_below_and_errors_pass() {
        let tip = Point::origin();
        let mouth = Point::new(-1.0, 0.0);
        let mut seen = Vec::new();
        let failed = Contour::new(tip, 1.0, mouth, mouth).j_integral(|at, half| {
            seen.push((at.y < 0.0, half));
            if seen.len() < 9 {
                Ok(ContourSample {
                    strain_energy_density: 0.0,
                    kinetic_energy_density: 0.0,
                    cauchy_stress: Matrix::zeros(),
                    displacement_gradient: Matrix::zeros(),
                })
            } else {
                Err("outside")
            }
        });
        assert_eq!(failed, Err("outside"));
        // The full circle starts at either direction of the mouth: atan2 of y = 0 gives +π, half a turn on.
        assert_eq!(seen.iter().filter(|(below, half)| *below == (*half == ContourHalf::Below)).count(), 9);
    }
}
