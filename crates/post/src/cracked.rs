//! The bodies as solids, with or without their cracks.

use crate::boolean::material;
use crate::error::PostError;
use crate::extrude::Extrusion;
use crate::mesh::{Content, Mesh, object_name};
use crate::opening::opening_edges;
use crate::options::PostOptions;
use crate::outline::outline_edges;
use crate::pieces::{Polygon, pieces, without_slivers};
use crate::pinch::part_pinches;
use crate::seam::{guests, join};
use crate::snap::Grid;
use crate::source::SourceEdge;
use fissure_scene::{CrackEnd, CrackFrame, Frame, OutlineFrame, Scene};
use std::collections::BTreeMap;

/// One solid per body and fragment, in that order; `with_cracks`: the cracks are cut out.
pub(crate) fn body_meshes(
    scene: &Scene,
    frame: &Frame,
    options: &PostOptions,
    with_cracks: bool,
) -> Result<Vec<Mesh>, PostError> {
    let mut meshes = Vec::new();
    for body in 0..scene.bodies.len() {
        let (polygons, sources, grid) = body_polygons(scene, frame, options, body, with_cracks)?;
        meshes.extend(solids(scene, options, body, polygons, &sources, grid));
    }
    Ok(meshes)
}

/// The pieces of one body, with the sources of their edges and the grid they lie on.
fn body_polygons(
    scene: &Scene,
    frame: &Frame,
    options: &PostOptions,
    body: usize,
    with_cracks: bool,
) -> Result<(Vec<Polygon>, Vec<SourceEdge>, Grid), PostError> {
    let outlines: Vec<&OutlineFrame> = frame.outlines.iter().filter(|o| o.body as usize == body).collect();
    let cracks: Vec<&CrackFrame> = frame.cracks.iter().filter(|c| with_cracks && c.body as usize == body).collect();
    let faces = cracks.iter().flat_map(|c| c.above.iter().chain(&c.below));
    let grid = Grid::covering(outlines.iter().flat_map(|o| &o.position).chain(faces));

    let (low, high) = scene.bodies[body].region.bounds();
    grid.check(frame.number, &scene.bodies[body].name, (high - low).amax())?;

    let mut rings: Vec<Vec<SourceEdge>> = outlines.iter().map(|o| outline_edges(o, grid)).collect();
    let first = |crack: &CrackFrame| scene.cracks.get(crack.crack as usize).and_then(|c| c.points.first().copied());
    let mut openings: Vec<Vec<SourceEdge>> = cracks.iter().map(|c| opening_edges(c, first(c), grid)).collect();
    for guest in cracks.iter().flat_map(|c| guests(c, grid)) {
        let trunk = |crack: u32| cracks.iter().position(|c| c.crack == crack);
        match guest.end {
            CrackEnd::Mouth => join(&mut rings, &guest),
            CrackEnd::Junction { crack } => {
                if let Some(at) = trunk(crack) {
                    join(&mut openings[at..=at], &guest);
                }
            }
            CrackEnd::Tip => {}
        }
    }
    let mut sources: Vec<SourceEdge> = rings.into_iter().chain(openings).flatten().collect();
    let shapes = without_slivers(material(&sources));
    let parted = part_pinches(shapes, &mut sources).map_err(|place| {
        let place = grid.place(place);
        PostError::Pinch { frame: frame.number, body: scene.bodies[body].name.clone(), x: place.x, y: place.y }
    })?;
    let whole = without_slivers(parted);
    Ok((pieces(whole, grid, &frame.particles, body as u32, options.smallest_fragment), sources, grid))
}

/// Extrudes the polygons; those of one fragment become one mesh.
fn solids(
    scene: &Scene,
    options: &PostOptions,
    body: usize,
    polygons: Vec<Polygon>,
    sources: &[SourceEdge],
    grid: Grid,
) -> Vec<Mesh> {
    let body = &scene.bodies[body];
    let (low, high) = body.region.bounds();
    let extrusion = Extrusion {
        grid,
        sources,
        thickness: options.thickness,
        crease_angle: options.crease_angle,
        texture_origin: low,
        texture_size: (high - low).amax(),
    };
    let mut by_piece = BTreeMap::<u32, Vec<Polygon>>::new();
    for polygon in polygons {
        by_piece.entry(polygon.piece).or_default().push(polygon);
    }
    let solid = |(piece, polygons): (u32, Vec<Polygon>)| {
        let area = polygons.iter().map(|p| p.area).sum();
        let name = object_name(&body.name, "piece", piece);
        let mut mesh = Mesh::new(name, piece, Content::Solid { area, thickness: options.thickness });
        polygons.iter().for_each(|p| extrusion.solid(&p.shape, &mut mesh));
        mesh
    };
    by_piece.into_iter().map(solid).collect()
}
