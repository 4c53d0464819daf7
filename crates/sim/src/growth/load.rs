//! What a tip bears, what it could bear, and what growth costs it.

use super::criterion::criterion;
use super::heading::{physical_way, way};
use super::seeking::{is_varied, toughness_at};
use crate::crack::DIRECTION_LENGTH;
use crate::crack::assessment::Assessment;
use crate::crack::cracks::{Cracks, TipId};
use crate::material::elastic::Elastic;
use crate::tip::gauge::Reading;
use fissure_scene::{Scene, Vector};

/// What a reading means for growth: direction and load by the criterion. The toughness is left 0: it is that of what
/// lies ahead, and which way that is [`heading`](super::heading()) may have to say first; see [`toughness_ahead`].
pub(crate) fn assess(reading: &Reading, scene: &Scene) -> Assessment {
    let criterion = criterion();
    let kink_angle = criterion.kink_angle(&reading.decisive, scene.growth.bending);
    Assessment {
        j_integral: reading.j_integral,
        mode_1: reading.modes.mode_1,
        mode_2: reading.modes.mode_2,
        kink_angle,
        equivalent: criterion.equivalent(&reading.decisive, kink_angle),
        released: reading.released,
        fracture_toughness: 0.0,
        contour_radius: reading.contour_radius,
        radius_shrunk: reading.radius_shrunk,
    }
}

/// Whether a tip begins to grow at `time` [s], or jumps on by an increment, given what was measured. `slides`: it can
/// also go a part of an increment.
pub(crate) fn wants_to_grow(
    cracks: &Cracks,
    id: TipId,
    assessed: &Assessment,
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
    let needed = assessed.fracture_toughness;
    equivalent(cracks, id, assessed, scene) >= needed && needed > 0.0
}

/// Fracture toughness of what the next increment would break [Pa·√m]: of what lies in its middle, in the direction the
/// tip takes.
pub(crate) fn toughness_ahead(cracks: &Cracks, id: TipId, assessed: &Assessment, scene: &Scene) -> f64 {
    let half = 0.5 * scene.growth.increment * scene.cell_size;
    toughness_at(cracks.of(id), cracks.position(id) + way(cracks, id, assessed, scene) * half, scene)
}

/// Fracture toughness of all that a tip may break [Pa·√m]; none where it is not the same everywhere.
pub(crate) fn toughness_everywhere(cracks: &Cracks, id: TipId, scene: &Scene) -> Option<f64> {
    let line = cracks.of(id);
    (!is_varied(line, scene)).then(|| toughness_at(line, cracks.position(id), scene))
}

/// K_eq [Pa·√m] for the direction the tip would take: what was measured for the physical direction, times how much less
/// that one gets of it.
fn equivalent(cracks: &Cracks, id: TipId, assessed: &Assessment, scene: &Scene) -> f64 {
    let guide = cracks.tip(id).and_then(|t| t.guide.as_ref());
    let has_guide = guide.is_some_and(|g| g.strength() > 0.0);
    if !has_guide && !is_varied(cracks.of(id), scene) {
        return assessed.equivalent;
    }
    let ahead = cracks.ahead(id, DIRECTION_LENGTH * scene.cell_size);
    let split = crate::StressIntensity { mode_1: assessed.mode_1.max(0.0), mode_2: assessed.mode_2 };
    let along = |toward: Vector| criterion().equivalent(&split, ahead.perp(&toward).atan2(ahead.dot(&toward)));
    let own = along(physical_way(cracks, id, assessed, scene));
    if own > 0.0 { assessed.equivalent * along(way(cracks, id, assessed, scene)) / own } else { 0.0 }
}

/// What a way of a tip costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Cost {
    /// Nothing; a schedule lets the tip go on by so much now [m].
    Scheduled(f64),
    /// Energy per length [J/m²].
    Energy(f64),
}

/// What growth costs a tip. In energy: G_c at least, which is what a kink takes along which the hoop stress is highest,
/// because its own tip opens without shear. A tip that has to go another way is sheared, and at K_eq = K_c there needs
/// more, (K_I² + K_II²)/E'. Where nothing can be measured, close to a ring maybe, it is G_c.
pub(crate) fn cost(
    cracks: &Cracks,
    id: TipId,
    assessed: &Assessment,
    scene: &Scene,
    elastic: &[Elastic],
    time: f64,
) -> Cost {
    let tip = cracks.tip(id);
    if let Some(due) = tip.and_then(|t| t.guide.as_ref()?.due(t.grown, time)) {
        return Cost::Scheduled(due.length);
    }
    let critical = critical_release(cracks, id, assessed, scene, elastic);
    if tip.is_some_and(|t| t.is_in_last_ligament) {
        return Cost::Energy(critical);
    }
    let part = assessed.fracture_toughness / equivalent(cracks, id, assessed, scene);
    // The larger of a NaN and a number is the number.
    Cost::Energy((assessed.released * part * part).max(critical))
}

/// G_c = K_c²/E' of what lies ahead of a tip [J/m²].
pub(crate) fn critical_release(
    cracks: &Cracks,
    id: TipId,
    assessed: &Assessment,
    scene: &Scene,
    elastic: &[Elastic],
) -> f64 {
    let material = scene.bodies[cracks.of(id).body as usize].material_at(cracks.position(id));
    assessed.fracture_toughness * assessed.fracture_toughness / elastic[material].effective_modulus
}
