//! Solids of fragments that are cut at rest.

use crate::bevel::{BevelCorner, BevelSize};
use crate::body_size::body_size;
use crate::boolean::{Edge, SourceIndex};
use crate::extrude::Extrusion;
use crate::joined::joined;
use crate::mesh::Mesh;
use crate::options::PostOptions;
use crate::pressed_corners::part_caps;
use crate::rest_bevel::RestBevel;
use crate::rest_cut::{RestDivision, rest_cap};
use crate::rest_needles::blunt_at_rest;
use crate::slivers::is_sliver;
use crate::slot::Slot;
use crate::snap::Grid;
use crate::solids::{Boundaries, ObjectKey, SolidCap, Solids, area};
use crate::source::{Carried, SourceEdge};
use crate::triangulate::Cap;
use fissure_scene::{Cut, Point, Vector};
use rustc_hash::FxHashSet;
use std::collections::BTreeMap;

/// How far faces of closed cracks are apart that are cut at rest, in shortest edges: a little more than a quarter, so
/// that programs may merge vertices within 5e-5 of the body, and a crack takes next to nothing of its area.
const APART: f64 = 0.275;
/// The same with rough walls, which come nearer where the two sides have turned differently.
const ROUGH_APART: f64 = 0.35;

/// How far faces of closed cracks within a body of some `size` are kept apart where they are cut at rest [m].
pub(crate) fn apart(options: &PostOptions, size: f64) -> f64 {
    let apart = if options.roughness.is_some() { ROUGH_APART } else { APART };
    if options.cut == Cut::Rest { apart * options.shortest_edge * size } else { 0.0 }
}

/// An object cut at rest, before it is extruded.
pub(crate) struct RestObject {
    pub(crate) body: u32,
    pub(crate) piece: u32,
    /// Its parts, with what their corners within carry.
    pub(crate) caps: Vec<(Cap, Vec<Carried>)>,
    /// Where the edges of all parts come from, in their order.
    pub(crate) sources: Vec<SourceEdge>,
    division: RestDivision,
}

impl Solids<'_> {
    /// Extrudes the triangles of fragments at rest, moved with the material, beside each other. What is no solid then,
    /// where the material has folded over so that one corner lies on another, goes to `opened`.
    pub(crate) fn at_rest(
        &self,
        objects: BTreeMap<ObjectKey, Vec<Vec<Vec<SourceEdge>>>>,
        opened: &mut Boundaries,
    ) -> BTreeMap<ObjectKey, Mesh> {
        let mut cut = Vec::with_capacity(objects.len());
        for (&object, fragments) in &objects {
            let mut divisions = self.divisions(object.0).into_iter();
            match divisions.find_map(|division| self.cut_at_rest(object, fragments, division)) {
                Some(found) => cut.push(found),
                None => drop(opened.insert(object, fragments.iter().flatten().flatten().copied().collect())),
            }
        }
        self.push_apart(&mut cut, opened);
        let mut meshes = BTreeMap::new();
        for of in cut {
            let object = (of.body, of.piece);
            let fragments = &objects[&object];
            let again = |division| self.extruded(self.cut_at_rest(object, fragments, division)?);
            match self.extruded(of).or_else(|| self.divisions(object.0).into_iter().find_map(again)) {
                Some(mesh) => meshes.extend(mesh.map(|mesh| (object, mesh))),
                None => drop(opened.insert(object, fragments.iter().flatten().flatten().copied().collect())),
            }
        }
        meshes
    }

    /// The ways to divide a fragment of a body, the best first.
    fn divisions(&self, body: u32) -> [RestDivision; 3] {
        let least = self.options.shortest_edge * body_size(self.scene, body);
        let size = self.options.cap_size;
        let apart = apart(self.options, body_size(self.scene, body));
        let plain = RestDivision { size, least, apart, keeps_edges: false, unfolds: false };
        let unfolded = RestDivision { unfolds: true, ..plain };
        let whole = RestDivision { least: 0.0, keeps_edges: true, ..plain };
        [unfolded, plain, whole]
    }

    /// The triangles of fragments at rest, moved with the material.
    fn cut_at_rest(
        &self,
        (body, piece): ObjectKey,
        fragments: &[Vec<Vec<SourceEdge>>],
        division: RestDivision,
    ) -> Option<RestObject> {
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
        Some(RestObject { body, piece, caps, sources, division })
    }

    /// The solid of an object; none where it is no solid. Nothing in it where it is smaller than asked for.
    fn extruded(&self, object: RestObject) -> Option<Option<Mesh>> {
        let RestObject { body, piece, mut caps, sources, division } = object;
        let (grid, interior) = (self.grids[body as usize], &self.interiors[body as usize]);
        let (low, high) = self.scene.bodies[body as usize].region.bounds();
        let rest_grid = Grid::covering(&[low, high], 0.0);
        caps.retain(|(cap, _)| area(&cap.shape, grid) >= self.options.smallest_fragment);
        let extrusion = self.extrusion(body, &sources);
        let bevels_at_rest = self.bevels_at_rest(&extrusion, &caps, rest_grid);
        let with_bevel = |((cap, within), at_rest): ((Cap, Vec<Carried>), Vec<BevelCorner>)| {
            let widths: Vec<f64> = at_rest.iter().map(|corner| corner.drop).collect();
            SolidCap { bevel: extrusion.bevel_like(&cap, &widths), cap, within }
        };
        if extrusion.bevel.is_some() && !caps.is_empty() {
            let mut all = sources.clone();
            let fine = |(made, at_rest): (&(Cap, Vec<Carried>), &Vec<BevelCorner>)| {
                let found = extrusion.rest_bevel(&made.0, at_rest, all.len(), division, rest_grid, (interior, piece));
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
