//! Tips on drawn paths.

use crate::saved::{self, Fits};
use fissure_scene::{Guide, Point, Vector};
use serde::{Deserialize, Serialize};

/// How far a tip has come along its guide.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct GuideWalk {
    guide: Guide,
    /// Arc length from the beginning of the guide [m].
    walked: f64,
}

/// What a schedule still asks of a tip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Due {
    /// Length by which the tip is behind [m]; negative: ahead.
    pub(crate) length: f64,
    /// Whether the schedule asks for nothing after that.
    pub(crate) is_last: bool,
}

impl GuideWalk {
    /// A tip at the beginning of `guide`.
    pub(crate) fn new(guide: &Guide) -> Self {
        Self { guide: guide.clone(), walked: 0.0 }
    }

    /// Checks a guide that was read.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(crate) fn check(&self) -> Fits {
        let points = self.guide.points.iter().flat_map(|p| p.iter());
        let schedule = self.guide.schedule.points.iter().flat_map(|(time, fraction)| [time, fraction]);
        saved::finite("a guide", points.chain(schedule).chain([&self.guide.strength, &self.walked]))?;
        saved::ensure(self.guide.points.len() >= 2, "the line of a guide")
    }

    /// How much the guide decides the direction, 0 to 1.
    pub(crate) fn strength(&self) -> f64 {
        self.guide.strength
    }

    /// The place on the guide `step` beyond where the tip is [m], and whether the guide ends there.
    pub(crate) fn ahead(&self, step: f64) -> (Point, bool) {
        self.place(self.walked + step)
    }

    fn place(&self, length: f64) -> (Point, bool) {
        let mut left = length;
        for w in self.guide.points.windows(2) {
            let segment = (w[1] - w[0]).norm();
            if left < segment {
                return (w[0] + (w[1] - w[0]) * (left / segment), false);
            }
            left -= segment;
        }
        (self.guide.points[self.guide.points.len() - 1], true)
    }

    /// Moves on by `step` [m].
    pub(crate) fn walk(&mut self, step: f64) {
        self.walked += step;
    }

    /// The direction from `tip`, which need not be on the guide, to the guide `over` [m] beyond the place nearest to it
    /// (unit vector). None at the end of the guide.
    pub(crate) fn drawn_direction(&self, tip: Point, over: f64) -> Option<Vector> {
        let mut nearest = (f64::INFINITY, 0.0);
        let mut before = 0.0;
        for w in self.guide.points.windows(2) {
            let along = w[1] - w[0];
            let segment = along.norm();
            let t = ((tip - w[0]).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            let distance = (tip - (w[0] + along * t)).norm();
            if distance < nearest.0 {
                nearest = (distance, before + t * segment);
            }
            before += segment;
        }
        if nearest.1 >= before {
            return None;
        }
        (self.place(nearest.1 + over).0 - tip).try_normalize(0.0)
    }

    /// What the schedule asks at `time` [s] of a tip that has grown by `grown` [m]; none without a schedule.
    pub(crate) fn due(&self, grown: f64, time: f64) -> Option<Due> {
        let schedule = &self.guide.schedule;
        let last = schedule.points.last()?;
        let length = fissure_plane::polyline_length(&self.guide.points);
        Some(Due { length: schedule.value(time) * length - grown, is_last: time >= last.0 })
    }
}
