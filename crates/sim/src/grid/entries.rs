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
    /// Row of each particle, or `NONE`.
    row: Vec<u32>,
    /// Particle of each row.
    particle: Vec<u32>,
    /// First entry of each row; one more at the end.
    first: Vec<u32>,
    /// Entries of all rows.
    entries: Vec<Entry>,
}

/// No row.
const NONE: u32 = u32::MAX;

impl Entries {
    /// No stencils of so many `particles`.
    pub(crate) fn new(particles: usize) -> Self {
        Self { row: vec![NONE; particles], first: vec![0], ..Self::default() }
    }

    /// Forgets all stencils of so many `particles`.
    pub(crate) fn clear(&mut self, particles: usize) {
        self.row.clear();
        self.row.resize(particles, NONE);
        self.particle.clear();
        self.first.clear();
        self.first.push(0);
        self.entries.clear();
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
        let is_divided = self.first.len() == rows + 1
            && self.first[0] == 0
            && self.first[rows] as usize == self.entries.len()
            && self.first.is_sorted();
        saved::ensure(is_divided, "the division of its rows")?;
        saved::below("a stencil", self.entries.iter().map(|e| e.field), fields)?;
        saved::finite("a stencil", self.entries.iter().flat_map(|e| [&e.weight, &e.gradient.x, &e.gradient.y]))
    }

    /// Number of rows.
    pub(crate) fn rows(&self) -> usize {
        self.particle.len()
    }

    /// Row of a particle, if it has one.
    #[inline]
    pub(crate) fn row_of(&self, particle: usize) -> Option<usize> {
        let row = *self.row.get(particle)?;
        (row != NONE).then_some(row as usize)
    }

    /// Entries of a particle, if they are stored.
    #[inline]
    pub(crate) fn of(&self, particle: usize) -> Option<&[Entry]> {
        self.row_of(particle).map(|row| self.of_row(row))
    }

    #[inline]
    fn of_row(&self, row: usize) -> &[Entry] {
        &self.entries[self.first[row] as usize..self.first[row + 1] as usize]
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
        self.entries.extend(entries);
        self.first.push(self.entries.len() as u32);
    }

    /// Puts new stencils in the place of old ones; particles that had none are added.
    pub(crate) fn replace(&mut self, stencils: Vec<(usize, Vec<Entry>)>) {
        let mut news: Vec<Option<Vec<Entry>>> = vec![None; self.rows()];
        for (particle, entries) in stencils {
            if self.row[particle] == NONE {
                self.row[particle] = self.particle.len() as u32;
                self.particle.push(particle as u32);
                news.push(Some(entries));
            } else {
                news[self.row[particle] as usize] = Some(entries);
            }
        }
        let mut first = Vec::with_capacity(news.len() + 1);
        let mut all = Vec::with_capacity(self.entries.len() + 64);
        for (row, new) in news.into_iter().enumerate() {
            first.push(all.len() as u32);
            match new {
                Some(entries) => all.extend(entries),
                None => all.extend_from_slice(self.of_row(row)),
            }
        }
        first.push(all.len() as u32);
        self.first = first;
        self.entries = all;
    }
}
