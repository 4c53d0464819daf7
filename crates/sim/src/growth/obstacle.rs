//! What stands in the way of a tip: the rings of its body and other cracks. A tip ends exactly on them.

use super::Advance;
use crate::crack::Crack;
use fissure_scene::{CrackEnd, End, Point, Region, TipState, orientation, segments_touch};

/// A place where a tip ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Obstacle {
    at: Point,
    end: CrackEnd,
}

impl Obstacle {
    /// The last advance of a tip that is at `from`: through `points` to the obstacle.
    pub(super) fn finish(self, mut points: Vec<Point>, from: Point) -> Advance {
        let last = points.last().copied().unwrap_or(from);
        if (self.at - last).norm() > 0.0 {
            points.push(self.at);
        }
        let state = match self.end {
            CrackEnd::Junction { .. } => TipState::MetCrack,
            _ => TipState::LeftBody,
        };
        Advance { points, end: self.end, state }
    }
}

/// The first ring or crack on the way from `from` to `to`.
pub(super) fn first_obstacle(
    cracks: &[Crack],
    index: usize,
    end: End,
    region: &Region,
    from: Point,
    to: Point,
) -> Option<Obstacle> {
    let mut nearest: Option<(f64, Obstacle)> = None;
    let mut consider = |a: Point, b: Point, what: CrackEnd| {
        if let Some((t, at)) = intersection(from, to, a, b)
            && nearest.is_none_or(|n| t < n.0)
        {
            nearest = Some((t, Obstacle { at, end: what }));
        }
    };
    for ring in region.rings() {
        for i in 0..ring.len() {
            consider(ring[i], ring[(i + 1) % ring.len()], CrackEnd::Mouth);
        }
    }
    for (other, crack) in cracks.iter().enumerate() {
        if crack.body != cracks[index].body {
            continue;
        }
        let n = crack.points.len();
        for k in 1..n {
            // Not the segment the tip itself stands on.
            let own = other == index && if end == End::End { k + 1 == n } else { k == 1 };
            if !own {
                consider(crack.points[k - 1], crack.points[k], CrackEnd::Junction { crack: other as u32 });
            }
        }
    }
    nearest.map(|n| n.1)
}

/// Where the way from `p` to `q` meets the segment `a`–`b`: (fraction of the way, place), the start of the way left out.
fn intersection(p: Point, q: Point, a: Point, b: Point) -> Option<(f64, Point)> {
    if p == q || !segments_touch(p, q, a, b) {
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
    (t > 1e-9).then_some((t, at))
}
