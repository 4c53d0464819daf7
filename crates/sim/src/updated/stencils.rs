//! The grid of a step: nodes, the order of particles by rows of it, and the divided stencils near cracks.

use super::Updated;
use crate::SimulationError;
use crate::crack::Crack;
use crate::division::CrossedSet;
use crate::grid::Grid;
use crate::kernel::{self, Stencil};
use fissure_scene::{Point, Vector};
use rayon::prelude::*;

/// No particle, no field, no row.
pub(super) const NONE: u32 = u32::MAX;

/// Nodes beyond the box around the particles: the cubic kernel reaches two, the rest is for outlines and crack points.
const MARGIN: i64 = 4;

/// Least weight of the bilinear kernel along an axis.
const LEAST_WEIGHT: f64 = 1e-12;

/// From so many particles on, loops go to several threads; below, handing out the work costs more than it saves.
pub(super) const PARALLEL_PARTICLES: usize = 8_000;

/// Values at fields: the own field of node i has number i, the further fields of all nodes follow.
#[derive(Debug, Default)]
pub(super) struct Nodes {
    /// The lattice; none before the first step.
    pub(super) grid: Option<Grid>,
    /// m_i [kg/m].
    pub(super) mass: Vec<f64>,
    /// Momentum while it is gathered, then velocity at the beginning of the step [m/s]; x and y apart.
    pub(super) before: [Vec<f64>; 2],
    /// Force while it is gathered, then velocity at the end of the step [m/s].
    pub(super) after: [Vec<f64>; 2],
    /// The beginning's velocity, sent to the particles and back, for XPIC [m/s]; empty otherwise.
    pub(super) smoothed: [Vec<f64>; 2],
    /// The particles' new velocities, sent to the grid once more, for the strains of the bilinear kernel [m/s]; empty otherwise.
    pub(super) remapped: [Vec<f64>; 2],
}

impl Nodes {
    fn clear(&mut self, fields: usize) {
        let [bx, by] = &mut self.before;
        let [ax, ay] = &mut self.after;
        for values in [&mut self.mass, bx, by, ax, ay] {
            values.clear();
            values.resize(fields, 0.0);
        }
        for values in self.remapped.iter_mut().chain(&mut self.smoothed) {
            values.clear();
        }
    }

    pub(super) fn velocity(&self, field: usize) -> Vector {
        Vector::new(self.after[0][field], self.after[1][field])
    }

    pub(super) fn velocity_before(&self, field: usize) -> Vector {
        Vector::new(self.before[0][field], self.before[1][field])
    }
}

/// Particles sorted by the lowest row of nodes that they reach; particles of one row stay in the order of their numbers.
#[derive(Debug, Default)]
pub(super) struct RowOrder {
    /// Lowest row of each particle.
    row: Vec<u32>,
    /// First place in `particles` of each row; one more at the end.
    pub(super) first: Vec<u32>,
    /// Particles, row by row.
    pub(super) particles: Vec<u32>,
}

/// One (particle, field) pair of a divided stencil.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Entry {
    pub(super) field: u32,
    /// Weight times share [–].
    pub(super) weight: f64,
    /// Gradient of it [1/m].
    pub(super) gradient: Vector,
    /// x_i − x_p [m].
    pub(super) arm: Vector,
}

/// A field besides a node's own.
#[derive(Debug)]
pub(super) struct FurtherField {
    pub(super) node: u32,
    /// What particles cross on their way to the node.
    pub(super) crossed: CrossedSet,
    /// Sums of the normals of the crossed segments, from below to above, for each part of `crossed`: (current, rest).
    pub(super) normals: Vec<(Vector, Vector)>,
    /// Next further field of the node, as a place in the list, or `NONE`.
    next: u32,
}

/// Particles that cracks divide, and the fields they need. All empty in a scene without a crack.
#[derive(Debug, Default)]
pub(super) struct Cut {
    /// Row in `first` of each particle, or `NONE`.
    row: Vec<u32>,
    pub(super) particles: Vec<u32>,
    first: Vec<u32>,
    entries: Vec<Entry>,
    /// First further field of each node, as a place in `further`, or `NONE`.
    head: Vec<u32>,
    pub(super) further: Vec<FurtherField>,
    /// Number of nodes, which is the number of the first further field.
    nodes: usize,
}

