//! A fragment cut where it lies at rest: triangles that the material carries along.
//!
//! The triangles depend on rings and cracks at rest alone. As long as no crack grows they are the same from frame to
//! frame, corner by corner. A crack that ends within a fragment is an edge of them with two sides: going around a
//! corner, what lies between two edges of the boundary has a corner of its own.

use crate::boolean::{Edge, Shape, SourceIndex};
use crate::carrying::{CarriedCorners, Carrying};
use crate::interior::Interior;
use crate::snap::{Grid, GridPoint};
use crate::source::{Carried, SourceEdge};
use crate::triangulate::{Cap, inwards};
use fissure_scene::{Point, Vector};
use spade::handles::FixedVertexHandle;
use spade::{AngleLimit, ConstrainedDelaunayTriangulation, Point2, RefinementParameters, Triangulation as _};
use std::collections::{BTreeMap, BTreeSet};

type Delaunay = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// Smallest angle that new corners are made for [degrees].
const SMALLEST_ANGLE: f64 = 20.1;

/// Room between a fragment and the frame around it, as a part of its size.
const MARGIN: f64 = 0.5;

/// Corners of that frame.
const FRAME: usize = 4;

/// Parts of edges are longer than so many grid steps.
const SHORTEST_PART: f64 = 8.0;

/// How the triangles of a fragment at rest are made.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RestDivision {
    /// Length of edges within, at most [m]; none: as long as may be.
    pub(crate) size: Option<f64>,
    /// Triangles so small that their edges are shorter are not divided [m].
    pub(crate) least: f64,
    /// Whether edges of the boundary get no new corners.
    pub(crate) keeps_edges: bool,
    /// Whether corners of the boundary may be elsewhere where it has turned over.
    pub(crate) unfolds: bool,
}

/// Triangles of a fragment at rest, moved with the material.
pub(crate) struct RestCap {
    pub(crate) cap: Cap,
    /// What the corners within carry.
    pub(crate) carried: Vec<Carried>,
    /// Where the edges of `cap` come from, in their order.
    pub(crate) sources: Vec<SourceEdge>,
}

