//! A fragment cut where it lies at rest: triangles that the material carries along.
//!
//! The triangles depend on rings and cracks at rest alone. As long as no crack grows they are the same from frame to
//! frame, corner by corner. A crack that ends within a fragment is an edge of them with two sides: going around a
//! corner, what lies between two edges of the boundary has a corner of its own.

use crate::boolean::{Edge, Shape, SourceIndex};
use crate::carrying::{CarriedCorners, Carrying};
use crate::interior::Interior;
use crate::parted_corners::part_corners;
use crate::pressed_corners::part_pressed;
use crate::rest_room::{is_crowded, with_room};
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

/// New corners are farther than so many grid steps from others, and than so many shortest edges: with these as long as
/// twice the distance at which readers merge vertices, none is merged where the material is compressed by a third.
const ROOM_STEPS: f64 = 8.0;
const ROOM: f64 = 0.75;

/// How the triangles of a fragment at rest are made.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RestDivision {
    /// Length of edges within, at most [m]; none: as long as may be.
    pub(crate) size: Option<f64>,
    /// Triangles so small that their edges are shorter are not divided [m].
    pub(crate) least: f64,
    /// Corners that lie in one place at rest are shown so far apart [m].
    pub(crate) apart: f64,
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
    let at_rest = |edge: &SourceEdge| edge.carried[0].rest;
    let places: Vec<Vec<Point>> = boundaries.iter().map(|edges| edges.iter().map(at_rest).collect()).collect();
    let Divided { new, within, triangles: found } = divided(&places, division, rest_grid)?;
    let mut shape = Shape::with_capacity(boundaries.len());
    let mut places = Vec::new();
    let mut source = 0;
    for (edges, new) in boundaries.iter().zip(&new) {
        let mut contour = Vec::with_capacity(edges.len());
        for (edge, new) in edges.iter().zip(new) {
            let whole = Edge { a: edge.a, b: edge.b, source: SourceIndex(source) };
            source += 1;
            let [start, end] = [0, 1].map(|k| edge.carried[k].rest);
            places.push(start);
            let mut place = edge.a;
            for &rest in new {
                let next = between(&whole, (rest - start).norm() / (end - start).norm());
                contour.push(Edge { a: place, b: next, ..whole });
                places.push(rest);
                place = next;
            }
            contour.push(Edge { a: place, ..whole });
        }
        shape.push(contour);
    }
    let count = places.len();
    places.extend(within);
    let edges: Vec<&SourceEdge> = boundaries.iter().flatten().collect();
    let told: Vec<[Carried; 2]> =
        shape.iter().flatten().map(|edge| [edge.a, edge.b].map(|p| edges[edge.source.0 as usize].at(p))).collect();
    let mut shown: Vec<GridPoint> = shape.iter().flatten().map(|edge| edge.a).collect();
    let lengths: Vec<usize> = shape.iter().map(Vec::len).collect();
    part_corners(&mut shown, &places[..count], &lengths, division.apart / grid.step, rest_grid);
    part_pressed(&mut shown, &lengths, division.apart / grid.step);
    let speeds: Vec<Vector> = told.iter().map(|[start, _]| start.velocity).collect();
    let carrying = Carrying { interior, grid, piece, places: &places, triangles: &found };
    let CarriedCorners { now, velocities } = carrying.corners(&shown, &speeds, division.unfolds);
    // Each edge tells of itself where it is: new corners and those that follow particles are not where the whole is.
    let (mut sources, mut begin) = (Vec::with_capacity(count), 0);
    for contour in &mut shape {
        let length = contour.len();
        for (i, edge) in contour.iter_mut().enumerate() {
            let ends = [begin + i, begin + (i + 1) % length];
            let slot = edges[edge.source.0 as usize].slot;
            let mut carried = told[ends[0]];
            for (carried, end) in carried.iter_mut().zip(ends) {
                (carried.rest, carried.velocity) = (places[end], velocities[end]);
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

/// What lies between closed lines at rest, in triangles.
pub(crate) struct Divided {
    /// The new corners in each edge of each line [m].
    pub(crate) new: Vec<Vec<Vec<Point>>>,
    /// Those within [m].
    pub(crate) within: Vec<Point>,
    /// Counter-clockwise, as numbers of the corners of the lines, those in edges in their places, then those within.
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// Triangles between closed lines with these corners [m], the material on their left. None where edges cross.
pub(crate) fn divided(lines: &[Vec<Point>], division: RestDivision, grid: Grid) -> Option<Divided> {
    let (corners, places) = corners(lines, grid);
    let old = places.len();
    let triangles = triangles(&corners, places, division, grid.step)?;
    let chains = Chains::new(&triangles, old);
    let (mut all, mut new) = (Vec::with_capacity(corners.len()), Vec::with_capacity(corners.len()));
    for line in &corners {
        let (mut ring, mut of_line) = (Vec::with_capacity(line.len()), Vec::with_capacity(line.len()));
        for (&from, &to) in line.iter().zip(line.iter().cycle().skip(1)) {
            let chain = chains.between(from, to)?;
            ring.push(from);
            ring.extend(chain);
            of_line.push(chain.iter().map(|&corner| rest_place(&triangles, corner, grid)).collect());
        }
        all.push(ring);
        new.push(of_line);
    }
    let sides = Sides::new(&triangles, &all)?;
    let count = all.iter().map(Vec::len).sum::<usize>();
    let (mut within, mut number) = (Vec::new(), BTreeMap::new());
    let mut found = Vec::with_capacity(sides.faces.len());
    for (face, corner) in sides.faces {
        let mut triangle = [0; 3];
        for (k, vertex) in triangles.face(face).vertices().into_iter().enumerate() {
            triangle[k] = corner[k].unwrap_or_else(|| {
                *number.entry(vertex.index()).or_insert_with(|| {
                    within.push(rest_place(&triangles, vertex.index(), grid));
                    (count + within.len() - 1) as u32
                })
            });
        }
        found.push(triangle);
    }
    Some(Divided { new, within, triangles: found })
}

/// A place on an edge, a `part` of its length from its start, to the grid inwards.
pub(crate) fn between(edge: &Edge, part: f64) -> GridPoint {
    let [a, b] = [edge.a, edge.b].map(|p| Point2::new(p.x as f64, p.y as f64));
    inwards(edge, Point2::new(a.x + part * (b.x - a.x), a.y + part * (b.y - a.y)))
}

/// The number of the place of each corner, and the places, in grid steps; those that the grid does not tell apart are
/// one.
fn corners(lines: &[Vec<Point>], grid: Grid) -> (Vec<Vec<usize>>, Vec<Point2<f64>>) {
    let mut places = Vec::new();
    let mut number = BTreeMap::new();
    let mut corner = |rest: &Point| {
        let place = grid.snap(*rest);
        *number.entry((place.x, place.y)).or_insert_with(|| {
            // Not on the grid: lines that hardly part would cross.
            places.push(Point2::new(rest.x / grid.step, rest.y / grid.step));
            places.len() - 1
        })
    };
    let corners = lines.iter().map(|line| line.iter().map(&mut corner).collect()).collect();
    (corners, places)
}

fn rest_place(triangles: &Delaunay, vertex: usize, grid: Grid) -> Point {
    let Point2 { x, y } = triangles.vertex(FixedVertexHandle::from_index(vertex)).position();
    Point::new(x, y) * grid.step
}

/// The places with the boundary among the edges; none if edges cross or have no length. `step`: of the grid [m].
fn triangles(corners: &[Vec<usize>], places: Vec<Point2<f64>>, division: RestDivision, step: f64) -> Option<Delaunay> {
    let pairs = corners.iter().flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
    let edges: BTreeSet<[usize; 2]> = pairs.map(|(&a, &b)| [a.min(b), a.max(b)]).collect();
    if edges.iter().any(|[a, b]| a == b) {
        return None;
    }
    // What lies outside is divided too: `spade` does not know it from what lies beyond a crack. With a frame around it
    // has no needles between the boundary and its convex hull.
    let old = places.len();
    let (low, high) = bounds(&places);
    let margin = MARGIN * (high.x - low.x).max(high.y - low.y);
    let [left, right] = [low.x - margin, high.x + margin];
    let [bottom, top] = [low.y - margin, high.y + margin];
    let mut places = places;
    places.extend([(left, bottom), (right, bottom), (right, top), (left, top)].map(|(x, y)| Point2::new(x, y)));
    let found = refined(places.clone(), edges.iter().copied().collect(), division, step)?;
    let fine = division.size.map_or(f64::INFINITY, |size| 0.25 * size);
    let room = ROOM_STEPS.max((ROOM * division.least).min(fine) / step);
    if division.keeps_edges || !is_crowded(&found, old + FRAME, room) {
        return Some(found);
    }
    let kept = RestDivision { keeps_edges: true, ..division };
    let (spread, numbers) = with_room(&found, old + FRAME, room);
    let chains = Chains::new(&found, old);
    let mut parts = Vec::with_capacity(edges.len());
    for &[a, b] in &edges {
        let between = chains.between(a, b)?.iter().filter_map(|&corner| numbers[corner]);
        let chain: Vec<usize> = std::iter::once(a).chain(between).chain([b]).collect();
        parts.extend(chain.windows(2).map(|pair| [pair[0], pair[1]]));
    }
    refined(spread, parts, kept, step).or_else(|| refined(places, edges.into_iter().collect(), kept, step))
}

/// Places with `edges` between them, divided into triangles without small angles. `step`: of the grid [m].
fn refined(places: Vec<Point2<f64>>, edges: Vec<[usize; 2]>, division: RestDivision, step: f64) -> Option<Delaunay> {
    let count = places.len();
    let mut crosses = false;
    let mut triangles = Delaunay::try_bulk_load_cdt(places, edges, |_| crosses = true).ok()?;
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
