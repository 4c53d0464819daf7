//! What never changes in a run.

use crate::material::elastic::Elastic;
use crate::particles::Particles;
use crate::threads::current_num_threads;
use fissure_scene::{Scene, Transfer};
use std::sync::Arc;

/// From so many particles on, loops go to several threads; below, handing out the work costs more than it saves.
pub(super) const PARALLEL_PARTICLES: usize = 8_000;

/// The scene, and what was laid from it.
#[derive(Debug)]
pub(super) struct Setup {
    pub(super) scene: Scene,
    pub(super) particles: Arc<Particles>,
    /// Elastic constants of each material.
    pub(super) elastic: Vec<Elastic>,
}

impl Setup {
    pub(super) fn new(scene: &Scene, particles: Arc<Particles>) -> Self {
        let elastic = scene.materials.iter().map(|m| Elastic::new(m, scene.plane)).collect();
        Self { scene: scene.clone(), particles, elastic }
    }

    /// Elastic constants of the material of a particle.
    #[inline(always)]
    pub(super) fn elastic_of(&self, particle: usize) -> &Elastic {
        match self.elastic.as_slice() {
            // Where all are of one material none is asked for its own.
            [all] => all,
            each => &each[self.particles.material[particle] as usize],
        }
    }

    /// Whether loops over particles go to several threads.
    pub(super) fn is_parallel(&self) -> bool {
        self.particles.len() >= PARALLEL_PARTICLES && current_num_threads() > 1
    }
}

/// Whether particles carry an affine velocity.
pub(super) fn has_affine(scene: &Scene) -> bool {
    matches!(scene.solver.transfer, Transfer::Apic | Transfer::Aflip)
}

/// Whether particles carry a plastic part.
pub(super) fn is_plastic(scene: &Scene) -> bool {
    scene.materials.iter().any(|m| m.plasticity.is_some())
}
