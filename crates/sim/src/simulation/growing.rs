//! One step of a simulation and what it makes the cracks do.

use super::Simulation;
use crate::SimulationError;
use crate::crack::{Crack, ENDS, Measured, Tip, slot};
use crate::growth::{self, Advance, Cost};
use crate::solver::Observed;
use crate::tip::gauge::Gauge;
use fissure_scene::{CrackEnd, End, Point, TipState, Vector};

/// Increments one tip may take in one step: with a step of 0.9 h/c_d and quarter cells, more would be faster than any wave.
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
/// ... is looked at only once in so many steps: with a step of half a cell's wave time or less a wave goes two cells in them, half a radius of the integral.
const STEPS_BETWEEN_LOOKS: u32 = 4;

impl Simulation {
    /// One step and what it makes the cracks do. `is_last`: the last one of a frame, after which the records of all tips are wanted.
    pub(super) fn one_step(&mut self, time_step: f64, is_last: bool) -> Result<(), SimulationError> {
        let Self { scene, elastic, solver, state, .. } = self;
        let gauge = Gauge { scene, elastic };
        let every = is_last || !scene.growth.enabled;
        let mut live = live_tips(&state.cracks);
        live.retain(|&(crack, end)| {
            let Some(tip) = &mut state.cracks[crack].tips[slot(end)] else { return false };
            let wait = tip.steps_to_look > 0 && !every;
            tip.steps_to_look = if wait { tip.steps_to_look - 1 } else { 0 };
            !wait
        });
        let cracks = &state.cracks;
        let mut measured: Vec<Measured> = Vec::with_capacity(live.len());
        let mut observe = |moment: &dyn Observed| {
            for &(crack, end) in &live {
                measured.push(growth::judge(&gauge.measure(moment, cracks, crack, end), scene));
            }
        };
        solver.step(cracks, state.time, time_step, &mut observe)?;
        state.steps += 1;
        for (&(crack, end), m) in live.iter().zip(&mut measured) {
            let heading = growth::heading(&state.cracks[crack], end, m, scene, elastic, time_step);
            if let Some(tip) = &mut state.cracks[crack].tips[slot(end)] {
                tip.heading = heading;
            }
            m.fracture_toughness = growth::toughness_ahead(&state.cracks[crack], end, m, scene);
            if let Some(tip) = &mut state.cracks[crack].tips[slot(end)] {
                tip.measured = *m;
                let is_far = m.equivalent < FAR_FROM_GROWTH * m.fracture_toughness;
                let has_schedule = tip.guide.as_ref().is_some_and(|g| g.due(0.0, 0.0).is_some());
                if tip.state != TipState::Growing && is_far && !has_schedule {
                    tip.steps_to_look = STEPS_BETWEEN_LOOKS - 1;
                }
            }
        }
        let time = state.time + time_step;
        for (&(crack, end), &m) in live.iter().zip(&measured) {
            self.pay_drag(crack, end);
            self.grow(crack, end, m, time, time_step);
        }
        Ok(())
    }

    /// What drag has taken counts as taken by the tip.
    fn pay_drag(&mut self, crack: usize, end: End) {
        let energy = self.solver.take_drag(crack, end);
        self.state.crack_energy += energy;
        if let Some(tip) = &mut self.state.cracks[crack].tips[slot(end)] {
            tip.balance += energy;
        }
    }

    /// Lets one tip grow as far as the energy balance and the speed limit allow within a step that ends at `time`.
    fn grow(&mut self, crack: usize, end: End, first: Measured, time: f64, time_step: f64) {
        let may_run = growth::speed_limit(&self.state.cracks[crack], end, &self.scene, &self.elastic, time) * time_step;
        if let Some(tip) = &mut self.state.cracks[crack].tips[slot(end)] {
            // A tip that waits may save up the way of one step and no more; it shall not leap later.
            tip.ahead_of_limit = (tip.ahead_of_limit - may_run).max(-may_run);
        }
        let mut measured = first;
        for increment in 0..MOST_INCREMENTS_PER_STEP {
            let line = &self.state.cracks[crack];
            let Some(tip) = &line.tips[slot(end)] else { return };
            let held = may_run <= 0.0 || tip.ahead_of_limit > 0.0;
            if held || !growth::wants_to_grow(line, end, &measured, &self.scene, time, self.solver.slides()) {
                if increment == 0 {
                    self.rest(crack, end, held);
                }
                return;
            }
            if tip.target.is_none() {
                if let Some(branches) =
                    growth::branches(&self.state.cracks, crack, end, &measured, &self.scene, &self.elastic)
                {
                    self.divide(crack, end, branches, &measured);
                    return;
                }
                let Some(advance) = growth::advance(&self.state.cracks, crack, end, &measured, &self.scene, time)
                else {
                    return;
                };
                self.begin_increment(crack, end, &advance, &measured);
                if self.state.cracks[crack].ends[slot(end)] != CrackEnd::Tip {
                    return;
                }
            }
            if !self.slide(crack, end, &measured, time) {
                if increment == 0 {
                    self.rest(crack, end, false);
                }
                return;
            }
            measured = self.measure(crack, end);
        }
    }

    /// Sets a tip on its way through an increment, or at its end where tips only jump or the increment is not like others.
    fn begin_increment(&mut self, crack: usize, end: End, advance: &Advance, measured: &Measured) {
        let from = self.state.cracks[crack].tip_position(end);
        match advance.points[..] {
            [target] if self.solver.slides() && advance.end == CrackEnd::Tip && advance.state == TipState::Growing => {
                self.add_points(crack, end, &[from + (target - from) * FIRST_PART], TipState::Growing);
                if let Some(tip) = &mut self.state.cracks[crack].tips[slot(end)] {
                    tip.target = Some(target);
                }
            }
            _ => {
                let length = self.add_points(crack, end, &advance.points, advance.state);
                self.state.crack_energy += measured.released.max(0.0) * length;
            }
        }
        self.state.cracks[crack].ends[slot(end)] = advance.end;
        if !advance.points.is_empty() {
            self.solver.recut(&self.state.cracks, &[(crack, end)]);
        }
    }

