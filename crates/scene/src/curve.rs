//! Factors over time.

use serde::{Deserialize, Serialize};

/// A piecewise linear factor over time; before the first and after the last point constant. Empty: always 1.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Curve {
    /// (time [s], factor), times rising.
    pub points: Vec<(f64, f64)>,
}

impl Curve {
    /// Factor at `time`.
    pub fn value(&self, time: f64) -> f64 {
        let p = &self.points;
        let (Some(first), Some(last)) = (p.first(), p.last()) else { return 1.0 };
        if time <= first.0 {
            return first.1;
        }
        if time >= last.0 {
            return last.1;
        }
        let next = p.partition_point(|q| q.0 <= time);
        let ((t0, f0), (t1, f1)) = (p[next - 1], p[next]);
        f0 + (f1 - f0) * (time - t0) / (t1 - t0)
    }
}
