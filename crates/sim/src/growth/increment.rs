//! The next increment of a tip: along its guide, or the way the stress asks for, or the rest of the way to what is
//! near.

use super::advance::{Advance, LAST_LIGAMENT};
use super::barrier::{Barrier, beside, first_barrier};
use super::heading::way;
use crate::crack::assessment::Assessment;
use crate::crack::cracks::{Cracks, TipId};
use fissure_scene::{CrackEnd, Point, Scene, TipState, Vector};

/// A turn by less than this [rad] is rounding. A crack that rounding turned off an axis of symmetry would pass
/// nodes and particles on it on sides that rounding chooses, and nothing would be symmetric from there on.
const NO_TURN: f64 = 1e-9;

/// The next increment of a tip that wants to grow. `runs`: it is on its way, and needs no integral to go on.
pub(crate) fn next_increment(
    cracks: &Cracks,
    id: TipId,
    assessed: &Assessment,
    scene: &Scene,
    time: f64,
    runs: bool,
) -> Option<Advance> {
    let tip = cracks.tip(id)?;
    let h = scene.cell_size;
    let mut step = scene.growth.increment * h;
    let from = cracks.position(id);
    let region = &scene.bodies[cracks.of(id).body as usize].region;
    // A schedule ends where it says, even within an increment.
    if let Some(due) = tip.guide.as_ref().and_then(|g| g.due(tip.grown, time)).filter(|due| due.is_last) {
        step = step.min(due.length);
    }
    if let Some(guide) = tip.guide.as_ref().filter(|g| g.strength() >= 1.0) {
        // Along the guide, looking a ligament ahead.
        let target = guide.after(guide.here(from), step);
        let pieces = (LAST_LIGAMENT / scene.growth.increment).ceil() as usize;
        let mut points = Vec::new();
        let (mut last, mut next) = (from, target);
        for _ in 0..=pieces {
            if let Some(hit) = first_barrier(cracks, id, region, last, next.at) {
                if runs && !points.is_empty() {
                    return Some(Advance { is_in_last_ligament: true, ..open(vec![target.at], TipState::Growing) });
                }
                return Some(hit.or_tip(cracks, id, region, last, h).finish(points, from));
            }
            points.push(next.at);
            (last, next) = (next.at, guide.after(next, step));
        }
        if (target.at - from).norm() <= 1e-9 * h {
            return Some(open(Vec::new(), TipState::GuideEnded));
        }
        let state = if target.is_end { TipState::GuideEnded } else { TipState::Growing };
        return Some(open(vec![target.at], state));
    }
    let last = cracks.last_direction(id);
    let toward = if tip.is_in_last_ligament { last } else { straight_on(way(cracks, id, assessed, scene), last) };
    let through = |hit: Barrier| {
        let hit = hit.or_tip(cracks, id, region, from, h);
        if runs { hit.approach(from, step) } else { hit.finish(Vec::new(), from) }
    };
    if let Some(hit) = first_barrier(cracks, id, region, from, from + toward * (step + LAST_LIGAMENT * h)) {
        return Some(through(hit));
    }
    if let Some(near) = beside(cracks, id, toward, h)
        && let Some(hit) = first_barrier(cracks, id, region, from, near + (near - from) * 0.01)
    {
        return Some(through(hit));
    }
    Some(open(vec![from + toward * step], TipState::Growing))
}

/// An advance of a tip that has nothing in its way.
fn open(points: Vec<Point>, state: TipState) -> Advance {
    Advance { points, end: CrackEnd::Tip, state, is_in_last_ligament: false, meets: None }
}

/// The direction `toward`, or that of the crack where they differ by rounding.
fn straight_on(toward: Vector, straight: Vector) -> Vector {
    if toward.perp(&straight).atan2(toward.dot(&straight)).abs() < NO_TURN { straight } else { toward }
}
