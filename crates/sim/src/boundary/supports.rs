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
