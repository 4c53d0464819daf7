//! The general path: particles with a stencil of their own, and probes that ride on the material.

use super::{FieldVectors, Run, Total};
use crate::crack::Crack;
use crate::crack::cracks::{Cracks, TipId};
use crate::crack::crossing::Side;
use crate::faces::outlines::{Outlines, Vertex};
use crate::grid::Walker;
use crate::grid::entries::{Entries, Entry};
use crate::saved::{self, Fits};
use fissure_scene::{CrackEnd, End, Matrix, Point, Vector};
use serde::{Deserialize, Serialize};

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
    /// When a crack turns, what lies ahead of its tip between the old and the new direction changes sides, and is attached to fields that may lie a good part of
    /// a cell away from those it had. Its strain must not jump for that: the difference is kept, and let go of slowly enough for the lattice to follow.
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
}

/// A place at rest that rides on the material: a vertex of an outline, a point of a crack face, a place of a load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Probe {
    /// Where it is at rest [m].
    pub(super) rest: Point,
    /// A hair beside it, on the side of the crack it belongs to [m].
    pub(super) nudged: Point,
    /// (field, weight).
    pub(super) entries: Vec<(u32, f64)>,
}

impl Vertex for Probe {
    fn rest(&self) -> Point {
        self.rest
    }

    fn is_at_mouth(&self) -> bool {
        // Only the faces of cracks are decided on beside where they are.
        self.nudged != self.rest
    }
}

impl Probe {
    /// Checks a probe that was read against so many `fields`.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(super) fn check(&self, fields: usize) -> Fits {
        saved::finite(
            "a probe",
            self.rest.iter().chain(self.nudged.iter()).chain(self.entries.iter().map(|(_, w)| w)),
        )?;
        saved::below("a probe", self.entries.iter().map(|(field, _)| *field), fields)
    }

    /// Value of a field vector at the probe.
    pub(super) fn value(&self, u: &FieldVectors) -> Vector {
        let mut value = Vector::zeros();
        for &(field, w) in &self.entries {
            value += Vector::new(u[0][field as usize], u[1][field as usize]) * w;
        }
        value
    }
}

/// A misfit below this is round-off [–].
const NO_MISFIT: f64 = 1e-15;

/// A weight below this comes from the rounding of a place [–].
const ROUND_OFF: f64 = 1e-9;

/// How far beside a crack the side of a face point is decided, in cells.
const NUDGE: f64 = 1e-6;

