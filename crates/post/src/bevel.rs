//! Bevelled edges: where the walls of cracks meet the caps, strips take the edge off.
//!
//! ```text
//!               a'┌───── cap
//!     strip     ╱
//!            a │   material
//!       wall   │
//! ```
//! The corners of caps move inwards and the walls end as much below them, so that strips lie at 45 degrees. Seen from
//! above, strips and cap fill the polygon without folds: what was a solid stays one. Where that leaves no room, between
//! cracks or along segments that are short, strips are narrower; at outlines, tips and sharp corners they end.

use crate::boolean::{Edge, Shape};
use crate::extrude::{Extrusion, wall_normal};
use crate::mesh::{Mesh, Vertex};
use crate::slot::Slot;
use crate::snap::GridPoint;
use crate::source::Carried;
use crate::triangulate::{Cap, Division, inwards, triangulate};
use fissure_scene::Vector;
use spade::Point2;

/// How wide bevels are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BevelSize {
    /// Width of strips, seen from above or from the side, in grid steps.
    pub(crate) width: f64,
    /// Strips are not narrower, and edges of caps do not become shorter, in grid steps.
    pub(crate) least: f64,
}

/// Corners at which a contour turns by more than this have no bevel: its corner would lie twice as far in, cosine.
const SHARP: f64 = -0.5;
/// Walls that turn by more than this have folded right back, cosine.
const FOLDED: f64 = -0.95;
/// Triangles of caps keep this part of their area.
const KEPT: f64 = 0.25;
/// A width that leaves no room is narrowed to this part of it.
pub(crate) const NARROWED: f64 = 0.7;
/// So many grid steps would be lost in rounding.
pub(crate) const LOST: f64 = 2.0;

/// What a strip becomes that has no room.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Narrowest {
    /// It goes.
    Nothing,
    /// It stays, hardly wide, and stands upright where that is too much.
    Something,
}

/// A corner of a cap that may have moved inwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BevelCorner {
    /// Where the cap has its corner.
    pub(crate) point: GridPoint,
    /// By how much the material there lies elsewhere at rest [m].
    pub(crate) at_rest: Vector,
    /// How far below the cap the wall ends [m].
    pub(crate) drop: f64,
}

/// A cap, and where its corners on the boundary go, contour after contour.
pub(crate) type BevelledCap = (Cap, Vec<BevelCorner>);

