//! What is held of an edge that lies anywhere in the lattice: weighted means of the velocity along it.
//!
//! The weights along the edge are hats φ_k whose sum is 1, so that reactions alike all along the edge push nodes as a
//! traction does: a body under uniform stress stays so. Their knots are where the edge crosses columns of nodes, where
//! it runs more along x than along y, else rows. That is as many as the lattice can follow: one for each crossing of
//! any line of nodes would keep the cells of an inclined edge from being strained at all (Moës, Béchet & Tourbier 2006
//! thin out the crossings for the same reason).

use super::lattice::Lattice;
use crate::grid::coverage::cuts;
use fissure_plane::{Point, Vector};
use fissure_scene::{OutlineStretch, Scene};
use std::collections::BTreeMap;

/// A weighted mean of the velocity along an edge: (field, weight); weights add up to 1.
pub(super) type EdgeMean = Vec<(u32, f64)>;

/// Knots are no closer than this, in cells: where an edge turns, columns and rows may lie beside each other.
const CLOSEST: f64 = 0.5;

/// Stretches of an outline that follow on each other.
#[derive(Debug, Clone)]
pub(super) struct Chain {
    body: usize,
    /// Its corners, both ends included [m].
    points: Vec<Point>,
    is_closed: bool,
    /// Whether other material of the body lies beyond its start and its end.
    goes_on: [bool; 2],
}

/// A chain in pieces within one cell each.
struct Pieces<'a> {
    lattice: &'a Lattice,
    chain: &'a Chain,
    /// Length of the way to each corner [m].
    way: Vec<f64>,
}

impl Chain {
    /// The chains that `stretches` make.
    pub(super) fn of(scene: &Scene, stretches: &[OutlineStretch]) -> Vec<Self> {
        let mut chains: Vec<Self> = Vec::new();
        let mut left: Vec<&OutlineStretch> = stretches.iter().filter(|s| s.from != s.to).collect();
        while !left.is_empty() {
            let first = left.remove(0);
            let mut chain =
                Self { body: first.body, points: vec![first.from, first.to], is_closed: false, goes_on: [false; 2] };
            let mut take = |matches: &dyn Fn(&OutlineStretch) -> bool| {
                left.iter().position(|s| s.body == first.body && matches(s)).map(|index| left.remove(index))
            };
            while let Some(next) = take(&|s| s.from == chain.points[chain.points.len() - 1]) {
                chain.points.push(next.to);
            }
            while let Some(before) = take(&|s| s.to == chain.points[0]) {
                chain.points.insert(0, before.from);
            }
            chain.is_closed = chain.points[0] == chain.points[chain.points.len() - 1];
            chain.goes_on = chain.looked_beyond(scene);
            chains.push(chain);
        }
        chains
    }

    fn looked_beyond(&self, scene: &Scene) -> [bool; 2] {
        let p = &self.points;
        let last = p.len() - 1;
        [(p[0], p[0] - p[1], -1.0), (p[last], p[last] - p[last - 1], 1.0)].map(|(end, way, sign)| {
            let ahead = way.normalize() * (0.25 * scene.cell_size);
            let inside = Vector::new(-ahead.y, ahead.x) * sign;
            scene.bodies[self.body].region.contains(end + ahead + inside)
        })
    }

    /// Whether it comes within a box from `low` to `high` [m].
    pub(super) fn meets(&self, low: Point, high: Point) -> bool {
        self.points.windows(2).any(|p| p[0].sup(&p[1]) >= low && p[0].inf(&p[1]) <= high)
    }

    /// The means that are held where the whole of it is.
    pub(super) fn means(&self, lattice: &Lattice) -> Vec<EdgeMean> {
        let mut way = vec![0.0];
        way.extend(self.points.windows(2).scan(0.0, |sum, p| {
            *sum += (p[1] - p[0]).norm();
            Some(*sum)
        }));
        Pieces { lattice, chain: self, way }.means()
    }
}

