//! The state of a run as bytes, and going on from it.

use super::{Counts, RunState, Simulation};
use crate::material::elastic::Elastic;
use crate::particles::Particles;
use crate::{SimulationError, formulation, memory, saved};
use fissure_scene::{Formulation, Scene};
use serde::Deserialize;
use std::sync::Arc;

#[derive(Deserialize)]
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
        // What `Saved` is as bytes, without a copy of the state.
        let (version, scene_hash) = (env!("CARGO_PKG_VERSION"), &self.scene.hash);
        saved::to_bytes(&(version, scene_hash, self.formulation, &self.state, self.solver.save()?))
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
            measured: None,
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use crate::Simulation;
    use crate::test_scenes::{add_crack, free_body, rectangle, set_motion};
    use fissure_plane::Point;
    use fissure_scene::{Curve, Formulation, Guide, Kernel, Selection, TipDivision};
    use std::ops::ControlFlow;

    /// Truth: the run that was not interrupted, byte for byte. A crack is pressed shut and runs all the same, because
    /// it has a schedule: when a frame ends its tip is in the middle of an increment, where faces press on each other.
    #[test]
    fn a_closed_crack_that_runs_goes_on_as_if_nothing_had_been() {
        let mut scene = free_body(rectangle([0.0, 0.0], [16.0, 8.0]), 0.5);
        scene.solver.formulation = Formulation::Total;
        scene.solver.kernel = Kernel::Bilinear;
        scene.solver.tip_division = TipDivision::PartlyCut;
        scene.growth.enabled = true;
        add_crack(&mut scene, &[[-0.3, 3.37], [4.21, 2.71]]);
        scene.cracks[0].end_live = true;
        scene.cracks[0].end_guide = Some(Guide {
            name: "path".into(),
            points: [[4.21, 2.71], [9.13, 3.93], [14.0, 3.77]].map(Point::from).into(),
            strength: 1.0,
            schedule: Curve { points: vec![(0.0, 0.0), (2.0, 1.0)] },
            branches: Vec::new(),
        });
        let upper = Selection::Region(rectangle([-1.0, 3.5], [20.0, 9.0]));
        set_motion(&mut scene, upper, [0.0, -0.3], 0.0, [0.0, 0.0]);
        scene.frames.last = 12;
        scene.frames.rate = 6.37;
        let mut whole = Simulation::new(&scene).unwrap();
        let next = |simulation: &mut Simulation| simulation.advance(&mut |_| ControlFlow::Continue(())).unwrap();
        let mut restored: Option<Simulation> = None;
        for frame in 2..12 {
            next(&mut whole);
            let state = whole.save().unwrap();
            if let Some(mut restored) = restored {
                next(&mut restored);
                assert!(restored.save().unwrap() == state, "frame {frame}");
            }
            restored = Some(Simulation::restore(&scene, &state).unwrap());
        }
    }
}
