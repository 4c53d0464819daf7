//! Which fragment each particle belongs to.

use crate::crack::Crack;
use crate::crack::division::{CrackLine, Division, LineEnd, TipCut};
use crate::particles::Particles;
use fissure_scene::{CrackEnd, End, TipDivision};
use std::collections::HashMap;

/// Splits the fragments in `numbers` (one number per particle) where the cracks, at rest, have cut neighbours apart. A
/// fragment that splits keeps its number for the part with the first particle; the others get the next free numbers, in
/// the order of their first particles.
pub(crate) fn split(particles: &Particles, cracks: &[Crack], cell_size: f64, numbers: &mut [u32]) {
    let s = particles.spacing;
    // Neighbours are one spacing apart; an open end goes so far on that no pair slips past it.
    let lines: Vec<CrackLine> = cracks
        .iter()
        .enumerate()
        .map(|(i, c)| {
            let end = |e: CrackEnd| if e == CrackEnd::Tip { LineEnd::Tip } else { LineEnd::Open(0.75 * s) };
            CrackLine {
                crack: i as u32,
                points: c.points.clone(),
                start: end(c.end(End::Start)),
                end: end(c.end(End::End)),
                trunk: Vec::new(),
            }
        })
        .collect();
    let division = Division::new(&lines, TipDivision::LineCrossing, TipCut::PLAIN, cell_size, s, s / cell_size);
    let mut parent: Vec<usize> = (0..particles.len()).collect();
    fn root(parent: &mut [usize], mut p: usize) -> usize {
        while parent[p] != p {
            parent[p] = parent[parent[p]];
            p = parent[p];
        }
        p
    }
    for p in 0..particles.len() {
        for step in [[1, 0], [0, 1]] {
            let place = particles.place[p];
            let Some(q) = particles.at([place[0] + step[0], place[1] + step[1]]) else { continue };
            // A crack does not cut another body beside it.
            let is_own = |crack: u32| cracks[crack as usize].body == particles.body[p];
            let is_parted = division.parts(particles.rest[p], particles.rest[q], is_own);
            if particles.body[p] == particles.body[q] && !is_parted {
                let (a, b) = (root(&mut parent, p), root(&mut parent, q));
                // The lower number is the root, so a fragment is known by its first particle.
                parent[a.max(b)] = a.min(b);
            }
        }
    }
    let mut next = numbers.iter().max().map_or(0, |&m| m + 1);
    let mut number: HashMap<(u32, usize), u32> = HashMap::new();
    let mut kept: HashMap<u32, usize> = HashMap::new();
    for p in 0..particles.len() {
        let group = root(&mut parent, p);
        let old = numbers[p];
        let new = *number.entry((old, group)).or_insert_with(|| {
            if *kept.entry(old).or_insert(group) == group {
                old
            } else {
                next += 1;
                next - 1
            }
        });
        numbers[p] = new;
    }
}

/// First numbers: one fragment per body.
pub(crate) fn of_bodies(particles: &Particles) -> Vec<u32> {
    particles.body.clone()
}
