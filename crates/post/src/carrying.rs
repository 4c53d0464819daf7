//! Where the corners of a cap that was made at rest are now.
//!
//! Those of its boundary are where the frame tells; those within follow the particles around them and go along with the
//! boundary. Where that folds triangles, what is within makes room. Where the boundary itself has turned over, faces of
//! a corner or a needle that holds no particle rode along with what lay beside it: there the boundary follows the
//! fragment's own particles too.

use crate::drawn_along::drawn_along;
use crate::interior::Interior;
use crate::snap::{Grid, GridPoint};
use crate::untangled::{folded, untangle};
use fissure_scene::{Point, Vector};

/// Times that more of the boundary follows particles, at most.
const ROUNDS: usize = 8;

/// A cap made at rest, in the material that carries it.
pub(crate) struct Carrying<'a> {
    pub(crate) interior: &'a Interior<'a>,
    /// Of the body as it is now.
    pub(crate) grid: Grid,
    pub(crate) piece: u32,
    /// Of all corners, those of the boundary first, at rest [m].
    pub(crate) places: &'a [Point],
    /// Counter-clockwise at rest.
    pub(crate) triangles: &'a [[u32; 3]],
}

/// Where the corners of a cap are, and how fast they move.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CarriedCorners {
    pub(crate) now: Vec<GridPoint>,
    /// [m/s]
    pub(crate) velocities: Vec<Vector>,
}

