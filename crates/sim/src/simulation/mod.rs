//! The simulation as its users see it: steps, what is measured at the tips, growth, frames.

use crate::crack::cracks::Cracks;
use crate::crack::{Crack, fragments};
use crate::formulation::{self, Choice};
use crate::material::elastic::Elastic;
use crate::particles::Particles;
use crate::solver::{Observed, Solver};
use crate::{SimulationError, foresight, memory, saved};
use fissure_scene::{Energies, Formulation, Frame, Pose, Scene, TipRecord, Vector};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

pub use counts::Counts;
pub use estimate::Estimate;
use std::sync::Arc;

mod counts;
mod estimate;
#[cfg(test)]
mod far_apart;
mod growing;
mod relaxation;
mod switching;

/// A simulation in progress.
#[derive(Debug)]
pub struct Simulation {
    scene: Scene,
    elastic: Vec<Elastic>,
    solver: Box<dyn Solver>,
    particles: Arc<Particles>,
    formulation: Formulation,
    state: RunState,
    /// Largest stable time step at the last look [s].
    stable_time_step: f64,
    counts: Counts,
}

/// What a saved state holds besides the solver's own.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct RunState {
    frame_number: i64,
    time: f64,
    steps: u64,
    cracks: Cracks,
    /// ∫ G da [J/m].
    crack_energy: f64,
    /// Kinetic and strain energy at the beginning [J/m].
    first_energy: f64,
    /// The most work that loads, supports, gravity and colliders have done or taken back, at the frames so far [J/m].
    most_work: f64,
    /// Time between the last two frames [s].
    interval: f64,
    /// Fragment of each particle.
    fragments: Vec<u32>,
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
        saved::ensure(self.fragments.len() == particles, "its number of particles")?;
        // Fragments only split, each into ones with particles of their own.
        saved::below("a particle", self.fragments.iter().copied(), particles)?;
        saved::ensure(self.cracks.len() >= scene.cracks.len(), "its number of cracks")?;
        self.cracks.iter().try_for_each(|crack| crack.check(scene, self.cracks.len()))
    }
}

#[derive(Serialize, Deserialize)]
struct Saved {
    version: String,
    scene_hash: String,
    formulation: Formulation,
    state: RunState,
    solver: Vec<u8>,
}

/// How far a simulation is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Simulated time [s].
    pub time: f64,
    /// Steps done so far.
    pub steps: u64,
    /// Steps done of the current frame.
    pub frame_steps: u64,
    /// Steps the current frame takes.
    pub frame_steps_total: u64,
    /// Number of live tips.
    pub live_tips: usize,
    /// Total crack length at rest [m].
    pub crack_length: f64,
}

/// Largest fraction of the stability limit with contact. A contact sets a velocity to zero in mid-oscillation; from rest at an amplitude A the next
/// leapfrog step goes to (1 − (ωΔt)²) A, which is no larger than A only if ωΔt ≤ √2, that is Δt at most 1/√2 of the limit 2/ω.
const CONTACT_COURANT: f64 = 0.7;

/// Largest fraction of the stability limit while a tip may grow: between two looks at the limit a tip passes through cells whose fields are stiffer for
/// their mass than those of the cells it came from. Measured on a plate pulled until a crack crosses it: 0.5 and below hold, 0.7 fails in some runs.
const GROWTH_COURANT: f64 = 0.5;

/// Energy a run may have beyond what it was given, as a part of what was exchanged. Kinetic and strain energy belong to moments half a step apart, so their
/// sum ripples by a few per cent where short waves run; a run that fails gains without bound.
const ENERGY_TOLERANCE: f64 = 0.1;

/// Steps between two looks at a stability limit that moves with the material.
const STEPS_BETWEEN_LIMITS: u64 = 8;

/// Steps are planned anew when the limit has changed by more than this part.
const LIMIT_SLACK: f64 = 0.1;

impl Simulation {
    /// Lays particles and grid for `scene`; the state is that of the first frame.
    ///
    /// # Errors
    /// When the scene cannot be simulated: see [`SimulationError`].
    pub fn new(scene: &Scene) -> Result<Self, SimulationError> {
        let cracks = Cracks::of_scene(scene);
        let elastic: Vec<Elastic> = scene.materials.iter().map(|m| Elastic::new(m, scene.plane)).collect();
        let Choice { formulation, .. } = formulation::choose(scene, &elastic);
        let scene = &formulation::settle(scene, formulation);
        memory::check(scene, formulation)?;
        let particles = Arc::new(Particles::fill(scene)?);
        foresight::check_layout(scene, &particles)?;
        let solver = formulation::build(formulation, scene, particles.clone(), &cracks)?;
        let mut simulation = Self {
            scene: scene.clone(),
            elastic,
            solver,
            formulation,
            state: RunState {
                frame_number: scene.frames.first,
                time: 0.0,
                steps: 0,
                cracks,
                crack_energy: 0.0,
                first_energy: 0.0,
                most_work: 0.0,
                interval: 0.0,
                fragments: fragments::of_bodies(&particles),
            },
            particles,
            stable_time_step: 0.0,
            counts: Counts::default(),
        };
        simulation.split_fragments();
        let energies = simulation.solver.energies();
        simulation.state.first_energy = energies.kinetic + energies.strain;
        simulation.stable_time_step = simulation.solver.stable_time_step();
        simulation.check_time_step()?;
        Ok(simulation)
    }

