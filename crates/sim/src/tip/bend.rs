//! The crack behind a tip, where it is bent.

use crate::crack::crossing::{Side, side_of_crack};
use fissure_plane::{Point, Vector, bounds, nearest_on_segment};

/// A crack behind its tip, in the frame of the tip.
#[derive(Debug, Clone, Default)]
pub(crate) struct Bend {
    /// Its points, towards the tip, which is the last one and lies at the origin [m].
    line: Vec<Point>,
    /// Way from each point to the tip [m].
    way: Vec<f64>,
    /// The boxes around so many segments that follow each other: the lowest x and y, and the highest [m].
    boxes: Vec<(Point, Point)>,
}

/// Segments in a box.
const IN_BOX: usize = 6;

/// What two distances have to differ by, as part of them, to differ whatever rounding has done to them.
const SURELY: f64 = 1e-9;

/// A place on a crack.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Foot {
    pub(crate) place: Point,
    /// Way to the tip [m].
    pub(crate) way: f64,
    /// Segment it lies on.
    segment: usize,
}

/// A short stretch of a crack.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stretch {
    /// Its middle.
    pub(crate) foot: Foot,
    /// Its length [m].
    pub(crate) length: f64,
    /// Unit vector along it, towards the tip.
    pub(crate) toward: Vector,
}

/// A place so near the crack [m/m of its distance from the tip] lies on it.
const ON_CRACK: f64 = 1e-9;

impl Bend {
    /// The crack through `line`, towards its tip.
    pub(crate) fn new(line: Vec<Point>) -> Self {
        let mut way = vec![0.0; line.len()];
        for k in (1..line.len()).rev() {
            way[k - 1] = way[k] + (line[k] - line[k - 1]).norm();
        }
        let last = line.len().saturating_sub(1);
        let around = |first: usize| bounds(&line[first..(first + IN_BOX).min(last) + 1]);
        let boxes = (0..last).step_by(IN_BOX).map(around).collect();
        Self { line, way, boxes }
    }

    /// The place on the crack nearest to `place`.
    pub(crate) fn foot(&self, place: Point) -> Foot {
        let tip = Foot { place: Point::origin(), way: 0.0, segment: self.line.len().saturating_sub(2) };
        let mut nearest = (place.coords.norm_squared(), tip);
        for (index, (low, high)) in self.boxes.iter().enumerate() {
            let beyond = (low - place).sup(&(place - high)).sup(&Vector::zeros());
            if beyond.norm_squared() > nearest.0 * (1.0 + SURELY) {
                continue;
            }
            for segment in index * IN_BOX..((index + 1) * IN_BOX).min(self.line.len() - 1) {
                let [from, to] = [self.line[segment], self.line[segment + 1]];
                let foot = nearest_on_segment(from, to, place);
                let distance = (place - foot).norm_squared();
                if distance < nearest.0 {
                    let way = self.way[segment + 1] + (to - foot).norm();
                    nearest = (distance, Foot { place: foot, way, segment });
                }
            }
        }
        nearest.1
    }

    /// The face that a place sees, left (above) or right, and its distance from that [m]; none where nothing of the
    /// crack is nearer than the tip. A place on the crack is on its `own` side.
    pub(crate) fn side(&self, place: Point, own: Side) -> Option<(Side, f64)> {
        let foot = self.foot(place);
        if foot.way <= 0.0 {
            return None;
        }
        let distance = (place - foot.place).norm();
        let is_on = distance < ON_CRACK * place.coords.norm();
        Some((if is_on { own } else { side_of_crack(&self.line, foot.segment, place) }, distance))
    }

    /// Whether the angle from e1 to a place goes on beyond ±π, as turned to without crossing the crack: left of it
    /// above 0, right of it below.
    pub(crate) fn is_beyond(place: Vector, side: Option<Side>) -> bool {
        // Behind the tip, 0 has a side too.
        let is_behind = place.x < 0.0;
        match side {
            Some(Side::Above) => place.y < 0.0 || is_behind && place.y.is_sign_negative(),
            Some(Side::Below) => place.y > 0.0 || is_behind && place.y.is_sign_positive(),
            None => false,
        }
    }

