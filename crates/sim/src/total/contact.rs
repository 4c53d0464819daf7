//! Contact between the two faces of a crack, at nodes that have fields on both sides of it.
//!
//! Nairn 2003, Guo & Nairn 2006 (thesis eq. 7–10): fields that overlap, (u_a − u_b)·n < 0 with n from below to above, and approach, (v_a − v_b)·n < 0, get
//! the normal velocity of their centre of mass. Friction after Coulomb: the tangential impulse is at most μ times the normal one; an infinite μ sticks.
//!
//! As published, this lets faces that meet overlap by the way they go in one step, and stay so; faces that slide along
//! each other overlap a little more with every step, and less and less pressure is passed on near a tip. Here two fields
//! may approach in a step by as much as the gap between them, so that faces meet and never overlap.

use super::Total;
use super::refresh::Near;
use crate::crack::Crack;
use crate::crack::cracks::Cracks;
use fissure_scene::{Point, Vector};

/// Two fields of one node on the two sides of one crack.
#[derive(Debug, Clone, Copy)]
pub(super) struct ContactPair {
    above: u32,
    below: u32,
    crack: u32,
    /// Segment of the crack nearest to the node.
    segment: u32,
    /// Force on the field above in the last step, per unit thickness [N/m].
    force: [f64; 2],
}

impl Total {
    /// All pairs of fields that face each other across one crack.
    pub(super) fn contact_pairs(&self, cracks: &Cracks) -> Vec<ContactPair> {
        let mut pairs = Vec::new();
        for node in self.state.fields.divided_nodes() {
            self.add_pairs_of_node(node, cracks, &mut pairs);
        }
        pairs
    }

    /// [`Total::contact_pairs`] after a change: nodes elsewhere have the pairs they had.
    pub(super) fn contacts_near(&self, near: &Near, cracks: &Cracks) -> Vec<ContactPair> {
        let node_of = |pair: &ContactPair| self.state.fields.node(pair.above as usize);
        let mut pairs = Vec::with_capacity(self.contacts.len() + 32);
        // Pairs are in the order of their nodes.
        let mut before = self.contacts.as_slice();
        for node in self.state.fields.divided_nodes() {
            let skipped = before.partition_point(|pair| node_of(pair) < node);
            let (own, rest) = before[skipped..].split_at(before[skipped..].partition_point(|p| node_of(p) == node));
            before = rest;
            if near.contains(self.grid.position(node)) {
                let first = pairs.len();
                self.add_pairs_of_node(node, cracks, &mut pairs);
                // What the faces did to each other in this step they did, however the node is divided now: tips may be measured again before the next.
                for before in own {
                    if let Some(now) = pairs[first..].iter_mut().find(|p| p.crack == before.crack) {
                        (0..2).for_each(|axis| now.force[axis] += before.force[axis]);
                    }
                }
            } else {
                let now = |p: &ContactPair| ContactPair { segment: near.segment_now(p.crack, p.segment), ..*p };
                pairs.extend(own.iter().map(now));
            }
        }
        pairs
    }

    fn add_pairs_of_node(&self, node: usize, cracks: &Cracks, pairs: &mut Vec<ContactPair>) {
        for facing in self.state.fields.facing_pairs(&self.fields_with_mass(node)) {
            let Some(line) = cracks.get(facing.crack as usize) else { continue };
            let [above, below] = facing.above_and_below();
            let segment = self.nearest_segment(facing.crack, line, self.grid.position(node));
            pairs.push(ContactPair { above, below, crack: facing.crack, segment: segment as u32, force: [0.0; 2] });
        }
    }

    /// The fields of a node that have mass, its own first.
    pub(super) fn fields_with_mass(&self, node: usize) -> Vec<u32> {
        let all = std::iter::once(node as u32).chain(self.state.fields.of(node).iter().copied());
        all.filter(|&field| self.state.mass[field as usize] > 0.0).collect()
    }

    /// The segment of a crack nearest to `place`.
    fn nearest_segment(&self, crack: u32, line: &Crack, place: Point) -> usize {
        // Around a vertex both its segments are equally near, up to round-off: the first one counts.
        let clearly = 1e-9 * self.grid.cell_size;
        let around = self.division.segments_around(crack, place);
        let (distance, segment) = nearest_of(around.into_iter(), line, place, clearly);
        if distance < self.division.surroundings() - 2.0 * clearly {
            return segment;
        }
        // Ahead of a tip or beyond a mouth, where few nodes are, what is nearest may lie anywhere.
        nearest_of(0..line.points.len() - 1, line, place, clearly).1
    }