impl Cut {
    /// Entries of a particle, if cracks divide its stencil.
    #[inline]
    pub(super) fn entries_of(&self, particle: usize) -> Option<&[Entry]> {
        let row = *self.row.get(particle)?;
        (row != NONE).then(|| &self.entries[self.first[row as usize] as usize..self.first[row as usize + 1] as usize])
    }

    /// Node of a field.
    pub(super) fn node(&self, field: usize) -> usize {
        if field < self.nodes { field } else { self.further[field - self.nodes].node as usize }
    }

    /// Further fields of a node: (number of the field, the field).
    pub(super) fn further_of(&self, node: usize) -> impl Iterator<Item = (usize, &FurtherField)> {
        let mut at = self.head.get(node).copied().unwrap_or(NONE);
        std::iter::from_fn(move || {
            let field = self.further.get(at as usize)?;
            let number = self.nodes + at as usize;
            at = field.next;
            Some((number, field))
        })
    }

    /// The field of a node across `crossed`, if it exists.
    pub(super) fn find(&self, node: usize, crossed: &CrossedSet) -> Option<usize> {
        if crossed.is_empty() {
            return Some(node);
        }
        self.further_of(node).find(|(_, f)| f.crossed == *crossed).map(|(number, _)| number)
    }

    fn find_or_add(&mut self, node: usize, crossed: &CrossedSet) -> usize {
        if let Some(field) = self.find(node, crossed) {
            return field;
        }
        let at = self.further.len();
        let normals = vec![(Vector::zeros(), Vector::zeros()); crossed.len()];
        let next = std::mem::replace(&mut self.head[node], at as u32);
        self.further.push(FurtherField { node: node as u32, crossed: crossed.clone(), normals, next });
        self.nodes + at
    }

    /// Number of fields of all nodes together.
    fn fields(&self, nodes: usize) -> usize {
        nodes + self.further.len()
    }
}

/// One pair of a divided stencil before its field has a number.
struct Raw {
    node: u32,
    crossed: CrossedSet,
    weight: f64,
    gradient: Vector,
    /// As in [`FurtherField::normals`].
    normals: Vec<(Vector, Vector)>,
}

impl Updated {
    /// Lays the grid of a step around the particles and sorts out who reaches what.
    ///
    /// # Errors
    /// When material has gone so far away that the grid would become too large.
    pub(super) fn lay_grid(&mut self, cracks: &[Crack], time: f64) -> Result<(), SimulationError> {
        let (mut low, mut high) = fissure_scene::bounds(&[]);
        for p in &self.state.points {
            (low, high) = (low.inf(&p.position), high.sup(&p.position));
        }
        let h = self.scene.cell_size;
        let cells = (high - low) / h;
        if (cells.x + 8.0) * (cells.y + 8.0) > self.most_nodes as f64 {
            return Err(self.left(time));
        }
        let grid = Grid::around(self.particles.anchor, low, high, h, MARGIN);
        self.nodes.grid = Some(grid);
        self.sort_rows(grid);
        self.cut.nodes = grid.len();
        if self.has_cracks() {
            self.division = self.division_now(cracks);
            self.divide_stencils(grid);
        }
        self.nodes.clear(self.cut.fields(grid.len()));
        Ok(())
    }

    /// The particle farthest from the middle of all has left.
    fn left(&self, time: f64) -> SimulationError {
        let points = &self.state.points;
        let middle = points.iter().fold(Vector::zeros(), |a, p| a + p.position.coords) / points.len() as f64;
        let (particle, point) = points
            .iter()
            .enumerate()
            .max_by(|a, b| {
                let away = |p: &super::MaterialPoint| (p.position.coords - middle).norm_squared();
                away(a.1).total_cmp(&away(b.1))
            })
            .map_or((0, Point::origin()), |(i, p)| (i, p.position));
        SimulationError::Unstable {
            time,
            x: point.x,
            y: point.y,
            cause: format!(
                "particle {particle} has flown so far from the rest that no grid holds both; end the run before \
                 (`frames.last`), hold the material with a collider, or use a smaller `solver.courant` if it was thrown off"
            ),
        }
    }

