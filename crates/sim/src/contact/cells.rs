//! Edges of surfaces by where they are.

use super::surface::Surface;
use fissure_plane::{Point, Vector};
use std::ops::Range;

/// A cell: its row and its column.
type Key = (i32, i32);

/// A distance may be off by this part of it, from rounding.
const ROUND_OFF: f64 = 1e-9;

/// An edge where it is now.
#[derive(Debug, Clone, Copy)]
struct Placed {
    edge: u32,
    middle: Point,
    /// All places within the reach of the edge are within this distance of its middle, squared [m²].
    reach_squared: f64,
}

/// Edges by the cell their middle is in.
pub(super) struct Cells {
    /// Sorted by cell, then by number.
    edges: Vec<(Key, Placed)>,
    /// Side of a cell [m].
    size: f64,
}

impl Cells {
    /// Cells so large that the middles of all of `edges` within `reach` [m] of a place are in its cell or in one beside
    /// it; vertices are at `place` [m].
    pub(super) fn new(surface: &Surface, place: &[Point], reach: f64, edges: impl Iterator<Item = u32>) -> Self {
        let placed = |edge: u32| {
            let (from, to) = (place[edge as usize], place[surface.next(edge)? as usize]);
            let farthest = (reach + 0.5 * (to - from).norm()) * (1.0 + ROUND_OFF);
            Some((farthest, Placed { edge, middle: from + (to - from) * 0.5, reach_squared: farthest * farthest }))
        };
        let all: Vec<(f64, Placed)> = edges.filter_map(placed).collect();
        let size = all.iter().map(|(farthest, _)| *farthest).fold(reach, f64::max);
        let mut edges: Vec<(Key, Placed)> = all.iter().map(|&(_, placed)| (key(placed.middle, size), placed)).collect();
        edges.sort_unstable_by_key(|&(key, placed)| (key, placed.edge));
        Self { edges, size }
    }
}

fn key(place: Point, size: f64) -> Key {
    ((place.y / size).floor() as i32, (place.x / size).floor() as i32)
}

/// Where in `sorted` those are that are in a cell or in one of the eight beside it: row by row.
fn ranges_around<T>(sorted: &[(Key, T)], (row, column): Key) -> [Range<usize>; 3] {
    let rows = [row.saturating_sub(1), row, row.saturating_add(1)];
    rows.map(|row| {
        let (low, high) = ((row, column.saturating_sub(1)), (row, column.saturating_add(1)));
        let first = sorted.partition_point(|item| item.0 < low);
        let count = sorted[first..].iter().take_while(|item| item.0 <= high).count();
        first..first + count
    })
}

/// What the edges of a cell have in common.
#[derive(Debug, Clone, Copy)]
struct Summary {
    /// Least and greatest displacement of their ends [m].
    displacements: (Vector, Vector),
    /// First and last body.
    bodies: (u32, u32),
    /// First and last piece.
    pieces: (u32, u32),
    /// Whether all lie on cracks.
    is_on_crack: bool,
}

impl Summary {
    fn of(surface: &Surface, place: &[Point], edge: u32) -> Self {
        let ends = [Some(edge), surface.next(edge)].into_iter().flatten();
        let of_end = |v: u32| {
            let vertex = surface.vertex(v);
            let moved = place[v as usize] - vertex.rest;
            let [bodies, pieces] = [vertex.body, vertex.piece].map(|number| (number, number));
            Self { displacements: (moved, moved), bodies, pieces, is_on_crack: vertex.is_on_crack }
        };
        ends.map(of_end).fold(of_end(edge), Self::with)
    }

    fn with(self, other: Self) -> Self {
        let ((low, high), (other_low, other_high)) = (self.displacements, other.displacements);
        let both = |own: (u32, u32), other: (u32, u32)| (own.0.min(other.0), own.1.max(other.1));
        Self {
            displacements: (low.inf(&other_low), high.sup(&other_high)),
            bodies: both(self.bodies, other.bodies),
            pieces: both(self.pieces, other.pieces),
            is_on_crack: self.is_on_crack && other.is_on_crack,
        }
    }
}

/// What is around one place after another.
pub(super) struct Surroundings<'a> {
    cells: &'a Cells,
    /// Of each cell with edges, sorted.
    summaries: Vec<(Key, Summary)>,
    /// What moves less than this relative to each other has moved alike [m]: within one piece, and otherwise.
    slides: [f64; 2],
    /// The cell that was asked for last.
    key: Option<Key>,
    /// Where its edges and those of the cells beside it are.
    ranges: [Range<usize>; 3],
    is_calm: bool,
}

impl<'a> Surroundings<'a> {
    /// Looks at all cells, for vertices at `place` [m]. `slides`: what moves less than this relative to each other has
    /// moved alike [m], within one piece and otherwise.
    pub(super) fn new(cells: &'a Cells, surface: &Surface, place: &[Point], slides: [f64; 2]) -> Self {
        let summary = |group: &[(Key, Placed)]| {
            let of = |(_, placed): &(Key, Placed)| Summary::of(surface, place, placed.edge);
            Some((group.first()?.0, group.iter().map(of).reduce(Summary::with)?))
        };
        let summaries = cells.edges.chunk_by(|a, b| a.0 == b.0).filter_map(summary).collect();
        Self { cells, summaries, slides, key: None, ranges: [0..0, 0..0, 0..0], is_calm: true }
    }

    /// Goes to a place. Returns whether all edges within its reach are crack faces of one body that have moved alike.
    pub(super) fn are_calm_at(&mut self, place: Point) -> bool {
        let key = key(place, self.cells.size);
        if self.key != Some(key) {
            self.key = Some(key);
            self.ranges = ranges_around(&self.cells.edges, key);
            let summaries = ranges_around(&self.summaries, key).into_iter().flat_map(|range| &self.summaries[range]);
            self.is_calm = summaries.map(|s| s.1).reduce(Summary::with).is_none_or(|all| {
                let (low, high) = all.displacements;
                let slide = self.slides[usize::from(all.pieces.0 != all.pieces.1)];
                all.is_on_crack && all.bodies.0 == all.bodies.1 && (high - low).norm() < slide
            });
        }
        self.is_calm
    }

    /// All edges within the reach of a place in the cell that was gone to, and some beyond it.
    pub(super) fn edges(&self, place: Point) -> impl Iterator<Item = u32> {
        let all = self.ranges.iter().flat_map(|range| &self.cells.edges[range.clone()]);
        all.filter(move |(_, p)| (p.middle - place).norm_squared() <= p.reach_squared).map(|(_, placed)| placed.edge)
    }
}
