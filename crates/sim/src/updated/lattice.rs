//! The grid of a step: its nodes, the order of particles by cells of it, and which particle reaches which field.

use super::points::MaterialPoint;
use super::setup::Setup;
use super::survey::{PART, Survey, SurveyOfPart};
use crate::crack::division::{Division, TipCut};
use crate::grid::Grid;
use crate::grid::entries::{Entries, Entry};
use crate::grid::fields::Fields;
use crate::grid::kernel::{self, AxisStencil, Stencil};
use crate::threads::prelude::*;
use crate::wide::run_widest;
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
    pub(super) order: Order,
    /// The cracks where they are now.
    pub(super) division: Division,
    /// The own field of each node and, near cracks, further ones.
    pub(super) fields: Fields,
    /// Stencils of the particles that cracks divide; those of others follow from their places.
    pub(super) stencils: Entries,
    /// Where the particles are now, when that was found as they moved there.
    pub(super) ahead: Option<Survey>,
}

/// Particles sorted by the lowest node that they reach, row by row and along each row; those of one node stay in the
/// order of their numbers.
#[derive(Debug, Default)]
pub(super) struct Order {
    /// Where the lowest node of each particle is, and its number.
    pub(super) place: Vec<[i32; 2]>,
    pub(super) node: Vec<u32>,
    /// Whether these are of the nodes that the grid has now.
    is_of_grid: bool,
    /// Whether any of them has changed since they were sorted.
    is_stale: bool,
    /// First place in `particles` of each node; two more at the end.
    first: Vec<u32>,
    particles: Vec<u32>,
}

impl Order {
    /// Whether the lowest nodes that are noted are of the nodes that the grid has now.
    pub(super) fn is_of_grid(&self) -> bool {
        self.is_of_grid
    }

    /// Sorts by `node`, which is below `nodes`.
    fn sort(&mut self, nodes: usize) {
        self.is_stale = false;
        self.first.clear();
        self.first.resize(nodes + 2, 0);
        // Counted two places on and summed up, each number is where the node before begins; moving on with each of its
        // particles, it ends where the next one begins.
        for &node in &self.node {
            self.first[node as usize + 2] += 1;
        }
        let mut sum = 0;
        for first in &mut self.first {
            sum += *first;
            *first = sum;
        }
        self.particles.resize(self.node.len(), 0);
        for (p, &node) in self.node.iter().enumerate() {
            let place = &mut self.first[node as usize + 1];
            self.particles[*place as usize] = p as u32;
            *place += 1;
        }
    }

