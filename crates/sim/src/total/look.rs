//! Looking at the solver: what is around a tip, what a frame holds, whether the run is still sound, how large a step may be.

use super::cut::Probe;
use super::reader::Rates;
use super::{FieldVectors, Total, left_of_tip};
use crate::SimulationError;
use crate::crack::DIRECTION_LENGTH;
use crate::crack::cracks::{Cracks, TipId};
use crate::faces::crack_frame::crack_frame;
use crate::material::constitutive::principal_stretches;
use crate::solver::Observed;
use crate::tip::frame::{side_of, tip_of, turn};
use crate::tip::zone::{FaceContact, QuadraturePoint, TipZone};
use fissure_scene::{CrackFrame, End, Matrix, OutlineFrame, ParticleFrame, Point, Vector};

/// A moment in the middle of a step: displacements and accelerations of the step's beginning, velocities half a step later.
#[derive(Debug)]
pub(super) struct Moment<'a> {
    pub(super) solver: &'a Total,
    /// Time by which velocities are ahead [s].
    pub(super) half_step: f64,
}

/// Steps between two checks that everything is still finite and in range.
const STEPS_BETWEEN_CHECKS: u32 = 8;
/// Volume ratio below which the total Lagrangian formulation is out of its range.
const SMALLEST_VOLUME_RATIO: f64 = 0.2;
/// Principal stretch above which it is.
const LARGEST_STRETCH: f64 = 3.0;
/// With no component of H above this, ‖H‖ is at most twice it, so that the singular values of F lie between 0.5 and 1.5 and det F is at least 0.25: within
/// the range.
const SOUND_STRAIN: f64 = 0.25;
/// Rounds of the Lanczos iteration. On a plate of 20 × 40 cells with an edge crack 40 rounds give 3.4910e8 1/s², 300 rounds 3.4914e8.
const LANCZOS_ROUNDS: usize = 40;
/// What the largest Ritz value may still miss.
const RITZ_MARGIN: f64 = 1.01;

impl Observed for Moment<'_> {
    fn tip_zone(&self, cracks: &Cracks, id: TipId, radius: f64) -> TipZone {
        self.solver.zone(cracks, id, radius, self.half_step)
    }

    fn tip_now(&self, cracks: &Cracks, id: TipId) -> (Point, Vector) {
        self.solver.tip_now(cracks, id)
    }
}

impl Observed for Total {
    fn tip_zone(&self, cracks: &Cracks, id: TipId, radius: f64) -> TipZone {
        self.zone(cracks, id, radius, 0.0)
    }

    fn tip_now(&self, cracks: &Cracks, id: TipId) -> (Point, Vector) {
        let faces = &self.state.faces[id.crack];
        let now: Vec<Point> = faces[0]
            .iter()
            .zip(&faces[1])
            .map(|(above, below)| nalgebra::center(&self.moved(above), &self.moved(below)))
            .collect();
        tip_of(cracks, id, &now, self.grid.cell_size)
    }
}