    pub(super) fn grid(&self) -> Grid {
        // A step lays the grid before anything asks for it; before the first step the one at rest does.
        self.nodes.grid.unwrap_or_else(|| {
            let (low, high) = fissure_scene::bounds(&self.particles.rest);
            Grid::around(self.particles.anchor, low, high, self.scene.cell_size, MARGIN)
        })
    }

    /// Half the domain of a particle in cells, for GIMP; at most half a cell.
    pub(super) fn half_size(&self) -> f64 {
        (0.5 * self.particles.spacing / self.scene.cell_size).min(0.5)
    }

    #[inline(always)]
    pub(super) fn stencil(&self, grid: &Grid, place: Point) -> Stencil {
        let inverse = 1.0 / grid.cell_size;
        let x = (place - grid.origin) * inverse;
        let mut stencil = Stencil::new(self.settings.kernel, self.half_size(), [x.x, x.y], inverse);
        if stencil.width == 2 {
            // Exactly on a grid line a particle has a gradient, but no weight, at the nodes beyond; were it alone there, they would
            // have neither mass nor velocity.
            for weight in &mut stencil.weight {
                weight[1] = weight[1].max(LEAST_WEIGHT);
                weight[0] = 1.0 - weight[1];
            }
        }
        stencil
    }

    fn sort_rows(&mut self, grid: Grid) {
        let (kernel, half_size) = (self.settings.kernel, self.half_size());
        let inverse = 1.0 / grid.cell_size;
        let order = &mut self.order;
        let points = &self.state.points;
        let same_shape = order.row.len() == points.len() && order.first.len() == grid.rows + 1;
        order.row.resize(points.len(), 0);
        let mut changed = !same_shape;
        for (row, p) in order.row.iter_mut().zip(points) {
            let now = kernel::axis_stencil(kernel, half_size, (p.position.y - grid.origin.y) * inverse).first as u32;
            changed |= *row != now;
            *row = now;
        }
        // Stiff bodies keep their rows for many steps.
        if !changed {
            return;
        }
        order.first.clear();
        order.first.resize(grid.rows + 1, 0);
        for &row in &order.row {
            order.first[row as usize + 1] += 1;
        }
        for row in 0..grid.rows {
            order.first[row + 1] += order.first[row];
        }
        let mut next = order.first.clone();
        order.particles.resize(points.len(), 0);
        for (p, &row) in order.row.iter().enumerate() {
            let place = &mut next[row as usize];
            order.particles[*place as usize] = p as u32;
            *place += 1;
        }
    }

    /// Finds the particles whose stencils cracks divide, and divides them.
    fn divide_stencils(&mut self, grid: Grid) {
        let mut cut = std::mem::take(&mut self.cut);
        cut.further.clear();
        cut.head.clear();
        cut.head.resize(grid.len(), NONE);
        cut.particles.clear();
        cut.row.clear();
        cut.row.resize(self.particles.len(), NONE);
        let near = NearCells::new(self);
        for (p, point) in self.state.points.iter().enumerate() {
            if !near.holds(point.position) {
                continue;
            }
            let stencil = self.stencil(&grid, point.position);
            let corner = |i: i32, j: i32| grid.origin + Vector::new(f64::from(i), f64::from(j)) * grid.cell_size;
            let low = corner(stencil.first[0], stencil.first[1]);
            let last = stencil.width as i32 - 1;
            let high = corner(stencil.first[0] + last, stencil.first[1] + last);
            if self.division.may_divide(point.position, low, high) {
                cut.row[p] = cut.particles.len() as u32;
                cut.particles.push(p as u32);
            }
        }
        let raw = |p: &u32| self.divided(&grid, *p as usize);
        let raws: Vec<Vec<Raw>> = if cut.particles.len() < PARALLEL_PARTICLES / 32 {
            cut.particles.iter().map(raw).collect()
        } else {
            cut.particles.par_iter().map(raw).collect()
        };
        cut.first.clear();
        cut.entries.clear();
        for (&p, raws) in cut.particles.clone().iter().zip(&raws) {
            cut.first.push(cut.entries.len() as u32);
            let place = self.state.points[p as usize].position;
            for raw in raws {
                let field = cut.find_or_add(raw.node as usize, &raw.crossed);
                if !raw.normals.is_empty() {
                    let sums = &mut cut.further[field - cut.nodes].normals;
                    for (sum, normal) in sums.iter_mut().zip(&raw.normals) {
                        sum.0 += normal.0;
                        sum.1 += normal.1;
                    }
                }
                cut.entries.push(Entry {
                    field: field as u32,
                    weight: raw.weight,
                    gradient: raw.gradient,
                    arm: grid.position(raw.node as usize) - place,
                });
            }
        }
        cut.first.push(cut.entries.len() as u32);
        self.cut = cut;
    }

