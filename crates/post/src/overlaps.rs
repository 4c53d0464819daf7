//! Fragments that lie in each other a little: contact is exact to a part of a cell, and what is smaller than a particle
//! moves as its neighbours do. Each such overlap is shared out, so that both fragments end on one line in its middle.
//!
//! ```text
//!            ┌──── boundary of a ───┐
//!      a     p  ·  ·  middle  ·  ·  q     b
//!            └──── boundary of b ───┘
//! ```
//! Going along both boundaries from p to q, each by parts of its length, the middle lies halfway between. The fragment
//! `a` loses what lies between its boundary and the middle, `b` the rest, whatever shape the overlap has: around every
//! place in it the two parts together wind once, so one of them at least contains it.
//!
//! An overlap that is wider belongs to the one that has particles in it, if that is one: faces of the other one have
//! ridden along with what lay beside them.

use crate::boolean::{Contour, Edge, Operation, Shape, SourceIndex, combine, twice_area};
use crate::lattice::{Chain, Claim, Enclosed, Lattice, Lens, Material, Overlaps, Tangle, rounded};
use crate::slivers::{is_narrower, without_slivers};
use crate::snap::GridPoint;
use crate::source::{Carried, SourceEdge};

/// How far what is taken off a fragment reaches beyond its boundary, in grid steps: more than rounding.
const OUTWARDS: f64 = 4.0;

/// Shares out what two of `fragments` have in common. Overlaps wider than `widest` [m] in the mean are no inaccuracy of
/// contact: these belong to the one of the two that alone has particles there, and stay where both have some, or none.
pub(crate) fn share_out_overlaps(fragments: &mut [Enclosed], widest: f64, material: &impl Material) {
    let lattice = Lattice::new(fragments);
    let Overlaps { lenses, tangles, claims } = lattice.overlaps(fragments, widest, material);
    let mut losses: Vec<Vec<Contour>> = vec![Vec::new(); fragments.len()];
    for Tangle { pair, region } in tangles {
        let loser = lattice.loser(pair, &region, fragments);
        losses[loser].extend(lattice.given_up(loser, &region, fragments, material));
    }
    for Claim { other, region, .. } in claims {
        losses[other].extend(lattice.given_up(other, &region, fragments, material));
    }
    for lens in lenses {
        for (fragment, loss) in lattice.halves(&lens, fragments) {
            losses[fragment].push(loss);
        }
    }
    for (fragment, loss) in fragments.iter_mut().zip(losses) {
        if !loss.is_empty() {
            let left = without_slivers(combine(&fragment.shapes, Operation::Cut, &loss));
            if !left.is_empty() {
                fragment.shapes = left;
                fragment.has_lost = true;
            }
        }
    }
}

impl Lattice {
    /// What each of the two fragments of a lens loses.
    fn halves(&self, lens: &Lens, fragments: &mut [Enclosed]) -> [(usize, Contour); 2] {
        let [a, b] = [&lens.sides[0], &lens.sides[1]];
        let scale = self.scales[a.0].max(self.scales[b.0]);
        let least = [a.0, b.0].map(|i| fragments[i].least * self.scales[i] as f64).into_iter().fold(0.0, f64::max);
        let forth = Chain::new(a.1.iter().map(|e| (e.a, e.b)).collect());
        let back = Chain::new(b.1.iter().rev().map(|e| (e.b, e.a)).collect());
        let middle = middle(&forth, &back, scale, least);
        let turned: Vec<(f64, GridPoint)> = middle.iter().rev().map(|&(part, place)| (1.0 - part, place)).collect();
        [(a, middle), (b, turned)].map(|((fragment, side), middle)| {
            (*fragment, self.loss(side, &middle, self.firsts[*fragment], &mut fragments[*fragment], *fragment))
        })
    }

