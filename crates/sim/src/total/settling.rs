//! Letting go of what a recut leaves strained without force, at the cost of the tips that have cut there.
//!
//! When a crack turns, its ties become stiffer and particles change sides. Forces must not jump for that, so that what
//! is strained has a part without force, the misfit of a particle or of a tie, which is let go of while a wave runs
//! some cells. As a rule that raises the strain energy: it is what the ties gave up when they became stiffer, and
//! what the tip was credited with. So the tip pays for it out of what it has taken of the body beyond the cost of its
//! way, and what no tip can pay for stays as it is. Otherwise a body whose cracks wind would gain energy from nothing:
//! in 16 random zigzags .07 of what the crack took in the mean and .25 at worst, where it is .0008 and .003 now.

use super::Total;
use super::lattice::{Lattice, Layout};
use crate::crack::cracks::{Cracks, TipId};
use fissure_plane::Point;
use smallvec::SmallVec;

/// Time in which misfits fall to 1/e, over the time a wave takes for a cell.
const SETTLING: f64 = 8.0;

/// How far from a tip what it pays for is, in cells: it was cut there, and a tip runs less than half as far as waves.
const REACH: f64 = 12.0;

/// The part of what a tip has that it gives for this in a step: it also has to drive faces apart that drag held back.
const PART: f64 = 0.5;

/// Tips whose distances from a misfit differ by less than this pay for it together [cells].
const ALIKE: f64 = 1e-9;

/// What two squares have to differ by, as part of them, to differ whatever rounding has done to them.
const ROUND_OFF: f64 = 1e-12;

/// Somebody who can pay.
struct Payer {
    id: TipId,
    place: Point,
    /// What it can give in this step [J/m].
    means: f64,
    /// What is asked of it [J/m].
    asked: f64,
    /// What it gives [J/m].
    given: f64,
}

/// What is strained without force.
#[derive(Clone, Copy)]
enum Strained {
    /// A row of the particles on the general path.
    Own(usize),
    /// A row of what of them lies across a crack.
    Across(usize),
    /// A tie of a tip.
    Tie(TipId, usize),
}

/// A misfit that can be let go of.
struct Misfit {
    of: Strained,
    /// Numbers of those who pay.
    payers: SmallVec<[usize; 4]>,
    /// Energy that the body gains when it is let go of [J/m].
    gain: f64,
    /// What its particle has per volume [J/m³]; of a tie nothing.
    density: f64,
}

