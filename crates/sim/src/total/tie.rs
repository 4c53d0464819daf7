//! Ties: what holds the two sides of a node together while a tip has only begun to pass it.
//!
//! A node ahead of the tip either has one field or two, and giving it its second field opens its whole support at once: the crack would act
//! as if it jumped. So the second field comes early, held to the first by a spring that softens from stiff to nothing as the tip
//! comes nearer, and the effective tip moves smoothly. The springs are the discrete counterpart of the hat of a node that is cut off at
//! the tip (Zi & Belytschko 2003), whose stiffness goes from infinite to that of the whole hat in the same way, but which particles half a
//! cell apart cannot sample.

use super::{FieldVectors, Total};
use crate::crack::{Crack, ENDS};
use crate::division::{TipCut, WINDOW, facing};
use fissure_scene::{CrackEnd, TipDivision};

/// A spring between two fields of one node.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tie {
    first: u32,
    second: u32,
    /// Force per displacement [Pa], per unit thickness.
    stiffness: f64,
}

/// Where the ties end, in cells ahead of the tip: when the tip has passed the node by a quarter of a cell.
const ENDS_AHEAD: f64 = -0.25;
/// Stiffness of a tie over (λ + 2μ) (1 − t)/t where a part t of the way from stiff to nothing is done. Chosen with the two lengths of [`TipCut::TIED`] on a
/// static edge crack of 8 cells, 80 places of the tip in a cell: the error of K_I has a standard deviation of 0.5 % and stays so between half and twice this
/// value.
const STIFFNESS: f64 = 0.03;
/// Stiffest tie over λ + 2μ.
const STIFFEST: f64 = 4.0;

impl Total {
    /// The ties around all tips.
    pub(super) fn ties_of(&self, cracks: &[Crack]) -> Vec<Tie> {
        let mut ties = Vec::new();
        if self.settings.tip_division != TipDivision::PartlyCut {
            return ties;
        }
        let h = self.grid.cell_size;
        let begins = TipCut::TIED.node_ahead;
        for (index, crack) in cracks.iter().enumerate() {
            for end in ENDS {
                if crack.ends[crate::crack::slot(end)] != CrackEnd::Tip {
                    continue;
                }
                let tip = crack.tip_position(end);
                // The direction of the last segment, as the division has it.
                let ahead = crack.ahead(end, 1e-6 * h);
                let material = self.scene.bodies[crack.body as usize].material_at(tip);
                let modulus = self.elastic[material].lambda + 2.0 * self.elastic[material].mu;
                for (node, further) in self.state.fields.divided_nodes() {
                    let arm = (self.grid.position(node) - tip) / h;
                    let before = arm.dot(&ahead);
                    if before <= ENDS_AHEAD || before > begins || arm.perp(&ahead).abs() > WINDOW {
                        continue;
                    }
                    let done = (begins - before) / (begins - ENDS_AHEAD);
                    let stiffness = modulus * (STIFFNESS * (1.0 - done) / done).min(STIFFEST);
                    let own = (Vec::new(), node as u32);
                    let all: Vec<_> =
                        std::iter::once(&own).chain(further).filter(|f| self.state.mass[f.1 as usize] > 0.0).collect();
                    for (k, first) in all.iter().enumerate() {
                        for second in &all[k + 1..] {
                            if facing(&first.0, &second.0).is_some_and(|(crack, _)| crack as usize == index) {
                                ties.push(Tie { first: first.1, second: second.1, stiffness });
                            }
                        }
                    }
                }
            }
        }
        ties
    }

    /// Adds the forces of the ties.
    pub(super) fn add_tie_forces(&self, u: &FieldVectors, force: &mut FieldVectors) {
        for tie in &self.ties {
            let (a, b) = (tie.first as usize, tie.second as usize);
            for axis in 0..2 {
                let pull = tie.stiffness * (u[axis][b] - u[axis][a]);
                force[axis][a] += pull;
                force[axis][b] -= pull;
            }
        }
    }

    /// Energy of the ties [J/m].
    pub(super) fn tie_energy(&self) -> f64 {
        let u = &self.state.displacement;
        self.ties
            .iter()
            .map(|tie| {
                let (a, b) = (tie.first as usize, tie.second as usize);
                0.5 * tie.stiffness * ((u[0][a] - u[0][b]).powi(2) + (u[1][a] - u[1][b]).powi(2))
            })
            .sum()
    }

    /// Adds the stiffness of the ties at each field to `stiffness` [Pa].
    pub(super) fn add_tie_stiffness(&self, stiffness: &mut [f64]) {
        for tie in &self.ties {
            stiffness[tie.first as usize] += tie.stiffness;
            stiffness[tie.second as usize] += tie.stiffness;
        }
    }
}
