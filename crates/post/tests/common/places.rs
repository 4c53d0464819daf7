//! How near the vertices of a mesh are to each other.

use fissure_post::Mesh;

/// Two places of vertices that programs would merge, nearer to each other than `distance` [m], if there are any.
pub(crate) fn mergeable(mesh: &Mesh, distance: f64) -> Option<[[f64; 3]; 2]> {
    let mut places: Vec<[f64; 3]> = mesh.vertices.iter().map(|vertex| vertex.position).collect();
    places.sort_by(|p, q| p.partial_cmp(q).unwrap());
    places.dedup();
    let apart = |p: &[f64; 3], q: &[f64; 3]| (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt();
    places.iter().enumerate().find_map(|(i, p)| {
        let mut near = places[i + 1..].iter().take_while(|q| q[0] - p[0] < distance);
        near.find(|q| apart(p, q) <= distance).map(|q| [*p, *q])
    })
}
