//! Contact between the two faces of a crack, at nodes that have fields on both sides of it.
//!
//! Nairn 2003, Guo & Nairn 2006 (thesis eq. 7–10): fields that overlap, (u_a − u_b)·n < 0 with n from below to above,
//! and approach, (v_a − v_b)·n < 0, get the normal velocity of their centre of mass. Friction after Coulomb: the
//! tangential impulse is at most μ times the normal one; an infinite μ sticks.
//!
//! As published, this lets faces that meet overlap by the way they go in one step, and stay so; faces that slide along
//! each other overlap a little more with every step, and less and less pressure is passed on near a tip. Here two
//! fields may approach in a step by as much as the gap between them, so that faces meet and never overlap.

use super::lattice::Lattice;
use super::motion::Motion;
use super::near::Near;
use super::probes::Probes;
use crate::contact::neighbours::TOGETHER;
use crate::crack::Crack;
use crate::crack::contact::face_impulse;
use crate::crack::cracks::{Cracks, Stretch};
use fissure_plane::{Point, Vector};

/// Rounds in which the pairs of a node that has several take what the others have done into account.
const ROUNDS: usize = 8;

/// Two fields of one node on the two sides of one crack.
#[derive(Debug, Clone, Copy)]
struct FacePair {
    above: u32,
    below: u32,
    /// Their node.
    node: u32,
    crack: u32,
    /// Segment of the crack nearest to the node.
    segment: u32,
    /// Force on the field above in the last step, per unit thickness [N/m].
    force: [f64; 2],
}

/// All pairs of fields that face each other across one crack, in the order of their nodes.
#[derive(Debug)]
pub(super) struct Contacts {
    pairs: Vec<FacePair>,
    /// Coefficient of friction; none where faces pass through each other.
    friction: Option<f64>,
    /// Fields that have slid farther than this along each other have parted [m].
    longest_slide: f64,
}

impl Contacts {
    /// The pairs of `lattice`. `friction`: coefficient of friction; none where faces pass through each other.
    pub(super) fn new(friction: Option<f64>, lattice: &Lattice, cracks: &Cracks) -> Self {
        let forks = cracks.forks();
        let mut pairs = Vec::new();
        for node in lattice.fields().divided_nodes() {
            add_pairs_of_node(lattice, node, cracks, &forks, &mut pairs);
        }
        Self { pairs, friction, longest_slide: TOGETHER * lattice.grid.cell_size }
    }

    /// Whether faces can press on each other.
    pub(super) fn are_possible(&self) -> bool {
        self.friction.is_some() && !self.pairs.is_empty()
    }

    /// The same after a change: nodes elsewhere have the pairs they had.
    pub(super) fn refresh(&mut self, near: &Near, lattice: &Lattice, cracks: &Cracks) {
        let node_of = |pair: &FacePair| pair.node as usize;
        let forks = cracks.forks();
        let mut pairs = Vec::with_capacity(self.pairs.len() + 32);
        let mut before = self.pairs.as_slice();
        for node in lattice.fields().divided_nodes() {
            let skipped = before.partition_point(|pair| node_of(pair) < node);
            let (own, rest) = before[skipped..].split_at(before[skipped..].partition_point(|p| node_of(p) == node));
            before = rest;
            if near.contains(lattice.grid.position(node)) {
                let first = pairs.len();
                add_pairs_of_node(lattice, node, cracks, &forks, &mut pairs);
                // What the faces did to each other in this step they did, however the node is divided now: tips may be
                // measured again before the next.
                for before in own {
                    if let Some(now) = pairs[first..].iter_mut().find(|p| p.crack == before.crack) {
                        (0..2).for_each(|axis| now.force[axis] += before.force[axis]);
                    }
                }
            } else {
                let now = |p: &FacePair| FacePair { segment: near.segment_now(p.crack, p.segment), ..*p };
                pairs.extend(own.iter().map(now));
            }
        }
        self.pairs = pairs;
    }

