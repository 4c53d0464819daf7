//! Crack points with their two faces, and outlines, carried along by the velocities on the grid (thesis 3.1.7).

use super::Updated;
use crate::crack::Crack;
use crate::crack::cracks::{Cracks, TipId};
use crate::crack::crossing::Side;
use crate::faces::outlines::{Outlines, Vertex};
use crate::saved::{self, Fits};
use crate::threads::prelude::*;
use fissure_scene::{CrackEnd, CrackFrame, End, Matrix, OutlineFrame, Point, Vector};
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

impl CrackNow {
    pub(super) fn at_rest(crack: &Crack) -> Self {
        let points = crack.points.clone();
        let still = vec![Vector::zeros(); points.len()];
        Self {
            rest: points.clone(),
            position: points.clone(),
            faces: [points.clone(), points],
            velocities: [still.clone(), still],
        }
    }

    /// Place [m] and velocity [m/s] of the last point of a face, 0 above or 1 below, at an end.
    pub(super) fn face_end(&self, end: End, face: usize) -> (Point, Vector) {
        let k = if end == End::Start { 0 } else { self.position.len() - 1 };
        (self.faces[face][k], self.velocities[face][k])
    }

    /// Whether every list has one entry per crack point.
    pub(super) fn is_even(&self) -> bool {
        let lists = [self.position.len(), self.faces[0].len(), self.faces[1].len()];
        let velocities = [self.velocities[0].len(), self.velocities[1].len()];
        lists.into_iter().chain(velocities).all(|length| length == self.rest.len())
    }

    /// Every number that changes.
    pub(super) fn numbers(&self) -> impl Iterator<Item = &f64> {
        let points = self.position.iter().chain(self.faces.iter().flatten()).flat_map(|p| p.iter());
        points.chain(self.velocities.iter().flatten().flatten())
    }

    /// Takes the place and the motion of the faces of `frame`, which has the same points.
    pub(super) fn take_over(&mut self, frame: &CrackFrame) {
        self.position = frame.above.iter().zip(&frame.below).map(|(a, b)| nalgebra::center(a, b)).collect();
        self.faces = [frame.above.clone(), frame.below.clone()];
        self.velocities = [frame.above_velocity.clone(), frame.below_velocity.clone()];
    }
}

/// A vertex of an outline.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Tracer {
    pub(super) rest: Point,
    pub(super) position: Point,
    pub(super) velocity: Vector,
    /// The end of a crack face that this vertex is, 0 above or 1 below.
    pub(super) face: Option<(TipId, usize)>,
}

impl Vertex for Tracer {
    fn rest(&self) -> Point {
        self.rest
    }

    fn is_at_mouth(&self) -> bool {
        self.face.is_some()
    }
}

impl Tracer {
    fn at_rest(rest: Point) -> Self {
        Self { rest, position: rest, velocity: Vector::zeros(), face: None }
    }

    /// Checks a tracer that was read against so many `cracks`.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(super) fn check(&self, cracks: usize) -> Fits {
        saved::finite("an outline", self.rest.iter().chain(self.position.iter()).chain(&self.velocity))?;
        let Some((id, side)) = self.face else { return Ok(()) };
        id.check(cracks)?;
        saved::ensure(side < SIDES.len(), "an outline")
    }
}

/// The faces, in the order of [`CrackNow::faces`].
const SIDES: [Side; 2] = [Side::Above, Side::Below];

/// How far beside a crack the side of a face point is decided, in cells.
const NUDGE: f64 = 1e-6;

/// Nodes with less than this part of a particle's mass are left out: force over mass is mostly noise there.
const LEAST_MASS: f64 = 1e-3;

/// Within so many cells of a tip particles say how the material there is deformed.
const TIP_REACH: f64 = 2.0;

/// Sums for the value of a velocity field at a place.
///
/// Where all nodes have material this is Σ v_i w_i. Elsewhere it is the linear field that fits the nodes with material best, in the sense of weighted
/// least squares: exact for rigid and any other linear motion.
#[derive(Debug, Clone, Copy, Default)]
struct LinearFit {
    weight: f64,
    arm: Vector,
    spread: Matrix,
    velocity: Vector,
    product: Matrix,
}

