//! The account of a tip that slides: what it takes out of the body pays for its way.

use super::Simulation;
use crate::crack::assessment::Assessment;
use crate::crack::cracks::TipId;
use crate::growth::{self, Cost};
use fissure_scene::TipState;

/// The most energy that a tip may carry over to the next step, as the length that it pays for, in cells. What the
/// lattice releases per length varies within a cell: in one part of it a tip takes a little too much, in the next too
/// little.
const BALANCE_CELLS: f64 = 0.5;

/// A tip stays where it is rather than move by less than this, in cells.
const LEAST_SLIDE: f64 = 1e-12;

/// Halvings of an increment in search of what a tip can pay: down to round-off, or scenes of another size would part.
const HALVINGS: u32 = 54;

impl Simulation {
    /// Settles the account of a tip after a step: what is carried over is bounded, and what drag has taken comes to it.
    /// A tip that does not grow has none.
    pub(super) fn settle_account(&mut self, id: TipId, assessed: &Assessment) {
        let Some(sliding) = self.solver.sliding_mut() else { return };
        let dragged = sliding.take_drag(id);
        self.state.crack_energy += dragged;
        let cost = growth::critical_release(&self.state.cracks, id, assessed, &self.scene, &self.elastic);
        let Some(tip) = self.state.cracks.tip_mut(id) else { return };
        let kept = tip.balance.min(BALANCE_CELLS * self.scene.cell_size * cost);
        tip.balance = if tip.state == TipState::Growing { kept + dragged } else { 0.0 };
    }

    /// Lets a tip run through its increment as far as it can pay. Whether it has come to the end of it.
    ///
    /// What the tip takes out of the body on the way is what the way costs: the energy balance holds over every
    /// stretch, not only at the moment when growth begins.
    pub(super) fn slide(&mut self, id: TipId, assessed: &Assessment, time: f64) -> bool {
        let cracks = &self.state.cracks;
        let Some(tip) = cracks.tip(id) else { return false };
        let Some(left) = cracks.left_of_increment(id) else { return true };
        let (cost, most) = match growth::cost(cracks, id, assessed, &self.scene, &self.elastic, time) {
            Cost::Scheduled(due) => (0.0, due),
            Cost::Energy(cost) => (cost, f64::INFINITY),
        };
        let most = most.min(left).min(-tip.ahead_of_limit);
        let balance = tip.balance;
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
