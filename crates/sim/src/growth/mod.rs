//! When and where a crack grows, and how it ends.
//!
//! A tip begins to grow when K_eq in its direction reaches the toughness; K_I and K_II are scaled so that they agree with
//! J. In the total formulation it then slides through its increment as far as the energy it releases pays for, so that
//! its speed follows from the energy balance; in the updated formulation it jumps by whole increments. A limit keeps it
//! below a fraction of c_R. Direction: maximum hoop stress, a guide, or a blend of both; a guide with a schedule also
//! says when. Close to a ring or another crack the tip goes the rest of the way at once and ends exactly there.

mod branching;
mod criterion;
mod heading;
mod obstacle;
mod seeking;
mod speed;

pub(crate) use branching::branches;
pub(crate) use heading::heading;
pub(crate) use seeking::toughness_at;
pub(crate) use speed::speed_limit;

use crate::crack::cracks::{Cracks, TipId};
use crate::crack::{DIRECTION_LENGTH, Measured};
use crate::tip::gauge::Reading;
use fissure_scene::{CrackEnd, Point, Scene, TipState, Vector};
use heading::{physical_way, way};
use obstacle::{beside, first_obstacle};

/// A ligament of less than this many cells breaks at once: no integral can be taken in it.
const LAST_LIGAMENT: f64 = 1.5;

/// What one tip does.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Advance {
    /// New points, in the order they are reached [m].
    pub(crate) points: Vec<Point>,
    /// What the new end is.
    pub(crate) end: CrackEnd,
    /// State of the tip afterwards.
    pub(crate) state: TipState,
}

/// What a reading means for growth: direction and load by the criterion. The toughness is left 0: it is that of what lies ahead, and which way that is
/// [`heading`] may have to say first; see [`toughness_ahead`].
pub(crate) fn judge(reading: &Reading, scene: &Scene) -> Measured {
    let kink_angle = reading.decisive.kink_angle(scene.growth.bending);
    Measured {
        j_integral: reading.j_integral,
        mode_1: reading.modes.mode_1,
        mode_2: reading.modes.mode_2,
        kink_angle,
        equivalent: reading.decisive.equivalent(kink_angle),
        released: reading.released,
        fracture_toughness: 0.0,
        contour_radius: reading.contour_radius,
        radius_shrunk: reading.radius_shrunk,
    }
}

/// Whether a tip grows at `time` [s], given what was measured. `slides`: it can also go a part of an increment.
pub(crate) fn wants_to_grow(
    cracks: &Cracks,
    id: TipId,
    measured: &Measured,
    scene: &Scene,
    time: f64,
    slides: bool,
) -> bool {
    let Some(tip) = cracks.tip(id) else { return false };
    if !scene.growth.enabled || !tip.state.is_live() {
        return false;
    }
    if let Some(due) = tip.guide.as_ref().and_then(|g| g.due(tip.grown, time)) {
        let h = scene.cell_size;
        return due.length >= scene.growth.increment * h || ((due.is_last || slides) && due.length > 1e-9 * h);
    }
    // NaN compares false: nothing known, no growth.
    let needed = measured.fracture_toughness;
    equivalent(cracks, id, measured, scene) >= needed && needed > 0.0
}

/// Fracture toughness of what the next increment would break [Pa·√m]: of what lies in its middle, in the direction the tip takes.
pub(crate) fn toughness_ahead(cracks: &Cracks, id: TipId, measured: &Measured, scene: &Scene) -> f64 {
    let half = 0.5 * scene.growth.increment * scene.cell_size;
    toughness_at(cracks.of(id), cracks.position(id) + way(cracks, id, measured, scene) * half, scene)
}

/// K_eq [Pa·√m] for the direction the tip would take: what was measured for the physical direction, times how much less that one gets of it.
fn equivalent(cracks: &Cracks, id: TipId, measured: &Measured, scene: &Scene) -> f64 {
    let guide = cracks.tip(id).and_then(|t| t.guide.as_ref());
    let has_guide = guide.is_some_and(|g| g.strength() > 0.0);
    if !has_guide && !seeking::is_varied(cracks.of(id), scene) {
        return measured.equivalent;
    }
    let ahead = cracks.ahead(id, DIRECTION_LENGTH * scene.cell_size);
    let split = crate::StressIntensity { mode_1: measured.mode_1.max(0.0), mode_2: measured.mode_2 };
    let along = |toward: Vector| split.equivalent(ahead.perp(&toward).atan2(ahead.dot(&toward)));
    let own = along(physical_way(cracks, id, measured, scene));
    if own > 0.0 { measured.equivalent * along(way(cracks, id, measured, scene)) / own } else { 0.0 }
}

/// What a way of a tip costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Cost {
    /// Nothing; a schedule lets the tip go on by so much now [m].
    Scheduled(f64),
    /// Energy per length [J/m²].
    Energy(f64),
}

/// What growth costs a tip. In energy: of what is released now, the part that is needed. K_eq² goes with the energy that is released, whatever the mode
/// and the direction, so at K_eq = K_c this is all of it, and in mode I it is always K_c²/E'.
pub(crate) fn cost(cracks: &Cracks, id: TipId, measured: &Measured, scene: &Scene, time: f64) -> Cost {
    let tip = cracks.tip(id);
    if let Some(due) = tip.and_then(|t| t.guide.as_ref()?.due(t.grown, time)) {
        return Cost::Scheduled(due.length);
    }
    let part = measured.fracture_toughness / equivalent(cracks, id, measured, scene);
    Cost::Energy(measured.released * part * part)
}

/// The next increment of a tip that wants to grow.
pub(crate) fn advance(cracks: &Cracks, id: TipId, measured: &Measured, scene: &Scene, time: f64) -> Option<Advance> {
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
        let (target, ended) = guide.ahead(step);
        let mut points = vec![target];
        let mut last = from;
        let pieces = (LAST_LIGAMENT / scene.growth.increment).ceil() as usize;
        for piece in 1..=pieces + 1 {
            let (next, _) = guide.ahead(step * piece as f64);
            if let Some(hit) = first_obstacle(cracks, id, region, last, next) {
                points.truncate(0);
                points.extend((1..piece).map(|k| guide.ahead(step * k as f64).0));
                return Some(hit.finish(points, from));
            }
            last = next;
        }
        if (target - from).norm() <= 1e-9 * h {
            return Some(Advance { points: Vec::new(), end: CrackEnd::Tip, state: TipState::GuideEnded });
        }
        points.dedup();
        let state = if ended { TipState::GuideEnded } else { TipState::Growing };
        return Some(Advance { points, end: CrackEnd::Tip, state });
    }
    let toward = way(cracks, id, measured, scene);
    if let Some(hit) = first_obstacle(cracks, id, region, from, from + toward * (step + LAST_LIGAMENT * h)) {
        return Some(hit.finish(Vec::new(), from));
    }
    if let Some(near) = beside(cracks, id, toward, h)
        && let Some(hit) = first_obstacle(cracks, id, region, from, near + (near - from) * 0.01)
    {
        return Some(hit.finish(Vec::new(), from));
    }
    Some(Advance { points: vec![from + toward * step], end: CrackEnd::Tip, state: TipState::Growing })
}
