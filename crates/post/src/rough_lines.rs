//! Where the vertices of rough walls are: in columns over the corners of a polygon, and over places between them.
//!
//! Programs that merge vertices by distance would join columns that come near to each other. The relief keeps away from
//! other lines and from tips; where a crack narrows towards its tip, places between its corners are left out.

use crate::boolean::Edge;
use crate::extrude::Extrusion;
use crate::relief::{OnCrack, Relief};
use crate::slot::Slot;
use crate::source::Carried;
use fissure_scene::{Point, Vector};
use rustc_hash::FxHashMap;

/// Least number of rows of quads.
const LEAST_ROWS: usize = 4;
/// Places this near to a corner, in parts of their distance, are left out.
const BESIDE: f64 = 0.03;

/// Vertices above each other, within a wall.
pub(crate) struct RoughLine {
    pub(crate) carried: Carried,
    /// Where they would be without a relief [m].
    straight: Point,
    /// Where they are and how deep [m], from the back to the front.
    pub(crate) rows: Vec<(Point, f64)>,
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

/// The vertices of the walls on a contour.
pub(crate) struct RoughWalls {
    /// Over each corner, the one at the start of an edge; none at the end of the wall.
    pub(crate) corners: Vec<Option<RoughLine>>,
    /// Over each edge, from its start to its end.
    pub(crate) between: Vec<Vec<RoughLine>>,
}

impl RoughWalls {
    /// Those of a `contour`, a ring if `closed`.
    pub(crate) fn new(extrusion: &Extrusion<'_>, contour: &[Edge], closed: bool, relief: &Relief) -> Self {
        let places = Places { extrusion, contour, closed, relief };
        let line = |place: &Place| places.line(place);
        let is_wall = |i: usize| extrusion.source(&contour[i]).slot == Slot::Inside;
        let mut walls = Self {
            corners: (0..contour.len()).map(|i| places.corner(i).filter(|_| is_wall(i)).as_ref().map(line)).collect(),
            between: (0..contour.len())
                .map(|i| if is_wall(i) { places.between(i).iter().map(line).collect() } else { Vec::new() })
                .collect(),
        };
        if closed {
            // At rest the vertices do not depend on how far faces are open.
            let at_rest = extrusion.at_rest;
            walls.leave_room(relief.room_to_others(at_rest) * extrusion.texture_size, at_rest);
        }
        walls
    }

    /// Makes columns over corners straight that come nearer than `room` [m] to others in any row, and leaves places
    /// between corners out that do: on both faces, which fit each other still. If all `stay` these go straight too.
    fn leave_room(&mut self, room: f64, stay: bool) {
        if room <= 0.0 {
            return;
        }
        // What goes straight may come near to what has not.
        loop {
            let near = self.near(room, stay);
            let all = self.corners.iter_mut().map(Option::as_mut).chain(self.between.iter_mut().flatten().map(Some));
            let mut is_done = true;
            for line in all.zip(near).filter_map(|(line, near)| line.filter(|_| near)) {
                for (place, _) in line.rows.iter_mut().filter(|(place, _)| *place != line.straight) {
                    *place = line.straight;
                    is_done = false;
                }
            }
            if is_done {
                break;
            }
        }
        if stay {
            return;
        }
        let near = self.near(room, true);
        let mut between = near[self.corners.len()..].iter();
        for lines in &mut self.between {
            lines.retain(|_| !between.next().is_some_and(|near| *near));
        }
    }

    /// Which columns come nearer than `room` [m] to others: those over corners, then, if `has_between`, those between.
    fn near(&self, room: f64, has_between: bool) -> Vec<bool> {
        let between = self.between.iter().flatten().filter(|_| has_between).map(Some);
        let all: Vec<Option<&RoughLine>> = self.corners.iter().map(Option::as_ref).chain(between).collect();
        let bin = |place: Point| [place.x, place.y].map(|x| (x / room).floor() as i64);
        let mut bins = FxHashMap::<(usize, [i64; 2]), Vec<(Point, usize)>>::default();
        for (number, line) in all.iter().enumerate() {
            for (row, &(place, _)) in line.iter().flat_map(|line| line.rows.iter().enumerate()) {
                bins.entry((row, bin(place))).or_default().push((place, number));
            }
        }
        let is_near = |(number, line): (usize, &Option<&RoughLine>)| {
            line.iter().flat_map(|line| line.rows.iter().enumerate()).any(|(row, (place, _))| {
                let [x, y] = bin(*place);
                let near = (x - 1..=x + 1).flat_map(|x| (y - 1..=y + 1).map(move |y| (row, [x, y])));
                let mut near = near.filter_map(|key| bins.get(&key)).flatten();
                near.any(|(other, whose)| *whose != number && (other - place).norm() < room)
            })
        };
        all.iter().enumerate().map(is_near).collect()
    }
}

/// Places on the walls of a contour.
struct Places<'a> {
    extrusion: &'a Extrusion<'a>,
    contour: &'a [Edge],
    closed: bool,
    relief: &'a Relief,
}

