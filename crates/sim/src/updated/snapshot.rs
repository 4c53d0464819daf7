//! What can be read from the solver between two steps.

use super::Updated;
use super::faces::Faces;
use super::points::Points;
use super::setup::Setup;
use super::tracer::Tracer;
use crate::SimulationError;
use crate::boundary::supports::Reaction;
use crate::crack::cracks::Cracks;
use crate::faces::crack_frame::crack_frame;
use crate::particles::{ParticleNow, Particles};
use crate::saved;
use crate::solver::{Continuation, Snapshot, SolverEnergies};
use fissure_scene::{CrackFrame, OutlineFrame, ParticleFrame, Point, Scene, Vector};

impl Snapshot for Updated {
    fn add_motions(&self, frame: &mut ParticleFrame) {
        self.points.add_motions(&self.setup, frame);
    }

    fn outline_frames(&self) -> Vec<OutlineFrame> {
        self.faces.outline_frames(&self.setup.scene)
    }

    fn crack_frames(&self, cracks: &Cracks) -> Vec<CrackFrame> {
        self.faces.crack_frames(cracks)
    }

    fn energies(&self) -> SolverEnergies {
        SolverEnergies {
            kinetic: self.points.kinetic_energy(&self.setup),
            strain: self.points.strain_energy(&self.setup),
            external_work: self.external_work,
        }
    }

    fn reactions(&self) -> &[Reaction] {
        &self.reactions
    }

    fn energy_of_lag(&self) -> f64 {
        // Not known: forces at the new places would need the grid of the next step.
        0.0
    }

    fn work_in_doubt(&self) -> f64 {
        0.5 * self.work_of_step.abs()
    }

    fn kinetic_energy(&self) -> f64 {
        self.points.kinetic_energy(&self.setup)
    }

    fn momenta(&self) -> (Vector, f64) {
        self.points.momenta(&self.setup)
    }

    fn rayleigh_quotient(&self) -> Option<f64> {
        // Its forces live on a grid that is laid anew in every step. Damped by ω² from the stresses of particles, a
        // beam comes to rest in twice the steps that it takes with stops at the peaks (`three-holes`, affine PIC, 1.5
        // cells per inch: 45 thousand for 22): what moves from cell to cell wakes up short waves.
        None
    }

    fn continuation(&self, _cracks: &Cracks) -> Option<Continuation> {
        None
    }

    fn save(&self) -> Result<Vec<u8>, SimulationError> {
        saved::to_bytes(&(&self.points, &self.faces, self.external_work, &self.reactions))
    }
}

impl Points {
    /// Adds to `frame`, which has what some particles are at rest, how these move.
    pub(super) fn add_motions(&self, setup: &Setup, frame: &mut ParticleFrame) {
        let now = |p: usize| {
            let (point, (mu, lambda)) = (&self.point[p], self.moduli(setup, p));
            let gradient = self.total_gradient(p);
            let ratio = 1.0 + crate::volume_change(&gradient);
            let cauchy_stress = crate::kirchhoff_stress(&point.elastic_gradient, mu, lambda) / ratio;
            ParticleNow { position: point.position, velocity: point.velocity, gradient, cauchy_stress }
        };
        Particles::add_motions(frame, |numbers| numbers.map(now).collect());
    }
}

impl Faces {
    /// The rings of all bodies of `scene`.
    pub(super) fn outline_frames(&self, scene: &Scene) -> Vec<OutlineFrame> {
        self.outlines.frames(scene, |tracer| self.vertex_now(tracer))
    }

    /// Place [m] and velocity [m/s] of a vertex of an outline.
    fn vertex_now(&self, tracer: &Tracer) -> (Point, Vector) {
        match tracer.face {
            None => (tracer.position, tracer.velocity),
            Some((id, face)) => self.cracks[id.crack].face_end(id.end, face),
        }
    }

    /// Place of a vertex of an outline [m].
    pub(super) fn place_of(&self, tracer: &Tracer) -> Point {
        self.vertex_now(tracer).0
    }

    /// The cracks with both faces.
    pub(super) fn crack_frames(&self, cracks: &Cracks) -> Vec<CrackFrame> {
        let now = self.cracks.iter().enumerate();
        let frames = cracks.iter().zip(now);
        frames.map(|(c, (i, now))| crack_frame(i, c, now.faces.clone(), now.velocities.clone())).collect()
    }
}
