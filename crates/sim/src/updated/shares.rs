//! What particles send to the grid, worked out for many at once and summed up over those that reach the same nodes.

use super::lattice::Lattice;
use super::particles_to_grid::{Piece, arm};
use super::points::Points;
use super::setup::Setup;
use crate::grid::walker::Walker;
use fissure_scene::{Kernel, Matrix};

/// Particles of a batch.
pub(super) const BATCH: usize = 32;

/// One number of each particle of a batch: loops over them have several side by side.
type Numbers = [f64; BATCH];

/// Of each particle of a batch `L` numbers along x.
type Columns<const L: usize> = [[f64; L]; BATCH];

/// What the particles of a batch carry; x and y apart, matrices by rows.
pub(super) struct Carried {
    /// x_p [m].
    place: [Numbers; 2],
    /// v_p [m/s].
    velocity: [Numbers; 2],
    /// C_p [1/s].
    affine: [[Numbers; 2]; 2],
    /// H [–].
    gradient: [[Numbers; 2]; 2],
    /// m_p [kg/m].
    mass: Numbers,
    /// V_p0 [m²].
    volume: Numbers,
    /// μ and λ [Pa].
    moduli: [Numbers; 2],
}

impl Carried {
    pub(super) const NONE: Self = Self {
        place: [[0.0; BATCH]; 2],
        velocity: [[0.0; BATCH]; 2],
        affine: [[[0.0; BATCH]; 2]; 2],
        gradient: [[[0.0; BATCH]; 2]; 2],
        mass: [0.0; BATCH],
        volume: [0.0; BATCH],
        moduli: [[0.0; BATCH]; 2],
    };

    /// Notes at place `k` of the batch what particle `p` carries.
    #[inline(always)]
    pub(super) fn put<const AFFINE: bool>(&mut self, k: usize, setup: &Setup, points: &Points, p: usize) {
        let (point, (mu, lambda)) = (&points.point[p], points.moduli(setup, p));
        for axis in 0..2 {
            self.place[axis][k] = point.position[axis];
            self.velocity[axis][k] = point.velocity[axis];
            for along in 0..2 {
                self.gradient[axis][along][k] = point.elastic_gradient[(axis, along)];
            }
        }
        if AFFINE {
            let affine = &points.affine[p];
            for (axis, along) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                self.affine[axis][along][k] = affine[(axis, along)];
            }
        }
        let volume = setup.particles.volume[p];
        self.volume[k] = volume;
        // As it was laid, without a look at yet another list.
        self.mass[k] = volume * setup.elastic_of(p).density;
        (self.moduli[0][k], self.moduli[1][k]) = (mu, lambda);
    }
}

/// What the particles of a batch send to the rows of their stencils, of `W` nodes along an axis: columns times numbers.
pub(super) struct Shares<const W: usize, const L: usize> {
    /// Lowest node along each axis.
    lowest: [[i32; BATCH]; 2],
    /// Weights along x [–] and their derivatives [1/m].
    x: Columns<L>,
    dx: Columns<L>,
    /// Weights along x times the velocity over the columns [m/s].
    moved: [Columns<L>; 2],
    /// Mass times the weight of each row [kg/m].
    mass: [Numbers; W],
    /// The same times what is added to the velocity in each row [N s/m²].
    turned: [[Numbers; W]; 2],
    /// −V_p0 τ_p, its first column times the weight of each row [N] and its second times the derivative [N/m].
    pulled: [[Numbers; W]; 2],
    sheared: [[Numbers; W]; 2],
}

/// Adds what moves along an axis in the columns, and what is added to that in the row.
#[inline(always)]
fn add_moved<const L: usize, const AFFINE: bool>(
    sums: &mut [f64; L],
    mass: f64,
    (moved, turned): (&[f64; L], f64),
    x: &[f64; L],
) {
    for a in 0..L {
        let still = mass * moved[a];
        sums[a] += if AFFINE { still + turned * x[a] } else { still };
    }
}

/// Adds what pulls along an axis.
#[inline(always)]
fn add_pulled<const L: usize>(sums: &mut [f64; L], (pulled, sheared): (f64, f64), dx: &[f64; L], x: &[f64; L]) {
    for a in 0..L {
        sums[a] += pulled * dx[a] + sheared * x[a];
    }
}

impl<const W: usize, const L: usize> Shares<W, L> {
    pub(super) const NONE: Self = Self {
        lowest: [[0; BATCH]; 2],
        x: [[0.0; L]; BATCH],
        dx: [[0.0; L]; BATCH],
        moved: [[[0.0; L]; BATCH]; 2],
        mass: [[0.0; BATCH]; W],
        turned: [[[0.0; BATCH]; W]; 2],
        pulled: [[[0.0; BATCH]; W]; 2],
        sheared: [[[0.0; BATCH]; W]; 2],
    };

    /// Works out the shares of all places of a batch; what comes of those without a particle is of no use.
    #[inline(always)]
    pub(super) fn fill<const AFFINE: bool>(&mut self, carried: &Carried, lattice: &Lattice) {
        // Known where the loops are compiled, the kernel takes no branches in them.
        match (W, lattice.kernel) {
            (2, _) => self.fill_by::<AFFINE>(carried, lattice, Kernel::Bilinear),
            (4, _) => self.fill_by::<AFFINE>(carried, lattice, Kernel::Cubic),
            (_, Kernel::Gimp) => self.fill_by::<AFFINE>(carried, lattice, Kernel::Gimp),
            _ => self.fill_by::<AFFINE>(carried, lattice, Kernel::Quadratic),
        }
    }