impl Carrying<'_> {
    /// All corners, when those of the boundary are told to be `shown`, at these `speeds` [m/s]. `unfolds`: whether some
    /// of them may be elsewhere.
    pub(crate) fn corners(&self, shown: &[GridPoint], speeds: &[Vector], unfolds: bool) -> CarriedCorners {
        let count = shown.len();
        let inside: Vec<Option<(Point, Vector)>> =
            self.places[count..].iter().map(|rest| self.interior.moved(*rest, *rest, self.piece)).collect();
        let beside = beside(self.places, count, self.triangles);
        let seen = |k: usize| self.interior.moved(self.places[k], beside[k], self.piece);
        let outside: Vec<Option<(Point, Vector)>> = (0..count).map(seen).collect();
        let mut follows = vec![false; count];
        let mut found = self.with(shown, speeds, &outside, &inside, &follows);
        let mut bad = folded(&found.now, self.triangles);
        let mut best: Option<(usize, CarriedCorners)> = None;
        for _ in 0..ROUNDS {
            if bad.is_empty() || !unfolds {
                return found;
            }
            if !self.let_follow(&bad, &outside, &mut follows) {
                break;
            }
            if best.as_ref().is_none_or(|(least, _)| bad.len() < *least) {
                best = Some((bad.len(), found));
            }
            found = self.with(shown, speeds, &outside, &inside, &follows);
            bad = folded(&found.now, self.triangles);
        }
        match best {
            Some((least, best)) if least <= bad.len() => best,
            _ => found,
        }
    }

    /// Lets the corners of the boundary follow particles at which triangles are `folded`, with those beside them that
    /// see none; where all of them do, those of the triangles around as well. Whether there are any.
    fn let_follow(&self, folded: &[usize], seen: &[Option<(Point, Vector)>], follows: &mut [bool]) -> bool {
        let corners = |triangle: &[u32; 3]| triangle.map(|corner| corner as usize);
        let (mut reached, mut beyond) = (vec![false; self.places.len()], vec![false; self.places.len()]);
        for triangle in folded.iter().map(|&k| &self.triangles[k]) {
            let all_follow = corners(triangle).iter().all(|&corner| follows.get(corner).is_none_or(|follows| *follows));
            let marks = if all_follow { &mut beyond } else { &mut reached };
            corners(triangle).into_iter().for_each(|corner| marks[corner] = true);
        }
        for triangle in self.triangles.iter().filter(|triangle| corners(triangle).iter().any(|&c| beyond[c])) {
            corners(triangle).into_iter().for_each(|corner| reached[corner] = true);
        }
        let mut goes_on = true;
        while goes_on {
            goes_on = false;
            for triangle in self.triangles {
                if corners(triangle).iter().any(|&corner| reached[corner]) {
                    for corner in corners(triangle).into_iter().filter(|&corner| seen.get(corner) == Some(&None)) {
                        goes_on |= !std::mem::replace(&mut reached[corner], true);
                    }
                }
            }
        }
        let before = follows.to_vec();
        follows.iter_mut().zip(reached).for_each(|(follows, reached)| *follows |= reached);
        before != follows
    }

    /// All corners, when some of the boundary follow particles.
    fn with(
        &self,
        shown: &[GridPoint],
        speeds: &[Vector],
        outside: &[Option<(Point, Vector)>],
        inside: &[Option<(Point, Vector)>],
        follows: &[bool],
    ) -> CarriedCorners {
        let (places, count) = (self.places, shown.len());
        let told = |k: usize| self.grid.place(shown[k]);
        // By how much the boundary is off what particles beside it see.
        let way = |k: usize| outside[k].filter(|_| !follows[k]).map(|(place, _)| told(k) - place);
        let mut ways: Vec<Option<Vector>> = (0..count).map(way).collect();
        ways.resize(places.len(), None);
        let along = drawn_along(&ways, places, self.triangles);
        // Corners that see no particle go as those around them do.
        let step = |k: usize| match follows.get(k) {
            Some(false) => Some(told(k) - places[k]),
            Some(true) => self.alone(outside[k], k).map(|place| place - places[k] + along[k]),
            None => inside[k - count].map(|(place, _)| place - places[k] + along[k]),
        };
        let steps = drawn_along(&(0..places.len()).map(step).collect::<Vec<_>>(), places, self.triangles);
        let speed = |k: usize| match follows.get(k) {
            Some(false) => Some(speeds[k]),
            Some(true) => outside[k].map(|(_, velocity)| velocity),
            None => inside[k - count].map(|(_, velocity)| velocity),
        };
        let velocities = drawn_along(&(0..places.len()).map(speed).collect::<Vec<_>>(), places, self.triangles);
        let place = |k: usize| match follows.get(k) {
            Some(false) => shown[k],
            _ => self.grid.snap(places[k] + steps[k]),
        };
        let mut now: Vec<GridPoint> = (0..places.len()).map(place).collect();
        untangle(&mut now, count, places, self.triangles);
        CarriedCorners { now, velocities }
    }

    /// Where a corner of the boundary is that follows particles: the nearest one where it sees none. None beyond the
    /// grid.
    fn alone(&self, seen: Option<(Point, Vector)>, corner: usize) -> Option<Point> {
        let place = seen.map(|(place, _)| place).or_else(|| self.interior.carried(self.places[corner], self.piece))?;
        (place.coords.amax() <= self.grid.reach()).then_some(place)
    }
}

/// A place beside each of the first `count` of some `places` [m], in that of its triangles with the widest angle there.
fn beside(places: &[Point], count: usize, triangles: &[[u32; 3]]) -> Vec<Point> {
    /// Part of the way to the middle of the triangle.
    const PART: f64 = 0.05;
    let mut found = vec![(0.0, Point::origin()); count];
    (0..count).for_each(|k| found[k].1 = places[k]);
    for triangle in triangles {
        let [a, b, c] = triangle.map(|corner| places[corner as usize]);
        let middle = Point::from((a.coords + b.coords + c.coords) / 3.0);
        for (corner, [at, p, q]) in
            triangle.iter().map(|corner| *corner as usize).zip([[a, b, c], [b, c, a], [c, a, b]])
        {
            let angle = (p - at).angle(&(q - at));
            if corner < count && angle > found[corner].0 {
                found[corner] = (angle, at + PART * (middle - at));
            }
        }
    }
    found.into_iter().map(|(_, place)| place).collect()
}
