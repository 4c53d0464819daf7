//! Particles between a crack and an outline, or between two cracks, that nothing holds.
//!
//! What [`crate::loose`] says of corners goes for those as well that a crack makes: a particle that is alone on its
//! side of the crack in its cell, and shares too few fields with others, flaps without any strain. It rides on the
//! nearest particle of its side: its volume and its mass count as if they were there, and its own fields are gone.
//! What of a particle lies across a crack, and flaps there, counts to the particle's own side.

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

/// What has no hold of its own.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Riders {
    /// Who rides on whom: (rider, host), riders rising.
    hosts: Vec<(u32, u32)>,
    /// Particles, rising, that are not divided although a crack runs through them.
    undivided: Vec<u32>,
}

/// A particle, or what of it lies across a crack.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Part {
    particle: usize,
    is_far: bool,
}

impl Riders {
    /// The particle that another one rides on.
    pub(super) fn host(&self, particle: usize) -> Option<usize> {
        let found = self.hosts.binary_search_by_key(&(particle as u32), |&(rider, _)| rider);
        found.ok().map(|index| self.hosts[index].1 as usize)
    }

    /// Whether a particle is all on its own side of a crack that runs through it.
    pub(super) fn is_undivided(&self, particle: usize) -> bool {
        self.undivided.binary_search(&(particle as u32)).is_ok()
    }

