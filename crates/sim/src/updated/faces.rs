//! The faces of cracks: where they are now, and how they move with the material (thesis 3.1.7).

use super::material_velocity::MaterialVelocity;
use super::points::Points;
use super::setup::Setup;
use super::tracer::{SIDES, Tracer};
use crate::SimulationError;
use crate::crack::cracks::{Cracks, TipId};
use crate::crack::division::{Division, TipCut};
use crate::crack::{Crack, left_at};
use crate::faces::outlines::Outlines;
use crate::grid::kernel;
use crate::saved::{self, Fits};
use crate::solver::Continuation;
use crate::threads::prelude::*;
use fissure_scene::{CrackEnd, CrackFrame, End, Matrix, Point, Scene, Vector};
use serde::{Deserialize, Serialize};

/// Where a crack is now. One entry per crack point in every list.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct CrackNow {
    /// Rest positions [m], as the crack itself has them.
    pub(super) rest: Vec<Point>,
    /// Positions of the crack line [m]; it divides the pairs.
    pub(super) position: Vec<Point>,
    /// Positions of the faces x_a and x_b [m].
    pub(super) faces: [Vec<Point>; 2],
    /// Velocities of the faces [m/s].
    pub(super) velocities: [Vec<Vector>; 2],
}

/// What of cracks and bodies is carried along: the faces of all cracks, and the rings of all bodies.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Faces {
    pub(super) cracks: Vec<CrackNow>,
    /// Doubled at mouths.
    pub(super) outlines: Outlines<Tracer>,
}

/// How far beside a crack the side of a face point is decided, in cells.
const NUDGE: f64 = 1e-6;

/// Within so many cells of a tip particles say how the material there is deformed.
const TIP_REACH: f64 = 2.0;

impl CrackNow {
    fn at_rest(crack: &Crack) -> Self {
        let points = crack.points.clone();
        let still = vec![Vector::zeros(); points.len()];
        Self {
            rest: points.clone(),
            position: points.clone(),
            faces: [points.clone(), points],
            velocities: [still.clone(), still],
        }
    }

    /// Whether every list has one entry per crack point.
    fn is_even(&self) -> bool {
        let lists = [self.position.len(), self.faces[0].len(), self.faces[1].len()];
        let velocities = [self.velocities[0].len(), self.velocities[1].len()];
        lists.into_iter().chain(velocities).all(|length| length == self.rest.len())
    }

    /// Every number that changes.
    fn numbers(&self) -> impl Iterator<Item = &f64> {
        let points = self.position.iter().chain(self.faces.iter().flatten()).flat_map(|p| p.iter());
        points.chain(self.velocities.iter().flatten().flatten())
    }

    /// Place [m] and velocity [m/s] of the last point of a face, 0 above or 1 below, at an end.
    pub(super) fn face_end(&self, end: End, face: usize) -> (Point, Vector) {
        let k = if end == End::Start { 0 } else { self.position.len() - 1 };
        (self.faces[face][k], self.velocities[face][k])
    }

    /// Goes where `frame` is, which has the same points.
    fn set(&mut self, frame: &CrackFrame) {
        self.position = frame.above.iter().zip(&frame.below).map(|(a, b)| nalgebra::center(a, b)).collect();
        self.faces = [frame.above.clone(), frame.below.clone()];
        self.velocities = [frame.above_velocity.clone(), frame.below_velocity.clone()];
    }

    /// Crack points from a tip backwards.
    fn backwards(&self, end: End) -> Vec<usize> {
        let n = self.position.len();
        match end {
            End::End => (0..n).rev().collect(),
            End::Start => (0..n).collect(),
        }
    }

