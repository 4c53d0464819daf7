//! Fragments of all bodies on one grid, and where they lie in each other.

use crate::boolean::{Edge, Shape, SourceIndex, common, covered_twice, twice_area};
use crate::slivers::is_sliver;
use crate::snap::{Grid, GridPoint};
use crate::source::SourceEdge;
use fissure_scene::{Point, Vector};
use std::collections::BTreeSet;

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

/// A grid that all places of all fragments are on: the finest of theirs.
pub(crate) struct Lattice {
    /// Distance between neighbouring points [m].
    pub(crate) step: f64,
    /// For each fragment how many steps its own have.
    pub(crate) scales: Vec<i64>,
    /// For each fragment the number of its first source among all.
    pub(crate) firsts: Vec<u32>,
}

/// A place where two fragments overlap: the boundary of each, from one of the two places where they cross to the other,
/// in opposite directions. Edges on the lattice, sources numbered among all.
pub(crate) struct Lens {
    pub(crate) sides: [(usize, Vec<Edge>); 2],
}

impl Lens {
    pub(crate) fn fragments(&self) -> [usize; 2] {
        let [a, b] = [self.sides[0].0, self.sides[1].0];
        [a.min(b), a.max(b)]
    }
}

/// An overlap of two fragments that has another form.
pub(crate) struct Tangle {
    pub(crate) pair: [usize; 2],
    pub(crate) region: Shape,
}

/// An overlap wider than contact is inexact, in which only one of the two has particles: faces of the other one have
/// ridden along with what lay beside them.
pub(crate) struct Claim {
    pub(crate) owner: usize,
    pub(crate) other: usize,
    pub(crate) region: Shape,
}

/// Where fragments lie in each other.
pub(crate) struct Overlaps {
    pub(crate) lenses: Vec<Lens>,
    pub(crate) tangles: Vec<Tangle>,
    pub(crate) claims: Vec<Claim>,
}

/// What is known of the material of fragments.
pub(crate) trait Material {
    /// Where what is at a place [m] in a fragment was at rest [m], and how fast it is [m/s].
    fn at(&self, fragment: &Enclosed, place: Point) -> Option<(Point, Vector)>;

    /// Whether a particle of a fragment is in a region between contours [m].
    fn is_in(&self, fragment: &Enclosed, contours: &[Vec<Point>]) -> bool;
}

