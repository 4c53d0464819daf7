//! Which velocity field serves a pair of a particle and a node, and with what share.
//!
//! The field of a pair is named by what the straight line between them crosses: nothing → the node's own field;
//! otherwise the set of (crack, side) it crosses (Nairn 2003, generalised from one crack to any number).
//!
//! **At a tip** a hard line-crossing test makes the crack act as if it ended at a node: the effective length jumps as
//! the tip moves. With [`TipDivision::PartlyCut`] the pair is split by the particle's own position instead: the crack
//! is thought to go on straight ahead of the tip, and a pair on opposite sides gives the share b to the far field and 1
//! − b to the node's own, where b falls from 1 to 0 over one particle spacing on either side of the tip (or of a place
//! a little behind it, [`TipCut::behind`]), with a slope that is a hat. A node that lies far enough ahead of the tip is
//! never split ([`TipCut`]). Gradients follow the product rule, ∇(b w) = b ∇w + w ∇b. The jump then ends at the tip.
//! Where ties hold the two sides of a node together until the tip has passed it, nothing is shared: the pair is split
//! as if the crack went on straight ahead.

use crate::crack::changes::{Cause, ChangedSegment, Changes, Touched, touches};
use crate::crack::crossing::{Meeting, Segment, Side, apart, meeting};
use crate::crack::split::{Split, runs_through};
use fissure_plane::{Point, Vector, distance_to_segment};
use fissure_scene::{Kernel, TipDivision};
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use std::ops::Range;

/// What a line crosses: sorted (crack, side of the particle); empty: nothing. Hardly ever more than two.
pub(crate) type CrossedSet = SmallVec<[(u32, Side); 2]>;

/// How far behind the tip, in cells, the crack counts as divided by particle position.
pub(crate) const WINDOW: f64 = 2.0;
/// How far ahead of the tip, in cells, the crack is thought to go on.
const AHEAD: f64 = WINDOW + 2.0;
/// Lengths that differ by more than this, in cells, differ by more than round-off.
const CLEARLY: f64 = 1e-6;

/// Number of the first segment of a crack in the lists of cells, before it has got on at its start, and of the first
/// continuation.
const FIRST_NUMBER: u32 = 1 << 30;
const FIRST_CONTINUATION: u32 = 1 << 31;

/// How pairs around a tip are split with [`TipDivision::PartlyCut`]. Lengths in cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TipCut {
    /// A node farther ahead of the tip than this is never split.
    pub(crate) node_ahead: f64,
    /// How far behind the tip the middle of the ramp lies on which pairs share out.
    pub(crate) behind: f64,
    /// Whether pairs share out: the far field gets b of a pair that lies on opposite sides of the tip's tangent.
    /// Otherwise it gets all, and something else has to hold the two sides together.
    pub(crate) shares: bool,
}

impl TipCut {
    /// Where nothing else is done at the tip. K_I of an edge crack of 8 cells over 80 places of the tip in a cell: −1.7
    /// to +1.7 %, standard deviation 0.9 %.
    pub(crate) const PLAIN: Self = Self { node_ahead: 0.3, behind: 0.0, shares: true };

    /// As [`TipCut::PLAIN`] for a kernel. Quadratic and cubic kernels let the tip act as if it lay farther ahead: K_I
    /// of an edge crack of 6 cells, a/W = 0.4, with the quadratic kernel: +3.5 to +4.9 % with the ramp around the tip
    /// (six places of it in a cell), −2.3 to +1.6 % with it behind (three).
    pub(crate) fn smooth(kernel: Kernel) -> Self {
        match kernel {
            Kernel::Bilinear | Kernel::Gimp => Self::PLAIN,
            Kernel::Quadratic | Kernel::Cubic => Self { behind: 0.15, ..Self::PLAIN },
        }
    }

    /// Where ties hold the two sides of a node together until the tip has passed it.
    pub(crate) fn tied(node_ahead: f64) -> Self {
        Self { node_ahead, behind: 0.0, shares: false }
    }
}

/// One end of a crack line, for the division.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum LineEnd {
    /// A tip inside the material.
    Tip,
    /// Open: at a ring of the body or on another crack. The line goes on for so far beyond it [m], so that
    /// lines to nodes outside the body are cut as well.
    Open(f64),
    /// On another crack. The line goes on for so far beyond it [m], for pairs only that cross the other crack as well:
    /// material on the far side of the other crack stays whole, but the fields of the two corners on this side stay
    /// apart.
    Junction {
        /// The crack it ends on.
        crack: u32,
        /// Length of the continuation [m].
        beyond: f64,
    },
}

/// A crack as the division sees it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CrackLine {
    /// Index of the crack.
    pub(crate) crack: u32,
    /// Points from start to end [m], in the configuration in which particles and nodes are given.
    pub(crate) points: Vec<Point>,
    /// First point.
    pub(crate) start: LineEnd,
    /// Last point.
    pub(crate) end: LineEnd,
    /// Where it leaves another crack at a point of that one: the way of the other one to there, that point left out
    /// [m]. Empty: it leaves none so. See [`SegmentKind::AlongTrunk`].
    pub(crate) trunk: Vec<Point>,
}

/// A pair's share in one field.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Share {
    /// The field.
    pub(crate) crossed: CrossedSet,
    /// Fraction of the weight, 0 to 1.
    pub(crate) fraction: f64,
    /// ∇ of the fraction with respect to the particle's position [1/m].
    pub(crate) gradient: Vector,
}

/// The shares of a pair: hardly ever more than two.
pub(crate) type Shares = SmallVec<[Share; 2]>;

/// A tip, and the way that it is thought to go on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TipRay {
    position: Point,
    ahead: Vector,
}

/// What tips make of boxes that reach over a particle and all its nodes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ahead {
    cut: TipCut,
    cell_size: f64,
}

impl Ahead {
    /// How far the corners of a box lie ahead of a tip and beside it, least and most [cells].
    fn extent(&self, tip: &TipRay, low: Point, high: Point) -> [[f64; 2]; 2] {
        let corners = [low, Point::new(high.x, low.y), high, Point::new(low.x, high.y)];
        let mut extent = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for arm in corners.map(|corner| (corner - tip.position) / self.cell_size) {
            for (range, x) in extent.iter_mut().zip([arm.dot(&tip.ahead), arm.perp(&tip.ahead)]) {
                *range = [range[0].min(x), range[1].max(x)];
            }
        }
        extent
    }

    /// How far ahead of a tip any place of a box lies at most [cells].
    pub(crate) fn most_ahead(&self, tip: &TipRay, low: Point, high: Point) -> f64 {
        let (middle, half) = (nalgebra::center(&low, &high), (high - low) * 0.5);
        ((middle - tip.position).dot(&tip.ahead) + half.dot(&tip.ahead.abs())) / self.cell_size
    }

    /// Whether no node of a box of which no place lies farther than `most` cells ahead of a tip lies so far ahead of it
    /// that what passes the crack on its way there is whole.
    pub(crate) fn is_behind(&self, most: f64) -> bool {
        !self.cut.shares && most < self.cut.node_ahead - CLEARLY
    }

    /// As [`Ahead::is_behind`], whether all of the box, and with it all that its pairs can meet of what is drawn ahead
    /// of the tip, lies behind the tip.
    pub(crate) fn is_wholly_behind(&self, most: f64) -> bool {
        !self.cut.shares && most < -CLEARLY
    }

    /// Whether a tip divides no pair of a box by the way that it is thought to go on: all nodes lie too far ahead, or
    /// all particles out of its reach.
    fn is_idle(&self, tip: &TipRay, low: Point, high: Point) -> bool {
        let [along, beside] = self.extent(tip, low, high);
        along[0] > self.cut.node_ahead + CLEARLY
            || along[1] < -WINDOW - CLEARLY
            || along[0] > AHEAD + CLEARLY
            || beside[1] < -WINDOW - CLEARLY
            || beside[0] > WINDOW + CLEARLY
    }
}

