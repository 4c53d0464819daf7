//! The bodies as solids, with or without their cracks.

use crate::body_size::body_size;
use crate::boolean::material;
use crate::closed::shifts as closed;
use crate::drawn_out::hold_drawn_out;
use crate::edges::MovedLines;
use crate::error::PostError;
use crate::explode::{groups, together, ways};
use crate::held_open::{LEAST, parted_points, shifts as held_open};
use crate::history::histories;
use crate::mesh::Mesh;
use crate::options::PostOptions;
use crate::outline::outline_edges;
use crate::pieces::numbers;
use crate::relief::Relief;
use crate::rest_solids::apart;
use crate::smooth::SmoothCracks;
use crate::snap::Grid;
use crate::solids::{Boundaries, ObjectKey, Solids};
use crate::source::SourceEdge;
use crate::thinned::{kept_points, picked, thinned};
use crate::widening::{Shift, Widening, widened};
use fissure_scene::{CrackFrame, Cut, Fragments, Frame, OpeningSettings, Scene, Vector, Walls};
use std::collections::BTreeMap;

/// The bodies with their cracks.
pub(crate) struct Cracked {
    pub(crate) meshes: Vec<Mesh>,
    /// How far fragments are shown from where they are, by body and number [m]; those that are where they are left out.
    pub(crate) moves: BTreeMap<ObjectKey, Vector>,
}

/// One solid per fragment, by body and number, checked.
///
/// Each is made of its own boundary alone, so that what touches or overlaps is never joined.
pub(crate) fn cracked_meshes(scene: &Scene, frame: &Frame, options: &PostOptions) -> Result<Cracked, PostError> {
    let mut fragments = Fragments::of_frame(frame);
    let mut cracks = SmoothCracks::new(scene, frame, &fragments, options.smoothing);
    let mut histories = if options.attributes.is_empty() { None } else { histories(frame) };
    let lines;
    let mut moved = frame;
    if options.wall_step > 0.0 {
        let kept = kept_points(scene, frame, &fragments, &cracks, options.wall_step * scene.cell_size);
        (lines, cracks) = thinned(frame, &cracks, &kept);
        moved = &lines;
        fragments = Fragments::of_frame(moved);
        histories = histories.map(|all| all.iter().zip(&kept).map(|(of_crack, kept)| picked(of_crack, kept)).collect());
    }
    let numbers = numbers(&fragments, frame);
    let factor = options.explode.as_ref().map_or(0.0, |curve| curve.value(frame.time));
    let shown_ways = if factor == 0.0 { BTreeMap::new() } else { ways(&frame.particles, &frame.particles.position) };
    let mut shifts = shifts(scene, frame.time, &cracks.cracks, options);
    let beyond = factor.abs() * farthest(shown_ways.values())
        + farthest(shifts.iter().flatten().flat_map(|s| [&s.above, &s.below]));
    let grids = grids(scene, frame, &cracks.cracks, beyond)?;
    let parted = parted_points(&cracks.cracks, &fragments, &numbers);
    for ((crack, parted), shifts) in cracks.cracks.iter().zip(parted).zip(&mut shifts) {
        let shown = widened(crack, shifts);
        let more = if holds_open(options) {
            let rounding = LEAST * grids[crack.body as usize].step;
            held_open(&shown, &parted, rounding.max(apart(options, body_size(scene, crack.body))))
        } else if options.shortest_edge == 0.0 {
            continue;
        } else {
            closed(&shown, &parted, options.shortest_edge * body_size(scene, crack.body))
        };
        shifts.iter_mut().zip(more).for_each(|(shift, more)| *shift = *shift + more);
    }
    let relief = Relief::new(scene, options, moved, &cracks);
    // Faces that only move into the material leave no fragment beyond itself.
    let takes_off = |settings: &&OpeningSettings| settings.factor.value(frame.time) >= 1.0;
    let still = || shifts.iter().map(|of_crack| vec![Shift::default(); of_crack.len()]).collect();
    let still_lines = options
        .opening
        .as_ref()
        .filter(takes_off)
        .map(|_| MovedLines::new(scene, moved, &cracks, still()).with(histories.clone()));
    let lines = MovedLines::new(scene, moved, &cracks, shifts).with(histories);
    let mut objects = BTreeMap::<ObjectKey, Vec<Vec<Vec<SourceEdge>>>>::new();
    let mut own = Boundaries::new();
    for (fragment, number) in fragments.list().iter().zip(numbers) {
        let (grid, object) = (grids[fragment.body as usize], (fragment.body, number));
        let mut boundaries: Vec<Vec<SourceEdge>> =
            fragment.boundaries.iter().map(|boundary| lines.edges(boundary, grid)).collect();
        if options.opening.is_none() {
            hold_drawn_out(&mut boundaries, frame, object, scene.particle_spacing, grid);
        }
        if let Some(lines) = &still_lines {
            let edges = fragment.boundaries.iter().flat_map(|boundary| lines.edges(boundary, grid));
            own.entry(object).or_default().extend(edges);
        }
        objects.entry(object).or_default().push(boundaries);
    }
    let mut solids = Solids { relief: relief.as_ref(), own, ..Solids::new(scene, frame, options, &grids) };
    if options.cut == Cut::Rest {
        (0..).zip(&mut solids.interiors).for_each(|(body, interior)| interior.part(body, &cracks));
    }
    let shown_ways = if shown_ways.is_empty() {
        shown_ways
    } else {
        let rest_grids: Vec<Grid> = scene
            .bodies
            .iter()
            .map(|body| {
                let (low, high) = body.region.bounds();
                Grid::covering(&[low, high], 0.0)
            })
            .collect();
        let at_rest = |(&object, fragments): (&ObjectKey, &Vec<Vec<Vec<SourceEdge>>>)| {
            let grid = rest_grids[object.0 as usize];
            let edges = fragments.iter().flatten().flatten().map(|edge| {
                let [a, b] = [0, 1].map(|end| grid.snap(edge.carried[end].rest));
                SourceEdge { a, b, ..*edge }
            });
            (object, material(&edges.collect::<Vec<_>>()))
        };
        let largest = options.explode.iter().flat_map(|curve| &curve.points).map(|point| point.1).fold(0.0, f64::max);
        let rest_ways = ways(&frame.particles, &frame.particles.rest);
        let members = groups(&rest_ways, objects.iter().map(at_rest).collect(), &rest_grids, largest);
        together(shown_ways, &members)
    };
    let mut opened = Boundaries::new();
    let mut meshes = if options.cut == Cut::Rest {
        solids.at_rest(objects, &mut opened)
    } else {
        let whole = |fragments: Vec<Vec<Vec<SourceEdge>>>| fragments.into_iter().flatten().flatten().collect();
        opened.extend(objects.into_iter().map(|(object, fragments)| (object, whole(fragments))));
        BTreeMap::new()
    };
    meshes.extend(solids.opened(&opened)?);
    // What has been checked stays as it is: the grid reaches so far.
    let moved = |(object, way): (ObjectKey, Vector)| (object, grids[object.0 as usize].nearest(factor * way));
    let moves: BTreeMap<ObjectKey, Vector> = shown_ways.into_iter().map(moved).collect();
    let apart = |(object, mesh): (ObjectKey, Mesh)| mesh.moved(moves.get(&object).copied().unwrap_or_default());
    Ok(Cracked { meshes: meshes.into_iter().map(apart).collect(), moves })
}

