//! How many of each thing a scene may have. Beyond these numbers a count is a slip of the pen, or an attack on the
//! machine's memory.

use crate::fault::{Check, KeyPath, SceneFault, short};

/// A bound of a number of things.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Count {
    most: u64,
    /// What is counted, in words.
    what: &'static str,
    remedy: &'static str,
}

/// Items of one array of the scene, such as `[[load]]`. Cracks are compared with each other, bodies too.
pub(crate) const ITEMS: Count =
    Count { most: 10_000, what: "items", remedy: "split the scene into several, or make several of them one" };
/// Corners of all rings of one region.
pub(crate) const CORNERS: Count = Count {
    most: 100_000,
    what: "corners",
    remedy: "draw it with fewer: what is finer than the particle spacing is not seen",
};
/// Points of one line.
pub(crate) const POINTS: Count = Count {
    most: 100_000,
    what: "points",
    remedy: "draw it with fewer: what is finer than the particle spacing is not seen",
};
/// Points of one curve, keyframes of one collider.
pub(crate) const KEYFRAMES: Count =
    Count { most: 100_000, what: "keyframes", remedy: "keep fewer of them: values between are interpolated" };
/// Frames of a scene.
pub(crate) const FRAMES: Count =
    Count { most: 1_000_000, what: "frames", remedy: "ask for fewer frames, or for a lower `frames.rate`" };
/// Particles of a scene.
pub(crate) const PARTICLES: Count =
    Count { most: 1_000_000_000, what: "particles", remedy: "make `grid.particle_spacing` larger" };
/// Particles that all frames hold together; each takes some 170 bytes on disk.
pub(crate) const PARTICLE_FRAMES: Count = Count {
    most: 100_000_000_000,
    what: "particles in all frames together",
    remedy: "ask for fewer frames, or make `grid.particle_spacing` larger",
};

impl Count {
    /// Checks a number of things. `whose`: what has them, in words.
    ///
    /// # Errors
    /// The number and its bound, at `path`.
    pub(crate) fn check(self, path: &KeyPath, whose: &str, count: usize) -> Check {
        self.check_real(path, whose, count as f64)
    }

    /// Checks a number of things that is known as an estimate, which may be too large for an integer.
    ///
    /// # Errors
    /// As [`Count::check`].
    pub(crate) fn check_real(self, path: &KeyPath, whose: &str, count: f64) -> Check {
        // NaN is too many.
        if count <= self.most as f64 {
            return Ok(());
        }
        let count = super::number(short(count.round()));
        let message = format!("{whose} has {count} {}, at most {} are possible", self.what, self.most);
        Err(SceneFault::new(path.clone(), message, self.remedy))
    }
}
