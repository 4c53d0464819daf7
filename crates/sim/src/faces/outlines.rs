//! The rings of the bodies as vertices that are carried along, doubled where cracks mouth at them.

use crate::saved::{self, Fits};
use fissure_plane::distance_to_segment;
use fissure_scene::{End, OutlineFrame, Point, Scene, Vector};
use serde::{Deserialize, Serialize};

/// A vertex of an outline.
pub(crate) trait Vertex: Clone {
    /// Where it is at rest [m].
    fn rest(&self) -> Point;

    /// Whether it ends a face of a crack.
    fn is_at_mouth(&self) -> bool;
}

/// The rings of all bodies, body by body, the exterior first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Outlines<V> {
    rings: Vec<Vec<V>>,
}

impl<V> Default for Outlines<V> {
    fn default() -> Self {
        Self { rings: Vec::new() }
    }
}

/// Distance between two vertices of an outline at rest, in cells; at most.
const SPACING: f64 = 0.5;

/// A vertex so close to a mouth, in cells, lies at it.
const CLOSE: f64 = 1e-9;

impl<V: Vertex> Outlines<V> {
    /// The rings of the bodies of `scene` without mouths; `vertex` makes a vertex of a body from its place at rest.
    pub(crate) fn at_rest(scene: &Scene, vertex: impl Fn(u32, Point) -> V) -> Self {
        let spacing = SPACING * scene.cell_size;
        let lay = |body: u32, ring: &[Point]| {
            let mut vertices = Vec::new();
            for i in 0..ring.len() {
                let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
                let pieces = ((b - a).norm() / spacing).ceil().max(1.0) as usize;
                vertices.extend((0..pieces).map(|k| vertex(body, a + (b - a) * (k as f64 / pieces as f64))));
            }
            vertices
        };
        let bodies = scene.bodies.iter().enumerate();
        Self {
            rings: bodies.flat_map(|(index, body)| body.region.rings().map(move |r| lay(index as u32, r))).collect(),
        }
    }

    /// Doubles the outline where a crack mouths at it, with its `end` at `place`, at rest [m]: the two new vertices are
    /// the ends of its `faces`, above and below.
    pub(crate) fn open_mouth(&mut self, place: Point, end: End, faces: [V; 2], cell_size: f64) {
        let mut best: Option<(f64, usize, usize)> = None;
        for (index, ring) in self.rings.iter().enumerate() {
            for k in 0..ring.len() {
                let distance = distance_to_segment(place, ring[k].rest(), ring[(k + 1) % ring.len()].rest());
                if best.is_none_or(|x| distance < x.0) {
                    best = Some((distance, index, k));
                }
            }
        }
        let Some((_, index, k)) = best else { return };
        let [above, below] = faces;
        // The material lies to the left of a ring. Walking along the ring, the left (above) of a crack that starts here
        // and runs inward comes before the mouth, that of a crack that ends here after it.
        let pair = if end == End::Start { [above, below] } else { [below, above] };
        let ring = &mut self.rings[index];
        // A vertex that coincides with the mouth gives way to the pair.
        let gives_way = |v: &V| !v.is_at_mouth() && (v.rest() - place).norm() < CLOSE * cell_size;
        let next = (k + 1) % ring.len();
        if gives_way(&ring[next]) {
            ring.splice(next..=next, pair);
        } else if gives_way(&ring[k]) {
            ring.splice(k..=k, pair);
        } else {
            ring.splice(k + 1..k + 1, pair);
        }
    }

    /// Checks that rings that were read are those of `scene`.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(crate) fn check(&self, scene: &Scene) -> Fits {
        let rings: usize = scene.bodies.iter().map(|body| 1 + body.region.holes.len()).sum();
        saved::ensure(self.rings.len() == rings && self.rings.iter().all(|ring| ring.len() >= 3), "an outline")
    }

    /// All vertices, ring by ring.
    pub(crate) fn vertices(&self) -> impl Iterator<Item = &V> + Clone {
        self.rings.iter().flatten()
    }

    /// A vertex of a ring.
    pub(crate) fn vertex(&self, ring: usize, vertex: usize) -> &V {
        &self.rings[ring][vertex]
    }

    /// The rings.
    pub(crate) fn rings(&self) -> impl Iterator<Item = &[V]> {
        self.rings.iter().map(Vec::as_slice)
    }

    /// The rings, whose vertices are to be moved.
    pub(crate) fn rings_mut(&mut self) -> impl Iterator<Item = &mut [V]> {
        self.rings.iter_mut().map(Vec::as_mut_slice)
    }

    /// All vertices, ring by ring, to be moved.
    pub(crate) fn vertices_mut(&mut self) -> impl Iterator<Item = &mut V> {
        self.rings.iter_mut().flatten()
    }

    /// The frames of the rings of `scene`; `motion` gives the place [m] and the velocity [m/s] of a vertex.
    pub(crate) fn frames(&self, scene: &Scene, motion: impl Fn(&V) -> (Point, Vector)) -> Vec<OutlineFrame> {
        let numbers = scene
            .bodies
            .iter()
            .enumerate()
            .flat_map(|(body, b)| (0..=b.region.holes.len()).map(move |ring| (body as u32, ring as u32)));
        let frame = |((body, ring), vertices): ((u32, u32), &Vec<V>)| {
            let (position, velocity) = vertices.iter().map(&motion).unzip();
            OutlineFrame { body, ring, rest: vertices.iter().map(V::rest).collect(), position, velocity }
        };
        numbers.zip(&self.rings).map(frame).collect()
    }
}
