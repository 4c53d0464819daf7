//! Tips on drawn paths.

use crate::saved::{self, Fits};
use fissure_scene::{BranchKind, Guide, GuideBranch, Point, Vector};
use serde::{Deserialize, Serialize};

/// A way to the next point of a guide nearer than this part of an increment is none.
const NO_WAY: f64 = 1e-6;
/// A point where something branches off that is nearer than this, in increments, is gone to at once: what would be left
/// to it would be too short for a direction.
const TO_BRANCH: f64 = 1.5;

/// How far a tip has come along its guide.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct GuideWalk {
    guide: Guide,
    /// Arc length from the beginning of the guide [m].
    walked: f64,
    /// What the tip had grown by when it began to follow the guide [m].
    grown_before: f64,
    /// How many of the branches it has passed.
    passed: usize,
}

/// A place on a guide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GuidePlace {
    /// Arc length from the beginning of the guide [m].
    pub(crate) way: f64,
    pub(crate) at: Point,
    /// Whether the guide ends there.
    pub(crate) is_end: bool,
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
    /// A tip at the beginning of `guide`, which has grown by `grown_before` [m] so far.
    pub(crate) fn new(guide: &Guide, grown_before: f64) -> Self {
        Self { guide: guide.clone(), walked: 0.0, grown_before, passed: 0 }
    }

    /// Checks a guide that was read.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(crate) fn check(&self, cracks: usize) -> Fits {
        saved::finite("a guide", [&self.walked, &self.grown_before])?;
        saved::ensure(self.passed <= self.guide.branches.len(), "the branches of a guide")?;
        check(&self.guide, cracks)
    }

    /// How much the guide decides the direction, 0 to 1.
    pub(crate) fn strength(&self) -> f64 {
        self.guide.strength
    }

    /// Where the tip is, which stands at `tip`. The way that it has come is that of its crack, which cuts the corners
    /// of the guide; at a branch it is known exactly.
    pub(crate) fn here(&self, tip: Point) -> GuidePlace {
        let branch = self.guide.branches.iter().find(|branch| self.guide.points[branch.point] == tip);
        let way = branch.map_or(self.walked, |branch| self.way_to(branch.point));
        GuidePlace { way, at: tip, is_end: false }
    }

    /// The place an increment of the length `step` [m] beyond `place`, or where something branches off just before it
    /// or a little behind.
    pub(crate) fn after(&self, place: GuidePlace, step: f64) -> GuidePlace {
        let branches = self.guide.branches.iter().map(|branch| (self.way_to(branch.point), branch.point));
        let mut ahead = branches.skip_while(|&(way, _)| way <= place.way + NO_WAY * step);
        if let Some((way, point)) = ahead.next().filter(|&(way, _)| way <= place.way + TO_BRANCH * step) {
            return GuidePlace { way, at: self.guide.points[point], is_end: point + 1 == self.guide.points.len() };
        }
        let (at, is_end) = self.place(place.way + step);
        GuidePlace { way: place.way + step, at, is_end }
    }

    /// Arc length from the beginning of the guide to one of its points [m].
    fn way_to(&self, point: usize) -> f64 {
        fissure_plane::polyline_length(&self.guide.points[..=point])
    }

    /// What a tip with the last points `line` of its crack, from the tip backwards, has come by since it was last
    /// asked.
    ///
    /// One that follows exactly is at a branch when a point of the crack is; another one when the place of the guide
    /// nearest to it is as far on.
    pub(crate) fn pass(&mut self, line: &[Point]) -> Vec<GuideBranch> {
        let ahead = &self.guide.branches[self.passed..];
        let Some(tip) = line.first().filter(|_| !ahead.is_empty()) else { return Vec::new() };
        let nearest = self.nearest(*tip);
        let is_exact = self.guide.strength >= 1.0;
        let is_passed = |branch: &&GuideBranch| {
            let point = self.guide.points[branch.point];
            if is_exact { line.contains(&point) } else { nearest >= self.way_to(branch.point) }
        };
        let passed: Vec<GuideBranch> = ahead.iter().take_while(is_passed).cloned().collect();
        if let Some(last) = passed.last().filter(|last| self.guide.points[last.point] == *tip) {
            self.walked = self.way_to(last.point);
        }
        self.passed += passed.len();
        passed
    }

    /// Whether something branches off that the tip has not passed yet.
    pub(crate) fn has_branches_ahead(&self) -> bool {
        self.passed < self.guide.branches.len()
    }

    /// Cracks of the scene that open into the one that follows the guide, and that it has not passed yet.
    pub(crate) fn will_join(&self, number: usize) -> bool {
        self.guide.branches[self.passed..]
            .iter()
            .any(|branch| matches!(branch.kind, BranchKind::Drawn { crack, .. } if crack == number))
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
        let nearest = self.nearest(tip);
        if nearest >= fissure_plane::polyline_length(&self.guide.points) {
            return None;
        }
        (self.place(nearest + over).0 - tip).try_normalize(0.0)
    }

    /// Arc length from the beginning of the guide to the place nearest to `tip` [m].
    fn nearest(&self, tip: Point) -> f64 {
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
        nearest.1
    }

    /// What the schedule asks at `time` [s] of a tip that has grown by `grown` [m] in all; none without a schedule.
    pub(crate) fn due(&self, grown: f64, time: f64) -> Option<Due> {
        let schedule = &self.guide.schedule;
        let last = schedule.points.last()?;
        let length = fissure_plane::polyline_length(&self.guide.points);
        let walked = grown - self.grown_before;
        Some(Due { length: schedule.value(time) * length - walked, is_last: time >= last.0 })
    }
}

/// Checks a guide that was read, in a run with so many `cracks`, and what branches off it.
///
/// # Errors
/// [`SimulationError::BadState`](crate::SimulationError::BadState)
pub(crate) fn check(guide: &Guide, cracks: usize) -> Fits {
    let points = guide.points.iter().flat_map(|p| p.iter());
    let schedule = guide.schedule.points.iter().flat_map(|(time, fraction)| [time, fraction]);
    saved::finite("a guide", points.chain(schedule).chain([&guide.strength]))?;
    saved::ensure(guide.points.len() >= 2, "the line of a guide")?;
    guide.branches.iter().try_for_each(|branch| {
        saved::ensure((1..guide.points.len()).contains(&branch.point), "a branch of a guide")?;
        match &branch.kind {
            BranchKind::Begins { guide, delay, .. } => {
                saved::finite("a guide", [delay])?;
                check(guide, cracks)
            }
            BranchKind::Drawn { crack, .. } => saved::ensure(*crack < cracks, "the crack on a guide"),
        }
    })
}
