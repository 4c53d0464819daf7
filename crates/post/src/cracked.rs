//! The bodies as solids, with or without their cracks.

use crate::bevel::{BevelCorner, BevelSize, BevelledCap};
use crate::body_names::body_names;
use crate::body_size::body_size;
use crate::boolean::{Edge, Shape, SourceIndex, common, material, twice_area};
use crate::closed::shifts as closed;
use crate::crumbs::hold_crumb;
use crate::edges::MovedLines;
use crate::error::PostError;
use crate::explode::{groups, together, ways};
use crate::extrude::Extrusion;
use crate::held_open::{LEAST, parted_points, shifts as held_open};
use crate::history::{attributes, histories};
use crate::interior::Interior;
use crate::joined::joined;
use crate::mesh::{Content, Mesh, MeshDefect, object_name};
use crate::narrows::part_narrows;
use crate::needles::blunt_needles;
use crate::options::PostOptions;
use crate::outline::outline_edges;
use crate::overlaps::{Enclosed, share_out_overlaps};
use crate::pieces::numbers;
use crate::pinch::part_pinches;
use crate::pressed_corners::part_caps;
use crate::relief::Relief;
use crate::rest_bevel::RestBevel;
use crate::rest_cut::{RestDivision, rest_cap};
use crate::rest_needles::blunt_at_rest;
use crate::short_edges::{Growth, without_short_edges};
use crate::slivers::{drop_narrow_parts, fill_narrow_holes, is_sliver, without_slivers};
use crate::slot::Slot;
use crate::smooth::SmoothCracks;
use crate::snap::Grid;
use crate::source::{Carried, SourceEdge};
use crate::thinned::{kept_points, picked, thinned};
use crate::triangulate::{Cap, Division, triangulate};
use crate::widening::{Shift, Widening, widened};
use fissure_scene::{
    Attribute, CrackFrame, Cut, Fragments, Frame, OpeningSettings, Point, Region, Scene, Vector, Walls,
};
use rustc_hash::FxHashSet;
use std::collections::BTreeMap;

/// Overlaps of fragments that are at most so wide in the mean are inaccuracies of contact, in cells: faces that press
/// on each other sink in by up to a tenth of a cell, what has no particle of its own by some more, and shards of a few
/// particles, driven into each other by others, by up to .36 (`glass-impact`).
const WIDEST_OVERLAP: f64 = 0.4;

/// How far faces of closed cracks are apart that are cut at rest, in shortest edges: a little more than a quarter, so
/// that programs may merge vertices within 5e-5 of the body, and a crack takes next to nothing of its area.
const APART: f64 = 0.275;
/// The same with rough walls, which come nearer where the two sides have turned differently.
const ROUGH_APART: f64 = 0.35;

/// What an edge may become shorter by as its ends go to the grid, in grid steps.
const ROUNDING: f64 = 3.0;
/// Where needles and narrow places have gone there may be others beside them; so many times at most.
const ROUNDS: usize = 8;

/// Body and number of an object.
type ObjectKey = (u32, u32);
/// The edges around each object.
type Boundaries = BTreeMap<ObjectKey, Vec<SourceEdge>>;

/// One solid per fragment, by body and number, checked.
///
/// Each is made of its own boundary alone, so that what touches or overlaps is never joined.
pub(crate) fn cracked_meshes(scene: &Scene, frame: &Frame, options: &PostOptions) -> Result<Vec<Mesh>, PostError> {
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
            hold_crumb(&mut boundaries, frame, object, scene.particle_spacing, grid);
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
    let mut meshes = BTreeMap::new();
    let mut opened = Boundaries::new();
    for ((body, piece), fragments) in objects {
        if options.cut == Cut::Rest
            && let Some(mesh) = solids.at_rest(body, piece, &fragments)
        {
            meshes.extend(mesh.map(|mesh| ((body, piece), mesh)));
            continue;
        }
        opened.insert((body, piece), fragments.into_iter().flatten().flatten().collect());
    }
    meshes.extend(solids.opened(&opened)?);
    // What has been checked stays as it is: the grid reaches so far.
    let apart = |(object, mesh): (ObjectKey, Mesh)| {
        let offset = factor * shown_ways.get(&object).copied().unwrap_or_default();
        mesh.moved(grids[object.0 as usize].nearest(offset))
    };
    Ok(meshes.into_iter().map(apart).collect())
}

