//! A fragment cut where it lies at rest: triangles that the material carries along.
//!
//! The triangles depend on rings and cracks at rest alone. As long as no crack grows they are the same from frame to
//! frame, corner by corner. A crack that ends within a fragment is an edge of them with two sides: going around a
//! corner, what lies between two edges of the boundary has a corner of its own.

use crate::boolean::{Edge, SourceIndex};
use crate::drawn_along::drawn_along;
use crate::interior::Interior;
use crate::snap::Grid;
use crate::source::{Carried, SourceEdge};
use crate::triangulate::Cap;
use fissure_scene::{Point, Vector};
use spade::handles::FixedVertexHandle;
use spade::{AngleLimit, ConstrainedDelaunayTriangulation, Point2, RefinementParameters, Triangulation as _};
use std::collections::{BTreeMap, BTreeSet};

type Delaunay = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// Smallest angle that new corners are made for [degrees].
const SMALLEST_ANGLE: f64 = 20.1;

/// Triangles of the fragment with these boundaries, moved with the material, and what the corners within carry. The
/// edges of the boundaries are `first` and those after it of their object; new corners lie within only.
///
/// `grids`: those of the body now and at rest.
///
/// `ways`: how far each edge's first corner is moved to be shown, edge after edge [m]; empty where nothing is.
///
/// None where edges cross at rest, which those of [`fissure_scene::Fragments`] do by rounding to the grid only, or
/// where no particle of fragment `piece` is near to a corner.
pub(crate) fn rest_cap(
    boundaries: &[Vec<SourceEdge>],
    ways: &[Vector],
    first: usize,
    size: Option<f64>,
    grids: [Grid; 2],
    interior: &Interior<'_>,
    piece: u32,
) -> Option<(Cap, Vec<Carried>)> {
    let [grid, rest_grid] = grids;
    let (corners, places) = corners(boundaries, rest_grid);
    let triangles = triangles(&corners, places, size.map(|size| size / rest_grid.step))?;
    let sides = Sides::new(&triangles, &corners)?;
    let mut source = first as u32;
    let mut contour = |edges: &Vec<SourceEdge>| {
        let edge = |e: &SourceEdge| {
            source += 1;
            Edge { a: e.a, b: e.b, source: SourceIndex(source - 1) }
        };
        edges.iter().map(edge).collect::<Vec<_>>()
    };
    let shape = boundaries.iter().map(&mut contour).collect();
    let (mut within, mut carried) = (Vec::new(), Vec::new());
    let mut number = BTreeMap::new();
    let mut found = Vec::with_capacity(sides.faces.len());
    for (face, corner) in sides.faces {
        let mut triangle = [0; 3];
        for (k, vertex) in triangles.face(face).vertices().into_iter().enumerate() {
            triangle[k] = match corner[k] {
                Some(corner) => corner,
                None => match number.get(&vertex.index()) {
                    Some(&number) => number,
                    None => {
                        let Point2 { x, y } = vertex.position();
                        let rest = Point::new(x, y) * rest_grid.step;
                        let (place, velocity) = interior.moved(rest, piece)?;
                        within.push(grid.snap(place));
                        carried.push(Carried::within(rest, velocity));
                        let new = sides.count + within.len() as u32 - 1;
                        number.insert(vertex.index(), new);
                        new
                    }
                },
            };
        }
        found.push(triangle);
    }
    if !ways.is_empty() {
        let outer = boundaries.iter().flatten().map(|edge| edge.carried[0].rest);
        let places: Vec<Point> = outer.chain(carried.iter().map(|carried| carried.rest)).collect();
        let along = drawn_along(ways, &places, &found);
        for (place, way) in within.iter_mut().zip(&along[ways.len()..]) {
            *place = grid.snap(grid.place(*place) + way);
        }
    }
    Some((Cap { shape, within, triangles: found }, carried))
}

