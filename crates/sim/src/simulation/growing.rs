//! One step of a simulation and what it makes the cracks do.

use super::Simulation;
use crate::SimulationError;
use crate::crack::Crack;
use crate::crack::assessment::Assessment;
use crate::crack::cracks::TipId;
use crate::crack::tip::Tip;
use crate::growth::{self, Advance, Cost};
use crate::solver::Observed;
use crate::tip::gauge::Gauge;
use fissure_scene::{CrackEnd, End, Point, TipState, Vector};

/// Increments one tip may take in one step: with a step of 0.9 h/c_d and quarter cells, more would be faster than any
/// wave.
const MOST_INCREMENTS_PER_STEP: usize = 4;

/// Part of an increment that a tip takes at once to give it its direction.
const FIRST_PART: f64 = 1e-3;

/// The most energy that a tip may keep for later, as the length that it pays for, in cells. What the lattice releases
/// per length varies within a cell: in one part of it a tip takes a little too much, in the next too little.
const BALANCE_CELLS: f64 = 0.05;

/// A tip stays where it is rather than move by less than this, in cells.
const LEAST_SLIDE: f64 = 1e-12;

/// Halvings of an increment in search of what a tip can pay: down to round-off, or scenes of another size would part.
const HALVINGS: u32 = 54;

/// A growing tip that has not moved for so many steps is at rest.
const ARREST_STEPS: u32 = 50;

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
        for (&id, &m) in live.iter().zip(&assessed) {
            self.pay_drag(id);
            self.grow(id, m, time, time_step);
        }
        Ok(())
    }

    /// What drag has taken counts as taken by the tip.
    fn pay_drag(&mut self, id: TipId) {
        let Some(sliding) = self.solver.sliding_mut() else { return };
        let energy = sliding.take_drag(id);
        self.state.crack_energy += energy;
        if let Some(tip) = self.state.cracks.tip_mut(id) {
            tip.balance += energy;
        }
    }

    /// Lets one tip grow as far as the energy balance and the speed limit allow within a step that ends at `time`.
    fn grow(&mut self, id: TipId, first: Assessment, time: f64, time_step: f64) {
        let may_run = growth::speed_limit(&self.state.cracks, id, &self.scene, &self.elastic, time) * time_step;
        if let Some(tip) = self.state.cracks.tip_mut(id) {
            // A tip that waits may save up the way of one step and no more; it shall not leap later.
            tip.ahead_of_limit = (tip.ahead_of_limit - may_run).max(-may_run);
        }
        let mut assessed = first;
        for increment in 0..MOST_INCREMENTS_PER_STEP {
            let cracks = &self.state.cracks;
            let Some(tip) = cracks.tip(id) else { return };
            let held = may_run <= 0.0 || tip.ahead_of_limit > 0.0;
            if held || !growth::wants_to_grow(cracks, id, &assessed, &self.scene, time, self.solver.sliding().is_some())
            {
                if increment == 0 {
                    self.rest(id, held);
                }
                return;
            }
            if cracks.left_of_increment(id).is_none() {
                if let Some(branches) = growth::branches(cracks, id, &assessed, &self.scene, &self.elastic) {
                    self.divide(id, branches, &assessed);
                    return;
                }
                let Some(advance) = growth::next_increment(cracks, id, &assessed, &self.scene, time) else { return };
                self.begin_increment(id, &advance, &assessed);
                if self.state.cracks.end(id) != CrackEnd::Tip {
                    return;
                }
            }
            if !self.slide(id, &assessed, time) {
                if increment == 0 {
                    self.rest(id, false);
                }
                return;
            }
            assessed = self.assess(id);
        }
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
                self.state.crack_energy += assessed.released.max(0.0) * length;
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

    /// Lets a tip run through its increment as far as it can pay. Whether it has come to the end of it.
    ///
    /// What the tip takes out of the body on the way is what the way costs: the energy balance holds over every
    /// stretch, not only at the moment when growth begins.
    fn slide(&mut self, id: TipId, assessed: &Assessment, time: f64) -> bool {
        let cracks = &self.state.cracks;
        let Some(tip) = cracks.tip(id) else { return false };
        let Some(left) = cracks.left_of_increment(id) else { return true };
        let (cost, most) = match growth::cost(cracks, id, assessed, &self.scene, time) {
            Cost::Scheduled(due) => (0.0, due),
            Cost::Energy(cost) => (cost, f64::INFINITY),
        };
        let most = most.min(left).min(-tip.ahead_of_limit);
        let slack = BALANCE_CELLS * self.scene.cell_size * cost;
        let balance = tip.balance.min(slack);
        let Some(sliding) = self.solver.sliding() else { return true };
        let release = sliding.release(cracks, id);
        let distance = affordable(most, |distance| balance + release(distance) - cost * distance);
        let arrives = distance >= left;
        if !arrives && distance < LEAST_SLIDE * self.scene.cell_size {
            return false;
        }
        let taken = release(distance);
        self.state.cracks.slide(id, distance);
        if let Some(tip) = self.state.cracks.tip_mut(id) {
            tip.balance = (balance + taken - cost * distance).max(0.0);
        }
        self.state.crack_energy += taken;
        if let Some(sliding) = self.solver.sliding_mut() {
            sliding.slide(&self.state.cracks, id);
        }
        arrives
    }

    /// A tip that does not grow in this step; `held`: by the speed limit alone.
    fn rest(&mut self, id: TipId, held: bool) {
        let Some(tip) = self.state.cracks.tip_mut(id) else { return };
        tip.steps_at_rest = if held { 0 } else { tip.steps_at_rest.saturating_add(1) };
        if tip.state == TipState::Growing && tip.steps_at_rest > ARREST_STEPS {
            tip.state = TipState::Arrested;
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

    /// Measures a tip between steps.
    fn assess(&mut self, id: TipId) -> Assessment {
        self.counts.looks += 1;
        let gauge = Gauge { scene: &self.scene, elastic: &self.elastic };
        let cracks = &self.state.cracks;
        let mut assessed = growth::assess(&gauge.read(&*self.solver, cracks, id), &self.scene);
        assessed.fracture_toughness = growth::toughness_ahead(cracks, id, &assessed, &self.scene);
        assessed
    }

    /// Measures every live tip now.
    pub fn measure_all(&mut self) {
        for id in self.state.cracks.live() {
            let m = self.assess(id);
            if let Some(tip) = self.state.cracks.tip_mut(id) {
                tip.assessment = m;
            }
        }
    }
}

/// The farthest way, up to `most`, at the end of which `balance` is not negative. The balance is concave: softening
/// gives less the farther it goes.
fn affordable(most: f64, balance: impl Fn(f64) -> f64) -> f64 {
    if most <= 0.0 {
        return 0.0;
    }
    if balance(most) >= 0.0 {
        return most;
    }
    let (mut enough, mut too_far) = (0.0, most);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (enough + too_far);
        if balance(middle) >= 0.0 {
            enough = middle;
        } else {
            too_far = middle;
        }
    }
    enough
}
