//! Which vertices of surfaces can come to which edges before the next look.

use super::cells::{Cells, Surroundings};
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
        let mut around = Surroundings::new(&cells, surface, place, search.least_slide());
        let edge_normals: Vec<Option<Vector>> =
            (0..surface.len() as u32).map(|edge| surface.edge_normal(edge, place)).collect();
        let mut found = Self { first: vec![0], ..Self::default() };
        let mut near = Vec::new();
        for vertex in 0..surface.len() as u32 {
            let x = place[vertex as usize];
            if around.are_calm_at(x) {
                continue;
            }
            let Some(normal) = surface.normal(vertex, place) else { continue };
            let faces = |edge: &u32| edge_normals[*edge as usize].is_some_and(|n| n.dot(&normal) < MAY_FACE);
            near.clear();
            near.extend(around.edges(x).filter(faces).filter(|&edge| search.is_near(vertex, edge)));
            near.sort_unstable();
            let first = found.edges.len();
            found.edges.extend(near.iter().map(|&edge| Neighbour { edge, can_touch: search.can_touch(vertex, edge) }));
            if !found.edges[first..].iter().any(|near| near.can_touch && !search.stays(vertex, near.edge)) {
                found.edges.truncate(first);
                continue;
            }
            found.vertices.push(vertex);
            found.first.push(found.edges.len() as u32);
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

    /// Whether a vertex and an edge of one body, one of them on a crack, have moved so much alike that they cannot be
    /// near each other now if they do not belong together.
    fn stays(&self, vertex: u32, edge: u32) -> bool {
        let Some(next) = self.surface.next(edge) else { return true };
        let [of_vertex, from, to] = [vertex, edge, next].map(|v| self.surface.vertex(v));
        let slid = |end: u32| (self.displacement(end) - self.displacement(vertex)).norm_squared();
        of_vertex.body == from.body
            && (of_vertex.is_on_crack || from.is_on_crack || to.is_on_crack)
            && slid(edge).max(slid(next)) < self.least_slide().powi(2)
    }

    /// What does not belong together and is near has moved by more than this relative to each other [m].
    fn least_slide(&self) -> f64 {
        (TOGETHER - REACH) * self.cell_size
    }

    fn displacement(&self, vertex: u32) -> Vector {
        self.place[vertex as usize] - self.rest[vertex as usize]
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Two rings that bend and move, the second with a crack drawn into it, its first half on the crack.
    fn moved(count: usize, slides: &[(f64, f64)], second_body: u32, turn: f64) -> (Surface, Vec<Point>) {
        let mut surface = Surface::default();
        for (ring, body) in [0, second_body].into_iter().enumerate() {
            let first = surface.len() as u32;
            for k in 0..count {
                let angle = std::f64::consts::TAU * k as f64 / count as f64;
                let rest = Point::new(angle.cos() + 2.2 * ring as f64, 1.5 * angle.sin());
                surface.push(rest, body, 0, ring == 1 && k < count / 2);
            }
            (0..count as u32).for_each(|k| surface.link(first + k, first + (k + 1) % count as u32));
        }
        let of_ring = |v: usize| if v < count { Vector::zeros() } else { Vector::new(-turn, 0.3 * turn) };
        let slide = |v: usize| slides[v * slides.len() / (2 * count)];
        let moved = |(v, rest): (usize, Point)| rest + of_ring(v) + Vector::new(slide(v).0, slide(v).1);
        let place = surface.places_at_rest().into_iter().enumerate().map(moved).collect();
        (surface, place)
    }

    proptest! {
        /// Truth: every vertex with every edge.
        #[test]
        fn neighbours_are_those_of_all_pairs(
            count in 8..60_usize,
            slides in prop::collection::vec((-0.3..0.3_f64, -0.3..0.3_f64), 1..12),
            second_body in 0..2_u32,
            turn in 0.0..0.6_f64,
            cell_size in 0.05..0.4_f64,
        ) {
            let (surface, place) = moved(count, &slides, second_body, turn);
            let rest = surface.places_at_rest();
            let search = Search { surface: &surface, place: &place, rest: &rest, cell_size, cracks_touch: true };
            let mut expected = Vec::new();
            for vertex in 0..surface.len() as u32 {
                let Some(normal) = surface.normal(vertex, &place) else { continue };
                let faces = |&edge: &u32| surface.edge_normal(edge, &place).is_some_and(|n| n.dot(&normal) < MAY_FACE);
                let near = (0..surface.len() as u32).filter(faces).filter(|&edge| search.is_near(vertex, edge));
                let near: Vec<Neighbour> =
                    near.map(|edge| Neighbour { edge, can_touch: search.can_touch(vertex, edge) }).collect();
                if near.iter().any(|neighbour| neighbour.can_touch) {
                    expected.push((vertex, near));
                }
            }
            let found = Neighbours::find(&surface, &place, cell_size, true);
            let found: Vec<(u32, Vec<Neighbour>)> = found.iter().map(|(v, near)| (v, near.to_vec())).collect();
            prop_assert_eq!(found, expected);
        }
    }
}
