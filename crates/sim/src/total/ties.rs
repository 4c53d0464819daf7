//! Ties: what holds the two sides of a node together until a tip has passed it.
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
//! c_R) ties and drag together take 91 % of ∫ G da, with two thirds of the drag 89 % (`fissure verify moving-crack`).
//!
//! **Inertia.** A stiff spring between two light fields would ask for a short time step. A tie of stiffness k therefore
//! carries the kinetic energy ½ m |δ̇|² with m ≥ k/ω², ω the highest frequency of a plane wave on the uncut lattice. It
//! acts on the difference of the two fields alone, so momentum, gravity and rigid motion do not see it, and by
//! Rayleigh's quotient (K + k)/(M + m) ≤ max(K/M, k/m) no mode is faster than one of the lattice without ties.

use super::lattice::Lattice;
use super::motion::{FieldVectors, Motion};
use super::near::Near;
use crate::crack::cracks::{Cracks, TipId};
use crate::crack::division::WINDOW;
use crate::saved::{self, Fits};
use crate::solver::Release;
use fissure_plane::{Point, Vector};
use fissure_scene::{CrackEnd, TipState};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// A spring between two fields of one node.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Tie {
    first: u32,
    second: u32,
    node: u32,
    /// Where the node is at rest [m].
    place: Point,
    /// What stiffness and drag are measured by [Pa], per unit thickness.
    scale: f64,
    /// Opening without force [m].
    rest: Vector,
    /// Force per opening [Pa], per unit thickness.
    stiffness: f64,
    /// Inertia of the opening [kg/m].
    inertia: f64,
    /// Force per opening speed [Pa s], per unit thickness.
    drag: f64,
    /// Energy that the drag has taken and that is not accounted for yet [J/m].
    dragged: f64,
}

/// The fields of one node that ties couple by their inertia.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Coupled {
    /// Tip and place of each tie in the list of its tip.
    members: Vec<(TipId, usize)>,
    fields: Vec<u32>,
    /// Row by row: the forces that give the fields, each with its own mass, the accelerations that all have together.
    mixing: Vec<f64>,
}

/// All ties.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Ties {
    of_tip: BTreeMap<TipId, Vec<Tie>>,
    at_node: BTreeMap<u32, Coupled>,
}

/// Displacements of two fields that differ by less than this part of their size differ by round-off only: the faces of
/// a crack that has just come still lie on each other.
const ROUND_OFF: f64 = 1e-12;
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
/// Length grown in `fissure verify crack-motion` at 2.0 and 2.4 t_c: +13 and 0 %, +8 and −5 %, +2 and −9 %.
const INERTIA: f64 = 0.65;

/// Drag of a tie divided by s (1 − t)³/((1 − t)³ + t) and by the time a wave takes for a cell. Length grown in
/// `fissure verify crack-motion` at 2.4 t_c: −5 % with this, −6 % with two thirds of it; with an [`INERTIA`] of ½, −1 %
/// with this, −7 % without and −5 % with twice as much.
const DRAG: f64 = 0.73;

/// How far ahead of the tip nodes are split, in cells, when tips decide on their direction every `increment` cells:
/// before their ties begin to soften, by the way within which the division stays as it is, and a little more.
pub(super) fn split_ahead(increment: f64) -> f64 {
    BEGINS + increment + 0.1
}

/// How far, t, a tie is on its way from stiff to nothing when the tip is `ahead` cells from its node.
fn released_part(ahead: f64) -> f64 {
    (FIRST_RELEASED + (1.0 - FIRST_RELEASED) * (BEGINS - ahead) / LENGTH).clamp(FIRST_RELEASED, 1.0)
}

/// Stiffness of a tie over [`Tie::scale`].
fn softness(released: f64) -> f64 {
    STIFFNESS * (1.0 - released).powi(3) / released
}

/// What all ties of one body of material have in common.
#[derive(Debug, Clone, Copy)]
struct Measures {
    cell_size: f64,
    /// Time a wave takes for a cell [s].
    crossing: f64,
}

