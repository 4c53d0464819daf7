//! Which vertices of surfaces can come to which edges before the next look.

use super::surface::Surface;
use fissure_plane::{Point, Vector, nearest_on_segment};

/// Vertices find edges within so many cells.
pub(crate) const REACH: f64 = 2.0;

/// Surfaces whose normals have a larger product than this do not face each other, however things turn until the next
/// look.
const MAY_FACE: f64 = 0.5;

/// Parts of one body that are nearer to each other at rest than this, in cells, belong together: the two sides of a
/// thin part, of a corner, and the faces of a crack that have hardly slid, which touch node by node.
pub(crate) const TOGETHER: f64 = 2.5;

/// A gap at rest whose two sides are so many times as long as it is wide can close.
const NARROW: f64 = 4.0;

/// An edge near a vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Neighbour {
    /// The edge.
    pub(crate) edge: u32,
    /// Whether the two can touch. Others have to be known as well: a vertex that is nearer to one of them is within its
    /// own surroundings, whatever lies behind.
    pub(crate) can_touch: bool,
}

/// The vertices with edges near them.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Neighbours {
    /// Vertices that can touch something, rising.
    vertices: Vec<u32>,
    /// First neighbour of each; one more at the end.
    first: Vec<u32>,
    edges: Vec<Neighbour>,
    /// All vertices whose places are asked for, rising.
    asked: Vec<u32>,
}

impl Neighbours {
    /// Finds all, for vertices of `surface` that are at `place` [m] now; `cell_size` [m]. `cracks_touch`: whether crack
    /// faces do.
    pub(crate) fn find(surface: &Surface, place: &[Point], cell_size: f64, cracks_touch: bool) -> Self {
        let rest = surface.places_at_rest();
        let search = Search { surface, place, rest: &rest, cell_size, cracks_touch };
        let cells = Cells::new(surface, place, REACH * cell_size);
        let normals: Vec<Option<Vector>> = (0..surface.len() as u32).map(|v| surface.normal(v, place)).collect();
        let edge_normals: Vec<Option<Vector>> =
            (0..surface.len() as u32).map(|edge| surface.edge_normal(edge, place)).collect();
        let mut found = Self { first: vec![0], ..Self::default() };
        let mut near: Vec<u32> = Vec::new();
        for vertex in 0..surface.len() as u32 {
            let Some(normal) = normals[vertex as usize] else { continue };
            near.clear();
            let faces = |edge: &u32| edge_normals[*edge as usize].is_some_and(|n| n.dot(&normal) < MAY_FACE);
            near.extend(
                cells.around(place[vertex as usize]).filter(faces).filter(|&edge| search.is_near(vertex, edge)),
            );
            near.sort_unstable();
            let before = found.edges.len();
            found.edges.extend(near.iter().map(|&edge| Neighbour { edge, can_touch: search.can_touch(vertex, edge) }));
            if found.edges[before..].iter().any(|n| n.can_touch) {
                found.vertices.push(vertex);
                found.first.push(found.edges.len() as u32);
            } else {
                found.edges.truncate(before);
            }
        }
        found.ask(surface);
        found
    }

    /// Notes whose places are asked for: with normals, those of vertices beside.
    fn ask(&mut self, surface: &Surface) {
        let ends = self.edges.iter().flat_map(|n| [Some(n.edge), surface.next(n.edge)]).flatten();
        let mut asked: Vec<u32> = self.vertices.iter().copied().chain(ends).collect();
        asked.sort_unstable();
        asked.dedup();
        let beside: Vec<u32> = asked.iter().flat_map(|&v| [surface.previous(v), surface.next(v)]).flatten().collect();
        asked.extend(beside);
        asked.sort_unstable();
        asked.dedup();
        self.asked = asked;
    }

    /// Whether nothing can touch.
    pub(crate) fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }

    /// The vertices that can touch something, with the edges near them.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (u32, &[Neighbour])> {
        let ranges = self.first.windows(2).map(|w| w[0] as usize..w[1] as usize);
        self.vertices.iter().zip(ranges).map(|(&vertex, range)| (vertex, &self.edges[range]))
    }

    /// The vertices whose places are asked for, rising.
    pub(crate) fn asked(&self) -> &[u32] {
        &self.asked
    }
}

