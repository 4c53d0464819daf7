//! One tie: what holds the two sides of a node together until a tip has passed it.
//!
//! A node near a tip either has one field or two, and giving it its second field opens its whole support at once: the
//! crack would act as if it jumped from node to node, and what it releases would stay in the lattice as vibration. So
//! the second field comes early, held to the first by a spring that softens from stiff to nothing while the tip passes.
//! A spring of stiffness s (1 − t)/t across a node that would open with the stiffness s has released the part t of what
//! it will release in all. Here several nodes of a row soften at a time, and s (1 − t)³/t lets the effective length of
//! the crack follow the tip best.
//!
//! **Energy.** Nothing but the springs depends on where the tip is within its increment. Softened at an opening δ they
//! give up ½ Δk δ², never less than nothing: this is the energy that the crack consumes, and what makes the tip move as
//! the energy balance says (node release along a decreasing force is the classic way to run a crack through finite
//! elements: Malluck & King 1980; here the force follows from the spring).
//!
//! **Drag.** A crack that runs fast softens its ties faster than nodes can part, and a part of what is released would
//! stay in the lattice as waves of a few cells. A viscous force on the opening takes it: at 1500 m/s in steel (0.51
//! c_R) ties and drag together take 1.7 % more than ∫ G da (`fissure verify moving-crack`). A tip that runs as fast as
//! waves takes more than its way costs, and [gives it back](super::push).
//!
//! **Inertia.** A stiff spring between two light fields would ask for a short time step. A tie of stiffness k therefore
//! carries the kinetic energy ½ m |δ̇|² with m ≥ k/ω², ω the highest frequency of a plane wave in an uncut lattice of
//! the material around it. It acts on the difference of the two fields alone, so momentum, gravity and rigid motion do
//! not see it, and by Rayleigh's quotient (K + k)/(M + m) ≤ max(K/M, k/m) no mode is faster than one of the lattice
//! without ties.

use super::field_vectors::{FieldVectors, at};
use super::motion::Motion;
use crate::saved::{self, Fits};
use fissure_plane::{Point, Vector};
use serde::{Deserialize, Serialize};

/// A spring between two fields of one node.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Tie {
    /// The fields it ties, above the crack and below it.
    pub(super) first: u32,
    pub(super) second: u32,
    /// Their node.
    pub(super) node: u32,
    /// Where the node is at rest [m].
    place: Point,
    /// What stiffness and drag are measured by [Pa], per unit thickness.
    pub(super) scale: f64,
    /// Time that the fastest wave in the material of the two takes for a cell [s].
    pub(super) crossing: f64,
    /// Opening without force [m].
    rest: Vector,
    /// Force per opening [Pa], per unit thickness.
    pub(super) stiffness: f64,
    /// Inertia of the opening [kg/m].
    pub(super) inertia: f64,
    /// Force per opening speed [Pa s], per unit thickness.
    drag: f64,
    /// Energy that the drag has taken and that is not accounted for yet [J/m].
    dragged: f64,
}

/// Displacements of two fields that differ by less than this part of their size differ by round-off only: the faces of
/// a crack that has just come still lie on each other.
pub(super) const ROUND_OFF: f64 = 1e-12;
/// Fields that are farther from each other than this, in cells, have come apart. Of 6,000 new ties of the examples the
/// fields of a split that has just been made lay within 1e-15, those of an open crack more than 1e-6 from each other.
const APART: f64 = 1e-9;
/// How far ahead of the tip a node is where its tie begins to soften, in cells. Chosen with the four numbers below on a
/// static edge crack of 8 cells in 64 places within a cell: K_I is off by −0.1 ± 0.2 %, at worst −0.5 %; at 16 cells by
/// 0.0 ± 0.1 %, at worst 0.3 %.
const BEGINS: f64 = 0.51;
/// Way of the tip over which a tie softens from its full stiffness to none, in cells. For a crack at rest one cell
/// would do as well, but at half the Rayleigh wave speed it leaves more than a quarter of what is released as
/// vibration.
const LENGTH: f64 = 2.0;
/// Stiffness of a tie divided by s (1 − t)³/t, where t is the part of it that is released and s = 1/√(1/s₁² + 1/s₂²) of
/// the stiffness s₁, s₂ [Pa] of its two fields.
const STIFFNESS: f64 = 0.49;
/// The released part t of a tie that has not begun to soften.
const FIRST_RELEASED: f64 = 0.02;
/// √(m/k) of a tie with inertia m and stiffness k, divided by the time a wave takes for a cell. At ½, where ω = 2c/h,
/// no mode is faster than one of the lattice without ties; with more, ties vibrate more slowly and less. Root mean
/// square error of K_I in `fissure verify step-load`, at worst: 1.1 % with 0.5, 0.93 % with this, 0.73 % with 0.8.
/// Length grown in `fissure verify crack-motion --cells 80`, τ 0.6 and 0.2 t_c, at 2.6 t_c: 0.2 and −1.7 % with this,
/// 0.4 and −1.6 % with 0.55.
const INERTIA: f64 = 0.65;

