//! Stencils that are stored: those of particles that cracks divide, or that lie beside a border.

use crate::saved::{self, Fits};
use fissure_scene::Vector;
use serde::{Deserialize, Serialize};

/// One (particle, field) pair.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Entry {
    pub(crate) field: u32,
    /// Weight times share [–].
    pub(crate) weight: f64,
    /// Gradient of it [1/m].
    pub(crate) gradient: Vector,
}

/// The stored stencils, one row per particle that has one.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Entries {
    /// Row of each particle, or `NONE`. It follows from the particle of each row: see [`Entries::number_rows`].
    #[serde(skip)]
    row: Vec<u32>,
    /// Particle of each row.
    particle: Vec<u32>,
    /// First entry of each row.
    first: Vec<u32>,
    /// Number of entries of each row.
    count: Vec<u32>,
    /// Entries of all rows, and some that are of none any more.
    entries: Vec<Entry>,
    /// How many are of none.
    unused: u32,
}

/// No row.
const NONE: u32 = u32::MAX;

impl Entries {
    /// No stencils of so many `particles`.
    pub(crate) fn new(particles: usize) -> Self {
        Self { row: vec![NONE; particles], ..Self::default() }
    }

    /// Forgets all stencils of so many `particles`.
    pub(crate) fn clear(&mut self, particles: usize) {
        self.row.clear();
        self.row.resize(particles, NONE);
        self.particle.clear();
        self.first.clear();
        self.count.clear();
        self.entries.clear();
        self.unused = 0;
    }

    /// Finds the row of each of so many `particles`, which is not in what was read.
    pub(crate) fn number_rows(&mut self, particles: usize) {
        self.row.resize(particles, NONE);
        for (row, &particle) in self.particle.iter().enumerate() {
            // Others are found by the check.
            if let Some(of_particle) = self.row.get_mut(particle as usize) {
                *of_particle = row as u32;
            }
        }
    }

    /// Checks rows that were read against so many `particles` and `fields`.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(crate) fn check(&self, particles: usize, fields: usize) -> Fits {
        let rows = self.particle.len();
        saved::ensure(self.row.len() == particles, "its number of particles")?;
        saved::below("a row", self.particle.iter().copied(), particles)?;
        let of_particle = |(row, &particle): (usize, &u32)| self.row[particle as usize] as usize == row;
        saved::ensure(self.particle.iter().enumerate().all(of_particle), "a row of a particle")?;
        saved::below("a particle", self.row.iter().copied().filter(|&row| row != NONE), rows)?;
        let is_inside = |(&first, &count): (&u32, &u32)| first as usize + count as usize <= self.entries.len();
        let is_divided = self.first.len() == rows
            && self.count.len() == rows
            && self.unused as usize <= self.entries.len()
            && self.first.iter().zip(&self.count).all(is_inside);
        saved::ensure(is_divided, "the division of its rows")?;
        saved::below("a stencil", self.entries.iter().map(|e| e.field), fields)?;
        saved::finite("a stencil", self.entries.iter().flat_map(|e| [&e.weight, &e.gradient.x, &e.gradient.y]))
    }

    /// Number of rows.
    pub(crate) fn rows(&self) -> usize {
        self.particle.len()
    }

    /// Row of a particle, if it has one.
    #[inline(always)]
    pub(crate) fn row_of(&self, particle: usize) -> Option<usize> {
        let row = *self.row.get(particle)?;
        (row != NONE).then_some(row as usize)
    }

    /// Entries of a particle, if they are stored.
    #[inline(always)]
    pub(crate) fn of(&self, particle: usize) -> Option<&[Entry]> {
        self.row_of(particle).map(|row| self.of_row(row))
    }

    #[inline(always)]
    fn of_row(&self, row: usize) -> &[Entry] {
        let first = self.first[row] as usize;
        &self.entries[first..first + self.count[row] as usize]
    }

    /// Particle and entries of a row.
    #[inline]
    pub(crate) fn row(&self, row: usize) -> (usize, &[Entry]) {
        (self.particle[row] as usize, self.of_row(row))
    }

    /// Every particle that has a row with its entries, row by row.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (usize, &[Entry])> {
        (0..self.rows()).map(|row| self.row(row))
    }

    /// Adds the row of a particle that has none.
    pub(crate) fn push(&mut self, particle: usize, entries: impl IntoIterator<Item = Entry>) {
        self.row[particle] = self.particle.len() as u32;
        self.particle.push(particle as u32);
        let first = self.entries.len();
        self.entries.extend(entries);
        self.first.push(first as u32);
        self.count.push((self.entries.len() - first) as u32);
    }

    /// Puts new stencils in the place of old ones; particles that had none are added. Rows elsewhere stay where they
    /// are.
    pub(crate) fn replace(&mut self, stencils: Vec<(usize, Vec<Entry>)>) {
        for (particle, entries) in stencils {
            match self.row_of(particle) {
                None => self.push(particle, entries),
                Some(row) => self.put(row, &entries),
            }
        }
        if self.unused as usize > self.entries.len() / 2 {
            self.move_together();
        }
    }

    /// Puts new entries in the place of those of a row, or at the end when they are more.
    fn put(&mut self, row: usize, entries: &[Entry]) {
        let before = self.count[row] as usize;
        if entries.len() > before {
            self.unused += before as u32;
            self.first[row] = self.entries.len() as u32;
            self.entries.extend_from_slice(entries);
        } else {
            self.unused += (before - entries.len()) as u32;
            let first = self.first[row] as usize;
            self.entries[first..first + entries.len()].copy_from_slice(entries);
        }
        self.count[row] = entries.len() as u32;
    }

    /// Leaves out what is of no row any more.
    fn move_together(&mut self) {
        let mut entries = Vec::with_capacity(self.entries.len());
        for row in 0..self.rows() {
            let first = entries.len() as u32;
            entries.extend_from_slice(self.of_row(row));
            self.first[row] = first;
        }
        self.entries = entries;
        self.unused = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Truth: a list of lists. Whatever is put where, every particle has the entries it was given last.
        #[test]
        fn every_particle_has_what_it_was_given_last(
            given in prop::collection::vec(prop::collection::vec((0_usize..12, 0_usize..9), 0..6), 0..40),
        ) {
            let (mut entries, mut plain) = (Entries::new(12), vec![None; 12]);
            for (round, stencils) in given.into_iter().enumerate() {
                let entry = |k: usize| Entry { field: k as u32, weight: round as f64, gradient: Vector::zeros() };
                let stencils: Vec<(usize, Vec<Entry>)> =
                    stencils.into_iter().map(|(p, count)| (p, (0..count).map(entry).collect())).collect();
                stencils.iter().for_each(|(p, new)| plain[*p] = Some(new.clone()));
                entries.replace(stencils);
                for (p, of_particle) in plain.iter().enumerate() {
                    prop_assert_eq!(entries.of(p), of_particle.as_deref());
                }
                prop_assert!(entries.check(12, 9).is_ok());
                prop_assert!(entries.unused as usize <= entries.entries.len() / 2);
            }
        }
    }
}
