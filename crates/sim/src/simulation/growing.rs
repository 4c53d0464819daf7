//! One step of a simulation and what it makes the cracks do.

use super::Simulation;
use super::stages::Stage;
use crate::SimulationError;
use crate::crack::assessment::Assessment;
use crate::crack::cracks::{Cracks, TipId};
use crate::crack::tip::Tip;
use crate::growth::{self, Advance};
use crate::solver::Observed;
use crate::threads;
use crate::tip::gauge::Gauge;
use fissure_scene::{CrackEnd, End, Point, Scene, TipState, Vector};

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

/// A tip that has been in its last ligament for so many of these times, at less than some tenths of c_R, breaks the
/// rest of it at once.
const IN_LIGAMENT: f64 = 25.0;

/// A resting tip whose K_eq is below this part of the toughness ...
const FAR_FROM_GROWTH: f64 = 0.7;
/// ... is looked at only once in so many steps: with a step of half a cell's wave time or less a wave goes two cells in
/// them, half a radius of the integral.
const STEPS_BETWEEN_LOOKS: u32 = 4;

/// A resting tip whose K_eq was below this part of the toughness when it was measured last is asked first for what
/// costs less than a look and says that it is far from growth still.
const ASKS_J: f64 = 0.45;

/// Tips nearer to each other than this, in cells, may meet within an increment.
const IN_EACH_OTHERS_WAY: f64 = 2.5;

/// Time over which the pace of a tip is averaged, over the time a wave takes for a cell.
const PACE_CELLS: f64 = 12.0;

/// A tip in a step.
#[derive(Debug)]
struct Runner {
    id: TipId,
    assessed: Assessment,
    /// Whether its speed limit lets it run at all.
    may_run: bool,
    /// See [`Simulation::runs`].
    runs: bool,
}

/// What a tip does next.
#[derive(Debug)]
enum Decision {
    /// It does not grow.
    Rest,
    /// Its speed limit holds it.
    Wait,
    /// It goes on through its increment.
    GoOn,
    Begin(Advance),
    Divide([Vec<Point>; 2]),
}

impl Simulation {
    /// One step and what it makes the cracks do. `is_last`: the last one of a frame, after which the records of all
    /// tips are wanted.
    pub(super) fn one_step(&mut self, time_step: f64, is_last: bool) -> Result<(), SimulationError> {
        let Self { scene, elastic, solver, state, counts, stages, contours, spares_looks, .. } = self;
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
        let spares = *spares_looks && !every;
        // None: at rest, and too far from growth to be looked at.
        let mut assessed: Vec<Option<Assessment>> = Vec::with_capacity(live.len());
        contours.clear();
        stages.enter(Stage::Motion);
        let is_wanted = contours.is_wanted();
        let mut observe = |moment: &dyn Observed| {
            stages.enter(Stage::Looks);
            let look = |&id: &TipId| {
                let toughness = if spares { tough_at_rest(cracks, id, scene) } else { None };
                if toughness.is_some_and(|toughness| gauge.is_below(moment, cracks, id, FAR_FROM_GROWTH * toughness)) {
                    return (None, Vec::new());
                }
                let found = growth::assess(&gauge.read(moment, cracks, id), scene);
                (Some(found), if is_wanted { gauge.contours(moment, cracks, id) } else { Vec::new() })
            };
            // Looks change nothing, so that it does not matter which tip comes first.
            for (found, of_contours) in threads::of_each(&live, look) {
                assessed.push(found);
                contours.keep(of_contours);
            }
            stages.enter(Stage::Motion);
        };
        solver.step(cracks, state.time, time_step, &mut observe)?;
        stages.enter(Stage::Growth);
        state.steps += 1;
        counts.steps += 1;
        counts.looks += assessed.iter().flatten().count() as u64;
        for (&id, m) in live.iter().zip(&mut assessed) {
            let Some(m) = m else {
                state.cracks.tip_mut(id).into_iter().for_each(|tip| tip.steps_to_look = STEPS_BETWEEN_LOOKS - 1);
                continue;
            };
            let heading = growth::heading(&state.cracks, id, m, scene, elastic, time_step);
            if let Some(tip) = state.cracks.tip_mut(id) {
                tip.heading = heading;
            }
            m.fracture_toughness = growth::toughness_ahead(&state.cracks, id, m, scene);
            if let Some(tip) = state.cracks.tip_mut(id) {
                tip.assessment = *m;
                let is_far = m.equivalent < FAR_FROM_GROWTH * m.fracture_toughness;
                if tip.state != TipState::Growing && is_far && !tip.has_schedule() {
                    tip.steps_to_look = STEPS_BETWEEN_LOOKS - 1;
                }
            }
        }
        let time = state.time + time_step;
        self.settle_strains();
        let mut tips = Vec::with_capacity(live.len());
        for (id, assessed) in live.into_iter().zip(assessed) {
            // What has not been measured anew is as it was; such a tip does not grow.
            let last = self.state.cracks.tip(id).map(|tip| tip.assessment).unwrap_or_default();
            let runner = self.ready(id, assessed.unwrap_or(last), time, time_step);
            tips.extend(assessed.map(|_| runner));
        }
        self.grow(tips, time);
        self.give_back();
        self.branch_off(time);
        self.state.cracks.date(time);
        self.stages.enter(Stage::Between);
        Ok(())
    }

