//! How much nearer to each other vertices and edges may have come.
//!
//! Two things come nearer to each other no faster than they move relative to each other. Of what is near a vertex that
//! is known from the velocities around it alone: pieces that fly past elsewhere, and those that lie still in a heap,
//! do not matter to each other.

use super::surface::Surface;
use fissure_plane::{Point, Vector};
use std::ops::Range;

/// What was farther apart than a vertex can reach by this, in cells, when bins were laid is not looked at with it until
/// it may have come nearer by as much.
const FAR: f64 = 2.0;

/// A distance may be off by this part of it, from rounding.
const ROUND_OFF: f64 = 1e-9;

/// A bin: its row and its column.
type Key = (i32, i32);

/// Least and greatest velocity [m/s].
#[derive(Debug, Clone, Copy)]
struct Span {
    low: Vector,
    high: Vector,
}

impl Span {
    /// Of nothing.
    const NONE: Self = Self {
        low: Vector::new(f64::INFINITY, f64::INFINITY),
        high: Vector::new(f64::NEG_INFINITY, f64::NEG_INFINITY),
    };

    fn with(self, other: Self) -> Self {
        Self { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }

    fn add(&mut self, velocity: &Vector) {
        *self = self.with(Self { low: *velocity, high: *velocity });
    }

    /// No two differ by more than this [m/s].
    fn speed(&self) -> f64 {
        (self.high - self.low).norm().max(0.0)
    }
}

/// How far the vertices of a surface may have come nearer to the edges around them since each was looked at.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Nearing {
    /// Bins with the bins beside each, itself included: row by row.
    around: Vec<[Range<usize>; 3]>,
    /// The bin of each vertex, and of the middle of each edge; none where there is no edge.
    bins: Vec<(usize, Option<usize>)>,
    /// All edges, bin by bin, in each of them rising ...
    edges: Vec<u32>,
    /// ... and where those of each bin begin; one more at the end.
    first: Vec<usize>,
    /// Of each vertex: by how much edges may have come nearer to it [m], and by how much more until the next look.
    moved: Vec<(f64, f64)>,
    /// The same of any two things since bins were laid.
    far: (f64, f64),
    /// How far those may come [m].
    most_far: f64,
}

impl Nearing {
    /// Sorts vertices and edges, which are at `place` [m], into bins: all edges that come within `reach` [m] of a
    /// vertex before they have to be laid anew are in its bin or in one beside it. What was counted for each vertex
    /// stays, where there are as many.
    pub(crate) fn lay_bins(&mut self, surface: &Surface, place: &[Point], (reach, cell_size): (f64, f64)) {
        let count = surface.len() as u32;
        let edge = |v: u32| Some((place[v as usize], place[surface.next(v)? as usize]));
        let longest = (0..count).filter_map(edge).map(|(from, to)| (to - from).norm()).fold(0.0, f64::max);
        self.most_far = FAR * cell_size;
        let size = (reach + self.most_far + 0.5 * longest) * (1.0 + ROUND_OFF);
        let key = |p: Point| ((p.y / size).floor() as i32, (p.x / size).floor() as i32);
        let keys_of = |v: u32| (key(place[v as usize]), edge(v).map(|(from, to)| key(from + (to - from) * 0.5)));
        let keys: Vec<(Key, Option<Key>)> = (0..count).map(keys_of).collect();
        let mut all: Vec<Key> = keys.iter().flat_map(|(own, middle)| middle.iter().copied().chain([*own])).collect();
        all.sort_unstable();
        all.dedup();
        let first = |key: Key| all.partition_point(|&other| other < key);
        self.bins = keys.iter().map(|&(own, middle)| (first(own), middle.map(first))).collect();
        self.around = all
            .iter()
            .map(|&(row, column)| {
                [row.saturating_sub(1), row, row.saturating_add(1)].map(|row| {
                    let begin = first((row, column.saturating_sub(1)));
                    begin..begin + all[begin..].iter().take_while(|k| **k <= (row, column.saturating_add(1))).count()
                })
            })
            .collect();
        self.sort_edges();
        self.far = (0.0, 0.0);
        self.moved.resize(surface.len(), (0.0, 0.0));
    }

