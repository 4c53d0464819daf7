//! What the colour of material stands for.

use fissure_scene::ParticleFrame;

/// What the colour of material stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Coloring {
    /// The fragment it belongs to.
    #[default]
    Fragment,
    /// The largest principal Cauchy stress in the plane [Pa], tension positive.
    Stress,
    /// The speed [m/s].
    Speed,
}

impl Coloring {
    /// What is measured, and its unit; none for fragments.
    pub(crate) fn quantity(self) -> Option<(&'static str, &'static str)> {
        match self {
            Self::Fragment => None,
            Self::Stress => Some(("largest principal stress", "Pa")),
            Self::Speed => Some(("speed", "m/s")),
        }
    }

    /// The value of each particle, in their order; none for fragments.
    pub(crate) fn values(self, particles: &ParticleFrame) -> Option<Vec<f64>> {
        match self {
            Self::Fragment => None,
            Self::Stress => Some(particles.cauchy_stress.iter().map(largest_principal).collect()),
            Self::Speed => Some(particles.velocity.iter().map(|velocity| velocity.norm()).collect()),
        }
    }

    /// The ends of the scale whose largest value is `most`.
    pub(crate) fn scale(self, most: f64) -> [f64; 2] {
        if self == Self::Stress { [-most, most] } else { [0.0, most] }
    }

    /// The colour at `part` of the scale, from 0 to 1; beyond its ends that of the end.
    pub(crate) fn color(self, part: f64) -> [u8; 3] {
        let part = if part.is_finite() { part.clamp(0.0, 1.0) } else { 0.0 };
        let color = match self {
            // From blue, pressed, through white to red, pulled.
            Self::Stress => colorous::RED_BLUE.eval_continuous(1.0 - part),
            Self::Fragment | Self::Speed => colorous::VIRIDIS.eval_continuous(part),
        };
        color.into_array()
    }
}

/// The larger eigenvalue of a symmetric matrix.
fn largest_principal(stress: &fissure_plane::Matrix) -> f64 {
    let middle = 0.5 * (stress.m11 + stress.m22);
    let shear = 0.5 * (stress.m12 + stress.m21);
    middle + (0.5 * (stress.m11 - stress.m22)).hypot(shear)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fissure_plane::Matrix;

    /// Truth: the eigenvalues of the matrix as `nalgebra` finds them.
    #[test]
    fn the_largest_principal_stress_is_the_larger_eigenvalue() {
        for [a, b, c] in [[1.0, 0.5, -2.0], [0.0, 3.0, 0.0], [-4.0, 0.0, -1.0], [2.0, 0.0, 2.0]] {
            let stress = Matrix::new(a, b, b, c);
            assert!((largest_principal(&stress) - stress.symmetric_eigenvalues().max()).abs() < 1e-12);
        }
    }
}
