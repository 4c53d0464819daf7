//! One step of a simulation and what it makes the cracks do.

use super::Simulation;
use crate::SimulationError;
use crate::crack::Crack;
use crate::crack::assessment::Assessment;
use crate::crack::cracks::TipId;
use crate::crack::tip::Tip;
use crate::growth::{self, Advance};
use crate::solver::Observed;
use crate::tip::gauge::Gauge;
use fissure_scene::{CrackEnd, End, Point, TipState, Vector};

/// Increments one tip may take in one step: with a step of 0.9 h/c_d and quarter cells, more would be faster than any
/// wave.
const MOST_INCREMENTS_PER_STEP: usize = 4;

/// Part of an increment that a tip takes at once to give it its direction.
const FIRST_PART: f64 = 1e-3;

/// What a tip that waits may save up of the way that its speed limit allows, beyond that of the step, in cells. What
/// the lattice releases varies within a cell, and a tip runs through it now faster, now more slowly.
const SAVED_WAY: f64 = 0.2;

/// A growing tip that has not moved for so many times that a wave takes for a cell runs no more: it goes on when what
/// is measured says so ...
const STANDS_STILL: f64 = 8.0;
/// ... and after so many it is at rest.
const ARRESTS: f64 = 25.0;

/// A resting tip whose K_eq is below this part of the toughness ...
const FAR_FROM_GROWTH: f64 = 0.7;
/// ... is looked at only once in so many steps: with a step of half a cell's wave time or less a wave goes two cells in
/// them, half a radius of the integral.
const STEPS_BETWEEN_LOOKS: u32 = 4;

impl Simulation {
    /// One step and what it makes the cracks do. `is_last`: the last one of a frame, after which the records of all
    /// tips are wanted.
    pub(super) fn one_step(&mut self, time_step: f64, is_last: bool) -> Result<(), SimulationError> {
        let Self { scene, elastic, solver, state, counts, .. } = self;
        let gauge = Gauge { scene, elastic };
        let every = is_last || !scene.growth.enabled;
        let mut live = state.cracks.live();
        live.retain(|&id| {
            let Some(tip) = state.cracks.tip_mut(id) else { return false };
            let wait = tip.steps_to_look > 0 && !every;
            tip.steps_to_look = if wait { tip.steps_to_look - 1 } else { 0 };
            !wait
        });
        let cracks = &state.cracks;
        let mut assessed: Vec<Assessment> = Vec::with_capacity(live.len());
        let mut observe = |moment: &dyn Observed| {
            for &id in &live {
                assessed.push(growth::assess(&gauge.read(moment, cracks, id), scene));
            }
        };
        solver.step(cracks, state.time, time_step, &mut observe)?;
        state.steps += 1;
        counts.steps += 1;
        counts.looks += live.len() as u64;
        for (&id, m) in live.iter().zip(&mut assessed) {
            let heading = growth::heading(&state.cracks, id, m, scene, elastic, time_step);
            if let Some(tip) = state.cracks.tip_mut(id) {
                tip.heading = heading;
            }
            m.fracture_toughness = growth::toughness_ahead(&state.cracks, id, m, scene);
            if let Some(tip) = state.cracks.tip_mut(id) {
                tip.assessment = *m;
                let is_far = m.equivalent < FAR_FROM_GROWTH * m.fracture_toughness;
                let has_schedule = tip.guide.as_ref().is_some_and(|g| g.due(0.0, 0.0).is_some());
                if tip.state != TipState::Growing && is_far && !has_schedule {
                    tip.steps_to_look = STEPS_BETWEEN_LOOKS - 1;
                }
            }
        }
        let time = state.time + time_step;
        for (&id, m) in live.iter().zip(&assessed) {
            self.settle_account(id, m);
            self.grow(id, m, time, time_step);
        }
        Ok(())
    }

    /// Lets one tip grow as far as the energy balance and the speed limit allow within a step that ends at `time`.
    fn grow(&mut self, id: TipId, assessed: &Assessment, time: f64, time_step: f64) {
        let may_run = growth::speed_limit(&self.state.cracks, id, &self.scene, &self.elastic, time) * time_step;
        let Some(tip) = self.state.cracks.tip_mut(id) else { return };
        // What a tip that waits saves up is bounded; it shall not leap later.
        let most_saved = may_run + SAVED_WAY * self.scene.cell_size;
        tip.ahead_of_limit = (tip.ahead_of_limit - may_run).max(-most_saved);
        tip.time_at_rest += time_step;
        let runs = self.runs(id);
        let assessed = &mut { *assessed };
        for increment in 0..MOST_INCREMENTS_PER_STEP {
            if increment > 0 {
                let toughness = growth::toughness_ahead(&self.state.cracks, id, assessed, &self.scene);
                assessed.fracture_toughness = toughness;
            }
            let cracks = &self.state.cracks;
            let Some(tip) = cracks.tip(id) else { return };
            if may_run <= 0.0 || tip.ahead_of_limit > 0.0 {
                // Held by its limit alone, a tip does not come to rest.
                self.forget_rest(id);
                return;
            }
            let slides = self.solver.sliding().is_some();
            if !runs && !growth::wants_to_grow(cracks, id, assessed, &self.scene, time, slides) {
                break;
            }
            if cracks.left_of_increment(id).is_none() {
                if let Some(branches) = growth::branches(cracks, id, assessed, &self.scene, &self.elastic) {
                    self.divide(id, branches, assessed);
                    return;
                }
                let Some(advance) = growth::next_increment(cracks, id, assessed, &self.scene, time) else { return };
                self.begin_increment(id, &advance, assessed);
                if self.state.cracks.end(id) != CrackEnd::Tip {
                    return;
                }
            } else if let Some(tip) = self.state.cracks.tip_mut(id) {
                // It may have come to rest on its way.
                tip.state = TipState::Growing;
            }
            if !self.slide(id, assessed, time) {
                break;
            }
        }
        self.rest(id);
    }

