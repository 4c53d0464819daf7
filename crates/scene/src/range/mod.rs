//! The ranges that numbers of a scene may have. Each is written here, once: checks, messages and the schema come from
//! this table.
//!
//! They are wide: from a grain of a micrometre to a mountain, from nanoseconds to years, from snow to diamond and
//! beyond. What lies outside is a slip of the pen (a wrong unit, a digit too many), and would overflow somewhere
//! behind.

#![cfg_attr(not(feature = "load"), allow(dead_code, reason = "some numbers are of scene files only"))]

#[cfg(feature = "load")]
mod bounds;
mod count;

#[cfg(feature = "load")]
pub(crate) use bounds::pairs;
pub(crate) use count::*;

use crate::fault::{Check, KeyPath, SceneFault};
use fissure_plane::Point;

/// A range of numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Range {
    /// Lower end.
    pub(crate) low: f64,
    /// Upper end.
    pub(crate) high: f64,
    /// Whether the ends themselves belong to it.
    ends: [bool; 2],
    /// Whether infinity does too, and what it stands for.
    infinity: Option<&'static str>,
    unit: &'static str,
}

/// From `low` to `high`, both included.
const fn within(low: f64, high: f64, unit: &'static str) -> Range {
    Range { low, high, ends: [true; 2], infinity: None, unit }
}

/// From −`most` to `most`.
const fn up_to(most: f64, unit: &'static str) -> Range {
    within(-most, most, unit)
}

/// From 0 to `most`.
const fn not_negative(most: f64, unit: &'static str) -> Range {
    within(0.0, most, unit)
}

/// Between `low` and `high`, neither included.
const fn between(low: f64, high: f64, unit: &'static str) -> Range {
    Range { ends: [false; 2], ..within(low, high, unit) }
}

// Space.
/// A component of a place or a displacement.
pub(crate) const COORDINATE: Range = up_to(1e9, "m");
/// A length, a radius, a spacing.
pub(crate) const LENGTH: Range = within(1e-12, 1e9, "m");
/// An area that may be nothing.
pub(crate) const AREA: Range = not_negative(1e18, "m²");
/// A width that may be nothing.
pub(crate) const WIDTH: Range = not_negative(1e9, "m");
/// An angle in degrees, any number of turns.
pub(crate) const DEGREES: Range = up_to(1e6, "degrees");
/// How far directions vary.
pub(crate) const DEGREES_APART: Range = not_negative(1e6, "degrees");
/// An angle between a branch and its trunk.
pub(crate) const ACUTE: Range = between(0.0, 90.0, "degrees");

// Time.
/// A moment.
pub(crate) const TIME: Range = up_to(1e9, "s");
/// From one keyframe to the next.
pub(crate) const INTERVAL: Range = within(1e-15, 2e9, "s");
/// A time step.
pub(crate) const TIME_STEP: Range = within(1e-18, 1e6, "s");
/// Frames per second.
pub(crate) const FRAME_RATE: Range = within(1e-9, 1e15, "frames per second");
/// A frame that a keyframe names; it may lie outside of the frames that are written.
pub(crate) const FRAME: Range = up_to(1e9, "");
/// So many frames long.
pub(crate) const FRAMES_LONG: Range = not_negative(1e9, "frames");
/// A damping rate.
pub(crate) const DAMPING: Range = not_negative(1e15, "1/s");

// Motion.
/// A component of a velocity.
pub(crate) const VELOCITY: Range = up_to(1e6, "m/s");
/// A speed of rotation.
pub(crate) const ANGULAR_VELOCITY: Range = up_to(1e12, "rad/s");
/// The speed of a crack tip.
pub(crate) const CRACK_SPEED: Range = within(1e-9, 1e6, "m/s");
/// A component of gravity.
pub(crate) const ACCELERATION: Range = up_to(1e12, "m/s²");

// Matter.
/// Young's modulus; diamond has 1.2e12.
pub(crate) const YOUNG_MODULUS: Range = within(1e-3, 1e15, "Pa");
/// Poisson's ratio.
pub(crate) const POISSON_RATIO: Range = between(-1.0, 0.5, "");
/// Density.
pub(crate) const DENSITY: Range = within(1e-6, 1e9, "kg/m³");
/// Fracture toughness; its upper end stands for a crack that never grows.
pub(crate) const FRACTURE_TOUGHNESS: Range = within(1e-6, 1e30, "Pa·√m");
/// A factor on the fracture toughness.
pub(crate) const TOUGHNESS_FACTOR: Range = within(1e-9, 1e9, "");
/// Compression beyond which snow flows.
pub(crate) const CRITICAL_COMPRESSION: Range = between(0.0, 1.0, "");
/// Stretch beyond which snow flows.
pub(crate) const CRITICAL_STRETCH: Range = within(1e-12, 1e3, "");
/// Hardening of snow, an exponent.
pub(crate) const HARDENING: Range = not_negative(100.0, "");
/// Coulomb friction.
pub(crate) const FRICTION: Range = Range { infinity: Some("stick"), ..not_negative(1e6, "") };