/// Whether cracks within fragments have walls even where they are closed: they are to be shown, or triangles do not
/// depend on the opening and have two sides everywhere.
fn holds_open(options: &PostOptions) -> bool {
    options.walls == Walls::All || options.cut == Cut::Rest
}

/// How far faces of closed cracks within a body of some `size` are kept apart where they are cut at rest [m].
fn apart(options: &PostOptions, size: f64) -> f64 {
    let apart = if options.roughness.is_some() { ROUGH_APART } else { APART };
    if options.cut == Cut::Rest { apart * options.shortest_edge * size } else { 0.0 }
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

/// Makes solids of the boundaries of a frame.
struct Solids<'a> {
    scene: &'a Scene,
    frame: &'a Frame,
    options: &'a PostOptions,
    grids: &'a [Grid],
    interiors: Vec<Interior<'a>>,
    names: Vec<String>,
    /// How rough the walls of cracks are.
    relief: Option<&'a Relief>,
    /// The boundaries of fragments that are to end within them, as cracks are; of others none.
    own: Boundaries,
    /// What of the history of crack walls is known and asked for.
    attributes: Vec<Attribute>,
    check: fn(&Mesh) -> Result<(), MeshDefect>,
}

impl<'a> Solids<'a> {
    fn new(scene: &'a Scene, frame: &'a Frame, options: &'a PostOptions, grids: &'a [Grid]) -> Self {
        let interior = |body| Interior::new(frame, body, scene.particle_spacing, options.cut);
        let interiors = (0..scene.bodies.len() as u32).map(interior).collect();
        let (names, attributes) = (body_names(scene), attributes(frame, options));
        Self {
            scene,
            frame,
            options,
            grids,
            interiors,
            names,
            relief: None,
            own: Boundaries::new(),
            attributes,
            check: Mesh::check,
        }
    }

    /// Extrudes what the boundaries of fragments enclose as they are now; nothing where that is no more than rounding.
    /// One that is no solid once its short edges and needles are gone keeps them.
    fn opened(&self, boundaries: &Boundaries) -> Result<BTreeMap<ObjectKey, Mesh>, PostError> {
        let checked = |mesh: Mesh| (self.check)(&mesh).map(|()| mesh);
        let enclosed = |(&object, sources): (&ObjectKey, &Vec<SourceEdge>)| {
            self.enclosed(object, sources.clone(), self.options.shortest_edge)
        };
        let mut fragments = boundaries.iter().map(enclosed).collect::<Result<Vec<_>, _>>()?;
        self.part(&mut fragments)?;
        let mut solids = BTreeMap::new();
        let mut broken = BTreeMap::new();
        for fragment in &fragments {
            let (object, Some(mesh)) = (fragment.object(), self.solid(fragment)) else { continue };
            let name = mesh.name.clone();
            match checked(mesh) {
                Ok(mesh) => drop(solids.insert(object, mesh)),
                Err(defect) => drop(broken.insert(object, (name, defect))),
            }
        }
        if broken.is_empty() {
            return Ok(solids);
        }
        // What has lost nothing is still as its boundary encloses it.
        for fragment in &mut fragments {
            let object = fragment.object();
            let is_broken = broken.contains_key(&object);
            if is_broken || fragment.has_lost {
                let shortest = if is_broken { 0.0 } else { self.options.shortest_edge };
                *fragment = self.enclosed(object, boundaries[&object].clone(), shortest)?;
            }
        }
        self.part(&mut fragments)?;
        for fragment in &fragments {
            if let Some((name, _)) = broken.get(&fragment.object())
                && let (object, Some(mesh)) = (fragment.object(), self.solid(fragment))
            {
                let of_mesh = |defect| PostError::Defect { frame: self.frame.number, mesh: name.clone(), defect };
                solids.insert(object, checked(mesh).map_err(of_mesh)?);
            }
        }
        Ok(solids)
    }

    /// Parts fragments that lie in each other in the middle of what they have in common.
    fn part(&self, fragments: &mut [Enclosed]) -> Result<(), PostError> {
        let material = |of: &Enclosed, place| self.interiors[of.body as usize].at(place, of.piece);
        share_out_overlaps(fragments, WIDEST_OVERLAP * self.scene.cell_size, material);
        fragments.iter_mut().filter(|fragment| fragment.has_lost).try_for_each(|of| self.tidy(of, Growth::Hardly))
    }

