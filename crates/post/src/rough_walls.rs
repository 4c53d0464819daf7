//! Walls with a relief: a net of triangles between the edges of both caps, which stay as they are.
//!
//! ```text
//!     front ─────┬───────────┬───
//!           ╲  ╱ ╲  ╱     ╲ ╱        corners of the polygon have vertices in all rows, places between
//!           ─┼──┼──┼──┼──┼──┼─       them in those within; where the wall of an outline begins there
//!            │╲ │╲ │╲ │╲ │╲ │        are those of the caps alone.
//!           ─┼──┼──┼──┼──┼──┼─
//!           ╱  ╲ ╱  ╲     ╱ ╲
//!     back  ─────┴───────────┴───
//! ```

use crate::boolean::Edge;
use crate::extrude::{Extrusion, Post};
use crate::mesh::{Mesh, Vertex};
use crate::relief::{OnCrack, Relief};
use crate::slot::Slot;
use crate::source::Carried;
use fissure_scene::{Point, Vector};

/// Least number of rows of quads.
const LEAST_ROWS: usize = 4;
/// Places this near to a corner, in parts of their distance, are left out.
const BESIDE: f64 = 0.01;

/// Vertices above each other, the back ones first.
struct Column {
    /// On the edges of the caps.
    ends: [u32; 2],
    /// In the rows within; none where the wall beside it has none.
    within: Vec<u32>,
}

/// A place along a wall.
#[derive(Clone, Copy)]
struct Place {
    now: Point,
    carried: Carried,
    /// Where on the crack it is, and how the material has turned, as the unit vector at that angle; none where the wall
    /// stays.
    moves: Option<(OnCrack, Vector)>,
}

impl Extrusion<'_> {
    /// The walls on the edges of `contour`, as [`Extrusion::walls`] makes them, those of cracks with `relief`.
    pub(crate) fn rough_walls(&self, contour: &[Edge], closed: bool, relief: &Relief, mesh: &mut Mesh) {
        let count = contour.len();
        let posts = self.posts(contour, closed, &[]);
        let seam = (0..count).find(|&i| posts[i][0] != posts[(i + count - 1) % count][1]).unwrap_or(0);
        let first = mesh.vertices.len();
        let new = mesh.triangles[Slot::Inside as usize].len();
        let mut previous: Option<(Post, Column)> = None;
        for i in (seam..count).chain(0..seam) {
            let [start, end] = posts[i];
            let slot = self.source(&contour[i]).slot;
            let column = |post: &Post, corner: usize, mesh: &mut Mesh| {
                let [back, front] = self.post(post, mesh);
                let mut ends = Column { ends: [back, front], within: Vec::new() };
                if slot == Slot::Inside
                    && let Some(place) = self.corner(contour, closed, corner, relief)
                {
                    ends.within = self.within(&place, &post.carried, relief, mesh);
                }
                ends
            };
            let a = match previous {
                Some((post, column)) if post == start => column,
                _ => column(&start, i, mesh),
            };
            let b = column(&end, (i + 1) % count, mesh);
            if slot == Slot::Inside {
                let between = self.between(contour, closed, i, relief);
                let between: Vec<Vec<u32>> =
                    between.iter().map(|place| self.within(place, &place.carried, relief, mesh)).collect();
                mesh.triangles[slot as usize].extend(net(&a, &between, &b));
                let length = (self.grid.place(contour[i].b) - self.grid.place(contour[i].a)).norm();
                mesh.may_differ(relief.amplitude() * length * self.thickness);
            } else {
                let (a, b) = (a.ends, b.ends);
                mesh.triangles[slot as usize].extend([[a[0], b[0], b[1]], [a[0], b[1], a[1]]]);
            }
            previous = Some((end, b));
        }
        mesh.set_normals(first, Slot::Inside, new);
    }

    /// Corner `i` of a contour, as its material at the edge that begins there; none at the end of the wall.
    fn corner(&self, contour: &[Edge], closed: bool, i: usize, relief: &Relief) -> Option<Place> {
        let count = contour.len();
        if i == 0 && !closed {
            return None;
        }
        let (before, after) = (&contour[(i + count - 1) % count], &contour[i]);
        let (source, next) = (self.source(before), self.source(after));
        if source.slot != next.slot {
            return None;
        }
        let longer = if length(before) > length(after) { before } else { after };
        let carried = next.at(after.a);
        let moves = relief.place(carried.rest).map(|place| (place, self.turn(longer)));
        Some(Place { now: self.grid.place(after.a), carried, moves })
    }

    /// How the material at an edge has turned, as the unit vector at that angle.
    fn turn(&self, edge: &Edge) -> Vector {
        let along = Vector::new((edge.b.x - edge.a.x) as f64, (edge.b.y - edge.a.y) as f64).normalize();
        let rest = self.source(edge).direction_at_rest();
        rest.map_or_else(Vector::x, |rest| Vector::new(along.dot(&rest), rest.perp(&along)))
    }

    /// The places on edge `i` where the length along the crack is a multiple of a step, the same on both of its faces.
    fn between(&self, contour: &[Edge], closed: bool, i: usize, relief: &Relief) -> Vec<Place> {
        let (edge, source) = (&contour[i], self.source(&contour[i]));
        let [from, to] = [source.at(edge.a), source.at(edge.b)];
        let middle = nalgebra::center(&from.rest, &to.rest);
        let Some((crack, _)) = relief.place(middle) else { return Vec::new() };
        let arcs = [from.rest, to.rest].map(|rest| relief.place_on(crack, rest).map(|(_, arc)| arc));
        let [Some(start), Some(end)] = arcs else { return Vec::new() };
        let turns = [i, (i + 1) % contour.len()].map(|corner| {
            let place = self.corner(contour, closed, corner, relief);
            place.and_then(|place| place.moves).map_or_else(|| self.turn(edge), |(_, turn)| turn)
        });
        let (a, b) = (self.grid.place(edge.a), self.grid.place(edge.b));
        let step = relief.step();
        let first = (start.min(end) / step + BESIDE).ceil() as i64;
        let last = (start.max(end) / step - BESIDE).floor() as i64;
        let place = |k: i64| {
            let part = (k as f64 * step - start) / (end - start);
            let carried = from.between(&to, part);
            let turn = (turns[0] + part * (turns[1] - turns[0])).normalize();
            let moves = Some(((crack, k as f64 * step), turn));
            Place { now: a + part * (b - a), carried, moves }
        };
        let mut places: Vec<Place> = (first..=last).map(place).collect();
        if end < start {
            places.reverse();
        }
        places
    }

    /// Adds the vertices of a column within the wall, which have texture and velocity of `carried`.
    fn within(&self, place: &Place, carried: &Carried, relief: &Relief, mesh: &mut Mesh) -> Vec<u32> {
        let rows = LEAST_ROWS.max((self.thickness / relief.step()).ceil() as usize);
        let first = mesh.vertices.len() as u32;
        let moves = place.moves.map(|(on_crack, turn)| (relief.profile(on_crack, place.carried.rest), turn));
        for row in 1..rows {
            let z = self.thickness * (row as f64 / rows as f64 - 0.5);
            let moved = moves.as_ref().map_or(Vector::zeros(), |(profile, turn)| {
                let shift = profile.shift(z);
                Vector::new(turn.x * shift.x - turn.y * shift.y, turn.y * shift.x + turn.x * shift.y)
            });
            let now = place.now + moved;
            mesh.vertices.push(Vertex {
                position: [now.x, now.y, z],
                normal: [0.0; 3],
                texture: [carried.arc / self.texture_size, (z + 0.5 * self.thickness) / self.texture_size],
                velocity: [carried.velocity.x, carried.velocity.y, 0.0],
                history: carried.history,
            });
        }
        (first..mesh.vertices.len() as u32).collect()
    }
}