/// Whether cracks within fragments have walls even where they are closed: they are to be shown, or triangles do not
/// depend on the opening and have two sides everywhere.
fn holds_open(options: &PostOptions) -> bool {
    options.walls == Walls::All || options.cut == Cut::Rest
}

/// How far the faces of each crack are moved at each of its points: as it is to be shown.
fn shifts(scene: &Scene, time: f64, cracks: &[CrackFrame], options: &PostOptions) -> Vec<Vec<Shift>> {
    let still = |crack: &CrackFrame| vec![Shift::default(); crack.rest.len()];
    let Some(opening) = &options.opening else { return cracks.iter().map(still).collect() };
    let widening = Widening::new(opening, scene, time);
    cracks.iter().map(|crack| widening.shifts(crack)).collect()
}

/// The largest component of any of `vectors` [m].
fn farthest<'a>(vectors: impl Iterator<Item = &'a Vector>) -> f64 {
    vectors.map(Vector::amax).fold(0.0, f64::max)
}

/// One solid per body, without its cracks, checked.
pub(crate) fn whole_meshes(scene: &Scene, frame: &Frame, options: &PostOptions) -> Result<Vec<Mesh>, PostError> {
    let grids = grids(scene, frame, &[], 0.0)?;
    let mut bodies = Boundaries::new();
    let options = &PostOptions { cut: Cut::Opening, ..options.clone() };
    let solids = Solids::new(scene, frame, options, &grids);
    for (body, &grid) in (0..).zip(&grids) {
        let rings = frame.outlines.iter().filter(|o| o.body == body);
        let sources = rings.flat_map(|outline| outline_edges(scene, outline, grid)).collect();
        let particles = &frame.particles;
        let of_body = (0..particles.len()).filter(|&p| particles.body[p] == body);
        let piece = of_body.map(|p| particles.piece[p]).min().unwrap_or(0);
        bodies.insert((body, piece), sources);
    }
    Ok(solids.opened(&bodies)?.into_values().collect())
}

/// The grid of each body, fine enough for its outline and `cracks`, all moved by so much `beyond` [m].
fn grids(scene: &Scene, frame: &Frame, cracks: &[CrackFrame], beyond: f64) -> Result<Vec<Grid>, PostError> {
    let grid = |(number, body): (u32, &fissure_scene::Body)| {
        let outlines = frame.outlines.iter().filter(|o| o.body == number);
        let cracks = cracks.iter().filter(|c| c.body == number);
        let at_rest = outlines.clone().flat_map(|o| &o.rest).chain(cracks.clone().flat_map(|c| &c.rest));
        let faces = cracks.flat_map(|c| c.above.iter().chain(&c.below));
        let grid = Grid::covering(outlines.flat_map(|o| &o.position).chain(faces), beyond);
        let (low, high) = body.region.bounds();
        // Places at rest may tell how far something has moved: without reason they lead beyond all grids.
        for grid in [grid, Grid::covering(at_rest, 0.0)] {
            grid.check(frame.number, &body.name, (high - low).amax())?;
        }
        Ok(grid)
    };
    (0..).zip(&scene.bodies).map(grid).collect()
}
