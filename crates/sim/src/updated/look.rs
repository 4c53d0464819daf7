//! Looking at the solver: what is around a tip, what a frame holds.

use super::Updated;
use crate::crack::cracks::{Cracks, TipId};
use crate::faces::crack_frame::crack_frame;
use crate::solver::Observed;
use crate::tip::frame::{side_of, tip_of, turn};
use crate::tip::zone::{FaceContact, QuadraturePoint, TipZone};
use fissure_scene::{CrackFrame, End, Matrix, OutlineFrame, ParticleFrame, Point, Vector};

/// A moment in the middle of a step: positions, deformations and accelerations of the step's beginning; velocities on the grid are half a step ahead and
/// taken back by half the acceleration.
#[derive(Debug)]
pub(super) struct Moment<'a> {
    pub(super) solver: &'a Updated,
    pub(super) time_step: f64,
}

/// Behind a tip, in cells, where the opening is taken. 1 to 3 cells: nearer, the tip's own discretisation shows; farther, the next term of the series.
const OPENING_DISTANCE: f64 = 1.5;

impl Observed for Moment<'_> {
    fn tip_zone(&self, cracks: &Cracks, id: TipId, radius: f64) -> TipZone {
        self.solver.zone(cracks, id, radius, Some(self.time_step))
    }

    fn tip_now(&self, cracks: &Cracks, id: TipId) -> (Point, Vector) {
        self.solver.tip_now(cracks, id)
    }
}

/// Between steps there is no grid: velocities are those of the particles, accelerations those of the last step.
impl Observed for Updated {
    fn tip_zone(&self, cracks: &Cracks, id: TipId, radius: f64) -> TipZone {
        self.zone(cracks, id, radius, None)
    }

    fn tip_now(&self, cracks: &Cracks, id: TipId) -> (Point, Vector) {
        tip_of(cracks, id, &self.state.cracks[id.crack].position, self.scene.cell_size)
    }
}

impl Updated {
    /// The current configuration around a tip. The displacement is measured from the rest configuration turned as the surroundings of the tip
    /// are: a turn of the whole body then leaves no gradient.
    fn zone(&self, cracks: &Cracks, id: TipId, radius: f64, time_step: Option<f64>) -> TipZone {
        let (tip, ahead) = self.tip_now(cracks, id);
        let mut found: Vec<(usize, Matrix)> = Vec::new();
        let mut mean = Matrix::zeros();
        for (p, point) in self.state.points.iter().enumerate() {
            if (point.position - tip).norm_squared() < radius * radius && self.particles.body[p] == cracks.of(id).body {
                let h = self.total_gradient(p);
                mean += h;
                found.push((p, h));
            }
        }
        let mean = mean / found.len().max(1) as f64;
        let (rotation, rotation_minus_one) = turn(2.0 + mean.m11 + mean.m22, mean.m21 - mean.m12);
        let frame = Matrix::new(ahead.x, ahead.y, -ahead.y, ahead.x);
        let into = |m: Matrix| frame * m * frame.transpose();
        let mut points = Vec::with_capacity(found.len());
        for (p, h) in found {
            let point = &self.state.points[p];
            let (mu, lambda) = self.moduli(p);
            let ratio = 1.0 + crate::volume_change(&h);
            // I − F⁻¹ = F⁻¹ H, so that small strains keep their digits; then R: I − R F⁻¹ = R (I − F⁻¹) − (R − I).
            let inverse = Matrix::new(1.0 + h.m22, -h.m12, -h.m21, 1.0 + h.m11) / ratio;
            let gradient = rotation * (inverse * h) - rotation_minus_one;
            let (velocity, motion) = match time_step {
                None => (point.velocity, self.motion.get(p).copied().unwrap_or_default()),
                Some(time_step) => {
                    let g = self.gather_at_particle(p);
                    ((g.velocity + g.before) * 0.5, g.motion(time_step))
                }
            };
            let elastic = &point.elastic_gradient;
            points.push(QuadraturePoint {
                place: frame * (point.position - tip),
                side: side_of(&self.state.cracks[id.crack].position, id.end, ahead, point.position),
                volume: self.particles.volume[p] * ratio,
                stress: into(crate::kirchhoff_stress(elastic, mu, lambda) / ratio),
                gradient: into(gradient),
                energy: crate::energy_density(elastic, mu, lambda) / ratio,
                density: self.elastic[self.particles.material[p] as usize].density / ratio,
                velocity: frame * velocity,
                velocity_slope: frame * (motion.velocity_gradient * ahead),
                acceleration: frame * motion.acceleration,
                material: self.particles.material[p],
            });
        }
        let (opening, opening_distance) = self.opening(id);
        // Above is the left side for one who walks to the end of the crack. Friction only: around a tip in pure shear the smooth kernels find overlaps that are
        // not there, and a pressure that would be a K_I of 4 % of K_II.
        let sign = if id.end == End::End { 1.0 } else { -1.0 };
        let contacts = self
            .face_forces(id.crack)
            // Elsewhere the crack may have come back behind the tip.
            .filter(|(place, _)| (place - tip).norm() < radius + 2.0 * self.scene.cell_size)
            .map(|(place, force)| FaceContact {
                behind: (tip - place).dot(&ahead),
                force: Vector::new((frame * force).x * sign, 0.0),
            })
            .collect();
        TipZone { points, contacts, opening: frame * opening, opening_distance }
    }

