//! The boundary of a fragment as edges of the moved body.

use crate::drawn_curve::tangents;
use crate::history::History;
use crate::opening::arc_lengths;
use crate::slot::Slot;
use crate::smooth::SmoothCracks;
use crate::snap::Grid;
use crate::source::{Carried, SourceEdge};
use crate::widening::{Shift, both};
use fissure_scene::{BoundaryEdge, CrackEnd, Frame, Line, Point, Scene, Vector};

/// Where a point of a line is now.
#[derive(Debug, Clone, Copy)]
struct Now {
    /// Position [m].
    place: Point,
    /// Velocity [m/s].
    velocity: Vector,
}

impl Now {
    /// Moved by `shift` [m].
    fn by(self, shift: Vector) -> Self {
        Self { place: self.place + shift, ..self }
    }

    fn middle(self, other: Self) -> Self {
        Self { place: nalgebra::center(&self.place, &other.place), velocity: 0.5 * (self.velocity + other.velocity) }
    }
}

/// The rings and crack faces of a frame as they are now.
pub(crate) struct MovedLines<'a> {
    frame: &'a Frame,
    cracks: &'a SmoothCracks<'a>,
    /// Length at rest along each ring and crack up to each of its points [m]; a ring's last is that of its first point
    /// on the way back.
    ring_arcs: Vec<Vec<f64>>,
    crack_arcs: Vec<Vec<f64>>,
    /// Directions at rest of the curve that was drawn, for each edge of each ring; of none where none is told of.
    ring_tangents: Vec<Vec<[Vector; 2]>>,
    /// How far the faces of each crack are moved at each of its points.
    shifts: Vec<Vec<Shift>>,
    /// How each point of each crack came about, where that is asked for.
    histories: Option<Vec<Vec<History>>>,
}

impl<'a> MovedLines<'a> {
    /// The lines of `frame`, with its cracks as `cracks`, the faces of each moved by its shifts, one for each of its
    /// points.
    pub(crate) fn new(scene: &Scene, frame: &'a Frame, cracks: &'a SmoothCracks<'a>, shifts: Vec<Vec<Shift>>) -> Self {
        let ring = |rest: &Vec<Point>| {
            let mut arc = 0.0;
            let steps = (0..rest.len()).map(|i| (rest[(i + 1) % rest.len()] - rest[i]).norm());
            let ends = steps.map(|step| {
                arc += step;
                arc
            });
            std::iter::once(0.0).chain(ends).collect()
        };
        let first = |crack: u32| scene.cracks.get(crack as usize).and_then(|c| c.points.first().copied());
        Self {
            frame,
            cracks,
            ring_arcs: frame.outlines.iter().map(|o| ring(&o.rest)).collect(),
            crack_arcs: frame.cracks.iter().map(|c| arc_lengths(&c.rest, first(c.crack))).collect(),
            ring_tangents: frame.outlines.iter().map(|outline| tangents(scene, outline)).collect(),
            shifts,
            histories: None,
        }
    }

    /// The lines with how each point of each crack came about.
    pub(crate) fn with(self, histories: Option<Vec<Vec<History>>>) -> Self {
        Self { histories, ..self }
    }

    /// The edges of a boundary, in its order, on `grid`. Where the walk passes from one line to another both edges end
    /// in one place.
    pub(crate) fn edges(&self, boundary: &[BoundaryEdge], grid: Grid) -> Vec<SourceEdge> {
        let count = boundary.len();
        let corners: Vec<Now> =
            (0..count).map(|i| self.corner(&boundary[(i + count - 1) % count], &boundary[i])).collect();
        (0..count)
            .map(|i| {
                let (edge, [start, end]) = (&boundary[i], [corners[i], corners[(i + 1) % count]]);
                let (arcs, histories, tangents) = (self.arcs(edge), self.histories(edge), self.tangents(edge));
                let carried = |k: usize, now: Now| Carried {
                    rest: edge.rest[k] + self.offset(edge, k),
                    velocity: now.velocity,
                    arc: arcs[k],
                    history: histories[k],
                    tangent: tangents[k],
                };
                SourceEdge {
                    a: grid.snap(start.place),
                    b: grid.snap(end.place),
                    carried: [carried(0, start), carried(1, end)],
                    slot: if matches!(edge.line, Line::Ring(_)) { Slot::Outside } else { Slot::Inside },
                }
            })
            .collect()
    }

    /// Where the corner between two edges is.
    ///
    /// The end of a crack knows the material beside it, whatever it ends on; the point of a ring or of a crack that is
    /// passed there is that of one of two corners only, or of none.
    fn corner(&self, before: &BoundaryEdge, after: &BoundaryEdge) -> Now {
        let (arrives, leaves) = (whole_point(before, 1), whole_point(after, 0));
        let is_same_line = crack_of(before.line) == crack_of(after.line);
        let (there, here) = (self.shift(before, 1), self.shift(after, 0));
        match (arrives, leaves) {
            (Some(p), Some(q)) if is_same_line && p == q => {
                self.at(before.line, p).by(there).middle(self.at(after.line, q).by(here))
            }
            // Both faces move: the corner moves with both.
            (_, Some(q)) if self.is_end(after.line, q) => self.at(after.line, q).by(both(there, here)),
            (Some(p), _) if self.is_end(before.line, p) => self.at(before.line, p).by(both(there, here)),
            (None, None) if before.line == after.line => self.between(after).by(here),
            _ => self.crossing(before, after).by(both(there, here)),
        }
    }

