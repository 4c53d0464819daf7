//! What stands in the way of a tip: the rings of its body and other cracks. A tip ends exactly on them.

use super::advance::{Advance, LAST_LIGAMENT};
use crate::crack::Crack;
use crate::crack::cracks::{Cracks, ENDS, TipId};
use crate::crack::crossing::apart;
use fissure_plane::{Point, Region, Vector, nearest_on_segment, orientation, segments_touch};
use fissure_scene::{CrackEnd, End, TipState};

/// Its own crack, the one it branched from and its branches count as beside a tip only this many cells from where they
/// part.
const PARTED: f64 = 8.0;

/// A tip that another one would pass, or leave behind it, by less than this many cells is the place where that one
/// ends, and ends with it: the two cracks become one. What would be left of a crack beyond the other one is none for
/// the grid while its points are hardly a particle apart, and its tip would be looked at across the faces of the
/// other.
const TIP_TO_TIP: f64 = 0.5;

/// What is farther than this many ligaments is farther than one, however the distance is rounded.
const FAR: f64 = 1.001;

/// A place where a tip ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Barrier {
    at: Point,
    end: CrackEnd,
    /// The tip that is there.
    tip: Option<TipId>,
}

impl Barrier {
    /// The last advance of a tip that is at `from`: through `points` to the barrier.
    pub(super) fn finish(self, mut points: Vec<Point>, from: Point) -> Advance {
        let last = points.last().copied().unwrap_or(from);
        if (self.at - last).norm() > 0.0 {
            points.push(self.at);
        }
        let state = match self.end {
            CrackEnd::Junction { .. } => TipState::MetCrack,
            _ => TipState::LeftBody,
        };
        Advance { points, end: self.end, state, is_in_last_ligament: true, meets: self.tip }
    }

    /// The next advance by `step` of a tip at `from` that runs on to the barrier.
    pub(super) fn approach(self, from: Point, step: f64) -> Advance {
        let way = self.at - from;
        let distance = way.norm();
        if distance <= step {
            return self.finish(Vec::new(), from);
        }
        let points = vec![from + way * (step / distance)];
        Advance { points, end: CrackEnd::Tip, state: TipState::Growing, is_in_last_ligament: true, meets: None }
    }

    /// The barrier, or the tip of the crack in the way that is so near that both end there; `from` is where the tip
    /// `id` is, `cell_size` h [m]. A tip that is led by a guide is not stopped by another one.
    pub(super) fn or_tip(self, cracks: &Cracks, id: TipId, region: &Region, from: Point, cell_size: f64) -> Self {
        let CrackEnd::Junction { crack } = self.end else { return self };
        let mut nearest: Option<(f64, Self)> = None;
        for other in ENDS.map(|end| TipId::new(crack as usize, end)) {
            let is_led = cracks.tip(other).is_some_and(|tip| tip.guide.is_some());
            if other == id || is_led || cracks.end(other) != CrackEnd::Tip {
                continue;
            }
            let at = cracks.position(other);
            let distance = (at - self.at).norm();
            let is_near = distance < TIP_TO_TIP * cell_size && nearest.is_none_or(|n| distance < n.0);
            // Nothing else is on the way to it: what ends at the tip, or a hair before it, is its own crack.
            let is_first = |hit: Self| hit.end == self.end && (hit.at - at).norm() < 1e-6 * cell_size;
            if is_near && at != from && first_barrier(cracks, id, region, from, at).is_none_or(is_first) {
                nearest = Some((distance, Self { at, end: self.end, tip: Some(other) }));
            }
        }
        nearest.map_or(self, |n| n.1)
    }
}

/// The first ring or crack on the way from `from` to `to`.
pub(super) fn first_barrier(cracks: &Cracks, id: TipId, region: &Region, from: Point, to: Point) -> Option<Barrier> {
    let mut nearest: Option<(f64, Barrier)> = None;
    let mut consider = |a: Point, b: Point, what: CrackEnd| {
        if let Some((t, at)) = intersection(from, to, a, b)
            && nearest.is_none_or(|n| t < n.0)
        {
            nearest = Some((t, Barrier { at, end: what, tip: None }));
        }
    };
    for ring in region.rings() {
        for i in 0..ring.len() {
            consider(ring[i], ring[(i + 1) % ring.len()], CrackEnd::Mouth);
        }
    }
    let own = cracks.of(id);
    let guide = cracks.tip(id).and_then(|tip| tip.guide.as_ref());
    for (other, crack) in cracks.iter().enumerate() {
        let is_passed = other != id.crack && (own.crosses || guide.is_some_and(|guide| guide.will_join(other)));
        if crack.body != own.body || is_passed || !crack.may_meet(from, to) {
            continue;
        }
        let n = crack.points.len();
        for k in 1..n {
            // Not the segment the tip itself stands on.
            let own = other == id.crack && if id.end == End::End { k + 1 == n } else { k == 1 };
            if !own {
                consider(crack.points[k - 1], crack.points[k], CrackEnd::Junction { crack: other as u32 });
            }
        }
    }
    nearest.map(|n| n.1)
}