    /// Stretches of at most `longest` [m] that the crack is made of, from `nearest` to the tip [m] on.
    pub(crate) fn stretches(&self, nearest: f64, longest: f64) -> impl Iterator<Item = Stretch> {
        self.line.windows(2).enumerate().flat_map(move |(segment, w)| {
            let (near, far) = (self.way[segment + 1].max(nearest), self.way[segment].max(nearest));
            let pieces = ((far - near) / longest - 1e-9).ceil().max(0.0);
            let (length, toward) = ((far - near) / pieces.max(1.0), (w[1] - w[0]).normalize());
            let end = (w[1], self.way[segment + 1]);
            (0..pieces as u32).map(move |k| {
                let way = near + (f64::from(k) + 0.5) * length;
                Stretch { foot: Foot { place: end.0 - toward * (way - end.1), way, segment }, length, toward }
            })
        })
    }

    /// The place at a `way` from the tip [m]; the last one where the crack is shorter.
    pub(crate) fn at(&self, way: f64) -> Point {
        let Some(segment) = (1..self.line.len()).rev().find(|&k| self.way[k - 1] >= way) else {
            return self.line.first().copied().unwrap_or_default();
        };
        let (from, to) = (self.line[segment - 1], self.line[segment]);
        to + (from - to).normalize() * (way - self.way[segment])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    proptest! {
        /// Truth: the feet on all segments, the first of those that are equally near. Cracks that go straight on, that
        /// wind and that turn back, some places on them.
        #[test]
        fn the_foot_of_a_place_is_on_the_nearest_segment(
            turns in prop::collection::vec(-2.0_f64..2.0, 1..50), swing in 0.0_f64..1.5,
            places in prop::collection::vec((-4.0_f64..4.0, -4.0_f64..4.0, any::<bool>()), 40),
        ) {
            let (mut line, mut heading) = (vec![Point::origin()], PI);
            for turn in turns {
                heading += swing * turn;
                line.push(line[line.len() - 1] + Vector::new(heading.cos(), heading.sin()) * 0.25);
            }
            line.reverse();
            let bend = Bend::new(line.clone());
            for (x, y, is_on) in places {
                let place = if is_on { line[(x.abs() * 12.0) as usize % line.len()] } else { Point::new(x, y) };
                let mut nearest = (place.coords.norm_squared(), Point::origin());
                for w in line.windows(2) {
                    let foot = nearest_on_segment(w[0], w[1], place);
                    if (place - foot).norm_squared() < nearest.0 {
                        nearest = ((place - foot).norm_squared(), foot);
                    }
                }
                prop_assert_eq!(bend.foot(place).place, nearest.1);
            }
        }
    }

    /// Truth: the drawing. A crack along the x axis whose parent comes from below, so that above the parent's line and
    /// left of the kink is still left of the crack, though more than half a turn away.
    #[test]
    fn an_angle_goes_round_the_tip_and_not_through_the_crack() {
        let bend = Bend::new(vec![Point::new(-2.0, -2.0), Point::new(-1.0, 0.0), Point::origin()]);
        let angle = |x: f64, y: f64| {
            let place = Point::new(x, y);
            let side = bend.side(place, Side::Above).map(|of| of.0);
            let turn = if Bend::is_beyond(place.coords, side) { 2.0 * PI } else { 0.0 };
            let angle = y.atan2(x);
            if side == Some(Side::Below) { angle - turn } else { angle + turn }
        };
        assert!((angle(1.0, 1.0) - 0.25 * PI).abs() < 1e-14 && (angle(1.0, -1.0) + 0.25 * PI).abs() < 1e-14);
        assert!((angle(-2.0, 0.0) - PI).abs() < 1e-14 && (angle(-2.0, -1.0) - PI - 0.5_f64.atan()).abs() < 1e-14);
        assert!((angle(-2.0, -0.0) - PI).abs() < 1e-14);
        assert!((angle(-1.0, -1.0) + 0.75 * PI).abs() < 1e-14 && (angle(-0.5, 0.0) - PI).abs() < 1e-14);
        // Beside a crack that comes back ahead of its tip, too; and nothing on e1 itself.
        for (x, y, of_above, of_below) in
            [(1.0, -1.0, true, false), (1.0, 1.0, false, true), (1.0, 0.0, false, false), (1.0, -0.0, false, false)]
        {
            let place = Vector::new(x, y);
            let found = [Side::Above, Side::Below].map(|side| Bend::is_beyond(place, Some(side)));
            assert_eq!(found, [of_above, of_below], "{x} {y}");
        }
        let length: f64 = bend.stretches(0.3, 0.1).map(|s| s.length).sum();
        assert!((length - (0.7 + 5.0_f64.sqrt())).abs() < 1e-14);
        for stretch in bend.stretches(0.0, 0.25) {
            assert!((bend.at(stretch.foot.way) - stretch.foot.place).norm() < 1e-14);
            assert!((bend.foot(stretch.foot.place).way - stretch.foot.way).abs() < 1e-14);
        }
    }
}