impl Pieces<'_> {
    fn length(&self) -> f64 {
        self.way[self.way.len() - 1]
    }

    /// The edge from a corner to the next, in cells.
    fn edge(&self, k: usize) -> [Vector; 2] {
        [k, k + 1].map(|k| self.lattice.grid.in_cells(self.chain.points[k]))
    }

    /// Where the knots are along the way, rising.
    fn knots(&self) -> Vec<f64> {
        let (length, h) = (self.length(), self.lattice.grid.cell_size);
        let mut knots = Vec::new();
        for (k, way) in self.way.windows(2).enumerate() {
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
        let last = self.lattice.grid.in_cells(self.place(knot))[tangent];
        let entries = self.lattice.probe_entries(self.chain.body as u32, place, place + self.inside(edge));
        entries.iter().any(|&(field, w)| {
            let node = self.lattice.grid.in_cells(self.lattice.position(field as usize))[tangent];
            w.abs() > 1e-9 && outward * (node - last) > 1e-6
        })
    }

    /// The place at a length of the way [m].
    fn place(&self, way: f64) -> Point {
        let k = (self.way.partition_point(|&corner| corner <= way).max(1) - 1).min(self.way.len() - 2);
        let [a, b] = [self.chain.points[k], self.chain.points[k + 1]];
        a + (b - a) * ((way - self.way[k]) / (self.way[k + 1] - self.way[k]))
    }

    /// From the edge that begins at a corner a hair into the material [m].
    fn inside(&self, k: usize) -> Vector {
        let [from, to] = [self.chain.points[k], self.chain.points[k + 1]];
        let length = self.way[k + 1] - self.way[k];
        Vector::new(from.y - to.y, to.x - from.x) * (1e-6 * self.lattice.grid.cell_size / length)
    }

    /// The hats that are not zero at a place on the way: the index of each with its value.
    fn hats(&self, knots: &[f64], at: f64) -> [(usize, f64); 2] {
        let last = knots.len() - 1;
        let after = knots.partition_point(|&knot| knot <= at);
        let (before, next, gap, run) = match (after, self.chain.is_closed) {
            (0, false) => return [(0, 1.0), (0, 0.0)],
            (0, true) => (last, 0, knots[0] + self.length() - knots[last], at + self.length() - knots[last]),
            (k, false) if k > last => return [(last, 1.0), (last, 0.0)],
            (k, true) if k > last => (last, 0, knots[0] + self.length() - knots[last], at - knots[last]),
            (k, _) => (k - 1, k, knots[k] - knots[k - 1], at - knots[k - 1]),
        };
        [(before, 1.0 - run / gap), (next, run / gap)]
    }

    fn means(&self) -> Vec<EdgeMean> {
        let knots = self.knots();
        let mut sums: Vec<BTreeMap<u32, f64>> = vec![BTreeMap::new(); knots.len()];
        for (k, way) in self.way.windows(2).enumerate() {
            let [from, to] = [self.chain.points[k], self.chain.points[k + 1]];
            let [a, b] = self.edge(k);
            let length = way[1] - way[0];
            let mut cuts = cuts(a, b);
            cuts.extend(knots.iter().map(|knot| (knot - way[0]) / length).filter(|t| *t > 0.0 && *t < 1.0));
            cuts.sort_unstable_by(f64::total_cmp);
            let inside = self.inside(k);
            for cut in cuts.windows(2).filter(|cut| cut[1] - cut[0] > 1e-9) {
                // Gauss' rule of two points: hats are linear on a piece, weights of nodes at most quadratic.
                let (middle, half) = (0.5 * (cut[0] + cut[1]), 0.5 * (cut[1] - cut[0]));
                for t in [middle - half / 3.0_f64.sqrt(), middle + half / 3.0_f64.sqrt()] {
                    let place = from + (to - from) * t;
                    let entries = self.lattice.probe_entries(self.chain.body as u32, place, place + inside);
                    for (knot, hat) in self.hats(&knots, way[0] + length * t) {
                        for &(field, w) in &entries {
                            *sums[knot].entry(field).or_default() += hat * half * length * w;
                        }
                    }
                }
            }
        }
        sums.into_iter().filter_map(mean).collect()
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
    use fissure_scene::{Formulation, Kernel};
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
        let means = |k: usize| Chain::of(&scene, &[edge(k)]).iter().flat_map(|c| c.means(&total.lattice)).collect();
        ((0..4).map(means).collect(), total.lattice.inverse_mass.clone())
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
