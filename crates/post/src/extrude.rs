//! From a polygon to a solid: two caps and the walls between them.

use crate::bevel::{BevelCorner, BevelSize};
use crate::boolean::Edge;
use crate::history::History;
use crate::mesh::{Mesh, Vertex};
use crate::options::PostOptions;
use crate::relief::Relief;
use crate::slot::Slot;
use crate::snap::{Grid, GridPoint};
use crate::source::{Carried, SourceEdge};
use crate::triangulate::Cap;
use fissure_scene::{Point, Vector};

/// Where a curve that was drawn turns by more than this there is a corner [rad]. Smooth joints of drawn curves are a
/// degree or two off, as drawing programs and fonts round their control points.
const CORNER: f64 = 0.1;
/// Walls of what is cut at rest that were smooth there are smooth, so that their corners stay those of both, unless
/// these have folded right back: the cosine between their normals. Programs find no normal of their own at such a
/// corner and lose what files say (Blender 5.0, beyond 178.4 degrees).
const FOLDED_BACK: f64 = -0.996;

/// How a polygon becomes a solid.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Extrusion<'a> {
    /// The grid of the polygon.
    pub(crate) grid: Grid,
    /// Where its edges come from.
    pub(crate) sources: &'a [SourceEdge],
    /// Thickness, half of it on each side of the drawing plane [m].
    pub(crate) thickness: f64,
    /// Walls that turn by less than this are smooth [rad].
    pub(crate) crease_angle: f64,
    /// Place at rest with texture coordinates (0, 0) [m].
    pub(crate) texture_origin: Point,
    /// Length of one texture unit [m].
    pub(crate) texture_size: f64,
    /// Whether corners of walls are shared as the material at rest tells alone.
    pub(crate) at_rest: bool,
    /// How rough the walls of cracks are; none: smooth.
    pub(crate) relief: Option<&'a Relief>,
    /// How the edges between walls of cracks and caps are bevelled; none: sharp.
    pub(crate) bevel: Option<BevelSize>,
}

impl<'a> Extrusion<'a> {
    /// That of a polygon on a `grid`, with edges of `sources`, in a body or collider within a box [m]: with walls that
    /// are smooth and edges that are sharp.
    pub(crate) fn plain(
        grid: Grid,
        sources: &'a [SourceEdge],
        options: &PostOptions,
        (low, high): (Point, Point),
    ) -> Self {
        Self {
            grid,
            sources,
            thickness: options.thickness,
            crease_angle: options.crease_angle,
            texture_origin: low,
            texture_size: (high - low).amax(),
            at_rest: false,
            relief: None,
            bevel: None,
        }
    }

    /// Adds the caps and walls of a polygon to `mesh`. `bevel`: where its corners on the boundary go;
    /// `within`: what its corners within carry, in their order.
    pub(crate) fn solid(&self, cap: &Cap, bevel: &[BevelCorner], within: &[Carried], mesh: &mut Mesh) {
        // Two caps, and walls that are smooth: what creases need comes on top.
        let corners = cap.shape.iter().map(Vec::len).sum::<usize>();
        mesh.vertices.reserve(2 * (corners + within.len()) + 2 * (corners + cap.shape.len()));
        mesh.triangles[Slot::Outside as usize].reserve(2 * cap.triangles.len());
        self.caps(cap, within, bevel, mesh);
        let (mut first, mut removed) = (0, 0.0);
        for contour in &cap.shape {
            let corners = &bevel[first..first + contour.len()];
            self.walls(contour, true, corners, mesh);
            removed += self.strips(contour, corners, mesh);
            first += contour.len();
        }
        mesh.may_differ(removed);
    }

    /// What the corners of the polygon carry, contour by contour.
    pub(crate) fn outer(&self, cap: &Cap) -> Vec<(GridPoint, Carried)> {
        cap.shape.iter().flatten().map(|edge| (edge.a, self.source(edge).at(edge.a))).collect()
    }

