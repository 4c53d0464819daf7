//! From frame to frame, in steps as long as stability allows.

use super::{Progress, Simulation};
use crate::SimulationError;
use crate::crack::Crack;
use fissure_scene::Formulation;
use std::ops::ControlFlow;

/// Largest fraction of the stability limit with contact. A contact sets a velocity to zero in mid-oscillation; from
/// rest at an amplitude A the next leapfrog step goes to (1 − (ωΔt)²) A, which is no larger than A only if ωΔt ≤ √2,
/// that is Δt at most 1/√2 of the limit 2/ω.
const CONTACT_COURANT: f64 = 0.7;

/// Largest fraction of the stability limit of the total formulation while a tip may grow: between two looks at the
/// limit a tip passes through cells whose fields are stiffer for their mass than those of the cells it came from.
/// Measured on a plate pulled until a crack crosses it: 0.5 and below hold, 0.7 fails in some runs. The limit of the
/// updated formulation holds wherever cracks run.
const GROWTH_COURANT: f64 = 0.5;

/// Steps between two looks at a stability limit that moves with the material.
const STEPS_BETWEEN_LIMITS: u64 = 8;

/// Steps are planned anew when the limit has changed by more than this part.
const LIMIT_SLACK: f64 = 0.1;

impl Simulation {
    pub(super) fn check_time_step(&self) -> Result<(), SimulationError> {
        match self.scene.solver.time_step {
            Some(time_step) if time_step > self.stable_time_step => {
                Err(SimulationError::TimeStepTooLarge { time_step, limit: self.stable_time_step })
            }
            _ => Ok(()),
        }
    }

    pub(super) fn largest_time_step(&self) -> f64 {
        let solver = &self.scene.solver;
        let contact = !self.scene.colliders.is_empty()
            || (solver.crack_contact && !self.state.cracks.is_empty())
            || self.solver.is_touching();
        let grows = self.scene.growth.enabled && self.state.cracks.iter().any(|c| c.live_tips() > 0);
        let most = match (grows && self.formulation == Formulation::Total, contact) {
            (true, _) => GROWTH_COURANT,
            (false, true) => CONTACT_COURANT,
            _ => 1.0,
        };
        solver.time_step.unwrap_or(solver.courant.min(most) * self.stable_time_step)
    }

    /// Runs to the next frame. `watch` is called after every step; when it breaks, the run stops in mid-frame and
    /// `false` is returned: the state is then good for nothing but being dropped, a saved state of the last frame goes
    /// on.
    ///
    /// # Errors
    /// When the run becomes unstable; the frames so far stay valid.
    pub fn advance(&mut self, watch: &mut dyn FnMut(&Progress) -> ControlFlow<()>) -> Result<bool, SimulationError> {
        self.advance_observed(&mut |_, progress| watch(progress))
    }

    /// As [`Simulation::advance`]; `watch` also sees the state. What was measured at the tips belongs to the beginning
    /// of the step.
    ///
    /// # Errors
    /// As [`Simulation::advance`].
    pub fn advance_observed(
        &mut self,
        watch: &mut dyn FnMut(&Self, &Progress) -> ControlFlow<()>,
    ) -> Result<bool, SimulationError> {
        self.measured = None;
        for tip in self.state.cracks.tips_mut() {
            tip.run_at_frame = tip.run();
        }
        self.state.impulses.clear();
        self.state.impulses.extend(self.solver.reactions().iter().map(|reaction| reaction.impulse));
        let next = self.scene.frames.time(self.state.frame_number + 1);
        self.state.interval = next - self.state.time;
        let mut frame_steps = 0;
        while self.state.time < next {
            if !self.run_to(next, &mut frame_steps, watch)? {
                return Ok(false);
            }
        }
        self.solver.end_frame(&self.state.cracks);
        self.watch_energy().map_err(|error| self.name_cause(error))?;
        self.state.frame_number += 1;
        self.split_fragments();
        Ok(true)
    }

    /// Runs to the time `next` [s], or to where the formulation or the length of the steps has to change. `frame_steps`
    /// counts the steps of the frame. `false`: `watch` has broken the run.
    fn run_to(
        &mut self,
        next: f64,
        frame_steps: &mut u64,
        watch: &mut dyn FnMut(&Self, &Progress) -> ControlFlow<()>,
    ) -> Result<bool, SimulationError> {
        self.solver.begin_run();
        self.stable_time_step = self.solver.stable_time_step();
        self.check_time_step()?;
        let was_touching = self.solver.is_touching();
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
            let begins_to_touch = !was_touching && self.solver.is_touching();
            if !is_last && step.is_multiple_of(STEPS_BETWEEN_LIMITS) && (begins_to_touch || self.limit_has_moved()) {
                return Ok(true);
            }
        }
        Ok(true)
    }

    /// Whether the stable step is no longer what the steps were planned by.
    fn limit_has_moved(&self) -> bool {
        let Some(now) = self.solver.moving_time_step(self.stable_time_step) else { return false };
        let change = now / self.stable_time_step;
        let rises = self.formulation == Formulation::Updated && change > 1.0 + LIMIT_SLACK;
        // NaN counts as moved.
        rises || change < 1.0 - LIMIT_SLACK || change.is_nan()
    }
}
