//! The general path: particles with a stencil of their own.

use super::lattice::Lattice;
use super::motion::FieldVectors;
use super::rows::Run;
use crate::grid::entries::{Entries, Entry};
use crate::grid::walker::Walker;
use crate::material::elastic::Elastic;
use crate::particles::Particles;
use crate::saved::{self, Fits};
use fissure_plane::Matrix;
use serde::{Deserialize, Serialize};

/// A misfit below this is round-off [–].
const NO_MISFIT: f64 = 1e-15;

/// Particles with stored stencils.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct CutParticles {
    stencils: Entries,
    /// Displacement gradient of each row that no field accounts for: see [`CutParticles::set_misfit`].
    misfit: Vec<[f64; 4]>,
    /// Rows that have one.
    strained: Vec<u32>,
}

impl CutParticles {
    /// None of so many `particles`.
    pub(super) fn new(particles: usize) -> Self {
        Self { stencils: Entries::new(particles), misfit: Vec::new(), strained: Vec::new() }
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
        saved::below("a strained row", self.strained.iter().copied(), rows)
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
        if !was_strained && misfit != Matrix::zeros() {
            self.strained.push(row as u32);
        }
    }

    /// Lets go of all misfits but the part `kept`.
    pub(super) fn relax_misfits(&mut self, kept: f64) {
        let misfit = &mut self.misfit;
        self.strained.retain(|&row| {
            let of = &mut misfit[row as usize];
            let is_left = of.iter().any(|x| x.abs() > NO_MISFIT);
            *of = if is_left { of.map(|x| x * kept) } else { [0.0; 4] };
            is_left
        });
    }

    /// Puts new stencils in the place of old ones; particles that had none are added.
    pub(super) fn replace(&mut self, stencils: Vec<(usize, Vec<Entry>)>) {
        self.stencils.replace(stencils);
        self.misfit.resize(self.stencils.rows(), [0.0; 4]);
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
        let [force_x, force_y] = force;
        for (row, (p, entries)) in self.stencils.iter().enumerate() {
            let mut h = if with_misfits { self.misfit_of_row(row) } else { Matrix::zeros() };
            for e in entries {
                let (x, y) = (u[0][e.field as usize], u[1][e.field as usize]);
                h.m11 += x * e.gradient.x;
                h.m12 += x * e.gradient.y;
                h.m21 += y * e.gradient.x;
                h.m22 += y * e.gradient.y;
            }
            let elastic = &materials[particles.material[p] as usize];
            let stress = crate::first_piola_stress(&h, elastic.mu, elastic.lambda) * particles.volume[p];
            for e in entries {
                force_x[e.field as usize] -= stress.m11 * e.gradient.x + stress.m12 * e.gradient.y;
                force_y[e.field as usize] -= stress.m21 * e.gradient.x + stress.m22 * e.gradient.y;
            }
        }
    }
}

impl Lattice {
    /// Entries of a particle, cut by the cracks as they are; fields that do not exist yet are made.
    pub(super) fn make_entries(&mut self, particle: usize) -> Vec<Entry> {
        let place = self.particles.rest[particle];
        let stencil = self.stencil(place);
        let near = self.division.is_near(place);
        let nodes = self.grid.stencil(&stencil);
        let mut entries = Vec::with_capacity(stencil.width * stencil.width);
        for b in 0..stencil.width {
            for a in 0..stencil.width {
                let (w, g) = (stencil.weight(a, b), stencil.weight_gradient(a, b));
                let Some(node) = nodes.at(a, b) else { continue };
                if !near {
                    entries.push(Entry { field: node as u32, weight: w, gradient: g });
                    continue;
                }
                for share in self.division.pair(place, nodes.place(a, b)) {
                    let field = self.layout.fields.find_or_add(node, &share.crossed);
                    let gradient = g * share.fraction + share.gradient * w;
                    entries.push(Entry { field: field as u32, weight: w * share.fraction, gradient });
                }
            }
        }
        entries
    }