impl Measures {
    fn of(lattice: &Lattice) -> Self {
        Self { cell_size: lattice.grid.cell_size, crossing: lattice.crossing_time() }
    }
}

impl Tie {
    /// Softens the tie to where it is when the tip is `ahead` cells from its node.
    fn set(&mut self, ahead: f64, measures: Measures) {
        let released = released_part(ahead);
        self.stiffness = self.scale * softness(released);
        self.inertia = self.stiffness * (INERTIA * measures.crossing).powi(2);
        let stiff = (1.0 - released).powi(3);
        self.drag = DRAG * stiff / (stiff + released) * self.scale * measures.crossing;
    }

    fn opening(&self, u: &FieldVectors) -> Vector {
        let (a, b) = (self.first as usize, self.second as usize);
        Vector::new(u[0][b] - u[0][a], u[1][b] - u[1][a])
    }

    /// Opening beyond that without force for the displacement `u` [m].
    fn stretch(&self, u: &FieldVectors) -> Vector {
        self.opening(u) - self.rest
    }

    /// Takes over from what tied the same fields before: a tie that has become stiffer, or is new between fields that
    /// lie apart, holds with the force that was there.
    fn take_over(&mut self, before: Option<&Self>, u: &FieldVectors) {
        match before {
            Some(before) if before.stiffness >= self.stiffness => self.rest = before.rest,
            _ => {
                let force = before.map_or(Vector::zeros(), |before| before.stretch(u) * before.stiffness);
                self.rest = self.opening(u) - force / self.stiffness.max(f64::MIN_POSITIVE);
            }
        }
    }

    fn ahead_of(&self, tip: Point, direction: Vector, cell_size: f64) -> f64 {
        (self.place - tip).dot(&direction) / cell_size
    }
}

