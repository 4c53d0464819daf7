//! Which vertices of surfaces can come to which edges before the next look.

use super::meeting::WIDEST;
use super::nearing::Nearing;
use super::surface::Surface;
use super::surroundings::Surroundings;
use fissure_plane::{Point, Vector, distance_to_segment, nearest_on_segment};

/// What is farther away than this, in cells, does not touch: round surfaces lie a little before their edges.
const TOUCHES: f64 = 0.2;

/// Surfaces whose normals have a larger product than this do not face each other, as long as none of them turns by more
/// than 60 degrees until the next look, both together.
const MAY_FACE: f64 = 0.5;

/// Parts of one body that are nearer to each other at rest than this, in cells, belong together: the two sides of a
/// thin part, of a corner, and the faces of a crack that have hardly slid, which touch node by node.
pub(crate) const TOGETHER: f64 = 2.5;

/// Pieces that a body has come to match where they are nearer to each other at rest than this, in cells: faces that
/// have hardly slid touch node by node there.
pub(crate) const MATCHED: f64 = 0.5;

/// Neighbours are looked for anew when surfaces may have come nearer to each other by this, in cells.
pub(crate) const MOST_MOVED: f64 = 0.8;

/// The same where a body has come to pieces: what may slide by [`MATCHED`] until then has slid by the rest at a look.
pub(crate) const MOST_MOVED_OF_PIECES: f64 = 0.3;

/// When some vertices have to be looked at, so are those that will soon, by this part of what they may come nearer: a
/// look takes time for all.
const SOON: f64 = 0.5;

/// A gap at rest whose two sides are so many times as long as it is wide can close.
const NARROW: f64 = 4.0;

/// An edge near a vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Neighbour {
    /// The edge.
    pub(crate) edge: u32,
    /// Whether the two can touch; pieces that match, where they no longer do. Others have to be known as well: a vertex
    /// that is nearer to one of them is within its own surroundings, whatever lies behind.
    pub(crate) can_touch: bool,
}

/// A vertex that can touch something.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Comer {
    vertex: u32,
    /// How far it was from the nearest edge that it can touch when that was found, none within one [m].
    distance: f64,
}

/// The vertices with edges near them.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Neighbours {
    /// Vertices that can touch something, rising.
    comers: Vec<Comer>,
    /// First neighbour of each; one more at the end.
    first: Vec<u32>,
    edges: Vec<Neighbour>,
    /// Those of the vertices that may touch something by now, by their place in the list.
    due: Vec<u32>,
    /// All vertices whose places are asked for, rising.
    asked: Vec<u32>,
    nearing: Nearing,
}

/// Surfaces as they are, and how they are looked at.
pub(crate) struct Scenery<'a> {
    pub(crate) surface: &'a Surface,
    /// Where its vertices are [m].
    pub(crate) place: &'a [Point],
    pub(crate) cell_size: f64,
    /// By how much what is found may come nearer before it is looked for anew, in cells.
    pub(crate) most_moved: f64,
    /// Whether crack faces touch.
    pub(crate) cracks_touch: bool,
}

impl Neighbours {
    /// Finds all. [`Neighbours::foresee`] has to follow, here and in [`Neighbours::find_again`].
    pub(crate) fn find(scenery: &Scenery<'_>) -> Self {
        let mut found = Self::default();
        found.nearing.lay_bins(scenery.surface, scenery.place, scenery.reach());
        found.look(scenery, &vec![true; scenery.surface.len()]);
        found
    }

    /// Finds those of the vertices anew to which something else may come before the next look.
    pub(crate) fn find_again(&mut self, scenery: &Scenery<'_>) {
        if self.nearing.are_far_near() {
            self.nearing.lay_bins(scenery.surface, scenery.place, scenery.reach());
        }
        let soon: Vec<bool> = (0..scenery.surface.len() as u32)
            .map(|v| self.nearing.by_next_look(v) >= SOON * scenery.most_moved * scenery.cell_size)
            .collect();
        self.look(scenery, &soon);
    }