    fn check_time_step(&self) -> Result<(), SimulationError> {
        match self.scene.solver.time_step {
            Some(time_step) if time_step > self.stable_time_step => {
                Err(SimulationError::TimeStepTooLarge { time_step, limit: self.stable_time_step })
            }
            _ => Ok(()),
        }
    }

    fn largest_time_step(&self) -> f64 {
        let solver = &self.scene.solver;
        let contact = !self.scene.colliders.is_empty() || (solver.crack_contact && !self.state.cracks.is_empty());
        let grows = self.scene.growth.enabled && self.state.cracks.iter().any(|c| c.live_tips() > 0);
        let most = match (grows, contact) {
            (true, _) => GROWTH_COURANT,
            (false, true) => CONTACT_COURANT,
            _ => 1.0,
        };
        solver.time_step.unwrap_or(solver.courant.min(most) * self.stable_time_step)
    }

    /// Stops a run that has more energy than it was given.
    fn watch_energy(&mut self) -> Result<(), SimulationError> {
        let now = self.solver.energies();
        let held = now.kinetic + now.strain;
        let given = self.state.first_energy + now.external_work;
        // What has been exchanged in all, so that a body that only flies is judged by its own energy, and one that bounces not by the little that gravity has
        // left it with at its highest point.
        self.state.most_work = self.state.most_work.max(now.external_work.abs());
        let scale = self.state.first_energy + self.state.most_work;
        if held.is_finite() && held <= given + ENERGY_TOLERANCE * scale {
            return Ok(());
        }
        let place = self.fastest_place();
        Err(SimulationError::Unstable {
            time: self.state.time,
            x: place.x,
            y: place.y,
            cause: format!(
                "kinetic and strain energy are {held:e} J/m, more than the {given:e} J/m that were there or came in by loads; use a smaller \
                 `solver.courant`, a lower `growth.speed_limit` or weaker loads"
            ),
        })
    }

    /// The error of a run that has failed, with its cause where it is known: material that is strained beyond measure fails at any step.
    fn name_cause(&self, error: SimulationError) -> SimulationError {
        match (error, foresight::overload(&self.scene, &self.elastic)) {
            (
                SimulationError::Unstable { time, x, y, .. } | SimulationError::OutOfRange { time, x, y, .. },
                Some(cause),
            ) => SimulationError::Unstable { time, x, y, cause },
            (error, _) => error,
        }
    }

    fn fastest_place(&self) -> fissure_scene::Point {
        let particles = self.solver.particle_frame();
        let mut fastest = (0.0, fissure_scene::Point::origin());
        for (v, x) in particles.velocity.iter().zip(&particles.position) {
            // A NaN counts as fastest of all.
            if v.norm().total_cmp(&fastest.0).is_gt() {
                fastest = (v.norm(), *x);
            }
        }
        fastest.1
    }

    /// The scene as it is simulated.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Whether the last frame has been reached.
    pub fn is_finished(&self) -> bool {
        self.state.frame_number >= self.scene.frames.last
    }

    /// The formulation in use; it changes in mid-run where the scene allows it.
    pub fn formulation(&self) -> Formulation {
        self.formulation
    }

    /// Number of the current frame.
    pub fn frame_number(&self) -> i64 {
        self.state.frame_number
    }

    /// Number of particles.
    pub fn particles(&self) -> usize {
        self.particles.len()
    }

    /// Steps taken so far.
    pub fn steps(&self) -> u64 {
        self.state.steps
    }

    /// Work done by this process so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Time since the start [s].
    pub fn time(&self) -> f64 {
        self.state.time
    }

    /// What was measured last at each tip that is or was live, as in a frame.
    pub fn tips(&self) -> Vec<TipRecord> {
        let observed: &dyn Observed = &*self.solver;
        let cracks = &self.state.cracks;
        let mut tips = Vec::new();
        for id in cracks.ids().filter(|&id| cracks.tip(id).is_some()) {
            let (position, ahead) = observed.tip_now(cracks, id);
            let direction = ahead.y.atan2(ahead.x);
            tips.extend(cracks.of(id).record(id, position, direction, self.state.interval));
        }
        tips
    }

    /// Energy budget now, as in a frame.
    pub fn energies(&self) -> Energies {
        let energies = self.solver.energies();
        Energies {
            kinetic: energies.kinetic,
            strain: energies.strain,
            external_work: energies.external_work,
            crack: self.state.crack_energy,
        }
    }

