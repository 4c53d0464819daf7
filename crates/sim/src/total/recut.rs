//! Taking up a crack that has grown: stencils change only near it, and what a weight carries changes hands with it.
//!
//! A (particle, node) weight that moves to another field takes its share of the node's momentum along, so momentum is conserved to
//! round-off and kinetic energy can only fall (fields merge inelastically). A field that is new takes the displacement of the fields its
//! mass came from, so that at the moment of the cut the strain does not change; a field that was there keeps its own.

use super::Total;
use super::refresh::Near;
use crate::crack::Crack;
use crate::crack::cracks::{Cracks, TipId};
use crate::crack::crossing::Side;
use crate::grid::entries::Entry;
use crate::grid::kernel;
use fissure_plane::{Matrix, Point, Vector, bounds};
use fissure_scene::{CrackEnd, End};

/// Stencils are laid anew within so many cells of what has changed of a crack: the window of the division, the kernel, and some room.
const REACH: f64 = 6.0;

/// A strain that changes by less than this part of itself has not changed.
const ROUND_OFF: f64 = 1e-12;

/// A field with less than this part of a particle's mass has lost all but round-off.
const NO_MASS: f64 = 1e-9;

/// What leaves and enters a field in a recut.
#[derive(Debug, Clone, Copy, Default)]
struct Transfer {
    mass_out: f64,
    mass_in: f64,
    momentum_in: Vector,
    displacement_in: Vector,
}

/// How the weight of one particle at one node moves between the fields of the node.
#[derive(Debug, Clone)]
struct Change {
    /// (field, change of weight); the changes add up to zero.
    moved: Vec<(u32, f64)>,
    /// Mass of the particle [kg/m].
    mass: f64,
}

impl Total {
    /// Makes room for new fields.
    pub(super) fn resize_fields(&mut self) {
        let fields = self.state.fields.len();
        self.state.mass.resize(fields, 0.0);
        let vectors = [&mut self.state.displacement, &mut self.state.velocity, &mut self.acceleration, &mut self.force];
        for values in vectors.into_iter().flatten() {
            values.resize(fields, 0.0);
        }
    }

    /// Takes up new crack points and new kinds of ends.
    pub(super) fn take_up(&mut self, cracks: &Cracks, changed: &[TipId]) {
        for &id in changed {
            self.state.cut_at.insert(id, cracks.position(id));
        }
        self.division = Self::division_of(&self.scene, cracks, &self.state.cut_at);
        let points_before: Vec<usize> = self.state.faces.iter().map(|faces| faces[0].len()).collect();
        let boxes: Vec<(Point, Point)> = changed.iter().map(|&id| self.changed_box(cracks.of(id), id.end)).collect();
        self.recut_particles(&boxes);
        self.refresh_probes(cracks, changed, &boxes);
        // Particles at the rim of a box, up to two rows beyond it, have given mass to nodes outside it, or taken it from them.
        let reach = Vector::repeat((0.5 * kernel::width(self.settings.kernel) as f64 + 1.0) * self.grid.cell_size);
        let boxes = boxes.into_iter().map(|(low, high)| (low - reach, high + reach)).collect();
        self.refresh_near(&Near::new(boxes, cracks, changed, &points_before), cracks);
    }

    /// The region in which stencils may change.
    fn changed_box(&self, crack: &Crack, end: End) -> (Point, Point) {
        // The last few points: increments are a good part of a cell, and the old window ends two cells behind the old tip.
        let n = crack.points.len().min(6);
        let (low, high) = match end {
            End::Start => bounds(&crack.points[..n]),
            End::End => bounds(&crack.points[crack.points.len() - n..]),
        };
        let reach = Vector::repeat(REACH * self.grid.cell_size);
        (low - reach, high + reach)
    }

    pub(super) fn recut_particles(&mut self, boxes: &[(Point, Point)]) {
        let mut affected: Vec<usize> = Vec::new();
        for &(low, high) in boxes {
            affected
                .extend(self.particles.in_box(low, high).filter(|&p| self.division.is_near(self.particles.rest[p])));
        }
        affected.sort_unstable();
        affected.dedup();
        // Cells that were whole leave their run; all their particles go on the general path.
        let mut rows: Vec<usize> =
            affected.iter().filter_map(|&p| self.grid.row_index(self.grid.cell(self.particles.rest[p])[1])).collect();
        rows.dedup();
        rows.sort_unstable();
        rows.dedup();
        for row in rows {
            let runs = self.runs_of_row(row);
            if runs != self.state.runs[row] {
                for p in self.cut_of_row(row, &runs) {
                    if self.state.cut.entries_of(p).is_none() {
                        affected.push(p);
                    }
                }
                self.state.runs[row] = runs;
            }
        }
        affected.sort_unstable();
        affected.dedup();
        let mut reader = self.reader();
        let strains: Vec<Matrix> = affected.iter().map(|&p| reader.strain(p)).collect();
        let mut stencils = Vec::with_capacity(affected.len());
        let mut changes: Vec<Change> = Vec::new();
        for &p in &affected {
            let entries = self.make_entries(p);
            self.note_changes(p, &entries, &mut changes);
            stencils.push((p, entries));
        }
        self.hand_over(&changes);
        self.state.cut.replace(stencils);
        for (&p, strain) in affected.iter().zip(strains) {
            let misfit = strain - self.reader().gradient(p, &self.state.displacement);
            // What only sums in another order has not changed.
            let is_real = misfit.norm() > ROUND_OFF * strain.norm();
            self.state.cut.set_misfit(p, if is_real { misfit } else { Matrix::zeros() });
        }
    }