fn length(edge: &Edge) -> f64 {
    ((edge.b.x - edge.a.x) as f64).hypot((edge.b.y - edge.a.y) as f64)
}

/// The triangles between two columns and those `between` them, seen from outside from left to right.
fn net(left: &Column, between: &[Vec<u32>], right: &Column) -> Vec<[u32; 3]> {
    let ([a, d], [b, c]) = (left.ends, right.ends);
    let all = std::iter::once(&left.within).chain(between).chain([&right.within]);
    let columns: Vec<&Vec<u32>> = all.filter(|column| !column.is_empty()).collect();
    let (Some(first), Some(last)) = (columns.first(), columns.last()) else {
        return vec![[a, b, c], [a, c, d]];
    };
    let mut triangles = Vec::new();
    for pair in columns.windows(2) {
        for row in 1..pair[0].len() {
            let [p, q, r, s] = [pair[0][row - 1], pair[1][row - 1], pair[1][row], pair[0][row]];
            triangles.extend([[p, q, r], [p, r, s]]);
        }
    }
    let turned = |[p, q, r]: [u32; 3]| [p, r, q];
    triangles.extend(fan([a, b], columns.iter().map(|column| column[0]).collect()));
    triangles.extend(fan([d, c], columns.iter().map(|column| column[column.len() - 1]).collect()).map(turned));
    if left.within.is_empty() {
        triangles.extend(fan([a, d], first.to_vec()).map(turned));
    }
    if right.within.is_empty() {
        triangles.extend(fan([b, c], last.to_vec()));
    }
    triangles
}

/// The triangles between an edge and a chain to its left that goes from beside its start to beside its end.
fn fan([a, b]: [u32; 2], chain: Vec<u32>) -> impl Iterator<Item = [u32; 3]> {
    let middle = chain.len() / 2;
    let side = move |(i, pair): (usize, [u32; 2])| [if i < middle { a } else { b }, pair[1], pair[0]];
    let across = [a, b, chain[middle]];
    let pairs: Vec<[u32; 2]> = chain.windows(2).map(|pair| [pair[0], pair[1]]).collect();
    std::iter::once(across).chain(pairs.into_iter().enumerate().map(side))
}