/// What decides whether a vertex and an edge are near, and can touch.
struct Search<'a> {
    surface: &'a Surface,
    place: &'a [Point],
    rest: &'a [Point],
    cell_size: f64,
    cracks_touch: bool,
}

impl Search<'_> {
    fn is_near(&self, vertex: u32, edge: u32) -> bool {
        let Some(next) = self.surface.next(edge) else { return false };
        if edge == vertex || next == vertex {
            return false;
        }
        let x = self.place[vertex as usize];
        let nearest = nearest_on_segment(self.place[edge as usize], self.place[next as usize], x);
        (nearest - x).norm_squared() <= (REACH * self.cell_size).powi(2)
    }

    /// Whether a vertex and an edge are not of one piece where they are near each other.
    fn can_touch(&self, vertex: u32, edge: u32) -> bool {
        let Some(next) = self.surface.next(edge) else { return false };
        let [of_vertex, from, to] = [vertex, edge, next].map(|v| self.surface.vertex(v));
        let on_crack = [of_vertex, from, to].iter().any(|v| v.is_on_crack);
        if on_crack && !self.cracks_touch {
            return false;
        }
        if of_vertex.body != from.body {
            return true;
        }
        let away = nearest_on_segment(from.rest, to.rest, of_vertex.rest) - of_vertex.rest;
        let distance = away.norm();
        if distance >= TOGETHER * self.cell_size {
            return true;
        }
        // The two sides of a drawn gap, but for its root.
        let through_gap = self.surface.normal(vertex, self.rest).is_some_and(|n| n.dot(&away) > 0.0);
        !on_crack && through_gap && !self.is_along(vertex, edge, NARROW * distance)
    }

    /// Whether the way from a vertex to an edge along the surface at rest is shorter than `length` [m].
    fn is_along(&self, vertex: u32, edge: u32, length: f64) -> bool {
        let walk = |step: &dyn Fn(u32) -> Option<u32>| {
            let (mut at, mut left) = (vertex, length);
            while let Some(next) = step(at) {
                left -= (self.rest[next as usize] - self.rest[at as usize]).norm();
                at = next;
                if left < 0.0 || at == vertex {
                    return false;
                }
                if at == edge {
                    return true;
                }
            }
            false
        };
        walk(&|v| self.surface.next(v)) || walk(&|v| self.surface.previous(v))
    }
}

/// Edges by the cell their first vertex is in.
struct Cells {
    /// (row, column, edge), sorted.
    edges: Vec<(i32, i32, u32)>,
    size: f64,
}

impl Cells {
    /// Cells so large that all edges within `reach` [m] of a place begin in its cell or in one beside it.
    fn new(surface: &Surface, place: &[Point], reach: f64) -> Self {
        let edges = || (0..surface.len() as u32).filter_map(|edge| Some((edge, surface.next(edge)?)));
        let length = |(edge, next): (u32, u32)| (place[next as usize] - place[edge as usize]).norm();
        let size = reach + edges().map(length).fold(0.0, f64::max);
        let mut cells = Self { edges: Vec::with_capacity(surface.len()), size };
        cells.edges = edges()
            .map(|(edge, _)| cells.key(place[edge as usize]))
            .zip(edges())
            .map(|((j, i), (edge, _))| (j, i, edge))
            .collect();
        cells.edges.sort_unstable();
        cells
    }

    fn key(&self, place: Point) -> (i32, i32) {
        ((place.y / self.size).floor() as i32, (place.x / self.size).floor() as i32)
    }

    /// All edges within the reach of a place, and others.
    fn around(&self, place: Point) -> impl Iterator<Item = u32> {
        let (row, column) = self.key(place);
        (row.saturating_sub(1)..=row.saturating_add(1)).flat_map(move |row| {
            let (low, high) = ((row, column.saturating_sub(1)), (row, column.saturating_add(1)));
            let first = self.edges.partition_point(|e| (e.0, e.1) < low);
            self.edges[first..].iter().take_while(move |e| (e.0, e.1) <= high).map(|e| e.2)
        })
    }
}