impl LinearFit {
    /// `arm`: from the place to the node.
    fn add(&mut self, weight: f64, arm: Vector, velocity: Vector) {
        self.weight += weight;
        self.arm += arm * weight;
        self.spread += arm * arm.transpose() * weight;
        self.velocity += velocity * weight;
        self.product += velocity * arm.transpose() * weight;
    }

    fn value(&self) -> Option<Vector> {
        if self.weight <= 0.0 {
            return None;
        }
        let (arm, mean) = (self.arm / self.weight, self.velocity / self.weight);
        if self.weight > 1.0 - 1e-9 {
            return Some(mean);
        }
        let spread = self.spread - arm * self.arm.transpose();
        let product = self.product - mean * self.arm.transpose();
        // Nodes on one line, or a single one, leave the slope open.
        let flat = spread.determinant() <= 1e-6 * self.spread.trace() * self.spread.trace();
        match spread.try_inverse() {
            Some(inverse) if !flat => Some(mean - product * inverse * arm),
            _ => Some(mean),
        }
    }
}

impl Updated {
    /// Velocity at `place` of the material that a particle at `side` would belong to [m/s]; none where there is none.
    fn velocity_at(&self, place: Point, side: Point) -> Option<Vector> {
        let near = self.division.is_near(side);
        let least = LEAST_MASS * self.particles.mass.first()?;
        let stencil = self.stencil(place);
        let nodes = self.grid.stencil(&stencil);
        let mut fit = LinearFit::default();
        for b in 0..stencil.width {
            for a in 0..stencil.width {
                let w = stencil.weight(a, b);
                let Some(node) = nodes.at(a, b) else { continue };
                let node_place = self.grid.place([stencil.first[0] + a as i32, stencil.first[1] + b as i32]);
                let mut add = |field: usize, w: f64| {
                    if self.nodes.mass[field] > least && w > 0.0 {
                        fit.add(w, node_place - place, self.nodes.velocity(field));
                    }
                };
                if !near {
                    add(node, w);
                    continue;
                }
                for share in self.division.pair(side, node_place) {
                    if let Some(field) = self.cut.fields.find(node, &share.crossed) {
                        add(field, w * share.fraction);
                    }
                }
            }
        }
        fit.value()
    }

    /// Velocity at `place` of the centres of mass of all fields of the nodes [m/s] (thesis eq. 20 and 21).
    fn mean_velocity_at(&self, place: Point) -> Option<Vector> {
        let least = LEAST_MASS * self.particles.mass.first()?;
        let stencil = self.stencil(place);
        let nodes = self.grid.stencil(&stencil);
        let mut fit = LinearFit::default();
        for b in 0..stencil.width {
            for a in 0..stencil.width {
                let Some(node) = nodes.at(a, b) else { continue };
                let node_place = self.grid.place([stencil.first[0] + a as i32, stencil.first[1] + b as i32]);
                let mut mass = self.nodes.mass[node];
                let mut momentum = self.nodes.velocity(node) * mass;
                for field in self.cut.fields.of(node).iter().rev().map(|&field| field as usize) {
                    mass += self.nodes.mass[field];
                    momentum += self.nodes.velocity(field) * self.nodes.mass[field];
                }
                let w = stencil.weight(a, b);
                if mass > least && w > 0.0 {
                    fit.add(w, node_place - place, momentum / mass);
                }
            }
        }
        fit.value()
    }