impl Total {
    fn zone(&self, cracks: &Cracks, id: TipId, radius: f64, half_step: f64) -> TipZone {
        let line = cracks.of(id);
        let tip = cracks.position(id);
        let ahead = cracks.ahead(id, DIRECTION_LENGTH * self.grid.cell_size);
        let s = self.particles.spacing;
        let center = (tip - self.particles.anchor) / s;
        let reach = (radius / s).ceil() as i32 + 1;
        let center = [center.x.floor() as i32, center.y.floor() as i32];
        let mut found: Vec<(usize, Matrix)> = Vec::new();
        let mut mean = Matrix::zeros();
        let mut reader = self.reader();
        for p in self.particles.within(center.map(|c| c.saturating_sub(reach)), center.map(|c| c.saturating_add(reach)))
        {
            if (self.particles.rest[p] - tip).norm_squared() < radius * radius && self.particles.body[p] == line.body {
                let h = reader.strain(p);
                mean += h;
                found.push((p, h));
            }
        }
        let mean = mean / found.len().max(1) as f64;
        // Rigid turn R of the surroundings (polar decomposition of the mean F), then into the tip frame.
        let (rotation, _) = turn(2.0 + mean.m11 + mean.m22, mean.m21 - mean.m12);
        let back = rotation.transpose();
        let (_, back_minus_one) = turn(2.0 + mean.m11 + mean.m22, mean.m12 - mean.m21);
        let frame = Matrix::new(ahead.x, ahead.y, -ahead.y, ahead.x);
        let mut points = Vec::with_capacity(found.len());
        for (p, h) in found {
            let e = &self.elastic[self.particles.material[p] as usize];
            let arm = self.particles.rest[p] - tip;
            let into = |m: Matrix| frame * m * frame.transpose();
            let Rates { velocity, velocity_gradient, acceleration } = reader.rates(p);
            let velocity = velocity - acceleration * half_step;
            points.push(QuadraturePoint {
                place: frame * arm,
                side: side_of(&line.points, id.end, ahead, self.particles.rest[p]),
                volume: self.particles.volume[p],
                stress: into(back * crate::first_piola_stress(&h, e.mu, e.lambda)),
                gradient: into(back * h + back_minus_one),
                energy: crate::energy_density(&h, e.mu, e.lambda),
                density: e.density,
                velocity: frame * (back * velocity),
                velocity_slope: frame * (back * (velocity_gradient * ahead)),
                acceleration: frame * (back * acceleration),
                material: self.particles.material[p],
            });
        }
        let (opening, opening_distance) = self.opening(cracks, id, frame * back);
        let into = frame * back;
        let sign = left_of_tip(id.end).sign();
        let contacts = self
            .face_forces(id.crack)
            // Elsewhere the crack may have come back behind the tip.
            .filter(|(place, _)| (place - tip).norm() < radius + 2.0 * self.grid.cell_size)
            .map(|(place, force)| FaceContact { behind: (tip - place).dot(&ahead), force: into * force * sign })
            .collect();
        TipZone { points, contacts, opening, opening_distance }
    }

    /// Opening of the faces some way behind a tip, in the tip frame, and that distance.
    fn opening(&self, cracks: &Cracks, id: TipId, into: Matrix) -> (Vector, f64) {
        let line = cracks.of(id);
        // 1 to 3 cells behind the tip: nearer, the tip's own discretisation shows; farther, the next term of the series.
        let wanted = 1.5 * self.grid.cell_size;
        let n = line.points.len();
        let mut distance = 0.0;
        let order: Vec<usize> = match id.end {
            End::End => (0..n).rev().collect(),
            End::Start => (0..n).collect(),
        };
        for w in order.windows(2) {
            let (from, to) = (line.points[w[0]], line.points[w[1]]);
            let length = (to - from).norm();
            if distance + length >= wanted {
                let t = (wanted - distance) / length;
                let jump = |k: usize| {
                    let [above, below] = &self.state.faces[id.crack];
                    above[k].value(&self.state.displacement) - below[k].value(&self.state.displacement)
                };
                // The probe between two crack points, a hair beside the crack.
                let place = from + (to - from) * t;
                let tangent = (to - from) / length;
                let hair = Vector::new(-tangent.y, tangent.x) * (1e-6 * self.grid.cell_size);
                // Seen from the tip looking ahead, left and right are the other way round.
                let [left, right] = [-hair, hair];
                let value = |offset: Vector| -> Option<Vector> {
                    let entries = self.probe_entries(place, place + offset);
                    (!entries.is_empty())
                        .then(|| Probe { rest: place, nudged: place + offset, entries }.value(&self.state.displacement))
                };
                if let (Some(a), Some(b)) = (value(left), value(right)) {
                    return (into * (a - b), wanted);
                }
                let sign = left_of_tip(id.end).sign();
                return (into * (jump(w[1]) * sign), distance + length);
            }
            distance += length;
        }
        (Vector::zeros(), 0.0)
    }

    /// Checks now and then that the run is sound.
    pub(super) fn watch(&mut self, time: f64) -> Result<(), SimulationError> {
        self.steps_since_check += 1;
        if self.steps_since_check < STEPS_BETWEEN_CHECKS {
            return Ok(());
        }
        self.steps_since_check = 0;
        self.check_range(time)
    }