    /// A tip after a step that ends at `time`, ready to grow: what it may run is counted, and its account is settled.
    fn ready(&mut self, id: TipId, assessed: Assessment, time: f64, time_step: f64) -> Runner {
        let limit = growth::speed_limit(&self.state.cracks, id, &self.scene, &self.elastic, time);
        self.settle_account(id, &assessed, limit);
        let may_run = limit * time_step;
        let crossing_time = self.crossing_time(id);
        let window = PACE_CELLS * crossing_time;
        if let Some(tip) = self.state.cracks.tip_mut(id) {
            tip.keep_pace(assessed.j_integral, time_step, window);
            // What a tip that waits saves up is bounded; it shall not leap later.
            let most_saved = may_run + SAVED_WAY * self.scene.cell_size;
            tip.ahead_of_limit = (tip.ahead_of_limit - may_run).max(-most_saved);
            tip.time_at_rest += time_step;
            tip.time_in_ligament = if tip.is_in_last_ligament { tip.time_in_ligament + time_step } else { 0.0 };
        }
        Runner { id, assessed, may_run: may_run > 0.0, runs: self.runs(id, crossing_time) }
    }

    /// Lets tips grow as far as the energy balance and their speed limits allow, up to the time `time`.
    ///
    /// In rounds of an increment: all decide what they do next on what they have left of the last round, then all are
    /// cut at once, then all slide. So no tip comes before another, and what is symmetric stays so.
    fn grow(&mut self, mut tips: Vec<Runner>, time: f64) {
        for round in 0..MOST_INCREMENTS_PER_STEP {
            if round > 0 {
                for tip in &mut tips {
                    let cracks = &self.state.cracks;
                    tip.assessed.fracture_toughness =
                        growth::toughness_ahead(cracks, tip.id, &tip.assessed, &self.scene);
                }
            }
            let decided: Vec<Decision> = tips.iter().map(|tip| self.decide(tip, time)).collect();
            let mut changed: Vec<TipId> = Vec::new();
            let mut sliding = Vec::with_capacity(tips.len());
            for (tip, decision) in tips.into_iter().zip(decided) {
                if self.follow(&tip, decision, time, &mut changed) {
                    sliding.push(tip);
                }
            }
            if !changed.is_empty() {
                self.recut(&changed);
            }
            sliding.retain(|tip| {
                let arrives = self.slide(tip.id, &tip.assessed, time);
                // One that stands only until it can pay a debt has not come to rest.
                if !arrives && !self.state.cracks.tip(tip.id).is_some_and(Tip::is_in_debt) {
                    self.rest(tip.id);
                }
                arrives
            });
            if sliding.is_empty() {
                return;
            }
            tips = sliding;
        }
    }

    /// Cuts around tips that have got farther. What a cut loses has been taken out of the body by their way as well.
    pub(super) fn recut(&mut self, changed: &[TipId]) {
        let lost = self.solver.recut(&self.state.cracks, changed);
        self.state.crack_energy += lost;
        for &id in changed {
            if let Some(tip) = self.state.cracks.tip_mut(id) {
                tip.balance += lost / changed.len() as f64;
            }
        }
        self.counts.recuts += changed.len() as u64;
    }

    /// What a tip does next.
    fn decide(&self, tip: &Runner, time: f64) -> Decision {
        let (cracks, scene, assessed) = (&self.state.cracks, &self.scene, &tip.assessed);
        let Some(of) = cracks.tip(tip.id) else { return Decision::Rest };
        if !tip.may_run || of.ahead_of_limit > 0.0 {
            return Decision::Wait;
        }
        let slides = self.solver.sliding().is_some();
        // What is too near for an integral breaks once a tip that ran to it hardly runs any more.
        let breaks = of.is_in_last_ligament && of.state == TipState::Growing && !tip.runs;
        if breaks {
            return growth::next_increment(cracks, tip.id, assessed, scene, time, false)
                .map_or(Decision::Wait, Decision::Begin);
        }
        if !tip.runs && !growth::wants_to_grow(cracks, tip.id, assessed, scene, time, slides) {
            return Decision::Rest;
        }
        if cracks.left_of_increment(tip.id).is_some() {
            return Decision::GoOn;
        }
        if let Some(branches) = growth::branches(cracks, tip.id, assessed, scene, &self.elastic) {
            return Decision::Divide(branches);
        }
        growth::next_increment(cracks, tip.id, assessed, scene, time, tip.runs).map_or(Decision::Wait, Decision::Begin)
    }

