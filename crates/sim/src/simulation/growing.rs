//! One step of a simulation and what it makes the cracks do.

use super::Simulation;
use crate::SimulationError;
use crate::crack::{Crack, ENDS, Measured, Tip, slot};
use crate::growth;
use crate::measure::Gauge;
use crate::solver::Observed;
use fissure_scene::{CrackEnd, End, Point, TipState, Vector};

/// Increments one tip may take in one step: with a step of 0.9 h/c_d and quarter cells, more would be faster than any wave.
const MOST_INCREMENTS_PER_STEP: usize = 4;

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
                measured.push(gauge.measure(moment, cracks, crack, end));
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
            self.grow(crack, end, m, time, time_step);
        }
        Ok(())
    }

    /// Lets one tip grow as far as the energy balance and the speed limit allow within a step that ends at `time`.
    fn grow(&mut self, crack: usize, end: End, first: Measured, time: f64, time_step: f64) {
        let may_run = growth::speed_limit(&self.state.cracks[crack], end, &self.scene, &self.elastic, time) * time_step;
        if let Some(tip) = &mut self.state.cracks[crack].tips[slot(end)] {
            // What is not used is lost, but for one step.
            tip.ahead_of_limit = (tip.ahead_of_limit - may_run).max(-may_run);
        }
        let mut measured = first;
        for increment in 0..MOST_INCREMENTS_PER_STEP {
            let line = &self.state.cracks[crack];
            let Some(tip) = &line.tips[slot(end)] else { return };
            let held = may_run <= 0.0 || tip.ahead_of_limit > 0.0;
            if held || !growth::wants_to_grow(line, end, &measured, &self.scene, time) {
                if increment == 0 {
                    self.rest(crack, end, held);
                }
                return;
            }
            if let Some(branches) =
                growth::branches(&self.state.cracks, crack, end, &measured, &self.scene, &self.elastic)
            {
                self.divide(crack, end, branches, &measured);
                return;
            }
            let Some(advance) = growth::advance(&self.state.cracks, crack, end, &measured, &self.scene, time) else {
                return;
            };
            self.add_points(crack, end, &advance.points, advance.state, &measured);
            self.state.cracks[crack].ends[slot(end)] = advance.end;
            if !advance.points.is_empty() {
                self.solver.recut(&self.state.cracks, &[(crack, end)]);
            }
            if advance.end != CrackEnd::Tip {
                return;
            }
            let gauge = Gauge { scene: &self.scene, elastic: &self.elastic };
            measured = gauge.measure(self.solver.observed(), &self.state.cracks, crack, end);
        }
    }

    /// A tip that does not grow in this step; `held`: by the speed limit alone.
    fn rest(&mut self, crack: usize, end: End, held: bool) {
        let Some(tip) = &mut self.state.cracks[crack].tips[slot(end)] else { return };
        tip.steps_at_rest = if held { 0 } else { tip.steps_at_rest.saturating_add(1) };
        if tip.state == TipState::Growing && tip.steps_at_rest > ARREST_STEPS {
            tip.state = TipState::Arrested;
        }
    }

    /// Adds points to an end, and to the books what they cost.
    fn add_points(&mut self, crack: usize, end: End, points: &[Point], state: TipState, measured: &Measured) {
        let line = &mut self.state.cracks[crack];
        let before = line.length();
        for &p in points {
            line.push(end, p);
        }
        let length = line.length() - before;
        self.state.crack_energy += measured.j_integral.max(0.0) * length;
        if let Some(tip) = &mut line.tips[slot(end)] {
            tip.state = state;
            tip.grown += length;
            tip.since_division += length;
            tip.ahead_of_limit += length;
            tip.steps_at_rest = 0;
            if let Some(guide) = &mut tip.guide {
                guide.walk(length);
            }
        }
    }

    /// Divides a tip: it goes on along the left branch, a new crack that begins at it along the right one.
    fn divide(&mut self, crack: usize, end: End, branches: [Vec<Point>; 2], measured: &Measured) {
        let from = self.state.cracks[crack].tip_position(end);
        let [left, right] = branches;
        // The first length of both together releases what one straight on would have.
        self.add_points(crack, end, &left, TipState::Growing, measured);
        let mut points = vec![from];
        points.extend(right);
        let mut twin = Tip::new(None);
        let line = &mut self.state.cracks[crack];
        if let Some(tip) = &mut line.tips[slot(end)] {
            tip.since_division = 0.0;
            // Each branch goes its own way from here.
            tip.guide = None;
            tip.heading = Vector::zeros();
            twin.state = tip.state;
            twin.since_division = 0.0;
            twin.ahead_of_limit = tip.ahead_of_limit;
        }
        let ends = [CrackEnd::Junction { crack: crack as u32 }, CrackEnd::Tip];
        let body = line.body;
        self.state.cracks.push(Crack { body, points, ends, tips: [None, Some(twin)] });
        let new = self.state.cracks.len() - 1;
        self.solver.recut(&self.state.cracks, &[(crack, end), (new, End::End)]);
    }

    /// Measures every live tip now.
    pub fn measure_all(&mut self) {
        let gauge = Gauge { scene: &self.scene, elastic: &self.elastic };
        for (crack, end) in live_tips(&self.state.cracks) {
            let m = gauge.measure(self.solver.observed(), &self.state.cracks, crack, end);
            if let Some(tip) = &mut self.state.cracks[crack].tips[slot(end)] {
                tip.measured = m;
            }
        }
    }
}

fn live_tips(cracks: &[Crack]) -> Vec<(usize, End)> {
    let live = |c: &Crack, end: End| c.tips[slot(end)].as_ref().is_some_and(|t| t.state.is_live());
    cracks
        .iter()
        .enumerate()
        .flat_map(|(i, c)| ENDS.into_iter().filter(move |&end| live(c, end)).map(move |end| (i, end)))
        .collect()
}
