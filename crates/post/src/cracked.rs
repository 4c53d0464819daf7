//! The bodies as solids, with or without their cracks.

use crate::boolean::{Shape, material, twice_area};
use crate::edges::MovedLines;
use crate::error::PostError;
use crate::extrude::Extrusion;
use crate::held_open::{parted_segments, shifts};
use crate::mesh::{Content, Mesh, object_name};
use crate::options::PostOptions;
use crate::outline::outline_edges;
use crate::pieces::numbers;
use crate::pinch::part_pinches;
use crate::slivers::without_slivers;
use crate::snap::Grid;
use crate::source::SourceEdge;
use fissure_scene::{CrackFrame, Fragments, Frame, Scene, Walls};
use std::collections::BTreeMap;

/// One solid per fragment, by body and number.
///
/// Each is made of its own boundary alone, so that what touches or overlaps is never joined.
pub(crate) fn cracked_meshes(scene: &Scene, frame: &Frame, options: &PostOptions) -> Result<Vec<Mesh>, PostError> {
    let fragments = Fragments::of_frame(frame);
    let numbers = numbers(&fragments, frame);
    let grids = grids(scene, frame, true)?;
    let mut lines = MovedLines::new(scene, frame);
    if options.walls == Walls::All {
        let parted = parted_segments(&frame.cracks, &fragments, &numbers);
        let of_crack = |(crack, parted): (&CrackFrame, Vec<bool>)| shifts(crack, &parted, grids[crack.body as usize]);
        lines = lines.hold_open(frame.cracks.iter().zip(parted).map(of_crack).collect());
    }
    let mut sources = BTreeMap::<(u32, u32), Vec<SourceEdge>>::new();
    for (fragment, number) in fragments.list().iter().zip(numbers) {
        let grid = grids[fragment.body as usize];
        let edges = fragment.boundaries.iter().flat_map(|boundary| lines.edges(boundary, grid));
        sources.entry((fragment.body, number)).or_default().extend(edges);
    }
    let mut meshes = Vec::with_capacity(sources.len());
    for ((body, piece), sources) in sources {
        meshes.extend(solid(scene, frame, options, Part { body, piece, sources, grid: grids[body as usize] })?);
    }
    Ok(meshes)
}

/// One solid per body, without its cracks.
pub(crate) fn whole_meshes(scene: &Scene, frame: &Frame, options: &PostOptions) -> Result<Vec<Mesh>, PostError> {
    let grids = grids(scene, frame, false)?;
    let mut meshes = Vec::with_capacity(grids.len());
    for (body, grid) in (0..).zip(grids) {
        let rings = frame.outlines.iter().filter(|o| o.body == body);
        let sources = rings.flat_map(|outline| outline_edges(outline, grid)).collect();
        let particles = &frame.particles;
        let of_body = (0..particles.len()).filter(|&p| particles.body[p] == body);
        let piece = of_body.map(|p| particles.piece[p]).min().unwrap_or(0);
        meshes.extend(solid(scene, frame, options, Part { body, piece, sources, grid })?);
    }
    Ok(meshes)
}

/// The grid of each body.
fn grids(scene: &Scene, frame: &Frame, with_cracks: bool) -> Result<Vec<Grid>, PostError> {
    let grid = |(number, body): (u32, &fissure_scene::Body)| {
        let outlines = frame.outlines.iter().filter(|o| o.body == number);
        let cracks = frame.cracks.iter().filter(|c| with_cracks && c.body == number);
        let faces = cracks.flat_map(|c| c.above.iter().chain(&c.below));
        let grid = Grid::covering(outlines.flat_map(|o| &o.position).chain(faces));
        let (low, high) = body.region.bounds();
        grid.check(frame.number, &body.name, (high - low).amax())?;
        Ok(grid)
    };
    (0..).zip(&scene.bodies).map(grid).collect()
}

/// What becomes one solid.
struct Part {
    body: u32,
    /// Number of the fragment.
    piece: u32,
    /// Its boundary.
    sources: Vec<SourceEdge>,
    /// The grid it lies on.
    grid: Grid,
}

/// Extrudes what the boundary of a part encloses; nothing where that is no more than rounding.
fn solid(scene: &Scene, frame: &Frame, options: &PostOptions, part: Part) -> Result<Option<Mesh>, PostError> {
    let Part { body, piece, mut sources, grid } = part;
    let body = &scene.bodies[body as usize];
    let shapes = without_slivers(material(&sources));
    let parted = part_pinches(shapes, &mut sources).map_err(|place| {
        let place = grid.place(place);
        PostError::Pinch { frame: frame.number, body: body.name.clone(), x: place.x, y: place.y }
    })?;
    let area = |shape: &Shape| 0.5 * shape.iter().map(|c| twice_area(c)).sum::<i128>() as f64 * grid.step * grid.step;
    let whole = without_slivers(parted);
    let polygons = whole.into_iter().map(|shape| (area(&shape), shape));
    let polygons: Vec<(f64, Shape)> = polygons.filter(|(area, _)| *area >= options.smallest_fragment).collect();
    if polygons.is_empty() {
        return Ok(None);
    }
    let (low, high) = body.region.bounds();
    let extrusion = Extrusion {
        grid,
        sources: &sources,
        thickness: options.thickness,
        crease_angle: options.crease_angle,
        texture_origin: low,
        texture_size: (high - low).amax(),
    };
    let area = polygons.iter().map(|(area, _)| area).sum();
    let name = object_name(&body.name, "piece", piece);
    let mut mesh = Mesh::new(name, piece, Content::Solid { area, thickness: options.thickness });
    polygons.iter().for_each(|(_, shape)| extrusion.solid(shape, &mut mesh));
    Ok(Some(mesh))
}
