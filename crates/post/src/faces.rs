//! The crack faces as surfaces.

use crate::body_names::body_names;
use crate::boolean::{Edge, SourceIndex};
use crate::extrude::Extrusion;
use crate::history::{History, attributes, histories};
use crate::mesh::{Content, Mesh, object_name};
use crate::opening::opening_edges;
use crate::options::PostOptions;
use crate::relief::Relief;
use crate::smooth::SmoothCracks;
use crate::snap::Grid;
use crate::widening::{Widening, widened};
use fissure_scene::{CrackFrame, Fragments, Frame, Scene};

/// One mesh per crack: both faces over the thickness, normals into the opening. Closed cracks have faces too.
pub(crate) fn face_meshes(scene: &Scene, frame: &Frame, options: &PostOptions) -> Vec<Mesh> {
    let cracks = SmoothCracks::new(scene, frame, &Fragments::of_frame(frame), options.smoothing);
    let relief = Relief::new(scene, options, frame, &cracks);
    let attributes = attributes(frame, options);
    let known = if attributes.is_empty() { None } else { histories(frame) };
    let mut known = known.unwrap_or_default().into_iter();
    let mut face_mesh = |crack: &CrackFrame| {
        let mut mesh = face_mesh(scene, crack, options, relief.as_ref(), &known.next().unwrap_or_default());
        mesh.attributes.clone_from(&attributes);
        mesh
    };
    let Some(opening) = &options.opening else { return cracks.cracks.iter().map(face_mesh).collect() };
    let widening = Widening::new(opening, scene, frame.time);
    let shown = |crack: &CrackFrame| widened(crack, &widening.shifts(crack));
    cracks.cracks.iter().map(|crack| face_mesh(&shown(crack))).collect()
}

fn face_mesh(
    scene: &Scene,
    crack: &CrackFrame,
    options: &PostOptions,
    relief: Option<&Relief>,
    histories: &[History],
) -> Mesh {
    let body = &scene.bodies[crack.body as usize];
    let grid = Grid::covering(crack.above.iter().chain(&crack.below), 0.0);
    let first = scene.cracks.get(crack.crack as usize).and_then(|c| c.points.first().copied());
    let sources = opening_edges(crack, first, histories, grid);
    let extrusion = Extrusion { relief, ..Extrusion::plain(grid, &sources, options, body.region.bounds()) };
    let name = object_name(&body_names(scene)[crack.body as usize], "crack", crack.crack);
    let mut mesh = Mesh::new(name, crack.crack, Content::Surface);
    mesh.texture_size = options.uv_in_metres.then_some(extrusion.texture_size);
    // Without the two closing edges, which lie in the opening and not on a face.
    let count = crack.rest.len();
    for face in [0..count.saturating_sub(1), count..(2 * count).saturating_sub(1)] {
        let edges: Vec<Edge> = face
            .map(|i| Edge { a: sources[i].a, b: sources[i].b, source: SourceIndex(i as u32) })
            .filter(|edge| edge.a != edge.b)
            .collect();
        extrusion.walls(&edges, false, &[], &mut mesh);
    }
    mesh
}