    /// Does what a tip has decided; `changed` are the tips that are to be cut before any slides, those that others have
    /// changed in this round too. Whether the tip is to slide.
    fn follow(&mut self, tip: &Runner, decision: Decision, time: f64, changed: &mut Vec<TipId>) -> bool {
        let id = tip.id;
        if !self.state.cracks.tip(id).is_some_and(|tip| tip.state.is_live()) {
            // Another one has ended on it in this round.
            return false;
        }
        match decision {
            Decision::Rest => self.rest(id),
            // Held by its limit alone, a tip does not come to rest.
            Decision::Wait => self.forget_rest(id),
            Decision::GoOn => {
                if let Some(tip) = self.state.cracks.tip_mut(id).filter(|tip| tip.state != TipState::Growing) {
                    // It had come to rest on its way, and starts anew.
                    (tip.state, tip.time_at_rest) = (TipState::Growing, 0.0);
                }
                return true;
            }
            Decision::Divide(branches) => changed.extend(self.divide(id, branches, &tip.assessed)),
            Decision::Begin(advance) => {
                // What another tip has just put in its way it sees.
                let from = self.state.cracks.position(id);
                let is_near = |&other: &TipId| {
                    (self.state.cracks.position(other) - from).norm() < IN_EACH_OTHERS_WAY * self.scene.cell_size
                };
                let advance = if changed.iter().any(is_near) {
                    growth::next_increment(&self.state.cracks, id, &tip.assessed, &self.scene, time, tip.runs)
                } else {
                    Some(advance)
                };
                let Some(advance) = advance else { return false };
                self.begin_increment(id, &advance, &tip.assessed);
                if !advance.points.is_empty() {
                    changed.push(id);
                }
                if let Some(met) = advance.meets {
                    self.state.cracks.end_on(met, id.crack);
                    if !changed.contains(&met) {
                        changed.push(met);
                    }
                }
                return self.state.cracks.end(id) == CrackEnd::Tip;
            }
        }
        false
    }

    /// Whether a tip is on its way, so that its account alone says how far it goes. J swings by a half from step to
    /// step with the waves that every increment sends out; a tip that asked it each time would stand still now and
    /// then with ample credit, and what it takes meanwhile would be lost to it.
    /// `crossing_time`: that of a wave for a cell [s].
    fn runs(&self, id: TipId, crossing_time: f64) -> bool {
        let cracks = &self.state.cracks;
        let Some(tip) = cracks.tip(id) else { return false };
        tip.state == TipState::Growing
            && self.solver.sliding().is_some()
            && !tip.has_schedule()
            && tip.time_at_rest < STANDS_STILL * crossing_time
            && tip.time_in_ligament < IN_LIGAMENT * crossing_time
    }

    /// Time a wave takes for a cell at a tip [s].
    fn crossing_time(&self, id: TipId) -> f64 {
        self.scene.cell_size / self.elastic[self.material_at(id)].dilatational_wave_speed()
    }