impl Ties {
    /// Checks ties that were read against so many `fields`, `nodes` and `cracks`.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(super) fn check(&self, fields: usize, nodes: usize, cracks: usize) -> Fits {
        self.of_tip.keys().try_for_each(|id| id.check(cracks))?;
        saved::below("a tie", self.all().flat_map(|tie| [tie.first, tie.second]), fields)?;
        saved::below("a tie", self.all().map(|tie| tie.node), nodes)?;
        for tie in self.all() {
            let numbers = [&tie.scale, &tie.stiffness, &tie.inertia, &tie.drag, &tie.dragged];
            saved::finite("a tie", numbers.into_iter().chain(tie.place.iter()).chain(tie.rest.iter()))?;
        }
        saved::below("the node of a tie", self.at_node.keys().copied(), nodes)?;
        for group in self.at_node.values() {
            saved::below("coupled ties", group.fields.iter().copied(), fields)?;
            saved::ensure(group.mixing.len() == group.fields.len().pow(2), "a coupling of ties")?;
            saved::finite("a coupling of ties", &group.mixing)?;
        }
        Ok(())
    }

    fn all(&self) -> impl Iterator<Item = &Tie> {
        self.of_tip.values().flatten()
    }

    /// Takes what drag has taken at a tip since the last call [J/m].
    pub(super) fn take_drag(&mut self, id: TipId) -> f64 {
        let ties = self.of_tip.get_mut(&id).map_or(&mut [][..], Vec::as_mut_slice);
        ties.iter_mut().map(|tie| std::mem::take(&mut tie.dragged)).sum()
    }

    /// Adds the forces of the ties.
    pub(super) fn add_forces(&self, u: &FieldVectors, force: &mut FieldVectors) {
        for tie in self.all() {
            let pull = tie.stretch(u) * tie.stiffness;
            for axis in 0..2 {
                force[axis][tie.first as usize] += pull[axis];
                force[axis][tie.second as usize] -= pull[axis];
            }
        }
    }

    /// Lets the inertia of the ties share out the forces.
    pub(super) fn share(&self, force: &mut FieldVectors) {
        let mut before = Vec::new();
        for group in self.at_node.values().filter(|group| !group.fields.is_empty()) {
            for force in force.iter_mut() {
                before.clear();
                before.extend(group.fields.iter().map(|&f| force[f as usize]));
                for (&field, row) in group.fields.iter().zip(group.mixing.chunks_exact(before.len())) {
                    force[field as usize] = row.iter().zip(&before).map(|(m, f)| m * f).sum();
                }
            }
        }
    }

    /// Elastic energy for the displacement `u` [J/m].
    pub(super) fn energy(&self, u: &FieldVectors) -> f64 {
        self.all().map(|tie| 0.5 * tie.stiffness * tie.stretch(u).norm_squared()).sum()
    }

    /// Kinetic energy for the velocity `v` [J/m].
    pub(super) fn kinetic_energy(&self, v: &FieldVectors) -> f64 {
        self.all().map(|tie| 0.5 * tie.inertia * tie.opening(v).norm_squared()).sum()
    }

    /// Angular momentum that their inertia holds [N s].
    pub(super) fn spin(&self, u: &FieldVectors, v: &FieldVectors) -> f64 {
        self.all().map(|tie| tie.inertia * tie.opening(u).perp(&tie.opening(v))).sum()
    }

    /// The ties of all tips.
    pub(super) fn new(lattice: &Lattice, motion: &Motion, cracks: &Cracks) -> Self {
        let mut ties = Self::default();
        ties.lay_where(lattice, motion, cracks, |_| true);
        ties
    }

    /// Lays the ties anew of tips whose ties reach to where something has changed: a field that has lost its mass, to
    /// another crack maybe, cannot be tied.
    pub(super) fn refresh(&mut self, near: &Near, lattice: &Lattice, motion: &Motion, cracks: &Cracks) {
        let reach = (WINDOW.hypot(WINDOW) + 1.0) * lattice.grid.cell_size;
        self.lay_where(lattice, motion, cracks, |tip| near.is_within(tip, reach));
    }

    fn lay_where(&mut self, lattice: &Lattice, motion: &Motion, cracks: &Cracks, is_changed: impl Fn(Point) -> bool) {
        if !lattice.has_ties() {
            return;
        }
        let mut changed = BTreeSet::new();
        for id in cracks.ids().filter(|&id| is_changed(cracks.position(id))) {
            let is_tip = cracks.end(id) == CrackEnd::Tip;
            let mut ties = if is_tip { ties_at(lattice, cracks, id) } else { Vec::new() };
            let before = self.of_tip.remove(&id).unwrap_or_default();
            for tie in &mut ties {
                let same = before.iter().find(|b| (b.first, b.second) == (tie.first, tie.second));
                tie.take_over(same, &motion.displacement);
            }
            changed.extend(ties.iter().chain(&before).map(|tie| tie.node));
            self.of_tip.insert(id, ties);
        }
        let mut members: BTreeMap<u32, Vec<(TipId, usize)>> = BTreeMap::new();
        for (&tip, ties) in &self.of_tip {
            for (k, tie) in ties.iter().enumerate().filter(|(_, tie)| changed.contains(&tie.node)) {
                members.entry(tie.node).or_default().push((tip, k));
            }
        }
        for node in changed {
            match members.remove(&node) {
                Some(members) => self.couple(lattice, node, members),
                None => drop(self.at_node.remove(&node)),
            }
        }
    }

    /// Softens the ties of a tip to where it is now.
    pub(super) fn soften(&mut self, lattice: &Lattice, cracks: &Cracks, id: TipId) {
        let measures = Measures::of(lattice);
        let (tip, direction) = (cracks.position(id), cracks.last_direction(id));
        let Some(ties) = self.of_tip.get_mut(&id) else { return };
        let mut nodes: Vec<u32> = Vec::with_capacity(ties.len());
        for tie in ties {
            tie.set(tie.ahead_of(tip, direction, measures.cell_size), measures);
            nodes.push(tie.node);
        }
        nodes.dedup();
        for node in nodes {
            if let Some(group) = self.at_node.remove(&node) {
                self.couple(lattice, node, group.members);
            }
        }
    }

    /// What the ties of a tip would give up if it went straight on now.
    ///
    /// The leapfrog keeps ½ v(t − Δt/2) · M v(t + Δt/2) + U(t). Both kicks count: a stiffness that changes by ΔK at t
    /// changes this by ½ u(t − Δt) · ΔK u(t).
    pub(super) fn release(&self, lattice: &Lattice, motion: &Motion, cracks: &Cracks, id: TipId) -> Release {
        let h = lattice.grid.cell_size;
        let (tip, direction) = (cracks.position(id), cracks.last_direction(id));
        let ties = self.of_tip.get(&id).map_or(&[][..], Vec::as_slice);
        let springs: Vec<(f64, f64, f64)> = ties
            .iter()
            .map(|tie| {
                let now = tie.stretch(&motion.displacement);
                let before = now - tie.opening(&motion.velocity) * motion.last_step;
                (tie.ahead_of(tip, direction, h), tie.stiffness / tie.scale, 0.5 * tie.scale * now.dot(&before))
            })
            .collect();
        Box::new(move |distance| {
            let of = |&(ahead, softness_now, energy): &(f64, f64, f64)| {
                energy * (softness_now - softness(released_part(ahead - distance / h)))
            };
            springs.iter().map(of).sum()
        })
    }

    /// Works out how the inertia of ties couples the fields of a node.
    fn couple(&mut self, lattice: &Lattice, node: u32, members: Vec<(TipId, usize)>) {
        let ties: Vec<&Tie> = members
            .iter()
            .filter_map(|(tip, k)| self.of_tip.get(tip)?.get(*k))
            .filter(|tie| tie.inertia > 0.0)
            .collect();
        let mut fields: Vec<u32> = ties.iter().flat_map(|tie| [tie.first, tie.second]).collect();
        fields.sort_unstable();
        fields.dedup();
        let n = fields.len();
        let at = |field: u32| fields.partition_point(|&f| f < field);
        let mass = |k: usize| lattice.layout.mass[fields[k] as usize];
        let mut matrix = nalgebra::DMatrix::from_fn(n, n, |i, j| if i == j { mass(i) } else { 0.0 });
        for tie in ties {
            let (a, b) = (at(tie.first), at(tie.second));
            matrix[(a, a)] += tie.inertia;
            matrix[(b, b)] += tie.inertia;
            matrix[(a, b)] -= tie.inertia;
            matrix[(b, a)] -= tie.inertia;
        }
        // Positive definite, because masses are positive.
        let mixing = matrix.cholesky().map(|factors| factors.inverse());
        let mixing =
            mixing.map_or(Vec::new(), |inverse| (0..n * n).map(|k| mass(k / n) * inverse[(k / n, k % n)]).collect());
        let fields = if mixing.is_empty() { Vec::new() } else { fields };
        self.at_node.insert(node, Coupled { members, fields, mixing });
    }

    /// Lets go of all openings without force but the part `kept`.
    pub(super) fn relax(&mut self, kept: f64) {
        for tie in self.of_tip.values_mut().flatten() {
            tie.rest *= kept;
        }
    }

    /// Drags at the opening of the ties around growing tips, for a kick of `kick` [s]. Only at its length: a body that
    /// turns, and the openings with it, is not dragged at. Nor is a crack at rest, whose body keeps its energy.
    pub(super) fn apply_drag(&mut self, mass: &[f64], motion: &mut Motion, cracks: &Cracks, kick: f64) {
        for (&id, ties) in &mut self.of_tip {
            if cracks.tip(id).is_none_or(|tip| tip.state != TipState::Growing) {
                continue;
            }
            for tie in ties.iter_mut().filter(|tie| tie.drag > 0.0) {
                let (a, b) = (tie.first as usize, tie.second as usize);
                let (mass_a, mass_b) = (mass[a], mass[b]);
                let reduced = mass_a * mass_b / (mass_a + mass_b);
                let inertia = reduced + tie.inertia;
                let kept = 1.0 / (1.0 + tie.drag * kick / inertia);
                let u = &motion.displacement;
                // What is apart by round-off only has no direction.
                let least = ROUND_OFF * (u[0][a].abs() + u[1][a].abs() + u[0][b].abs() + u[1][b].abs());
                let Some(direction) = tie.opening(u).try_normalize(least) else { continue };
                let speed = direction * direction.dot(&tie.opening(&motion.velocity));
                // The impulse works along the displacement of the step, which has the speed that is kept.
                tie.dragged += inertia * (1.0 - kept) * kept * speed.norm_squared();
                for axis in 0..2 {
                    let change = speed[axis] * (1.0 - kept) * reduced;
                    motion.velocity[axis][a] += change / mass_a;
                    motion.velocity[axis][b] -= change / mass_b;
                }
            }
        }
    }
}