    /// What the boundary of a fragment encloses.
    fn enclosed(
        &self,
        (body, piece): ObjectKey,
        mut sources: Vec<SourceEdge>,
        shortest: f64,
    ) -> Result<Enclosed, PostError> {
        let grid = self.grids[body as usize];
        let least = shortest * body_size(self.scene, body) / grid.step;
        let mut shapes = material(&sources);
        if let Some(own) = self.own.get(&(body, piece)) {
            // A crumb whose faces all move by more than its size would be turned inside out twice, and grow.
            let first = sources.len() as u32;
            let later = |edge: &Edge| Edge { source: SourceIndex(first + edge.source.0), ..*edge };
            let plain = material(own);
            shapes = common(shapes.iter().flatten().flatten().copied(), plain.iter().flatten().flatten().map(later));
            sources.extend(own);
        }
        let shapes = without_slivers(shapes);
        let mut enclosed = Enclosed { body, piece, grid, shapes, sources, least, has_lost: false };
        self.tidy(&mut enclosed, Growth::Allowed)?;
        Ok(enclosed)
    }

    /// Parts contours that touch or nearly do, and takes short edges out of them.
    fn tidy(&self, of: &mut Enclosed, growth: Growth) -> Result<(), PostError> {
        self.tidy_once(of, growth)?;
        if self.options.walls != Walls::All {
            for _ in 0..ROUNDS {
                if !part_narrows(&mut of.shapes, of.least, growth, &mut of.sources) {
                    break;
                }
                self.tidy_once(of, growth)?;
            }
        }
        Ok(())
    }

    fn tidy_once(&self, of: &mut Enclosed, growth: Growth) -> Result<(), PostError> {
        let body = &self.scene.bodies[of.body as usize];
        let parted =
            part_pinches(std::mem::take(&mut of.shapes), &mut of.sources, 0.25 * of.least).map_err(|place| {
                let place = of.grid.place(place);
                PostError::Pinch { frame: self.frame.number, body: body.name.clone(), x: place.x, y: place.y }
            })?;
        of.shapes = without_slivers(parted);
        let sources = &mut of.sources;
        let is_drawn = |edge: &Edge, source: &SourceEdge| is_drawn(&body.region, edge, source);
        if self.options.walls == Walls::All {
            without_short_edges(&mut of.shapes, of.least, growth, sources, is_drawn);
            return Ok(());
        }
        let wide = if of.least > 0.0 { of.least + ROUNDING } else { 0.0 };
        for _ in 0..ROUNDS {
            let is_inside = |edge: &Edge| sources[edge.source.0 as usize].slot == Slot::Inside;
            fill_narrow_holes(&mut of.shapes, of.least, is_inside);
            drop_narrow_parts(&mut of.shapes, of.least, is_inside);
            without_short_edges(&mut of.shapes, of.least, growth, sources, is_drawn);
            if !blunt_needles(&mut of.shapes, wide, growth, sources) {
                break;
            }
        }
        Ok(())
    }

    /// Extrudes a fragment; nothing where it is smaller than asked for.
    fn solid(&self, fragment: &Enclosed) -> Option<Mesh> {
        let &Enclosed { body, piece, grid, .. } = fragment;
        let options = self.options;
        let shown = fragment.shapes.iter().filter(|shape| area(shape, grid) >= options.smallest_fragment);
        let division = Division::Fine { size: options.cap_size.map(|size| size / grid.step) };
        let extrusion = self.extrusion(body, &fragment.sources);
        let carried = |(cap, bevel): BevelledCap| {
            let within = self.interiors[body as usize].of_cap(&cap, &extrusion, piece);
            SolidCap { cap, bevel, within }
        };
        let caps: Vec<Cap> = shown.map(|shape| triangulate(shape, division)).collect();
        let with_bevel = |cap: Cap| {
            let bevel = extrusion.bevel(&cap);
            (cap, bevel)
        };
        if extrusion.bevel.is_some() && !caps.is_empty() {
            let fine = |cap: &Cap| extrusion.bevelled(cap, division).unwrap_or_else(|| with_bevel(cap.clone()));
            let fine: Vec<SolidCap> = caps.iter().map(|cap| carried(fine(cap))).collect();
            let mesh = self.made(body, piece, &extrusion, &fine);
            if mesh.check().is_ok() {
                return Some(mesh);
            }
        }
        self.mesh(body, piece, &extrusion, caps.into_iter().map(|cap| carried(with_bevel(cap))).collect())
    }