    /// The contour of `side`, edges of a fragment, and `middle`, along which its new boundary runs: places with the
    /// part of the length of the side that they belong to.
    fn loss(
        &self,
        side: &[Edge],
        middle: &[(f64, GridPoint)],
        first: u32,
        fragment: &mut Enclosed,
        number: usize,
    ) -> Contour {
        let scale = self.scales[number];
        let own = |p: GridPoint| GridPoint::new(rounded(p.x, scale), rounded(p.y, scale));
        let chain = Chain::new(side.iter().map(|e| (own(e.a), own(e.b))).collect());
        let local = |k: usize| SourceIndex(side[k].source.0 - first);
        // A little outside of the fragment, so that no hair of it is left along its boundary.
        let mut contour = Contour::with_capacity(2 * side.len() + middle.len());
        for (k, &(a, b)) in chain.edges.iter().enumerate() {
            let out = outwards(a, b);
            let [a, b] = [a, b].map(|p| GridPoint::new(p.x + out.x, p.y + out.y));
            if let Some(last) = contour.last().copied() {
                contour.push(Edge { a: last.b, b: a, source: local(k) });
            }
            contour.push(Edge { a, b, source: local(k) });
        }
        // The ends of the middle are those of the side, whatever grid they were rounded to.
        let ends = (chain.edges[0].0, chain.edges[side.len() - 1].1);
        let last = middle.len() - 1;
        let place = |k: usize| match k {
            0 => ends.0,
            _ if k == last => ends.1,
            _ => own(middle[k].1),
        };
        let carried = |k: usize| {
            let (edge, point) = chain.at(middle[k].0);
            fragment.sources[local(edge).0 as usize].at(point)
        };
        let outer = (contour[0].a, contour[contour.len() - 1].b);
        contour.push(Edge { a: outer.1, b: ends.1, source: local(side.len() - 1) });
        let new: Vec<SourceEdge> = (0..last)
            .map(|k| {
                let (edge, _) = chain.at(0.5 * (middle[k].0 + middle[k + 1].0));
                let source = &fragment.sources[local(edge).0 as usize];
                // Lengths along another line have nothing to do with those along this one.
                let along = |k: usize| {
                    let Carried { arc, history, .. } = source.at(chain.at(middle[k].0).1);
                    Carried { arc, history, ..carried(k) }
                };
                SourceEdge { a: place(k), b: place(k + 1), carried: [along(k), along(k + 1)], slot: source.slot }
            })
            .collect();
        for edge in new.into_iter().rev() {
            contour.push(Edge { a: edge.b, b: edge.a, source: SourceIndex(fragment.sources.len() as u32) });
            fragment.sources.push(edge);
        }
        contour.push(Edge { a: ends.0, b: outer.0, source: local(0) });
        contour.retain(|edge| edge.a != edge.b);
        contour
    }

    /// Whether a region is all that there is of a fragment.
    fn is_all(&self, region: &Shape, fragment: &Enclosed, number: usize) -> bool {
        let scale = i128::from(self.scales[number]);
        let of_fragment: i128 = fragment.shapes.iter().flatten().map(|contour| twice_area(contour)).sum();
        region.iter().map(|contour| twice_area(contour)).sum::<i128>() >= of_fragment * scale * scale
    }

    /// Which of `pair` gives up an overlap of another form: the larger one makes room for the other one, or the smaller
    /// one where it is too thin to be kept.
    fn loser(&self, [a, b]: [usize; 2], region: &Shape, fragments: &[Enclosed]) -> usize {
        let area = |i: usize| {
            let twice: i128 = fragments[i].shapes.iter().flatten().map(|contour| twice_area(contour)).sum();
            twice as f64 * fragments[i].grid.step.powi(2)
        };
        let (larger, smaller) = if area(b) > area(a) { (b, a) } else { (a, b) };
        // A hole so narrow would be filled again.
        let least = fragments[larger].least * self.scales[larger] as f64;
        let is_narrow = region.iter().all(|contour| is_narrower(contour, least));
        if is_narrow && !self.is_all(region, &fragments[smaller], smaller) { smaller } else { larger }
    }