    /// Opening of the faces at the distance `wanted` [m] behind a tip, or as far as the crack goes: left minus right as
    /// seen from the tip looking ahead [m], and that distance [m].
    pub(super) fn opening(&self, end: End, wanted: f64) -> (Vector, f64) {
        // Above is the left side for one who walks to the end of the crack.
        let sign = if end == End::End { 1.0 } else { -1.0 };
        let jump = |k: usize| (self.faces[0][k] - self.faces[1][k]) * sign;
        let mut distance = 0.0;
        let mut last = (Vector::zeros(), 0.0);
        for w in self.backwards(end).windows(2) {
            let length = (self.position[w[1]] - self.position[w[0]]).norm();
            if distance + length >= wanted {
                let t = (wanted - distance) / length;
                return (jump(w[0]) * (1.0 - t) + jump(w[1]) * t, wanted);
            }
            distance += length;
            last = (jump(w[1]), distance);
        }
        last
    }

    /// Moves the points by the velocity of the centres of mass and their faces by the fields above and below (thesis
    /// eq. 22 to 24).
    fn advance(&mut self, crack: &Crack, material: &MaterialVelocity<'_>, time_step: f64) {
        let last = self.position.len() - 1;
        let now = &*self;
        let velocities: Vec<[Vector; 3]> =
            (0..last + 1).into_par_iter().with_min_len(64).map(|k| now.velocities_at(k, material)).collect();
        for (k, [mean, above, below]) in velocities.into_iter().enumerate() {
            let is_tip = (k == 0 && crack.end(End::Start) == CrackEnd::Tip)
                || (k == last && crack.end(End::End) == CrackEnd::Tip);
            self.position[k] += mean * time_step;
            for (side, v) in [above, below].into_iter().enumerate() {
                // The faces meet at a tip.
                let v = if is_tip { mean } else { v };
                self.velocities[side][k] = v;
                self.faces[side][k] = if is_tip { self.position[k] } else { self.faces[side][k] + v * time_step };
            }
        }
    }

    /// Velocity of a crack point and of its faces above and below.
    fn velocities_at(&self, k: usize, material: &MaterialVelocity<'_>) -> [Vector; 3] {
        let place = self.position[k];
        let left = left_at(&self.position, k);
        let hair = NUDGE * material.setup.scene.cell_size;
        let faces = [0, 1].map(|side| {
            let face = self.faces[side][k];
            let out = left * SIDES[side].sign();
            // At least a hair beside the crack line, even where the faces overlap.
            let height = (face - place).dot(&out);
            material.at(face, face + out * (hair - height).max(0.0))
        });
        let mean = material.mean_at(place);
        let still = Vector::zeros();
        let middle = match faces {
            [Some(a), Some(b)] => (a + b) * 0.5,
            [Some(v), None] | [None, Some(v)] => v,
            _ => still,
        };
        let mean = mean.unwrap_or(middle);
        [mean, faces[0].unwrap_or(mean), faces[1].unwrap_or(mean)]
    }

    /// The crack with the points of `crack`: those that it has stay where they are, those beyond an end lie where
    /// `carried` puts a place at rest, going out from a point of this crack.
    fn with_points_of(&self, crack: &Crack, carried: impl Fn(Point, usize) -> Point) -> Self {
        let mut now = Self::at_rest(crack);
        let place_of = |k: usize| self.rest.iter().position(|&r| r == crack.points[k]);
        let known: Vec<Option<usize>> = (0..crack.points.len()).map(place_of).collect();
        for k in 0..crack.points.len() {
            if let Some(from) = known[k] {
                now.position[k] = self.position[from];
                for side in 0..2 {
                    now.faces[side][k] = self.faces[side][from];
                    now.velocities[side][k] = self.velocities[side][from];
                }
                continue;
            }
            let before = (0..k).rev().find_map(|i| known[i].map(|from| (i, from)));
            let after = (k + 1..known.len()).find_map(|i| known[i].map(|from| (i, from)));
            match (before, after) {
                // Within the crack: between its neighbours.
                (Some((i, a)), Some((j, b))) => {
                    let along = crack.points[j] - crack.points[i];
                    let t = ((crack.points[k] - crack.points[i]).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
                    let between = |points: &[Point]| points[a] + (points[b] - points[a]) * t;
                    now.position[k] = between(&self.position);
                    for side in 0..2 {
                        now.faces[side][k] = between(&self.faces[side]);
                        let v = &self.velocities[side];
                        now.velocities[side][k] = v[a] + (v[b] - v[a]) * t;
                    }
                }
                // Beyond an end: as the material around the old tip is deformed.
                (Some((_, from)), None) | (None, Some((_, from))) => {
                    let place = carried(crack.points[k], from);
                    now.position[k] = place;
                    for side in 0..2 {
                        now.faces[side][k] = place;
                        now.velocities[side][k] = self.velocities[side][from];
                    }
                }
                (None, None) => {}
            }
        }
        now
    }
}

impl Faces {
    /// Cracks and outlines at rest.
    pub(super) fn at_rest(scene: &Scene, cracks: &Cracks) -> Self {
        let mut faces = Self {
            cracks: cracks.iter().map(CrackNow::at_rest).collect(),
            outlines: Outlines::at_rest(scene, |_, place| Tracer::at_rest(place)),
        };
        for id in cracks.ids().filter(|&id| cracks.end(id) == CrackEnd::Mouth) {
            faces.open_mouth(cracks, id, scene.cell_size);
        }
        faces
    }

