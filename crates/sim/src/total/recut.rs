//! Cutting anew where a crack has grown: stencils change only near it, and what a weight carries goes with the weight.
//!
//! A (particle, node) weight that moves to another field takes its share of the node's momentum along, so momentum is
//! conserved to round-off and kinetic energy can only fall (fields merge inelastically). A field that is new takes the
//! displacement of the fields its mass came from, so that at the moment of the cut the strain does not change; a field
//! that was there keeps its own. Where a tip divides, what lies between the branches is made of both sides of the
//! crack; a field of it takes the mean, whether it was there or not, or mirrored branches would differ.

use super::cut::CutParticles;
use super::cutting::Parts;
use super::lattice::{Lattice, Layout};
use super::motion::Motion;
use crate::crack::Crack;
use crate::crack::changes::Changes;
use crate::crack::cracks::{Cracks, TipId};
use crate::grid::entries::Entry;
use fissure_plane::{Matrix, Point, Vector, bounds};
use fissure_scene::End;

/// Particles that a crack leaves without hold as it comes to its end are looked for within so many cells of that.
const REACH: f64 = 6.0;

/// A strain that changes by less than this part of itself has not changed.
const ROUND_OFF: f64 = 1e-12;

/// What was told of so many cells is remembered: two rows of most boxes in which something has changed.
const CELLS_OF_TWO_ROWS: usize = 24;

/// A field with less than this part of a particle's mass has lost all but round-off.
const NO_MASS: f64 = 1e-9;

/// What leaves and enters a field in a recut.
#[derive(Debug, Clone, Copy, Default)]
struct FieldChange {
    mass_out: f64,
    mass_in: f64,
    momentum_in: Vector,
    displacement_in: Vector,
}

/// How the weight of one particle at one node moves between the fields of the node.
#[derive(Debug, Clone)]
pub(super) struct WeightChange {
    /// (field, change of weight); the changes add up to zero.
    pub(super) moved: Vec<(u32, f64)>,
    /// Mass of the particle [kg/m].
    pub(super) mass: f64,
}

/// The regions around what the ends `changed` have left behind last.
pub(super) fn boxes_behind(cracks: &Cracks, changed: &[TipId], cell_size: f64) -> Vec<(Point, Point)> {
    changed.iter().map(|&id| box_behind(cracks.of(id), id.end, cell_size)).collect()
}

fn box_behind(crack: &Crack, end: End, cell_size: f64) -> (Point, Point) {
    // The last few points: increments are a good part of a cell.
    let n = crack.points.len().min(6);
    let (low, high) = match end {
        End::Start => bounds(&crack.points[..n]),
        End::End => bounds(&crack.points[crack.points.len() - n..]),
    };
    let reach = Vector::repeat(REACH * cell_size);
    (low - reach, high + reach)
}

impl Lattice {
    /// Lays stencils anew where cracks divide otherwise than before `changes`. Returns the energy that is lost [J/m].
    /// `divides`: a tip has become two.
    pub(super) fn recut(&mut self, changes: &Changes, divides: bool, motion: &mut Motion) -> f64 {
        self.recut_particles(changes, divides, motion)
    }