    /// The material at a tip.
    pub(super) fn material_at(&self, id: TipId) -> usize {
        let cracks = &self.state.cracks;
        self.scene.bodies[cracks.of(id).body as usize].material_at(cracks.position(id))
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
                self.book_leap(&[id], assessed, length);
            }
        }
        let cracks = &mut self.state.cracks;
        if let Some(tip) = cracks.tip_mut(id) {
            tip.state = advance.state;
            tip.is_in_last_ligament = advance.is_in_last_ligament;
        }
        cracks.set_end(id, advance.end);
    }

    /// Books what a tip that jumps takes by its J; where tips slide, what a leap takes is what its cut does, and what
    /// it costs is to be paid with that.
    fn book_leap(&mut self, ids: &[TipId], assessed: &Assessment, length: f64) {
        let Some(&first) = ids.first() else { return };
        let critical = growth::critical_release(&self.state.cracks, first, assessed, &self.scene, &self.elastic);
        if self.solver.sliding().is_none() {
            // The first length of two branches together releases what one straight on would have.
            self.state.crack_energy += assessed.released.clamp(0.0, critical) * length;
            return;
        }
        for &id in ids {
            self.state.cracks.tip_mut(id).into_iter().for_each(|tip| tip.leaps += critical * length);
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

    /// Divides a tip: it goes on along the left branch, a new crack that begins at it along the right one, both alike.
    fn divide(&mut self, id: TipId, branches: [Vec<Point>; 2], assessed: &Assessment) -> Vec<TipId> {
        let [left, right] = branches;
        let cracks = &mut self.state.cracks;
        let points = [vec![cracks.position(id)], right].concat();
        let length = cracks.grow(id, &left);
        let Some(twin) = cracks.tip_mut(id).map(|tip| tip.divide(length)) else { return Vec::new() };
        let new = cracks.add(cracks.of(id).branch(id.crack, points, twin));
        let branches = vec![id, TipId::new(new, End::End)];
        self.book_leap(&branches, assessed, length);
        branches
    }

    /// From now on, between frames, tips at rest that cannot come near to growth are not measured: [`Simulation::tips`]
    /// tells what was measured before. Changes nothing of the run, and of its frames only what they tell of a tip that
    /// another crack has ended: that is of its last look.
    pub fn spare_looks(&mut self) {
        self.spares_looks = true;
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

/// The toughness of a tip at rest that is known to have a look only for whether it comes near to it; none where a look
/// may say more.
fn tough_at_rest(cracks: &Cracks, id: TipId, scene: &Scene) -> Option<f64> {
    let tip = cracks.tip(id)?;
    // The first look gives a tip its heading. What a guide asks for may have more hoop stress than where a kink heads.
    let is_known = tip.heading != Vector::zeros();
    if !is_known || tip.guide.is_some() || tip.state == TipState::Growing {
        return None;
    }
    // What was nearer than this when it was looked at last would be looked at twice.
    let toughness = growth::toughness_everywhere(cracks, id, scene)?;
    (tip.assessment.equivalent < ASKS_J * toughness).then_some(toughness)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::test_scenes::{add_crack, free_body, rectangle};
    use fissure_scene::{BoxSide, Curve, Formulation, JMethod, Load, LoadKind, ModeSplit, Selection, TipDivision};
    use std::ops::ControlFlow;

    /// Truth: the run that measures at every look. Three flaws of a plate that is pulled, of which some get on and the
    /// others stay: looks that are spared change nothing, and they are many.
    #[test]
    fn looks_that_are_spared_change_nothing() {
        let mut scene = free_body(rectangle([0.0, 0.0], [4.0, 4.0]), 0.1);
        scene.solver.formulation = Formulation::Total;
        scene.growth.enabled = true;
        let stress = 1e-3 * scene.materials[0].young_modulus;
        scene.materials[0].fracture_toughness = 1.9 * stress;
        for (side, pull) in [(BoxSide::Top, stress), (BoxSide::Bottom, -stress)] {
            let kind = LoadKind::Traction(Vector::new(0.0, pull));
            let curve = Curve { points: vec![(0.0, 0.0), (1.0, 1.0)] };
            scene.loads.push(Load { selection: Selection::Edge { side, bodies: None }, kind, curve });
        }
        add_crack(&mut scene, &[[1.2, 2.03], [2.8, 2.1]]);
        add_crack(&mut scene, &[[0.8, 3.0], [1.2, 3.3]]);
        add_crack(&mut scene, &[[2.8, 0.8], [3.2, 1.1]]);
        scene.cracks.iter_mut().for_each(|crack| (crack.start_live, crack.end_live) = (true, true));
        scene.solver.tip_division = TipDivision::PartlyCut;
        scene.solver.j_method = JMethod::Domain;
        scene.solver.mode_split = ModeSplit::Interaction;
        let largest = Simulation::new(&scene).unwrap().stable_time_step;
        scene.frames.last = 12;
        scene.frames.rate = 1.0 / (15.0 * largest);
        for load in &mut scene.loads {
            load.curve.points[1].0 = 90.0 * largest;
        }
        let runs = [false, true].map(|spares| {
            let mut simulation = Simulation::new(&scene).unwrap();
            if spares {
                simulation.spare_looks();
            }
            let mut frames = Vec::new();
            while !simulation.is_finished() {
                simulation.advance(&mut |_| ControlFlow::Continue(())).unwrap();
                frames.push(format!("{:?}", simulation.frame()));
            }
            let grown: Vec<bool> = simulation.tips().iter().map(|tip| tip.state != TipState::Resting).collect();
            (frames, simulation.counts(), grown)
        });
        let [(frames, all, grown), (of_sparing, spared, _)] = runs;
        assert!(frames == of_sparing);
        assert!(grown.contains(&true) && grown.contains(&false), "{grown:?}");
        assert!(spared.recuts == all.recuts && all.recuts > 10, "{all:?}");
        assert!(5 * spared.looks < 4 * all.looks, "{} of {}", spared.looks, all.looks);
    }
}