    /// What a fragment loses that gives up a region of it.
    fn given_up(
        &self,
        loser: usize,
        region: &Shape,
        fragments: &mut [Enclosed],
        material: &impl Material,
    ) -> Vec<Contour> {
        let (scale, first) = (self.scales[loser], self.firsts[loser]);
        let fragment = &mut fragments[loser];
        let own = |p: GridPoint| GridPoint::new(rounded(p.x, scale), rounded(p.y, scale));
        let carried = |fragment: &Enclosed, p: GridPoint| {
            let (rest, velocity) = material.at(fragment, fragment.grid.place(p))?;
            Some(Carried { history: fragment.sources[0].carried[0].history, ..Carried::within(rest, velocity) })
        };
        let mut contours = Vec::with_capacity(region.len());
        for contour in region {
            let mut lost = Contour::with_capacity(contour.len());
            for edge in contour {
                let (from, to) = (own(edge.a), own(edge.b));
                let source = if self.owner(edge) == loser {
                    SourceIndex(edge.source.0 - first)
                } else {
                    let beside = fragment.sources[0];
                    let ends = [to, from].map(|p| carried(fragment, p).unwrap_or(beside.carried[0]));
                    fragment.sources.push(SourceEdge { a: to, b: from, carried: ends, ..beside });
                    SourceIndex(fragment.sources.len() as u32 - 1)
                };
                lost.push(Edge { a: from, b: to, source });
            }
            contours.push(lost);
        }
        contours
    }
}

/// The line halfway between two chains with the same ends, with the part of the length at each place: first and last
/// place included, all on multiples of `scale`, no two nearer to each other than `least`.
fn middle(forth: &Chain, back: &Chain, scale: i64, least: f64) -> Vec<(f64, GridPoint)> {
    let mut parts: Vec<f64> = forth.parts.iter().chain(&back.parts).copied().collect();
    parts.sort_by(f64::total_cmp);
    let halfway = |part: f64| {
        let (p, q) = (forth.at(part).1, back.at(part).1);
        let multiple = |twice: i64| rounded(twice, 2 * scale) * scale;
        GridPoint::new(multiple(p.x + q.x), multiple(p.y + q.y))
    };
    let distance = |p: GridPoint, q: GridPoint| ((p.x - q.x) as f64).hypot((p.y - q.y) as f64);
    let end = (1.0, halfway(1.0));
    let mut places = vec![(0.0, halfway(0.0))];
    for part in parts {
        let (place, last) = (halfway(part), places[places.len() - 1].1);
        let is_apart = |other: GridPoint| place != other && distance(place, other) >= least;
        if is_apart(last) && is_apart(end.1) {
            places.push((part, place));
        }
    }
    places.push(end);
    places
}