    /// Linear [N s/m] and angular momentum about the origin [N s] now, per unit thickness.
    pub fn momenta(&self) -> (Vector, f64) {
        self.solver.momenta()
    }

    /// The current state as a frame.
    pub fn frame(&self) -> Frame {
        let mut particles = self.solver.particle_frame();
        particles.piece.clone_from(&self.state.fragments);
        Frame {
            number: self.state.frame_number,
            time: self.state.time,
            particles,
            outlines: self.solver.outline_frames(),
            cracks: self.solver.crack_frames(&self.state.cracks),
            tips: self.tips(),
            energies: self.energies(),
            colliders: self.collider_poses(),
        }
    }

    fn collider_poses(&self) -> Vec<Pose> {
        let time = self.state.time;
        self.scene.colliders.iter().map(|c| crate::boundary::collider::Obstacle::new(c).at(time).pose()).collect()
    }

    /// Runs to the next frame. `watch` is called after every step; when it breaks, the run stops in mid-frame and `false` is returned: the
    /// state is then good for nothing but being dropped, a saved state of the last frame goes on.
    ///
    /// # Errors
    /// When the run becomes unstable; the frames so far stay valid.
    pub fn advance(&mut self, watch: &mut dyn FnMut(&Progress) -> ControlFlow<()>) -> Result<bool, SimulationError> {
        self.advance_observed(&mut |_, progress| watch(progress))
    }

    /// As [`Simulation::advance`]; `watch` also sees the state. What was measured at the tips belongs to the beginning of the step.
    ///
    /// # Errors
    /// As [`Simulation::advance`].
    pub fn advance_observed(
        &mut self,
        watch: &mut dyn FnMut(&Self, &Progress) -> ControlFlow<()>,
    ) -> Result<bool, SimulationError> {
        for tip in self.state.cracks.tips_mut() {
            tip.run_at_frame = tip.run();
        }
        let next = self.scene.frames.time(self.state.frame_number + 1);
        self.state.interval = next - self.state.time;
        let mut frame_steps = 0;
        while self.state.time < next {
            if !self.run_to(next, &mut frame_steps, watch)? {
                return Ok(false);
            }
        }
        self.watch_energy().map_err(|error| self.name_cause(error))?;
        self.state.frame_number += 1;
        self.split_fragments();
        Ok(true)
    }

    /// Runs to the time `next` [s], or to where the formulation or the length of the steps has to change. `frame_steps` counts the steps of the frame. `false`:
    /// `watch` has broken the run.
    fn run_to(
        &mut self,
        next: f64,
        frame_steps: &mut u64,
        watch: &mut dyn FnMut(&Self, &Progress) -> ControlFlow<()>,
    ) -> Result<bool, SimulationError> {
        self.stable_time_step = self.solver.stable_time_step();
        self.check_time_step()?;
        let start = self.state.time;
        let steps = ((next - start) / self.largest_time_step()).ceil().max(1.0) as u64;
        let time_step = (next - start) / steps as f64;
        let frame_steps_total = *frame_steps + steps;
        for step in 1..=steps {
            let is_last = step == steps;
            *frame_steps += 1;
            let done =
                self.one_step(time_step, is_last).and_then(|()| if is_last { self.solver.check(next) } else { Ok(()) });
            // The frame's own time, free of accumulated rounding.
            self.state.time = if is_last { next } else { start + time_step * step as f64 };
            if let Err(error) = done {
                self.switch_formulation(error).map_err(|error| self.name_cause(error))?;
                return Ok(true);
            }
            let progress = Progress {
                time: self.state.time,
                steps: self.state.steps,
                frame_steps: *frame_steps,
                frame_steps_total,
                live_tips: self.state.cracks.iter().map(Crack::live_tips).sum(),
                crack_length: self.state.cracks.iter().map(Crack::length).sum(),
            };
            if watch(self, &progress).is_break() {
                return Ok(false);
            }
            if !is_last && step.is_multiple_of(STEPS_BETWEEN_LIMITS) && self.limit_has_moved() {
                return Ok(true);
            }
        }
        Ok(true)
    }

    /// Whether the stable step is no longer what the steps were planned by.
    fn limit_has_moved(&self) -> bool {
        let Some(now) = self.solver.moving_time_step() else { return false };
        let change = now / self.stable_time_step;
        let rises = self.formulation == Formulation::Updated && change > 1.0 + LIMIT_SLACK;
        // NaN counts as moved.
        rises || change < 1.0 - LIMIT_SLACK || change.is_nan()
    }

    fn split_fragments(&mut self) {
        fragments::split(&self.particles, &self.state.cracks, self.scene.cell_size, &mut self.state.fragments);
    }

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
            stable_time_step: 0.0,
            counts: Counts::default(),
        })
    }
}
