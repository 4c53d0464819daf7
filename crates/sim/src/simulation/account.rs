//! The account of a tip that slides: what it takes out of the body pays for its way.

use super::Simulation;
use crate::crack::assessment::Assessment;
use crate::crack::cracks::TipId;
use crate::crack::tip::Tip;
use crate::growth::{self, Cost};
use fissure_scene::TipState;

/// The most energy that a tip needs from one step to the next, as the length that it pays for, in cells. What the
/// lattice releases per length varies within a cell: in one part of it a tip takes a little too much, in the next too
/// little. What it has beyond this it gives back, or it is lost to what limits its speed below that of waves.
const BALANCE_CELLS: f64 = 0.5;

/// A speed limit of at least this part of the Rayleigh wave speed is that of waves. A lower one is the scene's or the
/// material's: of a real crack that runs no faster, more is used up at the tip.
const FREE: f64 = 0.9;

/// A tip stays where it is rather than move by less than this, in cells.
const LEAST_SLIDE: f64 = 1e-12;

/// Halvings of an increment in search of what a tip can pay: down to round-off, or scenes of another size would part.
const HALVINGS: u32 = 54;

impl Simulation {
    /// Settles the account of a tip after a step: what is carried over is bounded, and what drag has taken comes to it.
    /// A tip that does not grow has none. `limit`: its highest speed [m/s].
    pub(super) fn settle_account(&mut self, id: TipId, assessed: &Assessment, limit: f64) {
        let Some(sliding) = self.solver.sliding_mut() else { return };
        let dragged = sliding.take_drag(id);
        self.state.crack_energy += dragged;
        let cost = growth::critical_release(&self.state.cracks, id, assessed, &self.scene, &self.elastic);
        let fastest = self.elastic[self.material_at(id)].rayleigh_wave_speed();
        let Some(tip) = self.state.cracks.tip_mut(id) else { return };
        tip.is_free = limit >= FREE * fastest && !tip.has_schedule();
        tip.most_balance = BALANCE_CELLS * self.scene.cell_size * cost;
        let kept = if tip.is_free { tip.balance } else { tip.balance.min(tip.most_balance) };
        if tip.state == TipState::Growing {
            // What it owed when it came to rest it still does.
            let owed = tip.left_over.min(0.0);
            tip.left_over -= owed;
            tip.balance = kept + dragged + owed;
        } else {
            tip.left_over += kept + dragged;
            tip.balance = 0.0;
        }
    }

    /// Tips give back what they have taken and cannot use.
    pub(super) fn give_back(&mut self) {
        let Some(sliding) = self.solver.sliding_mut() else { return };
        let ids: Vec<TipId> = self.state.cracks.ids().collect();
        for id in ids {
            let surplus = self.state.cracks.tip_mut(id).map_or(0.0, Tip::surplus);
            if surplus > 0.0 && sliding.give_back(id, surplus) {
                self.state.crack_energy -= surplus;
                self.state.cracks.tip_mut(id).into_iter().for_each(|tip| tip.balance -= surplus);
            }
        }
    }

    /// Tips pay for what their cuts had left strained and the last step has let go of.
    pub(super) fn settle_strains(&mut self) {
        let Some(sliding) = self.solver.sliding_mut() else { return };
        self.state.crack_energy += sliding.take_refused();
        for (id, energy) in sliding.take_settled() {
            self.state.crack_energy -= energy;
            self.state.cracks.tip_mut(id).into_iter().for_each(|tip| tip.pay(energy));
        }
    }

    /// Lets a tip run through its increment as far as it can pay. Whether it has come to the end of it.
    ///
    /// What the tip takes out of the body on the way is what the way costs: the energy balance holds over every
    /// stretch, not only at the moment when growth begins.
    pub(super) fn slide(&mut self, id: TipId, assessed: &Assessment, time: f64) -> bool {
        let cracks = &self.state.cracks;
        let Some(tip) = cracks.tip(id) else { return false };
        let Some(left) = cracks.left_of_increment(id) else { return true };
        let cost = growth::cost(cracks, id, assessed, &self.scene, &self.elastic, time);
        let most = left.min(-tip.ahead_of_limit).max(0.0);
        let balance = tip.balance;
        let Some(sliding) = self.solver.sliding() else { return true };
        let release = sliding.release(cracks, id);
        let (distance, cost) = match cost {
            // What is due is due, whatever the tip has.
            Cost::Scheduled(due) => (most.min(due).max(0.0), 0.0),
            Cost::Energy(cost) => {
                // In debt it goes on if that pays for the way and something of the debt.
                let (means, asked) = (balance.max(0.0), cost * (1.0 + tip.surcharge()));
                (affordable(most, |distance| means + release(distance) - asked * distance), cost)
            }
        };
        let arrives = distance >= left;
        if !arrives && distance < LEAST_SLIDE * self.scene.cell_size {
            return false;
        }
        let taken = release(distance);
        self.state.cracks.slide(id, distance);
        if let Some(tip) = self.state.cracks.tip_mut(id) {
            // What the search is off by is no debt.
            tip.balance = (balance + taken - cost * distance).max(balance.min(0.0));
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