    /// Looks at the vertices that are `wanted`; of others what is known stays.
    fn look(&mut self, scenery: &Scenery<'_>, wanted: &[bool]) {
        let Scenery { surface, place, .. } = *scenery;
        let rest = surface.places_at_rest();
        let search = Search::new(scenery, &rest);
        let before = std::mem::take(self);
        *self = Self { first: vec![0], ..Self::default() };
        let mut nearing = before.nearing;
        let slides = [true, false].map(|are_one| search.least_slide(are_one));
        let near_wanted = nearing.bins_near(wanted);
        let mut around = Surroundings::new(&nearing, (surface, place), &near_wanted, search.reach(), slides);
        let mut edge_normals: Vec<Option<Option<Vector>>> = vec![None; surface.len()];
        let mut known = before.comers.iter().zip(before.first.windows(2)).peekable();
        let touches = (scenery.most_moved + TOUCHES) * scenery.cell_size;
        let mut near = Vec::new();
        for vertex in 0..surface.len() as u32 {
            let of_before = known.next_if(|(comer, _)| comer.vertex == vertex);
            if !wanted[vertex as usize] {
                if let Some((comer, range)) = of_before {
                    self.edges.extend(&before.edges[range[0] as usize..range[1] as usize]);
                    self.end(*comer);
                }
                continue;
            }
            let x = place[vertex as usize];
            if around.are_calm_at(vertex) {
                continue;
            }
            let Some(normal) = surface.normal(vertex, place) else { continue };
            let mut faces = |edge: &u32| {
                let of_edge = &mut edge_normals[*edge as usize];
                of_edge
                    .get_or_insert_with(|| surface.edge_normal(*edge, place))
                    .is_some_and(|n| n.dot(&normal) < MAY_FACE)
            };
            near.clear();
            near.extend(around.edges(x).filter(|edge| faces(edge)).filter(|&edge| search.is_near(vertex, edge)));
            near.sort_unstable();
            let first = self.edges.len();
            self.edges.extend(near.iter().map(|&edge| Neighbour { edge, can_touch: search.can_touch(vertex, edge) }));
            let comes = |near: &&Neighbour| near.can_touch && !search.stays(vertex, near.edge);
            let coming = self.edges[first..].iter().filter(comes);
            let distance = coming.map(|near| search.way_out(vertex, near.edge)).fold(f64::INFINITY, f64::min);
            if distance > touches {
                self.edges.truncate(first);
            } else {
                self.end(Comer { vertex, distance });
            }
        }
        (0..surface.len() as u32).filter(|&v| wanted[v as usize]).for_each(|v| nearing.restart(v));
        self.nearing = nearing;
    }

    /// The edges that were added last are those of a vertex.
    fn end(&mut self, comer: Comer) {
        self.comers.push(comer);
        self.first.push(self.edges.len() as u32);
    }

    /// Takes it that all has moved with `velocity` [m/s] for `time` [s] and will as long again. Returns whether
    /// neighbours have to be looked for anew before.
    pub(crate) fn go_on(&mut self, scenery: &Scenery<'_>, velocity: &[Vector], time: f64) -> bool {
        self.nearing.go_on(scenery.surface, velocity, time);
        self.nearing.may_pass(scenery.most_moved * scenery.cell_size)
    }

    /// Takes it that all will move with `velocity` [m/s] for `time` [s].
    pub(crate) fn foresee(&mut self, scenery: &Scenery<'_>, velocity: &[Vector], time: f64) {
        self.nearing.foresee(scenery.surface, velocity, time);
    }

    /// Chooses the vertices that may touch something until the next look.
    pub(crate) fn choose(&mut self, scenery: &Scenery<'_>) {
        let touches = |c: &Comer| self.nearing.by_next_look(c.vertex) + TOUCHES * scenery.cell_size;
        let is_due = |&k: &u32| self.comers[k as usize].distance <= touches(&self.comers[k as usize]);
        let due: Vec<u32> = (0..self.comers.len() as u32).filter(is_due).collect();
        if due != self.due {
            self.due = due;
            self.ask(scenery.surface);
        }
    }

