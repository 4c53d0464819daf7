//! Cutting the lattice: which cells are whole and go as rows, which particles get stencils of their own, and what those
//! are.

use super::lattice::Lattice;
use super::run::Run;
use crate::crack::division::CrossedSet;
use crate::grid::entries::Entry;
use crate::grid::walker::Walker;

impl Lattice {
    /// Entries of a particle, cut by the cracks as they are; fields that do not exist yet are made.
    pub(super) fn make_entries(&mut self, particle: usize) -> Vec<Entry> {
        let particle = self.layout.riders.host(particle).unwrap_or(particle);
        let (place, body) = (self.particles.rest[particle], self.particles.body[particle]);
        let stencil = self.stencil(place);
        // Of what an outline cuts, the mean gradient is that at its centre. Its mass stays where the particle stands,
        // or the nodes beyond a thin rest would be too light for any step.
        let slopes = match self.particles.off_center(particle) {
            Some(way) => stencil.carried_on(way),
            None => stencil,
        };
        let near = self.division.is_near(place);
        let nodes = self.grid.stencil(&stencil);
        let mut entries = Vec::with_capacity(stencil.width * stencil.width);
        for b in 0..stencil.width {
            for a in 0..stencil.width {
                let (w, g) = (stencil.weight(a, b), slopes.weight_gradient(a, b));
                let Some(node) = nodes.at(a, b) else { continue };
                let guest = self.owners.guest(node, body);
                if !near {
                    let field = self.layout.fields.find_or_add(node, guest, &CrossedSet::new());
                    entries.push(Entry { field: field as u32, weight: w, gradient: g });
                    continue;
                }
                for share in self.shares(body, place, nodes.place(a, b)) {
                    let field = self.layout.fields.find_or_add(node, guest, &share.crossed);
                    let gradient = g * share.fraction + share.gradient * w;
                    entries.push(Entry { field: field as u32, weight: w * share.fraction, gradient });
                }
            }
        }
        entries
    }

    /// Whether a particle is served by the nodes' own fields alone, and by the weights of its place.
    ///
    /// One that has a stencil of its own keeps it, be the crack that it was cut for no longer near: what lies ahead of
    /// a tip leaves its neighbourhood again when the tip turns. A cell that went back to its row all the same would act
    /// twice.
    pub(super) fn is_whole(&self, particle: usize) -> bool {
        self.layout.cut.entries_of(particle).is_none()
            && !self.division.is_near(self.particles.rest[particle])
            && self.particles.off_center(particle).is_none()
    }

    /// Whether all four particles of a cell are there, whole, of one material and of the body that owns all its nodes,
    /// which are two each from `rows` on; then its material.
    fn whole_cell(&self, column: i32, row: i32, rows: [usize; 2]) -> Option<u32> {
        // Place of the cell's lower left particle on the particle lattice, which starts at a node.
        let base = (self.grid.origin - self.particles.anchor) / self.particles.spacing;
        let (i0, j0) = (base.x.round() as i32 + 2 * column, base.y.round() as i32 + 2 * row);
        let mut material = None;
        let mut body = None;
        for (i, j) in [(i0, j0), (i0 + 1, j0), (i0, j0 + 1), (i0 + 1, j0 + 1)] {
            let p = self.particles.at([i, j])?;
            if !self.is_whole(p) {
                return None;
            }
            if *material.get_or_insert(self.particles.material[p]) != self.particles.material[p]
                || *body.get_or_insert(self.particles.body[p]) != self.particles.body[p]
            {
                return None;
            }
        }
        let body = body?;
        let mut nodes = rows.into_iter().flat_map(|node| [node, node + 1]);
        if nodes.any(|node| self.owners.guest(node, body).is_some()) {
            return None;
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
                let Some(material) = self.whole_cell(column, row, [rows[0], rows[1]]) else { continue };
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
        self.seat_riders();
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
