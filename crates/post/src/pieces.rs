//! Pieces: the fragments of a frame with the numbers that the simulation gives them.

use fissure_scene::{Fragment, Fragments, Frame, Line, Point};
use std::collections::BTreeMap;

/// The number of each of `fragments` in the simulation: [`Fragments::numbers`].
///
/// What is so small that it holds no particle goes with the fragment that it has the longest crack face in common with,
/// or else with the particle nearest to it at rest; of a body without particles all is number 0.
pub(crate) fn numbers(fragments: &Fragments, frame: &Frame) -> Vec<u32> {
    let mut numbers = fragments.numbers(&frame.particles);
    let others = beside_each_other(fragments, &numbers);
    // From those with a particle outwards, one fragment farther in each round.
    loop {
        let before = numbers.clone();
        for (&i, faces) in &others {
            let known = faces.iter().filter_map(|(&j, &length)| before[j].map(|number| (length, number)));
            let longest = known.max_by(|p, q| p.0.total_cmp(&q.0).then(q.1.cmp(&p.1)));
            numbers[i] = before[i].or(longest.map(|(_, number)| number));
        }
        if numbers == before {
            break;
        }
    }
    let list = fragments.list().iter();
    numbers.iter().zip(list).map(|(&number, fragment)| number.unwrap_or_else(|| nearest(fragment, frame))).collect()
}

/// For each fragment without a number those on the other side of the cracks that bound it, with the length of crack in
/// common [m].
fn beside_each_other(fragments: &Fragments, numbers: &[Option<u32>]) -> BTreeMap<usize, BTreeMap<usize, f64>> {
    let mut others = BTreeMap::<usize, BTreeMap<usize, f64>>::new();
    if numbers.iter().all(Option::is_some) {
        return others;
    }
    // A stretch of a crack is known by its ends, in the direction of its face above.
    let key = |[a, b]: [Point; 2]| [a.x, a.y, b.x, b.y].map(f64::to_bits);
    let edges =
        || fragments.list().iter().enumerate().flat_map(|(i, f)| f.boundaries.iter().flatten().map(move |e| (i, e)));
    let mut above = BTreeMap::new();
    for (i, edge) in edges() {
        if let Line::Above(crack) = edge.line {
            above.insert((crack, key(edge.rest)), i);
        }
    }
    for (i, edge) in edges() {
        let Line::Below(crack) = edge.line else { continue };
        let [b, a] = edge.rest;
        let Some(&j) = above.get(&(crack, key([a, b]))) else { continue };
        for (one, other) in [(i, j), (j, i)] {
            if numbers[one].is_none() && one != other {
                *others.entry(one).or_default().entry(other).or_default() += (b - a).norm();
            }
        }
    }
    others
}

/// The number of the particle of its body nearest to the first corner of a fragment at rest.
fn nearest(fragment: &Fragment, frame: &Frame) -> u32 {
    let (particles, corner) = (&frame.particles, fragment.boundaries[0][0].rest[0]);
    let distance = |p: &usize| (particles.rest[*p] - corner).norm_squared();
    let of_body = (0..particles.len()).filter(|&p| particles.body[p] == fragment.body);
    of_body.min_by(|p, q| distance(p).total_cmp(&distance(q))).map_or(0, |p| particles.piece[p])
}
