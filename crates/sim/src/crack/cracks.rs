//! All cracks of a run, and how a tip among them is named.

use super::tip::Tip;
use super::{Crack, SHORTEST_BRANCH, chord_start, is_kink, slot};
use crate::crack::division::CrackLine;
use crate::saved::{self, Fits};
use fissure_scene::{CrackEnd, End, Point, Scene, TipState, Vector};
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

/// Turns whose cosines differ by less are equal.
const EQUAL_TURNS: f64 = 1e-9;

/// A stretch of a crack, walked from one of its points to another one, in either direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Stretch {
    /// Number of the crack.
    pub(crate) crack: usize,
    from: usize,
    pub(crate) to: usize,
}

impl Stretch {
    /// Numbers of its points, as it is walked.
    fn points(self) -> impl Iterator<Item = usize> {
        let (low, high) = (self.from.min(self.to), self.from.max(self.to));
        (low..=high).map(move |k| if self.from <= self.to { k } else { low + high - k })
    }

    /// Whether the segment from the point number `k` of the crack to the next one is part of it.
    pub(crate) fn has_segment(self, k: usize) -> bool {
        (self.from.min(self.to)..self.from.max(self.to)).contains(&k)
    }

    /// Whether it is all of a crack of so many points.
    pub(crate) fn is_all_of(self, points: usize) -> bool {
        self.from.abs_diff(self.to) + 1 == points
    }

