//! Cracks that begin, or are opened into, where a tip passes a branch of its guide.

use super::Simulation;
use crate::crack::cracks::{Cracks, ENDS, TipId};
use crate::crack::guide::{self, GuideWalk};
use crate::crack::tip::Tip;
use crate::growth;
use crate::saved::{self, Fits};
use fissure_scene::{BranchKind, CrackEnd, Curve, End, Guide, GuideBranch, Point, TipState};
use serde::{Deserialize, Serialize};

/// A branch begins when the tip that has passed it is so far beyond, in cells: what is cut for the two is one then.
const CLEAR: f64 = 1.0;

/// Length in cells at which a branch begins that fracture mechanics lets grow: a shorter one lies in the corner of its
/// trunk and feels nothing else.
const FIRST_LENGTH: f64 = 1.5;

/// So many points at the end of a crack may be new since the last step: the last ligament and more.
const NEW_POINTS: usize = 32;

/// A branch of a guide that has been passed.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct WaitingBranch {
    /// The tip that has passed.
    trunk: TipId,
    /// Point of that crack at which it begins [m].
    at: Point,
    guide: Guide,
    /// It does not begin earlier [s].
    since: f64,
}

impl WaitingBranch {
    /// Checks a branch that was read.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(super) fn check(&self, cracks: &Cracks) -> Fits {
        self.trunk.check(cracks.len())?;
        saved::finite("a branch that waits", self.at.iter().chain([&self.since]))?;
        guide::check(&self.guide, cracks.len())
    }

    /// Whether it is time to begin: its delay is over, and what its schedule asks for is an increment of the length
    /// `step` [m].
    fn is_due(&self, time: f64, step: f64) -> bool {
        let due = GuideWalk::new(&self.guide, 0.0).due(0.0, time);
        time >= self.since && due.is_none_or(|due| due.length >= step || (due.is_last && due.length > 0.0))
    }
}

impl Simulation {
    /// Lets begin what branches off the guides of tips that have come by.
    pub(super) fn branch_off(&mut self, time: f64) {
        let mut changed = self.pass_branches(time);
        if !self.state.waiting.is_empty() {
            let step = self.scene.growth.increment * self.scene.cell_size;
            for branch in std::mem::take(&mut self.state.waiting) {
                if !branch.is_due(time, step) {
                    self.state.waiting.push(branch);
                    continue;
                }
                match self.place(&branch) {
                    Place::Inner => changed.extend(self.begin_branch(&branch)),
                    Place::Ahead => self.go_on_along(&branch),
                    Place::TooNear => self.state.waiting.push(branch),
                    Place::Gone => {}
                }
            }
        }
        if !changed.is_empty() {
            self.recut(&changed);
        }
    }

    /// Notes what tips have come by. Returns the ends of cracks that have become part of others.
    fn pass_branches(&mut self, time: f64) -> Vec<TipId> {
        let mut changed = Vec::new();
        for crack in 0..self.state.cracks.len() {
            for id in ENDS.map(|end| TipId::new(crack, end)) {
                for branch in self.passed(id) {
                    changed.extend(self.note(id, branch, time));
                }
            }
        }
        changed
    }

    /// What a tip has come by since the last step.
    fn passed(&mut self, id: TipId) -> Vec<GuideBranch> {
        let cracks = &mut self.state.cracks;
        if cracks.tip(id).and_then(|tip| tip.guide.as_ref()).is_none_or(|guide| !guide.has_branches_ahead()) {
            return Vec::new();
        }
        let line = cracks.of(id).last_points(id.end, NEW_POINTS);
        cracks.tip_mut(id).and_then(|tip| tip.guide.as_mut()).map_or(Vec::new(), |guide| guide.pass(&line))
    }