/// Triangles of the fragment with these boundaries, moved with the material. Their sources are to be `first` and those
/// after it of their object.
///
/// `grids`: those of the body now and at rest.
///
/// None where edges cross at rest, which those of [`fissure_scene::Fragments`] do by rounding to the grid only.
pub(crate) fn rest_cap(
    boundaries: &[Vec<SourceEdge>],
    first: usize,
    division: RestDivision,
    grids: [Grid; 2],
    interior: &Interior<'_>,
    piece: u32,
) -> Option<RestCap> {
    let [grid, rest_grid] = grids;
    let (corners, places) = corners(boundaries, rest_grid);
    let old = places.len();
    let triangles = triangles(&corners, places, division, rest_grid.step)?;
    let chains = Chains::new(&triangles, old);
    let (mut corners_now, mut shape) = (Vec::with_capacity(corners.len()), Shape::with_capacity(corners.len()));
    let mut outer = Vec::new();
    let mut source = 0;
    for (edges, corners) in boundaries.iter().zip(&corners) {
        let (mut ring, mut contour) = (Vec::with_capacity(edges.len()), Vec::with_capacity(edges.len()));
        for (i, edge) in edges.iter().enumerate() {
            let whole = Edge { a: edge.a, b: edge.b, source: SourceIndex(source) };
            source += 1;
            let [from, to] = [corners[i], corners[(i + 1) % corners.len()]];
            let [start, end] = [0, 1].map(|k| edge.carried[k].rest);
            ring.push(from);
            outer.push(start);
            let mut place = edge.a;
            for &corner in chains.between(from, to)? {
                let rest = rest_place(&triangles, corner, rest_grid);
                let part = (rest - start).norm() / (end - start).norm();
                let [a, b] = [edge.a, edge.b].map(|p| Point2::new(p.x as f64, p.y as f64));
                let next = inwards(&whole, Point2::new(a.x + part * (b.x - a.x), a.y + part * (b.y - a.y)));
                contour.push(Edge { a: place, b: next, ..whole });
                ring.push(corner);
                outer.push(rest);
                place = next;
            }
            contour.push(Edge { a: place, ..whole });
        }
        corners_now.push(ring);
        shape.push(contour);
    }
    let sides = Sides::new(&triangles, &corners_now)?;
    let mut places = outer.clone();
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
                        let rest = rest_place(&triangles, vertex.index(), rest_grid);
                        places.push(rest);
                        let new = places.len() as u32 - 1;
                        number.insert(vertex.index(), new);
                        new
                    }
                },
            };
        }
        found.push(triangle);
    }
    let edges: Vec<&SourceEdge> = boundaries.iter().flatten().collect();
    let told: Vec<[Carried; 2]> =
        shape.iter().flatten().map(|edge| [edge.a, edge.b].map(|p| edges[edge.source.0 as usize].at(p))).collect();
    let shown: Vec<GridPoint> = shape.iter().flatten().map(|edge| edge.a).collect();
    let speeds: Vec<Vector> = told.iter().map(|[start, _]| start.velocity).collect();
    let carrying = Carrying { interior, grid, piece, places: &places, triangles: &found };
    let CarriedCorners { now, velocities } = carrying.corners(&shown, &speeds, division.unfolds);
    let count = outer.len();
    // Each edge tells of itself where it is: new corners and those that follow particles are not where the whole is.
    let (mut sources, mut begin) = (Vec::with_capacity(count), 0);
    for contour in &mut shape {
        let length = contour.len();
        for (i, edge) in contour.iter_mut().enumerate() {
            let ends = [begin + i, begin + (i + 1) % length];
            let slot = edges[edge.source.0 as usize].slot;
            let mut carried = told[ends[0]];
            for (carried, end) in carried.iter_mut().zip(ends) {
                (carried.rest, carried.velocity) = (outer[end], velocities[end]);
            }
            *edge = Edge { a: now[ends[0]], b: now[ends[1]], source: SourceIndex((first + ends[0]) as u32) };
            sources.push(SourceEdge { a: edge.a, b: edge.b, carried, slot });
        }
        begin += length;
    }
    let carried = (count..places.len()).map(|k| Carried::within(places[k], velocities[k])).collect();
    let cap = Cap { shape, within: now[count..].to_vec(), triangles: found };
    Some(RestCap { cap, carried, sources })
}

/// The number of the place of each corner, and the places at rest, in grid steps; those that the grid does not tell
/// apart are one.
fn corners(boundaries: &[Vec<SourceEdge>], grid: Grid) -> (Vec<Vec<usize>>, Vec<Point2<f64>>) {
    let mut places = Vec::new();
    let mut number = BTreeMap::new();
    let mut corner = |edge: &SourceEdge| {
        let place = grid.snap(edge.carried[0].rest);
        *number.entry((place.x, place.y)).or_insert_with(|| {
            // Not on the grid: lines that hardly part would cross.
            places.push(Point2::new(edge.carried[0].rest.x / grid.step, edge.carried[0].rest.y / grid.step));
            places.len() - 1
        })
    };
    let corners = boundaries.iter().map(|boundary| boundary.iter().map(&mut corner).collect()).collect();
    (corners, places)
}

fn rest_place(triangles: &Delaunay, vertex: usize, grid: Grid) -> Point {
    let Point2 { x, y } = triangles.vertex(FixedVertexHandle::from_index(vertex)).position();
    Point::new(x, y) * grid.step
}

/// The places with the boundary among the edges; none if edges cross or have no length. `step`: of the grid [m].
///
/// Between lines that are hardly apart edges would be divided again and again: then they stay whole.
fn triangles(corners: &[Vec<usize>], places: Vec<Point2<f64>>, division: RestDivision, step: f64) -> Option<Delaunay> {
    let refined = refined(corners, places.clone(), division, step)?;
    let count = places.len() + FRAME;
    let is_short = |edge: spade::handles::UndirectedEdgeHandle<'_, _, _, _, _>| {
        let is_new = edge.vertices().iter().any(|vertex| vertex.index() >= count);
        is_new && edge.is_constraint_edge() && edge.length_2() < SHORTEST_PART * SHORTEST_PART
    };
    if division.keeps_edges || !refined.undirected_edges().any(is_short) {
        return Some(refined);
    }
    self::refined(corners, places, RestDivision { keeps_edges: true, ..division }, step)
}

