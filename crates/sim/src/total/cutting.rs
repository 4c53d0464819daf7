//! Cutting the lattice: which cells are whole and go as rows, which particles get stencils of their own, and what those
//! are.

use super::lattice::{Lattice, Layout};
use super::run::Run;
use crate::crack::division::CrossedSet;
use crate::crack::split::Split;
use crate::grid::entries::Entry;
use crate::grid::walker::Walker;
use fissure_plane::{Point, Vector};

/// The parts of a particle on both sides of a crack; the far one has no entries where none runs through it.
#[derive(Debug)]
pub(super) struct Parts {
    pub(super) own: Vec<Entry>,
    /// Share of the volume that its own side has.
    pub(super) share: f64,
    pub(super) own_way: Vector,
    pub(super) far: Vec<Entry>,
    pub(super) far_way: Vector,
}

impl Layout {
    /// Puts new stencils in the place of old ones.
    pub(super) fn put(&mut self, parts: Vec<(usize, Parts)>) {
        let (mut own, mut far, mut split) = (Vec::with_capacity(parts.len()), Vec::new(), Vec::new());
        for (p, parts) in parts {
            let is_split = !parts.far.is_empty();
            if is_split || self.far.entries_of(p).is_some() {
                far.push((p, parts.far));
            }
            split.push((p, parts.share, parts.own_way, parts.far_way));
            own.push((p, parts.own));
        }
        self.cut.replace(own);
        self.far.replace(far);
        for (p, share, own_way, far_way) in split {
            self.cut.set_part(p, share, own_way);
            self.far.set_part(p, 1.0 - share, far_way);
        }
    }
}

impl Lattice {
    /// What a particle sees of the nodes, cut by the cracks as they are; fields that do not exist yet are made.
    ///
    /// One that a crack runs through has two parts, each as large as what lies on its side, with the gradient at the
    /// centre of that. What both weigh stays where the particle stands.
    pub(super) fn make_parts(&mut self, particle: usize) -> Parts {
        let host = self.layout.riders.host(particle);
        let particle = host.unwrap_or(particle);
        let (place, body) = (self.particles.rest[particle], self.particles.body[particle]);
        // Of what an outline cuts, the mean gradient is that at its centre. Its mass stays where the particle stands,
        // or the nodes beyond a thin rest would be too light for any step.
        let off_center = self.particles.off_center(particle);
        let whole = Vector::zeros();
        let is_split = self.has_ties()
            && off_center.is_none()
            && self.division.is_near(place)
            && !self.layout.riders.is_undivided(particle);
        let split = if is_split { self.split(body, place) } else { None };
        if let Some(Split { share, near, far }) = split {
            let [near_entries, far_entries] =
                [near, far].map(|way| self.entries_seen_from(place, place + way, body, Some(way)));
            // What rides counts to the side of its host.
            if host.is_some() {
                return Parts { own: near_entries, share: 1.0, own_way: whole, far: Vec::new(), far_way: whole };
            }
            let differ = near_entries.iter().map(|e| e.field).ne(far_entries.iter().map(|e| e.field));
            if differ {
                return Parts { own: near_entries, share, own_way: near, far: far_entries, far_way: far };
            }
        }
        let own = self.entries_seen_from(place, place, body, off_center);
        Parts { own, share: 1.0, own_way: whole, far: Vec::new(), far_way: whole }
    }

    /// How the one crack that runs through the square of a particle at `place` splits it.
    fn split(&self, body: u32, place: Point) -> Option<Split> {
        let half = 0.5 * self.particles.spacing;
        self.division.split_square(place, half, |crack| self.body_of_crack[crack as usize] == body)
    }