    /// Notes a branch that a tip has come by. Returns the end of a crack that has become part of another.
    fn note(&mut self, id: TipId, branch: GuideBranch, time: f64) -> Option<TipId> {
        let cracks = &mut self.state.cracks;
        match branch.kind {
            BranchKind::Drawn { crack, end } => {
                let joined = TipId::new(crack, end);
                let is_there = cracks.of(id).points.contains(&cracks.position(joined));
                if !is_there || cracks.end(joined) != CrackEnd::Tip {
                    return None;
                }
                cracks.set_end(joined, CrackEnd::Junction { crack: id.crack as u32 });
                Some(joined)
            }
            BranchKind::Begins { mut guide, delay, from_passing } => {
                if from_passing {
                    let later = |&(at, value): &(f64, f64)| (at + time + delay, value);
                    guide.schedule = Curve { points: guide.schedule.points.iter().map(later).collect() };
                }
                let at = cracks.of(id).fixed_point(id.end);
                self.state.waiting.push(WaitingBranch { trunk: id, at, guide, since: time + delay });
                None
            }
        }
    }

    /// Where a branch is to begin on its trunk.
    fn place(&self, branch: &WaitingBranch) -> Place {
        let (cracks, id) = (&self.state.cracks, branch.trunk);
        let trunk = cracks.of(id);
        let Some(at) = trunk.points.iter().position(|p| *p == branch.at) else { return Place::Gone };
        let is_inner = at > 0 && at + 1 < trunk.points.len();
        let state = cracks.tip(id).map(|tip| tip.state);
        let beyond = match id.end {
            End::Start => fissure_plane::polyline_length(&trunk.points[..=at]),
            End::End => fissure_plane::polyline_length(&trunk.points[at..]),
        };
        if is_inner && (beyond >= CLEAR * self.scene.cell_size || state.is_none_or(|state| !state.is_live())) {
            Place::Inner
        } else if !is_inner && state == Some(TipState::GuideEnded) {
            Place::Ahead
        } else if state.is_some_and(TipState::is_live) {
            Place::TooNear
        } else {
            Place::Gone
        }
    }

    /// Lets the trunk go on along a branch at the end of its guide.
    fn go_on_along(&mut self, branch: &WaitingBranch) {
        if let Some(tip) = self.state.cracks.tip_mut(branch.trunk) {
            tip.guide = Some(GuideWalk::new(&branch.guide, tip.grown));
            tip.state = TipState::Resting;
            tip.time_at_rest = 0.0;
        }
    }

    /// Begins a branch: a new crack from a point of its trunk on. None where it would at once meet something else than
    /// its trunk.
    fn begin_branch(&mut self, branch: &WaitingBranch) -> Option<TipId> {
        let trunk = branch.trunk;
        let step = self.scene.growth.increment * self.scene.cell_size;
        let mut walk = GuideWalk::new(&branch.guide, 0.0);
        let is_scheduled = walk.due(0.0, 0.0).is_some();
        let count = if is_scheduled { 1 } else { (FIRST_LENGTH / self.scene.growth.increment).ceil() as usize };
        let (mut points, mut place) = (vec![branch.at], walk.here(branch.at));
        for _ in 0..count {
            place = walk.after(place, step);
            points.push(place.at);
            if place.is_end {
                break;
            }
        }
        let body = &self.scene.bodies[self.state.cracks.of(trunk).body as usize];
        let is_free = |w: &[Point]| growth::is_free(&self.state.cracks, trunk, &body.region, w[0], w[1]);
        points.dedup();
        if points.len() < 2 || !points.windows(2).all(is_free) {
            return None;
        }
        walk.walk(place.way);
        let state = if place.is_end { TipState::GuideEnded } else { TipState::Growing };
        let grown = fissure_plane::polyline_length(&points);
        let tip = Tip { state, grown, ..Tip::new(Some(walk)) };
        let cracks = &mut self.state.cracks;
        let new = cracks.add(cracks.of(trunk).branch(trunk.crack, points, tip));
        Some(TipId::new(new, End::End))
    }
}

/// Where a branch begins on its trunk.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    /// Behind the tip.
    Inner,
    /// At the tip, whose guide ends there.
    Ahead,
    /// Behind the tip, which is still too near.
    TooNear,
    /// Where the trunk has ended, or has never been.
    Gone,
}
