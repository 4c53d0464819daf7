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

use crate::boolean::{Contour, Edge, Operation, Shape, SourceIndex, combine, common, covered_twice, twice_area};
use crate::slivers::{is_narrower, is_sliver, without_slivers};
use crate::snap::{Grid, GridPoint};
use crate::source::{Carried, SourceEdge};
use fissure_scene::{Point, Vector};
use std::collections::BTreeSet;

/// How far what is taken off a fragment reaches beyond its boundary, in grid steps: more than rounding.
const OUTWARDS: f64 = 4.0;

/// What the boundary of a fragment encloses.
#[derive(Debug, Clone)]
pub(crate) struct Enclosed {
    /// Index of the body.
    pub(crate) body: u32,
    /// Number of the fragment.
    pub(crate) piece: u32,
    /// The grid of its body.
    pub(crate) grid: Grid,
    /// Valid polygons.
    pub(crate) shapes: Vec<Shape>,
    /// Where their edges come from.
    pub(crate) sources: Vec<SourceEdge>,
    /// Shortest edge that is made, in grid steps.
    pub(crate) least: f64,
    /// Whether something has been taken off since its boundary was made.
    pub(crate) has_lost: bool,
}

impl Enclosed {
    /// Body and number.
    pub(crate) fn object(&self) -> (u32, u32) {
        (self.body, self.piece)
    }
}

