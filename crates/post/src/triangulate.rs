//! Triangles of a polygon on the grid.
//!
//! Constrained Delaunay triangles of the crate `spade`, refined after Ruppert (J. Algorithms 18, 1995, 548–585): new
//! corners in the middle of long edges and at centres of circumcircles, until no angle is small. New corners go to the
//! grid, those in edges inwards, so that the polygon cannot touch itself even at a crack that is one grid step wide.

use crate::boolean::{Edge, Shape, twice_area};
use crate::snap::GridPoint;
use spade::handles::{DirectedEdgeHandle, FixedVertexHandle};
use spade::{AngleLimit, CdtEdge, ConstrainedDelaunayTriangulation, Point2, RefinementParameters, Triangulation as _};

/// Smallest angle of refined triangles [degrees], a little above what is promised because corners are rounded. The
/// refinement ends for sure below 20.7 degrees.
const SMALLEST_ANGLE: f64 = 20.1;
/// At most so many new corners for each corner there is.
const MOST_NEW: usize = 20;

/// How a polygon is divided.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Division {
    /// As few triangles as there can be.
    Plain,
    /// No angle below 20 degrees where the outline has none.
    Fine {
        /// Length of the edges within, at most, in grid steps; none: as long as may be.
        size: Option<f64>,
    },
}

/// A polygon in triangles.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Cap {
    /// The polygon, with new corners in its edges.
    pub(crate) shape: Shape,
    /// New corners within it.
    pub(crate) within: Vec<GridPoint>,
    /// Counter-clockwise, as indices into the corners of `shape`, contour after contour, and then `within`.
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// Triangles of `shape`, which must be valid and without pinch points, as [`crate::boolean`] and [`crate::pinch`] make
/// it.
pub(crate) fn triangulate(shape: &Shape, division: Division) -> Cap {
    let refined = |keeps_edges| {
        let Division::Fine { size } = division else { return None };
        let mut triangles = delaunay(shape);
        refine(&mut triangles, shape, size, keeps_edges);
        Some(cap(&triangles, shape)).filter(Cap::is_unfolded)
    };
    // Rounding folds triangles only where the polygon itself is a few grid steps wide.
    refined(false).or_else(|| refined(true)).unwrap_or_else(|| cap(&delaunay(shape), shape))
}

type Delaunay = ConstrainedDelaunayTriangulation<Point2<f64>>;
type Directed<'a> = DirectedEdgeHandle<'a, Point2<f64>, (), CdtEdge<()>, ()>;

/// The triangles of the convex hull of `shape`, its edges among theirs, its corners first and in order.
fn delaunay(shape: &Shape) -> Delaunay {
    let corners = shape.iter().flatten().map(|edge| Point2::new(edge.a.x as f64, edge.a.y as f64)).collect();
    let mut edges = Vec::new();
    let mut first = 0;
    for contour in shape {
        let count = contour.len();
        edges.extend((0..count).map(|i| [first + i, first + (i + 1) % count]));
        first += count;
    }
    // Grid coordinates are finite and far within what `spade` takes, and edges of a valid polygon do not cross.
    Delaunay::try_bulk_load_cdt(corners, edges, |_| ()).unwrap_or_default()
}

fn refine(triangles: &mut Delaunay, shape: &Shape, size: Option<f64>, keeps_edges: bool) {
    let area = |size: f64| 0.25 * 3.0_f64.sqrt() * size * size;
    let mut most_new = MOST_NEW * triangles.num_vertices();
    let mut parameters = RefinementParameters::<f64>::new()
        .exclude_outer_faces(true)
        .with_angle_limit(AngleLimit::from_deg(SMALLEST_ANGLE));
    if let Some(size) = size {
        parameters = parameters.with_max_allowed_area(area(size));
        let whole = 0.5 * shape.iter().map(|c| twice_area(c)).sum::<i128>() as f64;
        // Twice as many as there would be of triangles of half the area.
        most_new += (4.0 * whole / area(size)) as usize;
    }
    if keeps_edges {
        parameters = parameters.keep_constraint_edges();
    }
    triangles.refine(parameters.with_max_additional_vertices(most_new));
}

/// The triangles within `shape`.
fn cap(triangles: &Delaunay, shape: &Shape) -> Cap {
    let is_within = faces_within(triangles);
    let following = following(triangles, &is_within);
    let old = shape.iter().map(Vec::len).sum::<usize>();
    let mut number = vec![None; following.len()];
    let (mut refined, mut count, mut first) = (Shape::with_capacity(shape.len()), 0_u32, 0);
    for contour in shape {
        let mut edges: Vec<Edge> = Vec::with_capacity(contour.len());
        for (i, edge) in contour.iter().enumerate() {
            let (mut from, end) = (first + i, first + (i + 1) % contour.len());
            let mut place = edge.a;
            // From one corner of the old polygon to the next.
            while from != end {
                number[from] = Some(count);
                count += 1;
                let to = following[from].filter(|&to| to >= old).unwrap_or(end);
                let next = if to == end { edge.b } else { inwards(edge, position(triangles, to)) };
                edges.push(Edge { a: place, b: next, source: edge.source });
                (from, place) = (to, next);
            }
        }
        refined.push(edges);
        first += contour.len();
    }
    let mut within = Vec::new();
    let mut numbered = |vertex: FixedVertexHandle| {
        *number[vertex.index()].get_or_insert_with(|| {
            let Point2 { x, y } = position(triangles, vertex.index());
            within.push(GridPoint::new(x.round() as i64, y.round() as i64));
            count + within.len() as u32 - 1
        })
    };
    let faces = triangles.inner_faces().filter(|face| is_within[face.index()]);
    let triangles = faces.map(|face| face.vertices().map(|vertex| numbered(vertex.fix()))).collect();
    Cap { shape: refined, within, triangles }
}