    /// Cuts the particles anew that may be divided otherwise. Returns the energy that is lost [J/m].
    fn recut_particles(&mut self, of: &Changes, divides: bool, motion: &mut Motion) -> f64 {
        let mut affected: Vec<usize> = Vec::new();
        let mut told: Vec<([i32; 2], bool)> = Vec::new();
        for &(low, high) in &of.boxes {
            // Those that no crack is near any more become whole again. Where a tip divides, all move.
            // The particles of a cell see the same nodes, and come row by row.
            told.clear();
            let mut may_be_cut_anew = |p: usize| {
                let place = self.particles.rest[self.layout.riders.host(p).unwrap_or(p)];
                let cell = if self.has_rows() { self.grid.cell(place) } else { self.stencil(place).first };
                let known = told.iter().rev().take(CELLS_OF_TWO_ROWS).find(|known| known.0 == cell);
                known.map(|known| known.1).unwrap_or_else(|| {
                    let found = self.may_have_changed(of, place, place, &mut None);
                    told.push((cell, found));
                    found
                })
            };
            let around = self.particles.in_box(low, high);
            affected.extend(around.filter(|&p| (divides || may_be_cut_anew(p)) && !self.is_whole(p)));
        }
        affected.sort_unstable();
        affected.dedup();
        // Cells that were whole leave their run; all their particles go on the general path.
        let mut cells: Vec<[i32; 2]> = affected.iter().map(|&p| self.grid.cell(self.particles.rest[p])).collect();
        cells.sort_unstable();
        cells.dedup();
        for cell in cells {
            if self.leave_run(cell) {
                let own = self.particles_of_cell(cell).into_iter().flatten();
                affected.extend(own.filter(|&p| self.layout.cut.entries_of(p).is_none()));
            }
        }
        affected.sort_unstable();
        affected.dedup();
        let mut parts = Vec::with_capacity(affected.len());
        let mut changed = Vec::with_capacity(affected.len());
        let mut changes: Vec<WeightChange> = Vec::new();
        for p in affected {
            let of_particle = self.make_parts(p);
            // Where a tip divides, fields that were there move too.
            if !divides && self.has_kept(p, &of_particle) {
                continue;
            }
            let strains = self.reader().strains(p, &motion.displacement);
            let swaps = self.has_changed_sides(p, &of_particle);
            let kept = self.kept_strains(p, &of_particle, swaps, strains);
            self.note_changes(p, &of_particle, swaps, &mut changes);
            changed.push(p);
            parts.push((p, of_particle, kept));
        }
        let before = self.held_by(&changed, motion);
        let lost = self.move_weights(&changes, divides, motion);
        self.put_strained(parts, motion);
        let lost = lost + before - self.held_by(&changed, motion);
        self.recut = changed;
        lost
    }

    /// Whether a particle has these parts already, and mass in each of their fields: then none of them is new to it.
    fn has_kept(&self, particle: usize, parts: &Parts) -> bool {
        let Layout { cut, far, .. } = &self.layout;
        let has = |rows: &CutParticles, entries: &[Entry], part: (f64, Vector)| {
            rows.entries_of(particle).unwrap_or_default() == entries
                && rows.part_of(particle).is_none_or(|now| now == part)
                && entries.iter().all(|e| e.weight > NO_MASS)
        };
        cut.entries_of(particle).is_some()
            && has(cut, &parts.own, (parts.share, parts.own_way))
            && has(far, &parts.far, (1.0 - parts.share, parts.far_way))
    }

    /// Strain energy of `particles` [J/m].
    pub(super) fn held_by(&self, particles: &[usize], motion: &Motion) -> f64 {
        let mut reader = self.reader();
        particles.iter().map(|&p| self.particles.volume[p] * reader.energy_density(p, &motion.displacement)).sum()
    }

    /// The strains of both parts of a particle after it has been cut anew, from those before: material keeps its
    /// strain, and what goes from one part to the other takes it along, so that forces stay what they are.
    /// `swaps`: whether its parts [have changed sides](Self::has_changed_sides).
    pub(super) fn kept_strains(
        &self,
        particle: usize,
        new: &Parts,
        swaps: bool,
        [mut own, mut far]: [Matrix; 2],
    ) -> [Matrix; 2] {
        let mut before = self.layout.cut.part_of(particle).map_or(1.0, |part| part.0);
        if swaps {
            std::mem::swap(&mut own, &mut far);
            before = 1.0 - before;
        }
        let gained = new.share - before;
        if gained > 0.0 {
            own = (own * before + far * gained) / new.share;
        } else if new.share < 1.0 {
            far = (far * (1.0 - before) - own * gained) / (1.0 - new.share);
        }
        [own, far]
    }