/// The number of the place of each corner, and the places at rest, in grid steps.
fn corners(boundaries: &[Vec<SourceEdge>], grid: Grid) -> (Vec<Vec<usize>>, Vec<Point2<f64>>) {
    let mut places = Vec::new();
    let mut number = BTreeMap::new();
    let mut corner = |edge: &SourceEdge| {
        let place = grid.snap(edge.carried[0].rest);
        *number.entry((place.x, place.y)).or_insert_with(|| {
            places.push(Point2::new(place.x as f64, place.y as f64));
            places.len() - 1
        })
    };
    let corners = boundaries.iter().map(|boundary| boundary.iter().map(&mut corner).collect()).collect();
    (corners, places)
}

/// The places with the boundary among the edges; none if edges cross or have no length. `size`: of edges within, in
/// grid steps.
fn triangles(corners: &[Vec<usize>], places: Vec<Point2<f64>>, size: Option<f64>) -> Option<Delaunay> {
    let pairs = corners.iter().flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
    let edges: BTreeSet<[usize; 2]> = pairs.map(|(&a, &b)| [a.min(b), a.max(b)]).collect();
    if edges.iter().any(|[a, b]| a == b) {
        return None;
    }
    let count = places.len();
    let mut crosses = false;
    let mut triangles = Delaunay::try_bulk_load_cdt(places, edges.into_iter().collect(), |_| crosses = true).ok()?;
    if crosses || triangles.num_vertices() != count {
        return None;
    }
    let mut parameters = RefinementParameters::<f64>::new()
        .keep_constraint_edges()
        .with_angle_limit(AngleLimit::from_deg(SMALLEST_ANGLE));
    if let Some(size) = size {
        let area = 0.25 * 3.0_f64.sqrt() * size * size;
        let hull: f64 = triangles.inner_faces().map(|face| face.area()).sum();
        parameters = parameters
            .with_max_allowed_area(area)
            .with_max_additional_vertices(20 * count + (4.0 * hull / area) as usize);
    }
    triangles.refine(parameters);
    Some(triangles)
}

/// Which corner of the boundary each triangle has at each of its places.
struct Sides {
    /// The triangles within, each with the numbers of its corners that lie on the boundary.
    faces: Vec<(spade::handles::FixedFaceHandle<spade::handles::InnerTag>, [Option<u32>; 3])>,
    /// Number of corners on the boundary.
    count: u32,
}

impl Sides {
    /// Goes around each corner, from the edge that leaves it to the one that arrives, over the triangles between.
    fn new(triangles: &Delaunay, corners: &[Vec<usize>]) -> Option<Self> {
        let vertex = FixedVertexHandle::from_index;
        let mut sides = BTreeMap::new();
        let mut open = Vec::new();
        let mut count = 0;
        for ring in corners {
            for i in 0..ring.len() {
                let (before, here, after) =
                    (ring[(i + ring.len() - 1) % ring.len()], ring[i], ring[(i + 1) % ring.len()]);
                let mut edge = triangles.get_edge_from_neighbors(vertex(here), vertex(after))?;
                loop {
                    let face = edge.face().as_inner()?;
                    let place = face.vertices().iter().position(|v| v.index() == here)?;
                    sides.entry(face.index()).or_insert((face.fix(), [None; 3])).1[place] = Some(count);
                    open.push(face.fix());
                    edge = edge.prev().rev();
                    if edge.to().index() == before {
                        break;
                    }
                    // An edge of the boundary that is not one of this corner: the walk does not fit the triangles.
                    if edge.is_constraint_edge() {
                        return None;
                    }
                }
                count += 1;
            }
        }
        // From there inwards.
        while let Some(face) = open.pop() {
            for edge in triangles.face(face).adjacent_edges().iter().filter(|edge| !edge.is_constraint_edge()) {
                let next = edge.rev().face().as_inner()?;
                if let std::collections::btree_map::Entry::Vacant(new) = sides.entry(next.index()) {
                    new.insert((next.fix(), [None; 3]));
                    open.push(next.fix());
                }
            }
        }
        Some(Self { faces: sides.into_values().collect(), count })
    }
}