    #[inline(always)]
    fn fill_by<const AFFINE: bool>(&mut self, carried: &Carried, lattice: &Lattice, kernel: Kernel) {
        self.fill_columns::<AFFINE>(carried, lattice, kernel);
        self.fill_rows::<AFFINE>(carried, lattice, kernel);
    }

    #[inline(always)]
    fn fill_columns<const AFFINE: bool>(&mut self, carried: &Carried, lattice: &Lattice, kernel: Kernel) {
        let (origin, h) = (lattice.grid.origin.x, lattice.grid.cell_size);
        for k in 0..BATCH {
            let place = carried.place[0][k];
            let stencil = lattice.axis_stencil(kernel, 0, place);
            self.lowest[0][k] = stencil.first;
            let (vx, vy) = (carried.velocity[0][k], carried.velocity[1][k]);
            let (cx, cy) = (carried.affine[0][0][k], carried.affine[1][0][k]);
            for a in 0..L {
                let x = stencil.weight[a];
                self.x[k][a] = x;
                self.dx[k][a] = stencil.gradient[a];
                let arm = arm(stencil.first, a, origin, h, place);
                self.moved[0][k][a] = x * if AFFINE { vx + cx * arm } else { vx };
                self.moved[1][k][a] = x * if AFFINE { vy + cy * arm } else { vy };
            }
        }
    }

    #[inline(always)]
    fn fill_rows<const AFFINE: bool>(&mut self, carried: &Carried, lattice: &Lattice, kernel: Kernel) {
        let (origin, h) = (lattice.grid.origin.y, lattice.grid.cell_size);
        let Carried { place, gradient: [[xx, xy], [yx, yy]], moduli: [mu, lambda], volume, .. } = carried;
        let mut tension = [[[0.0; BATCH]; 2]; 2];
        for k in 0..BATCH {
            let gradient = Matrix::new(xx[k], xy[k], yx[k], yy[k]);
            let of_particle = crate::kirchhoff_stress(&gradient, mu[k], lambda[k]) * volume[k];
            tension[0][0][k] = of_particle.m11;
            tension[0][1][k] = of_particle.m12;
            tension[1][0][k] = of_particle.m21;
            tension[1][1][k] = of_particle.m22;
        }
        let (mut y, mut dy) = ([[0.0; BATCH]; W], [[0.0; BATCH]; W]);
        for k in 0..BATCH {
            let stencil = lattice.axis_stencil(kernel, 1, place[1][k]);
            self.lowest[1][k] = stencil.first;
            for b in 0..W {
                y[b][k] = stencil.weight[b];
                dy[b][k] = stencil.gradient[b];
            }
        }
        for b in 0..W {
            for k in 0..BATCH {
                self.mass[b][k] = carried.mass[k] * y[b][k];
            }
            for axis in 0..2 {
                for k in 0..BATCH {
                    // f_i −= V_p0 τ_p ∇w_ip.
                    self.pulled[axis][b][k] = -tension[axis][0][k] * y[b][k];
                    self.sheared[axis][b][k] = -tension[axis][1][k] * dy[b][k];
                }
                if AFFINE {
                    for k in 0..BATCH {
                        let arm = arm(self.lowest[1][k], b, origin, h, place[1][k]);
                        self.turned[axis][b][k] = self.mass[b][k] * (carried.affine[axis][1][k] * arm);
                    }
                }
            }
        }
    }

    /// Sends the shares of the first `count` to the nodes of a piece: those that follow each other and reach the same
    /// nodes go there together. Nodes that do not exist, which the grid has been laid for, get nothing.
    #[inline(always)]
    pub(super) fn send<const AFFINE: bool>(&self, count: usize, walker: &mut Walker<'_>, piece: &mut Piece<'_>) {
        let lowest = |k: usize| [self.lowest[0][k], self.lowest[1][k]];
        let mut start = 0;
        while start < count {
            let place = lowest(start);
            let mut end = start + 1;
            while end < count && lowest(end) == place {
                end += 1;
            }
            if let Some(rows) = walker.rows(place, W) {
                for b in 0..W {
                    piece.add(rows[b], &self.row::<AFFINE>(b, start, end));
                }
            }
            start = end;
        }
    }

    /// What the places from `start` up to `end` send to a row: mass, momentum along x and y, force along x and y.
    #[inline(always)]
    fn row<const AFFINE: bool>(&self, b: usize, start: usize, end: usize) -> [[f64; L]; 5] {
        // Each by its name, not by a number: what is numbered in a loop may be kept in memory.
        let mut weighed = [0.0; L];
        let (mut moved_x, mut moved_y, mut pulled_x, mut pulled_y) = (weighed, weighed, weighed, weighed);
        for k in start..end {
            let (x, dx, mass) = (&self.x[k], &self.dx[k], self.mass[b][k]);
            for a in 0..L {
                weighed[a] += mass * x[a];
            }
            let of = |axis: usize| (&self.moved[axis][k], self.turned[axis][b][k]);
            add_moved::<L, AFFINE>(&mut moved_x, mass, of(0), x);
            add_moved::<L, AFFINE>(&mut moved_y, mass, of(1), x);
            let of = |axis: usize| (self.pulled[axis][b][k], self.sheared[axis][b][k]);
            add_pulled(&mut pulled_x, of(0), dx, x);
            add_pulled(&mut pulled_y, of(1), dx, x);
        }
        [weighed, moved_x, moved_y, pulled_x, pulled_y]
    }
}