/// A way of [`OUTWARDS`] grid steps to the right of an edge.
fn outwards(a: GridPoint, b: GridPoint) -> GridPoint {
    let (x, y) = ((b.x - a.x) as f64, (b.y - a.y) as f64);
    let factor = OUTWARDS / x.hypot(y).max(1.0);
    GridPoint::new((y * factor).round() as i64, (-x * factor).round() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boolean::material;
    use crate::interior::encloses;
    use crate::slot::Slot;
    use crate::snap::Grid;
    use fissure_scene::{Point, Vector};

    const LEAST: f64 = 100.0;

    fn enclosed(piece: u32, ring: &[(i64, i64)]) -> Enclosed {
        let carried = [Carried::within(Point::origin(), Vector::zeros()); 2];
        let point = |&(x, y): &(i64, i64)| GridPoint::new(x, y);
        let edges = ring.iter().zip(ring.iter().cycle().skip(1));
        let edge = |(a, b)| SourceEdge { a: point(a), b: point(b), carried, slot: Slot::Inside };
        let sources: Vec<SourceEdge> = edges.map(edge).collect();
        let grid = Grid::covering(&[Point::new(1.0, 1.0)], 0.0);
        Enclosed { body: 0, piece, grid, shapes: material(&sources), sources, least: LEAST, has_lost: false }
    }

    /// Particles of fragments by number of these and place.
    struct Particles<'a>(&'a [(u32, Point)]);

    impl Material for Particles<'_> {
        fn at(&self, _: &Enclosed, _: Point) -> Option<(Point, Vector)> {
            None
        }

        fn is_in(&self, fragment: &Enclosed, contours: &[Vec<Point>]) -> bool {
            let of_fragment = self.0.iter().filter(|(piece, _)| *piece == fragment.piece);
            of_fragment.into_iter().any(|(_, place)| encloses(contours, *place))
        }
    }

    fn area(fragment: &Enclosed) -> f64 {
        0.5 * fragment.shapes.iter().flatten().map(|contour| twice_area(contour)).sum::<i128>() as f64
    }

    /// Truth: by hand. A crumb lies across a square, two ends of it beyond: where it is as wide as what may be shown
    /// the square makes room for it, where it is thinner, so that the room would be filled again, it loses that part
    /// itself.
    #[test]
    fn thin_parts_of_crumbs_make_room_for_what_they_lie_in() {
        const SIDE: i64 = 10_000;
        let square = [(0, 0), (SIDE, 0), (SIDE, SIDE), (0, SIDE)];
        for (width, parts) in [(400, [2, 1]), (40, [1, 2])] {
            let [low, high] = [5000, 5000 + width];
            let [left, right] = [-900, SIDE + 900];
            let crumb = [
                [(left, 4000), (-100, 4000), (-100, low), (SIDE + 100, low), (SIDE + 100, 4000), (right, 4000)],
                [(right, 6000), (SIDE + 100, 6000), (SIDE + 100, high), (-100, high), (-100, 6000), (left, 6000)],
            ];
            let mut fragments = [enclosed(0, &square), enclosed(1, &crumb.concat())];
            let before = [0, 1].map(|i| area(&fragments[i]));
            share_out_overlaps(&mut fragments, f64::INFINITY, &Particles(&[]));
            assert_eq!(fragments.each_ref().map(|fragment| fragment.shapes.len()), parts, "{width}");
            let loser = usize::from(width < LEAST as i64);
            for (i, fragment) in fragments.iter().enumerate() {
                let lost = if i == loser { (width * SIDE) as f64 } else { 0.0 };
                assert_eq!(area(fragment), before[i] - lost, "{width}");
            }
        }
    }

    /// Truth: by hand. Two squares lie in each other by more than contact is inexact: what only one of them has a
    /// particle in belongs to that, whichever it is; where both have one, or none, both are shown as they are.
    #[test]
    fn what_only_one_has_particles_in_belongs_to_that() {
        const SIDE: i64 = 10_000;
        let ring = |x: i64| [(x, 0), (x + SIDE, 0), (x + SIDE, SIDE), (x, SIDE)];
        let squares = || [enclosed(0, &ring(0)), enclosed(1, &ring(SIDE / 2))];
        let step = squares()[0].grid.step;
        let within = step * Point::new(0.75 * SIDE as f64, 0.5 * SIDE as f64);
        let beside = step * Point::new(0.25 * SIDE as f64, 0.5 * SIDE as f64);
        for (particles, parts) in [
            (&[(0, within), (0, beside)][..], [1.0, 0.5]),
            (&[(1, within), (0, beside)], [0.5, 1.0]),
            (&[(0, within), (1, within)], [1.0, 1.0]),
            (&[(0, beside)], [1.0, 1.0]),
        ] {
            let mut fragments = squares();
            share_out_overlaps(&mut fragments, 10.0 * step, &Particles(particles));
            for (fragment, part) in fragments.iter().zip(parts) {
                assert_eq!(area(fragment), part * (SIDE * SIDE) as f64, "{particles:?}");
            }
        }
    }
}