    /// Both caps; texture coordinates from the rest position, so that textures do not swim.
    fn caps(&self, cap: &Cap, within: &[Carried], bevel: &[BevelCorner], mesh: &mut Mesh) {
        let mut corners = self.outer(cap);
        for ((point, carried), bevel) in corners.iter_mut().zip(bevel) {
            *point = bevel.point;
            carried.rest += bevel.at_rest;
        }
        corners.extend(cap.within.iter().copied().zip(within.iter().copied()));
        for side in [1.0, -1.0] {
            let first = mesh.vertices.len() as u32;
            for (point, carried) in &corners {
                let place = self.grid.place(*point);
                let texture = (carried.rest - self.texture_origin) / self.texture_size;
                mesh.vertices.push(Vertex {
                    position: [place.x, place.y, 0.5 * side * self.thickness],
                    normal: [0.0, 0.0, side],
                    texture: [texture.x, texture.y],
                    velocity: [carried.velocity.x, carried.velocity.y, 0.0],
                    history: History::default(),
                });
            }
            let turned = |[a, b, c]: [u32; 3]| if side > 0.0 { [a, b, c] } else { [a, c, b] };
            let triangles = cap.triangles.iter().map(|&t| turned(t).map(|i| first + i));
            mesh.triangles[Slot::Outside as usize].extend(triangles);
        }
    }

    /// The walls on the edges of `contour`, which is a ring if `closed`; texture coordinates by arc length at rest.
    /// `bevel`: its corners, if some may be bevelled.
    pub(crate) fn walls(&self, contour: &[Edge], closed: bool, bevel: &[BevelCorner], mesh: &mut Mesh) {
        if let Some(relief) = self.relief
            && contour.iter().any(|edge| self.source(edge).slot == Slot::Inside)
        {
            return self.rough_walls(contour, closed, relief, mesh);
        }
        let count = contour.len();
        let posts = self.posts(contour, closed, bevel);
        // Beginning at a seam, a smooth wall never has to close on vertices of its beginning.
        let seam = (0..count).find(|&i| posts[i][0] != posts[(i + count - 1) % count][1]).unwrap_or(0);
        let mut previous: Option<(Post, [u32; 2])> = None;
        for i in (seam..count).chain(0..seam) {
            let [start, end] = posts[i];
            let a = match previous {
                Some((post, vertices)) if post == start => vertices,
                _ => self.post(&start, mesh),
            };
            let b = self.post(&end, mesh);
            let slot = self.source(&contour[i]).slot;
            mesh.triangles[slot as usize].extend([[a[0], b[0], b[1]], [a[0], b[1], a[1]]]);
            previous = Some((end, b));
        }
    }

    /// The vertical edges at the start and the end of each edge of `contour`, which is a ring if `closed`.
    pub(crate) fn posts(&self, contour: &[Edge], closed: bool, bevel: &[BevelCorner]) -> Vec<[Post; 2]> {
        let count = contour.len();
        let drop = |corner: usize| bevel.get(corner % count).map_or(0.0, |corner| corner.drop);
        (0..count)
            .map(|i| {
                let (edge, source) = (&contour[i], self.source(&contour[i]));
                let before = (i > 0 || closed).then(|| &contour[(i + count - 1) % count]);
                let after = (i + 1 < count || closed).then(|| &contour[(i + 1) % count]);
                let post = |point, other, corner| {
                    let normal = self.corner_normal(edge, other, point);
                    // Two chords of a curve tell its direction alike but for rounding; the normal knows it.
                    let carried = Carried { tangent: Vector::zeros(), ..source.at(point) };
                    Post { point, carried, normal, drop: drop(corner) }
                };
                [post(edge.a, before, i), post(edge.b, after, i + 1)]
            })
            .collect()
    }

    /// Adds the two vertices of a vertical wall edge, the back one first.
    pub(crate) fn post(&self, post: &Post, mesh: &mut Mesh) -> [u32; 2] {
        let place = self.grid.place(post.point);
        let first = mesh.vertices.len() as u32;
        let end = 0.5 * self.thickness - post.drop;
        for z in [-end, end] {
            mesh.vertices.push(Vertex {
                position: [place.x, place.y, z],
                normal: [post.normal.x, post.normal.y, 0.0],
                texture: [post.carried.arc / self.texture_size, (z + 0.5 * self.thickness) / self.texture_size],
                velocity: [post.carried.velocity.x, post.carried.velocity.y, 0.0],
                history: post.carried.history,
            });
        }
        [first, first + 1]
    }

