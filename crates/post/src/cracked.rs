//! The bodies as solids, with or without their cracks.

use crate::boolean::{Edge, Shape, material, twice_area};
use crate::edges::MovedLines;
use crate::error::PostError;
use crate::extrude::Extrusion;
use crate::held_open::{parted_segments, shifts};
use crate::interior::Interior;
use crate::mesh::{Content, Mesh, object_name};
use crate::options::PostOptions;
use crate::outline::outline_edges;
use crate::pieces::numbers;
use crate::pinch::part_pinches;
use crate::short_edges::without_short_edges;
use crate::slivers::without_slivers;
use crate::slot::Slot;
use crate::snap::Grid;
use crate::source::{Carried, SourceEdge};
use crate::triangulate::{Cap, Division, triangulate};
use fissure_scene::{CrackFrame, Fragments, Frame, Region, Scene, Walls};
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
    let interiors = interiors(scene, frame);
    for ((body, piece), sources) in sources {
        let (grid, interior) = (grids[body as usize], &interiors[body as usize]);
        meshes.extend(solid(scene, frame, options, Part { body, piece, sources, grid, interior })?);
    }
    Ok(meshes)
}

/// One solid per body, without its cracks.
pub(crate) fn whole_meshes(scene: &Scene, frame: &Frame, options: &PostOptions) -> Result<Vec<Mesh>, PostError> {
    let grids = grids(scene, frame, false)?;
    let mut meshes = Vec::with_capacity(grids.len());
    for (body, (grid, interior)) in (0..).zip(grids.into_iter().zip(&interiors(scene, frame))) {
        let rings = frame.outlines.iter().filter(|o| o.body == body);
        let sources = rings.flat_map(|outline| outline_edges(outline, grid)).collect();
        let particles = &frame.particles;
        let of_body = (0..particles.len()).filter(|&p| particles.body[p] == body);
        let piece = of_body.map(|p| particles.piece[p]).min().unwrap_or(0);
        meshes.extend(solid(scene, frame, options, Part { body, piece, sources, grid, interior })?);
    }
    Ok(meshes)
}

/// What the material of each body carries.
fn interiors<'a>(scene: &Scene, frame: &'a Frame) -> Vec<Interior<'a>> {
    (0..scene.bodies.len() as u32).map(|body| Interior::new(frame, body, scene.particle_spacing)).collect()
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
struct Part<'a> {
    body: u32,
    /// Number of the fragment.
    piece: u32,
    /// Its boundary.
    sources: Vec<SourceEdge>,
    /// The grid it lies on.
    grid: Grid,
    /// What its body carries.
    interior: &'a Interior<'a>,
}

/// Extrudes what the boundary of a part encloses; nothing where that is no more than rounding.
fn solid(scene: &Scene, frame: &Frame, options: &PostOptions, part: Part<'_>) -> Result<Option<Mesh>, PostError> {
    let Part { body, piece, mut sources, grid, interior } = part;
    let body = &scene.bodies[body as usize];
    let (low, high) = body.region.bounds();
    let size = (high - low).amax();
    let least = options.shortest_edge * size / grid.step;
    let shapes = without_slivers(material(&sources));
    let parted = part_pinches(shapes, &mut sources, 0.25 * least).map_err(|place| {
        let place = grid.place(place);
        PostError::Pinch { frame: frame.number, body: body.name.clone(), x: place.x, y: place.y }
    })?;
    let mut shapes = without_slivers(parted);
    let is_drawn = |edge: &Edge, source: &SourceEdge| is_drawn(&body.region, edge, source);
    without_short_edges(&mut shapes, least, &mut sources, is_drawn);
    let area = |shape: &Shape| 0.5 * shape.iter().map(|c| twice_area(c)).sum::<i128>() as f64 * grid.step * grid.step;
    shapes.retain(|shape| area(shape) >= options.smallest_fragment);
    if shapes.is_empty() {
        return Ok(None);
    }
    let division = Division::Fine { size: options.cap_size.map(|size| size / grid.step) };
    let caps: Vec<Cap> = shapes.iter().map(|shape| triangulate(shape, division)).collect();
    let extrusion = Extrusion {
        grid,
        sources: &sources,
        thickness: options.thickness,
        crease_angle: options.crease_angle,
        texture_origin: low,
        texture_size: size,
        interior: Some(interior),
    };
    let area = caps.iter().map(|cap| area(&cap.shape)).sum();
    let name = object_name(&body.name, "piece", piece);
    let mut mesh = Mesh::new(name, piece, Content::Solid { area, thickness: options.thickness });
    caps.iter().for_each(|cap| extrusion.solid(cap, &mut mesh));
    Ok(Some(mesh))
}

/// Whether an edge is one that was drawn, from corner to corner.
fn is_drawn(region: &Region, edge: &Edge, source: &SourceEdge) -> bool {
    let is_corner = |carried: &Carried| region.rings().flatten().any(|corner| *corner == carried.rest);
    let is_whole = (edge.a, edge.b) == (source.a, source.b);
    is_whole && source.slot == Slot::Outside && source.carried.iter().all(is_corner)
}