    /// Notes per node how the weights of a particle move between its fields.
    fn note_changes(&self, particle: usize, new: &[Entry], changes: &mut Vec<Change>) {
        let mut weights: Vec<(u32, u32, f64)> = Vec::with_capacity(16);
        let mut add = |field: u32, w: f64| {
            let node = self.state.fields.node(field as usize) as u32;
            match weights.iter_mut().find(|x| x.1 == field) {
                Some(x) => x.2 += w,
                None => weights.push((node, field, w)),
            }
        };
        self.reader().for_each_entry(particle, |field, w, _| add(field as u32, -w));
        new.iter().for_each(|e| add(e.field, e.weight));
        weights.sort_unstable_by_key(|x| (x.0, x.1));
        for of_node in weights.chunk_by(|a, b| a.0 == b.0) {
            let moved: Vec<(u32, f64)> = of_node.iter().filter(|x| x.2 != 0.0).map(|x| (x.1, x.2)).collect();
            if !moved.is_empty() {
                changes.push(Change { moved, mass: self.particles.mass[particle] });
            }
        }
    }

    fn hand_over(&mut self, changes: &[Change]) {
        let fields = self.state.fields.len();
        self.resize_fields();
        let (u, v) = (&self.state.displacement, &self.state.velocity);
        let mut transfers: Vec<Transfer> = Vec::new();
        let mut index = std::collections::BTreeMap::<u32, usize>::new();
        for Change { moved, mass } in changes {
            let given: f64 = moved.iter().filter(|m| m.1 < 0.0).map(|m| -m.1).sum();
            if given <= 0.0 {
                continue;
            }
            // All that is given goes into one pot, and every receiver takes its part of the mixture.
            let mut momentum = Vector::zeros();
            let mut displacement = Vector::zeros();
            for &(field, change) in moved.iter().filter(|m| m.1 < 0.0) {
                let d = field as usize;
                momentum += Vector::new(v[0][d], v[1][d]) * (-change / given);
                displacement += Vector::new(u[0][d], u[1][d]) * (-change / given);
            }
            for &(field, change) in moved {
                let at = *index.entry(field).or_insert_with(|| {
                    transfers.push(Transfer::default());
                    transfers.len() - 1
                });
                let transfer = &mut transfers[at];
                if change < 0.0 {
                    transfer.mass_out -= change * mass;
                } else {
                    transfer.mass_in += change * mass;
                    transfer.momentum_in += momentum * (change * mass);
                    transfer.displacement_in += displacement * (change * mass);
                }
            }
        }
        debug_assert_eq!(fields, self.state.mass.len());
        let smallest = NO_MASS * self.particles.mass.iter().copied().fold(f64::INFINITY, f64::min);
        for (&field, &at) in &index {
            let d = field as usize;
            let t = transfers[at];
            let kept = self.state.mass[d] - t.mass_out;
            let kept = if kept < smallest { 0.0 } else { kept };
            let total = kept + t.mass_in;
            if total < smallest {
                self.state.mass[d] = 0.0;
                self.state.velocity[0][d] = 0.0;
                self.state.velocity[1][d] = 0.0;
                continue;
            }
            for axis in 0..2 {
                let momentum = kept * self.state.velocity[axis][d] + t.momentum_in[axis];
                self.state.velocity[axis][d] = momentum / total;
                if kept == 0.0 {
                    self.state.displacement[axis][d] = t.displacement_in[axis] / t.mass_in;
                }
            }
            self.state.mass[d] = total;
        }
    }

    /// The faces of a crack whose last point at one end has moved along its last segment.
    pub(super) fn move_last_faces(&mut self, cracks: &Cracks, id: TipId) {
        let crack = cracks.of(id);
        let n = crack.points.len();
        // The point before has a tangent that depends on the last one only by its direction, which stays.
        let last = if id.end == End::Start { 0 } else { n - 1 };
        for (face, side) in [Side::Above, Side::Below].into_iter().enumerate() {
            self.state.faces[id.crack][face][last] = self.face_probe(crack, last, side);
        }
    }

    fn refresh_probes(&mut self, cracks: &Cracks, changed: &[TipId], boxes: &[(Point, Point)]) {
        // Faces: a changed crack anew (points have been added), the others where they lie in a box.
        let within = |p: Point| boxes.iter().any(|(low, high)| p >= *low && p <= *high);
        for (index, crack) in cracks.iter().enumerate() {
            if index >= self.state.faces.len() {
                let faces = self.face_probes(crack);
                self.state.faces.push(faces);
            } else if changed.iter().any(|id| id.crack == index) || crack.points.iter().any(|&p| within(p)) {
                self.state.faces[index] = self.face_probes(crack);
            }
        }
        let probes = self.state.outlines.vertices().filter(|probe| within(probe.rest));
        let renewed: Vec<_> = probes.map(|probe| self.probe_entries(probe.rest, probe.nudged)).collect();
        let probes = self.state.outlines.vertices_mut().filter(|probe| within(probe.rest));
        probes.zip(renewed).for_each(|(probe, entries)| probe.entries = entries);
        for &id in changed {
            if cracks.end(id) == CrackEnd::Mouth {
                let point = cracks.position(id);
                let there =
                    |p: &super::cut::Probe| (p.rest - point).norm() < 1e-12 * self.grid.cell_size && p.nudged != p.rest;
                if !self.state.outlines.vertices().any(there) {
                    self.open_mouth(cracks, id);
                }
            }
        }
    }
}