    /// Extrudes the triangles of `fragments` at rest, moved with the material. None where that is no solid: where the
    /// material has folded over so that one corner lies on another. Nothing in it where it is smaller than asked for.
    fn at_rest(&self, body: u32, piece: u32, fragments: &[Vec<Vec<SourceEdge>>]) -> Option<Option<Mesh>> {
        let least = self.options.shortest_edge * body_size(self.scene, body);
        let size = self.options.cap_size;
        let apart = apart(self.options, body_size(self.scene, body));
        let plain = RestDivision { size, least, apart, keeps_edges: false, unfolds: false };
        let unfolded = RestDivision { unfolds: true, ..plain };
        let whole = RestDivision { least: 0.0, keeps_edges: true, ..plain };
        [unfolded, plain, whole].into_iter().find_map(|division| self.at_rest_with(body, piece, fragments, division))
    }

    /// The same, in triangles as `division` asks for.
    fn at_rest_with(
        &self,
        body: u32,
        piece: u32,
        fragments: &[Vec<Vec<SourceEdge>>],
        division: RestDivision,
    ) -> Option<Option<Mesh>> {
        let (grid, interior) = (self.grids[body as usize], &self.interiors[body as usize]);
        let region = &self.scene.bodies[body as usize].region;
        let (low, high) = region.bounds();
        let grids = [grid, Grid::covering(&[low, high], 0.0)];
        let bits = |place: &Point| [place.x.to_bits(), place.y.to_bits()];
        let corners: FxHashSet<[u64; 2]> = region.rings().flatten().map(bits).collect();
        let is_corner = |carried: &Carried| corners.contains(&bits(&carried.rest));
        let is_drawn = |edge: &SourceEdge| edge.slot == Slot::Outside && edge.carried.iter().all(is_corner);
        let mut sources = Vec::new();
        let mut caps = Vec::with_capacity(fragments.len());
        for boundaries in fragments.iter().filter(|boundaries| !is_rounding(boundaries, grids[1])) {
            let mut boundaries = joined(boundaries, division.least, grids[1], is_drawn);
            blunt_at_rest(&mut boundaries, division.least);
            let of = rest_cap(&boundaries, sources.len(), division, grids, interior, piece)?;
            caps.push((of.cap, of.carried));
            sources.extend(of.sources);
        }
        if caps.is_empty() {
            return None;
        }
        part_caps(&mut caps, &mut sources, division.apart / grid.step);
        caps.retain(|(cap, _)| area(&cap.shape, grid) >= self.options.smallest_fragment);
        let extrusion = self.extrusion(body, &sources);
        let bevels_at_rest = self.bevels_at_rest(&extrusion, &caps, grids[1]);
        let with_bevel = |((cap, within), at_rest): ((Cap, Vec<Carried>), Vec<BevelCorner>)| {
            let widths: Vec<f64> = at_rest.iter().map(|corner| corner.drop).collect();
            SolidCap { bevel: extrusion.bevel_like(&cap, &widths), cap, within }
        };
        if extrusion.bevel.is_some() && !caps.is_empty() {
            let mut all = sources.clone();
            let fine = |(made, at_rest): (&(Cap, Vec<Carried>), &Vec<BevelCorner>)| {
                let found = extrusion.rest_bevel(&made.0, at_rest, all.len(), division, grids[1], (interior, piece));
                let Some(RestBevel { cap, corners, within, sources }) = found else {
                    return with_bevel((made.clone(), at_rest.clone()));
                };
                all.extend(sources);
                SolidCap { cap, bevel: corners, within }
            };
            let fine: Vec<SolidCap> = caps.iter().zip(&bevels_at_rest).map(fine).collect();
            let mesh = self.made(body, piece, &self.extrusion(body, &all), &fine);
            if (self.check)(&mesh).is_ok() {
                return Some(Some(mesh));
            }
        }
        let mesh = self.mesh(body, piece, &extrusion, caps.into_iter().zip(bevels_at_rest).map(with_bevel).collect());
        mesh.as_ref().is_none_or(|mesh| (self.check)(mesh).is_ok()).then_some(mesh)
    }