impl Lattice {
    pub(crate) fn new(fragments: &[Enclosed]) -> Self {
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
    pub(crate) fn edges<'a>(&self, fragment: usize, fragments: &'a [Enclosed]) -> impl Iterator<Item = Edge> + use<'a> {
        let (scale, first) = (self.scales[fragment], self.firsts[fragment]);
        let scaled = move |p: GridPoint| GridPoint::new(p.x * scale, p.y * scale);
        let edges = fragments[fragment].shapes.iter().flatten().flatten();
        edges.map(move |e| Edge { a: scaled(e.a), b: scaled(e.b), source: SourceIndex(first + e.source.0) })
    }

    /// The fragment of an edge.
    pub(crate) fn owner(&self, edge: &Edge) -> usize {
        self.firsts.partition_point(|first| *first <= edge.source.0) - 1
    }

    /// All places that are in two fragments or more.
    fn regions(&self, fragments: &[Enclosed]) -> Vec<Shape> {
        if fragments.len() < 2 {
            return Vec::new();
        }
        covered_twice((0..fragments.len()).flat_map(|i| self.edges(i, fragments)))
    }

    /// Where fragments lie in each other, but for overlaps wider than `widest` [m] in the mean in which both have
    /// particles, or none. Where some have another form than that of a lens all of the pairs around are looked at one
    /// by one, as more than two may lie there.
    pub(crate) fn overlaps(&self, fragments: &[Enclosed], widest: f64, material: &impl Material) -> Overlaps {
        let real = |regions: Vec<Shape>| regions.into_iter().filter(|region| !region.iter().all(|c| is_sliver(c)));
        let mut found = Overlaps { lenses: Vec::new(), tangles: Vec::new(), claims: Vec::new() };
        let mut tangled = BTreeSet::new();
        for region in real(self.regions(fragments)) {
            match self.lens(&region).filter(|_| !self.is_wide(&region, widest)) {
                Some(lens) => found.lenses.push(lens),
                None => tangled.extend(self.pairs_near(&region, fragments)),
            }
        }
        found.lenses.retain(|lens| !tangled.contains(&lens.fragments()));
        for pair in tangled {
            for region in real(self.common(pair, fragments)) {
                if self.is_wide(&region, widest) {
                    found.claims.extend(self.claim(pair, region, fragments, material));
                } else if let Some(lens) = self.lens(&region) {
                    found.lenses.push(lens);
                } else {
                    found.tangles.push(Tangle { pair, region });
                }
            }
        }
        found
    }

    /// Which of a pair has particles in a region, if it is one.
    fn claim(
        &self,
        [a, b]: [usize; 2],
        region: Shape,
        fragments: &[Enclosed],
        material: &impl Material,
    ) -> Option<Claim> {
        let place = |edge: &Edge| self.step * Point::new(edge.a.x as f64, edge.a.y as f64);
        let contours: Vec<Vec<Point>> = region.iter().map(|contour| contour.iter().map(place).collect()).collect();
        match [a, b].map(|k| material.is_in(&fragments[k], &contours)) {
            [true, false] => Some(Claim { owner: a, other: b, region }),
            [false, true] => Some(Claim { owner: b, other: a, region }),
            _ => None,
        }
    }

    /// What two fragments have in common.
    pub(crate) fn common(&self, [a, b]: [usize; 2], fragments: &[Enclosed]) -> Vec<Shape> {
        common(self.edges(a, fragments), self.edges(b, fragments))
    }

    /// Whether an overlap is wider than `widest` [m] in the mean.
    fn is_wide(&self, shape: &Shape, widest: f64) -> bool {
        let area = 0.5 * shape.iter().map(|contour| twice_area(contour)).sum::<i128>() as f64;
        let half: f64 = 0.5 * shape.iter().flatten().map(length).sum::<f64>();
        area * self.step > widest * half
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
}

/// Edges one after the other.
pub(crate) struct Chain {
    pub(crate) edges: Vec<(GridPoint, GridPoint)>,
    /// The part of the length where each edge ends.
    pub(crate) parts: Vec<f64>,
}

impl Chain {
    pub(crate) fn new(edges: Vec<(GridPoint, GridPoint)>) -> Self {
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
    pub(crate) fn at(&self, part: f64) -> (usize, GridPoint) {
        let edge = self.parts.partition_point(|end| *end < part).min(self.edges.len() - 1);
        let begin = if edge == 0 { 0.0 } else { self.parts[edge - 1] };
        let (a, b) = self.edges[edge];
        let length = self.parts[edge] - begin;
        let along = if length > 0.0 { ((part - begin) / length).clamp(0.0, 1.0) } else { 1.0 };
        let between = |a: i64, b: i64| a + ((b - a) as f64 * along).round() as i64;
        (edge, GridPoint::new(between(a.x, b.x), between(a.y, b.y)))
    }
}

pub(crate) fn length(edge: &Edge) -> f64 {
    ((edge.b.x - edge.a.x) as f64).hypot((edge.b.y - edge.a.y) as f64)
}

/// `number` in units of `unit`, rounded.
pub(crate) fn rounded(number: i64, unit: i64) -> i64 {
    (number + unit / 2).div_euclid(unit)
}

/// The lowest and the highest coordinates of edges.
pub(crate) fn bounds(edges: impl Iterator<Item = Edge>) -> [GridPoint; 2] {
    let (mut low, mut high) = (GridPoint::new(i64::MAX, i64::MAX), GridPoint::new(i64::MIN, i64::MIN));
    for Edge { a, .. } in edges {
        low = GridPoint::new(low.x.min(a.x), low.y.min(a.y));
        high = GridPoint::new(high.x.max(a.x), high.y.max(a.y));
    }
    [low, high]
}
