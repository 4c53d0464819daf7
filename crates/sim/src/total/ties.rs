//! The ties of all tips: where they are laid, how they are coupled, softened, and what they release.

use super::field_vectors::FieldVectors;
use super::lattice::Lattice;
use super::motion::Motion;
use super::near::Near;
use super::push::{self, Impulse, Push, Released};
use super::tie::{self, Tie};
use crate::boundary::constraints::Inertia;
use crate::crack::cracks::{Cracks, TipId};
use crate::crack::division::WINDOW;
use crate::crack::tip::Tip;
use crate::saved::{self, Fits};
use crate::solver::Release;
use fissure_plane::{Point, Vector};
use fissure_scene::CrackEnd;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// The fields of one node that ties couple by their inertia.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Coupled {
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
    /// What is given back in the next step.
    pushes: Vec<Push>,
    /// What the last ties of tips had given up that have come to their ends since the last step.
    ended: BTreeMap<TipId, Released>,
    /// What was to be given back and found no faces, since it was last asked for [J/m].
    refused: f64,
    /// `at_node` in lists.
    #[serde(skip)]
    flat: Flat,
}

/// What [`Coupled`] fields make of forces, as it is asked for in each step.
#[derive(Debug, Clone, Default)]
struct Flat {
    /// Whether it is that of the ties as they are.
    is_known: bool,
    /// Two fields that move together, as nearly all do, with their mixing.
    pairs: Vec<([u32; 2], [f64; 4])>,
    /// Nodes where more do.
    others: Vec<u32>,
}

impl PartialEq for Flat {
    /// It follows from the ties.
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Flat {
    fn new(at_node: &BTreeMap<u32, Coupled>) -> Self {
        let mut flat = Self { is_known: true, ..Self::default() };
        for (&node, group) in at_node.iter().filter(|(_, group)| !group.fields.is_empty()) {
            match (&group.fields[..], &group.mixing[..]) {
                (&[a, b], &[aa, ab, ba, bb]) => flat.pairs.push(([a, b], [aa, ab, ba, bb])),
                _ => flat.others.push(node),
            }
        }
        flat
    }
}

impl Coupled {
    /// The fields that move together.
    pub(super) fn fields(&self) -> &[u32] {
        &self.fields
    }

    /// By how much an impulse of 1 on one of the fields moves another [m/kg], by their numbers here; `mass`: of all
    /// fields [kg/m].
    pub(super) fn response(&self, mass: &[f64], pushed: usize, moved: usize) -> f64 {
        self.mixing[moved * self.fields.len() + pushed] / mass[self.fields[moved] as usize]
    }
}

impl Ties {
    /// Checks ties that were read against so many `fields`, `nodes` and `cracks`.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(super) fn check(&self, fields: usize, nodes: usize, cracks: usize) -> Fits {
        self.of_tip.keys().try_for_each(|id| id.check(cracks))?;
        self.all().try_for_each(|tie| tie.check(fields, nodes))?;
        saved::below("the node of a tie", self.at_node.keys().copied(), nodes)?;
        self.pushes.iter().try_for_each(|push| push.check(nodes))?;
        for (id, released) in &self.ended {
            id.check(cracks)?;
            saved::below("the node of a tip that has ended", released.iter().map(|&(node, _)| node), nodes)?;
            saved::finite("a tip that has ended", released.iter().map(|(_, energy)| energy))?;
        }
        saved::finite("ties", [&self.refused])?;
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
        ties.iter_mut().map(Tie::take_dragged).sum()
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
    pub(super) fn share(&mut self, force: &mut FieldVectors) {
        if !self.flat.is_known {
            self.flat = Flat::new(&self.at_node);
        }
        // No field is of two nodes: these may come in any order.
        for &([a, b], [aa, ab, ba, bb]) in &self.flat.pairs {
            for force in force.iter_mut() {
                let (of_a, of_b) = (force[a as usize], force[b as usize]);
                (force[a as usize], force[b as usize]) = (aa * of_a + ab * of_b, ba * of_a + bb * of_b);
            }
        }
        let mut before = Vec::new();
        for group in self.flat.others.iter().filter_map(|node| self.at_node.get(node)) {
            for force in force.iter_mut() {
                before.clear();
                before.extend(group.fields.iter().map(|&f| force[f as usize]));
                for (&field, row) in group.fields.iter().zip(group.mixing.chunks_exact(before.len())) {
                    force[field as usize] = row.iter().zip(&before).map(|(m, f)| m * f).sum();
                }
            }
        }
    }

