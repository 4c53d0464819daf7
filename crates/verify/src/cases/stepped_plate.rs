//! The plate of the step load, the moving crack and the crack-tip equation of motion.
//!
//! 10 × 4 m, edge crack of 5 m near mid height, plane strain, E = 210 GPa, ν = 0.3, ρ = 8000 kg/m³ (Freund 1990; the
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

/// The plate with the crack's tip moved along and across the crack by parts of a cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct SteppedPlate {
    /// h [m].
    pub(super) cell_size: f64,
    /// In cells.
    pub(super) offset: [f64; 2],
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

    /// Height of the crack [m].
    fn height(&self) -> f64 {
        2.0 + (self.offset[1] - 0.5) * self.cell_size
    }

    /// Place of the tip at the start [m].
    pub(super) fn tip(&self) -> (f64, f64) {
        (LENGTH + self.offset[0] * self.cell_size, self.height())
    }

    /// When the step reaches the crack, t_c [s].
    pub(super) fn arrival(&self) -> f64 {
        (4.0 - self.height()) / self.elastic().dilatational_wave_speed()
    }

    /// K_I of the resting crack at the time `t` [s], in Pa·√m: (2σ₀/(1−ν)) √(c_d (t−t_c)(1−2ν)/π).
    pub(super) fn mode_1(&self, t: f64) -> f64 {
        let loaded = (t - self.arrival()).max(0.0) * self.elastic().dilatational_wave_speed();
        2.0 * TRACTION / (1.0 - POISSON) * (loaded * (1.0 - 2.0 * POISSON) / PI).sqrt()
    }

    /// The scene until `end` arrival times.
    pub(super) fn problem(&self, end: f64) -> Problem {
        let (x, y) = self.tip();
        Problem::new(
            "stepped-plate",
            rectangle((0.0, 0.0), (10.0, 4.0)),
            self.material(),
            PlaneState::Strain,
            self.cell_size,
        )
        .crack(&[(0.0, y), (x, y)], [false, true])
        .traction(BoxSide::Top, 0.0, TRACTION)
        .support(Selection::Edge { side: BoxSide::Bottom, bodies: None }, [None, Some(0.0)])
        .until(end * self.arrival(), 30)
    }
}