    /// Largest difference of displacement along an edge of an uncut cell, over its length. A bound for every such cell: no component of H in it is larger. NaN
    /// gives infinity.
    fn largest_edge_strain(&self) -> f64 {
        let mut largest = 0.0_f64;
        for u in &self.state.displacement {
            let mut look = |a: f64, b: f64| {
                let difference = (a - b).abs();
                largest = if difference <= f64::MAX { largest.max(difference) } else { f64::INFINITY };
            };
            for run in self.state.runs.iter().flatten() {
                let [lower, upper] =
                    [run.lower, run.upper].map(|first| &u[first as usize..(first + run.count + 1) as usize]);
                [lower, upper].into_iter().for_each(|row| row.windows(2).for_each(|w| look(w[0], w[1])));
                lower.iter().zip(upper).for_each(|(a, b)| look(*a, *b));
            }
        }
        largest / self.grid.cell_size
    }

    /// Whether every particle is finite and within the range of the formulation.
    pub(super) fn check_range(&self, time: f64) -> Result<(), SimulationError> {
        let whole_cells_are_sound = self.largest_edge_strain() < SOUND_STRAIN;
        let mut reader = self.reader();
        for p in 0..self.particles.len() {
            if whole_cells_are_sound && self.state.cut.entries_of(p).is_none() {
                continue;
            }
            let motion = reader.motion(p);
            let (h, place) = (motion.strain, self.particles.rest[p] + motion.displacement);
            let fail = |cause: String| SimulationError::Unstable { time, x: place.x, y: place.y, cause };
            let volume_ratio = 1.0 + crate::volume_change(&h);
            if !volume_ratio.is_finite() {
                return Err(fail(format!(
                    "particle {p} has lost its finite state; use a smaller `solver.courant` or weaker loads"
                )));
            }
            let [stretch, _] = principal_stretches(&h);
            if volume_ratio < SMALLEST_VOLUME_RATIO || stretch > LARGEST_STRETCH {
                return Err(SimulationError::OutOfRange {
                    time,
                    x: place.x,
                    y: place.y,
                    cause: format!(
                        "particle {p} is stretched to {stretch:.2} with a volume ratio of {volume_ratio:.2}, out of the range of the \
                         total Lagrangian formulation (below {LARGEST_STRETCH} and above {SMALLEST_VOLUME_RATIO})"
                    ),
                });
            }
        }
        Ok(())
    }

