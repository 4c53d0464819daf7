//! The grid of a step: its nodes, the order of particles by rows of it, and which particle reaches which field.

use super::points::MaterialPoint;
use super::setup::Setup;
use crate::crack::division::{Division, TipCut};
use crate::grid::entries::{Entries, Entry};
use crate::grid::fields::Fields;
use crate::grid::kernel::{self, Stencil};
use crate::grid::walker::Walker;
use crate::grid::{BAND, Grid};
use fissure_scene::{Kernel, Point, Vector};
use std::ops::Range;

/// Cells by which node (0, 0) lies below and to the left of all particles: more than any kernel reaches.
const MARGIN: i64 = 4;

/// Cells by which nodes reach beyond the particles' stencils, so that they serve while particles move on by as much.
const ROOM: i32 = 1;

/// Least weight of the bilinear kernel along an axis.
const LEAST_WEIGHT: f64 = 1e-12;

/// The grid of a step.
#[derive(Debug)]
pub(super) struct Lattice {
    pub(super) kernel: Kernel,
    /// Half the domain of a particle in cells, for GIMP; at most half a cell.
    half_size: f64,
    /// The nodes that particles reach; none before the first step.
    pub(super) grid: Grid,
    pub(super) order: RowOrder,
    /// The cracks where they are now.
    pub(super) division: Division,
    /// The own field of each node and, near cracks, further ones.
    pub(super) fields: Fields,
    /// Stencils of the particles that cracks divide; those of others follow from their places.
    pub(super) stencils: Entries,
}

/// Particles sorted by the lowest row of nodes that they reach; particles of one row stay in the order of their
/// numbers.
#[derive(Debug, Default)]
pub(super) struct RowOrder {
    /// Index of the lowest row of each particle among the rows of the grid.
    row: Vec<u32>,
    /// First place in `particles` of each row; one more at the end.
    pub(super) first: Vec<u32>,
    /// Particles, row by row.
    pub(super) particles: Vec<u32>,
}

impl RowOrder {
    /// Sorts by `row`, which is below `rows`.
    fn sort(&mut self, rows: usize) {
        self.first.clear();
        self.first.resize(rows + 1, 0);
        for &row in &self.row {
            self.first[row as usize + 1] += 1;
        }
        for row in 0..rows {
            self.first[row + 1] += self.first[row];
        }
        let mut next = self.first.clone();
        self.particles.resize(self.row.len(), 0);
        for (p, &row) in self.row.iter().enumerate() {
            let place = &mut next[row as usize];
            self.particles[*place as usize] = p as u32;
            *place += 1;
        }
    }
}

/// Finds the lowest nodes of stencils on the lattice of a grid.
#[derive(Debug, Clone, Copy)]
struct Lowest {
    kernel: Kernel,
    half_size: f64,
    origin: Point,
    inverse_cell_size: f64,
}

impl Lowest {
    fn on(lattice: &Lattice) -> Self {
        Self {
            kernel: lattice.kernel,
            half_size: lattice.half_size,
            origin: lattice.grid.origin,
            inverse_cell_size: 1.0 / lattice.grid.cell_size,
        }
    }

    #[inline(always)]
    fn of(&self, place: Point) -> [i32; 2] {
        let x = (place - self.origin) * self.inverse_cell_size;
        [x.x, x.y].map(|x| kernel::axis_stencil(self.kernel, self.half_size, x).first)
    }
}

impl Lattice {
    /// No nodes yet.
    pub(super) fn new(setup: &Setup) -> Self {
        let (h, s) = (setup.scene.cell_size, setup.scene.particle_spacing);
        Self {
            kernel: setup.scene.solver.kernel,
            half_size: (0.5 * setup.particles.spacing / h).min(0.5),
            grid: Grid::default(),
            order: RowOrder::default(),
            division: Division::new(
                Vec::new(),
                setup.scene.solver.tip_division,
                TipCut::smooth(setup.scene.solver.kernel),
                h,
                s,
                0.0,
            ),
            fields: Fields::default(),
            stencils: Entries::default(),
        }
    }

    /// Lays the nodes around the particles and sorts these by rows; no node is divided any more. Whether a grid can be
    /// so large as to hold all particles.
    pub(super) fn lay(&mut self, setup: &Setup, points: &[MaterialPoint]) -> bool {
        let (mut low, mut high) = fissure_plane::bounds(&[]);
        for p in points {
            (low, high) = (low.inf(&p.position), high.sup(&p.position));
        }
        let Some(grid) = Grid::around(setup.particles.anchor, low, high, setup.scene.cell_size, MARGIN) else {
            return false;
        };
        let mut before = std::mem::replace(&mut self.grid, grid);
        let is_same_lattice = self.grid.take_nodes(&mut before);
        if !(is_same_lattice && self.sort_rows(points)) {
            let lowest = Lowest::on(self);
            self.grid.lay(points.iter().map(|p| lowest.of(p.position)), kernel::width(self.kernel), ROOM);
            if !self.sort_rows(points) {
                return false;
            }
        }
        self.fields.clear(self.grid.len());
        true
    }