    /// Goes where the cracks and outlines of the other formulation are.
    pub(super) fn set(&mut self, continuation: &Continuation) {
        for (now, frame) in self.cracks.iter_mut().zip(&continuation.cracks) {
            now.set(frame);
        }
        self.set_outlines(&continuation.outlines);
    }

    /// Checks what was read: that its numbers are finite, that it fits the scene and the cracks, and that no crack
    /// reaches farther than one may among so many `particles`.
    ///
    /// # Errors
    /// [`SimulationError::BadState`]
    pub(super) fn check(&self, scene: &Scene, cracks: &Cracks, particles: usize) -> Fits {
        let fits = |(now, crack): (&CrackNow, &Crack)| now.rest == crack.points && now.is_even();
        let same = self.cracks.len() == cracks.len() && self.cracks.iter().zip(cracks.iter()).all(fits);
        saved::ensure(same, "the place of a crack")?;
        self.cracks.iter().try_for_each(|now| saved::finite("a crack", now.numbers()))?;
        saved::ensure(self.holds_together(scene.cell_size, particles), "the length of a crack")?;
        self.outlines.check(scene)?;
        self.outlines.vertices().try_for_each(|tracer| tracer.check(cracks.len()))
    }

    /// Cells in the boxes around the segments of all cracks where they are now: what a division lists.
    fn crack_cells(&self, cell_size: f64) -> f64 {
        let segments = self.cracks.iter().flat_map(|now| now.position.windows(2));
        segments.map(|w| ((w[1] - w[0]).abs() / cell_size).add_scalar(1.0).product()).sum()
    }

    /// Whether cracks reach over no more cells than may lie in bodies of so many `particles`, and far more. A division
    /// takes some hundred bytes for each.
    fn holds_together(&self, cell_size: f64, particles: usize) -> bool {
        self.crack_cells(cell_size) <= (4.0 * particles as f64).max(1e5)
    }

    /// Checks that no crack has been torn apart at `time` [s].
    ///
    /// # Errors
    /// [`SimulationError::Unstable`] with the longest segment.
    pub(super) fn check_length(&self, setup: &Setup, time: f64) -> Result<(), SimulationError> {
        if self.holds_together(setup.scene.cell_size, setup.particles.len()) {
            return Ok(());
        }
        let segments = self.cracks.iter().flat_map(|now| now.position.windows(2));
        let longest = segments.max_by(|a, b| (a[1] - a[0]).norm().total_cmp(&(b[1] - b[0]).norm()));
        let (a, b) = longest.map_or((Point::origin(), Point::origin()), |w| (w[0], w[1]));
        let cause = format!(
            "the material has torn a crack apart, from there to ({:e}, {:e}) m; end the run before (`frames.last`), or \
             use a smaller `solver.courant` if it was thrown off",
            b.x, b.y
        );
        Err(SimulationError::Unstable { time, x: a.x, y: a.y, cause })
    }