    /// Current normal of a crack segment, from below to above: across the mean of the two faces.
    fn segment_normal(&self, crack: u32, segment: u32) -> Option<Vector> {
        let [above, below] = &self.state.faces[crack as usize];
        let s = segment as usize;
        let (from, to) = (above.get(s)?, above.get(s + 1)?);
        let u = &self.state.displacement;
        let mean = |k: usize| (above[k].value(u) + below[k].value(u)) * 0.5;
        let tangent = (to.rest - from.rest) + (mean(s + 1) - mean(s));
        let length = tangent.norm();
        (length > 0.0).then(|| Vector::new(-tangent.y, tangent.x) / length)
    }

    /// Displacement of the face above less that of the face below [m].
    fn gap(&self, pair: &ContactPair) -> Vector {
        let (u, a, b) = (&self.state.displacement, pair.above as usize, pair.below as usize);
        Vector::new(u[0][a] - u[0][b], u[1][a] - u[1][b])
    }

    /// The least and the widest gap of all pairs along their normals [m].
    #[cfg(test)]
    pub(super) fn least_and_widest_gap(&self) -> [f64; 2] {
        let along = |pair: &ContactPair| self.segment_normal(pair.crack, pair.segment).map(|n| self.gap(pair).dot(&n));
        let gaps = self.contacts.iter().filter_map(along);
        gaps.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, widest], gap| [least.min(gap), widest.max(gap)])
    }

    /// Forgets the forces of the step before.
    pub(super) fn release_crack_contact(&mut self) {
        self.contacts.iter_mut().for_each(|pair| pair.force = [0.0; 2]);
    }

    /// Applies contact to all pairs: impulses within the time `kick` [s].
    pub(super) fn resolve_crack_contact(&mut self, kick: f64, time_step: f64) {
        let mut pairs = std::mem::take(&mut self.contacts);
        let friction = self.settings.crack_friction;
        for pair in &mut pairs {
            let (a, b) = (pair.above as usize, pair.below as usize);
            let v = &self.state.velocity;
            let gap = self.gap(pair);
            let speed = Vector::new(v[0][a] - v[0][b], v[1][a] - v[1][b]);
            if gap == Vector::zeros() && speed == Vector::zeros() {
                continue;
            }
            let Some(n) = self.segment_normal(pair.crack, pair.segment) else { continue };
            let approach = speed.dot(&n);
            // What is left of the gap may be used up in this step; faces that overlap stay as they are.
            let allowed = -gap.dot(&n).max(0.0) / time_step;
            if approach >= allowed {
                continue;
            }
            let (mass_a, mass_b) = (self.state.mass[a], self.state.mass[b]);
            let reduced = mass_a * mass_b / (mass_a + mass_b);
            let sliding = speed - n * approach;
            let sliding_speed = sliding.norm();
            let mut impulse = n * ((allowed - approach) * reduced);
            if friction > 0.0 && sliding_speed > 0.0 {
                let most = friction * (allowed - approach);
                impulse -= sliding * (reduced * (most / sliding_speed).min(1.0));
            }
            for axis in 0..2 {
                pair.force[axis] += impulse[axis] / kick;
                self.state.velocity[axis][a] += impulse[axis] / mass_a;
                self.state.velocity[axis][b] -= impulse[axis] / mass_b;
            }
        }
        self.contacts = pairs;
    }

    /// The forces of the last step between the faces of a crack: place at rest [m] and force on the face above [N/m].
    pub(super) fn face_forces(&self, crack: usize) -> impl Iterator<Item = (Point, Vector)> {
        let pressed = self.contacts.iter().filter(move |p| p.crack as usize == crack && p.force != [0.0; 2]);
        pressed.map(|p| (self.grid.position(self.state.fields.node(p.above as usize)), Vector::from(p.force)))
    }
}

