//! The state of a run as bytes, and going on from it.

use super::{Counts, RunState, Simulation};
use crate::material::elastic::Elastic;
use crate::particles::Particles;
use crate::{SimulationError, formulation, memory, saved};
use fissure_scene::{Formulation, Scene};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

#[derive(Serialize, Deserialize)]
struct Saved {
    version: String,
    scene_hash: String,
    formulation: Formulation,
    state: RunState,
    solver: Vec<u8>,
}

impl RunState {
    /// Checks a state that was read against its scene, which has so many `particles`.
    ///
    /// # Errors
    /// [`SimulationError::BadState`]
    fn check(&self, scene: &Scene, particles: usize) -> Result<(), SimulationError> {
        let frames = scene.frames.first..=scene.frames.last;
        // A frame's time is that of the scene, to the bit.
        let is_a_frame = frames.contains(&self.frame_number) && self.time == scene.frames.time(self.frame_number);
        saved::ensure(is_a_frame, "its frame")?;
        saved::finite("its energy", [&self.crack_energy, &self.first_energy, &self.most_work, &self.interval])?;
        saved::ensure(self.impulses.len() == scene.supports.len(), "its number of supports")?;
        saved::finite("a reaction", self.impulses.iter().flatten())?;
        saved::ensure(self.fragments.len() == particles, "its number of particles")?;
        // Fragments only split, each into ones with particles of their own.
        saved::below("a particle", self.fragments.iter().copied(), particles)?;
        saved::ensure(self.cracks.len() >= scene.cracks.len(), "its number of cracks")?;
        self.waiting.iter().try_for_each(|branch| branch.check(&self.cracks))?;
        self.cracks.iter().try_for_each(|crack| crack.check(scene, self.cracks.len()))
    }
}

impl Simulation {
    /// The whole state at a frame boundary, for [`Simulation::restore`].
    ///
    /// # Errors
    /// [`SimulationError::NotSaved`]
    pub fn save(&self) -> Result<Vec<u8>, SimulationError> {
        saved::to_bytes(&Saved {
            version: env!("CARGO_PKG_VERSION").into(),
            scene_hash: self.scene.hash.clone(),
            formulation: self.formulation,
            state: self.state.clone(),
            solver: self.solver.save()?,
        })
    }

    /// Goes on from a saved state of the same scene: gives bit for bit what an uninterrupted run gives.
    ///
    /// # Errors
    /// [`SimulationError::BadState`] when `state` is of another scene or version, or does not hold together.
    pub fn restore(scene: &Scene, state: &[u8]) -> Result<Self, SimulationError> {
        let saved: Saved = saved::from_bytes(state)?;
        if saved.version != env!("CARGO_PKG_VERSION") || saved.scene_hash != scene.hash {
            return Err(SimulationError::BadState("it is of another scene or version".into()));
        }
        let elastic: Vec<Elastic> = scene.materials.iter().map(|m| Elastic::new(m, scene.plane)).collect();
        let scene = &formulation::settle(scene, saved.formulation);
        memory::check(scene, saved.formulation)?;
        let particles = Arc::new(Particles::fill(scene)?);
        saved.state.check(scene, particles.len())?;
        let cracks = &saved.state.cracks;
        let solver = formulation::restore(saved.formulation, scene, particles.clone(), cracks, &saved.solver)?;
        Ok(Self {
            scene: scene.clone(),
            elastic,
            solver,
            particles,
            formulation: saved.formulation,
            state: saved.state,
            counts: Counts::default(),
            stages: super::stages::StageWatch::default(),
            contours: super::contours::ContourWatch::default(),
            spares_looks: false,
            stable_time_step: 0.0,
        })
    }
}