    /// Where the corners of some caps that were made at rest go there, on this `grid`: as far as there is room.
    fn bevels_at_rest(
        &self,
        extrusion: &Extrusion<'_>,
        caps: &[(Cap, Vec<Carried>)],
        grid: Grid,
    ) -> Vec<Vec<BevelCorner>> {
        let scale = extrusion.grid.step / grid.step;
        let Some(size) = extrusion.bevel else {
            let still = |edge: &Edge| BevelCorner { point: edge.a, at_rest: Vector::zeros(), drop: 0.0 };
            return caps.iter().map(|(cap, _)| cap.shape.iter().flatten().map(still).collect()).collect();
        };
        let ends = |source: &SourceEdge| [0, 1].map(|end| grid.snap(source.carried[end].rest));
        let at_rest = |source: &SourceEdge| SourceEdge { a: ends(source)[0], b: ends(source)[1], ..*source };
        let sources: Vec<SourceEdge> = extrusion.sources.iter().map(at_rest).collect();
        let bevel = BevelSize { width: scale * size.width, least: scale * size.least };
        let of_rest = Extrusion { grid, sources: &sources, bevel: Some(bevel), ..*extrusion };
        let corners = |(cap, within): &(Cap, Vec<Carried>)| {
            let edge = |edge: &Edge| {
                let [a, b] = ends(extrusion.source(edge));
                Edge { a, b, ..*edge }
            };
            let shape = cap.shape.iter().map(|contour| contour.iter().map(edge).collect()).collect();
            let within = within.iter().map(|carried| grid.snap(carried.rest)).collect();
            of_rest.bevel(&Cap { shape, within, triangles: cap.triangles.clone() })
        };
        caps.iter().map(corners).collect()
    }

    fn extrusion<'b>(&'b self, body: u32, sources: &'b [SourceEdge]) -> Extrusion<'b> {
        Extrusion {
            grid: self.grids[body as usize],
            sources,
            thickness: self.options.thickness,
            crease_angle: self.options.crease_angle,
            texture_origin: self.scene.bodies[body as usize].region.bounds().0,
            texture_size: body_size(self.scene, body),
            at_rest: self.options.cut == Cut::Rest,
            relief: self.relief,
            bevel: self.bevel(body),
        }
    }

    /// How edges are bevelled, if they are.
    fn bevel(&self, body: u32) -> Option<BevelSize> {
        let step = self.grids[body as usize].step;
        let least = self.options.shortest_edge * body_size(self.scene, body) / step;
        (self.options.bevel > 0.0).then_some(BevelSize { width: self.options.bevel / step, least })
    }

    /// The solid of some polygons, with what their corners within carry; none of none. Its walls are smooth and its
    /// edges sharp where it is no solid otherwise: faces that are open by a few grid steps may meet there.
    fn mesh(&self, body: u32, piece: u32, extrusion: &Extrusion<'_>, mut caps: Vec<SolidCap>) -> Option<Mesh> {
        let mut mesh = self.made(body, piece, extrusion, &caps);
        if (extrusion.relief.is_some() || extrusion.bevel.is_some()) && mesh.check().is_err() {
            let plain = Extrusion { relief: None, bevel: None, ..*extrusion };
            caps.iter_mut().for_each(|cap| cap.bevel = plain.bevel(&cap.cap));
            mesh = self.made(body, piece, &plain, &caps);
        }
        (!caps.is_empty()).then_some(mesh)
    }

    /// The solid of some polygons.
    fn made(&self, body: u32, piece: u32, extrusion: &Extrusion<'_>, caps: &[SolidCap]) -> Mesh {
        let area = caps.iter().map(|of| area(&of.cap.shape, extrusion.grid)).sum();
        let name = object_name(&self.names[body as usize], "piece", piece);
        let content = Content::Solid { area, thickness: self.options.thickness, slack: 0.0 };
        let mut mesh = Mesh::new(name, piece, content);
        mesh.texture_size = self.options.uv_in_metres.then_some(extrusion.texture_size);
        mesh.attributes.clone_from(&self.attributes);
        caps.iter().for_each(|of| extrusion.solid(&of.cap, &of.bevel, &of.within, &mut mesh));
        mesh
    }
}

