//! Where a division is another one than before: which pairs of a particle and a node it may divide otherwise.
//!
//! A tip that gets on by a quarter of a cell changes the way it is drawn to go on over four cells ahead and what it
//! says of two cells behind it; of all pairs there those of some three cells are divided otherwise.

use super::crossing::apart;
use super::division::{Ahead, TipRay};
use fissure_plane::{Point, orientation};
use smallvec::SmallVec;

/// Why a segment may divide otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Cause {
    /// It has come or gone, or is of another kind.
    Itself,
    /// It has come or gone, drawn ahead of a tip: what lies farther ahead is whole with it and without it.
    DrawnAhead,
    /// It has stayed; the tip that says how it divides has moved.
    ItsTip,
    /// It has stayed; the tip no longer says how it divides, or does now.
    FarFromItsTip,
}

/// A segment that divides, or divided before, as it does not at the other of the two moments.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ChangedSegment {
    pub(crate) a: Point,
    pub(crate) b: Point,
    pub(crate) cause: Cause,
    /// Number of its line, and of the tips that this had and has: see [`Changes::tips`].
    pub(crate) line: u32,
    pub(crate) tips: u32,
}

/// What of a division has changed.
#[derive(Debug, Clone, Default)]
pub(crate) struct Changes {
    /// Boxes, from low to high corner [m], outside which particles are divided as they were; none touches another.
    pub(crate) boxes: Vec<(Point, Point)>,
    /// What has changed within each.
    segments: Vec<Vec<ChangedSegment>>,
    /// The tips of lines that have changed, before and after.
    tips: Vec<SmallVec<[TipRay; 4]>>,
}

/// What a box holds of what has changed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Touched {
    /// Nothing that can divide otherwise.
    Nothing,
    /// What is drawn ahead of a tip of one line, and nothing else that has changed: the numbers of the line and of its
    /// tips.
    DrawnAhead(u32, u32),
    Something,
}

impl Changes {
    /// Of `segments` within `boxes` that hold one each at least, and the `tips` that they tell of.
    pub(crate) fn new(
        boxes: Vec<(Point, Point)>,
        segments: Vec<ChangedSegment>,
        tips: Vec<SmallVec<[TipRay; 4]>>,
    ) -> Self {
        let mut within = vec![Vec::new(); boxes.len()];
        for s in segments {
            let holds = |(low, high): &(Point, Point)| s.a >= *low && s.a <= *high;
            boxes.iter().position(holds).into_iter().for_each(|k| within[k].push(s));
        }
        Self { boxes, segments: within, tips }
    }

    /// What the box from `low` to `high` holds, which reaches over a particle and all its nodes.
    pub(crate) fn touched(&self, low: Point, high: Point, ahead: Ahead) -> Touched {
        let mut found = Touched::Nothing;
        let is_there = |b: &(Point, Point)| b.0 <= high && low <= b.1;
        let there = self.boxes.iter().zip(&self.segments).filter(|of| is_there(of.0));
        // Of the tips that were asked about last, how far ahead of any of them the box reaches.
        let mut known: Option<(u32, f64)> = None;
        let mut most_ahead = |tips: u32| match known.filter(|known| known.0 == tips) {
            Some((_, most)) => most,
            None => {
                let of_tip = |tip: &TipRay| ahead.most_ahead(tip, low, high);
                let most = self.tips(tips).iter().map(of_tip).fold(f64::NEG_INFINITY, f64::max);
                known = Some((tips, most));
                most
            }
        };
        for s in there.flat_map(|of| of.1).filter(|s| !apart(low, high, s.a, s.b)) {
            let stays = match s.cause {
                Cause::Itself | Cause::DrawnAhead => false,
                Cause::FarFromItsTip => ahead.is_wholly_behind(most_ahead(s.tips)),
                Cause::ItsTip => ahead.is_behind(most_ahead(s.tips)),
            };
            let now = match s.cause {
                _ if stays => Touched::Nothing,
                Cause::DrawnAhead => Touched::DrawnAhead(s.line, s.tips),
                _ => Touched::Something,
            };
            if now == Touched::Nothing || now == found || !touches(low, high, s.a, s.b) {
                continue;
            }
            if found != Touched::Nothing || now == Touched::Something {
                return Touched::Something;
            }
            found = now;
        }
        found
    }

    /// The tips of a line, before and after, by their number.
    pub(crate) fn tips(&self, number: u32) -> &[TipRay] {
        &self.tips[number as usize]
    }
}

/// Whether a segment has a point in common with the box from `low` to `high`, its border included.
pub(crate) fn touches(low: Point, high: Point, a: Point, b: Point) -> bool {
    if apart(low, high, a, b) {
        return false;
    }
    let corners = [low, Point::new(high.x, low.y), high, Point::new(low.x, high.y)];
    let mut sides = corners.into_iter().map(|corner| orientation(a, b, corner));
    let Some(first) = sides.next() else { return true };
    !(if first > 0.0 { sides.all(|s| s > 0.0) } else { first < 0.0 && sides.all(|s| s < 0.0) })
}