    /// Checks what was read against so many `particles`.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(super) fn check(&self, particles: usize) -> Fits {
        saved::below("a rider", self.hosts.iter().flat_map(|&(rider, host)| [rider, host]), particles)?;
        saved::below("a particle", self.undivided.iter().copied(), particles)?;
        let is_sorted = self.hosts.is_sorted_by(|a, b| a.0 < b.0) && self.undivided.is_sorted_by(|a, b| a < b);
        saved::ensure(is_sorted, "the order of its riders")?;
        saved::ensure(self.hosts.iter().all(|&(_, host)| self.host(host as usize).is_none()), "a rider")
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
            reader.for_each_part(p, |field, _, w, _| seen[field] += u32::from(w > 0.0));
        }
        // Those that a crack or an outline has given a stencil of their own.
        let near =
            |&p: &usize| self.layout.cut.entries_of(p).is_some() && self.division.is_near(self.particles.rest[p]);
        let loose = self.loose_among((0..self.particles.len()).filter(near).collect(), &mut seen);
        let (riders, undivided) = self.seats(&loose, &[]);
        self.layout.riders.hosts = riders.iter().map(|&(p, host)| (p as u32, host as u32)).collect();
        self.layout.riders.undivided = undivided.iter().map(|&p| p as u32).collect();
        let moved = riders.into_iter().map(|(p, _)| p).chain(undivided);
        let parts = moved.map(|p| (p, self.make_parts(p))).collect();
        self.layout.put(parts);
    }

    /// Who of the `loose` and the `homeless` rides on whom, and who is not divided.
    fn seats(&self, loose: &[Part], homeless: &[usize]) -> (Vec<(usize, usize)>, Vec<usize>) {
        let own: Vec<usize> = loose.iter().filter(|part| !part.is_far).map(|part| part.particle).collect();
        let far = loose.iter().filter(|part| part.is_far).map(|part| part.particle);
        let undivided = far.filter(|p| own.binary_search(p).is_err()).collect();
        let mut all: Vec<usize> = own.iter().chain(homeless).copied().collect();
        all.sort_unstable();
        let mut riding: Vec<usize> = self.layout.riders.hosts.iter().map(|&(rider, _)| rider as usize).collect();
        riding.extend(&all);
        riding.sort_unstable();
        let riders = all.iter().filter_map(|&p| Some((p, self.nearest_host(p, &riding)?))).collect();
        (riders, undivided)
    }

    /// Puts the particles on others that a crack leaves without hold which has come to its end, at an outline or at
    /// another crack, within `boxes`; their mass and momentum go along. Those that ride already change where their host
    /// has got to the other side. Returns the energy that is lost [J/m].
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
            reader.for_each_part(p, |field, _, w, _| seen[field] += u32::from(w > 0.0));
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
                loose.binary_search(&Part { particle: host, is_far: false }).is_ok()
                    || self.is_across(body, self.particles.rest[p], self.particles.rest[host])
            })
        };
        let homeless: Vec<usize> = around.into_iter().filter(loses_host).collect();
        let (hosts, undivided) = self.seats(&loose, &homeless);
        self.seat(&hosts, &undivided, motion)
    }

    /// Puts particles on others, (rider, host), and others together on their own side, with their mass and momentum.
    /// Returns the energy that is lost [J/m].
    fn seat(&mut self, hosts: &[(usize, usize)], undivided: &[usize], motion: &mut Motion) -> f64 {
        let moved: Vec<usize> = hosts.iter().map(|&(p, _)| p).chain(undivided.iter().copied()).collect();
        if moved.is_empty() {
            return 0.0;
        }
        let riders = &mut self.layout.riders;
        riders.hosts.retain(|&(rider, _)| hosts.iter().all(|&(p, _)| p != rider as usize));
        riders.hosts.extend(hosts.iter().map(|&(p, host)| (p as u32, host as u32)));
        riders.hosts.sort_unstable();
        riders.undivided.extend(undivided.iter().map(|&p| p as u32));
        riders.undivided.sort_unstable();
        riders.undivided.dedup();
        let before = self.held_by(&moved, motion);
        let mut reader = self.reader();
        let strains: Vec<[Matrix; 2]> = moved.iter().map(|&p| reader.strains(p, &motion.displacement)).collect();
        let mut changes: Vec<WeightChange> = Vec::new();
        let mut parts = Vec::with_capacity(moved.len());
        for (k, (&p, strain)) in moved.iter().zip(&strains).enumerate() {
            let of_particle = self.make_parts(p);
            let swaps = self.has_changed_sides(p, &of_particle);
            if k < hosts.len() {
                changes.push(self.whole_change(p, &of_particle.own));
            } else {
                self.note_changes(p, &of_particle, swaps, &mut changes);
            }
            let kept = self.kept_strains(p, &of_particle, swaps, *strain);
            parts.push((p, of_particle, kept));
        }
        let lost = self.move_weights(&changes, false, motion);
        self.put_strained(parts, motion);
        lost + before - self.held_by(&moved, motion)
    }

    /// How all weights of a particle move to the fields of `new`, whatever their nodes are.
    fn whole_change(&self, particle: usize, new: &[Entry]) -> WeightChange {
        let mut moved: Vec<(u32, f64)> = Vec::with_capacity(16);
        let mut add = |field: u32, w: f64| match moved.iter_mut().find(|x| x.0 == field) {
            Some(x) => x.1 += w,
            None => moved.push((field, w)),
        };
        self.reader().for_each_part(particle, |field, share, w, _| add(field as u32, -w * share));
        new.iter().for_each(|e| add(e.field, e.weight));
        WeightChange { moved, mass: self.particles.mass[particle] }
    }

    /// Parts of `particles` that are loose, rising. `seen`: how many parts of particles have each field.
    fn loose_among(&self, particles: Vec<usize>, seen: &mut [u32]) -> Vec<Part> {
        let both = |particle: usize| [false, true].map(|is_far| Part { particle, is_far });
        let mut left: Vec<Part> =
            particles.into_iter().flat_map(both).filter(|&part| !self.entries(part).is_empty()).collect();
        let mut loose: Vec<Part> = Vec::new();
        for _ in 0..ROUNDS {
            let found: Vec<Part> = left.iter().copied().filter(|&part| self.is_loose(part, seen, &loose)).collect();
            if found.is_empty() {
                break;
            }
            for &part in &found {
                own_fields(self.entries(part)).for_each(|field| seen[field] -= 1);
            }
            left.retain(|part| found.binary_search(part).is_err());
            loose.extend(found);
            loose.sort_unstable();
        }
        loose
    }

    fn entries(&self, Part { particle, is_far }: Part) -> &[Entry] {
        let of = if is_far { &self.layout.far } else { &self.layout.cut };
        of.entries_of(particle).unwrap_or(&[])
    }

    /// Whether a part and those that share all fields of its cell with it are held by fewer than three fields of others
    /// if it is alone, by fewer than two if they are several. `seen`: how many parts have each field.
    fn is_loose(&self, part: Part, seen: &[u32], loose: &[Part]) -> bool {
        let fields: Vec<usize> = own_fields(self.entries(part)).collect();
        let [i, j] = self.particles.place[part.particle];
        let cell = self.grid.cell(self.particles.rest[part.particle]);
        let beside = self.particles.within([i - 1, j - 1], [i + 1, j + 1]);
        let is_mate = |q: &Part| {
            self.grid.cell(self.particles.rest[q.particle]) == cell
                && loose.binary_search(q).is_err()
                && own_fields(self.entries(*q)).eq(fields.iter().copied())
        };
        let both = |particle: usize| [false, true].map(|is_far| Part { particle, is_far });
        let mates = beside.flat_map(both).filter(is_mate).count() as u32;
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
            let (before, seated) = (sums(&total), total.lattice.layout.riders.hosts.len());
            let tip = TipId::new(0, End::End);
            let way: Vec<Point> =
                (1..=16).map(|j| turn * Point::new(3.0 + (width - 3.0) * f64::from(j) / 16.0, 2.7)).collect();
            cracks.grow(tip, &way);
            cracks.set_end(tip, CrackEnd::Mouth);
            total.recut(&cracks, &[tip]);
            riders += total.lattice.layout.riders.hosts.len() - seated;
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