    /// Whether all four particles of a cell are there, whole, and of one material; then its material.
    fn whole_cell(&self, column: i32, row: i32) -> Option<u32> {
        // Place of the cell's lower left particle on the particle lattice, which starts at a node.
        let base = (self.grid.origin - self.particles.anchor) / self.particles.spacing;
        let (i0, j0) = (base.x.round() as i32 + 2 * column, base.y.round() as i32 + 2 * row);
        let mut material = None;
        let mut body = None;
        for (i, j) in [(i0, j0), (i0 + 1, j0), (i0, j0 + 1), (i0 + 1, j0 + 1)] {
            let p = self.particles.at([i, j])?;
            if self.division.is_near(self.particles.rest[p]) {
                return None;
            }
            if *material.get_or_insert(self.particles.material[p]) != self.particles.material[p]
                || *body.get_or_insert(self.particles.body[p]) != self.particles.body[p]
            {
                return None;
            }
        }
        material
    }

    /// The runs of the cells above a row of nodes, which is given by its index.
    pub(super) fn runs_of_row(&self, index: usize) -> Vec<Run> {
        let mut runs: Vec<Run> = Vec::new();
        if !self.has_rows() {
            return runs;
        }
        let row = self.grid.row(index).row;
        let mut walker = Walker::new(&self.grid);
        for span in self.grid.spans_of_row(index) {
            for column in span.first..span.end - 1 {
                let Some(rows) = walker.rows([column, row], 2) else { continue };
                let Some(material) = self.whole_cell(column, row) else { continue };
                let [lower, upper] = [rows[0] as u32, rows[1] as u32];
                match runs.last_mut() {
                    Some(run) if run.material == material && run.lower + run.count == lower => run.count += 1,
                    _ => runs.push(Run { lower, upper, count: 1, material }),
                }
            }
        }
        runs
    }

    /// Particles on the general path in the cells above a row of nodes: those no run covers.
    pub(super) fn cut_of_row(&self, index: usize, runs: &[Run]) -> Vec<usize> {
        let row = self.grid.row(index).row;
        let mut walker = Walker::new(&self.grid);
        let mut is_covered = |column: i32| {
            let Some([node, ..]) = walker.rows([column, row], 1) else { return false };
            let after = runs.partition_point(|run| run.lower as usize <= node);
            after > 0 && runs[after - 1].holds(node)
        };
        self.particles_of_row(row).filter(|&(column, _)| !is_covered(column)).map(|(_, p)| p).collect()
    }

    /// The particles in a row of cells, with their columns of cells: row by row of the particle lattice.
    fn particles_of_row(&self, row: i32) -> impl Iterator<Item = (i32, usize)> {
        let s = self.particles.spacing / self.grid.cell_size;
        let base = self.grid.in_cells(self.particles.anchor);
        let cell = move |offset: f64, place: i32| (offset + (f64::from(place) + 0.5) * s).floor() as i32;
        let place = |row: i32| (f64::from(row) - base.y) / s - 0.5;
        let (first, last) = (place(row).floor() as i32 - 1, place(row + 1).ceil() as i32 + 1);
        let rows = (first..=last).filter(move |&place| cell(base.y, place) == row);
        let of_row = rows.flat_map(|place| self.particles.within([i32::MIN, place], [i32::MAX, place]));
        of_row.map(move |p| (cell(base.x, self.particles.place[p][0]), p))
    }

    /// Cuts the whole lattice, at rest, and gathers the masses.
    pub(super) fn cut_all(&mut self) {
        let mut stencils = Vec::new();
        for row in 0..self.grid.rows() {
            let runs = self.runs_of_row(row);
            for p in self.cut_of_row(row, &runs) {
                stencils.push(p);
            }
            self.layout.runs[row] = runs;
        }
        let stencils = stencils.into_iter().map(|p| (p, self.make_entries(p))).collect();
        self.layout.cut.replace(stencils);
        let mut mass = vec![0.0; self.field_count()];
        let mut reader = self.reader();
        for p in 0..self.particles.len() {
            let m = self.particles.mass[p];
            reader.for_each_entry(p, |field, w, _| mass[field] += m * w);
        }
        self.layout.mass = mass;
        self.invert_masses();
    }
}