    /// Largest stable step 2/ω_max [s] of the linearised discrete operator, cut cells included.
    ///
    /// Lanczos iteration on M^-½ K M^-½: its largest Ritz value closes in on ω_max² from below, much faster than a power iteration (Parlett 1998).
    pub(super) fn lanczos_time_step(&self) -> f64 {
        let fields = self.state.mass.len();
        let root: Vec<f64> = self.inverse_mass.iter().map(|m| m.sqrt()).collect();
        // A fixed start with all wavelengths in it, the shortest most, and the divided nodes, where the stiffest modes sit, stressed.
        let mut q: FieldVectors = [0, 1].map(|axis: i32| {
            self.places_of_fields()
                .enumerate()
                .map(|(d, [i, j])| {
                    if root[d] == 0.0 {
                        return 0.0;
                    }
                    let sign = if (i + axis * (i + j)) & 1 == 0 { 1.0 } else { -1.0 };
                    // Numbered as if all nodes of the box were there, so that it is the same however much of it is empty.
                    let number = match d.checked_sub(self.grid.len()) {
                        None => self.grid.number_in_box([i, j]),
                        Some(further) => self.grid.nodes_of_box() + further as i64,
                    };
                    let jitter = (number.rem_euclid(1009) * 7919 + i64::from(axis) * 104_729) % 1009;
                    let jitter = jitter as f64 / 1009.0;
                    let divided = if d >= self.grid.len() { 4.0 } else { 1.0 };
                    sign * (0.5 + jitter) * divided
                })
                .collect()
        });
        let dot = |a: &FieldVectors, b: &FieldVectors| -> f64 {
            a.iter().flatten().zip(b.iter().flatten()).map(|(x, y)| x * y).sum()
        };
        let norm = dot(&q, &q).sqrt();
        if norm == 0.0 {
            return f64::INFINITY;
        }
        q.iter_mut().flatten().for_each(|x| *x /= norm);
        let mut before: FieldVectors = [vec![0.0; fields], vec![0.0; fields]];
        let mut scaled = before.clone();
        let mut force: FieldVectors = [Vec::new(), Vec::new()];
        let (mut alphas, mut betas): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
        for _ in 0..LANCZOS_ROUNDS {
            // K M^-½ q by the forces of a displacement so small that the law is linear to round-off.
            let biggest = (0..2).flat_map(|a| q[a].iter().zip(&root)).fold(0.0_f64, |m, (x, r)| m.max((x * r).abs()));
            if biggest == 0.0 {
                break;
            }
            let amplitude = 1e-7 * self.grid.cell_size / biggest;
            for axis in 0..2 {
                for d in 0..fields {
                    scaled[axis][d] = q[axis][d] * root[d] * amplitude;
                }
            }
            self.lattice_forces(&scaled, false, &mut force);
            let beta = betas.last().copied().unwrap_or(0.0);
            for axis in 0..2 {
                for d in 0..fields {
                    force[axis][d] = -force[axis][d] * root[d] / amplitude - beta * before[axis][d];
                }
            }
            let alpha = dot(&force, &q);
            for axis in 0..2 {
                for d in 0..fields {
                    force[axis][d] -= alpha * q[axis][d];
                }
            }
            alphas.push(alpha);
            let beta = dot(&force, &force).sqrt();
            if beta <= 1e-12 * alpha.abs() {
                break;
            }
            betas.push(beta);
            force.iter_mut().flatten().for_each(|x| *x /= beta);
            std::mem::swap(&mut before, &mut q);
            std::mem::swap(&mut q, &mut force);
        }
        let n = alphas.len();
        let tridiagonal = nalgebra::DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
            0 => alphas[i],
            1 => betas[i.min(j)],
            _ => 0.0,
        });
        let largest = tridiagonal.symmetric_eigenvalues().max();
        2.0 / (RITZ_MARGIN * largest).sqrt()
    }

    pub(super) fn frame_of_particles(&self) -> ParticleFrame {
        let n = self.particles.len();
        let mut frame = ParticleFrame {
            id: (0..n as u32).collect(),
            body: self.particles.body.clone(),
            piece: vec![0; n],
            rest: self.particles.rest.clone(),
            position: Vec::with_capacity(n),
            velocity: Vec::with_capacity(n),
            deformation_gradient: Vec::with_capacity(n),
            cauchy_stress: Vec::with_capacity(n),
        };
        let mut reader = self.reader();
        for p in 0..n {
            let e = &self.elastic[self.particles.material[p] as usize];
            let motion = reader.motion(p);
            frame.position.push(self.particles.rest[p] + motion.displacement);
            frame.velocity.push(motion.velocity);
            frame.deformation_gradient.push(Matrix::identity() + motion.strain);
            frame.cauchy_stress.push(crate::cauchy_stress(&motion.strain, e.mu, e.lambda));
        }
        frame
    }

    fn moved(&self, probe: &Probe) -> Point {
        probe.rest + probe.value(&self.state.displacement)
    }

    pub(super) fn frames_of_outlines(&self) -> Vec<OutlineFrame> {
        self.state.outlines.frames(&self.scene, |probe| (self.moved(probe), probe.value(&self.state.velocity)))
    }

    pub(super) fn frames_of_cracks(&self, cracks: &Cracks) -> Vec<CrackFrame> {
        let frame = |(index, (crack, faces)): (usize, (&crate::crack::Crack, &[Vec<Probe>; 2]))| {
            let places = faces.each_ref().map(|face| face.iter().map(|p| self.moved(p)).collect());
            let velocities = faces.each_ref().map(|face| face.iter().map(|p| p.value(&self.state.velocity)).collect());
            crack_frame(index, crack, places, velocities)
        };
        cracks.iter().zip(&self.state.faces).enumerate().map(frame).collect()
    }
}