/// Distance to the nearest of `segments` [m], which rise, and which it is; one counts as nearer than those before it when it is so `clearly` [m].
fn nearest_of(segments: impl Iterator<Item = usize>, line: &Crack, place: Point, clearly: f64) -> (f64, usize) {
    segments.fold((f64::INFINITY, 0), |(nearest, segment), s| {
        let distance = fissure_plane::distance_to_segment(place, line.points[s], line.points[s + 1]);
        if distance < nearest - clearly { (distance, s) } else { (nearest, segment) }
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::crack::cracks::TipId;
    use crate::particles::Particles;
    use crate::solver::Solver;
    use crate::test_scenes;
    use fissure_scene::{End, Formulation, Kernel, TipDivision};
    use proptest::prelude::*;
    use std::sync::Arc;

    fn plate(kernel: Kernel, points: &[[f64; 2]]) -> (Total, Cracks) {
        let mut scene = test_scenes::free_body(test_scenes::rectangle([0.0, 0.0], [4.0, 4.0]), 0.1);
        scene.solver.formulation = Formulation::Total;
        scene.solver.kernel = kernel;
        scene.solver.tip_division = TipDivision::PartlyCut;
        test_scenes::add_crack(&mut scene, points);
        let cracks = Cracks::of_scene(&scene);
        (Total::new(&scene, Arc::new(Particles::fill(&scene).unwrap()), &cracks).unwrap(), cracks)
    }

    /// The segment of every pair, and what a look at all segments of the crack finds.
    fn assert_nearest(total: &Total, cracks: &Cracks) {
        let clearly = 1e-9 * total.grid.cell_size;
        assert!(!total.contacts.is_empty());
        for pair in &total.contacts {
            let line = &cracks[pair.crack as usize];
            let place = total.grid.position(total.state.fields.node(pair.above as usize));
            let nearest = nearest_of(0..line.points.len() - 1, line, place, clearly).1;
            assert_eq!(pair.segment as usize, nearest, "at {place}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        /// Truth: brute force, over cracks that wind, come back beside themselves and grow.
        #[test]
        fn pairs_have_the_nearest_segment_of_all(
            kernel in prop::sample::select(vec![Kernel::Bilinear, Kernel::Gimp, Kernel::Cubic]),
            start in 0.5..3.5_f64,
            turns in prop::collection::vec((-1.2..1.2_f64, 0.02..0.6_f64), 1..40),
            grown in 0.0..0.6_f64,
        ) {
            let mut points = vec![Point::new(0.0, start), Point::new(0.3, start)];
            let mut heading = 0.0_f64;
            for (turn, length) in turns {
                heading += turn;
                let next = points[points.len() - 1] + Vector::new(heading.cos(), heading.sin()) * length;
                if next.coords.amin() < 0.3 || next.coords.amax() > 3.7 {
                    break;
                }
                points.push(next);
            }
            let points: Vec<[f64; 2]> = points.into_iter().map(Into::into).collect();
            let (mut total, mut cracks) = plate(kernel, &points);
            assert_nearest(&total, &cracks);
            let ahead = Vector::new(heading.cos(), heading.sin()) * (grown * total.grid.cell_size);
            if ahead != Vector::zeros() {
                let id = TipId::new(0, End::End);
                cracks.push(id, cracks.position(id) + ahead);
                total.recut(&cracks, &[id]);
                assert_nearest(&total, &cracks);
            }
        }
    }

    /// Truth: the construction. However long a crack is, only what is around a node is looked at.
    #[test]
    fn a_node_looks_at_what_is_around_it() {
        let most = [40, 400].map(|segments| {
            let points: Vec<[f64; 2]> =
                (0..=segments).map(|k| [0.1 + 0.2 * f64::from(k), 2.03 + 0.02 * f64::from(k % 2)]).collect();
            let mut scene = test_scenes::free_body(test_scenes::rectangle([0.0, 0.0], [90.0, 4.0]), 0.1);
            scene.solver.formulation = Formulation::Total;
            test_scenes::add_crack(&mut scene, &points);
            let cracks = Cracks::of_scene(&scene);
            let total = Total::new(&scene, Arc::new(Particles::fill(&scene).unwrap()), &cracks).unwrap();
            let looks = |pair: &ContactPair| {
                let place = total.grid.position(total.state.fields.node(pair.above as usize));
                total.division.segments_around(pair.crack, place).len()
            };
            total.contacts.iter().map(looks).max().unwrap()
        });
        assert!(most[0] < 40 && most[1] <= most[0] + 2, "{most:?}");
    }
}
