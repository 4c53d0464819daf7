//! What is held of an edge that lies anywhere in the lattice: weighted means of the velocity along it.
//!
//! The weights along the edge are hats φ_k whose sum is 1, so that reactions alike all along the edge push nodes as a
//! traction does: a body under uniform stress stays so. Their knots are where the edge crosses columns of nodes, where
//! it runs more along x than along y, else rows. That is as many as the lattice can follow: one for each crossing of
//! any line of nodes would keep the cells of an inclined edge from being strained at all (Moës, Béchet & Tourbier 2006
//! thin out the crossings for the same reason).

use super::lattice::Lattice;
use crate::boundary::edges::{Chain, EdgeMean};
use fissure_plane::Vector;
use std::collections::BTreeMap;

/// Knots are no closer than this, in cells: where an edge turns, columns and rows may lie beside each other.
const CLOSEST: f64 = 0.5;

/// The means that are held where the whole of a chain is.
pub(super) fn means(chain: &Chain, lattice: &Lattice) -> Vec<EdgeMean> {
    let knots = OnLattice { lattice, chain }.knots();
    let mut sums: Vec<BTreeMap<u32, f64>> = vec![BTreeMap::new(); knots.len()];
    for at in chain.places(&knots, lattice.grid.origin, lattice.grid.cell_size) {
        let entries = lattice.probe_entries(chain.body as u32, at.place, at.place + at.inside);
        for (knot, hat) in at.hats {
            for &(field, w) in &entries {
                *sums[knot].entry(field).or_default() += hat * w;
            }
        }
    }
    sums.into_iter().filter_map(mean).collect()
}

/// A chain on the lattice that moves it.
struct OnLattice<'a> {
    lattice: &'a Lattice,
    chain: &'a Chain,
}

impl OnLattice<'_> {
    /// The edge from a corner to the next, in cells.
    fn edge(&self, k: usize) -> [Vector; 2] {
        [k, k + 1].map(|k| self.lattice.grid.in_cells(self.chain.points[k]))
    }

    /// Where the knots are along the way, rising.
    fn knots(&self) -> Vec<f64> {
        let (length, h) = (self.chain.length(), self.lattice.grid.cell_size);
        let mut knots = Vec::new();
        for (k, way) in self.chain.way.windows(2).enumerate() {
            let [a, b] = self.edge(k);
            let tangent = if (b - a).x.abs() >= (b - a).y.abs() { 0 } else { 1 };
            let (low, high) = (a[tangent].min(b[tangent]), a[tangent].max(b[tangent]));
            // The ends of an edge that lie on a line of nodes up to rounding do.
            let lines = (low - 1e-9).ceil() as i64..=(high + 1e-9).floor() as i64;
            let part = |line: i64| ((line as f64 - a[tangent]) / (b - a)[tangent]).clamp(0.0, 1.0);
            knots.extend(lines.map(|line| way[0] + (way[1] - way[0]) * part(line)));
        }
        knots.sort_unstable_by(f64::total_cmp);
        let mut kept: Vec<f64> = Vec::new();
        for knot in knots {
            if kept.last().is_none_or(|last| knot - last > CLOSEST * h) {
                kept.push(knot);
            }
        }
        if self.chain.is_closed {
            if kept.len() > 1 && kept[0] + length - kept[kept.len() - 1] <= CLOSEST * h {
                kept.pop();
            }
            return kept;
        }
        // At a corner the edge is held to its end; where material goes on, to the nearest line of nodes.
        let least = |goes_on: bool| if goes_on { CLOSEST * h } else { 1e-6 * h };
        let has_end = |end: usize, knot: f64, gap: f64| gap > least(self.chain.goes_on[end]) && self.moves(end, knot);
        if kept.first().is_none_or(|&first| has_end(0, first, first)) {
            kept.insert(0, 0.0);
        }
        let last = kept[kept.len() - 1];
        if has_end(1, last, length - last) {
            kept.push(length);
        }
        kept
    }

    /// Whether an end of the chain, 0 or 1, moves by a line of nodes that lies beyond the nearest `knot`.
    ///
    /// Where a corner reaches so little into its cells that no particle is there, the lattice carries on straight what
    /// it is before them. A knot more would say what follows from all others along the edge, each of which leaves 3.7
    /// times less to be said: after some fifteen that is lost in rounding, and impulses would be anything.
    fn moves(&self, end: usize, knot: f64) -> bool {
        let points = &self.chain.points;
        let (edge, place) = if end == 0 { (0, points[0]) } else { (points.len() - 2, points[points.len() - 1]) };
        let [a, b] = self.edge(edge);
        let tangent = if (b - a).x.abs() >= (b - a).y.abs() { 0 } else { 1 };
        let outward = if end == 0 { (a - b)[tangent] } else { (b - a)[tangent] }.signum();
        let last = self.lattice.grid.in_cells(self.chain.place(knot))[tangent];
        let entries = self.lattice.probe_entries(
            self.chain.body as u32,
            place,
            place + self.chain.inside(edge, self.lattice.grid.cell_size),
        );
        entries.iter().any(|&(field, w)| {
            let node = self.lattice.grid.in_cells(self.lattice.position(field as usize))[tangent];
            w.abs() > 1e-9 && outward * (node - last) > 1e-6
        })
    }
}

