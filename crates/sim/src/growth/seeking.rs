//! Cracks seek what is weak: where toughness varies, a tip takes the direction in which it has the most for what it
//! costs.

use super::criterion::criterion;
use crate::crack::Crack;
use crate::crack::cracks::{Cracks, TipId};
use crate::tip::frame::turned;
use fissure_scene::{Point, Scene, Vector};

/// Directions are looked at up to this many steps to either side of the one the stress asks for ...
const STEPS: i32 = 12;
/// ... each of this size [rad]: 5 degrees.
const STEP: f64 = 0.087_266_462_599_716_47;
/// A direction is judged by the mean toughness over this length, in cells: two particle spacings, of which painted
/// toughness knows one.
const REACH: f64 = 1.0;

/// Whether the toughness of the body of a crack is not the same everywhere.
pub(super) fn is_varied(crack: &Crack, scene: &Scene) -> bool {
    !scene.toughness.is_empty() || !scene.bodies[crack.body as usize].inclusions.is_empty()
}

/// Fracture toughness at a place at rest [Pa·√m]: of the material there, as strong as the scene makes it.
pub(super) fn toughness_at(crack: &Crack, place: Point, scene: &Scene) -> f64 {
    let body = &scene.bodies[crack.body as usize];
    scene.materials[body.material_at(place)].fracture_toughness * scene.toughness_factor(crack.body as usize, place)
}

/// The direction (unit vector, at rest) with the highest ratio of hoop stress to toughness, for a tip that the stress
/// opens along `physical`.
///
/// Of equal ratios the one nearest to `physical` is taken, so that a toughness that is the same all around changes
/// nothing.
pub(super) fn seek(cracks: &Cracks, id: TipId, physical: Vector, scene: &Scene) -> Vector {
    let crack = cracks.of(id);
    if !is_varied(crack, scene) {
        return physical;
    }
    let from = cracks.position(id);
    let criterion = criterion();
    let ratio = |angle: f64| {
        let along = turned(physical, angle) * (REACH * scene.cell_size);
        let toughness = toughness_at(crack, from + 0.5 * along, scene) + toughness_at(crack, from + along, scene);
        criterion.share_beside(angle) / toughness
    };
    let mut best = (ratio(0.0), 0.0);
    for step in 1..=STEPS {
        for angle in [f64::from(step) * STEP, f64::from(-step) * STEP] {
            let found = ratio(angle);
            // Better by more than round-off: mirrored scenes crack alike.
            if found > best.0 * (1.0 + 1e-9) {
                best = (found, angle);
            }
        }
    }
    turned(physical, best.1)
}
