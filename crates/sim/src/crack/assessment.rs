//! What is known of the load of a tip.

use serde::{Deserialize, Serialize};

/// What was measured at a tip last. Symbols and units as in [`TipRecord`](fissure_scene::TipRecord).
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Assessment {
    pub(crate) j_integral: f64,
    pub(crate) mode_1: f64,
    pub(crate) mode_2: f64,
    pub(crate) kink_angle: f64,
    pub(crate) equivalent: f64,
    /// What of J drives growth [J/m²].
    pub(crate) released: f64,
    pub(crate) fracture_toughness: f64,
    pub(crate) contour_radius: f64,
    pub(crate) radius_shrunk: bool,
}
