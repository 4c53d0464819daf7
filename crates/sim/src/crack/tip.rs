//! A crack tip while it lives: its state, its guide, and what it may and can pay for.

use super::assessment::Assessment;
use super::guide::GuideWalk;
use crate::saved::{self, Fits};
use fissure_plane::Vector;
use fissure_scene::TipState;
use serde::{Deserialize, Serialize};

/// The most debt of a tip over the most that it needs from one step to the next: with this, what a quarter of a cell
/// costs. A crack that winds has to pay up to a quarter of its cost, at sharp turns at once. Misfits that wait turn the
/// path: `fissure verify shear-notch`, first direction at 8 places, −69.1 ± 0.8° with 1.0, −67.6 ± 1.5° with this,
/// −66.6 ± 2.5° with 0.2. What a tip owes when it stops for good its body keeps: a plate with four flaws of 2.4 cells
/// and a crack beside a soft inclusion gains 1.7 % with 1.0, 0.6 % with this.
const CREDIT: f64 = 0.5;
/// By which part of its cost a tip with the most debt has to take more. `fissure verify wing-cracks`, K_I/K_Ic of wings
/// that run, at 12 cells: 1.002 with this, 0.987 if nothing is paid.
const SURCHARGE: f64 = 0.2;

/// How a tip runs, averaged over the last moments.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Pace {
    /// [m/s]
    pub(crate) speed: f64,
    /// J [J/m²].
    pub(crate) j_integral: f64,
    /// What [`Tip::run`] was at the last moment [m].
    run: f64,
}

/// A crack tip.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Tip {
    /// Whether it rests, grows or has come to its end.
    pub(crate) state: TipState,
    /// Path to follow.
    pub(crate) guide: Option<GuideWalk>,
    /// How far the tip is ahead of what the speed limit allows [m]; it may grow when this is not positive.
    pub(crate) ahead_of_limit: f64,
    /// Time since it grew last [s].
    pub(crate) time_at_rest: f64,
    /// Crack length added since the tip divided last; infinite before it ever did [m].
    pub(crate) since_division: f64,
    /// Steps until it is measured again.
    pub(crate) steps_to_look: u32,
    /// Crack length this tip has added so far [m].
    pub(crate) grown: f64,
    /// What [`Tip::run`] was at the last frame [m].
    pub(crate) run_at_frame: f64,
    /// What was measured last.
    pub(crate) assessment: Assessment,
    /// Energy that the tip has taken out of the body beyond the cost of its growth [J/m]. It pays for growth to come; a
    /// tip in debt, for what its cuts have left strained, takes more than its way costs until that is paid.
    pub(crate) balance: f64,
    /// The most of it that the tip needs from one step to the next [J/m].
    pub(crate) most_balance: f64,
    /// What it had left of its balance when it came to rest or to its end [J/m], below zero what it owed. It pays for
    /// nothing but what its cuts have left strained.
    pub(crate) left_over: f64,
    /// What its leaps have cost, over a last ligament or into two branches, as far as it has not been paid [J/m].
    pub(crate) leaps: f64,
    /// Whether nothing but waves limits its speed.
    pub(crate) is_free: bool,
    /// Whether what lies ahead is too near for an integral: see [`Advance`](crate::growth::Advance).
    pub(crate) is_in_last_ligament: bool,
    /// Time for which that has been so [s].
    pub(crate) time_in_ligament: f64,
    /// Speed [m/s] and J [J/m²], averaged over the last moments while it runs.
    pub(crate) pace: Pace,
    /// Direction of growth asked for by the stress, averaged over the last moments; at rest, not normalised. Zero:
    /// nothing known.
    pub(crate) heading: Vector,
}

impl Tip {
    /// A tip that has not grown yet.
    pub(crate) fn new(guide: Option<GuideWalk>) -> Self {
        Self {
            state: TipState::Resting,
            guide,
            ahead_of_limit: 0.0,
            time_at_rest: 0.0,
            since_division: f64::INFINITY,
            steps_to_look: 0,
            grown: 0.0,
            run_at_frame: 0.0,
            assessment: Assessment::default(),
            balance: 0.0,
            most_balance: 0.0,
            left_over: 0.0,
            leaps: 0.0,
            is_free: true,
            is_in_last_ligament: false,
            time_in_ligament: 0.0,
            pace: Pace::default(),
            heading: Vector::zeros(),
        }
    }

    /// Whether its guide says when it grows.
    pub(crate) fn has_schedule(&self) -> bool {
        self.guide.as_ref().is_some_and(|guide| guide.due(0.0, 0.0).is_some())
    }

    /// The part of the drag of its ties that acts: less the more the tip already has for its way, so that nothing is
    /// taken that pays for nothing. What a limit below the speed of waves holds back is lost to it. Around a tip that
    /// does not grow there is no drag: its body keeps its energy.
    pub(crate) fn part_of_drag(&self) -> f64 {
        if self.state != TipState::Growing {
            return 0.0;
        }
        let is_balanced = self.is_free && self.most_balance > 0.0;
        if is_balanced { (1.0 - self.balance / self.most_balance).clamp(0.0, 1.0) } else { 1.0 }
    }

