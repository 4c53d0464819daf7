//! Meshes as files hold them: single precision, only the vertices that are used.

use crate::history::History;
use crate::mesh::{Mesh, Vertex};
use fissure_scene::UpAxis;

/// A vertex in single precision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PackedVertex {
    pub(crate) position: [f32; 3],
    pub(crate) normal: [f32; 3],
    pub(crate) texture: [f32; 2],
    pub(crate) velocity: [f32; 3],
    pub(crate) history: History,
}

impl PackedVertex {
    /// Texture coordinates in metres, v upwards; `size` is the length of a unit of them [m].
    pub(crate) fn metres(&self, size: f64) -> [f32; 2] {
        self.texture.map(|x| (f64::from(x) * size) as f32)
    }
}

/// How positions and velocities are written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Convention {
    /// The axis that points up.
    pub(crate) up: UpAxis,
    /// Seconds of simulated time in one second that velocities are written for: 1, or
    /// [`fissure_scene::FrameSettings::time_scale`] for velocities per second of playback.
    pub(crate) time_scale: f64,
}

/// Rounds a vertex and turns it so that the axis up points up; a turn by a right angle, exact.
pub(crate) fn pack(vertex: &Vertex, convention: Convention) -> PackedVertex {
    let turn = |[x, y, z]: [f64; 3]| match convention.up {
        UpAxis::Y => [x as f32, y as f32, z as f32],
        // The viewer, who stood on +z, stands on −y: the front view of programs with z up.
        UpAxis::Z => [x as f32, -z as f32, y as f32],
    };
    PackedVertex {
        position: turn(vertex.position),
        normal: turn(vertex.normal),
        texture: vertex.texture.map(|x| x as f32),
        velocity: turn(vertex.velocity.map(|v| v * convention.time_scale)),
        history: vertex.history,
    }
}

/// The vertices that `triangles` use, in the order of first use, and the triangles in terms of them.
pub(crate) fn compact(
    mesh: &Mesh,
    triangles: &[[u32; 3]],
    convention: Convention,
) -> (Vec<PackedVertex>, Vec<[u32; 3]>) {
    let mut new_index = vec![u32::MAX; mesh.vertices.len()];
    let mut vertices = Vec::with_capacity(mesh.vertices.len().min(3 * triangles.len()));
    let mut renumbered = |old: u32| {
        let new = &mut new_index[old as usize];
        if *new == u32::MAX {
            *new = vertices.len() as u32;
            vertices.push(pack(&mesh.vertices[old as usize], convention));
        }
        *new
    };
    let triangles = triangles.iter().map(|t| t.map(&mut renumbered)).collect();
    (vertices, triangles)
}