    fn divided(&self, grid: &Grid, particle: usize) -> Vec<Raw> {
        let place = self.state.points[particle].position;
        let stencil = self.stencil(grid, place);
        let mut raws = Vec::with_capacity(stencil.width * stencil.width + 4);
        for b in 0..stencil.width {
            for a in 0..stencil.width {
                let (w, g) = (stencil.weight(a, b), stencil.weight_gradient(a, b));
                let node = stencil_node(grid, &stencil, a, b);
                let node_place = grid.position(node);
                for share in self.division.pair(place, node_place) {
                    let normals = if self.settings.crack_contact && !share.crossed.is_empty() {
                        self.crossed_normals(place, node_place, &share.crossed)
                    } else {
                        Vec::new()
                    };
                    raws.push(Raw {
                        node: node as u32,
                        weight: w * share.fraction,
                        gradient: g * share.fraction + share.gradient * w,
                        crossed: share.crossed,
                        normals,
                    });
                }
            }
        }
        raws
    }

    /// Sums of the normals of the segments that a pair crosses, now and at rest, for each crack of the set.
    fn crossed_normals(&self, place: Point, node: Point, crossed: &CrossedSet) -> Vec<(Vector, Vector)> {
        let mut sums = vec![(Vector::zeros(), Vector::zeros()); crossed.len()];
        self.division.for_each_crossed(place, node, |crack, segment| {
            let Some(at) = crossed.iter().position(|c| c.0 == crack) else { return };
            let now = &self.state.cracks[crack as usize];
            let normal = |points: &[Point]| {
                let along = points[segment + 1] - points[segment];
                let length = along.norm();
                if length > 0.0 { Vector::new(-along.y, along.x) / length } else { Vector::zeros() }
            };
            sums[at].0 += normal(&now.position);
            sums[at].1 += normal(&now.rest);
        });
        sums
    }
}

/// Number of node (a, b) of a stencil. Particles never reach beyond the grid; crack points and outlines may, and then see its edge.
pub(super) fn stencil_node(grid: &Grid, stencil: &Stencil, a: usize, b: usize) -> usize {
    let column = (stencil.first[0] + a as i32).clamp(0, grid.columns as i32 - 1) as usize;
    let row = (stencil.first[1] + b as i32).clamp(0, grid.rows as i32 - 1) as usize;
    row * grid.columns + column
}

/// The cells near cracks as a dense map, for a question that every particle asks.
struct NearCells {
    first: [i64; 2],
    columns: i64,
    rows: i64,
    near: Vec<bool>,
    inverse_cell_size: f64,
}

impl NearCells {
    fn new(solver: &Updated) -> Self {
        let (mut low, mut high) = ([i64::MAX; 2], [i64::MIN; 2]);
        for (i, j) in solver.division.near_cells() {
            low = [low[0].min(i), low[1].min(j)];
            high = [high[0].max(i), high[1].max(j)];
        }
        let (columns, rows) = ((high[0] - low[0] + 1).max(0), (high[1] - low[1] + 1).max(0));
        let mut near = vec![false; (columns * rows) as usize];
        for (i, j) in solver.division.near_cells() {
            near[((j - low[1]) * columns + i - low[0]) as usize] = true;
        }
        Self { first: low, columns, rows, near, inverse_cell_size: 1.0 / solver.scene.cell_size }
    }

    fn holds(&self, point: Point) -> bool {
        let i = (point.x * self.inverse_cell_size).floor() as i64 - self.first[0];
        let j = (point.y * self.inverse_cell_size).floor() as i64 - self.first[1];
        i >= 0 && j >= 0 && i < self.columns && j < self.rows && self.near[(j * self.columns + i) as usize]
    }
}