    /// Crack points from a tip backwards.
    fn backwards(&self, id: TipId) -> Vec<usize> {
        let n = self.state.cracks[id.crack].position.len();
        match id.end {
            End::End => (0..n).rev().collect(),
            End::Start => (0..n).collect(),
        }
    }

    /// Opening of the faces some way behind a tip, left minus right as seen from the tip looking ahead [m], and that distance [m].
    fn opening(&self, id: TipId) -> (Vector, f64) {
        let now = &self.state.cracks[id.crack];
        let wanted = OPENING_DISTANCE * self.scene.cell_size;
        // Above is the left side for one who walks to the end of the crack.
        let sign = if id.end == End::End { 1.0 } else { -1.0 };
        let jump = |k: usize| (now.faces[0][k] - now.faces[1][k]) * sign;
        let mut distance = 0.0;
        let mut last = (Vector::zeros(), 0.0);
        for w in self.backwards(id).windows(2) {
            let length = (now.position[w[1]] - now.position[w[0]]).norm();
            if distance + length >= wanted {
                let t = (wanted - distance) / length;
                return (jump(w[0]) * (1.0 - t) + jump(w[1]) * t, wanted);
            }
            distance += length;
            last = (jump(w[1]), distance);
        }
        last
    }

    pub(super) fn kinetic(&self) -> f64 {
        let twice: f64 =
            self.state.points.iter().zip(&self.particles.mass).map(|(p, m)| m * p.velocity.norm_squared()).sum();
        0.5 * twice
    }

    pub(super) fn strain_energy(&self) -> f64 {
        let energy = |(p, point): (usize, &super::MaterialPoint)| {
            let (mu, lambda) = self.moduli(p);
            self.particles.volume[p] * crate::energy_density(&point.elastic_gradient, mu, lambda)
        };
        self.state.points.iter().enumerate().map(energy).sum()
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
        for (p, point) in self.state.points.iter().enumerate() {
            let (mu, lambda) = self.moduli(p);
            let h = self.total_gradient(p);
            let ratio = 1.0 + crate::volume_change(&h);
            frame.position.push(point.position);
            frame.velocity.push(point.velocity);
            frame.deformation_gradient.push(Matrix::identity() + h);
            frame.cauchy_stress.push(crate::kirchhoff_stress(&point.elastic_gradient, mu, lambda) / ratio);
        }
        frame
    }

    pub(super) fn frames_of_outlines(&self) -> Vec<OutlineFrame> {
        self.state.outlines.frames(&self.scene, |tracer| match tracer.face {
            None => (tracer.position, tracer.velocity),
            Some((id, face)) => self.state.cracks[id.crack].face_end(id.end, face),
        })
    }

    pub(super) fn frames_of_cracks(&self, cracks: &Cracks) -> Vec<CrackFrame> {
        let now = self.state.cracks.iter().enumerate();
        cracks
            .iter()
            .zip(now)
            .map(|(c, (i, now))| crack_frame(i, c, now.faces.clone(), now.velocities.clone()))
            .collect()
    }
}
