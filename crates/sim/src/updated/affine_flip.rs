//! Affine FLIP: particles take up what the grid's velocities change by (Fei et al. 2021, "Revisiting integration in the
//! material point method", there with the velocity alone; here with its gradient as well).
//!
//! A particle carries q = (v_p, C_p). With G(v) for what it gathers from the velocities v of nodes,
//!
//!   q' = k q + G(v⁺ − k v⁻),
//!
//! v⁻ at the beginning of the step and v⁺ at its end. k = 0 is APIC, which filters all of the velocity in every step,
//! so that short waves fade, the faster the shorter the steps; with k = 1 nothing is filtered but what changes, and
//! what of q the grid does not see stays for ever, as in FLIP. Sums over particles of momentum are those of the grid
//! for every k; so is the sum of angular momentum until particles move, which they do with the grid's velocity.

use super::setup::Setup;
use crate::material::elastic::Elastic;

/// Cells that the fastest wave runs while what the grid does not see fades to 1/e.
///
/// Measured (`fissure verify transfers`, quadratic kernel): a standing wave of 10 cells loses 6.0 % of its energy per
/// period by APIC (k = 0), 3.2 % with 2 cells, 2.0 % with 10, 1.3 % with k = 1; with steps of a third 12.6, 2.8, 1.2
/// and .4 %. A square that spins loses .014 % of its angular momentum in a quarter turn with 2 cells, .08 % with 10,
/// 3.1 % with k = 1. With 10 cells a plate with a crack that is brought to rest goes on trembling beside the tip at
/// some places of it, where fields are light, and never rests; with 2 it does.
const FADING: f64 = 2.0;

/// k, what a particle keeps of its own velocity in a step of `time_step` [s] [–]: the same in a given time for any
/// length of the steps.
pub(super) fn kept(setup: &Setup, time_step: f64) -> f64 {
    let speed = setup.elastic.iter().map(Elastic::dilatational_wave_speed).fold(0.0, f64::max);
    (-speed * time_step / (FADING * setup.scene.cell_size)).exp()
}
