//! What a tip has taken beyond all that its way costs goes back into the body: it drives the faces behind it apart.
//!
//! At c_R a tip in an elastic body takes nothing, however hard it is driven (Freund 1990, section 6.4: g(v) → 0): what
//! there is stays in the body as motion. Ties that soften as fast as waves take what they hold, whether that is needed
//! or not. What is over goes to the openings that it came from, each as much as it has given up, as an impulse between
//! the two fields of the node: no momentum comes with it, and no angular momentum, as they are at one place.

use super::field_vectors::at;
use super::lattice::Lattice;
use super::motion::Motion;
use super::tie::ROUND_OFF;
use crate::crack::cracks::TipId;
use crate::saved::{self, Fits};
use fissure_plane::Vector;
use serde::{Deserialize, Serialize};

/// What drives the two sides of a crack at a node apart within the next step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Push {
    crack: u32,
    node: u32,
    /// [J/m]
    pub(super) energy: f64,
}

/// Openings of a tip: the node of each, and what it has given up [J/m].
pub(super) type Released = Vec<(u32, f64)>;

/// Shares out the energy `energy` [J/m] among those openings of a tip that are open.
pub(super) fn share_out(
    lattice: &Lattice,
    motion: &Motion,
    (id, energy): (TipId, f64),
    mut released: Released,
) -> impl Iterator<Item = Push> {
    let crack = id.crack as u32;
    released.retain(|&(node, released)| released > 0.0 && opening(lattice, motion, crack, node).is_some());
    let sum: f64 = released.iter().map(|&(_, released)| released).sum();
    released.into_iter().map(move |(node, released)| Push { crack, node, energy: energy * (released / sum) })
}

/// The two fields of a node between which a crack is open there, and the direction in which the second lies of the
/// first. Where there are several such pairs, the widest; where the end of the crack has left none, that of any two
/// fields of a body.
fn opening(lattice: &Lattice, motion: &Motion, crack: u32, node: u32) -> Option<([u32; 2], Vector)> {
    let u = &motion.displacement;
    let opening = |[a, b]: [u32; 2]| at(u, b as usize) - at(u, a as usize);
    let wider = |one, other| if opening(other).norm_squared() > opening(one).norm_squared() { other } else { one };
    let fields = lattice.fields_with_mass(node as usize);
    let facing = lattice.fields().facing_pairs(&fields).filter(|pair| pair.crack == crack);
    let of_one_body = |&[a, b]: &[u32; 2]| lattice.fields().guest(a as usize) == lattice.fields().guest(b as usize);
    let any = || (1..fields.len()).flat_map(|k| (0..k).map(move |j| [j, k])).map(|pair| pair.map(|k| fields[k]));
    let widest =
        facing.map(|pair| pair.above_and_below()).reduce(wider).or_else(|| any().filter(of_one_body).reduce(wider))?;
    let [a, b] = widest.map(|field| field as usize);
    // What is apart by round-off only has no direction.
    let least = ROUND_OFF * (u[0][a].abs() + u[1][a].abs() + u[0][b].abs() + u[1][b].abs());
    Some((widest, opening(widest).try_normalize(least)?))
}

/// An impulse between two fields [N s/m]: the first of them gets it, the second one its opposite.
#[derive(Debug, Clone, Copy)]
pub(super) struct Impulse {
    pub(super) fields: [u32; 2],
    pub(super) impulse: Vector,
}

impl Impulse {
    /// Changes velocities by it; `mass`: of all fields [kg/m].
    pub(super) fn act(&self, mass: &[f64], motion: &mut Motion) {
        let [first, second] = self.fields.map(|field| field as usize);
        for axis in 0..2 {
            motion.velocity[axis][first] += self.impulse[axis] / mass[first];
            motion.velocity[axis][second] -= self.impulse[axis] / mass[second];
        }
    }
}

impl Push {
    /// Checks one that was read against so many `nodes`.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(super) fn check(&self, nodes: usize) -> Fits {
        saved::below("what drives faces apart", [self.node], nodes)?;
        saved::finite("what drives faces apart", [&self.energy])
    }

    /// The impulse that brings its energy into the body within a kick; none where the sides of the crack lie on each
    /// other or are one again. `inertia`: that of the tie of two fields, if they have one [kg/m].
    pub(super) fn impulse(
        &self,
        lattice: &Lattice,
        motion: &Motion,
        inertia: impl Fn(u32, [u32; 2]) -> f64,
    ) -> Option<Impulse> {
        let (fields, direction) = opening(lattice, motion, self.crack, self.node)?;
        let [a, b] = fields.map(|field| field as usize);
        let reduced = 1.0 / (1.0 / lattice.mass()[a] + 1.0 / lattice.mass()[b]);
        // What an impulse brings into the leapfrog is its work at the mean of the velocities before and after a kick.
        let rate_in = |v| direction.dot(&(at(v, b) - at(v, a)));
        let mean = 0.5 * (rate_in(&motion.velocity) + rate_in(motion.before_kick()));
        let rate = change_for(mean, 2.0 * self.energy / (reduced + inertia(self.node, fields)));
        Some(Impulse { fields, impulse: direction * (-rate * reduced) })
    }
}

/// The Δ > 0 with Δ² + 2 `mean` Δ = `gained` > 0, from numbers that do not cancel.
fn change_for(mean: f64, gained: f64) -> f64 {
    let root = (mean * mean + gained).sqrt();
    if mean > 0.0 { gained / (root + mean) } else { root - mean }
}