#[derive(Debug, Clone, PartialEq)]
struct Line {
    crack: u32,
    segments: Vec<(Point, Point)>,
    tips: Vec<TipRay>,
    cut: TipCut,
    kinds: Vec<SegmentKind>,
    /// Segment of the crack that each prepared one is, or carries on.
    of: Vec<u32>,
    /// The last segment of the crack.
    last: u32,
    /// Number of the first one in the lists of cells: see [`Line::index`].
    first_number: u32,
    /// Whether each is so near to a tip that the tip says how it divides: see [`divide`].
    at_tip: Vec<bool>,
    /// Whether it has a continuation beyond a junction.
    has_junction: bool,
    /// Within so far of its start, along each axis [m], nodes count as around it: farther away none sees both the trunk
    /// and what it goes on as, unless across the branch.
    around_start: f64,
}

impl Line {
    /// Where the segment with a number in the lists of cells is. Those of the crack itself keep their numbers where it
    /// gets on at its start; continuations have theirs behind them.
    #[inline]
    fn index(&self, number: u32) -> usize {
        match number.checked_sub(FIRST_CONTINUATION) {
            Some(further) => self.last as usize + 1 + further as usize,
            None => (number - self.first_number) as usize,
        }
    }

    /// The number of a segment in the lists of cells.
    fn number(&self, index: usize) -> u32 {
        match (index as u32).checked_sub(self.last + 1) {
            Some(further) => FIRST_CONTINUATION + further,
            None => self.first_number + index as u32,
        }
    }

    /// The segments of the crack itself that it had `before`, for which what they are compared by is `same`, and by how
    /// much they have moved up since: the longest stretch of those that begin at an end or hold the middle.
    fn kept(&self, before: &Self, same: impl Fn(usize, usize) -> bool) -> (Range<usize>, i64) {
        let [now, was] = [self, before].map(|line| line.last as usize + 1);
        let middle = was / 2;
        // A crack has got new points at its ends, if any: what is between stays.
        let added =
            (0..=now.saturating_sub(was)).find(|&k| self.segments[middle.min(now - 1) + k] == before.segments[middle]);
        let moved = [Some((0, 0)), Some((was - 1, now as i64 - was as i64)), added.map(|k| (middle, k as i64))];
        let mut longest = (0..0, 0);
        for (from, by) in moved.into_iter().flatten() {
            if by == longest.1 && longest.0.contains(&from) {
                continue;
            }
            let is_kept = |&k: &usize| usize::try_from(k as i64 + by).is_ok_and(|at| at < now && same(at, k));
            let below = (0..from).rev().take_while(is_kept).count();
            let above = (from..was).take_while(is_kept).count();
            if above > 0 && below + above >= longest.0.len() {
                longest = (from - below..from + above, by);
            }
        }
        longest
    }

    /// The segments that divide, or divided `before`, as they do not at the other of the two moments; `line`, `tips`:
    /// the number of this line, and that of its tips.
    fn changed_segments(&self, (line, tips): (u32, u32), before: Option<&Self>, cell_size: f64) -> Vec<ChangedSegment> {
        let changed = |of: &Self, k: usize, cause: Cause| {
            let (a, b) = of.segments[k];
            ChangedSegment { a, b, cause, line, tips }
        };
        let Some(before) = before.filter(|before| before.cut == self.cut && before.crack == self.crack) else {
            let all = before.into_iter().chain([self]);
            return all.flat_map(|of| (0..of.segments.len()).map(|k| changed(of, k, Cause::Itself))).collect();
        };
        let (stayed, by) = self.kept(before, |now, was| self.part(now) == before.part(was));
        let stays = (stayed.start as i64 + by) as usize..(stayed.end as i64 + by) as usize;
        // What is drawn ahead of a tip, or carried on beyond a junction, is no segment of a crack itself.
        let has = |line: &Self, part: ((Point, Point), SegmentKind, bool)| {
            let first = if part.1 == SegmentKind::Real { 0 } else { line.last as usize + 1 };
            (first..line.segments.len()).any(|k| line.part(k) == part)
        };
        // What a tip that has moved says of segments near to it.
        let has_moved = |tip: &&TipRay| !(self.tips.contains(tip) && before.tips.contains(tip));
        let moved: Vec<Point> =
            self.tips.iter().chain(&before.tips).filter(has_moved).map(|tip| tip.position).collect();
        let is_near = |line: &Self, k: usize| {
            let (a, b) = line.segments[k];
            let reach = 2.0 * AHEAD * cell_size;
            line.at_tip[k] && moved.iter().any(|&tip| distance_to_segment(tip, a, b) < reach)
        };
        let mut segments = Vec::new();
        for (of, other, stays) in [(self, before, &stays), (before, self, &stayed)] {
            let count = of.last as usize + 1;
            let is_new = |k: usize| if k < count { !stays.contains(&k) } else { !has(other, of.part(k)) };
            // A tip that gets on no longer says how the segments divide that it leaves behind.
            let has_stayed = |k: usize| {
                let by = if std::ptr::eq(of, self) { -by } else { by };
                let before = usize::try_from(k as i64 + by).ok().filter(|&k| k <= other.last as usize);
                k < count && before.is_some_and(|k_before| of.segments[k] == other.segments[k_before])
            };
            let cause = |k: usize| match (is_new(k), of.kinds[k]) {
                (true, SegmentKind::AheadOfTip) => Some(Cause::DrawnAhead),
                (true, SegmentKind::Real) if has_stayed(k) => Some(Cause::FarFromItsTip),
                (true, _) => Some(Cause::Itself),
                (false, _) => is_near(of, k).then_some(Cause::ItsTip),
            };
            segments.extend((0..of.segments.len()).filter_map(|k| Some(changed(of, k, cause(k)?))));
        }
        segments
    }

    /// Of each segment beyond those of the crack itself, whether it is where it was `before`.
    fn same_continuations(&self, before: &Self) -> SmallVec<[bool; 4]> {
        let [now, was] = [self, before].map(|line| &line.segments[line.last as usize + 1..]);
        now.iter().zip(was).map(|(now, was)| now == was).collect()
    }

    /// The segments of the crack itself that are not in `kept`, and those beyond it that are not the `same`.
    fn others<'a>(&'a self, kept: Range<usize>, same: &'a [bool]) -> impl Iterator<Item = usize> + use<'a> {
        let count = self.last as usize + 1;
        let is_same = move |k: usize| same.get(k - count).copied().unwrap_or_default();
        let own = (0..kept.start).chain(kept.end..count);
        own.chain((count..self.segments.len()).filter(move |&k| !is_same(k)))
    }

    /// All that a segment divides by.
    fn part(&self, k: usize) -> ((Point, Point), SegmentKind, bool) {
        (self.segments[k], self.kinds[k], self.at_tip[k])
    }

    /// What the way from `particle` to `node` meets of those of its `segments` whose kind `counts`.
    fn meeting(
        &self,
        segments: &[Listed],
        particle: Point,
        node: Point,
        counts: impl Fn(SegmentKind) -> bool,
    ) -> Meeting {
        let numbered = segments.iter().map(|s| (self.index(s.segment), s));
        let near = numbered.filter(|(index, s)| !s.is_apart(particle, node) && counts(self.kinds[*index]));
        meeting(particle, node, near.map(|(index, s)| Segment { number: index as u32, a: s.a, b: s.b }))
    }
}