    /// Puts new stencils in the place of old ones, with strains of both parts that stay what they are, whatever the
    /// fields have.
    pub(super) fn put_strained(&mut self, parts: Vec<(usize, Parts, [Matrix; 2])>, motion: &Motion) {
        let strains: Vec<(usize, [Matrix; 2])> = parts.iter().map(|(p, _, strains)| (*p, *strains)).collect();
        self.layout.put(parts.into_iter().map(|(p, parts, _)| (p, parts)).collect());
        // What only sums in another order has not changed.
        let real = |misfit: Matrix, strain: Matrix| {
            if misfit.norm() > ROUND_OFF * strain.norm() { misfit } else { Matrix::zeros() }
        };
        for (p, [own, far]) in strains {
            let misfit = own - self.reader().gradient(p, &motion.displacement);
            let across = self.reader().far_gradient(p, &motion.displacement);
            self.layout.cut.set_misfit(p, real(misfit, own));
            self.layout.far.set_misfit(p, across.map_or_else(Matrix::zeros, |now| real(far - now, far)));
        }
    }

    /// Whether what lies across a crack from a particle is now what was on its side before, as when the crack turns and
    /// passes it.
    pub(super) fn has_changed_sides(&self, particle: usize, new: &Parts) -> bool {
        let Layout { cut, far, .. } = &self.layout;
        let is_split = cut.part_of(particle).is_some_and(|part| part.0 < 1.0) && !new.far.is_empty();
        let (Some(own), Some(far), true) = (cut.entries_of(particle), far.entries_of(particle), is_split) else {
            return false;
        };
        let common = |a: &[Entry], b: &[Entry]| a.iter().filter(|a| b.iter().any(|b| b.field == a.field)).count();
        common(own, &new.far) + common(far, &new.own) > common(own, &new.own) + common(far, &new.far)
    }

    /// Notes how the weights of a particle move between its fields: part by part, and what lies across a crack now and
    /// did not before. `swaps`: whether its parts [have changed sides](Self::has_changed_sides).
    pub(super) fn note_changes(&self, particle: usize, new: &Parts, swaps: bool, changes: &mut Vec<WeightChange>) {
        let (mut own, mut far) = (Vec::with_capacity(16), Vec::new());
        let mut reader = self.reader();
        reader.for_each_entry(particle, |field, w, _| own.push((field as u32, w)));
        let mut before = self.layout.cut.part_of(particle).map_or(1.0, |part| part.0);
        if before < 1.0 {
            far.extend(self.layout.far.entries_of(particle).into_iter().flatten().map(|e| (e.field, e.weight)));
        }
        if swaps {
            std::mem::swap(&mut own, &mut far);
            before = 1.0 - before;
        }
        let now = |entries: &[Entry]| -> Vec<(u32, f64)> { entries.iter().map(|e| (e.field, e.weight)).collect() };
        let (own_now, far_now) = (now(&new.own), now(&new.far));
        let mut note = |from: &[(u32, f64)], to: &[(u32, f64)], share: f64| {
            if share > 0.0 {
                self.note_flow(particle, from, to, share, changes);
            }
        };
        note(&own, &own_now, before.min(new.share));
        note(&far, &far_now, 1.0 - before.max(new.share));
        note(&own, &far_now, before - new.share);
        note(&far, &own_now, new.share - before);
    }

    /// Notes, node by node, how a share of the weights of a particle moves from some fields to others.
    fn note_flow(
        &self,
        particle: usize,
        from: &[(u32, f64)],
        to: &[(u32, f64)],
        share: f64,
        changes: &mut Vec<WeightChange>,
    ) {
        let mut weights: Vec<(u32, u32, f64)> = Vec::with_capacity(16);
        let signed = from.iter().map(|&(field, w)| (field, -(w * share)));
        for (field, w) in signed.chain(to.iter().map(|&(field, w)| (field, w * share))) {
            match weights.iter_mut().find(|x| x.1 == field) {
                Some(x) => x.2 += w,
                None => weights.push((self.layout.fields.node(field as usize) as u32, field, w)),
            }
        }
        weights.sort_unstable_by_key(|x| (x.0, x.1));
        for of_node in weights.chunk_by(|a, b| a.0 == b.0) {
            let moved: Vec<(u32, f64)> = of_node.iter().filter(|x| x.2 != 0.0).map(|x| (x.1, x.2)).collect();
            if !moved.is_empty() {
                changes.push(WeightChange { moved, mass: self.particles.mass[particle] });
            }
        }
    }

