//! Particles between a crack and an outline, or between two cracks, that nothing holds.
//!
//! What [`crate::loose`] says of corners goes for those as well that a crack makes: a particle that is alone on its
//! side of the crack in its cell, and shares too few fields with others, flaps without any strain. It rides on the
//! nearest particle of its side: its volume and its mass count as if they were there, and its own fields are gone.

use super::lattice::Lattice;
use super::motion::Motion;
use super::recut::WeightChange;
use crate::grid::entries::Entry;
use crate::saved::{self, Fits};
use fissure_plane::{Matrix, Point, Vector};
use serde::{Deserialize, Serialize};

/// Rounds in which those are found that lose hold with others.
const ROUNDS: usize = 4;

/// A host is not farther away than so many spacings of particles along an axis.
const REACH: i32 = 3;

/// So many cells within what is cut anew all particles are known that share a field with another.
const MARGIN: f64 = 3.0;

/// Who rides on whom: (rider, host), riders rising.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Riders(Vec<(u32, u32)>);

impl Riders {
    /// The particle that another one rides on.
    pub(super) fn host(&self, particle: usize) -> Option<usize> {
        let found = self.0.binary_search_by_key(&(particle as u32), |&(rider, _)| rider);
        found.ok().map(|index| self.0[index].1 as usize)
    }

    /// Checks what was read against so many `particles`.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(super) fn check(&self, particles: usize) -> Fits {
        saved::below("a rider", self.0.iter().flat_map(|&(rider, host)| [rider, host]), particles)?;
        saved::ensure(self.0.is_sorted_by(|a, b| a.0 < b.0), "the order of its riders")?;
        saved::ensure(self.0.iter().all(|&(_, host)| self.host(host as usize).is_none()), "a rider")
    }
}

impl Lattice {
    /// Puts the particles that the cracks as they are leave without hold on others.
    pub(super) fn seat_riders(&mut self) {
        if !self.has_rows() || self.layout.fields.further_count() == 0 {
            return;
        }
        let mut seen = vec![0_u32; self.field_count()];
        let mut reader = self.reader();
        for p in 0..self.particles.len() {
            reader.for_each_entry(p, |field, w, _| seen[field] += u32::from(w > 0.0));
        }
        // Those that a crack or an outline has given a stencil of their own.
        let near =
            |&p: &usize| self.layout.cut.entries_of(p).is_some() && self.division.is_near(self.particles.rest[p]);
        let loose = self.loose_among((0..self.particles.len()).filter(near).collect(), &mut seen);
        let riders = loose.iter().filter_map(|&p| Some((p as u32, self.nearest_host(p, &loose)? as u32))).collect();
        self.layout.riders = Riders(riders);
        let stencils = loose.into_iter().map(|p| (p, self.make_entries(p))).collect();
        self.layout.cut.replace(stencils);
    }

    /// Puts the particles on others that a crack leaves without hold which has come to its end, at an outline or at
    /// another crack, within `boxes`; their mass and momentum go along. Those that ride already change where their host
    /// has got to the other side. Returns the kinetic energy that is lost [J/m].
    pub(super) fn seat_more_riders(&mut self, boxes: &[(Point, Point)], motion: &mut Motion) -> f64 {
        if !self.has_rows() {
            return 0.0;
        }
        let mut around: Vec<usize> = boxes.iter().flat_map(|&(low, high)| self.particles.in_box(low, high)).collect();
        around.sort_unstable();
        around.dedup();
        let mut seen = vec![0_u32; self.field_count()];
        let mut reader = self.reader();
        for &p in around.iter().filter(|&&p| self.layout.riders.host(p).is_none()) {
            reader.for_each_entry(p, |field, w, _| seen[field] += u32::from(w > 0.0));
        }
        let margin = Vector::repeat(MARGIN * self.grid.cell_size);
        let is_within = |p: Point| boxes.iter().any(|(low, high)| p >= low + margin && p <= high - margin);
        let near = |&p: &usize| {
            let place = self.particles.rest[p];
            self.layout.riders.host(p).is_none()
                && self.layout.cut.entries_of(p).is_some()
                && self.division.is_near(place)
                && is_within(place)
        };
        let loose = self.loose_among(around.iter().copied().filter(near).collect(), &mut seen);
        let loses_host = |&p: &usize| {
            let body = self.particles.body[p];
            self.layout.riders.host(p).is_some_and(|host| {
                loose.binary_search(&host).is_ok()
                    || self.is_across(body, self.particles.rest[p], self.particles.rest[host])
            })
        };
        let moved: Vec<usize> =
            around.into_iter().filter(|p| loose.binary_search(p).is_ok() || loses_host(p)).collect();
        self.seat(&moved, motion)
    }