    /// The largest opening of a tie of a tip for the displacement `u` [m]; none where it has none.
    pub(super) fn parted(&self, u: &FieldVectors, id: TipId) -> Option<f64> {
        self.of_tip.get(&id)?.iter().map(|tie| tie.opening(u).norm()).reduce(f64::max)
    }

    /// Elastic energy for the displacement `u`, with what is given back in the next step [J/m].
    pub(super) fn energy(&self, u: &FieldVectors) -> f64 {
        let waiting: f64 = self.pushes.iter().map(|push| push.energy).sum();
        waiting + self.all().map(|tie| tie.energy(u)).sum::<f64>()
    }

    /// Kinetic energy for the velocity `v` [J/m].
    pub(super) fn kinetic_energy(&self, v: &FieldVectors) -> f64 {
        self.all().map(|tie| tie.kinetic_energy(v)).sum()
    }

    /// Angular momentum that their inertia holds [N s].
    pub(super) fn spin(&self, u: &FieldVectors, v: &FieldVectors) -> f64 {
        self.all().map(|tie| tie.inertia * tie.opening(u).perp(&tie.opening(v))).sum()
    }

    /// The ties of all tips.
    pub(super) fn new(lattice: &Lattice, motion: &mut Motion, cracks: &Cracks) -> Self {
        let mut ties = Self::default();
        ties.lay_where(lattice, motion, cracks, |_| true, |_| false);
        ties
    }

    /// How fields of these inverse masses [m/kg] answer impulses with the inertia of the ties.
    pub(super) fn inertia<'a>(&'a self, inverse_mass: &'a [f64]) -> TiedInertia<'a> {
        let places = |group: &'a Coupled| group.fields.iter().enumerate().map(move |(k, &f)| (f, (group, k)));
        TiedInertia { inverse_mass, groups: self.at_node.values().flat_map(places).collect() }
    }

    /// As [`Ties::inertia`], for the fields of one node.
    pub(super) fn inertia_at<'a>(&'a self, node: usize, inverse_mass: &'a [f64]) -> TiedInertia<'a> {
        let group = self.at_node.get(&(node as u32));
        let places = group
            .into_iter()
            .flat_map(|group| group.fields.iter().enumerate().map(move |(k, &field)| (field, (group, k))));
        TiedInertia { inverse_mass, groups: places.collect() }
    }

    /// All fields that ties couple, those of a node together.
    pub(super) fn coupled(&self) -> impl Iterator<Item = &Coupled> {
        self.at_node.values().filter(|group| !group.fields.is_empty())
    }

