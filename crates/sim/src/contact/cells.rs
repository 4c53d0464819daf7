//! Edges of surfaces by where they are.

use super::surface::Surface;
use fissure_plane::{Point, Vector};

/// A cell: its row and its column.
type Key = (i32, i32);

/// Edges by the cell their first vertex is in.
pub(super) struct Cells {
    /// Sorted.
    edges: Vec<(Key, u32)>,
    /// Side of a cell [m].
    size: f64,
}

impl Cells {
    /// Cells so large that all edges within `reach` [m] of a place begin in its cell or in one beside it; vertices are
    /// at `place` [m].
    pub(super) fn new(surface: &Surface, place: &[Point], reach: f64) -> Self {
        let edges = || (0..surface.len() as u32).filter_map(|edge| Some((edge, surface.next(edge)?)));
        let length = |(edge, next): (u32, u32)| (place[next as usize] - place[edge as usize]).norm();
        let size = reach + edges().map(length).fold(0.0, f64::max);
        let mut cells = Self { edges: Vec::with_capacity(surface.len()), size };
        cells.edges = edges().map(|(edge, _)| (cells.key(place[edge as usize]), edge)).collect();
        cells.edges.sort_unstable();
        cells
    }

    fn key(&self, place: Point) -> Key {
        ((place.y / self.size).floor() as i32, (place.x / self.size).floor() as i32)
    }

    /// All edges within the reach of a place, and others.
    pub(super) fn around(&self, place: Point) -> impl Iterator<Item = u32> {
        around(&self.edges, |e| e.0, self.key(place)).map(|e| e.1)
    }
}

/// Those of `sorted` that are in a cell or in one of the eight beside it.
fn around<T>(sorted: &[T], key: impl Fn(&T) -> Key + Copy, (row, column): Key) -> impl Iterator<Item = &T> {
    (row.saturating_sub(1)..=row.saturating_add(1)).flat_map(move |row| {
        let (low, high) = ((row, column.saturating_sub(1)), (row, column.saturating_add(1)));
        let first = sorted.partition_point(|item| key(item) < low);
        sorted[first..].iter().take_while(move |item| key(item) <= high)
    })
}

/// What the edges of a cell have in common.
#[derive(Debug, Clone, Copy)]
struct Summary {
    /// Least and greatest displacement of their ends [m].
    displacements: (Vector, Vector),
    /// First and last body.
    bodies: (u32, u32),
    /// Whether all lie on cracks.
    is_on_crack: bool,
}

impl Summary {
    fn of(surface: &Surface, place: &[Point], edge: u32) -> Self {
        let ends = [Some(edge), surface.next(edge)].into_iter().flatten();
        let of_end = |v: u32| {
            let vertex = surface.vertex(v);
            let moved = place[v as usize] - vertex.rest;
            let (displacements, bodies) = ((moved, moved), (vertex.body, vertex.body));
            Self { displacements, bodies, is_on_crack: vertex.is_on_crack }
        };
        ends.map(of_end).fold(of_end(edge), Self::with)
    }

    fn with(self, other: Self) -> Self {
        let ((low, high), (first, last)) = (self.displacements, self.bodies);
        let ((other_low, other_high), (other_first, other_last)) = (other.displacements, other.bodies);
        Self {
            displacements: (low.inf(&other_low), high.sup(&other_high)),
            bodies: (first.min(other_first), last.max(other_last)),
            is_on_crack: self.is_on_crack && other.is_on_crack,
        }
    }
}

/// Where nothing has moved relative to what is around it.
pub(super) struct Calm<'a> {
    cells: &'a Cells,
    /// Of each cell with edges, sorted.
    summaries: Vec<(Key, Summary)>,
    /// What was found last.
    last: Option<(Key, bool)>,
}

impl<'a> Calm<'a> {
    /// Looks at all cells, for vertices at `place` [m].
    pub(super) fn new(cells: &'a Cells, surface: &Surface, place: &[Point]) -> Self {
        let summary = |group: &[(Key, u32)]| {
            let of = |&(_, edge): &(Key, u32)| Summary::of(surface, place, edge);
            Some((group.first()?.0, group.iter().map(of).reduce(Summary::with)?))
        };
        Self { cells, summaries: cells.edges.chunk_by(|a, b| a.0 == b.0).filter_map(summary).collect(), last: None }
    }

    /// Whether all edges within the reach of a place are crack faces of one body and have moved alike, to within
    /// `slide` [m].
    pub(super) fn is_calm(&mut self, place: Point, slide: f64) -> bool {
        let key = self.cells.key(place);
        if let Some((of, is_calm)) = self.last
            && of == key
        {
            return is_calm;
        }
        let all = around(&self.summaries, |s| s.0, key).map(|s| s.1).reduce(Summary::with);
        let is_calm = all.is_none_or(|all| {
            let (low, high) = all.displacements;
            all.is_on_crack && all.bodies.0 == all.bodies.1 && (high - low).norm() < slide
        });
        self.last = Some((key, is_calm));
        is_calm
    }
}