    /// Puts particles on others, with their mass and momentum. Returns the kinetic energy that is lost [J/m].
    fn seat(&mut self, moved: &[usize], motion: &mut Motion) -> f64 {
        let mut riding: Vec<usize> = self.layout.riders.0.iter().map(|&(rider, _)| rider as usize).collect();
        riding.extend(moved);
        riding.sort_unstable();
        riding.dedup();
        let hosts: Vec<(usize, usize)> =
            moved.iter().filter_map(|&p| Some((p, self.nearest_host(p, &riding)?))).collect();
        if hosts.is_empty() {
            return 0.0;
        }
        let mut reader = self.reader();
        let strains: Vec<Matrix> = hosts.iter().map(|&(p, _)| reader.strain(p, &motion.displacement)).collect();
        let riders = &mut self.layout.riders.0;
        riders.retain(|&(rider, _)| hosts.iter().all(|&(p, _)| p != rider as usize));
        riders.extend(hosts.iter().map(|&(p, host)| (p as u32, host as u32)));
        riders.sort_unstable();
        let stencils: Vec<(usize, Vec<Entry>)> = hosts.iter().map(|&(p, _)| (p, self.make_entries(p))).collect();
        let changes: Vec<WeightChange> = stencils.iter().map(|(p, new)| self.whole_change(*p, new)).collect();
        let lost = self.move_weights(&changes, false, motion);
        self.layout.cut.replace(stencils);
        for (&(p, _), strain) in hosts.iter().zip(strains) {
            let misfit = strain - self.reader().gradient(p, &motion.displacement);
            self.layout.cut.set_misfit(p, misfit);
        }
        self.invert_masses();
        lost
    }

    /// How all weights of a particle move to the fields of `new`, whatever their nodes are.
    fn whole_change(&self, particle: usize, new: &[Entry]) -> WeightChange {
        let mut moved: Vec<(u32, f64)> = Vec::with_capacity(16);
        let mut add = |field: u32, w: f64| match moved.iter_mut().find(|x| x.0 == field) {
            Some(x) => x.1 += w,
            None => moved.push((field, w)),
        };
        self.reader().for_each_entry(particle, |field, w, _| add(field as u32, -w));
        new.iter().for_each(|e| add(e.field, e.weight));
        WeightChange { moved, mass: self.particles.mass[particle] }
    }

    /// Those of `left`, rising, that are loose, rising. `seen`: how many particles have each field.
    fn loose_among(&self, mut left: Vec<usize>, seen: &mut [u32]) -> Vec<usize> {
        let mut loose: Vec<usize> = Vec::new();
        for _ in 0..ROUNDS {
            let found: Vec<usize> = left.iter().copied().filter(|&p| self.is_loose(p, seen, &loose)).collect();
            if found.is_empty() {
                break;
            }
            for &p in &found {
                own_fields(self.entries(p)).for_each(|field| seen[field] -= 1);
            }
            left.retain(|p| found.binary_search(p).is_err());
            loose.extend(found);
            loose.sort_unstable();
        }
        loose
    }

    fn entries(&self, particle: usize) -> &[Entry] {
        self.layout.cut.entries_of(particle).unwrap_or(&[])
    }

    /// Whether a particle and those that share all fields of its cell with it are held by fewer than three fields of
    /// others if it is alone, by fewer than two if they are several. `seen`: how many particles have each field.
    fn is_loose(&self, particle: usize, seen: &[u32], loose: &[usize]) -> bool {
        let fields: Vec<usize> = own_fields(self.entries(particle)).collect();
        let [i, j] = self.particles.place[particle];
        let cell = self.grid.cell(self.particles.rest[particle]);
        let beside = self.particles.within([i - 1, j - 1], [i + 1, j + 1]);
        let is_mate = |&q: &usize| {
            self.grid.cell(self.particles.rest[q]) == cell
                && loose.binary_search(&q).is_err()
                && own_fields(self.entries(q)).eq(fields.iter().copied())
        };
        let mates = beside.filter(is_mate).count() as u32;
        let shared = fields.iter().filter(|&&field| seen[field] > mates).count();
        shared < if mates > 1 { 2 } else { 3 }
    }

    /// The nearest particle on the same side of all cracks that is not `loose`.
    fn nearest_host(&self, particle: usize, loose: &[usize]) -> Option<usize> {
        let (place, body) = (self.particles.rest[particle], self.particles.body[particle]);
        let [i, j] = self.particles.place[particle];
        let around = self.particles.within([i - REACH, j - REACH], [i + REACH, j + REACH]);
        let can_hold = |&q: &usize| {
            self.particles.body[q] == body
                && loose.binary_search(&q).is_err()
                && !self.is_across(body, place, self.particles.rest[q])
        };
        let away = |q: usize| (self.particles.rest[q] - place).norm_squared();
        around.filter(can_hold).min_by(|&a, &b| away(a).total_cmp(&away(b)))
    }
}

