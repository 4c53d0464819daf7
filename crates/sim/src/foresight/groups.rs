//! Which particles the grid holds together: those that share a node, directly or through others.

use crate::grid::kernel::axis_stencil;
use crate::grid::spans::Span;
use crate::particles::Particles;
use fissure_scene::Scene;

/// The number of the group that each particle belongs to. Cracks are left aside. Time goes with the number of rows of
/// particles and of gaps in them.
pub(super) fn groups(scene: &Scene, particles: &Particles) -> Vec<u32> {
    let reach = Reach::new(scene);
    let rows: Vec<(i32, &[Span])> = particles.lattice().rows().collect();
    let mut starts = vec![0];
    starts.extend(rows.iter().scan(0, |sum, (_, spans)| {
        *sum += spans.len();
        Some(*sum)
    }));
    let mut union = Union::new(starts[rows.len()]);
    for (index, &(row, spans)) in rows.iter().enumerate() {
        for (k, pair) in spans.windows(2).enumerate() {
            if reach.share_column(&pair[0], &pair[1]) {
                union.join(starts[index] + k, starts[index] + k + 1);
            }
        }
        let above = rows.iter().enumerate().skip(index + 1);
        for (other, &(_, others)) in above.take_while(|(_, (higher, _))| reach.share(row, *higher)) {
            // The span that ends first meets no later one that does not share a node with the other as well.
            let (mut a, mut b) = (0, 0);
            while let (Some(p), Some(q)) = (spans.get(a), others.get(b)) {
                if reach.share_column(p, q) {
                    union.join(starts[index] + a, starts[other] + b);
                }
                if p.end <= q.end { a += 1 } else { b += 1 }
            }
        }
    }
    let mut group = vec![u32::MAX; particles.len()];
    for (number, span) in rows.iter().flat_map(|(_, spans)| spans.iter()).enumerate() {
        let root = union.root(number) as u32;
        let first = span.number as usize;
        group[first..first + (span.end - span.first) as usize].fill(root);
    }
    // Of two particles in one place the lattice holds one.
    for p in 0..group.len() {
        if group[p] == u32::MAX {
            group[p] = particles.at(particles.place[p]).map_or(p as u32, |twin| group[twin]);
        }
    }
    group
}

/// The nodes that particles give mass to, along an axis.
struct Reach<'a> {
    scene: &'a Scene,
}

impl<'a> Reach<'a> {
    fn new(scene: &'a Scene) -> Self {
        Self { scene }
    }

    /// First and last node of the particle in a column or row.
    fn of(&self, place: i32) -> (i32, i32) {
        let (s, h) = (self.scene.particle_spacing, self.scene.cell_size);
        let half_size = (0.5 * s / h).min(0.5);
        let stencil = axis_stencil(self.scene.solver.kernel, half_size, (f64::from(place) + 0.5) * s / h);
        let has_mass = |w: &f64| *w > 0.0;
        let first = stencil.weight.iter().position(has_mass).unwrap_or(0) as i32;
        let last = stencil.weight.iter().rposition(has_mass).unwrap_or(0) as i32;
        (stencil.first + first, stencil.first + last)
    }

    /// Whether particles in the column or row `low` and in the one at or above it share a node.
    fn share(&self, low: i32, high: i32) -> bool {
        self.of(high).0 <= self.of(low).1
    }

    fn share_column(&self, one: &Span, other: &Span) -> bool {
        self.share(one.end - 1, other.first) && self.share(other.end - 1, one.first)
    }
}

/// Sets that are joined step by step; the lowest number stands for its set.
struct Union {
    parent: Vec<usize>,
}

impl Union {
    fn new(count: usize) -> Self {
        Self { parent: (0..count).collect() }
    }

    fn root(&mut self, mut of: usize) -> usize {
        while self.parent[of] != of {
            self.parent[of] = self.parent[self.parent[of]];
            of = self.parent[of];
        }
        of
    }

    fn join(&mut self, one: usize, other: usize) {
        let (a, b) = (self.root(one), self.root(other));
        self.parent[a.max(b)] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::grid::kernel::Stencil;
    use crate::test_scenes::{add_body, free_body, rectangle};
    use fissure_scene::{Kernel, Point};
    use proptest::prelude::*;
    use std::collections::HashMap;

    /// Groups from the nodes of every particle's stencil.
    fn by_nodes(scene: &Scene, particles: &Particles) -> Vec<usize> {
        let mut union = Union::new(particles.len());
        let mut holder: HashMap<[i32; 2], usize> = HashMap::new();
        let half_size = 0.5 * scene.particle_spacing / scene.cell_size;
        for p in 0..particles.len() {
            let place = (particles.rest[p] - particles.anchor) / scene.cell_size;
            let stencil = Stencil::new(scene.solver.kernel, half_size, [place.x, place.y], 1.0);
            for a in 0..stencil.width {
                for b in 0..stencil.width {
                    if stencil.weight[0][a] * stencil.weight[1][b] > 0.0 {
                        let node = [stencil.first[0] + a as i32, stencil.first[1] + b as i32];
                        let first = *holder.entry(node).or_insert(p);
                        union.join(first, p);
                    }
                }
            }
        }
        (0..particles.len()).map(|p| union.root(p)).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]
        /// Truth: the nodes of all stencils of the solver, for every kernel and number of particles per cell, on bodies
        /// of ragged outlines beside each other.
        #[test]
        fn groups_are_what_shares_nodes(
            corners in prop::collection::vec((0_u32..120, 0_u32..120), 3..14),
            away in (-60_i32..60, -60_i32..60),
            kernel in prop::sample::select(vec![Kernel::Bilinear, Kernel::Gimp, Kernel::Quadratic, Kernel::Cubic]),
            per_cell in prop::sample::select(vec![1.0, 1.5, 2.0, 3.0]),
        ) {
            let mut region = rectangle([0.0, 0.0], [1.0, 1.0]);
            region.exterior = corners.iter().map(|&(x, y)| Point::new(f64::from(x), f64::from(y)) * 0.25).collect();
            let mut scene = free_body(region, 1.0);
            add_body(&mut scene, [f64::from(away.0), f64::from(away.1)]);
            (scene.solver.kernel, scene.cell_size) = (kernel, per_cell);
            let Ok(particles) = Particles::fill(&scene) else { return Ok(()) };
            let (found, truth) = (groups(&scene, &particles), by_nodes(&scene, &particles));
            // Two numberings are of the same groups when pairs of them map one to one.
            let pairs: std::collections::BTreeSet<_> = found.iter().zip(&truth).collect();
            let ours: std::collections::BTreeSet<_> = found.iter().collect();
            let theirs: std::collections::BTreeSet<_> = truth.iter().collect();
            prop_assert_eq!((pairs.len(), pairs.len()), (ours.len(), theirs.len()));
        }
    }
}