/// A segment in the list of a cell. Most ways are far from most segments of their cell; with its ends in the list that
/// is seen without a look at its line.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Listed {
    line: u32,
    /// Its number, by which lists rise: see [`Line::index`].
    segment: u32,
    a: Point,
    b: Point,
}

impl Listed {
    /// Lists rise by this.
    fn key(&self) -> (u32, u32) {
        (self.line, self.segment)
    }

    /// Whether the way from `particle` to `node` cannot meet it.
    #[inline]
    fn is_apart(&self, particle: Point, node: Point) -> bool {
        apart(particle, node, self.a, self.b)
    }
}

/// What a segment of a prepared line stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
enum SegmentKind {
    /// The crack itself, or its continuation outside the body.
    Real,
    /// Drawn ahead of a tip for [`TipDivision::PartlyCut`]; not a crack by itself.
    AheadOfTip,
    /// Continuation beyond a junction with the crack named; counts for pairs that cross that one.
    BeyondJunction(u32),
    /// Along the crack that it leaves, to the point where it does; counts for nodes around that point.
    ///
    /// Three cracks that end in a point part what is around it in three, and of two of the three a node is told from
    /// which side they are crossed: the trunk with what it goes on as, and the trunk with the branch. Mirrored branches
    /// part alike, whichever of them goes on.
    AlongTrunk,
}

/// The cracks of a scene, ready to divide pairs.
#[derive(Debug, Clone)]
pub(crate) struct Division {
    /// The cracks as they were given.
    given: Vec<CrackLine>,
    lines: Vec<Line>,
    tip_division: TipDivision,
    cut: TipCut,
    cell_size: f64,
    particle_spacing: f64,
    /// How far from its segments a crack may divide pairs, along each axis [cells].
    reach: f64,
    /// Line and segment by cell, rising. Cells come from the scene, not from a stranger, so the hash need not be a
    /// strong one.
    buckets: FxHashMap<(i64, i64), Vec<Listed>>,
    has_junctions: bool,
}

impl Division {
    /// Prepares `lines` for pairs that lie at most `reach` cells apart along each axis.
    pub(crate) fn new(
        lines: Vec<CrackLine>,
        tip_division: TipDivision,
        cut: TipCut,
        cell_size: f64,
        particle_spacing: f64,
        reach: f64,
    ) -> Self {
        let mut division = Self {
            given: Vec::new(),
            lines: Vec::new(),
            tip_division,
            cut,
            cell_size,
            particle_spacing,
            reach,
            buckets: FxHashMap::default(),
            has_junctions: false,
        };
        division.set_lines(lines);
        division
    }

    /// Puts `lines` in the place of those before: see [`Division::follow`].
    pub(crate) fn set_lines(&mut self, lines: Vec<CrackLine>) -> Changes {
        let mut lines: Vec<Option<CrackLine>> = lines.into_iter().map(Some).collect();
        self.follow(lines.len(), |index, before| lines[index].take().filter(|line| before != Some(line)))
    }

    /// Follows cracks, of which there are `count` now: `changed` gives the line of each by its number and what it was
    /// before, or none where it is as it was. The cost is that of what has changed: of a crack that has grown, that of
    /// its new segments. Returns what has changed.
    pub(crate) fn follow(
        &mut self,
        count: usize,
        mut changed: impl FnMut(usize, Option<&CrackLine>) -> Option<CrackLine>,
    ) -> Changes {
        let (mut boxes, mut changed_segments, mut tips) = (Vec::new(), Vec::new(), vec![SmallVec::new()]);
        for index in count..self.lines.len() {
            for &(a, b) in &self.lines[index].segments {
                self.add_box((a, b), &mut boxes);
                changed_segments.push(ChangedSegment { a, b, cause: Cause::Itself, line: index as u32, tips: 0 });
            }
            self.take_out(index, 0..0, &[]);
        }
        self.lines.truncate(count);
        self.given.truncate(count);
        for index in 0..count {
            let Some(given) = changed(index, self.given.get(index)) else { continue };
            let mut line = prepare(&given, self.tip_division, self.cut, self.cell_size, self.reach);
            let numbers = (index as u32, tips.len() as u32);
            let segments = line.changed_segments(numbers, self.lines.get(index), self.cell_size);
            segments.iter().for_each(|s| self.add_box((s.a, s.b), &mut boxes));
            changed_segments.extend(segments);
            tips.push(self.lines.get(index).into_iter().chain([&line]).flat_map(|line| &line.tips).copied().collect());
            if index < self.lines.len() {
                let before = &self.lines[index];
                let (kept, by) = line.kept(before, |now, was| line.segments[now] == before.segments[was]);
                line.first_number = (i64::from(before.first_number) - by) as u32;
                let kept_now = (kept.start as i64 + by) as usize..(kept.end as i64 + by) as usize;
                let same = line.same_continuations(before);
                self.take_out(index, kept, &same);
                self.lines[index] = line;
                self.given[index] = given;
                self.put_in(index, kept_now, &same);
            } else {
                self.lines.push(line);
                self.given.push(given);
                self.put_in(index, 0..0, &[]);
            }
        }
        self.has_junctions = self.lines.iter().any(|l| l.has_junction);
        Changes::new(boxes, changed_segments, tips)
    }

    /// A particle at another `point` with the same key, and with the same nodes, is told the same by
    /// [`Division::may_have_changed`].
    pub(crate) fn key(&self, point: Point) -> (i64, i64) {
        ((point.x / self.cell_size).floor() as i64, (point.y / self.cell_size).floor() as i64)
    }

    /// Whether a pair of a particle at `point` and a node may be divided otherwise than before `changes`, both of them
    /// in the box from `low` to `high`.
    pub(crate) fn may_have_changed(&self, changes: &Changes, point: Point, low: Point, high: Point) -> bool {
        let ahead = self.ahead();
        match changes.touched(low, high, ahead) {
            Touched::Nothing => false,
            Touched::Something => true,
            // Where there is nothing else, all was whole and is.
            Touched::DrawnAhead(line, tips) => {
                !changes.tips(tips).iter().all(|tip| ahead.is_idle(tip, low, high))
                    || self.bucket(point).iter().any(|s| {
                        let is_ahead = s.line == line && self.kind(s) == SegmentKind::AheadOfTip;
                        !is_ahead && touches(low, high, s.a, s.b)
                    })
            }
        }
    }

    fn ahead(&self) -> Ahead {
        Ahead { cut: self.cut, cell_size: self.cell_size }
    }

    fn kind(&self, listed: &Listed) -> SegmentKind {
        let line = &self.lines[listed.line as usize];
        line.kinds[line.index(listed.segment)]
    }

    /// Adds the box of the cells in which a segment may divide pairs; boxes that touch become one.
    fn add_box(&self, segment: (Point, Point), boxes: &mut Vec<(Point, Point)>) {
        let [low, high] = self.range_of(segment);
        let corner = |[i, j]: [i64; 2]| Point::new(i as f64, j as f64) * self.cell_size;
        let mut whole = (corner(low), corner(high.map(|last| last + 1)));
        while let Some(k) = boxes.iter().position(|(low, high)| whole.0 <= *high && *low <= whole.1) {
            let (low, high) = boxes.swap_remove(k);
            whole = (whole.0.inf(&low), whole.1.sup(&high));
        }
        boxes.push(whole);
    }

    /// Cells in which a segment may divide pairs.
    fn cells_of(&self, segment: (Point, Point)) -> impl Iterator<Item = (i64, i64)> + use<> {
        let [low, high] = self.range_of(segment);
        (low[1]..=high[1]).flat_map(move |j| (low[0]..=high[0]).map(move |i| (i, j)))
    }