/// Shares out what two of `fragments` have in common, but for overlaps wider than `widest` [m] in the mean, which are
/// no inaccuracy of contact.
///
/// `material` says where the material of a fragment, known by its place in the list, was at rest [m], and how fast it
/// is [m/s].
pub(crate) fn share_out_overlaps(
    fragments: &mut [Enclosed],
    widest: f64,
    material: impl Fn(&Enclosed, Point) -> Option<(Point, Vector)>,
) {
    let lattice = Lattice::new(fragments);
    let mut regions = lattice.regions(fragments);
    regions.retain(|shape| lattice.is_shared(shape, widest));
    let mut losses: Vec<Vec<Contour>> = vec![Vec::new(); fragments.len()];
    let mut tangled = BTreeSet::new();
    let mut lenses = Vec::new();
    for region in regions {
        match lattice.lens(&region) {
            Some(lens) => lenses.push(lens),
            None => tangled.extend(lattice.pairs_near(&region, fragments)),
        }
    }
    lenses.retain(|lens| !tangled.contains(&lens.fragments()));
    for pair in tangled {
        for region in lattice.common(pair, fragments).into_iter().filter(|shape| lattice.is_shared(shape, widest)) {
            match lattice.lens(&region) {
                Some(lens) => lenses.push(lens),
                None => {
                    let (larger, contours) = lattice.given_up(pair, &region, fragments, &material);
                    losses[larger].extend(contours);
                }
            }
        }
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

/// A grid that all places of all fragments are on: the finest of theirs.
struct Lattice {
    /// Distance between neighbouring points [m].
    step: f64,
    /// For each fragment how many steps its own have.
    scales: Vec<i64>,
    /// For each fragment the number of its first source among all.
    firsts: Vec<u32>,
}

/// A place where two fragments overlap: the boundary of each, from one of the two places where they cross to the other,
/// in opposite directions. Edges on the lattice, sources numbered among all.
struct Lens {
    sides: [(usize, Vec<Edge>); 2],
}

impl Lens {
    fn fragments(&self) -> [usize; 2] {
        let [a, b] = [self.sides[0].0, self.sides[1].0];
        [a.min(b), a.max(b)]
    }
}

impl Lattice {
    fn new(fragments: &[Enclosed]) -> Self {
        let step = fragments.iter().map(|f| f.grid.step).fold(f64::INFINITY, f64::min);
        let mut first = 0;
        let mut firsts = Vec::with_capacity(fragments.len());
        for fragment in fragments {
            firsts.push(first);
            first += fragment.sources.len() as u32;
        }
        Self { step, scales: fragments.iter().map(|f| (f.grid.step / step) as i64).collect(), firsts }
    }

    /// The edges of a fragment, on the lattice.
    fn edges<'a>(&self, fragment: usize, fragments: &'a [Enclosed]) -> impl Iterator<Item = Edge> + use<'a> {
        let (scale, first) = (self.scales[fragment], self.firsts[fragment]);
        let scaled = move |p: GridPoint| GridPoint::new(p.x * scale, p.y * scale);
        let edges = fragments[fragment].shapes.iter().flatten().flatten();
        edges.map(move |e| Edge { a: scaled(e.a), b: scaled(e.b), source: SourceIndex(first + e.source.0) })
    }

    /// The fragment of an edge.
    fn owner(&self, edge: &Edge) -> usize {
        self.firsts.partition_point(|first| *first <= edge.source.0) - 1
    }

    /// All places that are in two fragments or more.
    fn regions(&self, fragments: &[Enclosed]) -> Vec<Shape> {
        if fragments.len() < 2 {
            return Vec::new();
        }
        covered_twice((0..fragments.len()).flat_map(|i| self.edges(i, fragments)))
    }

    /// What two fragments have in common.
    fn common(&self, [a, b]: [usize; 2], fragments: &[Enclosed]) -> Vec<Shape> {
        common(self.edges(a, fragments), self.edges(b, fragments))
    }

    /// Whether an overlap is more than rounding and not wider than `widest` [m].
    fn is_shared(&self, shape: &Shape, widest: f64) -> bool {
        let area = 0.5 * shape.iter().map(|contour| twice_area(contour)).sum::<i128>() as f64;
        let half: f64 = 0.5 * shape.iter().flatten().map(length).sum::<f64>();
        !shape.iter().all(|contour| is_sliver(contour)) && area * self.step <= widest * half
    }

    /// The two sides of an overlap; none where it has another form.
    fn lens(&self, shape: &Shape) -> Option<Lens> {
        let [contour] = shape.as_slice() else { return None };
        let count = contour.len();
        let owner = |i: usize| self.owner(&contour[i % count]);
        let mut begins = (0..count).filter(|&i| owner(i) != owner(i + count - 1));
        let (first, second) = (begins.next()?, begins.next()?);
        if begins.next().is_some() {
            return None;
        }
        let side = |from: usize, to: usize| (owner(from), (from..to).map(|i| contour[i % count]).collect());
        Some(Lens { sides: [side(first, second), side(second, first + count)] })
    }

    /// All pairs of fragments around a region.
    fn pairs_near(&self, region: &Shape, fragments: &[Enclosed]) -> Vec<[usize; 2]> {
        let [low, high] = bounds(region.iter().flatten().copied());
        let is_near = |&i: &usize| {
            let [from, to] = bounds(self.edges(i, fragments));
            from.x <= high.x && low.x <= to.x && from.y <= high.y && low.y <= to.y
        };
        let near: Vec<usize> = (0..fragments.len()).filter(is_near).collect();
        near.iter().enumerate().flat_map(|(k, &i)| near[k + 1..].iter().map(move |&j| [i, j])).collect()
    }

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

    /// An overlap of another form: the larger one of `pair` makes room for the other one, or the smaller one where it
    /// is too thin to be kept. Returns which one it is, and what it loses.
    fn given_up(
        &self,
        [a, b]: [usize; 2],
        region: &Shape,
        fragments: &mut [Enclosed],
        material: &impl Fn(&Enclosed, Point) -> Option<(Point, Vector)>,
    ) -> (usize, Vec<Contour>) {
        let area = |i: usize| {
            let twice: i128 = fragments[i].shapes.iter().flatten().map(|contour| twice_area(contour)).sum();
            twice as f64 * fragments[i].grid.step.powi(2)
        };
        let (larger, smaller) = if area(b) > area(a) { (b, a) } else { (a, b) };
        // A hole so narrow would be filled again.
        let least = fragments[larger].least * self.scales[larger] as f64;
        let is_narrow = region.iter().all(|contour| is_narrower(contour, least));
        let larger = if is_narrow && !self.is_all(region, &fragments[smaller], smaller) { smaller } else { larger };
        let (scale, first) = (self.scales[larger], self.firsts[larger]);
        let fragment = &mut fragments[larger];
        let own = |p: GridPoint| GridPoint::new(rounded(p.x, scale), rounded(p.y, scale));
        let carried = |fragment: &Enclosed, p: GridPoint| {
            let (rest, velocity) = material(fragment, fragment.grid.place(p))?;
            Some(Carried { history: fragment.sources[0].carried[0].history, ..Carried::within(rest, velocity) })
        };
        let mut contours = Vec::with_capacity(region.len());
        for contour in region {
            let mut lost = Contour::with_capacity(contour.len());
            for edge in contour {
                let (from, to) = (own(edge.a), own(edge.b));
                let source = if self.owner(edge) == larger {
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
        (larger, contours)
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

/// Edges one after the other.
struct Chain {
    edges: Vec<(GridPoint, GridPoint)>,
    /// The part of the length where each edge ends.
    parts: Vec<f64>,
}

impl Chain {
    fn new(edges: Vec<(GridPoint, GridPoint)>) -> Self {
        let mut arc = 0.0;
        let mut parts: Vec<f64> = edges
            .iter()
            .map(|(a, b)| {
                arc += ((b.x - a.x) as f64).hypot((b.y - a.y) as f64);
                arc
            })
            .collect();
        parts.iter_mut().for_each(|part| *part /= arc);
        Self { edges, parts }
    }

    /// The edge at a part of the length, and the place.
    fn at(&self, part: f64) -> (usize, GridPoint) {
        let edge = self.parts.partition_point(|end| *end < part).min(self.edges.len() - 1);
        let begin = if edge == 0 { 0.0 } else { self.parts[edge - 1] };
        let (a, b) = self.edges[edge];
        let length = self.parts[edge] - begin;
        let along = if length > 0.0 { ((part - begin) / length).clamp(0.0, 1.0) } else { 1.0 };
        let between = |a: i64, b: i64| a + ((b - a) as f64 * along).round() as i64;
        (edge, GridPoint::new(between(a.x, b.x), between(a.y, b.y)))
    }
}

/// A way of [`OUTWARDS`] grid steps to the right of an edge.
fn outwards(a: GridPoint, b: GridPoint) -> GridPoint {
    let (x, y) = ((b.x - a.x) as f64, (b.y - a.y) as f64);
    let factor = OUTWARDS / x.hypot(y).max(1.0);
    GridPoint::new((y * factor).round() as i64, (-x * factor).round() as i64)
}

fn length(edge: &Edge) -> f64 {
    ((edge.b.x - edge.a.x) as f64).hypot((edge.b.y - edge.a.y) as f64)
}

/// `number` in units of `unit`, rounded.
fn rounded(number: i64, unit: i64) -> i64 {
    (number + unit / 2).div_euclid(unit)
}

/// The lowest and the highest coordinates of edges.
fn bounds(edges: impl Iterator<Item = Edge>) -> [GridPoint; 2] {
    let (mut low, mut high) = (GridPoint::new(i64::MAX, i64::MAX), GridPoint::new(i64::MIN, i64::MIN));
    for Edge { a, .. } in edges {
        low = GridPoint::new(low.x.min(a.x), low.y.min(a.y));
        high = GridPoint::new(high.x.max(a.x), high.y.max(a.y));
    }
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boolean::material;
    use crate::slot::Slot;

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
            share_out_overlaps(&mut fragments, f64::INFINITY, |_, _| None);
            assert_eq!(fragments.each_ref().map(|fragment| fragment.shapes.len()), parts, "{width}");
            let loser = usize::from(width < LEAST as i64);
            for (i, fragment) in fragments.iter().enumerate() {
                let lost = if i == loser { (width * SIDE) as f64 } else { 0.0 };
                assert_eq!(area(fragment), before[i] - lost, "{width}");
            }
        }
    }
}