    /// Takes it that all has moved with `velocity` [m/s] for `time` [s] and will as long again.
    pub(crate) fn go_on(&mut self, surface: &Surface, velocity: &[Vector], time: f64) {
        self.foresee(surface, velocity, time);
        self.far.0 += self.far.1;
        self.moved.iter_mut().for_each(|(moved, coming)| *moved += *coming);
    }

    /// Takes it that all will move with `velocity` [m/s] for `time` [s].
    pub(crate) fn foresee(&mut self, surface: &Surface, velocity: &[Vector], time: f64) {
        let mut spans = vec![Span::NONE; self.around.len()];
        for (v, &(own, middle)) in self.bins.iter().enumerate() {
            spans[own].add(&velocity[v]);
            if let Some((middle, next)) = middle.zip(surface.next(v as u32)) {
                spans[middle].add(&velocity[v]);
                spans[middle].add(&velocity[next as usize]);
            }
        }
        self.far.1 = spans.iter().copied().fold(Span::NONE, Span::with).speed() * time;
        let of_bin = |rows: &[Range<usize>; 3]| {
            let all = rows.iter().flat_map(|row| &spans[row.clone()]);
            all.copied().fold(Span::NONE, Span::with).speed() * time
        };
        let coming: Vec<f64> = self.around.iter().map(of_bin).collect();
        for ((_, own_coming), (own, _)) in self.moved.iter_mut().zip(&self.bins) {
            *own_coming = coming[*own];
        }
    }

    /// By how much edges may have come nearer to a vertex at the next look [m].
    pub(crate) fn by_next_look(&self, vertex: u32) -> f64 {
        let (moved, coming) = self.moved[vertex as usize];
        moved + coming
    }

    /// Whether at the next look edges may have come nearer to some vertex by `most` [m].
    pub(crate) fn may_pass(&self, most: f64) -> bool {
        self.are_far_near() || self.moved.iter().any(|(moved, coming)| moved + coming >= most)
    }

    /// Whether bins have to be laid anew.
    pub(crate) fn are_far_near(&self) -> bool {
        self.far.0 + self.far.1 >= self.most_far
    }

    /// Sorts edges by their bins, by counting.
    fn sort_edges(&mut self) {
        let Self { around, bins, edges, first, .. } = self;
        let of_edges = || bins.iter().enumerate().filter_map(|(edge, (_, bin))| Some((edge as u32, (*bin)?)));
        *first = vec![0; around.len() + 1];
        of_edges().for_each(|(_, bin)| first[bin + 1] += 1);
        (0..around.len()).for_each(|bin| first[bin + 1] += first[bin]);
        let mut next = first.clone();
        *edges = vec![0; next[around.len()]];
        for (edge, bin) in of_edges() {
            edges[next[bin]] = edge;
            next[bin] += 1;
        }
    }

    /// How many bins there are.
    pub(super) fn count(&self) -> usize {
        self.around.len()
    }

    /// The bin of a vertex.
    pub(super) fn bin_of(&self, vertex: u32) -> usize {
        self.bins[vertex as usize].0
    }

    /// The bins that all edges within reach of the vertices of a bin are in: row by row.
    pub(super) fn bins_around(&self, bin: usize) -> [Range<usize>; 3] {
        self.around[bin].clone()
    }

    /// Where the edges of some bins are in the list of all.
    pub(super) fn range_of(&self, bins: Range<usize>) -> Range<usize> {
        self.first[bins.start]..self.first[bins.end]
    }

    /// All edges, bin by bin.
    pub(super) fn edges(&self) -> &[u32] {
        &self.edges
    }

    /// Which bins have edges within reach of the `wanted` vertices, and maybe others.
    pub(super) fn bins_near(&self, wanted: &[bool]) -> Vec<bool> {
        let mut is_near = vec![false; self.around.len()];
        for ((own, _), _) in self.bins.iter().zip(wanted).filter(|(_, wanted)| **wanted) {
            self.around[*own].iter().for_each(|row| is_near[row.clone()].fill(true));
        }
        is_near
    }

    /// A vertex is looked at.
    pub(crate) fn restart(&mut self, vertex: u32) {
        self.moved[vertex as usize].0 = 0.0;
    }
}
