//! The plastic part of particles, for materials that have one.

use fissure_scene::{Matrix, Plasticity};
use serde::{Deserialize, Serialize};

/// What a particle of a plastic material carries besides its elastic part.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct PlasticPart {
    /// F_P [–].
    pub(super) gradient: Matrix,
    /// Factor exp(ξ(1 − det F_P)) on the elastic constants [–].
    pub(super) hardening: f64,
}

impl PlasticPart {
    /// Nothing has flowed.
    pub(super) const NONE: Self = Self { gradient: Matrix::new(1.0, 0.0, 0.0, 1.0), hardening: 1.0 };

    /// Moves the part of the trial F_E that is beyond the limits into F_P; gives the new F_E − I (thesis eq. 14–17,
    /// erratum corrected).
    pub(super) fn flow(&mut self, elastic_trial: Matrix, plasticity: &Plasticity) -> Matrix {
        let Some(step) = crate::plastic_step(&elastic_trial, &self.gradient, plasticity) else { return elastic_trial };
        self.gradient = step.plastic;
        self.hardening = crate::hardening_factor(plasticity, step.plastic.determinant());
        step.elastic
    }
}