    /// Sorts the particles by rows. Whether the grid has all nodes that they reach; if not, nothing is sorted.
    fn sort_rows(&mut self, points: &[MaterialPoint]) -> bool {
        let lowest = Lowest::on(self);
        let width = kernel::width(self.kernel);
        let (grid, order) = (&self.grid, &mut self.order);
        let mut changed = order.row.len() != points.len() || order.first.len() != grid.rows() + 1;
        order.row.resize(points.len(), 0);
        let mut walker = Walker::new(grid);
        for (row, p) in order.row.iter_mut().zip(points) {
            let Some(now) = walker.lowest_row(lowest.of(p.position), width) else {
                // What follows sorts anew.
                order.first.clear();
                return false;
            };
            changed |= *row != now as u32;
            *row = now as u32;
        }
        // Stiff bodies keep their rows for many steps.
        if changed {
            order.sort(grid.rows());
        }
        true
    }

    /// The stencil of a particle at `place` that no crack divides.
    #[inline(always)]
    pub(super) fn stencil(&self, place: Point) -> Stencil {
        let grid = &self.grid;
        let inverse = 1.0 / grid.cell_size;
        let x = (place - grid.origin) * inverse;
        let mut stencil = Stencil::new(self.kernel, self.half_size, [x.x, x.y], inverse);
        if stencil.width == 2 {
            // Exactly on a grid line a particle has a gradient, but no weight, at the nodes beyond; were it alone
            // there, they would have neither mass nor velocity.
            for weight in &mut stencil.weight {
                weight[1] = weight[1].max(LEAST_WEIGHT);
                weight[0] = 1.0 - weight[1];
            }
        }
        stencil
    }

    /// Calls `visit` with (field, weight) for every entry of the stencil of a particle at `place`.
    pub(super) fn for_each_entry(&self, particle: usize, place: Point, mut visit: impl FnMut(usize, f64)) {
        if let Some(entries) = self.stencils.of(particle) {
            for e in entries {
                visit(e.field as usize, e.weight);
            }
            return;
        }
        let stencil = self.stencil(place);
        let nodes = self.grid.stencil(&stencil);
        for b in 0..stencil.width {
            for a in 0..stencil.width {
                // Those of a particle all exist.
                if let Some(node) = nodes.at(a, b) {
                    visit(node, stencil.weight(a, b));
                }
            }
        }
    }

    /// From a particle at `place` to the node of an entry [m].
    pub(super) fn arm(&self, entry: &Entry, place: Point) -> Vector {
        self.grid.position(self.fields.node(entry.field as usize)) - place
    }

    /// Where the node of each field is on the lattice.
    pub(super) fn places_of_fields(&self) -> impl Iterator<Item = [i32; 2]> {
        let own = self.grid.nodes().map(|(_, place)| place);
        own.chain(self.fields.nodes_of_further().map(|node| self.grid.place_of(node)))
    }

    /// Nodes that have further fields, in the order in which these were made.
    pub(super) fn divided_nodes(&self) -> impl Iterator<Item = usize> {
        let mut visited = vec![false; if self.fields.further_count() > 0 { self.grid.len() } else { 0 }];
        self.fields.nodes_of_further().filter(move |&node| !std::mem::replace(&mut visited[node], true))
    }

    /// The fields of a node: its own, then the others, the one that was made last first.
    pub(super) fn fields_of(&self, node: usize) -> impl Iterator<Item = usize> {
        std::iter::once(node).chain(self.fields.of(node).iter().rev().map(|&field| field as usize))
    }

    /// Every other band, with the nodes that its particles reach: none shares a node with another.
    pub(super) fn bands(&self, parity: usize) -> impl Iterator<Item = (usize, Range<usize>)> + Clone {
        let bands = (0..self.grid.bands()).filter(move |&band| self.grid.band(band).rem_euclid(2) as usize == parity);
        bands.map(|band| (band, self.grid.nodes_reached_from(band)))
    }

    /// The particles whose lowest nodes are in a band, row by row.
    pub(super) fn particles_of_band(&self, band: usize) -> &[u32] {
        let rows = &self.order.first;
        &self.order.particles[rows[band * BAND] as usize..rows[(band + 1) * BAND] as usize]
    }
}