    /// The first and the last of those cells, along both axes.
    fn range_of(&self, (a, b): (Point, Point)) -> [[i64; 2]; 2] {
        let low = a.inf(&b).coords / self.cell_size - Vector::repeat(self.reach);
        let high = a.sup(&b).coords / self.cell_size + Vector::repeat(self.reach);
        [low, high].map(|corner| [corner.x.floor() as i64, corner.y.floor() as i64])
    }

    /// Puts the segments of a line but those in `kept` into the buckets, of what carries it on what is not the `same`.
    fn put_in(&mut self, line: usize, kept: Range<usize>, same: &[bool]) {
        let of = &self.lines[line];
        for index in of.others(kept, same) {
            let (a, b) = of.segments[index];
            let listed = Listed { line: line as u32, segment: of.number(index), a, b };
            for cell in self.cells_of((a, b)) {
                let bucket = self.buckets.entry(cell).or_default();
                bucket.insert(bucket.partition_point(|other| other.key() < listed.key()), listed);
            }
        }
    }

    /// As [`Division::put_in`], takes them out.
    fn take_out(&mut self, line: usize, kept: Range<usize>, same: &[bool]) {
        let of = &self.lines[line];
        for index in of.others(kept, same) {
            let key = (line as u32, of.number(index));
            for cell in self.cells_of(of.segments[index]) {
                let Some(bucket) = self.buckets.get_mut(&cell) else { continue };
                if let Ok(at) = bucket.binary_search_by_key(&key, Listed::key) {
                    bucket.remove(at);
                }
                if bucket.is_empty() {
                    self.buckets.remove(&cell);
                }
            }
        }
    }

    fn bucket(&self, point: Point) -> &[Listed] {
        self.buckets.get(&self.key(point)).map_or(&[], Vec::as_slice)
    }

    /// Distance within which [`Division::segments_around`] misses nothing when it looks at so many cells `beside` that
    /// of a point [m].
    pub(crate) fn surroundings(&self, beside: u8) -> f64 {
        (self.reach + f64::from(beside)) * self.cell_size
    }

    /// Within so far of a place where a crack leaves another one, along each axis [m], the two sides of the other one
    /// differ by both.
    pub(crate) fn around_fork(&self) -> f64 {
        around_fork(self.reach, self.cell_size)
    }

    /// Segments of a crack around `point`, rising: all within [`Division::surroundings`], some beside, and always the
    /// first and the last one, whose ends may have moved on since the division was made. `beside`: how many cells to
    /// each side are looked at.
    pub(crate) fn segments_around(&self, crack: u32, point: Point, beside: u8) -> SmallVec<[usize; 32]> {
        let mut segments = SmallVec::new();
        let Some(index) = self.line_of(crack) else { return segments };
        let line = &self.lines[index];
        segments.push(0);
        let cells = -i32::from(beside)..=i32::from(beside);
        for (i, j) in cells.clone().flat_map(|i| cells.clone().map(move |j| (i, j))) {
            let bucket = self.bucket(point + Vector::new(f64::from(i), f64::from(j)) * self.cell_size);
            let first = bucket.partition_point(|s| (s.line as usize) < index);
            let own = bucket[first..].iter().take_while(|s| s.line as usize == index);
            segments.extend(own.map(|s| line.of[line.index(s.segment)] as usize));
        }
        segments.push(line.last as usize);
        // Those of one cell rise, but for continuations.
        if !segments.is_sorted() {
            segments.sort_unstable();
        }
        segments.dedup();
        segments
    }

    /// Number of the line of a crack.
    fn line_of(&self, crack: u32) -> Option<usize> {
        // Where all cracks are given, they have the numbers of their lines.
        let own = crack as usize;
        let is_own = self.lines.get(own).is_some_and(|line| line.crack == crack);
        if is_own { Some(own) } else { self.lines.iter().position(|line| line.crack == crack) }
    }

    /// Whether a particle at `point` may have a divided pair at all.
    pub(crate) fn is_near(&self, point: Point) -> bool {
        !self.bucket(point).is_empty()
    }

    /// Cells of the lattice ⌊x/h⌋ around the origin in which [`Division::is_near`] holds, in no order.
    pub(crate) fn near_cells(&self) -> impl Iterator<Item = (i64, i64)> {
        self.buckets.keys().copied()
    }

    /// Whether a crack may divide the pair of a particle at `point` and any node of the box from `low` to `high`, which
    /// holds the particle. When it says no, no pair is divided.
    pub(crate) fn may_divide(&self, point: Point, low: Point, high: Point) -> bool {
        self.bucket(point).iter().any(|s| touches(low, high, s.a, s.b))
    }

    /// Whether a crack may part a particle at `point` from a node, both of them in the box from `low` to `high`, or run
    /// through the material there. What is only drawn ahead of a tip, and farther ahead than the tip parts anything,
    /// does not.
    pub(crate) fn may_part(&self, point: Point, low: Point, high: Point) -> bool {
        let ahead = self.ahead();
        let mut drawn_ahead = None;
        for s in self.bucket(point).iter().filter(|s| touches(low, high, s.a, s.b)) {
            if self.kind(s) != SegmentKind::AheadOfTip || drawn_ahead.is_some_and(|line| line != s.line) {
                return true;
            }
            drawn_ahead = Some(s.line);
        }
        drawn_ahead.is_some_and(|line| {
            let tips = &self.lines[line as usize].tips;
            !tips.iter().all(|tip| ahead.is_idle(tip, low, high))
        })
    }

    /// Calls `visit` with (crack, segment of it) for every segment that the line from `particle` to `node` crosses; a
    /// continuation counts as the segment it carries on.
    pub(crate) fn for_each_crossed(&self, particle: Point, node: Point, mut visit: impl FnMut(u32, usize)) {
        for segments in self.bucket(particle).chunk_by(|s, t| s.line == t.line) {
            let line = &self.lines[segments[0].line as usize];
            for segment in line.meeting(segments, particle, node, |kind| kind != SegmentKind::AlongTrunk).crossed {
                visit(line.crack, line.of[segment as usize] as usize);
            }
        }
    }

    /// How the square around `center`, `half` [m] to each side, is split by the only crack that runs through it of
    /// those that `counts`; none where there is none, or several. Of what is drawn ahead of several tips it is the
    /// nearest tip's: between tips that face each other both are there.
    pub(crate) fn split_square(&self, center: Point, half: f64, counts: impl Fn(u32) -> bool) -> Option<Split> {
        let is_part = |line: &Line, s: &Listed| {
            matches!(line.kinds[line.index(s.segment)], SegmentKind::Real | SegmentKind::AheadOfTip)
                && runs_through(center, half, (s.a, s.b))
        };
        let mut chosen: Option<(f64, Vec<(Point, Point)>)> = None;
        for of_line in self.bucket(center).chunk_by(|s, t| s.line == t.line) {
            let line = &self.lines[of_line[0].line as usize];
            let part = of_line.iter().filter(|s| is_part(line, s));
            let within: Vec<usize> = part.map(|s| line.index(s.segment)).collect();
            if within.is_empty() || !counts(line.crack) {
                continue;
            }
            let is_real = within.iter().any(|&k| line.kinds[k] == SegmentKind::Real);
            let to_tip = |tip: &TipRay| (tip.position - center).norm();
            let distance = if is_real { 0.0 } else { line.tips.iter().map(to_tip).fold(f64::INFINITY, f64::min) };
            match &chosen {
                Some((nearest, _)) if is_real || *nearest == 0.0 => return None,
                Some((nearest, _)) if *nearest <= distance => {}
                _ => chosen = Some((distance, within.iter().map(|&k| line.segments[k]).collect())),
            }
        }
        Split::of_square(center, half, &chosen?.1)
    }