/// The same, with parts of edges however short.
fn refined(corners: &[Vec<usize>], places: Vec<Point2<f64>>, division: RestDivision, step: f64) -> Option<Delaunay> {
    let pairs = corners.iter().flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
    let edges: BTreeSet<[usize; 2]> = pairs.map(|(&a, &b)| [a.min(b), a.max(b)]).collect();
    if edges.iter().any(|[a, b]| a == b) {
        return None;
    }
    // What lies outside is divided too: `spade` does not know it from what lies beyond a crack. With a frame around it
    // has no needles between the boundary and its convex hull.
    let count = places.len() + FRAME;
    let (low, high) = bounds(&places);
    let margin = MARGIN * (high.x - low.x).max(high.y - low.y);
    let [left, right] = [low.x - margin, high.x + margin];
    let [bottom, top] = [low.y - margin, high.y + margin];
    let mut places = places;
    places.extend([(left, bottom), (right, bottom), (right, top), (left, top)].map(|(x, y)| Point2::new(x, y)));
    let mut crosses = false;
    let mut triangles = Delaunay::try_bulk_load_cdt(places, edges.into_iter().collect(), |_| crosses = true).ok()?;
    if crosses || triangles.num_vertices() != count {
        return None;
    }
    let area = |side: f64| 0.25 * 3.0_f64.sqrt() * (side / step).powi(2);
    let mut parameters = RefinementParameters::<f64>::new().with_angle_limit(AngleLimit::from_deg(SMALLEST_ANGLE));
    if division.least > 0.0 {
        parameters = parameters.with_min_required_area(area(division.least));
    }
    if division.keeps_edges {
        parameters = parameters.keep_constraint_edges();
    }
    if let Some(size) = division.size {
        let hull: f64 = triangles.inner_faces().map(|face| face.area()).sum();
        parameters = parameters
            .with_max_allowed_area(area(size))
            .with_max_additional_vertices(20 * count + (4.0 * hull / area(size)) as usize);
    }
    triangles.refine(parameters);
    Some(triangles)
}

/// The box around some places.
fn bounds(places: &[Point2<f64>]) -> (Point2<f64>, Point2<f64>) {
    let all = |start: f64, best: fn(f64, f64) -> f64| {
        let (x, y) = places.iter().fold((start, start), |(x, y), place| (best(x, place.x), best(y, place.y)));
        Point2::new(x, y)
    };
    (all(f64::INFINITY, f64::min), all(f64::NEG_INFINITY, f64::max))
}

/// The new corners in the edges of the boundary.
struct Chains {
    /// Those between two corners, from the first to the second.
    between: BTreeMap<[usize; 2], Vec<usize>>,
}

impl Chains {
    /// Those of triangles whose first `old` corners were there before.
    fn new(triangles: &Delaunay, old: usize) -> Self {
        let ends = |vertex: usize| {
            let vertex = triangles.vertex(FixedVertexHandle::from_index(vertex));
            vertex.out_edges().filter(|edge| edge.is_constraint_edge()).map(|edge| edge.to().index())
        };
        let mut between = BTreeMap::new();
        for start in 0..old {
            for mut at in ends(start) {
                let (mut before, mut chain) = (start, Vec::new());
                // A new corner lies on one line.
                while at >= old
                    && let Some(next) = ends(at).find(|&next| next != before)
                {
                    chain.push(at);
                    (before, at) = (at, next);
                }
                between.insert([start, at], chain);
            }
        }
        Self { between }
    }

    fn between(&self, from: usize, to: usize) -> Option<&[usize]> {
        self.between.get(&[from, to]).map(Vec::as_slice)
    }
}

/// Which corner of the boundary each triangle has at each of its places.
struct Sides {
    /// The triangles within, each with the numbers of its corners that lie on the boundary.
    faces: Vec<(spade::handles::FixedFaceHandle<spade::handles::InnerTag>, [Option<u32>; 3])>,
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
        Some(Self { faces: sides.into_values().collect() })
    }
}