    /// The fields that ties couple at these nodes.
    fn fields_at<'a>(&'a self, nodes: impl IntoIterator<Item = &'a u32> + 'a) -> impl Iterator<Item = u32> + 'a {
        nodes.into_iter().filter_map(|node| self.at_node.get(node)).flat_map(|group| group.fields.iter().copied())
    }

    /// Lays the ties anew of tips whose ties reach to where something has changed: a field that has lost its mass, to
    /// another crack maybe, cannot be tied. `recut`: the particles of which parts see other nodes than before; none
    /// where these are not all known. Gives the fields whose inertia is another one, and the energy that is lost [J/m].
    pub(super) fn refresh(
        &mut self,
        near: &Near,
        recut: Option<&[usize]>,
        lattice: &Lattice,
        motion: &mut Motion,
        cracks: &Cracks,
    ) -> (Vec<u32>, f64) {
        let reach = (WINDOW.hypot(WINDOW) + 1.0) * lattice.grid.cell_size;
        // Particles are looked for in a box that may be a row larger.
        let seen = lattice.reach() * lattice.grid.cell_size + 1.001 * lattice.particles.spacing;
        let is_as_before = |node: Point| {
            let is_far = |&p: &usize| (lattice.particles.rest[p] - node).amax() > seen;
            recut.is_some_and(|recut| recut.iter().all(is_far))
        };
        self.lay_where(lattice, motion, cracks, |tip| near.is_within(tip, reach), is_as_before)
    }

    fn lay_where(
        &mut self,
        lattice: &Lattice,
        motion: &mut Motion,
        cracks: &Cracks,
        is_changed: impl Fn(Point) -> bool,
        is_as_before: impl Fn(Point) -> bool,
    ) -> (Vec<u32>, f64) {
        if !lattice.has_ties() {
            return (Vec::new(), 0.0);
        }
        let mut lost = 0.0;
        let mut changed = BTreeSet::new();
        for id in cracks.ids().filter(|&id| is_changed(cracks.position(id))) {
            let is_tip = cracks.end(id) == CrackEnd::Tip;
            let before = self.of_tip.remove(&id).unwrap_or_default();
            if !is_tip && !before.is_empty() {
                let released = released_by(&before, motion);
                // What has not begun to soften, the end has broken.
                let held = || before.iter().map(|tie| (tie.node, tie.energy(&motion.displacement))).collect();
                let has_softened = released.iter().any(|&(_, released)| released > 0.0);
                self.ended.insert(id, if has_softened { released } else { held() });
            }
            let asked = if is_tip { ties_at(lattice, cracks, id, &before, &is_as_before) } else { Vec::new() };
            let mut ties = Vec::with_capacity(asked.len());
            for &(mut tie) in &asked {
                let same = same_tie(&tie, &asked, &before);
                if same.is_some() || tie.lies_together(&motion.displacement, lattice.grid.cell_size) {
                    tie.take_over(same, &motion.displacement);
                    lost += same.map_or(0.0, |before| tie.keep_momentum(before, lattice.mass(), motion));
                    ties.push(tie);
                }
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
        let mut fields: Vec<u32> = self.fields_at(&changed).collect();
        for &node in &changed {
            match members.remove(&node) {
                Some(members) => self.couple(lattice, node, members),
                None => drop(self.at_node.remove(&node)),
            }
        }
        self.flat.is_known &= changed.is_empty();
        fields.extend(self.fields_at(&changed));
        (fields, lost)
    }

    /// Softens the ties of a tip to where it is now. Gives the fields whose inertia is another one.
    pub(super) fn soften(&mut self, lattice: &Lattice, cracks: &Cracks, id: TipId) -> Vec<u32> {
        let cell_size = lattice.grid.cell_size;
        let (tip, direction) = (cracks.position(id), cracks.last_direction(id));
        let Some(ties) = self.of_tip.get_mut(&id) else { return Vec::new() };
        let mut nodes: Vec<u32> = Vec::with_capacity(ties.len());
        for tie in ties {
            tie.soften(tie.ahead_of(tip, direction, cell_size));
            nodes.push(tie.node);
        }
        nodes.dedup();
        let mut fields: Vec<u32> = self.fields_at(&nodes).collect();
        self.flat.is_known &= nodes.is_empty();
        for &node in &nodes {
            if let Some(group) = self.at_node.remove(&node) {
                self.couple(lattice, node, group.members);
            }
        }
        fields.extend(self.fields_at(&nodes));
        fields
    }

    /// What the ties of a tip would give up if it went straight on now.
    ///
    /// The leapfrog keeps ½ v(t − Δt/2) · M v(t + Δt/2) + U(t), with v the velocity before a kick in both places where
    /// the kick changes. A stiffness that changes by ΔK at t and an inertia that changes by ΔM with it change this by
    /// ½ u(t − Δt) · ΔK u(t) + ½ v(t − Δt/2) · ΔM v(t − Δt/2).
    pub(super) fn release(&self, lattice: &Lattice, motion: &Motion, cracks: &Cracks, id: TipId) -> Release {
        let h = lattice.grid.cell_size;
        let (tip, direction) = (cracks.position(id), cracks.last_direction(id));
        let ties = self.of_tip.get(&id).map_or(&[][..], Vec::as_slice);
        let springs: Vec<(f64, f64, f64)> = ties
            .iter()
            .map(|tie| {
                let held = 0.5 * tie.scale * tie.held_per_stiffness(motion);
                (tie.ahead_of(tip, direction, h), tie.stiffness / tie.scale, held)
            })
            .collect();
        Box::new(move |distance| {
            let of = |&(ahead, softness_now, energy): &(f64, f64, f64)| {
                energy * (softness_now - tie::softness_at(ahead - distance / h))
            };
            springs.iter().map(of).sum()
        })
    }

    /// What all ties hold of what the leapfrog keeps [J/m]: see [`Ties::release`].
    pub(super) fn held(&self, motion: &Motion) -> f64 {
        self.all().map(|tie| 0.5 * tie.stiffness * tie.held_per_stiffness(motion)).sum()
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
        let mass = |k: usize| lattice.mass()[fields[k] as usize];
        let couplings = |add: &mut dyn FnMut(usize, usize, f64)| {
            (0..n).for_each(|k| add(k, k, mass(k)));
            for tie in &ties {
                let (a, b) = (at(tie.first), at(tie.second));
                add(a, a, tie.inertia);
                add(b, b, tie.inertia);
                add(a, b, -tie.inertia);
                add(b, a, -tie.inertia);
            }
        };
        // Positive definite, because masses are positive. Nearly all are of two fields.
        let mixing: Vec<f64> = if n == 2 {
            let mut matrix = nalgebra::Matrix2::<f64>::zeros();
            couplings(&mut |i, j, x| matrix[(i, j)] += x);
            let inverse = matrix.cholesky().map(|factors| factors.inverse());
            inverse.map_or(Vec::new(), |inverse| (0..4).map(|k| mass(k / 2) * inverse[(k / 2, k % 2)]).collect())
        } else {
            let mut matrix = nalgebra::DMatrix::<f64>::zeros(n, n);
            couplings(&mut |i, j, x| matrix[(i, j)] += x);
            let inverse = matrix.cholesky().map(|factors| factors.inverse());
            inverse.map_or(Vec::new(), |inverse| (0..n * n).map(|k| mass(k / n) * inverse[(k / n, k % n)]).collect())
        };
        let fields = if mixing.is_empty() { Vec::new() } else { fields };
        self.at_node.insert(node, Coupled { members, fields, mixing });
    }

    /// Tells of all ties with an opening without force: its tip, its number, and the energy that it gains when but the
    /// part `kept` of that is let go of, for the displacement `u` [J/m].
    pub(super) fn each_misfit(&self, kept: f64, u: &FieldVectors, each: &mut dyn FnMut(TipId, usize, f64)) {
        for (&id, ties) in &self.of_tip {
            for (k, tie) in ties.iter().enumerate().filter(|(_, tie)| tie.is_misfit()) {
                let mut after = *tie;
                each(id, k, after.let_go(kept, u));
            }
        }
    }

    /// Lets go of the opening without force of a tie but the part `kept`. Returns the energy that it gains by it [J/m].
    pub(super) fn let_go(&mut self, id: TipId, index: usize, kept: f64, u: &FieldVectors) -> f64 {
        let tie = self.of_tip.get_mut(&id).and_then(|ties| ties.get_mut(index));
        tie.map_or(0.0, |tie| tie.let_go(kept, u))
    }

    /// Lets the drag of the ties around growing tips act within a kick of `kick` [s], as far as each tip needs what
    /// it takes, and then what tips give back.
    pub(super) fn apply_drag(&mut self, lattice: &Lattice, motion: &mut Motion, cracks: &Cracks, kick: f64) {
        let mass = lattice.mass();
        let part = |id: TipId| cracks.tip(id).map_or(0.0, Tip::part_of_drag);
        let growing = self.of_tip.iter_mut().map(|(id, ties)| (part(*id), ties)).filter(|(part, _)| *part != 0.0);
        // All see the velocities without drag: where the ties of two tips share a field, neither comes before the
        // other.
        let of = |part: f64, tie: &mut Tie| {
            let impulse = tie.drag(part, mass, motion, kick)?;
            Some(Impulse { fields: [tie.first, tie.second], impulse })
        };
        let impulses: Vec<Impulse> =
            growing.flat_map(|(part, ties)| ties.iter_mut().filter_map(move |tie| of(part, tie))).collect();
        impulses.iter().for_each(|impulse| impulse.act(mass, motion));
        self.ended.clear();
        let pushes = std::mem::take(&mut self.pushes);
        let of = |push: &Push| push.impulse(lattice, motion, |node, fields| self.inertia_between(node, fields));
        let impulses: Vec<Option<Impulse>> = pushes.iter().map(of).collect();
        for (push, impulse) in pushes.iter().zip(impulses) {
            match impulse {
                Some(impulse) => impulse.act(mass, motion),
                None => self.refused += push.energy,
            }
        }
    }

    /// Inertia of the opening of two fields of a node [kg/m].
    fn inertia_between(&self, node: u32, fields: [u32; 2]) -> f64 {
        let members = self.at_node.get(&node).map_or(&[][..], |group| &group.members[..]);
        let ties = members.iter().filter_map(|(tip, k)| self.of_tip.get(tip)?.get(*k));
        ties.filter(|tie| [tie.first, tie.second] == fields).map(|tie| tie.inertia).sum()
    }

    /// Lets the energy `energy` [J/m] that a tip has taken drive apart, within the next step, the faces that it has
    /// taken it from. Of a tip that has come to its end in this step, these are the last that it had. Whether there
    /// are any.
    pub(super) fn give_back(&mut self, lattice: &Lattice, motion: &Motion, id: TipId, energy: f64) -> bool {
        let ties = self.of_tip.get(&id).map_or(&[][..], Vec::as_slice);
        let ended = self.ended.remove(&id).unwrap_or_default();
        let released = if ties.is_empty() { ended } else { released_by(ties, motion) };
        let before = self.pushes.len();
        self.pushes.extend(push::share_out(lattice, motion, (id, energy), released));
        self.pushes.len() > before
    }

    /// Takes what was to go back into the body since the last call and found no faces [J/m].
    pub(super) fn take_refused(&mut self) -> f64 {
        std::mem::take(&mut self.refused)
    }
}

/// What each of some ties has given up.
fn released_by(ties: &[Tie], motion: &Motion) -> Released {
    ties.iter().map(|tie| (tie.node, tie.released(&motion.displacement))).collect()
}

/// Masses of fields, and what ties add to them.
pub(super) struct TiedInertia<'a> {
    inverse_mass: &'a [f64],
    /// The group of each field that is coupled, and its place there.
    groups: BTreeMap<u32, (&'a Coupled, usize)>,
}

impl Inertia for TiedInertia<'_> {
    fn response(&self, field: u32, each: &mut dyn FnMut(u32, f64)) {
        let Some(&(group, place)) = self.groups.get(&field) else {
            return each(field, self.inverse_mass[field as usize]);
        };
        for (&moved, row) in group.fields.iter().zip(group.mixing.chunks_exact(group.fields.len())) {
            each(moved, self.inverse_mass[moved as usize] * row[place]);
        }
    }
}