    /// What the line from `particle` to `node` crosses.
    pub(crate) fn crossed(&self, particle: Point, node: Point) -> CrossedSet {
        if !self.is_near(particle) {
            return CrossedSet::new();
        }
        self.shares(particle, node, 0.0)
            .into_iter()
            .max_by(|a, b| a.fraction.total_cmp(&b.fraction))
            .map_or_else(CrossedSet::new, |s| s.crossed)
    }

    /// The shares of the pair (`particle`, `node`) in the fields of the node; fractions add up to 1. Never empty.
    pub(crate) fn pair(&self, particle: Point, node: Point) -> Shares {
        self.shares(particle, node, self.particle_spacing)
    }

    /// What may divide the pairs of a particle at `particle` and nodes within the box from `low` to `high`.
    pub(crate) fn around(&self, particle: Point, low: Point, high: Point) -> Around<'_> {
        let (low, high) = (low.inf(&particle), high.sup(&particle));
        let bucket = self.bucket(particle).iter();
        Around { division: self, particle, segments: bucket.filter(|s| !s.is_apart(low, high)).copied().collect() }
    }

    /// Whether any of `segments` is the continuation of a crack beyond the one that it ends on.
    fn has_continuation(&self, segments: &[Listed]) -> bool {
        let is_continuation = |s: &Listed| {
            let line = &self.lines[s.line as usize];
            matches!(line.kinds[line.index(s.segment)], SegmentKind::BeyondJunction(_))
        };
        segments.iter().any(is_continuation)
    }

    fn shares(&self, particle: Point, node: Point, domain: f64) -> Shares {
        self.shares_across(self.bucket(particle), particle, node, domain)
    }

    /// As [`Division::shares`], `bucket` being the segments that the way may meet.
    fn shares_across(&self, bucket: &[Listed], particle: Point, node: Point, domain: f64) -> Shares {
        let mut shares = Shares::new();
        shares.push(Share { crossed: CrossedSet::new(), fraction: 1.0, gradient: Vector::zeros() });
        let near: SmallVec<[Listed; 8]> = bucket.iter().filter(|s| !s.is_apart(particle, node)).copied().collect();
        // So it is with most pairs.
        if near.is_empty() {
            return shares;
        }
        let cut = |segments: &[Listed], crossed: &[u32]| {
            let line = &self.lines[segments[0].line as usize];
            divide(line, segments, particle, node, self.cell_size, domain, crossed)
        };
        let of_lines = || near.chunk_by(|s, t| s.line == t.line);
        let mut found: SmallVec<[(u32, Option<PairCut>); 8]> =
            of_lines().map(|segments| (segments[0].line, cut(segments, &[]))).collect();
        // A continuation beyond a junction counts where the pair crosses the other crack itself, whatever the numbers
        // of both are.
        if self.has_junctions {
            let crossed: SmallVec<[u32; 8]> =
                found.iter().filter(|of| of.1.is_some()).map(|of| self.lines[of.0 as usize].crack).collect();
            for (of, segments) in found.iter_mut().zip(of_lines()) {
                if !crossed.is_empty() && self.has_continuation(segments) {
                    of.1 = cut(segments, &crossed);
                }
            }
        }
        for (line, cut) in found {
            if let Some(cut) = cut {
                shares = split(shares, self.lines[line as usize].crack, cut);
            }
        }
        shares
    }
}

/// What may divide the pairs of one particle: see [`Division::around`]. A particle has many pairs, and of the segments
/// in its cell most are far from all of them.
#[derive(Debug)]
pub(crate) struct Around<'a> {
    division: &'a Division,
    particle: Point,
    segments: SmallVec<[Listed; 16]>,
}

impl Around<'_> {
    /// The shares of the pair of the particle and `node`: see [`Division::pair`].
    pub(crate) fn pair(&self, node: Point) -> Shares {
        self.division.shares_across(&self.segments, self.particle, node, self.division.particle_spacing)
    }

    /// Whether any of it is the continuation of a crack beyond the one that it ends on.
    pub(crate) fn is_beyond_junction(&self) -> bool {
        self.division.has_continuation(&self.segments)
    }
}

/// Splits every share by one more crack.
fn split(shares: Shares, crack: u32, cut: PairCut) -> Shares {
    let mut result = Shares::new();
    for share in shares {
        let mut far = share.clone();
        far.crossed.push((crack, cut.side));
        far.crossed.sort_unstable();
        far.gradient = share.gradient * cut.fraction + cut.gradient * share.fraction;
        far.fraction *= cut.fraction;
        if cut.fraction < 1.0 {
            let gradient = share.gradient * (1.0 - cut.fraction) - cut.gradient * share.fraction;
            result.push(Share { fraction: share.fraction * (1.0 - cut.fraction), gradient, ..share });
        }
        result.push(far);
    }
    result
}

fn prepare(line: &CrackLine, tip_division: TipDivision, cut: TipCut, cell_size: f64, reach: f64) -> Line {
    let p = &line.points;
    let n = p.len();
    let ahead_of_end = (p[n - 1] - p[n - 2]).normalize();
    let ahead_of_start = (p[0] - p[1]).normalize();
    // With room for what carries on.
    let all = n + 1 + line.trunk.len();
    let mut segments: Vec<(Point, Point)> = Vec::with_capacity(all);
    segments.extend(p.windows(2).map(|w| (w[0], w[1])));
    let mut kinds = Vec::with_capacity(all);
    kinds.resize(n - 1, SegmentKind::Real);
    let mut tips = Vec::new();
    let mut carry_on = |end: LineEnd, from: Point, ahead: Vector| {
        let (length, kind) = match end {
            LineEnd::Open(beyond) => (beyond, SegmentKind::Real),
            LineEnd::Junction { crack, beyond } => (beyond, SegmentKind::BeyondJunction(crack)),
            LineEnd::Tip if tip_division == TipDivision::PartlyCut => {
                tips.push(TipRay { position: from, ahead });
                (AHEAD * cell_size, SegmentKind::AheadOfTip)
            }
            LineEnd::Tip => return None,
        };
        (length > 0.0).then(|| {
            kinds.push(kind);
            from + ahead * length
        })
    };
    // All segments run from the start to the end of the crack, so that a line through a vertex is crossed just once.
    let mut of: Vec<u32> = Vec::with_capacity(all);
    of.extend(0..segments.len() as u32);
    if let Some(point) = carry_on(line.end, p[n - 1], ahead_of_end) {
        segments.push((p[n - 1], point));
        of.push(n as u32 - 2);
    }
    if line.trunk.is_empty() {
        if let Some(point) = carry_on(line.start, p[0], ahead_of_start) {
            segments.push((point, p[0]));
            of.push(0);
        }
    } else {
        let along: Vec<Point> = line.trunk.iter().copied().chain([p[0]]).collect();
        for w in along.windows(2) {
            segments.push((w[0], w[1]));
            kinds.push(SegmentKind::AlongTrunk);
            of.push(0);
        }
    }
    let has_junction = kinds.iter().any(|k| matches!(k, SegmentKind::BeyondJunction(_)));
    let of_line = near_tips(line, WINDOW * cell_size);
    let at_tip = of.iter().zip(&kinds).map(|(&of, &kind)| kind == SegmentKind::AlongTrunk || of_line[of as usize]);
    let at_tip = at_tip.collect();
    let around_start = around_fork(reach, cell_size);
    let last = n as u32 - 2;
    let first_number = FIRST_NUMBER;
    Line { crack: line.crack, segments, tips, cut, kinds, of, last, first_number, at_tip, has_junction, around_start }
}

fn around_fork(reach: f64, cell_size: f64) -> f64 {
    2.0 * reach * cell_size
}

