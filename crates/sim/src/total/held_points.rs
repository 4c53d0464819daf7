//! Supports smaller than a cell, in which no node lies: points whose velocity is held.

use super::lattice::Lattice;
use crate::boundary::edges::EdgeMean;
use fissure_plane::{Point, Vector};
use fissure_scene::{Scene, Selection};
use std::collections::BTreeMap;

/// Places of a body that are held as one: the mean of their velocities.
#[derive(Debug)]
pub(super) struct HeldPoint {
    body: u32,
    /// At rest [m], each with a place a hair into the material.
    places: Vec<[Point; 2]>,
}

impl HeldPoint {
    /// The points that a selection means: the material nearest to each of its points, if that is within their radius,
    /// or what of the corners of a region lies in a body.
    pub(super) fn of(scene: &Scene, selection: &Selection) -> Vec<Self> {
        match selection {
            Selection::Near { points, radius } => {
                let of_point = |&point: &Point| {
                    let in_body = |body: usize| Some((body, place_in(scene, body, point, *radius)?));
                    let nearest = (0..scene.bodies.len()).filter_map(in_body).min_by(|a, b| {
                        let [a, b] = [a, b].map(|(_, [place, _])| (place - point).norm());
                        a.total_cmp(&b)
                    });
                    nearest.map(|(body, place)| Self { body: body as u32, places: vec![place] })
                };
                points.iter().filter_map(of_point).collect()
            }
            Selection::Region(region) => {
                let of_body = |body: usize| {
                    let places =
                        region.exterior.iter().filter_map(|&corner| place_in(scene, body, corner, 0.0)).collect();
                    Self { body: body as u32, places }
                };
                (0..scene.bodies.len()).map(of_body).filter(|point| !point.places.is_empty()).collect()
            }
            _ => Vec::new(),
        }
    }

    /// The mean that is held.
    pub(super) fn mean(&self, lattice: &Lattice) -> EdgeMean {
        let part = 1.0 / self.places.len() as f64;
        let mut sums: BTreeMap<u32, f64> = BTreeMap::new();
        for &[place, nudged] in &self.places {
            for (field, w) in lattice.probe_entries(self.body, place, nudged) {
                *sums.entry(field).or_default() += part * w;
            }
        }
        sums.into_iter().collect()
    }

    /// Whether it comes within a box from `low` to `high` [m].
    pub(super) fn meets(&self, low: Point, high: Point) -> bool {
        self.places.iter().any(|[place, _]| *place >= low && *place <= high)
    }
}

/// The place of a body nearest to a `point`, with one a hair into it; none where that is farther off than `within` [m].
fn place_in(scene: &Scene, body: usize, point: Point, within: f64) -> Option<[Point; 2]> {
    let region = &scene.bodies[body].region;
    if region.contains(point) {
        return Some([point; 2]);
    }
    let nearest = region.nearest(point).filter(|nearest| nearest.distance <= within)?;
    let ring = region.rings().nth(nearest.ring)?;
    let way = ring[(nearest.edge + 1) % ring.len()] - ring[nearest.edge];
    let inside = Vector::new(-way.y, way.x).try_normalize(0.0)? * (1e-6 * scene.cell_size);
    Some([nearest.point, nearest.point + inside])
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use crate::boundary::supports::Reaction;
    use crate::crack::cracks::Cracks;
    use crate::particles::Particles;
    use crate::test_scenes;
    use crate::total::Total;
    use fissure_plane::{Point, Vector};
    use fissure_scene::{Formulation, Kernel, Selection, Support};
    use proptest::prelude::*;
    use std::sync::Arc;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Truth: the drawing, and Newton. Wherever in the cells of a square, and of its lower edge, a support of a
        /// hundredth of a cell lies: what is there moves as it says, and the square takes up the momentum it gives.
        #[test]
        fn a_support_smaller_than_a_cell_holds_its_point(
            at in prop::array::uniform2(0.3..7.7_f64),
            on_edge in any::<bool>(),
            is_region in any::<bool>(),
            speed in -1.0..1.0_f64,
        ) {
            let mut scene = test_scenes::free_body(test_scenes::rectangle([0.1, 0.2], [8.0, 8.1]), 0.5);
            scene.solver.formulation = Formulation::Total;
            scene.solver.kernel = Kernel::Bilinear;
            let place = Point::new(at[0], if on_edge { 0.2 } else { at[1] });
            let reach = Vector::repeat(0.01);
            let corners = [place - reach, place + reach].map(|corner| [corner.x, corner.y]);
            let selection = if is_region {
                Selection::Region(test_scenes::rectangle(corners[0], corners[1]))
            } else {
                Selection::Near { points: vec![place - Vector::new(0.0, 0.005)], radius: 0.01 }
            };
            scene.supports.push(Support { selection, velocity: [Some(speed), None], curve: test_scenes::always() });
            let particles = Arc::new(Particles::fill(&scene).unwrap());
            let mut total = Total::new(&scene, particles, &Cracks::of_scene(&scene)).unwrap();
            let momentum = |total: &Total| -> f64 {
                total.lattice.mass().iter().zip(&total.motion.velocity[0]).map(|(mass, v)| mass * v).sum()
            };
            total.apply_supports(0.0, 1e-3, 1e-3);
            // The edge is held along all that lies in a region.
            if !(is_region && on_edge) {
                let held = place - if is_region { Vector::zeros() } else { Vector::new(0.0, 0.005) };
                let held = Point::new(held.x, held.y.max(0.2));
                let probe = total.lattice.probe_entries(0, held, held + Vector::new(0.0, 1e-6));
                let there: f64 = probe.iter().map(|&(field, w)| w * total.motion.velocity[0][field as usize]).sum();
                prop_assert!((there - speed).abs() < 1e-6, "{there} {speed}");
            }
            let Reaction { impulse, .. } = total.reactions[0];
            prop_assert!((momentum(&total) - impulse[0]).abs() < 1e-9, "{} {}", momentum(&total), impulse[0]);
            prop_assert!(total.motion.velocity[1].iter().all(|v| *v == 0.0));
        }
    }
}
