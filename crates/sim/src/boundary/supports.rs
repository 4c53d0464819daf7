//! Supports as prescribed velocities.

use crate::saved::{self, Fits};
use fissure_scene::Support;
use serde::{Deserialize, Serialize};

/// What a support prescribes along one axis over a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Prescribed {
    pub(crate) axis: usize,
    /// Velocity at a curve factor of 1 [m/s].
    pub(crate) speed: f64,
    /// The mean of the curve factor [–].
    pub(crate) factor: f64,
}

impl Prescribed {
    /// Mean velocity of the step [m/s].
    pub(crate) fn velocity(&self) -> f64 {
        self.speed * self.factor
    }
}

/// What `support` prescribes over a step of `time_step` around the time `middle` [s], for each axis that it holds: the
/// mean velocity, so that the way is right whatever the length of the steps.
pub(crate) fn prescribed(support: &Support, middle: f64, time_step: f64) -> impl Iterator<Item = Prescribed> + Clone {
    let factor = support.curve.mean(middle - 0.5 * time_step, middle + 0.5 * time_step);
    let velocity = support.velocity;
    (0..2).filter_map(move |axis| Some(Prescribed { axis, speed: velocity[axis]?, factor }))
}

/// The first time [s] at which two supports prescribe different velocities along `axis`.
pub(crate) fn contradiction(a: &Support, b: &Support, axis: usize) -> Option<f64> {
    let (u, v) = (a.velocity[axis]?, b.velocity[axis]?);
    // Both velocities are linear between these times, and constant outside.
    let mut times = std::iter::once(0.0).chain(a.curve.points.iter().chain(&b.curve.points).map(|p| p.0));
    let differ = |t: &f64| {
        let (u, v) = (u * a.curve.value(*t), v * b.curve.value(*t));
        (u - v).abs() > 1e-9 * u.abs().max(v.abs())
    };
    times.find(|t| *t >= 0.0 && differ(t))
}

/// What a support has done to the material so far, per unit thickness.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Reaction {
    /// Force times time along x and y [N s/m].
    pub(crate) impulse: [f64; 2],
    /// Work [J/m].
    pub(crate) work: f64,
}

impl Reaction {
    /// Checks what was read: one for each of so many `supports`.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(crate) fn check(reactions: &[Self], supports: usize) -> Fits {
        saved::ensure(reactions.len() == supports, "its number of supports")?;
        saved::finite("a reaction", reactions.iter().flat_map(|r| r.impulse.iter().chain([&r.work])))
    }
}
