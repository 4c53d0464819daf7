//! The particles as points.

use crate::body_names::body_names;
use crate::history::History;
use crate::mesh::{Content, Mesh, Vertex, object_name};
use fissure_scene::{Frame, Scene};
use std::collections::BTreeMap;

/// One mesh per body and fragment, in that order.
pub(crate) fn particle_meshes(scene: &Scene, frame: &Frame) -> Vec<Mesh> {
    let (particles, names) = (&frame.particles, body_names(scene));
    let mut meshes = BTreeMap::<(u32, u32), Mesh>::new();
    for p in 0..particles.len() {
        let (body, piece) = (particles.body[p], particles.piece[p]);
        let mesh = meshes.entry((body, piece)).or_insert_with(|| {
            let name = object_name(&names[body as usize], "particles", piece);
            Mesh::new(name, piece, Content::Points)
        });
        let (position, velocity) = (particles.position[p], particles.velocity[p]);
        mesh.vertices.push(Vertex {
            position: [position.x, position.y, 0.0],
            normal: [0.0; 3],
            texture: [0.0; 2],
            velocity: [velocity.x, velocity.y, 0.0],
            history: History::default(),
        });
    }
    meshes.into_values().collect()
}
