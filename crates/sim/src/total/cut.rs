//! The general path: particles with a stencil of their own.

use super::field_vectors::FieldVectors;
use crate::grid::entries::{Entries, Entry};
use crate::material::elastic::Elastic;
use crate::particles::Particles;
use crate::saved::{self, Fits};
use crate::threads;
use fissure_plane::{Matrix, Vector};
use serde::{Deserialize, Serialize};

/// A misfit below this is round-off [–] ...
const NO_MISFIT: f64 = 1e-15;
/// ... and one below this part of the strain does nothing that can be seen: rows would stay strained for 400 steps.
const SMALL_MISFIT: f64 = 1e-5;

/// What the stress of a row takes, over what a number of a list takes that is added to another.
const ROW_COST: usize = 32;

/// Particles with stored stencils.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct CutParticles {
    stencils: Entries,
    /// Displacement gradient of each row that no field accounts for: see [`CutParticles::set_misfit`].
    misfit: Vec<[f64; 4]>,
    /// Rows that have one.
    strained: Vec<u32>,
    /// Of each row, the share of its particle's volume that it stands for and the way from where the particle stands to
    /// the centre of that [m].
    parts: Vec<(f64, Vector)>,
}

impl CutParticles {
    /// None of so many `particles`.
    pub(super) fn new(particles: usize) -> Self {
        Self { stencils: Entries::new(particles), misfit: Vec::new(), strained: Vec::new(), parts: Vec::new() }
    }

    /// Finds the row of each of so many `particles`, which is not in what was read.
    pub(super) fn number_rows(&mut self, particles: usize) {
        self.stencils.number_rows(particles);
    }

