//! Meshes as they are written, and the check that a solid is one.

use crate::history::History;
use crate::slot::Slot;
use fissure_scene::{Attribute, Vector};
use rustc_hash::FxHashMap;

/// A vertex. The drawing lies in the x–y plane, y up, z towards the viewer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    /// Position [m].
    pub position: [f64; 3],
    /// Outward normal, of unit length; zero for points.
    pub normal: [f64; 3],
    /// Texture coordinates, v upwards; 1 is the longest side of the body's bounding box at rest.
    pub texture: [f64; 2],
    /// Velocity [m/s].
    pub velocity: [f64; 3],
    /// How the wall of a crack came about here.
    pub history: History,
}

/// What a mesh is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Content {
    /// Triangles that close a solid: a plane region extruded.
    Solid {
        /// Area of the plane region [m²].
        area: f64,
        /// Thickness [m].
        thickness: f64,
        /// What its volume may differ by from area × thickness, as its walls are rough [m³].
        slack: f64,
    },
    /// Triangles of an open surface.
    Surface,
    /// Vertices only.
    Points,
}

/// One object of a file: a fragment, a collider, a crack or a cloud of particles.
///
/// Vertices are split where normals or texture coordinates differ on both sides; the solid is closed by position.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Name, without dots.
    pub name: String,
    /// Fragment number of the simulation, or index of the crack or collider.
    pub piece: u32,
    /// What it is made of.
    pub content: Content,
    /// Length of a unit of the texture coordinates at rest [m], where they are written in metres too.
    pub texture_size: Option<f64>,
    /// What of the history of its crack walls is written.
    pub attributes: Vec<Attribute>,
    /// Vertices.
    pub vertices: Vec<Vertex>,
    /// Triangles by slot, counter-clockwise from outside.
    pub triangles: [Vec<[u32; 3]>; 2],
}

impl Mesh {
    /// An empty mesh.
    pub(crate) fn new(name: String, piece: u32, content: Content) -> Self {
        let triangles = [Vec::new(), Vec::new()];
        Self { name, piece, content, texture_size: None, attributes: Vec::new(), vertices: Vec::new(), triangles }
    }

    /// The mesh moved in the drawing plane [m].
    pub(crate) fn moved(mut self, offset: Vector) -> Self {
        for vertex in &mut self.vertices {
            vertex.position[0] += offset.x;
            vertex.position[1] += offset.y;
        }
        self
    }

    /// Lets the volume differ by so much more from area × thickness [m³].
    pub(crate) fn may_differ(&mut self, by: f64) {
        if let Content::Solid { slack, .. } = &mut self.content {
            *slack += by;
        }
    }

    /// Gives all vertices from `first` on that triangles of `slot` from `new` on have the mean normal of these,
    /// weighted by area.
    pub(crate) fn set_normals(&mut self, first: usize, slot: Slot, new: usize) {
        let mut normals = vec![[0.0; 3]; self.vertices.len() - first];
        for &triangle in &self.triangles[slot as usize][new..] {
            let [p, q, r] = triangle.map(|i| self.vertices[i as usize].position);
            let normal = cross(subtract(q, p), subtract(r, p));
            for i in triangle {
                let sum: &mut [f64; 3] = &mut normals[i as usize - first];
                *sum = std::array::from_fn(|k| sum[k] + normal[k]);
            }
        }
        for (vertex, normal) in self.vertices[first..].iter_mut().zip(normals) {
            let length = dot(normal, normal).sqrt();
            if length > 0.0 {
                vertex.normal = normal.map(|x| x / length);
            }
        }
    }

    /// Triangles of one slot.
    pub fn slot(&self, slot: Slot) -> &[[u32; 3]] {
        &self.triangles[slot as usize]
    }

