//! An edge that a support holds: means of the velocity along it, wherever it is on the grid of a step.

use super::beside::Beside;
use super::lattice::Lattice;
use super::points::Points;
use super::setup::Setup;
use crate::boundary::edges::{Chain, EdgeMean, EdgePlace};

/// Knots are no closer than this, in cells, wherever the grid lies beside them: waves between them are then longer than
/// those that the kernels cannot follow. Half a cell beside the nodes no quadratic spline tells hats of one cell apart.
const SPACING: f64 = 1.5;

/// An edge that a support holds.
#[derive(Debug)]
pub(super) struct HeldEdge {
    knots: usize,
    /// Places along it, each with the hats that are not zero there: index and value times length [m].
    places: Vec<(Beside, [(usize, f64); 2])>,
}

impl HeldEdge {
    /// The edge along a chain that goes with the nearest particles of `layer`.
    pub(super) fn new(setup: &Setup, chain: &Chain, layer: &[u32]) -> Self {
        let (length, h) = (chain.length(), setup.scene.cell_size);
        let pieces = (length / (SPACING * h)).floor().max(1.0);
        // That of a closed chain begins where it ends.
        let knots = if chain.is_closed { pieces as usize } else { pieces as usize + 1 };
        let ways: Vec<f64> = (0..knots).map(|k| length * k as f64 / pieces).collect();
        let places = chain.places(&ways, setup.particles.anchor, h).into_iter();
        let beside = |at: EdgePlace| Some((Beside::nearest(setup, layer, at.place)?, at.hats));
        Self { knots, places: places.filter_map(beside).collect() }
    }

    /// The means on the grid of a step.
    pub(super) fn means(&self, points: &Points, lattice: &Lattice) -> Vec<EdgeMean> {
        let mut sums: Vec<Vec<(u32, f64)>> = vec![Vec::new(); self.knots];
        for (place, hats) in &self.places {
            place.for_each_entry(points, lattice, |field, w| {
                for &(knot, hat) in hats {
                    sums[knot].push((field as u32, hat * w));
                }
            });
        }
        sums.into_iter().filter_map(mean).collect()
    }
}

/// Weights as a mean, those of a field together; none of nothing.
fn mean(mut weights: Vec<(u32, f64)>) -> Option<EdgeMean> {
    weights.sort_by_key(|(field, _)| *field);
    let total: f64 = weights.iter().map(|(_, w)| w).sum();
    let of_fields = weights.chunk_by(|a, b| a.0 == b.0);
    let mean = of_fields.map(|same| (same[0].0, same.iter().map(|(_, w)| w).sum::<f64>() / total));
    (total > 0.0).then(|| mean.filter(|(_, w)| w.abs() > 1e-12).collect())
}