// Loads.
/// A component of a force per thickness.
pub(crate) const FORCE: Range = up_to(1e18, "N/m");
/// A component of a traction.
pub(crate) const TRACTION: Range = up_to(1e18, "Pa");
/// A pressure; below zero it pulls.
pub(crate) const PRESSURE: Range = up_to(1e18, "Pa");
/// A factor over time.
pub(crate) const CURVE_FACTOR: Range = up_to(1e9, "");

// Parts and multiples.
/// A part of the whole, nothing and all included.
pub(crate) const UNIT: Range = within(0.0, 1.0, "");
/// A part of the whole that is not nothing.
pub(crate) const FRACTION: Range = Range { ends: [false, true], ..UNIT };
/// A spread relative to a mean.
pub(crate) const SPREAD: Range = Range { ends: [true, false], ..UNIT };
/// A number of cells.
pub(crate) const CELLS: Range = within(1e-3, 1e4, "cells");
/// How far the path of a crack may be moved to be smooth.
pub(crate) const SMOOTHING_CELLS: Range = not_negative(2.0, "cells");
/// How long edges of crack walls may be.
pub(crate) const WALL_CELLS: Range = not_negative(2.0, "cells");
/// A factor on K_II in the direction of growth.
pub(crate) const BENDING: Range = not_negative(1e3, "");
/// A factor on the speed limit.
pub(crate) const SPEED_FACTOR: Range = not_negative(1e9, "");
/// Release of a tip at rest over G_c at which it divides.
pub(crate) const RELEASE_RATIO: Range = Range { ends: [false, true], ..within(1.0, 1e9, "") };
/// Flaws per area.
pub(crate) const FLAW_DENSITY: Range = not_negative(1e24, "1/m²");

impl Range {
    /// Checks that `value` lies in the range. `what`: what it is, in words.
    ///
    /// # Errors
    /// The value and the range, at `path`.
    pub(crate) fn check(self, path: KeyPath, what: &str, value: f64) -> Check {
        if self.holds(value) {
            return Ok(());
        }
        Err(SceneFault::new(path, format!("{what} is {}", number(value)), format!("it must be {}", self.words())))
    }

    /// Checks both components.
    ///
    /// # Errors
    /// As [`Range::check`].
    pub(crate) fn check_pair(self, path: KeyPath, what: &str, value: [f64; 2]) -> Check {
        value.into_iter().try_for_each(|v| self.check(path.clone(), what, v))
    }

    /// Checks both components of all points.
    ///
    /// # Errors
    /// As [`Range::check`].
    pub(crate) fn check_points(self, path: &KeyPath, what: &str, points: &[Point]) -> Check {
        points.iter().try_for_each(|p| self.check_pair(path.clone(), what, [p.x, p.y]))
    }

    /// Whether `value` lies in the range.
    pub(crate) fn holds(self, value: f64) -> bool {
        let [low, high] = self.ends;
        let above = if low { value >= self.low } else { value > self.low };
        let below = if high { value <= self.high } else { value < self.high };
        (above && below) || (self.infinity.is_some() && value == f64::INFINITY)
    }

    /// The range as messages show it.
    pub(crate) fn words(self) -> String {
        let (low, high, unit) = (number(self.low), number(self.high), self.unit);
        let words = match self.ends {
            // Whoever has written 0 wants to hear that it must be more, not by how little.
            [true, true] if self.low > 0.0 => format!("above 0: from {low} to {high}"),
            [true, true] if self.low == 0.0 && self.high > 1.0 => format!("at least 0 and at most {high}"),
            [true, true] if self.low == -self.high => format!("finite: from {low} to {high}"),
            [true, true] => format!("from {low} to {high}"),
            [true, false] => format!("at least {low} and below {high}"),
            [false, true] => format!("above {low} and at most {high}"),
            [false, false] => format!("above {low} and below {high}"),
        };
        let words = if unit.is_empty() { words } else { format!("{words} {unit}") };
        match self.infinity {
            Some(meaning) => format!("{words}, or inf ({meaning})"),
            None => words,
        }
    }
}

/// A number as messages show it: not as a row of zeros.
pub(crate) fn number(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || !size.is_finite() || (1e-5..1e12).contains(&size) {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_are_told_as_they_hold() {
        assert_eq!(LENGTH.words(), "above 0: from 1e-12 to 1000000000 m");
        assert_eq!(FRICTION.words(), "at least 0 and at most 1000000, or inf (stick)");
        assert_eq!(POISSON_RATIO.words(), "above -1 and below 0.5");
        assert_eq!(SPREAD.words(), "at least 0 and below 1");
        assert!(POISSON_RATIO.holds(0.499) && !POISSON_RATIO.holds(0.5) && !POISSON_RATIO.holds(-1.0));
        assert!(FRACTION.holds(1.0) && !FRACTION.holds(0.0) && SPREAD.holds(0.0) && !SPREAD.holds(1.0));
        assert!(FRICTION.holds(f64::INFINITY) && !FRICTION.holds(f64::NEG_INFINITY));
        for range in [LENGTH, COORDINATE, FRICTION, UNIT, YOUNG_MODULUS] {
            assert!(!range.holds(f64::NAN) && range.holds(range.low) && range.holds(range.high));
        }
        assert!(!LENGTH.holds(f64::INFINITY) && !COORDINATE.holds(1e30));
    }
}