    /// Moves weights between the fields of nodes, and mass, momentum and displacement with them. Returns the kinetic
    /// energy that is lost [J/m].
    pub(super) fn move_weights(&mut self, changes: &[WeightChange], divides: bool, motion: &mut Motion) -> f64 {
        self.layout.mass.resize(self.field_count(), 0.0);
        motion.resize(self.field_count());
        let field_changes = field_changes(changes, motion);
        let smallest = NO_MASS * self.least_mass;
        let twice = |mass: f64, velocity: Vector| mass * velocity.norm_squared();
        let mut lost = 0.0;
        for &(field, t) in &field_changes {
            let d = field as usize;
            lost += twice(self.layout.mass[d], motion.velocity(d));
            let kept = self.layout.mass[d] - t.mass_out;
            let kept = if kept < smallest { 0.0 } else { kept };
            let total = kept + t.mass_in;
            if (self.layout.mass[d] > 0.0) != (total >= smallest) {
                self.turned.push(self.layout.fields.node(d));
            }
            if total < smallest {
                self.layout.mass[d] = 0.0;
                motion.velocity[0][d] = 0.0;
                motion.velocity[1][d] = 0.0;
                continue;
            }
            for axis in 0..2 {
                let momentum = kept * motion.velocity[axis][d] + t.momentum_in[axis];
                motion.velocity[axis][d] = momentum / total;
                let moved = &mut motion.displacement[axis][d];
                if kept == 0.0 {
                    *moved = t.displacement_in[axis] / t.mass_in;
                } else if divides && t.mass_in > 0.0 {
                    *moved = (kept * *moved + t.displacement_in[axis]) / total;
                }
            }
            self.layout.mass[d] = total;
            lost -= twice(total, motion.velocity(d));
        }
        self.invert_masses_of(field_changes.iter().map(|of| of.0));
        0.5 * lost
    }
}

/// What leaves and enters each field, all `changes` together, by rising fields.
fn field_changes(changes: &[WeightChange], motion: &Motion) -> Vec<(u32, FieldChange)> {
    let mut fields: Vec<u32> = changes.iter().flat_map(|change| change.moved.iter().map(|m| m.0)).collect();
    fields.sort_unstable();
    fields.dedup();
    let mut of_fields = vec![None; fields.len()];
    for WeightChange { moved, mass } in changes {
        let given: f64 = moved.iter().filter(|m| m.1 < 0.0).map(|m| -m.1).sum();
        if given <= 0.0 {
            continue;
        }
        // All that is given goes into one pot, and every receiver takes its part of the mixture.
        let mut momentum = Vector::zeros();
        let mut displacement = Vector::zeros();
        for &(field, change) in moved.iter().filter(|m| m.1 < 0.0) {
            momentum += motion.velocity(field as usize) * (-change / given);
            displacement += motion.displacement(field as usize) * (-change / given);
        }
        for &(field, change) in moved {
            let Ok(at) = fields.binary_search(&field) else { continue };
            let of_field = of_fields[at].get_or_insert(FieldChange::default());
            if change < 0.0 {
                of_field.mass_out -= change * mass;
            } else {
                of_field.mass_in += change * mass;
                of_field.momentum_in += momentum * (change * mass);
                of_field.displacement_in += displacement * (change * mass);
            }
        }
    }
    fields.into_iter().zip(of_fields).filter_map(|(field, of_field)| Some((field, of_field?))).collect()
}
