//! The grid of a step: nodes, the order of particles by rows of it, and the divided stencils near cracks.

use super::Updated;
use crate::SimulationError;
use crate::crack::cracks::Cracks;
use crate::crack::division::CrossedSet;
use crate::grid::entries::{Entries, Entry};
use crate::grid::fields::Fields;
use crate::grid::kernel::{self, Stencil};
use crate::grid::spans::{Span, SpanRows};
use crate::grid::{Grid, Walker};
use crate::threads::prelude::*;
use fissure_scene::{Kernel, Point, Vector};

/// Cells by which node (0, 0) lies below and to the left of all particles: more than any kernel reaches.
const MARGIN: i64 = 4;

/// Cells by which nodes reach beyond the particles' stencils, so that they serve while particles move on by as much.
const ROOM: i32 = 1;

/// Least weight of the bilinear kernel along an axis.
const LEAST_WEIGHT: f64 = 1e-12;

/// From so many particles on, loops go to several threads; below, handing out the work costs more than it saves.
pub(super) const PARALLEL_PARTICLES: usize = 8_000;

/// Values at fields: the own field of node i has number i, the further fields of all nodes follow.
#[derive(Debug, Default)]
pub(super) struct Nodes {
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
    fn new(solver: &Updated, grid: &Grid) -> Self {
        Self {
            kernel: solver.settings.kernel,
            half_size: solver.half_size(),
            origin: grid.origin,
            inverse_cell_size: 1.0 / grid.cell_size,
        }
    }

    #[inline(always)]
    fn of(&self, place: Point) -> [i32; 2] {
        let x = (place - self.origin) * self.inverse_cell_size;
        [x.x, x.y].map(|x| kernel::axis_stencil(self.kernel, self.half_size, x).first)
    }
}

/// Particles that cracks divide, and the fields they need. No further field and no stencil in a scene without a crack.
#[derive(Debug, Default)]
pub(super) struct Cut {
    pub(super) fields: Fields,
    /// Stencils of the particles that cracks divide.
    pub(super) stencils: Entries,
}

/// One pair of a divided stencil before its field has a number.
pub(super) struct Raw {
    node: u32,
    crossed: CrossedSet,
    weight: f64,
    gradient: Vector,
}

impl Updated {
    /// Lays the grid of a step around the particles and sorts out who reaches what.
    ///
    /// # Errors
    /// When material has gone so far away that the grid would become too large.
    pub(super) fn lay_grid(&mut self, cracks: &Cracks, time: f64) -> Result<(), SimulationError> {
        let (mut low, mut high) = fissure_plane::bounds(&[]);
        for p in &self.state.points {
            (low, high) = (low.inf(&p.position), high.sup(&p.position));
        }
        let h = self.scene.cell_size;
        let Some(grid) = Grid::around(self.particles.anchor, low, high, h, MARGIN) else {
            return Err(self.left(time));
        };
        let mut before = std::mem::replace(&mut self.grid, grid);
        let is_same_lattice = self.grid.take_nodes(&mut before);
        if !(is_same_lattice && self.sort_rows()) {
            self.lay_nodes();
            if !self.sort_rows() {
                return Err(self.left(time));
            }
        }
        self.cut.fields.clear(self.grid.len());
        if self.has_cracks() {
            if self.crack_cells() > self.most_crack_cells() {
                return Err(self.torn(time));
            }
            self.division = self.division_now(cracks);
            self.divide_stencils();
        }
        self.nodes.clear(self.cut.fields.len());
        Ok(())
    }

    /// Makes the nodes around the particles.
    fn lay_nodes(&mut self) {
        let mut grid = std::mem::take(&mut self.grid);
        let lattice = Lowest::new(self, &grid);
        let lowest = self.state.points.iter().map(|p| lattice.of(p.position));
        grid.lay(lowest, kernel::width(self.settings.kernel), ROOM);
        self.grid = grid;
    }