    /// Whether it is walked against the direction of the crack, which then runs towards where the walk begins.
    pub(crate) fn is_backwards(self) -> bool {
        self.from > self.to
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

    /// What leads to an end, from it on: along its crack to the other end and, where that leaves another crack, along
    /// that one on the side to which it turns less. Two branches of a crack are so followed alike, whichever of them
    /// has the number of the crack.
    pub(crate) fn trail(&self, id: TipId) -> Vec<Stretch> {
        let last = self.of(id).points.len() - 1;
        let (from, to) = if id.end == End::Start { (0, last) } else { (last, 0) };
        let mut trail = vec![Stretch { crack: id.crack, from, to }];
        // Cracks that leave each other in a circle are followed once.
        while trail.len() <= self.len() {
            let Stretch { crack, to, .. } = trail[trail.len() - 1];
            let Some(fork) = self.fork(crack, if to == 0 { End::Start } else { End::End }) else { break };
            trail.push(fork);
        }
        trail
    }

    /// The way on behind an end of a crack that leaves another one there, on the side to which it turns less; none
    /// where it leaves none at a point of it, or turns by the same to both sides.
    fn fork(&self, crack: usize, end: End) -> Option<Stretch> {
        let (own, trunk) = (&self.0[crack], self.trunk(crack, end)?);
        let points = &self.0[trunk].points;
        let place = own.tip_position(end);
        let at = points.iter().position(|p| *p == place)?;
        if at == 0 || at + 1 == points.len() {
            return None;
        }
        let away = -own.last_direction(end);
        let along = |from: usize| (place - points[from]).normalize().dot(&away);
        let (before, after) = (along(at - 1), along(at + 1));
        if (before - after).abs() < EQUAL_TURNS {
            return None;
        }
        Some(Stretch { crack: trunk, from: at, to: if before > after { 0 } else { points.len() - 1 } })
    }

    /// Where cracks begin at a point of another one: the place at rest [m], and the way on along the other one, on the
    /// side to which they turn less.
    pub(crate) fn forks(&self) -> Vec<(Point, Stretch)> {
        let of = |crack: usize| self.fork(crack, End::Start).map(|trunk| (self.0[crack].points[0], trunk));
        (0..self.len()).filter_map(of).collect()
    }

    /// The crack that an end is on.
    fn trunk(&self, crack: usize, end: End) -> Option<usize> {
        let CrackEnd::Junction { crack: trunk } = self.0[crack].end(end) else { return None };
        (trunk as usize != crack).then_some(trunk as usize).filter(|&trunk| trunk < self.len())
    }

    /// Points behind the end at rest, from it on, up to the first one `over` [m] behind it.
    pub(crate) fn behind(&self, id: TipId, over: f64) -> Vec<Point> {
        self.behind_at(id, over, |crack, point| self.0[crack].points[point])
    }

    /// As [`Cracks::behind`], the points of the cracks being where `place` (crack, number of the point) says.
    pub(crate) fn behind_at(&self, id: TipId, over: f64, place: impl Fn(usize, usize) -> Point) -> Vec<Point> {
        let trail = self.trail(id);
        let mut points = Vec::with_capacity(64);
        points.push(place(id.crack, trail[0].from));
        let mut way = 0.0;
        for stretch in trail {
            for k in stretch.points().skip(1) {
                if way >= over {
                    return points;
                }
                let point = place(stretch.crack, k);
                way += (point - points[points.len() - 1]).norm();
                points.push(point);
            }
        }
        points
    }

    /// Way from the end to the first kink behind it [m], if that is less than `within` [m].
    pub(crate) fn way_to_kink(&self, id: TipId, within: f64) -> Option<f64> {
        let mut way = 0.0;
        for w in self.behind(id, within).windows(3) {
            let (last, before) = (w[0] - w[1], w[1] - w[2]);
            way += last.norm();
            if way >= within {
                break;
            }
            if is_kink(before, last) {
                return Some(way);
            }
        }
        None
    }

    /// Length of the chord that gives the direction of the crack at an end: `over` [m], or the way to the last kink
    /// where that is shorter.
    pub(crate) fn chord_length(&self, id: TipId, over: f64) -> f64 {
        self.way_to_kink(id, over).filter(|&way| way > SHORTEST_BRANCH * over).unwrap_or(over)
    }

    /// Unit vector along the crack at rest, pointing ahead of the end: along the chord from the place `over` [m] behind
    /// the tip (or the other end), or from the last kink. A branch shorter than a quarter cell, of a chord of two, has
    /// the direction of the crack that it comes from, but for as far as it has come.
    pub(crate) fn ahead(&self, id: TipId, over: f64) -> Vector {
        let chord = self.chord_length(id, over);
        (self.position(id) - chord_start(&self.behind(id, chord), End::Start, chord)).normalize()
    }

    /// Unit vector of the last segment at rest, pointing ahead of the end.
    pub(crate) fn last_direction(&self, id: TipId) -> Vector {
        self.of(id).last_direction(id.end)
    }

    /// The cracks as the division sees them, their points being where `points` puts those of a crack (its number, the
    /// crack); pairs reach over `reach` [m] along an axis.
    pub(crate) fn lines(&self, points: impl Fn(usize, &Crack) -> Vec<Point>, reach: f64) -> Vec<CrackLine> {
        let of = |(i, crack): (usize, &Crack)| {
            let mut line = crack.line(i, points(i, crack), beyond(reach));
            line.trunk = self.way_along_trunk(i, &points, 5.0 * reach);
            line
        };
        self.iter().enumerate().map(of).collect()
    }

    /// A crack as the division sees it, its points as lines were last cut for them; none where it is as it was
    /// `before`. Of points only the ends are compared: those between never move.
    pub(crate) fn changed_line(&self, index: usize, before: Option<&CrackLine>, reach: f64) -> Option<CrackLine> {
        let crack = &self.0[index];
        let as_cut = |_: usize, crack: &Crack| crack.points_as_cut();
        let trunk = self.way_along_trunk(index, &as_cut, 5.0 * reach);
        let is_same = |before: &&CrackLine| {
            let [start, end] = crack.ends_as_cut();
            let ends = (before.points.first() == Some(&start), before.points.last() == Some(&end));
            ends == (true, true)
                && before.points.len() == crack.points.len()
                && [before.start, before.end] == crack.line_ends(beyond(reach))
                && before.trunk == trunk
        };
        if before.filter(is_same).is_some() {
            return None;
        }
        Some(CrackLine { trunk, ..crack.line(index, crack.points_as_cut(), beyond(reach)) })
    }

    /// The way to the start of a crack along the one that it leaves there, over `length` [m], the start left out; empty
    /// where it leaves none at a point of it.
    fn way_along_trunk(&self, crack: usize, points: &impl Fn(usize, &Crack) -> Vec<Point>, length: f64) -> Vec<Point> {
        let Some(trunk) = self.fork(crack, End::Start) else { return Vec::new() };
        let of_trunk = points(trunk.crack, &self.0[trunk.crack]);
        let (mut left, mut last) = (length, of_trunk[trunk.from]);
        let mut way: Vec<Point> = Vec::new();
        for k in trunk.points().skip(1) {
            if left <= 0.0 {
                break;
            }
            left -= (of_trunk[k] - last).norm();
            last = of_trunk[k];
            way.push(last);
        }
        way.reverse();
        way
    }

    /// Adds a crack. Returns its number.
    pub(crate) fn add(&mut self, crack: Crack) -> usize {
        self.0.push(crack);
        self.0.len() - 1
    }

    /// Says of all that tips have reached since this was called last that it came about at `time` [s].
    pub(crate) fn date(&mut self, time: f64) {
        self.0.iter_mut().for_each(|crack| crack.date(time));
    }

    /// Makes the end something else.
    pub(crate) fn set_end(&mut self, id: TipId, end: CrackEnd) {
        self.0[id.crack].set_end(id.end, end);
    }

    /// Ends the tip there: the crack number `other` has ended on it, and each goes on as the other.
    pub(crate) fn end_on(&mut self, id: TipId, other: usize) {
        self.set_end(id, CrackEnd::Junction { crack: other as u32 });
        self.0[id.crack].ways[slot(id.end)].target = None;
        if let Some(tip) = self.tip_mut(id) {
            tip.state = TipState::MetCrack;
            tip.is_in_last_ligament = true;
        }
    }

    /// Adds points at the end, for which lines will be cut; an increment that it is on its way through ends where it
    /// is. Returns the length that they add [m].
    pub(crate) fn grow(&mut self, id: TipId, points: &[Point]) -> f64 {
        let crack = &mut self.0[id.crack];
        let before = crack.length();
        crack.ways[slot(id.end)].target = None;
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
/// How far lines go on beyond open ends [m], where pairs reach over `reach` [m]: a line from a particle inside the body
/// to a node outside may pass a mouth by as much as the kernel reaches.
fn beyond(reach: f64) -> f64 {
    2.0 * reach
}