/// The fields in which a particle has a part.
fn own_fields(entries: &[Entry]) -> impl Iterator<Item = usize> {
    entries.iter().filter(|entry| entry.weight > 0.0).map(|entry| entry.field as usize)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use crate::crack::cracks::{Cracks, TipId};
    use crate::particles::Particles;
    use crate::solver::Solver;
    use crate::test_scenes::{add_crack, free_body, rectangle};
    use crate::total::field_vectors::FieldVectors;
    use crate::total::{Total, internal_forces};
    use fissure_plane::Point;
    use fissure_scene::{CrackEnd, End, Formulation, Kernel, Scene, TipDivision};
    use std::sync::Arc;

    /// Modes of the linearised lattice that take less than 1e-5 of the stiffness of the stiffest, mass for mass.
    fn modes_without_strain(total: &Total) -> usize {
        let inverse_mass = &total.lattice.inverse_mass;
        let fields: Vec<usize> = (0..inverse_mass.len()).filter(|&d| inverse_mass[d] > 0.0).collect();
        let (n, amplitude) = (fields.len(), 1e-7 * total.lattice.grid.cell_size);
        let mut matrix = nalgebra::DMatrix::zeros(2 * n, 2 * n);
        let mut force = FieldVectors::default();
        for column in 0..2 * n {
            let mut u: FieldVectors = [0, 1].map(|_| vec![0.0; inverse_mass.len()]);
            let moved = fields[column % n];
            u[column / n][moved] = amplitude;
            internal_forces(&total.lattice, &total.ties, &u, &mut force);
            for row in 0..2 * n {
                let d = fields[row % n];
                matrix[(row, column)] = -force[row / n][d] / amplitude * (inverse_mass[d] * inverse_mass[moved]).sqrt();
            }
        }
        let symmetric = (&matrix + matrix.transpose()) * 0.5;
        let values = symmetric.symmetric_eigenvalues();
        values.iter().filter(|&&value| value < 1e-5 * values.max()).count()
    }

    /// A plate turned by `turn`, of a width of its own, with a crack from its left side to the middle.
    fn cracked_plate(turn: nalgebra::Rotation2<f64>, width: f64) -> Scene {
        let mut region = rectangle([0.0, 0.0], [width, 5.4]);
        region.exterior.iter_mut().for_each(|p| *p = turn * *p);
        let mut scene = free_body(region, 0.5);
        scene.solver.formulation = Formulation::Total;
        scene.solver.kernel = Kernel::Bilinear;
        scene.solver.tip_division = TipDivision::PartlyCut;
        let place = |x: f64, y: f64| (turn * Point::new(x, y)).into();
        let mouth: [f64; 2] = place(0.0, 2.7);
        // A mouth is a corner of the outline.
        scene.bodies[0].region.exterior.push(mouth.into());
        add_crack(&mut scene, &[mouth, place(3.0, 2.7)]);
        scene
    }

    /// Truth: two halves move without strain in three ways each, wherever the crack leaves that has grown across, and
    /// momentum and mass stay what they are.
    #[test]
    fn a_plate_that_has_cracked_across_has_six_motions_without_strain() {
        let mut riders = 0;
        for k in 0..20 {
            let (turn, width) = (nalgebra::Rotation2::new(0.317 * f64::from(k)), 7.0 + 0.13 * f64::from(k % 5));
            let scene = cracked_plate(turn, width);
            let mut cracks = Cracks::of_scene(&scene);
            let mut total = Total::new(&scene, Arc::new(Particles::fill(&scene).unwrap()), &cracks).unwrap();
            total.motion.velocity.iter_mut().flatten().enumerate().for_each(|(d, v)| *v = (d as f64).sin());
            let sums = |total: &Total| {
                let mass = &total.lattice.layout.mass;
                let along =
                    |axis: usize| mass.iter().zip(&total.motion.velocity[axis]).map(|(m, v)| m * v).sum::<f64>();
                [mass.iter().sum(), along(0), along(1)]
            };
            let (before, seated) = (sums(&total), total.lattice.layout.riders.0.len());
            let tip = TipId::new(0, End::End);
            let way: Vec<Point> =
                (1..=16).map(|j| turn * Point::new(3.0 + (width - 3.0) * f64::from(j) / 16.0, 2.7)).collect();
            cracks.grow(tip, &way);
            cracks.set_end(tip, CrackEnd::Mouth);
            total.recut(&cracks, &[tip]);
            riders += total.lattice.layout.riders.0.len() - seated;
            assert_eq!(modes_without_strain(&total), 6, "turned by {:.3} rad", turn.angle());
            for (a, b) in before.into_iter().zip(sums(&total)) {
                assert!((a - b).abs() < 1e-9 * before[0], "turned by {:.3} rad: {a} and {b}", turn.angle());
            }
        }
        assert!(riders > 0, "nobody rides");
    }

    /// Truth: a plate with a crack that does not part it moves without strain in three ways, by shifts and by a turn,
    /// counted by the eigenvalues of its stiffness.
    #[test]
    fn a_cracked_plate_has_three_motions_without_strain() {
        for k in 0..20 {
            let turn = nalgebra::Rotation2::new(0.317 * f64::from(k));
            let scene = cracked_plate(turn, 7.0 + 0.13 * f64::from(k % 5));
            let cracks = Cracks::of_scene(&scene);
            let total = Total::new(&scene, Arc::new(Particles::fill(&scene).unwrap()), &cracks).unwrap();
            assert_eq!(modes_without_strain(&total), 3, "turned by {:.3} rad", turn.angle());
        }
    }
}
