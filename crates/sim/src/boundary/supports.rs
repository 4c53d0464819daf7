//! Supports as prescribed velocities.

use fissure_scene::Support;

/// What a support prescribes along one axis at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Prescribed {
    pub(crate) axis: usize,
    /// Velocity at a curve factor of 1 [m/s].
    pub(crate) speed: f64,
    /// The curve factor now [–].
    pub(crate) factor: f64,
}

impl Prescribed {
    /// Velocity now [m/s].
    pub(crate) fn velocity(&self) -> f64 {
        self.speed * self.factor
    }
}

/// What `support` prescribes at `time` [s], for each axis that it holds.
pub(crate) fn prescribed(support: &Support, time: f64) -> impl Iterator<Item = Prescribed> + Clone {
    let factor = support.curve.value(time);
    let velocity = support.velocity;
    (0..2).filter_map(move |axis| Some(Prescribed { axis, speed: velocity[axis]?, factor }))
}