    /// Notes whose places are asked for: with normals, those of vertices beside.
    fn ask(&mut self, surface: &Surface) {
        let ends = self.iter().flat_map(|(vertex, near)| {
            near.iter().flat_map(|n| [Some(n.edge), surface.next(n.edge)]).flatten().chain([vertex])
        });
        let mut asked: Vec<u32> = ends.collect();
        asked.sort_unstable();
        asked.dedup();
        let beside: Vec<u32> = asked.iter().flat_map(|&v| [surface.previous(v), surface.next(v)]).flatten().collect();
        asked.extend(beside);
        asked.sort_unstable();
        asked.dedup();
        self.asked = asked;
    }

    /// Whether something may touch by now.
    pub(crate) fn are_due(&self) -> bool {
        !self.due.is_empty()
    }

    /// The vertices that may touch something by now, with the edges near them.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (u32, &[Neighbour])> {
        let range = |k: usize| self.first[k] as usize..self.first[k + 1] as usize;
        self.due.iter().map(move |&k| (self.comers[k as usize].vertex, &self.edges[range(k as usize)]))
    }

    /// The vertices whose places are asked for, rising.
    pub(crate) fn asked(&self) -> &[u32] {
        &self.asked
    }
}

/// What decides whether a vertex and an edge are near, and can touch.
struct Search<'a> {
    surface: &'a Surface,
    place: &'a [Point],
    rest: &'a [Point],
    cell_size: f64,
    most_moved: f64,
    cracks_touch: bool,
}

impl Scenery<'_> {
    /// What is farther apart than this now is met by nothing before the next look, and the size of cells [m].
    fn reach(&self) -> (f64, f64) {
        ((WIDEST + self.most_moved) * self.cell_size, self.cell_size)
    }
}

impl<'a> Search<'a> {
    fn new(scenery: &Scenery<'a>, rest: &'a [Point]) -> Self {
        let Scenery { surface, place, cell_size, most_moved, cracks_touch } = *scenery;
        Self { surface, place, rest, cell_size, most_moved, cracks_touch }
    }

    /// What is farther apart than this now is met by nothing before the next look [m].
    fn reach(&self) -> f64 {
        (WIDEST + self.most_moved) * self.cell_size
    }

    fn is_near(&self, vertex: u32, edge: u32) -> bool {
        let Some(next) = self.surface.next(edge) else { return false };
        if edge == vertex || next == vertex {
            return false;
        }
        self.distance_to(vertex, [edge, next]) <= self.reach()
    }

    /// How far a vertex is before an edge now, none behind it [m].
    fn way_out(&self, vertex: u32, edge: u32) -> f64 {
        let Some(next) = self.surface.next(edge) else { return f64::INFINITY };
        let away = self.place[vertex as usize] - self.place[edge as usize];
        let is_behind = self.surface.edge_normal(edge, self.place).is_some_and(|normal| normal.dot(&away) < 0.0);
        if is_behind { 0.0 } else { self.distance_to(vertex, [edge, next]) }
    }

    fn distance_to(&self, vertex: u32, ends: [u32; 2]) -> f64 {
        let [x, from, to] = [vertex, ends[0], ends[1]].map(|v| self.place[v as usize]);
        distance_to_segment(x, from, to)
    }

    /// Whether a vertex and an edge of one body, one of them on a crack, have moved so much alike that they cannot be
    /// near each other now if they do not belong together.
    fn stays(&self, vertex: u32, edge: u32) -> bool {
        let Some(next) = self.surface.next(edge) else { return true };
        let [of_vertex, from, to] = [vertex, edge, next].map(|v| self.surface.vertex(v));
        let slid = |end: u32| (self.displacement(end) - self.displacement(vertex)).norm_squared();
        of_vertex.body == from.body
            && (of_vertex.is_on_crack || from.is_on_crack || to.is_on_crack)
            && slid(edge).max(slid(next)) < self.least_slide(of_vertex.piece == from.piece).powi(2)
    }