    /// Moves crack points by the centre-of-mass velocity and their faces by the fields above and below (thesis eq. 22 to 24).
    pub(super) fn move_cracks(&mut self, cracks: &Cracks, time_step: f64) {
        let mut all = std::mem::take(&mut self.state.cracks);
        for (crack, now) in cracks.iter().zip(&mut all) {
            let last = now.position.len() - 1;
            let velocities: Vec<[Vector; 3]> =
                (0..last + 1).into_par_iter().with_min_len(64).map(|k| self.crack_point_velocities(now, k)).collect();
            for (k, [mean, above, below]) in velocities.into_iter().enumerate() {
                let is_tip = (k == 0 && crack.end(End::Start) == CrackEnd::Tip)
                    || (k == last && crack.end(End::End) == CrackEnd::Tip);
                now.position[k] += mean * time_step;
                for (side, v) in [above, below].into_iter().enumerate() {
                    // The faces meet at a tip.
                    let v = if is_tip { mean } else { v };
                    now.velocities[side][k] = v;
                    now.faces[side][k] = if is_tip { now.position[k] } else { now.faces[side][k] + v * time_step };
                }
            }
        }
        self.state.cracks = all;
    }

    /// Velocity of a crack point and of its faces above and below.
    fn crack_point_velocities(&self, now: &CrackNow, k: usize) -> [Vector; 3] {
        let place = now.position[k];
        let (before, after) = (now.position[k.saturating_sub(1)], now.position[(k + 1).min(now.position.len() - 1)]);
        let along = after - before;
        let length = along.norm();
        let normal = if length > 0.0 { Vector::new(-along.y, along.x) / length } else { Vector::zeros() };
        let hair = NUDGE * self.scene.cell_size;
        let faces = [0, 1].map(|side| {
            let face = now.faces[side][k];
            let out = normal * SIDES[side].sign();
            // At least a hair beside the crack line, even where the faces overlap.
            let height = (face - place).dot(&out);
            self.velocity_at(face, face + out * (hair - height).max(0.0))
        });
        let mean = self.mean_velocity_at(place);
        let still = Vector::zeros();
        let middle = match faces {
            [Some(a), Some(b)] => (a + b) * 0.5,
            [Some(v), None] | [None, Some(v)] => v,
            _ => still,
        };
        let mean = mean.unwrap_or(middle);
        [mean, faces[0].unwrap_or(mean), faces[1].unwrap_or(mean)]
    }

    /// Moves the vertices of outlines with the material they belong to.
    pub(super) fn move_outlines(&mut self, time_step: f64) {
        let outlines = &self.state.outlines;
        // The ends of crack faces move with these; out of all material a vertex goes on as it went.
        let velocity = |t: &Tracer| {
            if t.face.is_some() { None } else { Some(self.velocity_at(t.position, t.position).unwrap_or(t.velocity)) }
        };
        let velocities: Vec<Vec<Option<Vector>>> =
            outlines.rings().map(|ring| ring.par_iter().with_min_len(256).map(velocity).collect()).collect();
        for (t, velocity) in self.state.outlines.vertices_mut().zip(velocities.into_iter().flatten()) {
            if let Some(velocity) = velocity {
                t.velocity = velocity;
                t.position += t.velocity * time_step;
            }
        }
    }

    /// Lays the outlines at rest.
    pub(super) fn lay_outlines(&mut self, cracks: &Cracks) {
        self.state.outlines = Outlines::at_rest(&self.scene, Tracer::at_rest);
        for id in cracks.ids().filter(|&id| cracks.end(id) == CrackEnd::Mouth) {
            self.open_mouth(cracks, id);
        }
    }

    /// Takes the place and the motion of the outlines of `frames`: vertices are known by their rest positions, those at mouths by the crack faces they end.
    pub(super) fn take_over_outlines(&mut self, frames: &[OutlineFrame]) {
        for (ring, frame) in self.state.outlines.rings_mut().zip(frames) {
            for tracer in ring {
                if let Some((id, face)) = tracer.face {
                    (tracer.position, tracer.velocity) = self.state.cracks[id.crack].face_end(id.end, face);
                } else if let Some(k) = frame.rest.iter().position(|&p| p == tracer.rest) {
                    tracer.position = frame.position[k];
                    tracer.velocity = frame.velocity[k];
                }
            }
        }
    }

