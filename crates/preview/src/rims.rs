//! Edges of front faces.

use fissure_post::{Mesh, Slot};
use std::collections::{HashMap, HashSet};

/// Share of a normal that must point to the front for a triangle to lie in a front face.
const FRONT: f64 = 0.999;

/// An edge of a front face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rim {
    /// Its ends [m].
    pub(crate) ends: [[f64; 3]; 2],
    /// What stands on it.
    pub(crate) slot: Slot,
}

/// The edges of the front faces of a mesh, in the order of its triangles.
pub(crate) fn rims(mesh: &Mesh) -> Vec<Rim> {
    let place = |i: u32| mesh.vertices[i as usize].position;
    let key = |position: [f64; 3]| position.map(|x| (x + 0.0).to_bits());
    let is_front = |triangle: &[u32; 3]| triangle.iter().all(|&i| mesh.vertices[i as usize].normal[2] > FRONT);
    let front: Vec<[u32; 3]> = mesh.all_triangles().filter(is_front).collect();
    let edges = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]];
    let keys = |[a, b]: [u32; 2]| (key(place(a)), key(place(b)));
    let of_front: HashSet<_> = front.iter().flat_map(|&triangle| edges(triangle)).map(keys).collect();
    let walls = mesh.slot(Slot::Inside).iter().filter(|triangle| !is_front(triangle));
    let inside: HashMap<_, Slot> =
        walls.flat_map(|&triangle| edges(triangle)).map(|edge| (keys(edge), Slot::Inside)).collect();
    let outer = front.iter().flat_map(|&triangle| edges(triangle)).filter_map(|edge| {
        let (a, b) = keys(edge);
        let slot = inside.get(&(b, a)).copied().unwrap_or(Slot::Outside);
        (!of_front.contains(&(b, a))).then_some(Rim { ends: edge.map(place), slot })
    });
    outer.collect()
}