impl Total {
    /// Lets go of misfits within a step of `time_step` [s].
    pub(super) fn settle(&mut self, cracks: &Cracks, time_step: f64) {
        self.settled.clear();
        let kept = (-time_step / (SETTLING * self.lattice.crossing_time())).exp();
        let mut strained = self.strained(kept);
        if strained.is_empty() {
            return;
        }
        let is_free = !self.lattice.has_ties();
        let mut payers = if is_free { Vec::new() } else { payers(cracks) };
        let by_column = by_column(&payers);
        for misfit in &mut strained {
            let place = match misfit.of {
                Strained::Own(row) => self.lattice.particles.rest[self.lattice.layout.cut.particle_of(row)],
                Strained::Across(row) => self.lattice.particles.rest[self.lattice.layout.far.particle_of(row)],
                Strained::Tie(id, _) => cracks.position(id),
            };
            misfit.payers = nearest(&by_column, place, self.lattice.grid.cell_size);
            let share = misfit.gain / misfit.payers.len() as f64;
            misfit.payers.iter().for_each(|&k| payers[k].asked += share);
        }
        for misfit in &strained {
            let part_of = |k: &usize| (payers[*k].means / payers[*k].asked.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            let part = if misfit.gain <= 0.0 || is_free {
                1.0
            } else {
                // Energy is convex: a part of a misfit costs no more than that part of what all of it does.
                misfit.payers.iter().map(part_of).reduce(f64::min).unwrap_or(0.0)
            };
            if part > 0.0 {
                let gain = self.let_go(misfit, 1.0 - (1.0 - kept) * part);
                let share = gain / misfit.payers.len() as f64;
                misfit.payers.iter().for_each(|&k| payers[k].given += share);
            }
        }
        self.settled.extend(payers.iter().filter(|payer| payer.given != 0.0).map(|payer| (payer.id, payer.given)));
    }

    /// All that is strained without force and can be let go of but the part `kept`, with what the body gains by that.
    fn strained(&mut self, kept: f64) -> Vec<Misfit> {
        let u = &self.motion.displacement;
        let Lattice { layout, particles, materials, .. } = &mut self.lattice;
        let mut found = Vec::new();
        let mut add = |of: Strained, gain: f64, density: f64| {
            found.push(Misfit { of, payers: SmallVec::new(), gain, density });
        };
        let Layout { cut, far, .. } = layout;
        cut.each_misfit(kept, particles, materials, u, &mut |row, gain, density| {
            add(Strained::Own(row), gain, density);
        });
        far.each_misfit(kept, particles, materials, u, &mut |row, gain, density| {
            add(Strained::Across(row), gain, density);
        });
        self.ties.each_misfit(kept, u, &mut |id, k, gain| add(Strained::Tie(id, k), gain, 0.0));
        found
    }

    /// Lets go of a misfit but the part `kept`. Returns the energy that the body gains by it [J/m].
    fn let_go(&mut self, misfit: &Misfit, kept: f64) -> f64 {
        let u = &self.motion.displacement;
        let Lattice { layout, particles, materials, .. } = &mut self.lattice;
        let kept_of = (kept, misfit.density);
        match misfit.of {
            Strained::Own(row) => layout.cut.let_go(row, kept_of, particles, materials, u),
            Strained::Across(row) => layout.far.let_go(row, kept_of, particles, materials, u),
            Strained::Tie(id, k) => self.ties.let_go(id, k, kept, u),
        }
    }
}

/// The tips that have something to give.
fn payers(cracks: &Cracks) -> Vec<Payer> {
    let payer = |id: TipId| {
        let means = PART * cracks.tip(id)?.means();
        (means > 0.0).then(|| Payer { id, place: cracks.position(id), means, asked: 0.0, given: 0.0 })
    };
    cracks.ids().filter_map(payer).collect()
}

/// Where payers are and what their numbers are, from left to right.
fn by_column(payers: &[Payer]) -> Vec<(Point, usize)> {
    let mut places: Vec<(Point, usize)> = payers.iter().enumerate().map(|(k, payer)| (payer.place, k)).collect();
    places.sort_unstable_by(|a, b| a.0.x.total_cmp(&b.0.x));
    places
}

/// The payers nearest to a place, of those that [`by_column`] gives: more than one where they are equally near.
fn nearest(payers: &[(Point, usize)], place: Point, cell_size: f64) -> SmallVec<[usize; 4]> {
    let far = (REACH + 1.0) * cell_size;
    let mut near: SmallVec<[(usize, f64); 16]> = SmallVec::new();
    let mut least = f64::INFINITY;
    // Square of what is farther away than the nearest so far, whatever rounding does [m²].
    let mut farther = f64::INFINITY;
    let from = payers.partition_point(|payer| payer.0.x < place.x - far);
    for &(payer, k) in payers[from..].iter().take_while(|payer| payer.0.x <= place.x + far) {
        let arm = payer - place;
        if arm.y.abs() < far && arm.norm_squared() <= farther {
            let way = arm.norm() / cell_size;
            near.push((k, way));
            if way < least {
                least = way;
                farther = ((least + ALIKE) * cell_size).powi(2) * (1.0 + ROUND_OFF);
            }
        }
    }
    if least > REACH {
        return SmallVec::new();
    }
    near.into_iter().filter(|of| of.1 <= least + ALIKE).map(|of| of.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fissure_scene::End;
    use proptest::prelude::*;

    proptest! {
        /// Truth: the distances to all of them. Tips crowded or far apart, some in one place.
        #[test]
        fn those_pay_that_are_nearest(
            places in prop::collection::vec([-40_i32..40, -40_i32..40], 0..60), place in [-45.0_f64..45.0, -45.0_f64..45.0],
            cell_size in 0.3_f64..4.0,
        ) {
            let payer = |(crack, &[x, y]): (usize, &[i32; 2])| Payer {
                id: TipId { crack, end: End::End },
                place: Point::new(f64::from(x), f64::from(y)),
                means: 1.0,
                asked: 0.0,
                given: 0.0,
            };
            let payers: Vec<Payer> = places.iter().enumerate().map(payer).collect();
            let mut found = nearest(&by_column(&payers), place.into(), cell_size).to_vec();
            found.sort_unstable();
            let ways: Vec<f64> = payers.iter().map(|payer| (payer.place - Point::from(place)).norm() / cell_size).collect();
            let least = ways.iter().copied().fold(f64::INFINITY, f64::min);
            let pays = |k: &usize| least <= REACH && ways[*k] <= least + ALIKE;
            prop_assert_eq!(found, (0..payers.len()).filter(pays).collect::<Vec<_>>());
        }
    }
}
