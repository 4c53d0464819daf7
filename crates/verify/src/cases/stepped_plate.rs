//! The plate of the step load, the moving crack and the crack-tip equation of motion.
//!
//! 10 × 4 m, edge crack of 5 m at mid height, plane strain, E = 210 GPa, ν = 0.3, ρ = 8000 kg/m³ (Freund 1990; the
//! usual test of dynamic fracture codes). A tension σ₀ steps up at t = 0 on the top edge; the bottom edge slides on
//! rollers. Until the waves come back from the side edges, 2.64 t_c after the step, the crack is as good as alone in
//! the plane. σ₀ is 5 MPa: strains of 1e-4, because the reference is linear; all stress intensities are in proportion.

use crate::problem::{Problem, material, rectangle};
use fissure_scene::{BoxSide, Material, PlaneState, Selection};
use fissure_sim::Elastic;
use std::f64::consts::PI;

/// σ₀ [Pa].
pub(super) const TRACTION: f64 = 5e6;
const POISSON: f64 = 0.3;
/// Length of the crack [m].
pub(super) const LENGTH: f64 = 5.0;
/// Height of the crack [m].
pub(super) const HEIGHT: f64 = 2.0;

/// The plate.
#[derive(Debug, Clone, Copy)]
pub(super) struct SteppedPlate {
    /// h [m].
    pub(super) cell_size: f64,
    /// K_Ic [Pa·√m].
    pub(super) toughness: f64,
}

impl SteppedPlate {
    fn material(&self) -> Material {
        material(210e9, POISSON, 8000.0, self.toughness)
    }

    /// Constants of the plate.
    pub(super) fn elastic(&self) -> Elastic {
        Elastic::new(&self.material(), PlaneState::Strain)
    }

    /// When the step reaches the crack, t_c [s].
    pub(super) fn arrival(&self) -> f64 {
        HEIGHT / self.elastic().dilatational_wave_speed()
    }

    /// K_I of the resting crack at the time `t` [s], in Pa·√m: (2σ₀/(1−ν)) √(c_d (t−t_c)(1−2ν)/π).
    pub(super) fn mode_1(&self, t: f64) -> f64 {
        let loaded = (t - self.arrival()).max(0.0) * self.elastic().dilatational_wave_speed();
        2.0 * TRACTION / (1.0 - POISSON) * (loaded * (1.0 - 2.0 * POISSON) / PI).sqrt()
    }

    /// The scene until `end` arrival times.
    pub(super) fn problem(&self, end: f64) -> Problem {
        Problem::new(
            "stepped-plate",
            rectangle((0.0, 0.0), (10.0, 2.0 * HEIGHT)),
            self.material(),
            PlaneState::Strain,
            self.cell_size,
        )
        .crack(&[(0.0, HEIGHT), (LENGTH, HEIGHT)], [false, true])
        .traction(BoxSide::Top, 0.0, TRACTION)
        .support(Selection::Edge { side: BoxSide::Bottom, bodies: None }, [None, Some(0.0)])
        .until(end * self.arrival(), 30)
    }
}