    /// What of its balance it does not need, while nothing but waves limits its speed [J/m]: all at its end. What its
    /// leaps have cost it pays with this first.
    pub(crate) fn surplus(&mut self) -> f64 {
        if !self.is_free {
            return 0.0;
        }
        let needed = if self.state.is_live() { self.most_balance } else { 0.0 };
        let paid = (self.balance - needed).min(self.leaps).max(0.0);
        self.balance -= paid;
        self.leaps -= paid;
        (self.balance - needed).max(0.0)
    }

    /// What it can give for what its cuts have left strained [J/m]: while it runs, on credit too.
    pub(crate) fn means(&self) -> f64 {
        match self.state {
            TipState::Growing => self.balance + CREDIT * self.most_balance,
            _ => self.balance + self.left_over,
        }
    }

    /// Whether it has paid more than it has taken.
    pub(crate) fn is_in_debt(&self) -> bool {
        self.balance < 0.0
    }

    /// By which part of its cost a tip in debt has to take more than that.
    pub(crate) fn surcharge(&self) -> f64 {
        let most = CREDIT * self.most_balance;
        if self.is_in_debt() && most > 0.0 { SURCHARGE * -self.balance / most } else { 0.0 }
    }

    /// Takes some of what [`Tip::means`] tells of [J/m].
    pub(crate) fn pay(&mut self, energy: f64) {
        *if self.state == TipState::Growing { &mut self.balance } else { &mut self.left_over } -= energy;
    }

    /// Crack length this tip has added so far without what it is ahead of its speed limit [m]: a leap, over the last
    /// ligament or into two branches, counts as it would have been run.
    pub(crate) fn run(&self) -> f64 {
        self.grown - self.ahead_of_limit.max(0.0)
    }

    /// Keeps the pace after a step of `time_step` [s] in which `j_integral` [J/m²] was measured; what lies `window` [s]
    /// back counts 1/e. A tip that does not run has none.
    pub(crate) fn keep_pace(&mut self, j_integral: f64, time_step: f64, window: f64) {
        let run = self.run();
        let speed = (run - self.pace.run) / time_step;
        if self.state != TipState::Growing {
            self.pace = Pace { speed: 0.0, j_integral, run };
        } else if j_integral.is_finite() {
            let part = 1.0 - (-time_step / window).exp();
            self.pace.speed += (speed - self.pace.speed) * part;
            self.pace.j_integral += (j_integral - self.pace.j_integral) * part;
            self.pace.run = run;
        }
    }

    /// Makes this tip and a new one of what it was, at the first length of two branches: alike in all that decides how
    /// they go on. Returns the new one.
    pub(crate) fn divide(&mut self, length: f64) -> Self {
        self.state = TipState::Growing;
        self.since_division = 0.0;
        self.balance *= 0.5;
        self.left_over *= 0.5;
        self.leaps *= 0.5;
        (self.is_in_last_ligament, self.time_in_ligament) = (false, 0.0);
        self.pace = Pace { run: self.run(), ..Pace::default() };
        // Each branch goes its own way from here.
        self.guide = None;
        self.heading = Vector::zeros();
        let mut twin = Self { grown: length, run_at_frame: 0.0, ..self.clone() };
        twin.pace.run = twin.run();
        twin
    }

    /// Checks a tip that was read, in a run with so many `cracks`.
    ///
    /// # Errors
    /// [`SimulationError::BadState`]
    pub(super) fn check(&self, cracks: usize) -> Fits {
        let m = &self.assessment;
        let what = "a tip";
        saved::finite(
            what,
            [
                &self.ahead_of_limit,
                &self.grown,
                &self.run_at_frame,
                &self.time_at_rest,
                &self.balance,
                &self.most_balance,
                &self.left_over,
                &self.leaps,
                &self.time_in_ligament,
            ],
        )?;
        saved::finite(what, [&m.j_integral, &m.mode_1, &m.mode_2, &m.kink_angle, &m.equivalent, &m.released])?;
        saved::finite(what, [&m.fracture_toughness, &m.contour_radius])?;
        saved::finite(what, &self.heading)?;
        // Infinite before the tip has divided.
        saved::ensure(!self.since_division.is_nan(), "the division of a tip")?;
        self.guide.as_ref().map_or(Ok(()), |guide| guide.check(cracks))
    }

    /// Counts growth by `length` [m].
    pub(crate) fn add_grown(&mut self, length: f64) {
        self.grown += length;
        self.since_division += length;
        self.ahead_of_limit += length;
        self.time_at_rest = 0.0;
        if let Some(guide) = &mut self.guide {
            guide.walk(length);
        }
    }
}