    /// What does not belong together, of one piece (`are_one`) or of two of one body, and touches before the next look,
    /// has moved by more than this relative to each other [m].
    fn least_slide(&self, are_one: bool) -> f64 {
        if are_one { TOGETHER * self.cell_size - self.reach() } else { (MATCHED - self.most_moved) * self.cell_size }
    }

    fn displacement(&self, vertex: u32) -> Vector {
        self.place[vertex as usize] - self.rest[vertex as usize]
    }

    /// Whether a vertex and an edge are not of one piece where they are near each other.
    fn can_touch(&self, vertex: u32, edge: u32) -> bool {
        let Some(next) = self.surface.next(edge) else { return false };
        let [of_vertex, from, to] = [vertex, edge, next].map(|v| self.surface.vertex(v));
        let on_crack = [of_vertex, from, to].iter().any(|v| v.is_on_crack);
        if on_crack && !self.cracks_touch {
            return false;
        }
        if of_vertex.body != from.body {
            return true;
        }
        let away = nearest_on_segment(from.rest, to.rest, of_vertex.rest) - of_vertex.rest;
        let distance = away.norm();
        if distance >= TOGETHER * self.cell_size {
            return true;
        }
        if of_vertex.piece != from.piece {
            // Where on the edge, tells the moment.
            return [from, to].iter().any(|end| (end.rest - of_vertex.rest).norm() >= MATCHED * self.cell_size);
        }
        // The two sides of a drawn gap, but for its root.
        let through_gap = self.surface.normal(vertex, self.rest).is_some_and(|n| n.dot(&away) > 0.0);
        !on_crack && through_gap && !self.is_along(vertex, edge, NARROW * distance)
    }

    /// Whether the way from a vertex to an edge along the surface at rest is shorter than `length` [m].
    fn is_along(&self, vertex: u32, edge: u32, length: f64) -> bool {
        let walk = |step: &dyn Fn(u32) -> Option<u32>| {
            let (mut at, mut left) = (vertex, length);
            while let Some(next) = step(at) {
                left -= (self.rest[next as usize] - self.rest[at as usize]).norm();
                at = next;
                if left < 0.0 || at == vertex {
                    return false;
                }
                if at == edge {
                    return true;
                }
            }
            false
        };
        walk(&|v| self.surface.next(v)) || walk(&|v| self.surface.previous(v))
    }
}

#[cfg(test)]
mod tests {
    use super::super::meeting::{Meeting, meeting};
    use super::*;
    use proptest::prelude::*;

    /// Two rings that bend and move, the second with a crack drawn into it, its first half on the crack: two bodies,
    /// two pieces of one, or one piece.
    fn moved(count: usize, slides: &[(f64, f64)], parts: usize, turn: f64) -> (Surface, Vec<Point>) {
        let mut surface = Surface::default();
        for (ring, body) in [0, u32::from(parts == 0)].into_iter().enumerate() {
            let first = surface.len() as u32;
            for k in 0..count {
                let angle = std::f64::consts::TAU * k as f64 / count as f64;
                let rest = Point::new(angle.cos() + 2.2 * ring as f64, 1.5 * angle.sin());
                surface.push(rest, body, 0, ring == 1 && k < count / 2);
            }
            (0..count as u32).for_each(|k| surface.link(first + k, first + (k + 1) % count as u32));
        }
        let joined: &[[u32; 2]] = if parts == 2 { &[[0, count as u32]] } else { &[] };
        surface.number_pieces(joined);
        let of_ring = |v: usize| if v < count { Vector::zeros() } else { Vector::new(-turn, 0.3 * turn) };
        // From one to the next, so that no edge is sheared by as much as it is long.
        let slide = |v: usize| {
            let at = (v % count) as f64 / count as f64 * slides.len() as f64;
            let [a, b] = [0, 1].map(|next| slides[(at as usize + next + v / count) % slides.len()]);
            (a.0 + (b.0 - a.0) * at.fract(), a.1 + (b.1 - a.1) * at.fract())
        };
        let moved = |(v, rest): (usize, Point)| rest + of_ring(v) + Vector::new(slide(v).0, slide(v).1);
        let place = surface.places_at_rest().into_iter().enumerate().map(moved).collect();
        (surface, place)
    }