    /// The longest segment of all cracks has been torn apart.
    fn torn(&self, time: f64) -> SimulationError {
        let segments = self.state.cracks.iter().flat_map(|now| now.position.windows(2));
        let longest = segments.max_by(|a, b| (a[1] - a[0]).norm().total_cmp(&(b[1] - b[0]).norm()));
        let (a, b) = longest.map_or((Point::origin(), Point::origin()), |w| (w[0], w[1]));
        let cause = format!(
            "the material has torn a crack apart, from there to ({:e}, {:e}) m; end the run before (`frames.last`), or use a smaller \
             `solver.courant` if it was thrown off",
            b.x, b.y
        );
        SimulationError::Unstable { time, x: a.x, y: a.y, cause }
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

    /// Half the domain of a particle in cells, for GIMP; at most half a cell.
    pub(super) fn half_size(&self) -> f64 {
        (0.5 * self.particles.spacing / self.scene.cell_size).min(0.5)
    }

    #[inline(always)]
    pub(super) fn stencil(&self, place: Point) -> Stencil {
        let grid = &self.grid;
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

    /// Sorts the particles by rows. Whether the grid has all nodes that they reach; if not, nothing is sorted.
    fn sort_rows(&mut self) -> bool {
        let lattice = Lowest::new(self, &self.grid);
        let width = kernel::width(self.settings.kernel);
        let (grid, order, points) = (&self.grid, &mut self.order, &self.state.points);
        let mut changed = order.row.len() != points.len() || order.first.len() != grid.rows() + 1;
        order.row.resize(points.len(), 0);
        let mut walker = Walker::new(grid);
        for (row, p) in order.row.iter_mut().zip(points) {
            let Some(now) = walker.lowest_row(lattice.of(p.position), width) else {
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

    /// Finds the particles whose stencils cracks divide, and divides them.
    fn divide_stencils(&mut self) {
        let near = NearCells::new(self);
        let is_divided = |(_, point): &(usize, &super::MaterialPoint)| {
            if !near.holds(point.position) {
                return false;
            }
            let stencil = self.stencil(point.position);
            let low = self.grid.place(stencil.first);
            let high = self.grid.place(stencil.first.map(|first| first + stencil.width as i32 - 1));
            self.division.may_divide(point.position, low, high)
        };
        let particles: Vec<usize> = self.state.points.iter().enumerate().filter(is_divided).map(|(p, _)| p).collect();
        let divided = |&p: &usize| self.divided(p);
        let raws: Vec<Vec<Raw>> = if particles.len() < PARALLEL_PARTICLES / 32 {
            particles.iter().map(divided).collect()
        } else {
            particles.par_iter().map(divided).collect()
        };
        let Cut { fields, stencils } = &mut self.cut;
        stencils.clear(self.particles.len());
        for (p, raws) in particles.into_iter().zip(raws) {
            let entries = raws.into_iter().map(|raw| {
                let field = fields.find_or_add(raw.node as usize, &raw.crossed) as u32;
                Entry { field, weight: raw.weight, gradient: raw.gradient }
            });
            stencils.push(p, entries);
        }
    }

    fn divided(&self, particle: usize) -> Vec<Raw> {
        let place = self.state.points[particle].position;
        let stencil = self.stencil(place);
        let nodes = self.grid.stencil(&stencil);
        let mut raws = Vec::with_capacity(stencil.width * stencil.width + 4);
        for b in 0..stencil.width {
            for a in 0..stencil.width {
                let (w, g) = (stencil.weight(a, b), stencil.weight_gradient(a, b));
                let Some(node) = nodes.at(a, b) else { continue };
                let node_place = self.grid.place([stencil.first[0] + a as i32, stencil.first[1] + b as i32]);
                for share in self.division.pair(place, node_place) {
                    raws.push(Raw {
                        node: node as u32,
                        weight: w * share.fraction,
                        gradient: g * share.fraction + share.gradient * w,
                        crossed: share.crossed,
                    });
                }
            }
        }
        raws
    }
}

/// The cells near cracks, for a question that every particle asks.
struct NearCells {
    spans: SpanRows,
    inverse_cell_size: f64,
}

impl NearCells {
    fn new(solver: &Updated) -> Self {
        let mut cells: Vec<(i32, i32)> = solver.division.near_cells().map(|(i, j)| (j as i32, i as i32)).collect();
        cells.sort_unstable();
        let mut spans = SpanRows::default();
        for run in cells.chunk_by(|a, b| a.0 == b.0 && a.1 + 1 == b.1) {
            let (row, first) = run[0];
            spans.push(row, Span { first, end: first + run.len() as i32, number: 0 });
        }
        Self { spans, inverse_cell_size: 1.0 / solver.scene.cell_size }
    }

    fn holds(&self, point: Point) -> bool {
        let x = point.coords * self.inverse_cell_size;
        self.spans.number(x.x.floor() as i32, x.y.floor() as i32).is_some()
    }
}