    /// All triangles.
    pub fn all_triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        self.triangles.iter().flatten().copied()
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.triangles.iter().map(Vec::len).sum()
    }

    /// Volume enclosed by the triangles with positions rounded to `f32`, as a file holds them [m³].
    pub fn volume(&self) -> f64 {
        // Relative to a vertex of the mesh, so that a small solid far from the origin keeps its digits.
        let Some(origin) = self.vertices.first().map(|v| rounded(v.position)) else { return 0.0 };
        let corner = |i: u32| subtract(rounded(self.vertices[i as usize].position), origin);
        self.all_triangles().map(|[a, b, c]| dot(corner(a), cross(corner(b), corner(c))) / 6.0).sum()
    }

    /// Checks that the mesh is a solid after rounding to `f32`: closed, manifold, oriented outwards, without degenerate
    /// triangles, and of volume = area × thickness within 1e-6 relative and its slack. Surfaces and points pass.
    ///
    /// # Errors
    /// The first defect found, with its place.
    pub fn check(&self) -> Result<(), MeshDefect> {
        let Content::Solid { area, thickness, slack } = self.content else { return Ok(()) };
        let places: Vec<[f64; 3]> = self.vertices.iter().map(|vertex| rounded(vertex.position)).collect();
        for triangle in self.all_triangles() {
            let [p, q, r] = triangle.map(|i| places[i as usize]);
            let normal = cross(subtract(q, p), subtract(r, p));
            if dot(normal, normal) == 0.0 {
                return Err(MeshDefect::Degenerate { place: p });
            }
        }
        self.check_edges(&places)?;
        let (volume, expected) = (self.volume(), area * thickness);
        let close = (volume - expected).abs() <= 1e-6 * expected + slack;
        if close { Ok(()) } else { Err(MeshDefect::WrongVolume { volume, expected }) }
    }

    /// Checks that each edge, from one of the `places` of the vertices to another, has one triangle on either side.
    fn check_edges(&self, places: &[[f64; 3]]) -> Result<(), MeshDefect> {
        let mut known = FxHashMap::with_capacity_and_hasher(places.len(), Default::default());
        // The number of the place of each vertex. Adding zero makes −0 and 0 the same place, as they are to a reader.
        let mut number = |place: &[f64; 3]| {
            let next = known.len() as u32;
            *known.entry(place.map(|x| (x as f32 + 0.0).to_bits())).or_insert(next)
        };
        let numbers: Vec<u32> = places.iter().map(&mut number).collect();
        let distinct = known.len();
        let edges = || {
            self.all_triangles().flat_map(|triangle| {
                let [a, b, c] = triangle.map(|i| numbers[i as usize]);
                [(a, b), (b, c), (c, a)]
            })
        };
        // The ends of the edges that start at each place, one place after the other.
        let mut ends = vec![0_u32; 3 * self.triangle_count()];
        let mut until = vec![0_u32; distinct];
        edges().for_each(|(a, _)| until[a as usize] += 1);
        let mut begin = 0;
        for count in &mut until {
            begin += std::mem::replace(count, begin);
        }
        for (a, b) in edges() {
            let end = &mut until[a as usize];
            ends[*end as usize] = b;
            *end += 1;
        }
        let of = |a: usize| (if a == 0 { 0 } else { until[a - 1] as usize })..until[a] as usize;
        let place = |a: usize| numbers.iter().position(|&n| n as usize == a).map_or([0.0; 3], |vertex| places[vertex]);
        for a in 0..distinct {
            let ends = &mut ends[of(a)];
            ends.sort_unstable();
            if ends.windows(2).any(|pair| pair[0] == pair[1]) {
                return Err(MeshDefect::NotManifold { place: place(a) });
            }
        }
        for a in 0..distinct {
            if ends[of(a)].iter().any(|&b| !ends[of(b as usize)].contains(&(a as u32))) {
                return Err(MeshDefect::Open { place: place(a) });
            }
        }
        Ok(())
    }
}