impl Total {
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
                    let field = self.state.fields.find_or_add(node, &share.crossed);
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
            self.state.runs[row] = runs;
        }
        let stencils = stencils.into_iter().map(|p| (p, self.make_entries(p))).collect();
        self.state.cut.replace(stencils);
        let fields = self.state.fields.len();
        let mut mass = vec![0.0; fields];
        let mut reader = self.reader();
        for p in 0..self.particles.len() {
            let m = self.particles.mass[p];
            reader.for_each_entry(p, |field, w, _| mass[field] += m * w);
        }
        self.state.mass = mass;
        for values in self.state.displacement.iter_mut().chain(&mut self.state.velocity) {
            values.resize(fields, 0.0);
        }
    }

    /// Adds the forces of the particles on the general path, with or without their misfits.
    pub(super) fn add_cut_forces(
        &self,
        u: &FieldVectors,
        with_misfits: bool,
        force_x: &mut [f64],
        force_y: &mut [f64],
    ) {
        let cut = &self.state.cut;
        for (row, (p, entries)) in cut.stencils.iter().enumerate() {
            let mut h = if with_misfits { cut.misfit_of_row(row) } else { Matrix::zeros() };
            for e in entries {
                let (x, y) = (u[0][e.field as usize], u[1][e.field as usize]);
                h.m11 += x * e.gradient.x;
                h.m12 += x * e.gradient.y;
                h.m21 += y * e.gradient.x;
                h.m22 += y * e.gradient.y;
            }
            let elastic = &self.elastic[self.particles.material[p] as usize];
            let stress = crate::first_piola_stress(&h, elastic.mu, elastic.lambda) * self.particles.volume[p];
            for e in entries {
                force_x[e.field as usize] -= stress.m11 * e.gradient.x + stress.m12 * e.gradient.y;
                force_y[e.field as usize] -= stress.m21 * e.gradient.x + stress.m22 * e.gradient.y;
            }
        }
    }

    /// A probe at `rest` that belongs to the material at `nudged`.
    pub(super) fn probe(&self, rest: Point, nudged: Point) -> Probe {
        Probe { rest, nudged, entries: self.probe_entries(rest, nudged) }
    }

    /// (field, weight) of a probe. Where a node has no material on the probe's side, the nearest particle carries the probe along
    /// linearly instead: w_ip + ∇w_ip · (X − X_p), exact for rigid motion.
    pub(super) fn probe_entries(&self, rest: Point, nudged: Point) -> Vec<(u32, f64)> {
        let stencil = self.stencil(rest);
        let nodes = self.grid.stencil(&stencil);
        let mass = |field: usize| self.state.mass[field];
        let has_material = |&node: &usize| {
            mass(node) > 0.0 || self.state.fields.of(node).iter().any(|&field| mass(field as usize) > 0.0)
        };
        let mut entries = Vec::with_capacity(8);
        for b in 0..stencil.width {
            for a in 0..stencil.width {
                let w = stencil.weight(a, b);
                if w <= 1e-14 {
                    continue;
                }
                let found = match nodes.at(a, b).filter(has_material) {
                    // On the last grid line of a body, up to rounding.
                    None if w <= ROUND_OFF => {
                        nodes.near(a, b).find(has_material).map(|node| (node, self.grid.position(node)))
                    }
                    node => node.map(|node| (node, nodes.place(a, b))),
                };
                let Some((node, place)) = found else { return self.carried_entries(rest, nudged) };
                for share in self.division.pair(nudged, place) {
                    match self.state.fields.find(node, &share.crossed) {
                        Some(field) if mass(field) > 0.0 => entries.push((field as u32, w * share.fraction)),
                        _ => return self.carried_entries(rest, nudged),
                    }
                }
            }
        }
        entries
    }

    fn carried_entries(&self, rest: Point, nudged: Point) -> Vec<(u32, f64)> {
        let at = (rest - self.particles.anchor) / self.particles.spacing;
        let center = [at.x.floor() as i32, at.y.floor() as i32];
        let mut nearest: Option<(bool, f64, usize)> = None;
        for reach in [2, 6] {
            for p in
                self.particles.within(center.map(|c| c.saturating_sub(reach)), center.map(|c| c.saturating_add(reach)))
            {
                let place = self.particles.rest[p];
                let across = !self.division.crossed(place, nudged).is_empty();
                let candidate = (across, (place - rest).norm_squared(), p);
                if nearest.is_none_or(|n| candidate < n) {
                    nearest = Some(candidate);
                }
            }
            if matches!(nearest, Some((false, ..))) {
                break;
            }
        }
        let Some((_, _, p)) = nearest else { return Vec::new() };
        let offset = rest - self.particles.rest[p];
        let mut entries = Vec::with_capacity(8);
        self.reader().for_each_entry(p, |field, w, g| entries.push((field as u32, w + g.dot(&offset))));
        entries
    }

    /// Lays the probes of outlines and crack faces.
    pub(super) fn lay_probes(&mut self, cracks: &Cracks) {
        self.state.faces = cracks.iter().map(|c| self.face_probes(c)).collect();
        self.state.outlines = Outlines::at_rest(&self.scene, |place| self.probe(place, place));
        for id in cracks.ids().filter(|&id| cracks.end(id) == CrackEnd::Mouth) {
            self.open_mouth(cracks, id);
        }
    }

    /// Probes of both faces of a crack.
    pub(super) fn face_probes(&self, crack: &Crack) -> [Vec<Probe>; 2] {
        [Side::Above, Side::Below]
            .map(|side| (0..crack.points.len()).map(|k| self.face_probe(crack, k, side)).collect())
    }

    /// Probe of one face at point `k` of a crack.
    pub(super) fn face_probe(&self, crack: &Crack, k: usize, side: Side) -> Probe {
        let before = crack.points[k.saturating_sub(1)];
        let after = crack.points[(k + 1).min(crack.points.len() - 1)];
        let tangent = (after - before).normalize();
        let normal = Vector::new(-tangent.y, tangent.x) * side.sign();
        self.probe(crack.points[k], crack.points[k] + normal * (NUDGE * self.grid.cell_size))
    }

    /// Doubles the outline where a crack mouths at it: the two new vertices are the end points of the faces.
    pub(super) fn open_mouth(&mut self, cracks: &Cracks, id: TipId) {
        let at = if id.end == End::Start { 0 } else { cracks.of(id).points.len() - 1 };
        let faces = self.state.faces[id.crack].each_ref().map(|face| face[at].clone());
        self.state.outlines.open_mouth(cracks.position(id), id.end, faces, self.grid.cell_size);
    }
}