    /// Whether a tip is on its way, so that its account alone says how far it goes. J swings by a half from step to
    /// step with the waves that every increment sends out; a tip that asked it each time would stand still now and
    /// then with ample credit, and what it takes meanwhile would be lost to it.
    fn runs(&self, id: TipId) -> bool {
        let cracks = &self.state.cracks;
        let Some(tip) = cracks.tip(id) else { return false };
        let has_schedule = tip.guide.as_ref().is_some_and(|g| g.due(0.0, 0.0).is_some());
        tip.state == TipState::Growing
            && self.solver.sliding().is_some()
            && !has_schedule
            && tip.time_at_rest < STANDS_STILL * self.crossing_time(id)
    }

    /// Time a wave takes for a cell at a tip [s].
    fn crossing_time(&self, id: TipId) -> f64 {
        let cracks = &self.state.cracks;
        let material = self.scene.bodies[cracks.of(id).body as usize].material_at(cracks.position(id));
        self.scene.cell_size / self.elastic[material].dilatational_wave_speed()
    }

    /// Sets a tip on its way through an increment, or at its end where tips only jump or the increment is not like
    /// others.
    fn begin_increment(&mut self, id: TipId, advance: &Advance, assessed: &Assessment) {
        let cracks = &mut self.state.cracks;
        match advance.points[..] {
            [target]
                if self.solver.sliding().is_some()
                    && advance.end == CrackEnd::Tip
                    && advance.state == TipState::Growing =>
            {
                cracks.begin_increment(id, target, FIRST_PART);
            }
            _ => {
                let length = cracks.grow(id, &advance.points);
                let most = growth::critical_release(cracks, id, assessed, &self.scene, &self.elastic);
                self.state.crack_energy += assessed.released.clamp(0.0, most) * length;
            }
        }
        if let Some(tip) = cracks.tip_mut(id) {
            tip.state = advance.state;
        }
        cracks.set_end(id, advance.end);
        if !advance.points.is_empty() {
            self.solver.recut(&self.state.cracks, &[id]);
            self.counts.recuts += 1;
        }
    }

    /// A tip that has not moved, or not to the end of what it could.
    fn rest(&mut self, id: TipId) {
        let longest = ARRESTS * self.crossing_time(id);
        let Some(tip) = self.state.cracks.tip_mut(id) else { return };
        if tip.state == TipState::Growing && tip.time_at_rest > longest {
            tip.state = TipState::Arrested;
        }
    }

    fn forget_rest(&mut self, id: TipId) {
        if let Some(tip) = self.state.cracks.tip_mut(id) {
            tip.time_at_rest = 0.0;
        }
    }

    /// Divides a tip: it goes on along the left branch, a new crack that begins at it along the right one.
    fn divide(&mut self, id: TipId, branches: [Vec<Point>; 2], assessed: &Assessment) {
        let from = self.state.cracks.position(id);
        let [left, right] = branches;
        // The first length of both together releases what one straight on would have.
        let length = self.state.cracks.grow(id, &left);
        self.state.crack_energy += assessed.released.max(0.0) * length;
        let mut points = vec![from];
        points.extend(right);
        let mut twin = Tip::new(None);
        twin.add_grown(points.windows(2).map(|w| (w[1] - w[0]).norm()).sum());
        if let Some(tip) = self.state.cracks.tip_mut(id) {
            tip.state = TipState::Growing;
            tip.since_division = 0.0;
            // Each branch goes its own way from here.
            tip.guide = None;
            tip.heading = Vector::zeros();
            twin.state = tip.state;
            twin.since_division = 0.0;
        }
        let body = self.state.cracks.of(id).body;
        let new = self.state.cracks.add(Crack::branch(id.crack, body, points, twin));
        self.solver.recut(&self.state.cracks, &[id, TipId::new(new, End::End)]);
        self.counts.recuts += 1;
    }

    /// Measures every live tip now.
    pub fn measure_all(&mut self) {
        for id in self.state.cracks.live() {
            self.counts.looks += 1;
            let gauge = Gauge { scene: &self.scene, elastic: &self.elastic };
            let cracks = &self.state.cracks;
            let mut m = growth::assess(&gauge.read(&*self.solver, cracks, id), &self.scene);
            m.fracture_toughness = growth::toughness_ahead(cracks, id, &m, &self.scene);
            if let Some(tip) = self.state.cracks.tip_mut(id) {
                tip.assessment = m;
            }
        }
    }
}
