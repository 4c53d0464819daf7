//! Pieces: connected polygons with the identity that the simulation gives them.

use crate::boolean::{Contour, Edge, Shape, twice_area};
use crate::snap::Grid;
use fissure_scene::{ParticleFrame, Point};
use std::collections::BTreeMap;

/// Thinnest polygon or hole that is more than rounding, in grid steps of mean width.
const THINNEST: f64 = 2.0;

/// A connected polygon of one body.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Polygon {
    /// Outer contour and holes.
    pub(crate) shape: Shape,
    /// Area [m²].
    pub(crate) area: f64,
    /// Fragment of the simulation that it shows.
    pub(crate) piece: u32,
}

/// Fills holes and drops polygons that are no more than rounding: of a mean width below two grid steps.
///
/// Faces that touch leave a chain of such slivers; their walls would be hidden faces in a closed crack.
pub(crate) fn without_slivers(shapes: Vec<Shape>) -> Vec<Shape> {
    let mut kept = shapes;
    for shape in &mut kept {
        let mut first = true;
        shape.retain(|contour| std::mem::take(&mut first) || !is_sliver(contour));
    }
    kept.retain(|shape| shape.first().is_some_and(|outer| !is_sliver(outer)));
    kept
}

fn is_sliver(contour: &[Edge]) -> bool {
    let length: f64 = contour.iter().map(|e| ((e.b.x - e.a.x) as f64).hypot((e.b.y - e.a.y) as f64)).sum();
    // A strip of width w and length l has area w l and circumference 2 l.
    twice_area(contour).unsigned_abs() as f64 <= THINNEST * length
}

/// Gives each polygon of the body the fragment that most of the particles inside it belong to (of equally many the
/// lowest number); a polygon without particles gets that of the nearest. Polygons smaller than `smallest` [m²] are left
/// out.
pub(crate) fn pieces(
    shapes: Vec<Shape>,
    grid: Grid,
    particles: &ParticleFrame,
    body: u32,
    smallest: f64,
) -> Vec<Polygon> {
    let of_body: Vec<(Point, u32)> = (0..particles.len())
        .filter(|&p| particles.body[p] == body)
        .map(|p| (particles.position[p], particles.piece[p]))
        .collect();
    let area = |shape: &Shape| 0.5 * shape.iter().map(|c| twice_area(c)).sum::<i128>() as f64 * grid.step * grid.step;
    let large = shapes.into_iter().map(|shape| (area(&shape), shape)).filter(|(area, _)| *area >= smallest);
    large.map(|(area, shape)| Polygon { piece: piece_of(&shape, grid, &of_body), shape, area }).collect()
}

fn piece_of(shape: &Shape, grid: Grid, particles: &[(Point, u32)]) -> u32 {
    let rows = Rows::new(shape, grid);
    let mut votes = BTreeMap::<u32, usize>::new();
    for &(_, piece) in particles.iter().filter(|(position, _)| rows.contains(*position)) {
        *votes.entry(piece).or_default() += 1;
    }
    let winner = votes.into_iter().max_by_key(|&(piece, count)| (count, std::cmp::Reverse(piece)));
    if let Some((piece, _)) = winner {
        return piece;
    }
    let center = mean_corner(&shape[0], grid);
    let distance = |position: &Point| (position - center).norm_squared();
    particles.iter().min_by(|(p, _), (q, _)| distance(p).total_cmp(&distance(q))).map_or(0, |&(_, piece)| piece)
}

/// The mean of the corners of a contour.
fn mean_corner(contour: &Contour, grid: Grid) -> Point {
    let sum = contour.iter().fold(Point::origin().coords, |sum, e| sum + grid.place(e.a).coords);
    Point::from(sum / contour.len() as f64)
}

/// The edges of a polygon sorted into horizontal rows, so that a point is tested against those of its own row only.
struct Rows {
    low: Point,
    high: Point,
    height: f64,
    rows: Vec<Vec<(Point, Point)>>,
}

impl Rows {
    fn new(shape: &Shape, grid: Grid) -> Self {
        let edges: Vec<_> = shape.iter().flatten().map(|e| (grid.place(e.a), grid.place(e.b))).collect();
        let corners: Vec<Point> = edges.iter().map(|e| e.0).collect();
        let (low, high) = fissure_plane::bounds(&corners);
        let count = edges.len().clamp(1, 1024);
        let height = (high.y - low.y) / count as f64;
        let mut rows = Self { low, high, height, rows: vec![Vec::new(); count] };
        for (a, b) in edges {
            for row in rows.row(a.y.min(b.y))..=rows.row(a.y.max(b.y)) {
                rows.rows[row].push((a, b));
            }
        }
        rows
    }

    fn row(&self, y: f64) -> usize {
        (((y - self.low.y) / self.height) as usize).min(self.rows.len() - 1)
    }

    /// Whether `point` lies inside (even-odd, half-open).
    fn contains(&self, point: Point) -> bool {
        let in_box = point.x >= self.low.x && point.x <= self.high.x && point.y >= self.low.y && point.y <= self.high.y;
        in_box
            && self.rows[self.row(point.y)]
                .iter()
                .fold(false, |inside, &(a, b)| inside != fissure_plane::is_left_of(a, b, point))
    }
}