/// Whether nothing is on the way from `from`, on the crack of the tip `id`, to `to`, but what begins at `from`.
pub(crate) fn is_free(cracks: &Cracks, id: TipId, region: &Region, from: Point, to: Point) -> bool {
    first_barrier(cracks, id, region, from, to).is_none()
}

/// The place to end for a tip beside another crack, or beside an older part of its own, nearer than a last ligament;
/// none when there is no such crack.
///
/// Two cracks side by side within a cell leave a strip that the grid does not resolve, of fields with next to no mass;
/// a real one breaks.
pub(super) fn beside(cracks: &Cracks, id: TipId, toward: Vector, h: f64) -> Option<Point> {
    let crack = cracks.of(id);
    let from = cracks.position(id);
    let own_tip = cracks.tip(id)?;
    // A branch begins beside its twin.
    let has_parted = own_tip.grown.min(own_tip.since_division) >= PARTED * h;
    let is_twin = |other: usize, line: &Crack| crack.is_joined_to(other) || line.is_joined_to(id.crack);
    let mut nearest: Option<(f64, Point)> = None;
    let around = Vector::repeat(FAR * LAST_LIGAMENT * h);
    // Of two tips side by side only one ends on the other.
    let ended_here = |c: &Crack| {
        let met = |end: End| c.tip(end).is_some_and(|t| t.state == TipState::MetCrack);
        ENDS.into_iter().any(|end| met(end) && c.end(end) == CrackEnd::Junction { crack: id.crack as u32 })
    };
    for (other, line) in cracks.iter().enumerate().filter(|(_, c)| c.body == crack.body && !ended_here(c)) {
        if crack.crosses && other != id.crack || line.least_distance(from) > FAR * LAST_LIGAMENT * h {
            continue;
        }
        if !has_parted && other != id.crack && is_twin(other, line) {
            continue;
        }
        let n = line.points.len();
        let mut behind = 0.0;
        for j in 1..n {
            // From the tip back along the own crack.
            let k = if other == id.crack && id.end == End::End { n - j } else { j };
            let (a, b) = (line.points[k - 1], line.points[k]);
            if other == id.crack && behind < PARTED * h {
                behind += (b - a).norm();
                if behind < PARTED * h {
                    continue;
                }
            }
            // As most are.
            if apart(from - around, from + around, a, b) {
                continue;
            }
            let at = nearest_on_segment(a, b, from);
            let distance = (at - from).norm();
            let is_behind = (at - from).dot(&toward) < -0.5 * distance;
            if distance > 0.0 && !is_behind && distance < LAST_LIGAMENT * h && nearest.is_none_or(|n| distance < n.0) {
                nearest = Some((distance, at));
            }
        }
    }
    nearest.map(|n| n.1)
}

/// Where the way from `p` to `q` meets the segment `a`–`b`: (fraction of the way, place). What it stands on at its
/// start it leaves; that is asked exactly, because it may begin a hair before what is in its way.
fn intersection(p: Point, q: Point, a: Point, b: Point) -> Option<(f64, Point)> {
    if p == q || !segments_touch(p, q, a, b) || segments_touch(p, p, a, b) {
        return None;
    }
    let (at_a, at_b) = (orientation(p, q, a), orientation(p, q, b));
    let span = at_a - at_b;
    let at = if span == 0.0 {
        // Along the same line: the nearer end of the segment.
        if (a - p).norm_squared() < (b - p).norm_squared() { a } else { b }
    } else {
        a + (b - a) * (at_a / span)
    };
    let way = q - p;
    let t = (at - p).dot(&way) / way.norm_squared();
    Some((t, at))
}