    /// Lets a tip run through its increment as far as it can pay. Whether it has come to the end of it.
    ///
    /// What the tip takes out of the body on the way is what the way costs: the energy balance holds over every stretch, not only at the moment when growth begins.
    fn slide(&mut self, crack: usize, end: End, measured: &Measured, time: f64) -> bool {
        let line = &self.state.cracks[crack];
        let Some(tip) = &line.tips[slot(end)] else { return false };
        let Some(target) = tip.target else { return true };
        let from = line.tip_position(end);
        let left = (target - from).norm();
        let (cost, most) = match growth::cost(line, end, measured, &self.scene, time) {
            Cost::Scheduled(due) => (0.0, due),
            Cost::Energy(cost) => (cost, f64::INFINITY),
        };
        let most = most.min(left).min(-tip.ahead_of_limit);
        let slack = BALANCE_CELLS * self.scene.cell_size * cost;
        let balance = tip.balance.min(slack);
        let release = self.solver.release(&self.state.cracks, crack, end);
        let distance = affordable(most, |distance| balance + release(distance) - cost * distance);
        let arrives = distance >= left;
        if !arrives && distance < LEAST_SLIDE * self.scene.cell_size {
            return false;
        }
        let taken = release(distance);
        let to = if arrives { target } else { from + (target - from) * (distance / left) };
        let line = &mut self.state.cracks[crack];
        line.move_end(end, to);
        if let Some(tip) = &mut line.tips[slot(end)] {
            tip.take_up(distance);
            tip.balance = (balance + taken - cost * distance).max(0.0);
            if arrives {
                tip.target = None;
            }
        }
        self.state.crack_energy += taken;
        self.solver.slide(&self.state.cracks, crack, end);
        arrives
    }

    /// A tip that does not grow in this step; `held`: by the speed limit alone.
    fn rest(&mut self, crack: usize, end: End, held: bool) {
        let Some(tip) = &mut self.state.cracks[crack].tips[slot(end)] else { return };
        tip.steps_at_rest = if held { 0 } else { tip.steps_at_rest.saturating_add(1) };
        if tip.state == TipState::Growing && tip.steps_at_rest > ARREST_STEPS {
            tip.state = TipState::Arrested;
        }
    }

    /// Adds points to an end. Returns the length that they add [m].
    fn add_points(&mut self, crack: usize, end: End, points: &[Point], state: TipState) -> f64 {
        let line = &mut self.state.cracks[crack];
        let before = line.length();
        for &p in points {
            line.push(end, p);
        }
        let length = line.length() - before;
        if let Some(tip) = &mut line.tips[slot(end)] {
            tip.state = state;
            tip.take_up(length);
        }
        length
    }

    /// Divides a tip: it goes on along the left branch, a new crack that begins at it along the right one.
    fn divide(&mut self, crack: usize, end: End, branches: [Vec<Point>; 2], measured: &Measured) {
        let from = self.state.cracks[crack].tip_position(end);
        let [left, right] = branches;
        // The first length of both together releases what one straight on would have.
        let length = self.add_points(crack, end, &left, TipState::Growing);
        self.state.crack_energy += measured.released.max(0.0) * length;
        let mut points = vec![from];
        points.extend(right);
        let mut twin = Tip::new(None);
        twin.take_up(points.windows(2).map(|w| (w[1] - w[0]).norm()).sum());
        let line = &mut self.state.cracks[crack];
        if let Some(tip) = &mut line.tips[slot(end)] {
            tip.since_division = 0.0;
            // Each branch goes its own way from here.
            tip.guide = None;
            tip.heading = Vector::zeros();
            twin.state = tip.state;
            twin.since_division = 0.0;
        }
        let ends = [CrackEnd::Junction { crack: crack as u32 }, CrackEnd::Tip];
        let body = line.body;
        self.state.cracks.push(Crack { body, points, ends, tips: [None, Some(twin)] });
        let new = self.state.cracks.len() - 1;
        self.solver.recut(&self.state.cracks, &[(crack, end), (new, End::End)]);
    }

    /// Measures a tip between steps.
    fn measure(&self, crack: usize, end: End) -> Measured {
        let gauge = Gauge { scene: &self.scene, elastic: &self.elastic };
        let cracks = &self.state.cracks;
        let mut measured = growth::judge(&gauge.measure(self.solver.observed(), cracks, crack, end), &self.scene);
        measured.fracture_toughness = growth::toughness_ahead(&cracks[crack], end, &measured, &self.scene);
        measured
    }

    /// Measures every live tip now.
    pub fn measure_all(&mut self) {
        for (crack, end) in live_tips(&self.state.cracks) {
            let m = self.measure(crack, end);
            if let Some(tip) = &mut self.state.cracks[crack].tips[slot(end)] {
                tip.measured = m;
            }
        }
    }
}

/// The farthest way, up to `most`, at the end of which `balance` is not negative. The balance is concave: softening gives less the farther it goes.
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

fn live_tips(cracks: &[Crack]) -> Vec<(usize, End)> {
    let live = |c: &Crack, end: End| c.tips[slot(end)].as_ref().is_some_and(|t| t.state.is_live());
    cracks
        .iter()
        .enumerate()
        .flat_map(|(i, c)| ENDS.into_iter().filter(move |&end| live(c, end)).map(move |end| (i, end)))
        .collect()
}