/// The tie among those `before` that `tie`, one of `all`, is now: of the same fields, or the only one of its node, the
/// fields of which have other names where it is so near the line of the crack that rounding decides on its side.
fn same_tie<'t>(tie: &Tie, all: &[Tie], before: &'t [Tie]) -> Option<&'t Tie> {
    let same = before.iter().find(|b| (b.first, b.second) == (tie.first, tie.second));
    let is_only = |ties: &[Tie]| ties.iter().filter(|other| other.node == tie.node).count() == 1;
    same.or_else(|| before.iter().find(|b| b.node == tie.node).filter(|_| is_only(all) && is_only(before)))
}

/// The ties that a tip should have where it is now. `before`: those that it has had; where the particles around a node
/// are as they were (`is_as_before`), its fields withstand as they did.
fn ties_at(
    lattice: &Lattice,
    cracks: &Cracks,
    id: TipId,
    before: &[Tie],
    is_as_before: &impl Fn(Point) -> bool,
) -> Vec<Tie> {
    let h = lattice.grid.cell_size;
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
            let is_tied = tie::is_tied(ahead, lattice.split_ahead());
            if lattice.fields().of(node).is_empty() || !is_tied || arm.perp(&direction).abs() > WINDOW {
                continue;
            }
            let fields = lattice.fields_with_mass(node);
            let facing = lattice.fields().facing_pairs(&fields).filter(|pair| pair.crack as usize == id.crack);
            let is_as_before = is_as_before(place);
            ties.extend(facing.map(|pair| {
                let fields = pair.above_and_below();
                let same = before.iter().find(|tie| [tie.first, tie.second] == fields);
                if let Some(same) = same.filter(|_| is_as_before) {
                    return same.laid_anew(ahead);
                }
                let [above, below] = Rigidity::of(lattice, fields, place);
                let crossing = h / above.wave_speed.max(below.wave_speed);
                Tie::new(fields, (node as u32, place), [above.stiffness, below.stiffness], crossing, ahead)
            }));
        }
    }
    ties
}