    /// How far the face of an edge is moved at one of its ends, 0 or 1 [m].
    fn shift(&self, edge: &BoundaryEdge, end: usize) -> Vector {
        let shift = |point: usize| match edge.line {
            Line::Ring(_) => Vector::zeros(),
            Line::Above(i) => self.shifts[i][point].above,
            Line::Below(i) => self.shifts[i][point].below,
        };
        let [p, q] = edge.points.map(shift);
        p + edge.span[end] * (q - p)
    }

    /// A point of a line, as the material is.
    fn at(&self, line: Line, point: usize) -> Now {
        let (cracks, rings) = (&self.cracks.cracks, &self.frame.outlines);
        let (place, velocity) = match line {
            Line::Ring(i) => (rings[i].position[point], rings[i].velocity[point]),
            Line::Above(i) => (cracks[i].above[point], cracks[i].above_velocity[point]),
            Line::Below(i) => (cracks[i].below[point], cracks[i].below_velocity[point]),
        };
        Now { place, velocity }
    }

    /// The start of an edge that begins within its segment.
    fn between(&self, edge: &BoundaryEdge) -> Now {
        let [p, q] = edge.points.map(|point| self.at(edge.line, point));
        let part = edge.span[0];
        Now { place: p.place + part * (q.place - p.place), velocity: p.velocity + part * (q.velocity - p.velocity) }
    }

    /// A corner that no crack ends at, where two cracks cross: where their faces, as they are now, meet; if they do not
    /// meet near there, from how the other ends of the two edges have moved, which lie in the material of this corner.
    fn crossing(&self, before: &BoundaryEdge, after: &BoundaryEdge) -> Now {
        let moved = |edge: &BoundaryEdge, k: usize| {
            let now = self.at(edge.line, edge.points[k]);
            let rest = self.rest(edge.line, edge.points[k]);
            Now { place: after.rest[0] + (now.place - rest), velocity: now.velocity }
        };
        let middle = moved(before, 0).middle(moved(after, 1));
        let [p, q] = [before, after].map(|edge| edge.points.map(|point| self.at(edge.line, point).place));
        let (along, other) = (p[1] - p[0], q[1] - q[0]);
        let parts = [other, along].map(|way| (q[0] - p[0]).perp(&way) / along.perp(&other));
        let is_near = parts.iter().all(|part| (-1.0..=2.0).contains(part));
        Now { place: if is_near { p[0] + parts[0] * along } else { middle.place }, ..middle }
    }

    fn rest(&self, line: Line, point: usize) -> Point {
        match line {
            Line::Ring(i) => self.frame.outlines[i].rest[point],
            Line::Above(i) | Line::Below(i) => self.frame.cracks[i].rest[point],
        }
    }

    /// How far the smoothing of its crack has moved an end of an edge, at rest [m]. What crosses is not moved.
    fn offset(&self, edge: &BoundaryEdge, end: usize) -> Vector {
        match edge.line {
            Line::Above(i) | Line::Below(i) if whole_point(edge, end).is_some() => {
                self.cracks.offsets[i][edge.points[end]]
            }
            _ => Vector::zeros(),
        }
    }

    /// Whether a crack ends on something at a point of its face.
    fn is_end(&self, line: Line, point: usize) -> bool {
        let (Line::Above(i) | Line::Below(i)) = line else { return false };
        let crack = &self.frame.cracks[i];
        (point == 0 && crack.start != CrackEnd::Tip) || (point + 1 == crack.rest.len() && crack.end != CrackEnd::Tip)
    }

    /// How the wall came about where an edge begins and ends.
    fn histories(&self, edge: &BoundaryEdge) -> [History; 2] {
        match (edge.line, &self.histories) {
            (Line::Above(i) | Line::Below(i), Some(histories)) => {
                let [p, q] = edge.points.map(|point| histories[i][point]);
                edge.span.map(|part| if part == 1.0 { q } else { p.between(q, part) })
            }
            _ => [History::default(); 2],
        }
    }

    /// Direction at rest of the curve that was drawn, where an edge begins and ends.
    fn tangents(&self, edge: &BoundaryEdge) -> [Vector; 2] {
        let Line::Ring(i) = edge.line else { return [Vector::zeros(); 2] };
        let [p, q] = self.ring_tangents[i].get(edge.points[0]).copied().unwrap_or_default();
        edge.span.map(|part| p + part * (q - p))
    }

    /// Length at rest along the line, where an edge begins and ends [m].
    fn arcs(&self, edge: &BoundaryEdge) -> [f64; 2] {
        let [p, q] = match edge.line {
            Line::Ring(i) => [self.ring_arcs[i][edge.points[0]], self.ring_arcs[i][edge.points[0] + 1]],
            Line::Above(i) | Line::Below(i) => edge.points.map(|point| self.crack_arcs[i][point]),
        };
        edge.span.map(|part| if part == 1.0 { q } else { p + part * (q - p) })
    }
}

/// The point of its line at an end of an edge; none where the edge ends within its segment.
fn whole_point(edge: &BoundaryEdge, end: usize) -> Option<usize> {
    let wanted = end as f64;
    (edge.span[end] == wanted).then(|| edge.points[end])
}

/// What two faces have in common: the crack, or the ring.
pub(crate) fn crack_of(line: Line) -> (bool, usize) {
    match line {
        Line::Ring(i) => (false, i),
        Line::Above(i) | Line::Below(i) => (true, i),
    }
}