    /// Checks rows that were read against so many `particles` and `fields`.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(super) fn check(&self, particles: usize, fields: usize) -> Fits {
        self.stencils.check(particles, fields)?;
        let rows = self.stencils.rows();
        saved::ensure(self.misfit.len() == rows, "the division of its rows")?;
        saved::finite("a row", self.misfit.iter().flatten())?;
        saved::ensure(self.parts.len() == rows, "the division of its rows")?;
        saved::finite("a row", self.parts.iter().flat_map(|(share, way)| [share, &way.x, &way.y]))?;
        saved::below("a strained row", self.strained.iter().copied(), rows)
    }

    /// The particles on the general path.
    pub(super) fn particles(&self) -> impl Iterator<Item = usize> {
        self.stencils.iter().map(|(p, _)| p)
    }

    /// Entries of a particle, if it is on the general path.
    #[inline]
    pub(super) fn entries_of(&self, particle: usize) -> Option<&[Entry]> {
        self.stencils.of(particle)
    }

    /// What the displacement gradient of a particle is more than its fields make it.
    pub(super) fn misfit_of(&self, particle: usize) -> Matrix {
        self.stencils.row_of(particle).map_or_else(Matrix::zeros, |row| self.misfit_of_row(row))
    }

    fn misfit_of_row(&self, row: usize) -> Matrix {
        let [a, b, c, d] = self.misfit[row];
        Matrix::new(a, b, c, d)
    }

    /// Makes the displacement gradient of a particle on the general path more than its fields make it.
    ///
    /// When a crack turns, what lies ahead of its tip between the old and the new direction changes sides, and is
    /// attached to fields that may lie a good part of a cell away from those it had. Its strain must not jump for that:
    /// the difference is kept, and let go of slowly enough for the lattice to follow.
    pub(super) fn set_misfit(&mut self, particle: usize, misfit: Matrix) {
        let Some(row) = self.stencils.row_of(particle) else { return };
        let was_strained = self.misfit[row] != [0.0; 4];
        self.misfit[row] = [misfit.m11, misfit.m12, misfit.m21, misfit.m22];
        // One that was let go of is in the list until the next step.
        if !was_strained && misfit != Matrix::zeros() && !self.strained.contains(&(row as u32)) {
            self.strained.push(row as u32);
        }
    }

    /// Tells of all misfits that can be let go of but the part `kept`: the row, the energy that its particle gains by
    /// that for the displacement `u` [J/m], and what it has per volume [J/m³].
    ///
    /// One that is larger than the strain of its particle is let go of only while that lowers the energy of the
    /// particle: it is that of fields which an open crack has parted, and they would be pulled together by what nothing
    /// pays for.
    pub(super) fn each_misfit(
        &mut self,
        kept: f64,
        particles: &Particles,
        materials: &[Elastic],
        u: &FieldVectors,
        each: &mut dyn FnMut(usize, f64, f64),
    ) {
        let mut strained = std::mem::take(&mut self.strained);
        strained.retain(|&row| {
            let row = row as usize;
            let (strain, own) = (self.strain_of_row(row, u), self.misfit_of_row(row));
            if own.amax() <= NO_MISFIT || own.norm_squared() <= SMALL_MISFIT.powi(2) * strain.norm_squared() {
                self.misfit[row] = [0.0; 4];
                return false;
            }
            // By all of what is let go of now, not by the slope: that may be past what lowers it.
            let before = self.energy_density(row, &strain, particles, materials);
            let after = self.energy_density(row, &(strain - own * (1.0 - kept)), particles, materials);
            let gain = self.volume(row, particles) * (after - before);
            if gain < 0.0 || own.norm_squared() <= strain.norm_squared() {
                each(row, gain, before);
            }
            true
        });
        self.strained = strained;
    }

    /// Lets go of the misfit of a row but the part `kept`; `before`: the energy per volume of its particle [J/m³].
    /// Returns the energy that it gains [J/m].
    pub(super) fn let_go(
        &mut self,
        row: usize,
        (kept, before): (f64, f64),
        particles: &Particles,
        materials: &[Elastic],
        u: &FieldVectors,
    ) -> f64 {
        self.misfit[row] = self.misfit[row].map(|x| x * kept);
        let after = self.energy_density(row, &self.strain_of_row(row, u), particles, materials);
        self.volume(row, particles) * (after - before)
    }

    /// The particle of a row.
    pub(super) fn particle_of(&self, row: usize) -> usize {
        self.stencils.row(row).0
    }

    /// Displacement gradient of a row for the displacement `u`, its misfit with it.
    fn strain_of_row(&self, row: usize, u: &FieldVectors) -> Matrix {
        gradient(self.stencils.row(row).1, self.misfit_of_row(row), u)
    }

    /// Volume that a row stands for [m²].
    fn volume(&self, row: usize, particles: &Particles) -> f64 {
        particles.volume[self.particle_of(row)] * self.parts[row].0
    }

    /// Energy per volume of the particle of a row for a displacement gradient [J/m³].
    fn energy_density(&self, row: usize, h: &Matrix, particles: &Particles, materials: &[Elastic]) -> f64 {
        let elastic = &materials[particles.material[self.particle_of(row)] as usize];
        crate::energy_density(h, elastic.mu, elastic.lambda)
    }

    /// Puts new stencils in the place of old ones; particles that had none are added. Each stands for the whole of its
    /// particle until [`CutParticles::set_part`] says otherwise.
    pub(super) fn replace(&mut self, stencils: Vec<(usize, Vec<Entry>)>) {
        let particles: Vec<usize> = stencils.iter().map(|(p, _)| *p).collect();
        self.stencils.replace(stencils);
        self.misfit.resize(self.stencils.rows(), [0.0; 4]);
        self.parts.resize(self.stencils.rows(), (1.0, Vector::zeros()));
        for p in particles {
            self.set_part(p, 1.0, Vector::zeros());
        }
    }

    /// Makes the row of a particle stand for a share of its volume, the centre of which is `way` from it [m].
    pub(super) fn set_part(&mut self, particle: usize, share: f64, way: Vector) {
        if let Some(row) = self.stencils.row_of(particle) {
            self.parts[row] = (share, way);
        }
    }

    /// What the row of a particle stands for: the share of its volume, and the way to its centre [m].
    pub(super) fn part_of(&self, particle: usize) -> Option<(f64, Vector)> {
        self.stencils.row_of(particle).map(|row| self.parts[row])
    }

    /// Adds the forces of the particles on the general path, with or without their misfits.
    pub(super) fn add_forces(
        &self,
        particles: &Particles,
        materials: &[Elastic],
        u: &FieldVectors,
        with_misfits: bool,
        force: &mut FieldVectors,
    ) {
        // First Piola–Kirchhoff stress times volume [N m].
        let stress = |row: usize| {
            let (p, entries) = self.stencils.row(row);
            let misfit = if with_misfits { self.misfit_of_row(row) } else { Matrix::zeros() };
            let h = gradient(entries, misfit, u);
            let elastic = &materials[particles.material[p] as usize];
            crate::first_piola_stress(&h, elastic.mu, elastic.lambda) * (particles.volume[p] * self.parts[row].0)
        };
        let [force_x, force_y] = force;
        let mut add = |row: usize, stress: Matrix| {
            for e in self.stencils.row(row).1 {
                force_x[e.field as usize] -= stress.m11 * e.gradient.x + stress.m12 * e.gradient.y;
                force_y[e.field as usize] -= stress.m21 * e.gradient.x + stress.m22 * e.gradient.y;
            }
        };
        let rows = self.stencils.rows();
        let part = threads::part(ROW_COST * rows) / ROW_COST;
        if part >= rows {
            return (0..rows).for_each(|row| add(row, stress(row)));
        }
        // Rows share fields: only stresses are shared out, and added one after the other.
        let mut stresses = vec![Matrix::zeros(); rows];
        threads::share_out([&mut stresses], part, &|start, [stresses]| {
            stresses.iter_mut().enumerate().for_each(|(k, of_row)| *of_row = stress(start + k));
        });
        stresses.into_iter().enumerate().for_each(|(row, of_row)| add(row, of_row));
    }
}

