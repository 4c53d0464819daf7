//! Which fragment each particle belongs to.

use crate::crack::Crack;
use crate::crack::cracks::ENDS;
use crate::particles::Particles;
use fissure_scene::{Fragments, RestCrack, RestRing, Scene};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

/// Splits the fragments in `numbers` (one number per particle) where the cracks, at rest, have cut a body through. A
/// fragment that splits keeps its number for the part with the most particles (of equally many, with the first); the
/// others get the next free numbers, in the order of their first particles. What is so small that it holds no particle
/// is no fragment.
pub(crate) fn split(scene: &Scene, particles: &Particles, cracks: &[Crack], numbers: &mut [u32]) {
    let fragments = at_rest(scene, cracks);
    let known: BTreeSet<u32> = numbers.iter().copied().collect();
    if fragments.list().len() <= known.len() {
        return;
    }
    let part_of = |p: usize| fragments.at(particles.body[p], particles.rest[p]);
    // Each part of each fragment by its number and place: how many particles it has, and the first of them.
    let parts: Vec<Option<usize>> = (0..particles.len()).map(part_of).collect();
    let mut sizes = BTreeMap::<(u32, usize), (usize, usize)>::new();
    for (p, (&number, &part)) in numbers.iter().zip(&parts).enumerate() {
        // A particle on a ring may lie outside by rounding; it stays with the part that keeps the number.
        if let Some(part) = part {
            sizes.entry((number, part)).or_insert((0, p)).0 += 1;
        }
    }
    let mut kept = BTreeMap::<u32, (usize, Reverse<usize>, usize)>::new();
    for (&(number, part), &(count, first)) in &sizes {
        let candidate = (count, Reverse(first), part);
        kept.entry(number).and_modify(|best| *best = candidate.max(*best)).or_insert(candidate);
    }
    let mut others: Vec<(usize, (u32, usize))> =
        sizes.iter().filter(|((number, part), _)| kept[number].2 != *part).map(|(key, size)| (size.1, *key)).collect();
    others.sort_unstable();
    let next = known.last().map_or(0, |last| last + 1);
    let new: BTreeMap<(u32, usize), u32> = others.into_iter().map(|(_, key)| key).zip(next..).collect();
    for (number, part) in numbers.iter_mut().zip(parts) {
        let split_off = part.and_then(|part| new.get(&(*number, part)));
        *number = split_off.copied().unwrap_or(*number);
    }
}

/// The parts that the cracks cut the bodies of the scene into; lines are known by their place among the rings of all
/// bodies and among `cracks`.
pub(crate) fn at_rest(scene: &Scene, cracks: &[Crack]) -> Fragments {
    let bodies = scene.bodies.iter().zip(0..);
    let rings: Vec<RestRing<'_>> = bodies
        .flat_map(|(body, number)| body.region.rings().map(move |points| RestRing { body: number, points }))
        .collect();
    let cracks: Vec<RestCrack<'_>> = cracks
        .iter()
        .zip(0..)
        .map(|(c, crack)| RestCrack { crack, body: c.body, points: &c.points, ends: ENDS.map(|end| c.end(end)) })
        .collect();
    Fragments::new(&rings, &cracks)
}

/// First numbers: one fragment per body.
pub(crate) fn of_bodies(particles: &Particles) -> Vec<u32> {
    particles.body.clone()
}
