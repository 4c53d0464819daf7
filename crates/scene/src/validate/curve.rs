//! Values over time, in seconds or in frames.

use crate::curve::Curve;
use crate::fault::Check;
use crate::fault::{KeyPath, SceneFault, short};
use crate::range::{CURVE_FACTOR, FRAME, KEYFRAMES, Range, SPEED_FACTOR, TIME, UNIT};

/// What the first numbers of a curve count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Clock {
    /// Seconds.
    Seconds,
    /// Frames, as a scene file has them.
    #[cfg_attr(not(feature = "load"), allow(dead_code, reason = "a scene has seconds"))]
    Frames,
}

impl Clock {
    fn word(self) -> &'static str {
        match self {
            Self::Seconds => "time",
            Self::Frames => "frame",
        }
    }

    fn unit(self) -> &'static str {
        match self {
            Self::Seconds => " s",
            Self::Frames => "",
        }
    }

    /// What the numbers may be.
    fn range(self) -> Range {
        match self {
            Self::Seconds => TIME,
            Self::Frames => FRAME,
        }
    }

    /// That the numbers are in range and rise. `what`: the points of what, in words.
    fn check(self, path: &KeyPath, what: &str, points: &[(f64, f64)]) -> Check {
        KEYFRAMES.check(path, "this", points.len())?;
        for (i, &(at, _)) in points.iter().enumerate() {
            self.range().check(path.then(i), &format!("the {} of one of {what}", self.word()), at)?;
            if i > 0 && points[i - 1].0 >= at {
                return Err(self.not_rising(path.then(i), what, points[i - 1].0, at));
            }
        }
        Ok(())
    }

    pub(super) fn not_rising(self, path: KeyPath, what: &str, before: f64, after: f64) -> SceneFault {
        let (word, unit) = (self.word(), self.unit());
        SceneFault::new(
            path,
            format!("the {word}s of {what} do not rise: {after}{unit} comes after {before}{unit}"),
            format!("sort them by {word}, each {word} once"),
        )
    }
}

/// The factor of a load or support over time.
pub(crate) fn validate_curve(path: &KeyPath, curve: &Curve) -> Check {
    let path = path.then("curve");
    Clock::Seconds.check(&path, "the points of the curve", &curve.points)?;
    let factor =
        |(i, &(_, factor)): (usize, &(f64, f64))| CURVE_FACTOR.check(path.then(i), "a factor of the curve", factor);
    curve.points.iter().enumerate().try_for_each(factor)
}

/// The schedule of a guide: fractions of its length that never fall.
pub(crate) fn validate_schedule(path: &KeyPath, guide: &str, clock: Clock, points: &[(f64, f64)]) -> Check {
    clock.check(path, &format!("the keyframes of guide `{guide}`"), points)?;
    for (i, &(_, fraction)) in points.iter().enumerate() {
        UNIT.check(path.then(i), &format!("a fraction of the length of guide `{guide}`"), fraction)?;
        if i > 0 && points[i - 1].1 > fraction {
            return Err(SceneFault::new(
                path.then(i),
                format!("guide `{guide}` goes back: the fraction {fraction} comes after {}", points[i - 1].1),
                "a crack does not heal: fractions of the length may rise or stay",
            ));
        }
    }
    Ok(())
}

/// A factor over time that may be anything but negative. `what`: the keyframes of what, in words.
pub(crate) fn validate_factor(path: &KeyPath, what: &str, clock: Clock, points: &[(f64, f64)]) -> Check {
    clock.check(path, what, points)?;
    let factor = |(i, &(_, factor)): (usize, &(f64, f64))| SPEED_FACTOR.check(path.then(i), "a factor", factor);
    points.iter().enumerate().try_for_each(factor)
}

/// The factor on the highest speed: with `limit` it stays within the Rayleigh wave speed.
pub(crate) fn validate_speed(path: &KeyPath, limit: f64, clock: Clock, points: &[(f64, f64)]) -> Check {
    clock.check(path, "the keyframes of the speed", points)?;
    for (i, &(_, factor)) in points.iter().enumerate() {
        SPEED_FACTOR.check(path.then(i), "a factor on the speed limit", factor)?;
        if factor * limit > 1.0 {
            return Err(SceneFault::new(
                path.then(i),
                format!(
                    "a factor of {factor} on `speed_limit` = {limit} is {} Rayleigh wave speeds",
                    short(factor * limit)
                ),
                format!("no crack is faster than one: make it at most {}", short(1.0 / limit)),
            ));
        }
    }
    Ok(())
}