/// Of each segment of a crack, whether its way to a tip along the crack is less than `within` [m].
fn near_tips(line: &CrackLine, within: f64) -> Vec<bool> {
    let n = line.points.len() - 1;
    let mut near = vec![false; n];
    for (end, is_last) in [(line.start, false), (line.end, true)] {
        let mut way = 0.0;
        for j in (0..n).take_while(|_| end == LineEnd::Tip) {
            if way >= within {
                break;
            }
            let k = if is_last { n - 1 - j } else { j };
            near[k] = true;
            way += (line.points[k + 1] - line.points[k]).norm();
        }
    }
    near
}

/// The crack across which two fields face each other, and the side of the first; none when they differ by more than one
/// crack.
pub(crate) fn facing(first: &[(u32, Side)], second: &[(u32, Side)]) -> Option<(u32, Side)> {
    let only_first: Vec<_> = first.iter().filter(|x| !second.contains(x)).collect();
    let only_second: Vec<_> = second.iter().filter(|x| !first.contains(x)).collect();
    match (only_first.as_slice(), only_second.as_slice()) {
        ([x], []) => Some(**x),
        ([], [y]) => Some((y.0, y.1.opposite())),
        ([x], [y]) if x.0 == y.0 => Some(**x),
        _ => None,
    }
}

/// How one crack divides a pair.
#[derive(Debug, Clone, Copy)]
struct PairCut {
    /// Side of the crack the particle is on.
    side: Side,
    /// Share of the far field, above 0 and up to 1.
    fraction: f64,
    /// ∇ of the fraction [1/m].
    gradient: Vector,
}

/// The share b at a distance `behind` its middle, and its slope: the integral of a hat of half width `width` (0: a
/// step). Particles stand `width` apart, so their samples of the slope always add up to the same, and each changes
/// continuously as the tip moves.
fn ramp(behind: f64, width: f64) -> (f64, f64) {
    if width <= 0.0 {
        return (f64::from(behind >= 0.0), 0.0);
    }
    let t = (behind / width).clamp(-1.0, 1.0);
    let left = 1.0 - t.abs();
    let beyond = 0.5 * left * left;
    (if t < 0.0 { beyond } else { 1.0 - beyond }, left / width)
}