    /// The least and the widest gap of all pairs along their normals [m].
    #[cfg(test)]
    pub(super) fn least_and_widest_gap(&self, probes: &Probes, motion: &Motion) -> [f64; 2] {
        let along =
            |pair: &FacePair| probes.segment_normal(pair.crack, pair.segment, motion).map(|n| pair.gap(motion).dot(&n));
        let gaps = self.pairs.iter().filter_map(along);
        gaps.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, widest], gap| [least.min(gap), widest.max(gap)])
    }

    /// Forgets the forces of the step before.
    pub(super) fn forget_forces(&mut self) {
        self.pairs.iter_mut().for_each(|pair| pair.force = [0.0; 2]);
    }

    /// Applies contact to all pairs: impulses within the time `kick` [s].
    pub(super) fn resolve(&mut self, mass: &[f64], probes: &Probes, motion: &mut Motion, kick: f64, time_step: f64) {
        let Some(friction) = self.friction else { return };
        let longest_slide = self.longest_slide;
        let mut meeting: Vec<(usize, Vector, f64)> = Vec::new();
        for pairs in self.pairs.chunk_by_mut(|p, q| p.node == q.node) {
            meeting.clear();
            for (k, pair) in pairs.iter().enumerate() {
                let gap = pair.gap(motion);
                if gap == Vector::zeros() && pair.speed(motion) == Vector::zeros() {
                    continue;
                }
                let Some(n) = probes.segment_normal(pair.crack, pair.segment, motion) else { continue };
                // Faces that have slid apart touch others than they faced at rest.
                if (gap - n * gap.dot(&n)).norm() > longest_slide {
                    continue;
                }
                // What is left of the gap may be used up in this step; faces that overlap stay as they are.
                meeting.push((k, n, -gap.dot(&n).max(0.0) / time_step));
            }
            let rounds = if meeting.len() > 1 { ROUNDS } else { 1 };
            for _ in 0..rounds {
                // All see the same velocities, and each has its part of the mass of a field that it shares: none comes
                // before another, and together they do no more than they may.
                let part = |field: u32| {
                    let sharing = meeting.iter().filter(|m| pairs[m.0].above == field || pairs[m.0].below == field);
                    mass[field as usize] / sharing.count() as f64
                };
                let impulse_of = |&(k, n, allowed): &(usize, Vector, f64)| {
                    let pair = &pairs[k];
                    let masses = [part(pair.above), part(pair.below)];
                    Some((k, face_impulse(pair.speed(motion), n, allowed, masses, friction)?))
                };
                let impulses: Vec<(usize, Vector)> = meeting.iter().filter_map(impulse_of).collect();
                for (k, impulse) in impulses {
                    let pair = &mut pairs[k];
                    let (a, b) = (pair.above as usize, pair.below as usize);
                    for axis in 0..2 {
                        pair.force[axis] += impulse[axis] / kick;
                        motion.velocity[axis][a] += impulse[axis] / mass[a];
                        motion.velocity[axis][b] -= impulse[axis] / mass[b];
                    }
                }
            }
        }
    }

    /// The forces of the last step between the faces of a crack along a stretch of it: place at rest [m] and force on
    /// the face above [N/m].
    pub(super) fn forces(&self, stretch: Stretch, lattice: &Lattice) -> impl Iterator<Item = (Point, Vector)> {
        let is_on = move |p: &FacePair| p.crack as usize == stretch.crack && stretch.has_segment(p.segment as usize);
        let pressed = self.pairs.iter().filter(move |p| is_on(p) && p.force != [0.0; 2]);
        pressed.map(|p| (lattice.position(p.above as usize), Vector::from(p.force)))
    }
}

impl FacePair {
    /// Displacement of the face above less that of the face below [m].
    fn gap(&self, motion: &Motion) -> Vector {
        motion.displacement(self.above as usize) - motion.displacement(self.below as usize)
    }

    /// Velocity of the face above less that of the face below [m/s].
    fn speed(&self, motion: &Motion) -> Vector {
        motion.velocity(self.above as usize) - motion.velocity(self.below as usize)
    }
}

fn add_pairs_of_node(
    lattice: &Lattice,
    node: usize,
    cracks: &Cracks,
    forks: &[(Point, Stretch)],
    pairs: &mut Vec<FacePair>,
) {
    let place = lattice.grid.position(node);
    for facing in lattice.fields().facing_pairs(&lattice.fields_with_mass(node)) {
        let Some(line) = cracks.get(facing.crack as usize) else { continue };
        let [above, below] = facing.above_and_below();
        // Around a fork the two sides of the trunk differ by both its branches: what differs by one faces across that.
        let is_of_trunk = |segment: &usize| {
            let is_near = |at: Point| (place - at).amax() <= lattice.division.around_fork();
            forks
                .iter()
                .any(|(at, trunk)| trunk.crack == facing.crack as usize && trunk.has_segment(*segment) && is_near(*at))
        };
        let segment = nearest_segment(lattice, facing.crack, line, place, |segment| !is_of_trunk(segment)) as u32;
        pairs.push(FacePair { above, below, node: node as u32, crack: facing.crack, segment, force: [0.0; 2] });
    }
}

/// The segment of a crack nearest to `place` of those that count.
fn nearest_segment(
    lattice: &Lattice,
    crack: u32,
    line: &Crack,
    place: Point,
    counts: impl Fn(&usize) -> bool + Copy,
) -> usize {
    // Around a vertex both its segments are equally near, up to round-off: the first one counts.
    let clearly = 1e-9 * lattice.grid.cell_size;
    let around = lattice.division.segments_around(crack, place);
    let (distance, segment) = nearest_of(around.into_iter().filter(counts), line, place, clearly);
    if distance < lattice.division.surroundings() - 2.0 * clearly {
        return segment;
    }
    // Ahead of a tip or beyond a mouth, where few nodes are, what is nearest may lie anywhere.
    nearest_of((0..line.points.len() - 1).filter(counts), line, place, clearly).1
}

/// Distance to the nearest of `segments` [m], which rise, and which it is; one counts as nearer than those before it
/// when it is so `clearly` [m].
fn nearest_of(segments: impl Iterator<Item = usize>, line: &Crack, place: Point, clearly: f64) -> (f64, usize) {
    segments.fold((f64::INFINITY, 0), |(nearest, segment), s| {
        let distance = fissure_plane::distance_to_segment(place, line.points[s], line.points[s + 1]);
        if distance < nearest - clearly { (distance, s) } else { (nearest, segment) }
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::Total;
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
        let clearly = 1e-9 * total.lattice.grid.cell_size;
        assert!(!total.contacts.pairs.is_empty());
        for pair in &total.contacts.pairs {
            let line = &cracks[pair.crack as usize];
            let place = total.lattice.position(pair.above as usize);
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
            let ahead = Vector::new(heading.cos(), heading.sin()) * (grown * total.lattice.grid.cell_size);
            if ahead != Vector::zeros() {
                let id = TipId::new(0, End::End);
                cracks.grow(id, &[cracks.position(id) + ahead]);
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
            let looks = |pair: &FacePair| {
                let place = total.lattice.position(pair.above as usize);
                total.lattice.division.segments_around(pair.crack, place).len()
            };
            total.contacts.pairs.iter().map(looks).max().unwrap()
        });
        assert!(most[0] < 40 && most[1] <= most[0] + 2, "{most:?}");
    }
}
