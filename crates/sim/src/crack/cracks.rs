//! All cracks of a run, and how a tip among them is named.

use super::tip::Tip;
use super::{Crack, slot};
use crate::crack::division::CrackLine;
use crate::saved::{self, Fits};
use fissure_scene::{CrackEnd, End, Point, Scene, Vector};
use serde::{Deserialize, Serialize};
use std::ops::Deref;

/// Both ends of a crack.
pub(crate) const ENDS: [End; 2] = [End::Start, End::End];

/// One end of one crack: what a tip is known by, for as long as the run lasts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) struct TipId {
    /// Number of the crack.
    pub(crate) crack: usize,
    /// Its end.
    pub(crate) end: End,
}

impl TipId {
    /// The tip at `end` of the crack number `crack`.
    pub(crate) fn new(crack: usize, end: End) -> Self {
        Self { crack, end }
    }

    /// Checks that a tip that was read is an end of one of `cracks` cracks.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(crate) fn check(self, cracks: usize) -> Fits {
        saved::ensure(self.crack < cracks, "the crack of a tip")
    }
}

/// All cracks. What looks at a tip is handed them and a [`TipId`]; numbers of cracks never change, new ones are added
/// at the end.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Cracks(Vec<Crack>);

impl Deref for Cracks {
    type Target = [Crack];

    fn deref(&self) -> &[Crack] {
        &self.0
    }
}

impl Cracks {
    /// The cracks that a scene begins with.
    pub(crate) fn of_scene(scene: &Scene) -> Self {
        Self(scene.cracks.iter().map(|crack| Crack::drawn(scene, crack)).collect())
    }

    /// Every end of every crack, in order.
    pub(crate) fn ids(&self) -> impl Iterator<Item = TipId> {
        (0..self.len()).flat_map(|crack| ENDS.into_iter().map(move |end| TipId::new(crack, end)))
    }

    /// The ends with a live tip, in order.
    pub(crate) fn live(&self) -> Vec<TipId> {
        self.ids().filter(|&id| self.tip(id).is_some_and(|tip| tip.state.is_live())).collect()
    }

    /// The crack that `id` is an end of.
    pub(crate) fn of(&self, id: TipId) -> &Crack {
        &self.0[id.crack]
    }

    /// The tip there; none where the drawing has no live tip.
    pub(crate) fn tip(&self, id: TipId) -> Option<&Tip> {
        self.of(id).tip(id.end)
    }

    /// As [`Cracks::tip`], to be changed.
    pub(crate) fn tip_mut(&mut self, id: TipId) -> Option<&mut Tip> {
        self.0[id.crack].tip_mut(id.end)
    }

    /// All tips, to be changed.
    pub(crate) fn tips_mut(&mut self) -> impl Iterator<Item = &mut Tip> {
        self.0.iter_mut().flat_map(Crack::tips_mut)
    }

    /// What is at the end: a tip, a mouth, another crack.
    pub(crate) fn end(&self, id: TipId) -> CrackEnd {
        self.of(id).end(id.end)
    }

    /// Where the end is at rest [m].
    pub(crate) fn position(&self, id: TipId) -> Point {
        self.of(id).tip_position(id.end)
    }

    /// Unit vector ahead of the end at rest: see [`Crack::ahead`].
    pub(crate) fn ahead(&self, id: TipId, over: f64) -> Vector {
        self.of(id).ahead(id.end, over)
    }

    /// Way from the end to the first kink behind it [m], if that is less than `within` [m].
    pub(crate) fn way_to_kink(&self, id: TipId, within: f64) -> Option<f64> {
        self.of(id).way_to_kink(id.end, within)
    }

    /// Unit vector of the last segment at rest, pointing ahead of the end.
    pub(crate) fn last_direction(&self, id: TipId) -> Vector {
        self.of(id).last_direction(id.end)
    }

    /// The cracks as the division sees them, their points being where `points` puts those of a crack (its number, the
    /// crack); pairs reach over `reach` [m] along an axis.
    pub(crate) fn lines(&self, points: impl Fn(usize, &Crack) -> Vec<Point>, reach: f64) -> Vec<CrackLine> {
        // A line from a particle inside the body to a node outside may pass a mouth by as much as the kernel reaches.
        let beyond = 2.0 * reach;
        let of = |(i, crack): (usize, &Crack)| {
            let mut line = crack.line(i, points(i, crack), beyond);
            line.trunk = self.way_along_trunk(crack, &points, 5.0 * reach);
            line
        };
        self.iter().enumerate().map(of).collect()
    }

    /// The way along the crack that a crack leaves at a point of that one to there, over `length` [m], that point left
    /// out; empty where it leaves none so.
    fn way_along_trunk(&self, crack: &Crack, points: &impl Fn(usize, &Crack) -> Vec<Point>, length: f64) -> Vec<Point> {
        let CrackEnd::Junction { crack: number } = crack.end(End::Start) else { return Vec::new() };
        let Some(trunk) = self.get(number as usize) else { return Vec::new() };
        let Some(at) = trunk.points.iter().position(|p| *p == crack.points[0]) else { return Vec::new() };
        if at == 0 || at + 1 == trunk.points.len() {
            return Vec::new();
        }
        let of_trunk = points(number as usize, trunk);
        let mut left = length;
        let is_within = |k: &usize| {
            let is_within = left > 0.0;
            left -= (of_trunk[*k + 1] - of_trunk[*k]).norm();
            is_within
        };
        let mut way: Vec<Point> = (0..at).rev().take_while(is_within).map(|k| of_trunk[k]).collect();
        way.reverse();
        way
    }

    /// Adds a crack. Returns its number.
    pub(crate) fn add(&mut self, crack: Crack) -> usize {
        self.0.push(crack);
        self.0.len() - 1
    }

    /// Makes the end something else.
    pub(crate) fn set_end(&mut self, id: TipId, end: CrackEnd) {
        self.0[id.crack].set_end(id.end, end);
    }

    /// Adds points at the end, for which lines will be cut. Returns the length that they add [m].
    pub(crate) fn grow(&mut self, id: TipId, points: &[Point]) -> f64 {
        let crack = &mut self.0[id.crack];
        let before = crack.length();
        for &point in points {
            crack.push(id.end, point);
        }
        let length = crack.length() - before;
        if let Some(tip) = crack.tip_mut(id.end) {
            tip.add_grown(length);
        }
        length
    }

    /// Sets the end on its way to `target` with a new point, at the part `part` of the way, for which lines will be
    /// cut.
    pub(crate) fn begin_increment(&mut self, id: TipId, target: Point, part: f64) {
        let from = self.position(id);
        self.grow(id, &[from + (target - from) * part]);
        self.0[id.crack].ways[slot(id.end)].target = Some(target);
    }

    /// Where the increment ends that the end is on its way through; none between increments.
    pub(crate) fn target(&self, id: TipId) -> Option<Point> {
        self.of(id).ways[slot(id.end)].target
    }

    /// What is left of the increment that the end is on its way through [m]; none between increments.
    pub(crate) fn left_of_increment(&self, id: TipId) -> Option<f64> {
        self.of(id).left_of_increment(id.end)
    }

    /// Moves the end on by `distance` [m] along its increment, whose end it reaches when no more is left; lines stay
    /// cut as they are.
    pub(crate) fn slide(&mut self, id: TipId, distance: f64) {
        let crack = &mut self.0[id.crack];
        crack.slide(id.end, distance);
        if let Some(tip) = crack.tip_mut(id.end) {
            tip.add_grown(distance);
        }
    }
}