    /// The cracks where they are now, ready to divide pairs.
    pub(super) fn division(&self, setup: &Setup, cracks: &Cracks) -> Division {
        let scene = &setup.scene;
        let reach = kernel::reach(scene.solver.kernel);
        // Lines that are torn too long end the next step; till then they lie at rest.
        let holds = self.holds_together(setup.scene.cell_size, setup.particles.len());
        let points = |i: usize, crack: &Crack| {
            let points = if holds { &self.cracks[i].position } else { &crack.points };
            points.clone()
        };
        let lines = cracks.lines(points, reach * scene.cell_size);
        let tip_division = scene.solver.tip_division;
        Division::new(
            lines,
            tip_division,
            TipCut::smooth(scene.solver.kernel),
            scene.cell_size,
            scene.particle_spacing,
            reach,
        )
    }

    /// Moves crack points and their faces with the material.
    pub(super) fn advance_cracks(&mut self, cracks: &Cracks, material: &MaterialVelocity<'_>, time_step: f64) {
        for (crack, now) in cracks.iter().zip(&mut self.cracks) {
            now.advance(crack, material, time_step);
        }
    }

    /// Follows `cracks` that have got new points, new ends where `changed` says so, or are new themselves.
    pub(super) fn follow(&mut self, cracks: &Cracks, changed: &[TipId], setup: &Setup, points: &Points) {
        for (index, crack) in cracks.iter().enumerate() {
            match self.cracks.get_mut(index) {
                None => self.cracks.push(born(crack, setup, points)),
                Some(old) if old.rest != crack.points => {
                    let carried = |rest, from: usize| {
                        carried(setup, points, crack, rest, Some((old.rest[from], old.position[from])))
                    };
                    *old = old.with_points_of(crack, carried);
                }
                Some(_) => {}
            }
        }
        for &id in changed {
            let is_open = self.outlines.vertices().filter_map(|t| t.face).any(|(of, _)| of == id);
            if cracks.end(id) == CrackEnd::Mouth && !is_open {
                self.open_mouth(cracks, id, setup.scene.cell_size);
            }
        }
    }
}

/// A crack that has just been born, where the material at its points is.
fn born(crack: &Crack, setup: &Setup, points: &Points) -> CrackNow {
    let mut now = CrackNow::at_rest(crack);
    for k in 0..crack.points.len() {
        let place = carried(setup, points, crack, crack.points[k], None);
        now.position[k] = place;
        for face in &mut now.faces {
            face[k] = place;
        }
    }
    now
}

/// Where the place `rest` is now: `from` (rest, now) plus F times the way, with the mean F of the particles near it;
/// without `from`, as the nearest particle is.
fn carried(setup: &Setup, points: &Points, crack: &Crack, rest: Point, from: Option<(Point, Point)>) -> Point {
    let particles = &setup.particles;
    let center = from.map_or(rest, |f| f.0);
    let reach_squared = (TIP_REACH * setup.scene.cell_size).powi(2);
    let (mut mean, mut count) = (Matrix::zeros(), 0.0);
    let mut nearest: Option<(f64, usize)> = None;
    for p in 0..particles.len() {
        if particles.body[p] != crack.body {
            continue;
        }
        let distance = (particles.rest[p] - center).norm_squared();
        if distance < reach_squared {
            mean += points.total_gradient(p);
            count += 1.0;
        }
        if nearest.is_none_or(|n| distance < n.0) {
            nearest = Some((distance, p));
        }
    }
    let Some((_, p)) = nearest else { return rest };
    let h = if count > 0.0 { mean / count } else { points.total_gradient(p) };
    let (start, now) = from.unwrap_or((particles.rest[p], points.point[p].position));
    let way = rest - start;
    now + way + h * way
}