/// How a field at a node withstands.
#[derive(Debug, Clone, Copy, Default)]
struct Rigidity {
    /// Against being moved alone: Σ_p V E' |∇w|² [Pa], with the modulus that cracks open by.
    stiffness: f64,
    /// Speed of the fastest wave in its material [m/s]. Not that of the scene: a tie that were made for a material of
    /// waves four times as fast would have a sixteenth of its inertia, and ask for a shorter step than the material.
    wave_speed: f64,
}

impl Rigidity {
    /// That of two `fields` of a node at `place`.
    fn of(lattice: &Lattice, fields: [u32; 2], place: Point) -> [Self; 2] {
        let reach = Vector::repeat(lattice.reach() * lattice.grid.cell_size);
        let mut rigidities = [Self::default(); 2];
        let mut reader = lattice.reader();
        for p in lattice.particles.in_box(place - reach, place + reach) {
            let e = lattice.material(p);
            let modulus = e.effective_modulus * lattice.particles.volume[p];
            reader.for_each_part(p, |of, share, _, gradient| {
                if let Some(k) = fields.iter().position(|&field| of == field as usize) {
                    let rigidity = &mut rigidities[k];
                    rigidity.stiffness += share * modulus * gradient.norm_squared();
                    rigidity.wave_speed = rigidity.wave_speed.max(e.dilatational_wave_speed());
                }
            });
        }
        rigidities
    }
}