/// A polygon that becomes a solid.
struct SolidCap {
    cap: Cap,
    /// Where its corners on the boundary go.
    bevel: Vec<BevelCorner>,
    /// What its corners within carry.
    within: Vec<Carried>,
}

/// Whether what boundaries enclose at rest, on this `grid`, is no more than rounding: between cracks that lie on each
/// other.
fn is_rounding(boundaries: &[Vec<SourceEdge>], grid: Grid) -> bool {
    let at_rest = |edge: &SourceEdge| {
        let [a, b] = [0, 1].map(|end| grid.snap(edge.carried[end].rest));
        Edge { a, b, source: SourceIndex(0) }
    };
    boundaries.first().is_none_or(|outer| is_sliver(&outer.iter().map(at_rest).collect::<Vec<_>>()))
}

/// Area of a polygon [m²].
fn area(shape: &Shape, grid: Grid) -> f64 {
    0.5 * shape.iter().map(|contour| twice_area(contour)).sum::<i128>() as f64 * grid.step * grid.step
}

/// Whether an edge is one that was drawn, from corner to corner.
fn is_drawn(region: &Region, edge: &Edge, source: &SourceEdge) -> bool {
    let is_corner = |carried: &Carried| region.rings().flatten().any(|corner| *corner == carried.rest);
    let is_whole = (edge.a, edge.b) == (source.a, source.b);
    is_whole && source.slot == Slot::Outside && source.carried.iter().all(is_corner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::{options, scene, square};

    /// The square of 1 m at `x`, with an edge of 1e-4 m along one side and a corner that stands out by as much.
    fn boundary(x: f64, grid: Grid) -> Vec<SourceEdge> {
        let corners = [(0.0, 0.0), (0.5, 0.0), (0.500_05, -1e-4), (0.5001, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let places = corners.map(|(u, v)| Point::new(x + u, v));
        let carried = |rest| Carried::within(rest, Vector::zeros());
        let edge = |(a, b): (&Point, &Point)| SourceEdge {
            a: grid.snap(*a),
            b: grid.snap(*b),
            carried: [carried(*a), carried(*b)],
            slot: Slot::Inside,
        };
        places.iter().zip(places.iter().cycle().skip(1)).map(edge).collect()
    }

    fn stands_out(mesh: &Mesh) -> bool {
        mesh.vertices.iter().any(|vertex| vertex.position[1] < 0.0)
    }

    /// Truth: by hand. Of two fragments with short edges the one that is no solid without them keeps them; one that is
    /// none with them either is an error that names it.
    #[test]
    fn a_fragment_that_breaks_without_its_short_edges_keeps_them() {
        let (scene, frame) = (scene(square(20.0)), Frame::default());
        let (options, grid) = (options(&scene), Grid::covering(&[Point::new(20.0, 20.0)], 0.0));
        let boundaries = Boundaries::from([((0, 3), boundary(0.0, grid)), ((0, 4), boundary(2.0, grid))]);
        let defect = MeshDefect::Open { place: [0.0; 3] };
        let grids = [grid];
        let mut solids = Solids::new(&scene, &frame, &options, &grids);
        let shown = |solids: &Solids<'_>| {
            let meshes = solids.opened(&boundaries)?;
            Ok::<Vec<bool>, PostError>(meshes.values().map(stands_out).collect())
        };
        assert_eq!(shown(&solids), Ok(vec![false, false]));
        solids.check = |mesh| {
            let is_broken = mesh.piece == 4 && !stands_out(mesh);
            if is_broken { Err(MeshDefect::Open { place: [0.0; 3] }) } else { mesh.check() }
        };
        assert_eq!(shown(&solids), Ok(vec![false, true]));
        solids.check = |mesh| if mesh.piece == 4 { Err(MeshDefect::Open { place: [0.0; 3] }) } else { mesh.check() };
        let mesh = "plate_piece_0004".to_owned();
        assert_eq!(shown(&solids), Err(PostError::Defect { frame: 0, mesh, defect }));
    }
}