    /// Entries of what stands at `place` and sees cracks from `from`, with the gradients `way` from `place` on.
    fn entries_seen_from(&mut self, place: Point, from: Point, body: u32, way: Option<Vector>) -> Vec<Entry> {
        let stencil = self.stencil(place);
        let slopes = match way {
            Some(way) => stencil.carried_on(way),
            None => stencil,
        };
        let near = self.division.is_near(place);
        let nodes = self.grid.stencil(&stencil);
        let last = stencil.width - 1;
        let mut entries = Vec::with_capacity(stencil.width * stencil.width);
        let around = near.then(|| self.division.around(from, nodes.place(0, 0), nodes.place(last, last)));
        for b in 0..stencil.width {
            for a in 0..stencil.width {
                let (w, g) = (stencil.weight(a, b), slopes.weight_gradient(a, b));
                let Some(node) = nodes.at(a, b) else { continue };
                let guest = self.owners.guest(node, body);
                let Some(around) = &around else {
                    let field = self.layout.fields.find_or_add(node, guest, &CrossedSet::new());
                    entries.push(Entry { field: field as u32, weight: w, gradient: g });
                    continue;
                };
                for share in self.shares_of(body, around, nodes.place(a, b)) {
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
    /// One that has a stencil of its own keeps it, be the crack that it was cut for no longer there: what lies ahead of
    /// a tip is no longer when the tip turns. A cell that went back to its row all the same would act
    /// twice.
    pub(super) fn is_whole(&self, particle: usize) -> bool {
        self.layout.cut.entries_of(particle).is_none()
            && !self.may_be_parted(self.particles.rest[particle])
            && self.particles.off_center(particle).is_none()
    }

    /// Whether a crack may part a particle at `place` from one of its nodes.
    fn may_be_parted(&self, place: Point) -> bool {
        let (low, high) = self.nodes_seen_from(place);
        self.division.may_part(place, low, high)
    }

    /// The four particles of a cell, from its lower left one on, row by row; none where one is not there.
    pub(super) fn particles_of_cell(&self, [column, row]: [i32; 2]) -> Option<[usize; 4]> {
        // Place of the cell's lower left particle on the particle lattice, which starts at a node.
        let base = (self.grid.origin - self.particles.anchor) / self.particles.spacing;
        let (i, j) = (base.x.round() as i32 + 2 * column, base.y.round() as i32 + 2 * row);
        let at = |i, j| self.particles.at([i, j]);
        Some([at(i, j)?, at(i + 1, j)?, at(i, j + 1)?, at(i + 1, j + 1)?])
    }

    /// Whether all four particles of a cell are there, whole, of one material and of the body that owns all its nodes,
    /// which are two each from `rows` on; then its material.
    fn whole_cell(&self, cell: [i32; 2], rows: [usize; 2]) -> Option<u32> {
        let own = self.particles_of_cell(cell)?;
        let (material, body) = (self.particles.material[own[0]], self.particles.body[own[0]]);
        let is_alike = |&p: &usize| self.particles.material[p] == material && self.particles.body[p] == body;
        if !own.iter().all(|&p| self.is_whole(p)) || !own.iter().all(is_alike) {
            return None;
        }
        let mut nodes = rows.into_iter().flat_map(|node| [node, node + 1]);
        let is_shared = nodes.any(|node| self.owners.guest(node, body).is_some());
        (!is_shared).then_some(material)
    }

    /// Takes a cell out of its run, if it is in one and no longer whole. Whether it was.
    pub(super) fn leave_run(&mut self, cell: [i32; 2]) -> bool {
        let Some(rows) = Walker::new(&self.grid).rows(cell, 2) else { return false };
        let Some(index) = self.grid.row_index(cell[1]) else { return false };
        let runs = &self.layout.runs[index];
        let Some(k) = runs.partition_point(|run| run.lower as usize <= rows[0]).checked_sub(1) else { return false };
        if !runs[k].holds(rows[0]) || self.whole_cell(cell, [rows[0], rows[1]]).is_some() {
            return false;
        }
        let left = runs[k].without(rows[0]);
        self.layout.runs[index].splice(k..=k, left);
        true
    }

    /// The runs of the cells above a row of nodes, which is given by its index.
    fn runs_of_row(&self, index: usize) -> Vec<Run> {
        let mut runs: Vec<Run> = Vec::new();
        if !self.has_rows() {
            return runs;
        }
        let row = self.grid.row(index).row;
        let mut walker = Walker::new(&self.grid);
        for span in self.grid.spans_of_row(index) {
            for column in span.first..span.end - 1 {
                let Some(rows) = walker.rows([column, row], 2) else { continue };
                let Some(material) = self.whole_cell([column, row], [rows[0], rows[1]]) else { continue };
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
    fn cut_of_row(&self, index: usize, runs: &[Run]) -> Vec<usize> {
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
        let parts: Vec<(usize, Parts)> = stencils.into_iter().map(|p| (p, self.make_parts(p))).collect();
        self.layout.put(parts);
        self.seat_riders();
        let mut mass = vec![0.0; self.field_count()];
        let mut reader = self.reader();
        for p in 0..self.particles.len() {
            let m = self.particles.mass[p];
            reader.for_each_part(p, |field, share, w, _| mass[field] += m * share * w);
        }
        self.layout.mass = mass;
        self.invert_masses();
    }
}