impl Extrusion<'_> {
    /// A cap whose triangles are made anew within its bevels: where they go inwards, triangles of the whole polygon
    /// become narrow. New corners in edges of the inner polygon are new ones of the outer polygon, too. None where
    /// nothing is bevelled.
    pub(crate) fn bevelled(&self, cap: &Cap, division: Division) -> Option<BevelledCap> {
        let corners = self.bevel(cap);
        if corners.iter().all(|corner| corner.drop == 0.0) {
            return None;
        }
        let mut first = 0;
        let mut inner = Shape::with_capacity(cap.shape.len());
        for contour in &cap.shape {
            let at = |i: usize| corners[first + i % contour.len()].point;
            inner.push(contour.iter().enumerate().map(|(i, edge)| Edge { a: at(i), b: at(i + 1), ..*edge }).collect());
            first += contour.len();
        }
        let fine = triangulate(&inner, division);
        let (mut shape, mut all) = (Shape::with_capacity(cap.shape.len()), Vec::new());
        let mut first = 0;
        for ((contour, inner), fine) in cap.shape.iter().zip(&inner).zip(&fine.shape) {
            let (mut edges, mut parts) = (Vec::with_capacity(fine.len()), fine.iter().peekable());
            for (i, (edge, of_inner)) in contour.iter().zip(inner).enumerate() {
                let [p, q] = [i, (i + 1) % contour.len()].map(|k| corners[first + k]);
                let mut place = edge.a;
                all.push(p);
                loop {
                    let part = parts.next()?;
                    if part.b == of_inner.b {
                        break;
                    }
                    let far = distance(of_inner.a, part.b) / distance(of_inner.a, of_inner.b);
                    let next = if p.drop == 0.0 && q.drop == 0.0 { part.b } else { between(edge, far) };
                    edges.push(Edge { a: place, b: next, ..*edge });
                    all.push(BevelCorner {
                        point: part.b,
                        at_rest: p.at_rest + far * (q.at_rest - p.at_rest),
                        drop: p.drop + far * (q.drop - p.drop),
                    });
                    place = next;
                }
                edges.push(Edge { a: place, ..*edge });
            }
            if parts.peek().is_some() {
                return None;
            }
            shape.push(edges);
            first += contour.len();
        }
        Some((Cap { shape, ..fine }, all))
    }

    /// The corners of a cap, contour after contour; as they are where edges are not bevelled.
    pub(crate) fn bevel(&self, cap: &Cap) -> Vec<BevelCorner> {
        let (mut widths, mut ways) = self.widths(cap);
        if let Some(size) = self.bevel {
            narrow(cap, &mut ways, &mut widths, size.least, Narrowest::Nothing);
        }
        self.corners(cap, &widths, &ways)
    }

    /// The corners of a cap with bevels of these `widths` [m], narrower where there is no room, but nowhere nothing:
    /// there are strips where there are some at rest.
    pub(crate) fn bevel_like(&self, cap: &Cap, widths: &[f64]) -> Vec<BevelCorner> {
        let mut steps: Vec<f64> = widths.iter().map(|width| width / self.grid.step).collect();
        let (_, mut ways) = self.widths(cap);
        let least = self.bevel.map_or(0.0, |size| size.least);
        narrow(cap, &mut ways, &mut steps, least, Narrowest::Something);
        self.corners(cap, &steps, &ways)
    }

    /// How wide bevels are to be at the corners of a cap, in grid steps, and where they go for each.
    pub(crate) fn widths(&self, cap: &Cap) -> (Vec<f64>, Vec<Vector>) {
        let count = cap.shape.iter().map(Vec::len).sum();
        let (mut widths, mut ways) = (vec![0.0; count], vec![Vector::zeros(); count]);
        let Some(size) = self.bevel else { return (widths, ways) };
        let mut first = 0;
        for contour in &cap.shape {
            for i in 0..contour.len() {
                let before = &contour[(i + contour.len() - 1) % contour.len()];
                let (is_blunt, way) = self.inwards(before, &contour[i]);
                ways[first + i] = way;
                widths[first + i] = if is_blunt { size.width } else { 0.0 };
            }
            first += contour.len();
        }
        (widths, ways)
    }

    fn corners(&self, cap: &Cap, widths: &[f64], ways: &[Vector]) -> Vec<BevelCorner> {
        let corner = |(edge, (&width, way)): (&Edge, (&f64, &Vector))| {
            let (way, drop) = (width * way, width * self.grid.step);
            BevelCorner { point: moved(edge.a, way), at_rest: self.grid.step * self.at_rest(edge, way), drop }
        };
        cap.shape.iter().flatten().zip(widths.iter().zip(ways)).map(corner).collect()
    }

    /// Whether the corner between two edges has a bevel, and where it goes for one that is one step wide.
    fn inwards(&self, before: &Edge, after: &Edge) -> (bool, Vector) {
        let is_inside = [before, after].iter().all(|edge| self.source(edge).slot == Slot::Inside);
        let normals = [before, after].map(wall_normal);
        let cosine = normals[0].dot(&normals[1]);
        let is_blunt = is_inside && cosine > SHARP;
        (is_blunt, -(normals[0] + normals[1]) / (1.0 + cosine).max(1.0 + SHARP))
    }

    /// A way in the material beside an edge, as it is at rest.
    fn at_rest(&self, edge: &Edge, way: Vector) -> Vector {
        let out = wall_normal(edge);
        let along = Vector::new(-out.y, out.x);
        let Some(rest) = self.source(edge).direction_at_rest() else { return Vector::zeros() };
        way.dot(&along) * rest + way.dot(&out) * Vector::new(rest.y, -rest.x)
    }

    /// Adds the strips along `contour`, whose corners are `corners`. Returns the volume that they take off [m³].
    pub(crate) fn strips(&self, contour: &[Edge], corners: &[BevelCorner], mesh: &mut Mesh) -> f64 {
        let (first, new) = (mesh.vertices.len(), mesh.triangles[Slot::Inside as usize].len());
        let (count, mut removed) = (contour.len(), 0.0);
        let mut previous: Option<(Carried, [Vector; 2], [u32; 4])> = None;
        for (i, edge) in contour.iter().enumerate() {
            let (source, [p, q]) = (self.source(edge), [corners[i], corners[(i + 1) % count]]);
            if source.slot != Slot::Inside || (p.drop == 0.0 && q.drop == 0.0) {
                previous = None;
                continue;
            }
            let (start, end) = (source.at(edge.a), source.at(edge.b));
            let normal = wall_normal(edge);
            let direction = source.direction_at_rest().filter(|_| self.at_rest).unwrap_or(normal);
            let a = match previous {
                // What has folded right back has no normal in common.
                Some((carried, others, vertices))
                    if carried == start
                        && others[0].dot(&direction) >= self.crease_angle.cos()
                        && others[1].dot(&normal) > FOLDED =>
                {
                    vertices
                }
                _ => self.rail(edge.a, &p, &start, mesh),
            };
            let b = self.rail(edge.b, &q, &end, mesh);
            let triangles = &mut mesh.triangles[Slot::Inside as usize];
            let [over_both, over_start] =
                areas(edge, p.point, q.point).map(|twice| 0.5 * twice * self.grid.step.powi(2));
            if q.drop > 0.0 {
                triangles.extend([[a[0], b[0], b[1]], [a[2], b[3], b[2]]]);
                removed += 2.0 * over_both * (p.drop + q.drop) / 3.0;
            }
            if p.drop > 0.0 {
                triangles.extend([[a[0], b[1], a[1]], [a[2], a[3], b[3]]]);
                removed += 2.0 * over_start * p.drop / 3.0;
            }
            previous = Some((end, [direction, normal], b));
        }
        mesh.set_normals(first, Slot::Inside, new);
        removed
    }

    /// Adds the vertices of a strip at a corner: at the end of the wall and at the cap, in front and at the back.
    fn rail(&self, wall: GridPoint, corner: &BevelCorner, carried: &Carried, mesh: &mut Mesh) -> [u32; 4] {
        let half = 0.5 * self.thickness;
        let mut vertex = |point: GridPoint, z: f64, height: f64| {
            let place = self.grid.place(point);
            mesh.vertices.push(Vertex {
                position: [place.x, place.y, z],
                normal: [0.0; 3],
                texture: [carried.arc / self.texture_size, height / self.texture_size],
                velocity: [carried.velocity.x, carried.velocity.y, 0.0],
                history: carried.history,
            });
            mesh.vertices.len() as u32 - 1
        };
        // Texture goes on over the slope as it does along the wall.
        let (end, slope) = (half - corner.drop, corner.drop * std::f64::consts::SQRT_2);
        let front = vertex(wall, end, end + half);
        let back = vertex(wall, -end, half - end);
        if corner.drop == 0.0 {
            return [front, front, back, back];
        }
        [front, vertex(corner.point, half, end + half + slope), back, vertex(corner.point, -half, half - end - slope)]
    }
}

