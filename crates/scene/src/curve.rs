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

    /// Mean of the factor from `start` to `end`, which is later.
    pub fn mean(&self, start: f64, end: f64) -> f64 {
        let first = self.points.partition_point(|p| p.0 <= start);
        let within = self.points[first..].iter().map(|p| p.0).take_while(|&t| t < end);
        let (mut from, mut sum) = (start, 0.0);
        for to in within.chain(std::iter::once(end)) {
            sum += 0.5 * (self.value(from) + self.value(to)) * (to - from);
            from = to;
        }
        sum / (end - start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the areas of trapezoids by hand, before, between and beyond the points.
    #[test]
    fn the_mean_is_the_area_over_the_time() {
        let curve = Curve { points: vec![(1.0, 0.0), (2.0, 4.0), (4.0, 0.0)] };
        for (start, end, area) in [(0.0, 1.0, 0.0), (0.0, 2.0, 2.0), (0.0, 9.0, 6.0), (1.5, 3.0, 4.5), (2.5, 3.0, 1.25)]
        {
            assert!((curve.mean(start, end) * (end - start) - area).abs() < 1e-12, "{start} to {end}");
        }
        assert_eq!(Curve::default().mean(1.0, 3.0), 1.0);
    }
}
