//! Where a tip wants to go: by the stress, by a drawn path, or by both.

use super::seeking::{is_varied, seek};
use crate::crack::assessment::Assessment;
use crate::crack::cracks::{Cracks, TipId};
use crate::crack::{DIRECTION_LENGTH, KINK};
use crate::material::elastic::Elastic;
use crate::tip::frame::turned;
use fissure_scene::{End, Scene, TipState, Vector};

/// Distance over which the direction of a running tip is averaged, in cells.
const HEADING_CELLS: f64 = 2.0;

/// Lengths that differ by less than this part of them are equal.
const ROUND_OFF: f64 = 1e-9;

/// The direction that the stress asks for now: unit vector, at rest.
fn asked(cracks: &Cracks, id: TipId, assessed: &Assessment, scene: &Scene) -> Vector {
    turned(cracks.ahead(id, DIRECTION_LENGTH * scene.cell_size), assessed.kink_angle)
}

/// The heading of a tip after one more measurement, `time_step` [s] after the last one.
///
/// Every increment sends out waves, and the ratio of the modes swings with them at a period that is the lattice's, not
/// the body's. A running tip follows the mean over the time that a shear wave takes for a few cells; a resting one has
/// no waves of its own and starts as the stress is. Both go straight on from a kink that they have made themselves;
/// where toughness varies, they remember what the stress asked for before it, because it may have been made to avoid
/// what is tough: judged anew from every kink, many small turns would cost next to nothing.
pub(crate) fn heading(
    cracks: &Cracks,
    id: TipId,
    assessed: &Assessment,
    scene: &Scene,
    elastic: &[Elastic],
    time_step: f64,
) -> Vector {
    let now = asked(cracks, id, assessed, scene);
    let Some(tip) = cracks.tip(id) else { return now };
    if tip.heading == Vector::zeros() {
        return now;
    }
    if tip.is_in_last_ligament {
        return cracks.last_direction(id);
    }
    if let Some(direction) = after_kink(cracks, id, DIRECTION_LENGTH * scene.cell_size, tip.grown) {
        return if is_varied(cracks.of(id), scene) { tip.heading } else { direction };
    }
    if tip.state != TipState::Growing {
        return now;
    }
    let slowest = elastic.iter().map(Elastic::shear_wave_speed).fold(f64::INFINITY, f64::min);
    let window = HEADING_CELLS * scene.cell_size / slowest;
    tip.heading + (now - tip.heading) * (1.0 - (-time_step / window).exp())
}

/// Direction of the last segment of a crack with a kink nearer to its tip than `over` [m], of which the tip has made
/// the last `grown` [m] itself: a kink that is drawn says nothing about the way from there.
///
/// What is measured around such a tip is still the field of the crack before the kink, seen along a chord that has
/// turned by a part of it. A crack that follows it turns on: under pure shear from 70 to 92° within the first cell and
/// a half, whatever the size of the cells, before it comes back to 73°.
fn after_kink(cracks: &Cracks, id: TipId, over: f64, grown: f64) -> Option<Vector> {
    let points = &cracks.of(id).points;
    let n = points.len();
    let at = |k: usize| if id.end == End::Start { points[k] } else { points[n - 1 - k] };
    // On its way through an increment the tip may have gone too little of it for a direction.
    let tip = cracks.target(id).unwrap_or(at(0));
    let (mut ahead, mut way) = (tip - at(1), (at(0) - at(1)).norm());
    let direction = ahead.try_normalize(0.0)?;
    for k in 2..n {
        if way >= over || way > grown * (1.0 + ROUND_OFF) {
            return None;
        }
        let segment = at(k - 1) - at(k);
        if segment.perp(&ahead).atan2(segment.dot(&ahead)).abs() > KINK {
            return Some(direction);
        }
        (ahead, way) = (segment, way + segment.norm());
    }
    None
}

/// The direction a tip would take without a guide (unit vector, at rest).
pub(super) fn physical_way(cracks: &Cracks, id: TipId, assessed: &Assessment, scene: &Scene) -> Vector {
    let tip = cracks.tip(id);
    tip.and_then(|t| t.heading.try_normalize(0.0)).unwrap_or_else(|| asked(cracks, id, assessed, scene))
}

/// The direction a tip takes (unit vector, at rest): its heading, turned to what is weak, then towards its guide by the
/// strength of the guide.
pub(super) fn way(cracks: &Cracks, id: TipId, assessed: &Assessment, scene: &Scene) -> Vector {
    let physical = seek(cracks, id, physical_way(cracks, id, assessed, scene), scene);
    let Some(guide) = cracks.tip(id).and_then(|t| t.guide.as_ref()) else { return physical };
    match guide.drawn_direction(cracks.position(id), DIRECTION_LENGTH * scene.cell_size) {
        Some(drawn) => turned(physical, guide.strength() * physical.perp(&drawn).atan2(physical.dot(&drawn))),
        None => physical,
    }
}