/// The displacement gradient that the displacement `u` of fields makes, and a `misfit` with it.
#[inline]
fn gradient(entries: &[Entry], misfit: Matrix, u: &FieldVectors) -> Matrix {
    let mut h = misfit;
    for e in entries {
        let (x, y) = (u[0][e.field as usize], u[1][e.field as usize]);
        h.m11 += x * e.gradient.x;
        h.m12 += x * e.gradient.y;
        h.m21 += y * e.gradient.x;
        h.m22 += y * e.gradient.y;
    }
    h
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::test_scenes::{free_body, rectangle};
    use fissure_scene::PlaneState;
    use proptest::prelude::*;

    proptest! {
        /// Truth: nothing pays for it. A misfit larger than the strain is let go of by any part at a time, and never
        /// raises the energy of its particle; where that lowers it, it goes.
        #[test]
        fn letting_go_of_a_large_misfit_gains_nothing(
            own in prop::array::uniform4(-0.3_f64..0.3), strain in prop::array::uniform4(-0.03_f64..0.03), kept in 0.0_f64..0.99,
        ) {
            let [own, strain] = [own, strain].map(|[a, b, c, d]| Matrix::new(a, b, c, d));
            prop_assume!(own.norm() > strain.norm());
            let scene = free_body(rectangle([0.0, 0.0], [1.0, 1.0]), 0.5);
            let particles = Particles::fill(&scene).unwrap();
            let elastic = Elastic::new(&scene.materials[0], PlaneState::Strain);
            // Two fields, each of which strains the particle along one axis.
            let entry = |field, gradient| Entry { field, weight: 0.5, gradient };
            let mut cut = CutParticles::new(particles.len());
            cut.replace(vec![(0, vec![entry(0, Vector::x()), entry(1, Vector::y())])]);
            cut.set_misfit(0, own);
            let of_fields = strain - own;
            let u = [vec![of_fields.m11, of_fields.m12], vec![of_fields.m21, of_fields.m22]];
            let energy = |cut: &CutParticles| {
                let h = gradient(cut.entries_of(0).unwrap(), cut.misfit_of(0), &u);
                crate::energy_density(&h, elastic.mu, elastic.lambda)
            };
            let before = energy(&cut);
            let lower = crate::energy_density(&(strain - own * (1.0 - kept)), elastic.mu, elastic.lambda) < before * (1.0 - 1e-9);
            let mut asked = Vec::new();
            cut.each_misfit(kept, &particles, &[elastic], &u, &mut |row, gain, density| asked.push((row, gain, density)));
            for (row, told, density) in asked {
                let gain = cut.let_go(row, (kept, density), &particles, &[elastic], &u);
                prop_assert!((gain - told).abs() <= 1e-9 * told.abs(), "{gain} {told}");
            }
            prop_assert!(energy(&cut) <= before, "{before} {}", energy(&cut));
            prop_assert!(!lower || energy(&cut) < before, "nothing is let go of");
        }
    }
}
