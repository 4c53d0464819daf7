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
use crate::relief::Relief;
use crate::rough_lines::{RoughLine, RoughWalls};
use crate::slot::Slot;
use crate::source::Carried;

/// Vertices above each other, the back ones first.
struct Column {
    /// On the edges of the caps.
    ends: [u32; 2],
    /// In the rows within; none where the wall beside it has none.
    within: Vec<u32>,
}

impl Extrusion<'_> {
    /// The walls on the edges of `contour`, as [`Extrusion::walls`] makes them, those of cracks with `relief`.
    pub(crate) fn rough_walls(&self, contour: &[Edge], closed: bool, relief: &Relief, mesh: &mut Mesh) {
        let count = contour.len();
        let posts = self.posts(contour, closed, &[]);
        let walls = RoughWalls::new(self, contour, closed, relief);
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
                    && let Some(line) = &walls.corners[corner]
                {
                    ends.within = self.within(line, &post.carried, mesh);
                }
                ends
            };
            let a = match previous {
                Some((post, column)) if post == start => column,
                _ => column(&start, i, mesh),
            };
            let b = column(&end, (i + 1) % count, mesh);
            if slot == Slot::Inside {
                let lines = walls.between[i].iter();
                let between: Vec<Vec<u32>> = lines.map(|line| self.within(line, &line.carried, mesh)).collect();
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

    /// Adds the vertices of a column within the wall, which have texture and velocity of `carried`.
    fn within(&self, line: &RoughLine, carried: &Carried, mesh: &mut Mesh) -> Vec<u32> {
        let first = mesh.vertices.len() as u32;
        for &(now, z) in &line.rows {
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
