//! Cracks seek what is weak: where toughness varies, a tip takes the direction in which it has the most for what it
//! costs.

use super::criterion::criterion;
use crate::crack::Crack;
use crate::crack::cracks::{Cracks, TipId};
use crate::tip::frame::turned;
use fissure_scene::{Inclusion, Point, Scene, Vector};

/// Directions are looked at up to this many steps to either side of the one the stress asks for ...
const STEPS: i32 = 24;
/// ... each of this size [rad]: 5 degrees.
const STEP: f64 = 0.087_266_462_599_716_47;
/// Cosine of the largest turn from the last segment of a crack: 120 degrees. Beyond it lies, within a cell, what the
/// crack has just come from.
const LARGEST_TURN_COSINE: f64 = -0.5;
/// A direction is judged by the mean toughness over this length, in cells: two particle spacings, of which painted
/// toughness knows one.
const REACH: f64 = 1.0;
/// What is better by less than this part is not better.
const ROUND_OFF: f64 = 1e-9;

/// Whether the toughness of the body of a crack is not the same everywhere.
pub(super) fn is_varied(crack: &Crack, scene: &Scene) -> bool {
    !scene.toughness.is_empty() || !scene.bodies[crack.body as usize].inclusions.is_empty()
}

/// Whether the toughness of the body of a crack is not the same all around a place, as far as ways are judged by it.
fn is_varied_near(crack: &Crack, place: Point, scene: &Scene) -> bool {
    let reach = REACH.max(0.5 * scene.growth.increment) * scene.cell_size * (1.0 + ROUND_OFF);
    let is_near = |inclusion: &Inclusion| inclusion.region.distance_to_rings(place) <= reach;
    !scene.toughness.is_empty() || scene.bodies[crack.body as usize].inclusions.iter().any(is_near)
}

/// Fracture toughness at a place at rest [Pa·√m]: of the material there, as strong as the scene makes it.
pub(super) fn toughness_at(crack: &Crack, place: Point, scene: &Scene) -> f64 {
    let body = &scene.bodies[crack.body as usize];
    scene.materials[body.material_at(place)].fracture_toughness * scene.toughness_factor(crack.body as usize, place)
}

/// The direction (unit vector, at rest) with the highest ratio of hoop stress to toughness, for a tip that the stress
/// opens along `physical`: the one in which growth begins first, as it begins where K_eq reaches the toughness. By the
/// energy that kinks release, the square of cos²(δ/2) for small ones, tips would turn a little farther.
///
/// Of equal ratios the one nearest to `physical` is taken, so that a toughness that is the same all around changes
/// nothing.
pub(super) fn seek(cracks: &Cracks, id: TipId, physical: Vector, scene: &Scene) -> Vector {
    let (crack, from) = (cracks.of(id), cracks.position(id));
    // To measure the way to all interfaces takes as long as to ask for the material at one place.
    if is_varied_near(crack, from, scene) {
        best_way(crack, from, cracks.last_direction(id), physical, scene)
    } else {
        physical
    }
}

/// See [`seek`]: of a tip at `from` that came along `last`, by the toughness in all directions.
fn best_way(crack: &Crack, from: Point, last: Vector, physical: Vector, scene: &Scene) -> Vector {
    let criterion = criterion();
    let ratio = |angle: f64| {
        let along = turned(physical, angle);
        let toughness = |way: f64| toughness_at(crack, from + along * (way * scene.cell_size), scene);
        let ahead = 0.5 * (toughness(0.5 * REACH) + toughness(REACH));
        // No less than what the next increment has to break: at the edge of a tough place that curves away a tip would
        // go where it cannot begin.
        criterion.share_beside(angle) / ahead.max(toughness(0.5 * scene.growth.increment))
    };
    let is_open = |angle: f64| turned(physical, angle).dot(&last) >= LARGEST_TURN_COSINE;
    let angles = (1..=STEPS).map(|step| f64::from(step) * STEP);
    let sides =
        angles.map(|angle| [angle, -angle].map(|angle| (if is_open(angle) { ratio(angle) } else { 0.0 }, angle)));
    let mut sides: Vec<[(f64, f64); 2]> = sides.collect();
    // Where a turn to the left has as much as one to the right, all others of the side decide, and then the stress:
    // mirrored scenes crack alike.
    let (left, right) = sides.iter().fold((0.0, 0.0), |sum, pair| (sum.0 + pair[0].0, sum.1 + pair[1].0));
    let is_even = (left - right).abs() <= ROUND_OFF * (left + right);
    if if is_even { last.perp(&physical) < 0.0 } else { left < right } {
        sides.iter_mut().for_each(|pair| pair.swap(0, 1));
    }
    let mut best = (ratio(0.0), 0.0);
    for found in sides.into_iter().flatten() {
        if found.0 > best.0 * (1.0 + ROUND_OFF) {
            best = found;
        }
    }
    turned(physical, best.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_scenes::{add_crack, free_body, rectangle};
    use fissure_scene::{End, Region};
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    proptest! {
        /// Truth: the search in all directions. A tip near a disc of a tougher or weaker material, inside it, on its
        /// interface and far off goes where that says.
        #[test]
        fn a_tip_far_from_interfaces_goes_where_a_search_would_send_it(
            angle in 0.0..TAU, physical in 0.0..TAU, distance in 0.2_f64..3.0, size in 0.3_f64..4.0, factor in 0.2_f64..5.0,
            increment in 0.1_f64..3.0,
        ) {
            let way = |angle: f64| Vector::new(angle.cos(), angle.sin());
            let mut scene = free_body(rectangle([-9.0, -9.0], [9.0, 9.0]), 0.25);
            scene.growth.increment = increment;
            scene.materials.push(scene.materials[0].clone());
            scene.materials[1].fracture_toughness *= factor;
            add_crack(&mut scene, &[[-1.0, 0.0], [0.0, 0.0]]);
            let middle = Point::origin() + way(angle) * distance * scene.cell_size * size;
            let disc = (0..24).map(|k| middle + way(TAU / 24.0 * f64::from(k)) * scene.cell_size * size).collect();
            let region = Region { exterior: disc, holes: Vec::new() };
            scene.bodies[0].inclusions.push(Inclusion { region, material: 1 });
            let cracks = Cracks::of_scene(&scene);
            let id = TipId { crack: 0, end: End::End };
            let (crack, from, last) = (cracks.of(id), cracks.position(id), cracks.last_direction(id));
            let searched = best_way(crack, from, last, way(physical), &scene);
            prop_assert!((seek(&cracks, id, way(physical), &scene) - searched).norm() == 0.0);
        }
    }
}