    /// Normal of the wall on `edge` at its end `point`, where it meets the wall on `other`: that of the curve that was
    /// drawn, turned as the edge has turned; halfway between both walls when the corner is smooth.
    fn corner_normal(&self, edge: &Edge, other: Option<&Edge>, point: GridPoint) -> Vector {
        let turn = |edge: &Edge| self.source(edge).turn(point);
        let own_turn = turn(edge);
        let own = turned(wall_normal(edge), own_turn);
        let Some(other) = other else { return own };
        let (source, other_source, other_turn) = (self.source(edge), self.source(other), turn(other));
        let theirs = turned(wall_normal(other), other_turn);
        // At rest, so that no edge becomes sharp as the material bends, unless it has folded; what has no length there
        // counts as it is now.
        let sides = match [source, other_source].map(SourceEdge::direction_at_rest) {
            [Some(own), Some(theirs)] => [turned(own, own_turn), turned(theirs, other_turn)],
            _ => [own, theirs],
        };
        let is_curve = own_turn.is_some() || other_turn.is_some();
        let crease = if is_curve { self.crease_angle.min(CORNER) } else { self.crease_angle };
        let is_folded = own.dot(&theirs) <= if self.at_rest { FOLDED_BACK } else { 0.0 };
        let smooth = !is_folded && source.slot == other_source.slot && sides[0].dot(&sides[1]) >= crease.cos();
        if !smooth {
            return own;
        }
        (own + theirs).normalize()
    }

    pub(crate) fn source(&self, edge: &Edge) -> &SourceEdge {
        &self.sources[edge.source.0 as usize]
    }
}

/// A vertical wall edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Post {
    point: GridPoint,
    pub(crate) carried: Carried,
    normal: Vector,
    /// How far from the caps it ends [m].
    drop: f64,
}

/// A direction turned counter-clockwise by an angle [rad], if there is one.
fn turned(direction: Vector, angle: Option<f64>) -> Vector {
    angle.map_or(direction, |angle| nalgebra::Rotation2::new(angle) * direction)
}

/// Outward unit normal of the wall on `edge`: to its right.
pub(crate) fn wall_normal(edge: &Edge) -> Vector {
    Vector::new((edge.b.y - edge.a.y) as f64, (edge.a.x - edge.b.x) as f64).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boolean::SourceIndex;
    use crate::common::{options, scene, square};
    use fissure_scene::Point;

    /// Truth: by hand. A corner of what was straight at rest has one normal for both walls while these are 10 degrees
    /// apart or more, and one for each once they have folded right back.
    #[test]
    fn walls_that_have_folded_right_back_have_a_normal_each() {
        let scene = scene(square(20.0));
        let (options, grid) = (options(&scene), Grid::covering(&[Point::new(20.0, 20.0)], 0.0));
        for (apart, is_one) in [(90.0_f64, true), (10.0, true), (1.0, false)] {
            let half = (0.5 * apart.to_radians()).tan();
            let now = [Point::new(0.0, -half), Point::new(1.0, 0.0), Point::new(0.0, half)].map(|p| grid.snap(p));
            let carried = |k: usize| Carried::within(Point::new(1.0, k as f64), Vector::zeros());
            let sources = [0, 1].map(|k| SourceEdge {
                a: now[k],
                b: now[k + 1],
                carried: [carried(k), carried(k + 1)],
                slot: Slot::Inside,
            });
            let contour = [0, 1].map(|k| Edge { a: now[k], b: now[k + 1], source: SourceIndex(k as u32) });
            let plain = Extrusion::plain(grid, &sources, &options, scene.bodies[0].region.bounds());
            let posts = Extrusion { at_rest: true, ..plain }.posts(&contour, false, &[]);
            assert_eq!(posts[0][1] == posts[1][0], is_one, "{apart}");
            assert!(posts.iter().flatten().all(|post| (post.normal.norm() - 1.0).abs() < 1e-12));
        }
    }
}