/// The ties that a tip should have where it is now.
fn ties_at(lattice: &Lattice, cracks: &Cracks, id: TipId) -> Vec<Tie> {
    let h = lattice.grid.cell_size;
    let measures = Measures::of(lattice);
    let (tip, direction) = (cracks.position(id), cracks.last_direction(id));
    let [middle_column, middle_row] = lattice.grid.cell(tip);
    let reach = WINDOW.ceil() as i32 + 1;
    let mut ties = Vec::new();
    for row in middle_row - reach..=middle_row + reach {
        for column in middle_column - reach..=middle_column + reach {
            let Some(node) = lattice.grid.node([column, row]) else { continue };
            let place = lattice.grid.position(node);
            let arm = (place - tip) / h;
            let ahead = arm.dot(&direction);
            let is_tied = ahead > BEGINS - LENGTH && ahead <= lattice.split_ahead();
            if lattice.layout.fields.of(node).is_empty() || !is_tied || arm.perp(&direction).abs() > WINDOW {
                continue;
            }
            let fields = lattice.fields_with_mass(node);
            let stiffness: Vec<f64> = fields.iter().map(|&field| field_stiffness(lattice, field, place)).collect();
            let stiffness_of = |field: u32| fields.iter().zip(&stiffness).find(|f| *f.0 == field).map_or(0.0, |f| *f.1);
            let facing = lattice.layout.fields.facing_pairs(&fields).filter(|pair| pair.crack as usize == id.crack);
            ties.extend(facing.map(|pair| {
                let (s1, s2) = (stiffness_of(pair.first), stiffness_of(pair.second));
                let mut tie = Tie {
                    first: pair.first,
                    second: pair.second,
                    node: node as u32,
                    place,
                    scale: s1 * s2 / s1.hypot(s2),
                    rest: Vector::zeros(),
                    stiffness: 0.0,
                    inertia: 0.0,
                    drag: 0.0,
                    dragged: 0.0,
                };
                tie.set(ahead, measures);
                tie
            }));
        }
    }
    ties
}

/// Stiffness of a field at a node against being moved alone: Σ_p V E' |∇w|² [Pa], with the modulus that cracks open by.
fn field_stiffness(lattice: &Lattice, field: u32, node: Point) -> f64 {
    let reach = Vector::repeat(lattice.reach() * lattice.grid.cell_size);
    let mut stiffness = 0.0;
    let mut reader = lattice.reader();
    for p in lattice.particles.in_box(node - reach, node + reach) {
        let e = lattice.material(p);
        let modulus = e.effective_modulus * lattice.particles.volume[p];
        reader.for_each_entry(p, |of, _, gradient| {
            if of == field as usize {
                stiffness += modulus * gradient.norm_squared();
            }
        });
    }
    stiffness
}