fn distance(p: GridPoint, q: GridPoint) -> f64 {
    ((q.x - p.x) as f64).hypot((q.y - p.y) as f64)
}

/// A place on an edge, a `part` of its length from its start.
fn between(edge: &Edge, part: f64) -> GridPoint {
    let way = |from: i64, to: i64| from as f64 + part * (to - from) as f64;
    inwards(edge, Point2::new(way(edge.a.x, edge.b.x), way(edge.a.y, edge.b.y)))
}

fn moved(point: GridPoint, way: Vector) -> GridPoint {
    GridPoint::new(point.x + way.x.round() as i64, point.y + way.y.round() as i64)
}

/// Twice the areas, in squared grid steps, of the two triangles of the strip along an edge whose ends are `p` and `q`
/// at the cap: a b q and a q p.
pub(crate) fn areas(edge: &Edge, p: GridPoint, q: GridPoint) -> [f64; 2] {
    [twice(edge.a, edge.b, q), twice(edge.a, q, p)]
}

fn twice(a: GridPoint, b: GridPoint, c: GridPoint) -> f64 {
    ((b.x - a.x) as f64) * ((c.y - a.y) as f64) - ((b.y - a.y) as f64) * ((c.x - a.x) as f64)
}

/// Makes the `widths` at the corners of a cap, which go `ways` per width, so small that its triangles and those of the
/// strips keep their sense. A width below `least` grid steps becomes the `narrowest`.
fn narrow(cap: &Cap, ways: &mut [Vector], widths: &mut [f64], least: f64, narrowest: Narrowest) {
    let old: Vec<GridPoint> = cap.corners().collect();
    loop {
        let outer = |k: usize| widths.get(k).is_some_and(|width| *width > 0.0);
        let new: Vec<GridPoint> =
            (0..old.len()).map(|k| if outer(k) { moved(old[k], widths[k] * ways[k]) } else { old[k] }).collect();
        let mut is_narrow = vec![false; widths.len()];
        let mut narrow_at = |k: usize| {
            if outer(k) {
                is_narrow[k] = true;
            }
        };
        for triangle in &cap.triangles {
            let corners = triangle.map(|k| k as usize);
            if !corners.into_iter().any(outer) {
                continue;
            }
            let ([a, b, c], [p, q, r]) = (corners.map(|k| old[k]), corners.map(|k| new[k]));
            let is_short = |before: f64, after: f64| after < least.min(before);
            let is_cramped = twice(p, q, r) <= KEPT * twice(a, b, c).max(0.0)
                || is_short(distance(a, b), distance(p, q))
                || is_short(distance(b, c), distance(q, r))
                || is_short(distance(c, a), distance(r, p));
            if is_cramped {
                corners.into_iter().for_each(&mut narrow_at);
            }
        }
        let mut first = 0;
        for contour in &cap.shape {
            for (i, edge) in contour.iter().enumerate() {
                let (p, q) = (first + i, first + (i + 1) % contour.len());
                let [over_both, over_start] = areas(edge, new[p], new[q]);
                if (outer(q) && over_both <= 0.0) || (outer(p) && over_start <= 0.0) {
                    [p, q].into_iter().for_each(&mut narrow_at);
                }
            }
            first += contour.len();
        }
        let mut changes = false;
        for k in (0..widths.len()).filter(|&k| is_narrow[k]) {
            let next = NARROWED * widths[k];
            if narrowest == Narrowest::Nothing {
                (changes, widths[k]) = (true, if next < least.max(LOST) { 0.0 } else { next });
            } else if next >= LOST {
                (changes, widths[k]) = (true, next);
            } else {
                changes |= ways[k] != Vector::zeros();
                ways[k] = Vector::zeros();
            }
        }
        if !changes {
            return;
        }
    }
}