    fn scenery<'a>(surface: &'a Surface, place: &'a [Point], (cell_size, most_moved): (f64, f64)) -> Scenery<'a> {
        Scenery { surface, place, cell_size, most_moved, cracks_touch: true }
    }

    proptest! {
        /// Truth: every vertex with every edge. However the one ring moves on, with looks as often as it may need them,
        /// all that touch are found at any time.
        #[test]
        fn what_touches_before_the_next_look_is_found(
            edge in 0.3..1.0_f64,
            slides in prop::collection::vec((-0.3..0.3_f64, -0.3..0.3_f64), 1..12),
            parts in 0..3_usize,
            turn in 0.0..0.6_f64,
            cell_size in 0.1..0.4_f64,
            ways in prop::collection::vec((0.0..1.0_f64, 0.0..std::f64::consts::TAU, 0.0..0.5_f64), 1..8),
        ) {
            // A ring is 7.9 long; surfaces have edges up to a cell long.
            let count = (7.9 / (edge * cell_size)).ceil() as usize;
            let (surface, mut place) = moved(count, &slides, parts, turn);
            let most_moved = if parts == 1 { MOST_MOVED_OF_PIECES } else { MOST_MOVED };
            let scale = (cell_size, most_moved);
            let rest = surface.places_at_rest();
            let all = |place: &[Point], vertex: u32| {
                let scenery = scenery(&surface, place, scale);
                let search = Search::new(&scenery, &rest);
                let normal = surface.normal(vertex, place);
                let faces = |edge: &u32| {
                    let of_edge = surface.edge_normal(*edge, place);
                    of_edge.zip(normal).is_some_and(|(of_edge, normal)| of_edge.dot(&normal) < MAY_FACE)
                };
                let others = (0..surface.len() as u32).filter(|&e| e != vertex && surface.next(e) != Some(vertex));
                let near = |edge: u32| Neighbour { edge, can_touch: search.can_touch(vertex, edge) };
                others.filter(faces).map(near).collect::<Vec<_>>()
            };
            let mut found = Neighbours::find(&scenery(&surface, &place, scale));
            let mut last = vec![Vector::zeros(); surface.len()];
            for (part, heading, whole) in ways {
                // The ring as a whole, and one side of it by as much more: what is far from where they meet has to be
                // followed as well.
                let way = Vector::new(heading.cos(), heading.sin()) * (part * most_moved * cell_size);
                let beside = |v: usize| (std::f64::consts::PI * (v - count) as f64 / count as f64).sin().powi(2);
                let of = |v: usize| if v < count { Vector::zeros() } else { way * (whole + (1.0 - whole) * beside(v)) };
                let velocity: Vec<Vector> = (0..surface.len()).map(of).collect();
                found.go_on(&scenery(&surface, &place, scale), &last, 1.0);
                found.nearing.foresee(&surface, &velocity, 1.0);
                if found.nearing.may_pass(most_moved * cell_size) {
                    found.find_again(&scenery(&surface, &place, scale));
                }
                found.foresee(&scenery(&surface, &place, scale), &velocity, 1.0);
                found.choose(&scenery(&surface, &place, scale));
                place.iter_mut().zip(&velocity).for_each(|(p, way)| *p += way);
                last = velocity;
                let touches = |(vertex, near): (u32, &[Neighbour])| {
                    let met = meeting(&surface, &place, vertex, near, cell_size)?;
                    (met.gap < 0.1 * cell_size).then_some((vertex, met))
                };
                let every = (0..surface.len() as u32).map(|v| (v, all(&place, v)));
                let expected: Vec<(u32, Meeting)> = every.filter_map(|(v, near)| touches((v, &near))).collect();
                let found: Vec<(u32, Meeting)> = found.iter().filter_map(touches).collect();
                prop_assert_eq!(found, expected);
            }
        }
    }
}