impl Places<'_> {
    /// Corner `i` of a contour, as its material at the edge that begins there; none at the end of the wall.
    fn corner(&self, i: usize) -> Option<Place> {
        let count = self.contour.len();
        if i == 0 && !self.closed {
            return None;
        }
        let (before, after) = (&self.contour[(i + count - 1) % count], &self.contour[i]);
        let (source, next) = (self.extrusion.source(before), self.extrusion.source(after));
        if source.slot != next.slot {
            return None;
        }
        let longer = if length(before) > length(after) { before } else { after };
        let carried = next.at(after.a);
        let moves = self.relief.place(carried.rest).map(|place| (place, self.turn(longer)));
        Some(Place { now: self.extrusion.grid.place(after.a), carried, moves })
    }

    /// Whether the contour comes back the way that it went at corner `i`: at the tip of a crack.
    fn is_tip(&self, i: usize) -> bool {
        let count = self.contour.len();
        let (before, after) = (&self.contour[(i + count - 1) % count], &self.contour[i]);
        self.extrusion.source(before).at(before.a).rest == self.extrusion.source(after).at(after.b).rest
    }

    /// How the material at an edge has turned, as the unit vector at that angle.
    fn turn(&self, edge: &Edge) -> Vector {
        let along = Vector::new((edge.b.x - edge.a.x) as f64, (edge.b.y - edge.a.y) as f64).normalize();
        let rest = self.extrusion.source(edge).direction_at_rest();
        rest.map_or_else(Vector::x, |rest| Vector::new(along.dot(&rest), rest.perp(&along)))
    }

    /// The places on edge `i` where the length along the crack is a multiple of a step, the same on both of its faces.
    fn between(&self, i: usize) -> Vec<Place> {
        // Faces that are held apart at rest narrow to nothing there.
        if self.extrusion.at_rest && (self.is_tip(i) || self.is_tip((i + 1) % self.contour.len())) {
            return Vec::new();
        }
        let (edge, source) = (&self.contour[i], self.extrusion.source(&self.contour[i]));
        let [from, to] = [source.at(edge.a), source.at(edge.b)];
        let middle = nalgebra::center(&from.rest, &to.rest);
        let Some((crack, _)) = self.relief.place(middle) else { return Vec::new() };
        let arcs = [from.rest, to.rest].map(|rest| self.relief.place_on(crack, rest).map(|(_, arc)| arc));
        let [Some(start), Some(end)] = arcs else { return Vec::new() };
        let turns = [i, (i + 1) % self.contour.len()].map(|corner| {
            let place = self.corner(corner);
            place.and_then(|place| place.moves).map_or_else(|| self.turn(edge), |(_, turn)| turn)
        });
        let (a, b) = (self.extrusion.grid.place(edge.a), self.extrusion.grid.place(edge.b));
        let step = self.relief.step();
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

    /// The vertices over a place.
    fn line(&self, place: &Place) -> RoughLine {
        let thickness = self.extrusion.thickness;
        let rows = LEAST_ROWS.max((thickness / self.relief.step()).ceil() as usize);
        let moves = place.moves.map(|(on_crack, turn)| (self.relief.profile(on_crack, place.carried.rest), turn));
        let row = |row: usize| {
            let z = thickness * (row as f64 / rows as f64 - 0.5);
            let moved = moves.as_ref().map_or(Vector::zeros(), |(profile, turn)| {
                let shift = profile.shift(z);
                Vector::new(turn.x * shift.x - turn.y * shift.y, turn.y * shift.x + turn.x * shift.y)
            });
            (place.now + moved, z)
        };
        RoughLine { carried: place.carried, straight: place.now, rows: (1..rows).map(row).collect() }
    }
}

fn length(edge: &Edge) -> f64 {
    ((edge.b.x - edge.a.x) as f64).hypot((edge.b.y - edge.a.y) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Truth: by brute force. Columns that stand apart where they are straight are apart
        /// afterwards in every row, also from what went straight because of others.
        #[test]
        fn columns_that_go_straight_come_near_to_none(
            steps in proptest::collection::vec((-0.9..0.9_f64, -0.9..0.9_f64, -0.9..0.9_f64), 3..12), stay: bool,
        ) {
            let line = |(k, (low, middle, high)): (usize, &(f64, f64, f64))| {
                let straight = Point::new(1.01 * k as f64, 0.0);
                let row = |(z, shift): (usize, &f64)| (straight + *shift * Vector::x(), z as f64);
                let rows = [*low, *middle, *high].iter().enumerate().map(row).collect();
                RoughLine { carried: Carried::within(straight, Vector::zeros()), straight, rows }
            };
            let corners: Vec<Option<RoughLine>> = steps.iter().enumerate().map(line).map(Some).collect();
            let between = corners.iter().map(|_| Vec::new()).collect();
            let mut walls = RoughWalls { corners, between };
            walls.leave_room(1.0, stay);
            let lines: Vec<&RoughLine> = walls.corners.iter().flatten().collect();
            for (k, line) in lines.iter().enumerate() {
                for other in &lines[k + 1..] {
                    for ((p, _), (q, _)) in line.rows.iter().zip(&other.rows) {
                        prop_assert!((p - q).norm() >= 1.0, "{} {}", p, q);
                    }
                }
            }
        }
    }
}