/// What keeps a mesh from being a solid.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MeshDefect {
    /// A triangle without area.
    #[error("a triangle at {place:?} has no area")]
    Degenerate {
        /// A corner of it [m].
        place: [f64; 3],
    },
    /// An edge with more than two triangles, or with two of opposite orientation.
    #[error("more than two triangles meet in the edge at {place:?}")]
    NotManifold {
        /// Start of the edge [m].
        place: [f64; 3],
    },
    /// An edge with one triangle.
    #[error("the surface has a hole at {place:?}")]
    Open {
        /// Start of the edge [m].
        place: [f64; 3],
    },
    /// The volume is not area × thickness.
    #[error("the volume is {volume:e} m³ instead of {expected:e} m³")]
    WrongVolume {
        /// Volume enclosed [m³].
        volume: f64,
        /// Area × thickness [m³].
        expected: f64,
    },
}

/// Name of an object, `owner_kind_0001`, of letters, digits, `_` and `-` only: viewers strip or rewrite others.
pub(crate) fn object_name(owner: &str, kind: &str, number: u32) -> String {
    format!("{}_{kind}_{number:04}", plain(owner))
}

/// A name with `_` in place of all but letters, digits and `-`.
pub(crate) fn plain(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || c == '-' { c } else { '_' }).collect()
}

fn rounded(position: [f64; 3]) -> [f64; 3] {
    position.map(|x| f64::from(x as f32))
}

fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// The corner tetrahedron of the unit cube: volume 1/6, as a prism of area 1/2 and a third of the height.
    fn tetrahedron() -> Mesh {
        let content = Content::Solid { area: 0.5, thickness: 1.0 / 3.0, slack: 0.0 };
        let mut mesh = Mesh::new("tetrahedron".to_owned(), 0, content);
        for position in [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
            mesh.vertices.push(Vertex {
                position,
                normal: [0.0; 3],
                texture: [0.0; 2],
                velocity: [0.0; 3],
                history: History::default(),
            });
        }
        mesh.triangles[0] = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        mesh
    }

    fn defect(change: impl FnOnce(&mut Mesh)) -> MeshDefect {
        let mut mesh = tetrahedron();
        assert_eq!(mesh.check(), Ok(()));
        change(&mut mesh);
        mesh.check().unwrap_err()
    }

    #[test]
    fn each_defect_is_found() {
        let open = defect(|m| m.triangles[0].truncate(3));
        assert!(matches!(open, MeshDefect::Open { .. }), "{open}");
        let twice = defect(|m| m.triangles[0].push([1, 2, 3]));
        assert!(matches!(twice, MeshDefect::NotManifold { .. }), "{twice}");
        let flipped = defect(|m| m.triangles[0][0].swap(0, 1));
        assert!(matches!(flipped, MeshDefect::NotManifold { .. }), "{flipped}");
        let inside_out = defect(|m| m.triangles[0].iter_mut().for_each(|t| t.swap(0, 1)));
        assert!(matches!(inside_out, MeshDefect::WrongVolume { volume, .. } if volume < 0.0), "{inside_out}");
        // Apart in f64, but one place in f32.
        let flat = defect(|m| m.vertices[1].position = [1e-60, 0.0, 0.0]);
        assert_eq!(flat, MeshDefect::Degenerate { place: [0.0; 3] });
        let larger = defect(|m| m.content = Content::Solid { area: 0.500_001, thickness: 1.0 / 3.0, slack: 0.0 });
        assert!(matches!(larger, MeshDefect::WrongVolume { .. }), "{larger}");
    }

    #[test]
    fn split_vertices_close_by_position() {
        let mut mesh = tetrahedron();
        let copy = Vertex { position: [1.0, -0.0, 0.0], ..mesh.vertices[1] };
        mesh.vertices.push(copy);
        mesh.triangles[0][3] = [4, 2, 3];
        assert_eq!(mesh.check(), Ok(()));
    }
}