impl Cap {
    /// All corners, by their numbers.
    pub(crate) fn corners(&self) -> impl Iterator<Item = GridPoint> {
        self.shape.iter().flatten().map(|edge| edge.a).chain(self.within.iter().copied())
    }

    /// Whether all triangles turn counter-clockwise.
    fn is_unfolded(&self) -> bool {
        let corners: Vec<GridPoint> = self.corners().collect();
        self.triangles.iter().all(|triangle| {
            let [a, b, c] = triangle.map(|corner| corners[corner as usize]);
            (b.x - a.x) * (c.y - a.y) > (b.y - a.y) * (c.x - a.x)
        })
    }
}

fn position(triangles: &Delaunay, vertex: usize) -> Point2<f64> {
    triangles.vertex(FixedVertexHandle::from_index(vertex)).position()
}

/// The grid point next to `place` on `edge` that lies on it or to its left, where the material is.
pub(crate) fn inwards(edge: &Edge, place: Point2<f64>) -> GridPoint {
    let (along, up) = (edge.b.x - edge.a.x, edge.b.y - edge.a.y);
    let (x, y) = (place.x.floor() as i64, place.y.floor() as i64);
    let around = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| GridPoint::new(x + i, y + j));
    let is_left = |p: &GridPoint| along * (p.y - edge.a.y) >= up * (p.x - edge.a.x);
    let distance = |p: &GridPoint| (p.x as f64 - place.x).hypot(p.y as f64 - place.y);
    let nearest = around.into_iter().filter(is_left).min_by(|p, q| distance(p).total_cmp(&distance(q)));
    nearest.unwrap_or_else(|| GridPoint::new(place.x.round() as i64, place.y.round() as i64))
}

/// The corner of the refined polygon that comes after each one; none for those that are not its corners.
fn following(triangles: &Delaunay, is_within: &[bool]) -> Vec<Option<usize>> {
    let within = |edge: Directed<'_>| edge.face().as_inner().is_some_and(|face| is_within[face.index()]);
    let mut following = vec![None; triangles.num_vertices()];
    for edge in triangles.directed_edges() {
        if edge.is_constraint_edge() && within(edge) && !within(edge.rev()) {
            following[edge.from().index()] = Some(edge.to().index());
        }
    }
    following
}