    /// The particles whose lowest nodes are among `nodes`.
    pub(super) fn of_nodes(&self, nodes: Range<usize>) -> &[u32] {
        &self.particles[self.first[nodes.start] as usize..self.first[nodes.end] as usize]
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
            order: Order::default(),
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
            ahead: None,
        }
    }

    /// Lays the nodes around the particles and sorts these; no node is divided any more. Whether a grid can be so large
    /// as to hold all particles.
    pub(super) fn lay(&mut self, setup: &Setup, points: &[MaterialPoint]) -> bool {
        // Most steps need no other nodes than the one before.
        let before = self.ahead.take().unwrap_or_else(|| self.survey(setup, points));
        let (h, anchor) = (setup.scene.cell_size, setup.particles.anchor);
        let Some(grid) = Grid::around(anchor, before.low, before.high, h, MARGIN) else {
            return false;
        };
        let mut old = std::mem::replace(&mut self.grid, grid);
        let is_same_lattice = self.grid.take_nodes(&mut old);
        if !(is_same_lattice && before.has_nodes) {
            let mut grid = std::mem::take(&mut self.grid);
            (self.grid.origin, self.grid.cell_size) = (grid.origin, grid.cell_size);
            grid.lay(points.iter().map(|p| self.stencil(p.position).first), kernel::width(self.kernel), ROOM);
            self.grid = grid;
            self.order.is_of_grid = false;
            if !self.survey(setup, points).has_nodes {
                return false;
            }
        }
        // Stiff bodies keep their cells for many steps.
        let is_sorted = self.order.particles.len() == points.len() && self.order.first.len() == self.grid.len() + 2;
        if self.order.is_stale || !is_sorted {
            self.order.sort(self.grid.len());
        }
        self.fields.clear(self.grid.len());
        true
    }

    /// Finds the lowest node of each particle.
    fn survey(&mut self, setup: &Setup, points: &[MaterialPoint]) -> Survey {
        let (mut places, mut nodes) = self.take_lowest(points.len());
        let parts = points.chunks(PART).zip(places.chunks_mut(PART)).zip(nodes.chunks_mut(PART));
        let lattice = &*self;
        let parts: Vec<SurveyOfPart<'_>> =
            parts.map(|((points, places), nodes)| SurveyOfPart { lattice, points, places, nodes }).collect();
        let parts: Vec<Survey> = if setup.is_parallel() {
            parts.into_par_iter().map(run_widest).collect()
        } else {
            parts.into_iter().map(run_widest).collect()
        };
        let survey = parts.into_iter().fold(Survey::NONE, Survey::with);
        self.put_lowest(places, nodes, survey);
        survey
    }

    /// Takes out places and numbers of the lowest nodes of so many `particles`, to be looked at anew.
    pub(super) fn take_lowest(&mut self, particles: usize) -> (Vec<[i32; 2]>, Vec<u32>) {
        let order = &mut self.order;
        let (mut places, mut nodes) = (std::mem::take(&mut order.place), std::mem::take(&mut order.node));
        order.is_of_grid &= places.len() == particles;
        places.resize(particles, [0; 2]);
        nodes.resize(particles, 0);
        (places, nodes)
    }

    /// Puts them back as a `survey` has found them.
    pub(super) fn put_lowest(&mut self, places: Vec<[i32; 2]>, nodes: Vec<u32>, survey: Survey) {
        (self.order.place, self.order.node, self.order.is_of_grid) = (places, nodes, survey.has_nodes);
        self.order.is_stale |= survey.has_changed;
    }

    /// The stencil of a particle at `place` that no crack divides.
    #[inline(always)]
    pub(super) fn stencil(&self, place: Point) -> Stencil {
        let (x, y) = (self.axis_stencil(self.kernel, 0, place.x), self.axis_stencil(self.kernel, 1, place.y));
        Stencil {
            first: [x.first, y.first],
            width: kernel::width(self.kernel),
            weight: [x.weight, y.weight],
            gradient: [x.gradient, y.gradient],
        }
    }

    /// The same along one axis; `kernel` is that of the lattice, its derivatives are per metre.
    #[inline(always)]
    pub(super) fn axis_stencil(&self, kernel: Kernel, axis: usize, place: f64) -> AxisStencil {
        let grid = &self.grid;
        let inverse = 1.0 / grid.cell_size;
        let mut stencil = kernel::axis_stencil(kernel, self.half_size, (place - grid.origin[axis]) * inverse);
        for gradient in &mut stencil.gradient {
            *gradient *= inverse;
        }
        if kernel == Kernel::Bilinear {
            // Exactly on a grid line a particle has a gradient, but no weight, at the nodes beyond; were it alone
            // there, they would have neither mass nor velocity.
            stencil.weight[1] = stencil.weight[1].max(LEAST_WEIGHT);
            stencil.weight[0] = 1.0 - stencil.weight[1];
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

    /// Calls `visit` with (field, weight, its gradient [1/m]) for every entry of the stencil of a particle at `place`.
    pub(super) fn for_each_slope(&self, particle: usize, place: Point, mut visit: impl FnMut(usize, f64, Vector)) {
        if let Some(entries) = self.stencils.of(particle) {
            entries.iter().for_each(|e| visit(e.field as usize, e.weight, e.gradient));
            return;
        }
        let stencil = self.stencil(place);
        let nodes = self.grid.stencil(&stencil);
        for (b, a) in (0..stencil.width).flat_map(|b| (0..stencil.width).map(move |a| (b, a))) {
            // Those of a particle all exist.
            if let Some(node) = nodes.at(a, b) {
                visit(node, stencil.weight(a, b), stencil.weight_gradient(a, b));
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

    /// The particles whose lowest nodes are in a band.
    pub(super) fn particles_of_band(&self, band: usize) -> &[u32] {
        self.order.of_nodes(self.grid.nodes_of_band(band))
    }
}
