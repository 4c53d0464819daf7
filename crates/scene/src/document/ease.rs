//! How values go from one keyframe to the next.
//!
//! A scene knows lines between points alone, so a segment that is eased becomes many of them. The shapes are the
//! quadratic and cubic ones that animation programs call by these names (R. Penner, *Programming Macromedia Flash MX*,
//! 2002, chapter 7; the last is the smoothstep polynomial 3t² − 2t³).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::{Add, Mul, Sub};

/// Lines that an eased segment becomes. The farthest that one is from the curve is 3/4 / 32² of the segment's rise.
const LINES: u32 = 32;

/// How values go from one keyframe to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Ease {
    /// Evenly.
    #[default]
    Linear,
    /// Slow at first.
    In,
    /// Slow at last.
    Out,
    /// Slow at first and at last.
    InOut,
}

impl Ease {
    /// The part of the rise that is done after the part `time` of the interval, both 0 to 1.
    fn rise(self, time: f64) -> f64 {
        match self {
            Self::Linear => time,
            Self::In => time * time,
            Self::Out => time * (2.0 - time),
            Self::InOut => time * time * (3.0 - 2.0 * time),
        }
    }

    /// Points of a piecewise linear curve that goes through `points`, (time, value), and between them as this says.
    /// Points whose times do not rise are none of a curve and stay as they are, for the validation to find.
    pub(crate) fn between<V>(self, points: &[(f64, V)]) -> Vec<(f64, V)>
    where
        V: Copy + Add<Output = V> + Sub<Output = V> + Mul<f64, Output = V>,
    {
        if self == Self::Linear || !points.windows(2).all(|w| w[0].0 < w[1].0) {
            return points.to_vec();
        }
        let mut eased = Vec::with_capacity(points.len() * LINES as usize);
        for pair in points.windows(2) {
            let ((start, from), (end, to)) = (pair[0], pair[1]);
            eased.push(pair[0]);
            for line in 1..LINES {
                let time = f64::from(line) / f64::from(LINES);
                eased.push((start + (end - start) * time, from + (to - from) * self.rise(time)));
            }
        }
        eased.extend(points.last());
        eased
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::curve::Curve;

    /// Truth: the polynomials. Keyframes are met to the bit, half the time is a quarter, three quarters or half of the
    /// rise, the curve never leaves the polynomial by more than a line of it can, and it never goes back.
    #[test]
    fn a_rise_is_eased_between_its_keyframes() {
        let points = [(1.0, 0.25), (3.0, 0.75), (4.0, 0.75)];
        type Polynomial = fn(f64) -> f64;
        let polynomials: [(Ease, Polynomial); 4] = [
            (Ease::Linear, |t| t),
            (Ease::In, |t| t.powi(2)),
            (Ease::Out, |t| 1.0 - (1.0 - t).powi(2)),
            (Ease::InOut, |t| 3.0 * t.powi(2) - 2.0 * t.powi(3)),
        ];
        for (ease, polynomial) in polynomials {
            let curve = Curve { points: ease.between(&points) };
            assert!(points.iter().all(|&(time, value)| curve.value(time) == value), "{ease:?}");
            let mut before = 0.0;
            for k in 0..=1000 {
                let t = f64::from(k) / 1000.0;
                let value = curve.value(1.0 + 2.0 * t);
                assert!((value - (0.25 + 0.5 * polynomial(t))).abs() < 0.5 * 7.5e-4, "{ease:?} at {t}");
                assert!(value >= before && curve.value(3.0 + t) == 0.75, "{ease:?} at {t}");
                before = value;
            }
        }
        assert!(Ease::In.between::<f64>(&[]).is_empty());
        assert_eq!(Ease::In.between(&points[..1]), points[..1]);
        let backwards = [points[1], points[0]];
        assert_eq!(Ease::In.between(&backwards), backwards);
    }
}