/// For each triangle whether it is within the polygon: whether an odd number of its edges lie between it and the
/// outside.
fn faces_within(triangles: &Delaunay) -> Vec<bool> {
    // One more than there are triangles: the outer face has a number too.
    let mut seen = vec![false; triangles.num_all_faces()];
    let mut is_within = vec![false; triangles.num_all_faces()];
    let mut open: Vec<_> = triangles.convex_hull().map(|edge| (edge.rev(), false)).collect();
    while let Some((edge, before)) = open.pop() {
        let Some(face) = edge.face().as_inner() else { continue };
        if std::mem::replace(&mut seen[face.index()], true) {
            continue;
        }
        let here = before ^ edge.is_constraint_edge();
        is_within[face.index()] = here;
        open.extend([edge.next().rev(), edge.prev().rev()].map(|next| (next, here)));
    }
    is_within
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boolean::{SourceIndex, material};
    use crate::slot::Slot;
    use crate::source::{Carried, SourceEdge};
    use fissure_scene::{Point, Vector};
    use proptest::prelude::*;
    use std::collections::BTreeSet;
    use std::f64::consts::TAU;

    /// A star around the origin with one corner per radius.
    fn star(radii: &[f64], scale: f64) -> Vec<GridPoint> {
        let corner = |(i, radius): (usize, &f64)| {
            let (sin, cos) = (TAU * i as f64 / radii.len() as f64).sin_cos();
            GridPoint::new((scale * radius * cos) as i64, (scale * radius * sin) as i64)
        };
        radii.iter().enumerate().map(corner).collect()
    }

    fn shapes(rings: &[Vec<GridPoint>]) -> Vec<Shape> {
        let carried = [Carried::within(Point::origin(), Vector::zeros()); 2];
        let edges = rings.iter().flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
        let source = |(&a, &b)| SourceEdge { a, b, carried, slot: Slot::Outside };
        material(&edges.map(source).collect::<Vec<_>>())
    }

    fn twice(a: GridPoint, b: GridPoint, c: GridPoint) -> i128 {
        i128::from(b.x - a.x) * i128::from(c.y - a.y) - i128::from(b.y - a.y) * i128::from(c.x - a.x)
    }

    /// Angles of a triangle or corner [degrees].
    fn angle(before: GridPoint, at: GridPoint, after: GridPoint) -> f64 {
        let heading = |p: GridPoint| ((p.y - at.y) as f64).atan2((p.x - at.x) as f64);
        (heading(before) - heading(after)).rem_euclid(TAU).to_degrees()
    }

    /// Whether a point lies on an edge, but for rounding.
    fn is_on(point: GridPoint, a: GridPoint, b: GridPoint) -> bool {
        let way = |p: GridPoint, q: GridPoint| ((q.x - p.x) as f64, (q.y - p.y) as f64);
        let (along, to) = (way(a, b), way(a, point));
        let square = along.0 * along.0 + along.1 * along.1;
        let part = (to.0 * along.0 + to.1 * along.1) / square;
        let off = (to.0 * along.1 - to.1 * along.0).abs() / square.sqrt();
        (-1e-6..1.0 + 1e-6).contains(&part) && off < 3.0
    }

    proptest! {
        /// Truth: the triangles fill the polygon without folds, meet edge to edge, have no angle below 20 degrees but
        /// at and across its sharp corners, and keep all its corners; it loses no more than rounding.
        #[test]
        fn triangles_are_well_shaped(
            outer in proptest::collection::vec(0.5..1.0_f64, 5..30),
            hole in proptest::collection::vec(0.1..0.3_f64, 3..20),
            size in proptest::option::of(0.02..0.3_f64),
        ) {
            let scale = 4e6;
            let mut inner = star(&hole, scale);
            inner.reverse();
            for shape in shapes(&[star(&outer, scale), inner]) {
                let size = size.map(|size| size * scale);
                let cap = triangulate(&shape, Division::Fine { size });
                let corners: Vec<GridPoint> = cap.corners().collect();
                let at = |t: [u32; 3]| t.map(|i| corners[i as usize]);
                let area: i128 = cap.shape.iter().map(|c| twice_area(c)).sum();
                let filled: i128 = cap.triangles.iter().map(|&t| at(t)).map(|[a, b, c]| twice(a, b, c)).sum();
                prop_assert_eq!(filled, area);
                let drawn: i128 = shape.iter().map(|c| twice_area(c)).sum();
                prop_assert!(area <= drawn && drawn - area < 100 * scale as i128);
                let mut edges = BTreeSet::new();
                for t in &cap.triangles {
                    for k in 0..3 {
                        prop_assert!(edges.insert((t[k], t[(k + 1) % 3])));
                    }
                }
                let open = edges.iter().filter(|(a, b)| !edges.contains(&(*b, *a))).count();
                prop_assert_eq!(open, cap.shape.iter().map(Vec::len).sum::<usize>());
                let all: BTreeSet<GridPoint> = corners.iter().copied().collect();
                prop_assert!(shape.iter().flatten().all(|edge| all.contains(&edge.a)));
                let mut sharp = Vec::new();
                for contour in &shape {
                    for (edge, next) in contour.iter().zip(contour.iter().cycle().skip(1)) {
                        if angle(edge.a, next.a, next.b) < 60.0 {
                            sharp.push([edge.a, next.a, next.b]);
                        }
                    }
                }
                // What spans a sharp corner cannot be mended: new corners on one side of it call for new ones on the
                // other (Shewchuk, Comput. Geom. 22, 2002, 21-74).
                let spans = |t: [GridPoint; 3], [before, here, after]: [GridPoint; 3]| {
                    t.iter().any(|&p| is_on(p, before, here)) && t.iter().any(|&p| is_on(p, here, after))
                };
                for [a, b, c] in cap.triangles.iter().map(|&t| at(t)) {
                    for [before, here, after] in [[a, b, c], [b, c, a], [c, a, b]] {
                        let small = angle(before, here, after) < 20.0;
                        let is_at_corner = sharp.iter().any(|&corner| spans([a, b, c], corner));
                        prop_assert!(!small || is_at_corner, "{}", angle(before, here, after));
                    }
                    if let Some(size) = size {
                        prop_assert!(twice(a, b, c) as f64 <= 0.867 * size * size);
                    }
                }
            }
        }
    }

    /// Truth: by hand. A slit one grid step wide is kept open by corners that go inwards only.
    #[test]
    fn a_slit_of_one_step_stays_open() {
        let slit = [(0, 0), (9000, 0), (9000, 4000), (2000, 4501), (9000, 4001), (9000, 9000), (0, 9000)];
        let ring = slit.map(|(x, y)| GridPoint::new(x, y)).to_vec();
        let count = ring.len();
        let edge = |i: usize| Edge { a: ring[i], b: ring[(i + 1) % count], source: SourceIndex(0) };
        let shape = vec![(0..count).map(edge).collect::<Vec<_>>()];
        let cap = triangulate(&shape, Division::Fine { size: Some(500.0) });
        let places: BTreeSet<GridPoint> = cap.corners().collect();
        assert!(cap.triangles.len() > 500 && cap.is_unfolded());
        assert_eq!(places.len(), cap.corners().count());
    }
}
