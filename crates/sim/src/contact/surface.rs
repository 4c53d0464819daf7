//! Surfaces as chains of vertices with the material on their left.

use fissure_plane::{Point, Vector};
use petgraph::unionfind::UnionFind;

/// No vertex.
const NONE: u32 = u32::MAX;

/// Cosine of the turn up to which a surface is round at a vertex and no corner: 30°.
const ROUND: f64 = 0.866;

/// Cosine of the angle between the normals of surfaces that touch, at most: 45°.
const LOOKS: f64 = 0.7;

/// A vertex of a surface. Edges have the number of the vertex they begin at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SurfaceVertex {
    /// Where it is at rest [m].
    pub(crate) rest: Point,
    /// Body it belongs to.
    pub(crate) body: u32,
    /// Material there.
    pub(crate) material: u32,
    /// Whether it lies on a crack, a mouth included.
    pub(crate) is_on_crack: bool,
    /// The piece of material that it belongs to: see [`Surface::number_pieces`].
    pub(crate) piece: u32,
    next: u32,
    previous: u32,
}

/// All surfaces of a scene.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Surface {
    vertices: Vec<SurfaceVertex>,
}

impl Surface {
    /// Adds a vertex without edges. Returns its number.
    pub(crate) fn push(&mut self, rest: Point, body: u32, material: u32, is_on_crack: bool) -> u32 {
        self.vertices.push(SurfaceVertex { rest, body, material, is_on_crack, piece: 0, next: NONE, previous: NONE });
        self.vertices.len() as u32 - 1
    }

    /// Makes the edge from one vertex to another, in place of those that began and ended there.
    pub(crate) fn link(&mut self, from: u32, to: u32) {
        self.unlink(from);
        let before = self.vertices[to as usize].previous;
        if before != NONE {
            self.vertices[before as usize].next = NONE;
        }
        self.vertices[from as usize].next = to;
        self.vertices[to as usize].previous = from;
    }

    /// Removes the edge that begins at a vertex.
    pub(crate) fn unlink(&mut self, from: u32) {
        let next = std::mem::replace(&mut self.vertices[from as usize].next, NONE);
        if next != NONE {
            self.vertices[next as usize].previous = NONE;
        }
    }

    /// Numbers the pieces of material by their surfaces: what edges join is of one piece, and so are the two vertices
    /// of each of the `joined` pairs.
    pub(crate) fn number_pieces(&mut self, joined: &[[u32; 2]]) {
        let mut pieces = UnionFind::new(self.len());
        let edges = (0..self.len() as u32).filter_map(|from| Some([from, self.next(from)?]));
        for [first, second] in edges.chain(joined.iter().copied()) {
            pieces.union(first, second);
        }
        for (vertex, piece) in self.vertices.iter_mut().zip(pieces.into_labeling()) {
            vertex.piece = piece;
        }
    }

    /// Number of vertices.
    pub(crate) fn len(&self) -> usize {
        self.vertices.len()
    }

    /// A vertex.
    pub(crate) fn vertex(&self, vertex: u32) -> &SurfaceVertex {
        &self.vertices[vertex as usize]
    }

    /// The vertex after one.
    pub(crate) fn next(&self, vertex: u32) -> Option<u32> {
        let next = self.vertices[vertex as usize].next;
        (next != NONE).then_some(next)
    }

    /// The vertex before one.
    pub(crate) fn previous(&self, vertex: u32) -> Option<u32> {
        let previous = self.vertices[vertex as usize].previous;
        (previous != NONE).then_some(previous)
    }

    /// Whether an edge begins or ends at a vertex.
    pub(crate) fn has_edge(&self, vertex: u32) -> bool {
        self.next(vertex).or(self.previous(vertex)).is_some()
    }

    /// Where all vertices are at rest [m].
    pub(crate) fn places_at_rest(&self) -> Vec<Point> {
        self.vertices.iter().map(|v| v.rest).collect()
    }

    /// Outward unit normal of the edge that begins at a vertex; none where there is no edge, or one without length.
    pub(crate) fn edge_normal(&self, edge: u32, place: &[Point]) -> Option<Vector> {
        let next = self.next(edge)?;
        let along = place[next as usize] - place[edge as usize];
        Vector::new(along.y, -along.x).try_normalize(0.0)
    }

    /// Outward normals of the edges before and after a vertex.
    pub(crate) fn normals_around(&self, vertex: u32, place: &[Point]) -> [Option<Vector>; 2] {
        [self.previous(vertex).and_then(|edge| self.edge_normal(edge, place)), self.edge_normal(vertex, place)]
    }

    /// Outward unit normal at a vertex: half way between those of its edges; none where it has no edge, or a fold.
    pub(crate) fn normal(&self, vertex: u32, place: &[Point]) -> Option<Vector> {
        let sum: Vector = self.normals_around(vertex, place).into_iter().flatten().sum();
        sum.try_normalize(1e-9)
    }

    /// The normal at a vertex where the surface is round; none at its corners and ends.
    pub(crate) fn round_normal(&self, vertex: u32, place: &[Point]) -> Option<Vector> {
        let [Some(before), Some(after)] = self.normals_around(vertex, place) else { return None };
        if before.dot(&after) >= ROUND { (before + after).try_normalize(0.0) } else { None }
    }

    /// Whether of all places of the surface around a vertex the vertex is the nearest to `point`.
    pub(crate) fn faces(&self, vertex: u32, point: Point, place: &[Point]) -> bool {
        let (Some(previous), Some(next)) = (self.previous(vertex), self.next(vertex)) else { return false };
        let at = place[vertex as usize];
        let away = point - at;
        away.dot(&(at - place[previous as usize])) >= 0.0 && away.dot(&(place[next as usize] - at)) <= 0.0
    }
}

/// Whether the material ends towards `direction` (a unit vector) at a vertex with `normals` before and after it: within
/// [`LOOKS`] of these or, at a corner, between them.
pub(crate) fn looks(normals: [Option<Vector>; 2], direction: Vector) -> bool {
    let between = match normals {
        [Some(before), Some(after)] => before.perp(&direction) > 0.0 && direction.perp(&after) > 0.0,
        _ => false,
    };
    between || normals.into_iter().flatten().any(|normal| normal.dot(&direction) > LOOKS)
}