/// How `line` divides a pair; none when the pair is whole. `crossed` are the other cracks that the pair crosses.
///
/// What a tip has left behind divides wholly, wherever the tip has gone from there: a crack may turn until a part of it
/// lies ahead of its tip.
fn divide(
    line: &Line,
    segments: &[Listed],
    particle: Point,
    node: Point,
    cell_size: f64,
    domain: f64,
    crossed: &[u32],
) -> Option<PairCut> {
    let counts = |kind: SegmentKind| match kind {
        SegmentKind::BeyondJunction(other) => crossed.contains(&other),
        SegmentKind::AlongTrunk => (node - line.segments[0].0).amax() <= line.around_start,
        SegmentKind::Real | SegmentKind::AheadOfTip => true,
    };
    let met = line.meeting(segments, particle, node, counts);
    let whole = |side: Side| PairCut { side, fraction: 1.0, gradient: Vector::zeros() };
    if met.crossed.iter().any(|&segment| !line.at_tip[segment as usize]) {
        let real = |kind: SegmentKind| kind != SegmentKind::AheadOfTip && counts(kind);
        return line.meeting(segments, particle, node, real).side.map(whole);
    }
    let side = met.side?;
    let crosses_real = met.crossed.iter().any(|&segment| line.kinds[segment as usize] != SegmentKind::AheadOfTip);
    for tip in &line.tips {
        let behind = -(particle - tip.position).dot(&tip.ahead);
        let beside = (particle - tip.position).perp(&tip.ahead).abs();
        if behind > WINDOW * cell_size || behind < -AHEAD * cell_size || beside > WINDOW * cell_size {
            continue;
        }
        if (node - tip.position).dot(&tip.ahead) > line.cut.node_ahead * cell_size {
            return None;
        }
        // A domain of no size asks for the side, not for a share.
        if domain > 0.0 && !line.cut.shares {
            return Some(whole(side));
        }
        let (fraction, slope) = ramp(behind - line.cut.behind * cell_size, domain);
        if fraction == 0.0 {
            return None;
        }
        let gradient = -tip.ahead * slope;
        return Some(PairCut { side, fraction, gradient });
    }
    crosses_real.then_some(whole(side))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SPACING: f64 = 0.5;

    fn any_point() -> impl Strategy<Value = Point> {
        (0.0_f64..12.0, 0.0_f64..12.0).prop_map(|(x, y)| Point::new(x, y))
    }

    /// Lines of 2 to 5 points in a square of 12 cells of size 1, with tips or open ends.
    fn any_lines(ends: impl Strategy<Value = LineEnd> + Clone) -> impl Strategy<Value = Vec<CrackLine>> {
        let line = (prop::collection::vec(any_point(), 2..6), ends.clone(), ends);
        prop::collection::vec(line, 1..4).prop_map(|lines| {
            let number = |(crack, (points, start, end))| CrackLine {
                crack: crack as u32,
                points,
                start,
                end,
                trunk: Vec::new(),
            };
            lines.into_iter().enumerate().map(number).collect()
        })
    }

    /// A particle and a node within the reach of a bilinear kernel.
    fn any_pair() -> impl Strategy<Value = (Point, Point)> {
        (any_point(), -1.0_f64..1.0, -1.0_f64..1.0).prop_map(|(p, x, y)| (p, p + Vector::new(x, y)))
    }

    fn division(lines: &[CrackLine], tips: TipDivision, cut: TipCut) -> Division {
        Division::new(lines.to_vec(), tips, cut, 1.0, SPACING, 1.5)
    }

    fn any_cut() -> impl Strategy<Value = TipCut> {
        prop_oneof![Just(TipCut::PLAIN), Just(TipCut::tied(0.8))]
    }

    proptest! {
        /// Truth: a division made at once. Cracks come, grow at both ends, turn and go. What lies outside the boxes
        /// that are told is divided as before.
        #[test]
        fn lines_put_in_the_place_of_others_divide_as_if_they_were_the_first(
            rounds in prop::collection::vec(
                any_lines(prop_oneof![Just(LineEnd::Tip), Just(LineEnd::Open(1.0))]), 1..5,
            ),
            grown in prop::collection::vec((0_usize..4, any::<bool>(), any_point()), 0..12), cut in any_cut(),
            pairs in prop::collection::vec(any_pair(), 60),
        ) {
            let mut changed = division(&[], TipDivision::PartlyCut, cut);
            let mut lines = Vec::new();
            let grow = |lines: &mut Vec<CrackLine>, (line, at_end, point): (usize, bool, Point)| {
                let Some(line) = lines.get_mut(line) else { return };
                line.points.insert(if at_end { line.points.len() } else { 0 }, point);
            };
            for given in rounds {
                lines = given;
                changed.set_lines(lines.clone());
            }
            for by in grown.chunks(2) {
                by.iter().for_each(|&by| grow(&mut lines, by));
                let before = changed.clone();
                let changes = changed.set_lines(lines.clone());
                let is_outside = |p: Point| changes.boxes.iter().all(|(low, high)| !(p >= *low && p <= *high));
                for &(particle, node) in pairs.iter().filter(|pair| is_outside(pair.0)) {
                    prop_assert_eq!(before.pair(particle, node), changed.pair(particle, node));
                }
                for &(particle, node) in &pairs {
                    let (low, high) = (particle.inf(&node), particle.sup(&node));
                    if !changed.may_have_changed(&changes, particle, low, high) {
                        prop_assert_eq!(before.pair(particle, node), changed.pair(particle, node));
                    }
                }
                for &(particle, node) in &pairs {
                    let around = changed.around(particle, node, node);
                    prop_assert_eq!(around.pair(node), changed.pair(particle, node));
                }
                let fresh = division(&lines, TipDivision::PartlyCut, cut);
                let [changed, fresh] = [&changed, &fresh].map(|of| {
                    // Numbers depend on how a crack came to be where it is; what they stand for does not.
                    let mut of = of.clone();
                    for listed in of.buckets.values_mut().flatten() {
                        listed.segment = of.lines[listed.line as usize].index(listed.segment) as u32;
                    }
                    of.lines.iter_mut().for_each(|line| line.first_number = 0);
                    of
                });
                prop_assert_eq!(&changed.lines, &fresh.lines);
                prop_assert_eq!(&changed.buckets, &fresh.buckets);
            }
        }

        /// Truth: the construction. Where a crack gets on at both its ends at once, what is far from both stays.
        #[test]
        fn a_crack_that_grows_at_both_ends_changes_only_around_them(
            height in 1.0_f64..11.0, turns in prop::collection::vec(-0.3_f64..0.3, 2..6), cut in any_cut(),
        ) {
            let points = (0..=60).map(|k| Point::new(f64::from(k), height + 0.1 * f64::from(k % 2))).collect();
            let tip = LineEnd::Tip;
            let mut lines = vec![CrackLine { crack: 0, points, start: tip, end: tip, trunk: Vec::new() }];
            let mut division = division(&lines, TipDivision::PartlyCut, cut);
            for (k, turn) in turns.into_iter().enumerate() {
                let [start, end] = [-0.3, 60.3].map(|x| Point::new(x, height + turn));
                let by = Vector::new(0.3 * k as f64, 0.0);
                lines[0].points.insert(0, start - by);
                lines[0].points.push(end + by);
                let boxes = division.set_lines(lines.clone()).boxes;
                prop_assert!(boxes.iter().all(|(low, high)| high.x < 20.0 || low.x > 40.0), "{boxes:?}");
            }
        }

        /// Truth: all pairs around two tips that get on by small increments, asked before and after. Whatever is
        /// divided otherwise lies in cells that are told, and these are few.
        #[test]
        fn of_the_cells_around_a_tip_few_are_told_to_have_changed(
            (x, y) in (5.0_f64..6.0, 5.0_f64..6.0), length in 0.1_f64..6.0, (angle, toward) in (0.0_f64..6.3, 0.0_f64..6.3),
            distance in 1.0_f64..8.0, turns in prop::collection::vec((-0.6_f64..0.6, -0.1_f64..0.1), 1..12),
        ) {
            let way = |angle: f64, length: f64| Vector::new(angle.cos(), angle.sin()) * length;
            let start = Point::new(x, y);
            let other = start + way(toward, distance);
            let line = |crack, points| CrackLine { crack, points, start: LineEnd::Tip, end: LineEnd::Tip, trunk: Vec::new() };
            let points = [vec![start, start + way(angle, length)], vec![other, other + way(toward + 1.0, 3.0)]];
            let mut lines: Vec<CrackLine> = (0..).zip(points).map(|(crack, points)| line(crack, points)).collect();
            let mut division = division(&lines, TipDivision::PartlyCut, TipCut::tied(0.735));
            let mut headings = [angle, toward + 1.0];
            for (sharp, slight) in turns {
                for (line, heading) in lines.iter_mut().zip(&mut headings) {
                    *heading += if heading.sin() > 0.7 { sharp } else { slight };
                    line.points.push(line.points[line.points.len() - 1] + way(*heading, 0.125));
                }
                let before = division.clone();
                let changes = division.set_lines(lines.clone());
                let (mut told, mut parting) = (0, 0);
                for (i, j) in (0..400).map(|k| (k % 20 - 4, k / 20 - 4)) {
                    let low = Point::new(f64::from(i), f64::from(j));
                    let high = low + Vector::repeat(1.0);
                    let parts = division.may_part(low + Vector::repeat(0.5), low, high);
                    parting += i32::from(parts);
                    if division.may_have_changed(&changes, low + Vector::repeat(0.5), low, high) {
                        told += 1;
                        continue;
                    }
                    for particle in [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]].map(|[x, y]| low + Vector::new(x, y)) {
                        for node in [low, high, Point::new(low.x, high.y), Point::new(high.x, low.y)] {
                            let shares = division.pair(particle, node);
                            prop_assert!(parts || shares[0].crossed.is_empty(), "{shares:?}");
                            prop_assert_eq!(before.pair(particle, node), shares);
                        }
                    }
                }
                prop_assert!(told <= 40 && parting >= told / 2 && parting <= 80, "{told} {parting}");
            }
        }

        /// Truth: the same cracks under other numbers. Which of two cracks that end on others, or on each other, comes
        /// first says nothing of what they part.
        #[test]
        fn the_numbers_of_cracks_do_not_matter(
            lines in any_lines(prop_oneof![
                Just(LineEnd::Tip), Just(LineEnd::Open(1.0)),
                (0_u32..3).prop_map(|crack| LineEnd::Junction { crack, beyond: 1.0 }),
            ]),
            cut in any_cut(), pairs in prop::collection::vec(any_pair(), 60),
        ) {
            let last = lines.len() as u32 - 1;
            let turned = |crack: u32| last.saturating_sub(crack);
            let end = |end: LineEnd| match end {
                LineEnd::Junction { crack, beyond } if crack <= last => LineEnd::Junction { crack: turned(crack), beyond },
                other => other,
            };
            // Close together, so that pairs cross several.
            let near = |p: Point| Point::from(p.coords * 0.2);
            let mut lines = lines;
            lines.iter_mut().flat_map(|line| &mut line.points).for_each(|p| *p = near(*p));
            let mut others: Vec<CrackLine> = lines.clone();
            for line in &mut others {
                (line.crack, line.start, line.end) = (turned(line.crack), end(line.start), end(line.end));
            }
            others.reverse();
            let [first, second] = [&lines, &others].map(|lines| division(lines, TipDivision::PartlyCut, cut));
            for (particle, node) in pairs {
                let node = near(particle) + (node - particle);
                let particle = near(particle);
                let shares = first.pair(particle, node);
                let of_others = second.pair(particle, node);
                prop_assert_eq!(shares.len(), of_others.len());
                for share in shares {
                    let mut crossed: CrossedSet = share.crossed.iter().map(|&(k, side)| (turned(k), side)).collect();
                    crossed.sort_unstable();
                    let same = of_others.iter().find(|other| other.crossed == crossed);
                    prop_assert!(same.is_some_and(|same| (same.fraction - share.fraction).abs() < 1e-12), "{crossed:?}");
                }
            }
        }

        /// Truth: a partition of unity. The shares of a pair add up to one, their gradients to zero, none is negative,
        /// and no two are of one field.
        #[test]
        fn the_shares_of_a_pair_are_a_partition_of_unity(
            lines in any_lines(prop_oneof![Just(LineEnd::Tip), Just(LineEnd::Open(1.0))]), cut in any_cut(),
            (particle, node) in any_pair(),
        ) {
            let shares = division(&lines, TipDivision::PartlyCut, cut).pair(particle, node);
            let sum: f64 = shares.iter().map(|s| s.fraction).sum();
            let gradient: Vector = shares.iter().map(|s| s.gradient).sum();
            prop_assert!((sum - 1.0).abs() < 1e-14 && gradient.norm() < 1e-13, "{shares:?}");
            prop_assert!(shares.iter().all(|s| s.fraction > 0.0));
            let mut fields: Vec<_> = shares.iter().map(|s| &s.crossed).collect();
            fields.sort();
            fields.dedup();
            prop_assert_eq!(fields.len(), shares.len());
        }

        /// Truth: the construction. A crack that lies straight ahead of its own tip, farther than anything is thought
        /// of there, divides as if it had no tip.
        #[test]
        fn a_tip_changes_nothing_far_ahead_of_it(
            points in prop::collection::vec(any_point(), 4..8), cut in any_cut(),
            pairs in prop::collection::vec((AHEAD..12.0, -2.0_f64..2.0, -1.0_f64..1.0, -1.0_f64..1.0), 200),
        ) {
            let line = |end| CrackLine { crack: 0, points: points.clone(), start: LineEnd::Open(0.0), end, trunk: Vec::new() };
            let of = |end| division(&[line(end)], TipDivision::PartlyCut, cut);
            let (with_tip, without) = (of(LineEnd::Tip), of(LineEnd::Open(0.0)));
            let [.., before, tip] = points[..] else { return Ok(()) };
            let ahead = (tip - before).normalize();
            for (along, beside, x, y) in pairs {
                // A pair reaches over 1.5 cells.
                let particle = tip + ahead * (along + 1.5) + Vector::new(-ahead.y, ahead.x) * beside;
                let node = particle + Vector::new(x, y);
                prop_assert_eq!(with_tip.pair(particle, node), without.pair(particle, node));
            }
        }

        /// Truth: every segment of every crack asked in turn. The cells find what a search without them finds.
        #[test]
        fn what_is_crossed_is_what_all_segments_say(
            lines in any_lines(Just(LineEnd::Tip)), (particle, node) in any_pair(),
        ) {
            let mut expected = CrossedSet::new();
            for line in &lines {
                let numbered = line.points.windows(2).enumerate();
                let all = numbered.map(|(k, w)| Segment { number: k as u32, a: w[0], b: w[1] });
                expected.extend(meeting(particle, node, all).side.map(|side| (line.crack, side)));
            }
            let found = division(&lines, TipDivision::LineCrossing, TipCut::PLAIN).crossed(particle, node);
            prop_assert_eq!(found, expected);
        }

        /// Truth: the pairs themselves. Where a box is said to be whole, no pair of a particle and a node in it is cut.
        #[test]
        fn a_box_that_is_whole_has_no_divided_pair(
            lines in any_lines(prop_oneof![Just(LineEnd::Tip), Just(LineEnd::Open(1.0))]), cut in any_cut(),
            particle in any_point(), nodes in prop::collection::vec((-1.0_f64..1.0, -1.0_f64..1.0), 1..8),
        ) {
            let division = division(&lines, TipDivision::PartlyCut, cut);
            let (low, high) = (particle - Vector::repeat(1.0), particle + Vector::repeat(1.0));
            if !division.may_divide(particle, low, high) || !division.may_part(particle, low, high) {
                for (x, y) in nodes {
                    let shares = division.pair(particle, particle + Vector::new(x, y));
                    prop_assert!(shares.len() == 1 && shares[0].crossed.is_empty(), "{shares:?}");
                }
            }
        }

        /// Truth: the sectors of the drawing. Around the point where a crack divides, a node has a field for each
        /// of the three sectors and no more, wherever the point lies and whichever way round it is drawn.
        #[test]
        fn a_division_parts_what_is_around_it_in_three(
            x in 6.0_f64..7.0, y in 6.0_f64..7.0, turn in 0.0_f64..6.3, spread in 0.2_f64..1.0, level in any::<bool>(),
        ) {
            // Level: along a row of nodes, with nodes and particles on the axis of symmetry.
            let (x, y, turn) = if level { (x, 6.0, 0.0) } else { (x, y, turn) };
            let placed = |angle: f64, r: f64| {
                let (sine, cosine) = (turn + angle).sin_cos();
                Point::new(x + r * cosine, y + r * sine)
            };
            let from = |angle: f64| move |k: i32| placed(angle, 0.25 * f64::from(k));
            let half = std::f64::consts::PI;
            let behind: Vec<Point> = if level { (1..=24).rev().map(|k| Point::new(x - 0.25 * f64::from(k), y)).collect() }
                else { (1..=24).rev().map(from(half)).collect() };
            let at = Point::new(x, y);
            let points: Vec<Point> = behind.iter().copied().chain([at]).chain((1..=20).map(from(spread))).collect();
            let branch: Vec<Point> = [at].into_iter().chain((1..=20).map(from(-spread))).collect();
            let trunk = CrackLine { crack: 0, points, start: LineEnd::Open(1.0), end: LineEnd::Tip, trunk: Vec::new() };
            let start = LineEnd::Junction { crack: 0, beyond: 2.0 };
            let branch = CrackLine { crack: 1, points: branch, start, end: LineEnd::Tip, trunk: behind[4..].to_vec() };
            let division = Division::new(vec![trunk, branch], TipDivision::PartlyCut, TipCut::tied(0.8), 1.0, SPACING, 1.0);
            let sector = |p: Point| {
                let angle = (p - at).y.atan2((p - at).x) - turn;
                let angle = angle.sin().atan2(angle.cos());
                // Above, between, below.
                if angle > spread { 0 } else if angle < -spread { 2 } else { 1 }
            };
            for (i, j) in (3..11).flat_map(|i| (3..11).map(move |j| (i, j))) {
                let node = Point::new(f64::from(i), f64::from(j));
                let mut fields: Vec<(CrossedSet, i32)> = Vec::new();
                for (k, l) in (-2..2).flat_map(|k| (-2..2).map(move |l| (k, l))) {
                    let particle = node + Vector::new(0.25 + 0.5 * f64::from(k), 0.25 + 0.5 * f64::from(l));
                    if (particle - at).norm() > 2.0 {
                        continue;
                    }
                    let shares = division.pair(particle, node);
                    prop_assert_eq!(shares.len(), 1);
                    fields.push((shares[0].crossed.clone(), sector(particle)));
                }
                for (a, b) in fields.iter().flat_map(|a| fields.iter().map(move |b| (a, b))) {
                    prop_assert_eq!(a.0 == b.0, a.1 == b.1, "node {} {:?} {:?}", node, a, b);
                }
            }
        }

        /// Truth: the difference quotient. How a share changes as its particle moves along the tip.
        #[test]
        fn the_gradient_of_a_share_is_its_slope(
            ahead in -0.9 * SPACING..0.9 * SPACING, beside in 0.05_f64..0.4, turn in 0.0_f64..6.3,
        ) {
            // Away from the kinks of the ramp, at its ends and in its middle.
            prop_assume!(ahead.abs() > 1e-3);
            let rotation = nalgebra::Rotation2::new(turn);
            let placed = |x: f64, y: f64| Point::new(5.0, 5.0) + rotation * Vector::new(x, y);
            let points = vec![placed(-4.0, 0.0), placed(0.0, 0.0)];
            let line = CrackLine { crack: 0, points, start: LineEnd::Tip, end: LineEnd::Tip, trunk: Vec::new() };
            let division = division(&[line], TipDivision::PartlyCut, TipCut::PLAIN);
            let node = placed(-0.5, -0.3);
            let far = |x: f64, y: f64| {
                let shares = division.pair(placed(x, y), node);
                let far = shares.into_iter().find(|s| !s.crossed.is_empty());
                far.map_or((0.0, Vector::zeros()), |s| (s.fraction, s.gradient))
            };
            let step = 1e-6;
            let along = (far(ahead + step, beside).0 - far(ahead - step, beside).0) / (2.0 * step);
            let across = (far(ahead, beside + step).0 - far(ahead, beside - step).0) / (2.0 * step);
            let expected = rotation * Vector::new(along, across);
            let (fraction, gradient) = far(ahead, beside);
            prop_assert!(fraction > 0.0 && fraction < 1.0, "{fraction}");
            prop_assert!((gradient - expected).norm() < 1e-8, "{gradient} {expected}");
        }
    }
}
