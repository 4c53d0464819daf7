//! The criterion of growth: the three questions that all of growth asks, each criterion answering them in a file of its
//! own.

mod hoop_stress;

use crate::StressIntensity;

/// In which direction a crack goes on, and under which load.
pub(super) trait Criterion {
    /// Direction of growth under `load`, from the tangent of the crack [rad], counter-clockwise; 0 without any load.
    ///
    /// `bending` scales what turns a crack: 0 straight on, 1 physical.
    fn kink_angle(&self, load: &StressIntensity, bending: f64) -> f64;

    /// What `load` amounts to in the direction `angle` [rad], as a stress intensity of mode I [Pa·√m], to be compared
    /// with K_Ic.
    fn equivalent(&self, load: &StressIntensity, angle: f64) -> f64;

    /// Part of the load in the best direction that is left at an angle [rad] from it.
    fn share_beside(&self, angle: f64) -> f64;
}

/// The criterion that growth goes by: here a scene would choose among several.
pub(super) fn criterion() -> &'static dyn Criterion {
    &hoop_stress::HoopStress
}
