//! Solids of polygons: what the boundaries of fragments enclose, checked.

use crate::bevel::{BevelCorner, BevelSize, BevelledCap};
use crate::body_names::body_names;
use crate::body_size::body_size;
use crate::boolean::{Edge, Shape, SourceIndex, common, material, twice_area};
use crate::error::PostError;
use crate::extrude::Extrusion;
use crate::history::attributes;
use crate::interior::Interior;
use crate::lattice::{Enclosed, Material};
use crate::mesh::{Content, Mesh, MeshDefect, object_name};
use crate::options::PostOptions;
use crate::overlaps::share_out_overlaps;
use crate::relief::Relief;
use crate::short_edges::Growth;
use crate::slivers::without_slivers;
use crate::snap::Grid;
use crate::source::{Carried, SourceEdge};
use crate::triangulate::{Cap, Division, triangulate};
use fissure_scene::{Attribute, Cut, Frame, Point, Scene, Vector};
use std::collections::BTreeMap;

/// Overlaps of fragments that are at most so wide in the mean are inaccuracies of contact, in cells: faces that press
/// on each other sink in by up to a tenth of a cell, what has no particle of its own by some more, and shards of a few
/// particles, driven into each other by others, by up to .36 (`glass-impact`).
pub(crate) const WIDEST_OVERLAP: f64 = 0.4;

/// Body and number of an object.
pub(crate) type ObjectKey = (u32, u32);
/// The edges around each object.
pub(crate) type Boundaries = BTreeMap<ObjectKey, Vec<SourceEdge>>;

/// Makes solids of the boundaries of a frame.
pub(crate) struct Solids<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) frame: &'a Frame,
    pub(crate) options: &'a PostOptions,
    pub(crate) grids: &'a [Grid],
    pub(crate) interiors: Vec<Interior<'a>>,
    pub(crate) names: Vec<String>,
    /// How rough the walls of cracks are.
    pub(crate) relief: Option<&'a Relief>,
    /// The boundaries of fragments that are to end within them, as cracks are; of others none.
    pub(crate) own: Boundaries,
    /// What of the history of crack walls is known and asked for.
    pub(crate) attributes: Vec<Attribute>,
    pub(crate) check: fn(&Mesh) -> Result<(), MeshDefect>,
}

impl<'a> Solids<'a> {
    pub(crate) fn new(scene: &'a Scene, frame: &'a Frame, options: &'a PostOptions, grids: &'a [Grid]) -> Self {
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
    pub(crate) fn opened(&self, boundaries: &Boundaries) -> Result<BTreeMap<ObjectKey, Mesh>, PostError> {
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
        share_out_overlaps(fragments, WIDEST_OVERLAP * self.scene.cell_size, self);
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

    pub(crate) fn extrusion<'b>(&'b self, body: u32, sources: &'b [SourceEdge]) -> Extrusion<'b> {
        let (grid, bounds) = (self.grids[body as usize], self.scene.bodies[body as usize].region.bounds());
        let plain = Extrusion::plain(grid, sources, self.options, bounds);
        Extrusion { at_rest: self.options.cut == Cut::Rest, relief: self.relief, bevel: self.bevel(body), ..plain }
    }

    /// How edges are bevelled, if they are.
    fn bevel(&self, body: u32) -> Option<BevelSize> {
        let step = self.grids[body as usize].step;
        let least = self.options.shortest_edge * body_size(self.scene, body) / step;
        (self.options.bevel > 0.0).then_some(BevelSize { width: self.options.bevel / step, least })
    }

    /// The solid of some polygons, with what their corners within carry; none of none. Its walls are smooth and its
    /// edges sharp where it is no solid otherwise: faces that are open by a few grid steps may meet there.
    pub(crate) fn mesh(
        &self,
        body: u32,
        piece: u32,
        extrusion: &Extrusion<'_>,
        mut caps: Vec<SolidCap>,
    ) -> Option<Mesh> {
        let mut mesh = self.made(body, piece, extrusion, &caps);
        if (extrusion.relief.is_some() || extrusion.bevel.is_some()) && mesh.check().is_err() {
            let plain = Extrusion { relief: None, bevel: None, ..*extrusion };
            caps.iter_mut().for_each(|cap| cap.bevel = plain.bevel(&cap.cap));
            mesh = self.made(body, piece, &plain, &caps);
        }
        (!caps.is_empty()).then_some(mesh)
    }

    /// The solid of some polygons.
    pub(crate) fn made(&self, body: u32, piece: u32, extrusion: &Extrusion<'_>, caps: &[SolidCap]) -> Mesh {
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

impl Material for Solids<'_> {
    fn at(&self, fragment: &Enclosed, place: Point) -> Option<(Point, Vector)> {
        self.interiors[fragment.body as usize].at(place, fragment.piece)
    }

    fn is_in(&self, fragment: &Enclosed, contours: &[Vec<Point>]) -> bool {
        self.interiors[fragment.body as usize].is_in(contours, fragment.piece)
    }
}

/// A polygon that becomes a solid.
pub(crate) struct SolidCap {
    pub(crate) cap: Cap,
    /// Where its corners on the boundary go.
    pub(crate) bevel: Vec<BevelCorner>,
    /// What its corners within carry.
    pub(crate) within: Vec<Carried>,
}

/// Area of a polygon [m²].
pub(crate) fn area(shape: &Shape, grid: Grid) -> f64 {
    0.5 * shape.iter().map(|contour| twice_area(contour)).sum::<i128>() as f64 * grid.step * grid.step
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::{options, scene, square};
    use crate::slot::Slot;

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