/// Drag of a tie divided by s (1 − t) and by the time a wave takes for a cell. It stays longer than the stiffness:
/// waves of a few cells leave the faces behind the tip. Root mean square error of J in `fissure verify moving-crack`:
/// 1.9 % with this, 1.6 % with 0.73, 1.7 % with 1.0, 4.0 % with 0.73 that goes with (1 − t)³/((1 − t)³ + t). Length
/// grown in `crack-motion`, τ 0.2 t_c, at 2.6 t_c in 40, 80 and 160 cells: 0.3, −1.7, −2.5 % with this, −0.3, −2.3,
/// −3.1 % with 0.73, −1.1, −3.7, −4.2 % with 1.0, −4.8, −6.0 % (40, 80) with the other.
const DRAG: f64 = 0.5;

/// How far ahead of the tip nodes are split, in cells, when tips decide on their direction every `increment` cells:
/// before their ties begin to soften, by the way within which the division stays as it is, and a little more.
pub(super) fn split_ahead(increment: f64) -> f64 {
    BEGINS + increment + 0.1
}

/// How far, t, a tie is on its way from stiff to nothing when the tip is `ahead` cells from its node.
fn released_part(ahead: f64) -> f64 {
    (FIRST_RELEASED + (1.0 - FIRST_RELEASED) * (BEGINS - ahead) / LENGTH).clamp(FIRST_RELEASED, 1.0)
}

/// Stiffness of a tie over [`Tie::scale`] when the part `released` of it is.
fn softness(released: f64) -> f64 {
    STIFFNESS * (1.0 - released).powi(3) / released
}

/// Stiffness of a tie over [`Tie::scale`] when the tip is `ahead` cells from its node.
pub(super) fn softness_at(ahead: f64) -> f64 {
    softness(released_part(ahead))
}

/// Whether a node `ahead` cells from the tip is tied, when nodes are split as far as `split_ahead` cells ahead.
pub(super) fn is_tied(ahead: f64, split_ahead: f64) -> bool {
    ahead > BEGINS - LENGTH && ahead <= split_ahead
}

impl Tie {
    /// A tie of the fields `fields` of the node number `node` at `place`, for a tip `ahead` cells before it; their
    /// stiffness is `stiffness` [Pa], and a wave in them takes the time `crossing` [s] for a cell. It holds with no
    /// force where they are without displacement.
    pub(super) fn new(
        fields: [u32; 2],
        (node, place): (u32, Point),
        stiffness: [f64; 2],
        crossing: f64,
        ahead: f64,
    ) -> Self {
        let [s1, s2] = stiffness;
        let mut tie = Self {
            first: fields[0],
            second: fields[1],
            node,
            place,
            scale: s1 * s2 / s1.hypot(s2),
            crossing,
            rest: Vector::zeros(),
            stiffness: 0.0,
            inertia: 0.0,
            drag: 0.0,
            dragged: 0.0,
        };
        tie.soften(ahead);
        tie
    }

    /// The same tie as [`Tie::new`] makes it for fields that are as stiff as before, and a tip `ahead` cells before it.
    pub(super) fn laid_anew(&self, ahead: f64) -> Self {
        let mut tie = Self { rest: Vector::zeros(), dragged: 0.0, ..*self };
        tie.soften(ahead);
        tie
    }

