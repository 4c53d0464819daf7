//! What particles carry from step to step.

use super::plastic::PlasticPart;
use super::setup::{Setup, has_affine, is_plastic};
use crate::SimulationError;
use crate::saved::{self, Fits};
use fissure_scene::{Kernel, Matrix, Point, Scene, Vector};
use serde::{Deserialize, Serialize};

/// What every particle carries; one cache line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct MaterialPoint {
    /// x_p [m].
    pub(super) position: Point,
    /// v_p [m/s].
    pub(super) velocity: Vector,
    /// H = F_E − I [–]: a strain of 1e-9 keeps its digits.
    pub(super) elastic_gradient: Matrix,
}

/// The motion of a particle in a step.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Motion {
    /// [m/s²].
    pub(super) acceleration: Vector,
    /// ∇v [1/s].
    pub(super) velocity_gradient: Matrix,
}

/// What all particles carry. One entry per particle in every list that is not empty.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Points {
    pub(super) point: Vec<MaterialPoint>,
    /// Affine velocity C_p [1/s]; empty unless the transfer is affine.
    pub(super) affine: Vec<Matrix>,
    /// Plastic part; empty when every material is elastic.
    pub(super) plastic: Vec<PlasticPart>,
    /// What each did in the last step, for a look between steps; empty in a scene without a crack, and before the
    /// first step.
    #[serde(skip)]
    pub(super) motion: Vec<Motion>,
}

impl Points {
    /// Particles at rest, with their first velocities.
    pub(super) fn at_rest(setup: &Setup) -> Self {
        let (scene, particles) = (&setup.scene, &setup.particles);
        let count = particles.len();
        let at_rest =
            |&position| MaterialPoint { position, velocity: Vector::zeros(), elastic_gradient: Matrix::zeros() };
        let mut points = Self {
            point: particles.rest.iter().map(at_rest).collect(),
            affine: if has_affine(scene) { vec![Matrix::zeros(); count] } else { Vec::new() },
            plastic: if is_plastic(scene) { vec![PlasticPart::NONE; count] } else { Vec::new() },
            motion: Vec::new(),
        };
        for (p, motion) in particles.first_motions(scene).into_iter().enumerate() {
            points.point[p].velocity += motion.velocity;
            if let Some(c) = points.affine.get_mut(p) {
                *c += Matrix::new(0.0, -motion.angular_velocity, motion.angular_velocity, 0.0);
            }
        }
        points
    }

    /// Checks what was read: that its numbers are finite, and that it fits the scene and its number of `particles`.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(super) fn check(&self, scene: &Scene, particles: usize) -> Fits {
        let counts = [self.point.len(), self.affine.len(), self.plastic.len()];
        let expected =
            [particles, if has_affine(scene) { particles } else { 0 }, if is_plastic(scene) { particles } else { 0 }];
        saved::ensure(counts == expected, "its number of particles")?;
        for point in &self.point {
            let numbers = point.position.iter().chain(&point.velocity).chain(&point.elastic_gradient);
            saved::finite("a particle", numbers)?;
        }
        saved::finite("a particle", self.affine.iter().flatten())?;
        for part in &self.plastic {
            saved::finite("a particle", part.gradient.iter().chain([&part.hardening]))?;
        }
        Ok(())
    }

    /// Elastic constants (μ, λ) of a particle, hardening included [Pa].
    #[inline(always)]
    pub(super) fn moduli(&self, setup: &Setup, particle: usize) -> (f64, f64) {
        let elastic = setup.elastic_of(particle);
        match self.plastic.get(particle) {
            None => (elastic.mu, elastic.lambda),
            Some(part) => (elastic.mu * part.hardening, elastic.lambda * part.hardening),
        }
    }

    /// V_p0 τ_p [N], which equals V_p σ_p, of a particle, which is at `point`.
    #[inline(always)]
    pub(super) fn stress_times_volume(&self, setup: &Setup, particle: usize, point: &MaterialPoint) -> Matrix {
        let (mu, lambda) = self.moduli(setup, particle);
        crate::kirchhoff_stress(&point.elastic_gradient, mu, lambda) * setup.particles.volume[particle]
    }

    /// H = F − I of a particle, elastic and plastic part together.
    pub(super) fn total_gradient(&self, particle: usize) -> Matrix {
        let h = self.point[particle].elastic_gradient;
        match self.plastic.get(particle) {
            None => h,
            Some(part) => part.gradient - Matrix::identity() + h * part.gradient,
        }
    }

    /// The error for particles of which no grid holds all: the one farthest from the middle of all has left.
    pub(super) fn left(&self, time: f64) -> SimulationError {
        let middle = self.point.iter().fold(Vector::zeros(), |a, p| a + p.position.coords) / self.point.len() as f64;
        let away = |p: &MaterialPoint| (p.position.coords - middle).norm_squared();
        let farthest = self.point.iter().enumerate().max_by(|a, b| away(a.1).total_cmp(&away(b.1)));
        let (particle, point) = farthest.map_or((0, Point::origin()), |(p, point)| (p, point.position));
        let cause = format!(
            "particle {particle} has flown so far from the rest that no grid holds both; end the run before \
             (`frames.last`), hold the material with a collider, or use a smaller `solver.courant` if it was thrown off"
        );
        SimulationError::Unstable { time, x: point.x, y: point.y, cause }
    }

    /// Sets all velocities to zero.
    pub(super) fn stop(&mut self) {
        self.point.iter_mut().for_each(|p| p.velocity = Vector::zeros());
        self.affine.fill(Matrix::zeros());
        self.motion.fill(Motion::default());
    }

    /// Kinetic energy [J/m].
    pub(super) fn kinetic_energy(&self, setup: &Setup) -> f64 {
        let twice: f64 = self.point.iter().zip(&setup.particles.mass).map(|(p, m)| m * p.velocity.norm_squared()).sum();
        0.5 * twice
    }

    /// Strain energy [J/m].
    pub(super) fn strain_energy(&self, setup: &Setup) -> f64 {
        let energy = |(p, point): (usize, &MaterialPoint)| {
            let (mu, lambda) = self.moduli(setup, p);
            setup.particles.volume[p] * crate::energy_density(&point.elastic_gradient, mu, lambda)
        };
        self.point.iter().enumerate().map(energy).sum()
    }

    /// Linear [N s/m] and angular momentum about the origin [N s].
    pub(super) fn momenta(&self, setup: &Setup) -> (Vector, f64) {
        // The affine part of APIC turns too: m D (C_21 − C_12), D = h²/4 (quadratic) or h²/3 (cubic) (Jiang et al.
        // 2015).
        let (h, kernel) = (setup.scene.cell_size, setup.scene.solver.kernel);
        let d = h.powi(2) / if kernel == Kernel::Quadratic { 4.0 } else { 3.0 };
        let (mut linear, mut angular) = (Vector::zeros(), 0.0);
        for (p, (point, mass)) in self.point.iter().zip(&setup.particles.mass).enumerate() {
            let turning = self.affine.get(p).map_or(0.0, |c| d * (c.m21 - c.m12));
            linear += point.velocity * *mass;
            angular += mass * (point.position.coords.perp(&point.velocity) + turning);
        }
        (linear, angular)
    }
}