/// Sums of weights as a mean; none of nothing.
fn mean(sums: BTreeMap<u32, f64>) -> Option<EdgeMean> {
    let total: f64 = sums.values().sum();
    let weights = sums.into_iter().map(|(field, w)| (field, w / total));
    (total > 0.0).then(|| weights.filter(|(_, w)| w.abs() > 1e-12).collect())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::crack::cracks::Cracks;
    use crate::particles::Particles;
    use crate::test_scenes::{free_body, rectangle};
    use crate::total::Total;
    use fissure_scene::{Formulation, Kernel, OutlineStretch};
    use proptest::prelude::*;
    use std::sync::Arc;

    /// Means of the velocity along the edges of a rectangle of `size` cells turned by `angle`, with the inverse masses.
    fn means_of_edges(size: [f64; 2], angle: f64) -> (Vec<Vec<EdgeMean>>, Vec<f64>) {
        let mut region = rectangle([0.0, 0.0], size);
        let turn = nalgebra::Rotation2::new(angle);
        region.exterior.iter_mut().for_each(|p| *p = turn * *p);
        let ring = region.exterior.clone();
        let mut scene = free_body(region, 0.5);
        scene.solver.formulation = Formulation::Total;
        scene.solver.kernel = Kernel::Bilinear;
        let particles = Arc::new(Particles::fill(&scene).unwrap());
        let total = Total::new(&scene, particles, &Cracks::of_scene(&scene)).unwrap();
        let edge = |k: usize| OutlineStretch { body: 0, from: ring[k], to: ring[(k + 1) % 4] };
        let of_edge = |k: usize| Chain::of(&scene, &[edge(k)]).iter().flat_map(|c| means(c, &total.lattice)).collect();
        ((0..4).map(of_edge).collect(), total.lattice.inverse_mass.clone())
    }

    proptest! {
        /// Truth: the eigenvalues of W M⁻¹ Wᵀ, scaled to a diagonal of ones. Hats along a line of nodes give .2;
        /// where the lattice cannot follow one of n knots, the least is below 3.7^(-2n). Measured: 2.7e-3 at the worst
        /// of 1024 edges.
        #[test]
        fn no_mean_follows_from_the_others(
            length in 20.0..25.0_f64,
            width in 5.0..7.0_f64,
            angle in -3.2..3.2_f64,
            quarters in any::<bool>(),
        ) {
            let quarter = std::f64::consts::FRAC_PI_2;
            let angle = if quarters { (angle / quarter).round() * quarter } else { angle };
            let (edges, inverse_mass) = means_of_edges([length, width], angle);
            for means in edges {
                let product = |a: &EdgeMean, b: &EdgeMean| -> f64 {
                    let of = |field| b.iter().find(|entry| entry.0 == field).map_or(0.0, |entry| entry.1);
                    a.iter().map(|&(field, w)| w * inverse_mass[field as usize] * of(field)).sum()
                };
                let gram = nalgebra::DMatrix::from_fn(means.len(), means.len(), |i, j| {
                    let own = product(&means[i], &means[i]) * product(&means[j], &means[j]);
                    product(&means[i], &means[j]) / own.sqrt()
                });
                let least = gram.symmetric_eigenvalues().min();
                prop_assert!(least > 1e-3, "{least}");
            }
        }
    }
}