    /// Doubles the outline where a crack mouths at it: the two new vertices are the end points of the faces.
    fn open_mouth(&mut self, cracks: &Cracks, id: TipId) {
        let place = cracks.position(id);
        let face = |face| Tracer { face: Some((id, face)), ..Tracer::at_rest(place) };
        self.state.outlines.open_mouth(place, id.end, [face(0), face(1)], self.scene.cell_size);
    }

    /// Takes up new crack points, new cracks and new kinds of ends. Particles keep what they carry, so momentum is untouched.
    pub(super) fn take_up(&mut self, cracks: &Cracks, changed: &[TipId]) {
        for (index, crack) in cracks.iter().enumerate() {
            if index >= self.state.cracks.len() {
                let now = self.born(crack);
                self.state.cracks.push(now);
            } else if self.state.cracks[index].rest != crack.points {
                self.state.cracks[index] = self.grown(&self.state.cracks[index], crack);
            }
        }
        for &id in changed {
            let is_open = self.state.outlines.vertices().filter_map(|t| t.face).any(|(of, _)| of == id);
            if cracks.end(id) == CrackEnd::Mouth && !is_open {
                self.open_mouth(cracks, id);
            }
        }
        self.division = self.division_now(cracks);
    }

    /// A crack that has just been born, where the material at its points is.
    fn born(&self, crack: &Crack) -> CrackNow {
        let mut now = CrackNow::at_rest(crack);
        for k in 0..crack.points.len() {
            let place = self.carried(crack, crack.points[k], None);
            now.position[k] = place;
            for face in &mut now.faces {
                face[k] = place;
            }
        }
        now
    }

    /// A crack with the points of `crack`: those that `old` had stay where they are.
    fn grown(&self, old: &CrackNow, crack: &Crack) -> CrackNow {
        let mut now = CrackNow::at_rest(crack);
        let place_of = |k: usize| old.rest.iter().position(|&r| r == crack.points[k]);
        let known: Vec<Option<usize>> = (0..crack.points.len()).map(place_of).collect();
        for k in 0..crack.points.len() {
            if let Some(from) = known[k] {
                now.position[k] = old.position[from];
                for side in 0..2 {
                    now.faces[side][k] = old.faces[side][from];
                    now.velocities[side][k] = old.velocities[side][from];
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
                    now.position[k] = between(&old.position);
                    for side in 0..2 {
                        now.faces[side][k] = between(&old.faces[side]);
                        let v = &old.velocities[side];
                        now.velocities[side][k] = v[a] + (v[b] - v[a]) * t;
                    }
                }
                // Beyond an end: as the material around the old tip is deformed.
                (Some((_, from)), None) | (None, Some((_, from))) => {
                    let place = self.carried(crack, crack.points[k], Some((old.rest[from], old.position[from])));
                    now.position[k] = place;
                    for side in 0..2 {
                        now.faces[side][k] = place;
                        now.velocities[side][k] = old.velocities[side][from];
                    }
                }
                (None, None) => {}
            }
        }
        now
    }

    /// Where the place `rest` is now: `from` (rest, now) plus F times the way, with the mean F of the particles near it; without `from`, as
    /// the nearest particle is.
    fn carried(&self, crack: &Crack, rest: Point, from: Option<(Point, Point)>) -> Point {
        let center = from.map_or(rest, |f| f.0);
        let reach_squared = (TIP_REACH * self.scene.cell_size).powi(2);
        let (mut mean, mut count) = (Matrix::zeros(), 0.0);
        let mut nearest: Option<(f64, usize)> = None;
        for p in 0..self.particles.len() {
            if self.particles.body[p] != crack.body {
                continue;
            }
            let distance = (self.particles.rest[p] - center).norm_squared();
            if distance < reach_squared {
                mean += self.total_gradient(p);
                count += 1.0;
            }
            if nearest.is_none_or(|n| distance < n.0) {
                nearest = Some((distance, p));
            }
        }
        let Some((_, p)) = nearest else { return rest };
        let h = if count > 0.0 { mean / count } else { self.total_gradient(p) };
        let (start, now) = from.unwrap_or((self.particles.rest[p], self.state.points[p].position));
        let way = rest - start;
        now + way + h * way
    }
}