    /// Checks a tie that was read against so many `fields` and `nodes`.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(super) fn check(&self, fields: usize, nodes: usize) -> Fits {
        saved::below("a tie", [self.first, self.second], fields)?;
        saved::below("a tie", [self.node], nodes)?;
        let numbers = [&self.scale, &self.crossing, &self.stiffness, &self.inertia, &self.drag, &self.dragged];
        saved::finite("a tie", numbers.into_iter().chain(self.place.iter()).chain(self.rest.iter()))
    }

    /// Takes what drag has taken since the last call [J/m].
    pub(super) fn take_dragged(&mut self) -> f64 {
        std::mem::take(&mut self.dragged)
    }

    /// Whether it has an opening without force.
    pub(super) fn is_misfit(&self) -> bool {
        self.rest != Vector::zeros()
    }

    /// Lets go of the opening without force but the part `kept`. Returns the energy that it gains by it for the
    /// displacement `u` [J/m].
    pub(super) fn let_go(&mut self, kept: f64, u: &FieldVectors) -> f64 {
        let before = self.energy(u);
        self.rest *= kept;
        self.energy(u) - before
    }

    /// Softens the tie to where it is when the tip is `ahead` cells from its node.
    pub(super) fn soften(&mut self, ahead: f64) {
        let released = released_part(ahead);
        self.stiffness = self.scale * softness(released);
        self.inertia = self.stiffness * self.inertia_per_stiffness();
        self.drag = DRAG * (1.0 - released) * self.scale * self.crossing;
    }

    /// Inertia over stiffness [s²].
    fn inertia_per_stiffness(&self) -> f64 {
        (INERTIA * self.crossing).powi(2)
    }

    pub(super) fn opening(&self, u: &FieldVectors) -> Vector {
        at(u, self.second as usize) - at(u, self.first as usize)
    }

    /// Opening beyond that without force for the displacement `u` [m].
    pub(super) fn stretch(&self, u: &FieldVectors) -> Vector {
        self.opening(u) - self.rest
    }

    /// Elastic energy for the displacement `u` [J/m].
    pub(super) fn energy(&self, u: &FieldVectors) -> f64 {
        0.5 * self.stiffness * self.stretch(u).norm_squared()
    }

    /// Kinetic energy for the velocity `v` [J/m].
    pub(super) fn kinetic_energy(&self, v: &FieldVectors) -> f64 {
        0.5 * self.inertia * self.opening(v).norm_squared()
    }

    /// Twice what a tie holds of what the leapfrog keeps, over its stiffness [m²]: u(t − Δt) · u(t) of the stretch and
    /// the part of the inertia.
    pub(super) fn held_per_stiffness(&self, motion: &Motion) -> f64 {
        let now = self.stretch(&motion.displacement);
        let rate = self.opening(&motion.velocity);
        let before = now - rate * motion.last_step;
        now.dot(&before) + self.inertia_per_stiffness() * rate.norm_squared()
    }

    /// Whether its fields lie on each other, as those of a node that has just been split do. What has come apart is not
    /// tied again: it is an older part of the crack, or another one, that the tip has come to lie beside.
    pub(super) fn lies_together(&self, u: &FieldVectors, cell_size: f64) -> bool {
        let size = at(u, self.first as usize).amax() + at(u, self.second as usize).amax();
        self.opening(u).amax() <= APART * cell_size + ROUND_OFF * size
    }

    /// Takes over from what tied the same material before, under other names of its fields maybe: a tie that has become
    /// stiffer, or is new between fields that lie apart, holds with the force that was there.
    pub(super) fn take_over(&mut self, before: Option<&Self>, u: &FieldVectors) {
        match before {
            Some(before) if before.stiffness >= self.stiffness => self.rest = before.rest,
            _ => {
                let opening = self.opening(u);
                let force = before.map_or(Vector::zeros(), |before| (opening - before.rest) * before.stiffness);
                self.rest = opening - force / self.stiffness.max(f64::MIN_POSITIVE);
            }
        }
    }

    /// Lets the opening go on with the momentum that it had with the inertia of the tie `before`, where that was less:
    /// what is made heavier in flight gets slower, or it would come with energy that nothing has given. Returns what
    /// the fields lose by it of what the leapfrog keeps [J/m].
    pub(super) fn keep_momentum(&self, before: &Self, mass: &[f64], motion: &mut Motion) -> f64 {
        if self.inertia <= before.inertia {
            return 0.0;
        }
        let [a, b] = [self.first, self.second].map(|field| field as usize);
        let reduced = 1.0 / (1.0 / mass[a] + 1.0 / mass[b]);
        let rate = self.opening(&motion.velocity);
        let change = rate * (before.inertia - self.inertia) / (reduced + self.inertia);
        // Of ½ v(t − Δt/2) · M v(t + Δt/2), with the force of the fields alone as the last step has shown it.
        let acceleration = motion.acceleration(b) - motion.acceleration(a);
        let force = acceleration * (reduced + before.inertia) + before.stretch(&motion.displacement) * before.stiffness;
        for axis in 0..2 {
            motion.velocity[axis][a] -= change[axis] * reduced / mass[a];
            motion.velocity[axis][b] += change[axis] * reduced / mass[b];
        }
        -change.dot(&(reduced * (rate + 0.5 * change) + 0.5 * motion.last_step * force))
    }

    pub(super) fn ahead_of(&self, tip: Point, direction: Vector, cell_size: f64) -> f64 {
        (self.place - tip).dot(&direction) / cell_size
    }

    /// The impulse of the part `part` of the drag within a kick of `kick` [s] between the
    /// two fields [N s/m], none where there is none. Only at the length of the opening: a body that turns, and the
    /// openings with it, is not dragged at.
    pub(super) fn drag(&mut self, part: f64, mass: &[f64], motion: &Motion, kick: f64) -> Option<Vector> {
        if self.drag <= 0.0 {
            return None;
        }
        let (a, b) = (self.first as usize, self.second as usize);
        let (mass_a, mass_b) = (mass[a], mass[b]);
        let reduced = mass_a * mass_b / (mass_a + mass_b);
        let inertia = reduced + self.inertia;
        let kept = 1.0 / (1.0 + part * self.drag * kick / inertia);
        let u = &motion.displacement;
        // What is apart by round-off only has no direction.
        let least = ROUND_OFF * (u[0][a].abs() + u[1][a].abs() + u[0][b].abs() + u[1][b].abs());
        let direction = self.opening(u).try_normalize(least)?;
        let speed = direction.dot(&self.opening(&motion.velocity));
        let before = direction.dot(&self.opening(motion.before_kick()));
        // What an impulse takes out of the leapfrog is its work at the mean of the velocities before and after a kick.
        self.dragged += inertia * (1.0 - kept) * speed * 0.5 * (before + kept * speed);
        Some(direction * (speed * (1.0 - kept) * reduced))
    }

    /// What it has given up since it began to soften, as far as its opening `u` is what it has been [J/m].
    pub(super) fn released(&self, u: &FieldVectors) -> f64 {
        let softened = self.scale * softness(FIRST_RELEASED) - self.stiffness;
        0.5 * softened * self.stretch(u).norm_squared()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// Truth: two bodies that collide and go on together (momentum, and what is lost of ½ m v²). A tie of fields that
    /// fly apart becomes stiffer, and so heavier: (μ + m) v stays, μ the reduced mass; the fields lose what both had
    /// together less what both have and the tie holds more. One that becomes lighter changes nothing.
    #[test]
    fn what_gets_heavier_in_flight_gets_slower() {
        let mass = [3.0, 1.5];
        let [light, heavy] = [0.4, -0.2].map(|ahead| {
            let stiffness = [2e3, 3e3];
            Tie::new([0, 1], (0, Point::new(0.0, 0.0)), stiffness, 0.01, -ahead)
        });
        let mut motion = Motion::at_rest(2);
        motion.velocity = [vec![0.3, -1.1], vec![-0.2, 0.9]];
        let before = motion.clone();
        assert!(light.inertia < heavy.inertia);
        assert_eq!(light.keep_momentum(&heavy, &mass, &mut motion), 0.0);
        assert_eq!(motion.velocity, before.velocity);
        let lost = heavy.keep_momentum(&light, &mass, &mut motion);
        let reduced = mass[0] * mass[1] / (mass[0] + mass[1]);
        let [old, new] = [&before, &motion].map(|motion| light.opening(&motion.velocity));
        let expected = old * ((reduced + light.inertia) / (reduced + heavy.inertia));
        assert!((new - expected).norm() < 1e-14, "{new} {expected}");
        for axis in 0..2 {
            let momentum = |motion: &Motion| (0..2).map(|k| mass[k] * motion.velocity[axis][k]).sum::<f64>();
            assert!((momentum(&motion) - momentum(&before)).abs() < 1e-14);
        }
        let collision = 0.5 * (reduced + light.inertia) * (old.norm_squared() - old.dot(&new));
        let held = heavy.kinetic_energy(&motion.velocity) - light.kinetic_energy(&before.velocity);
        assert!((lost - held - collision).abs() < 1e-14, "{lost} {held} {collision}");
        assert!(collision > 0.0);
    }
}
