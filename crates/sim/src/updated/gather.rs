//! What a particle gathers from the grid at its place.

use super::lattice::Lattice;
use super::nodes::Nodes;
use super::particles_to_grid::{arms, first};
use super::points::{MaterialPoint, Motion};
use super::setup::Setup;
use crate::grid::entries::Entry;
use crate::grid::kernel;
use crate::grid::walker::Walker;
use crate::threads::prelude::*;
use fissure_scene::{Kernel, Matrix, Transfer, Vector};

/// What a particle gathers from the grid.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Gathered {
    /// Σ v_i w_ip at the end of the step [m/s].
    pub(super) velocity: Vector,
    /// The same at its beginning [m/s].
    pub(super) before: Vector,
    /// ∇v_p [1/s] (thesis eq. 12).
    pub(super) gradient: Matrix,
    /// C_p = Σ v_i (x_i − x_p)ᵀ w_ip D⁻¹ [1/s] (Jiang et al. 2015).
    pub(super) affine: Matrix,
    /// The beginning's velocity, sent to the grid and back once more [m/s] (Hammerquist & Nairn 2017).
    pub(super) smoothed: Vector,
    /// What the particle's velocity gains [m/s], with [`Transfer::Aflip`].
    pub(super) gain: Vector,
}

impl Gathered {
    /// What the particle does in a step of `time_step` [s].
    pub(super) fn motion(&self, time_step: f64) -> Motion {
        Motion { acceleration: (self.velocity - self.before) / time_step, velocity_gradient: self.gradient }
    }

    /// New velocity of a particle of velocity `v` by a transfer.
    #[inline(always)]
    pub(super) fn new_velocity(&self, v: Vector, kept: f64, transfer: Transfer) -> Vector {
        match transfer {
            Transfer::Pic | Transfer::Apic => self.velocity,
            Transfer::Flip(blend) => (v + self.velocity - self.before) * blend + self.velocity * (1.0 - blend),
            Transfer::Aflip => v * kept + self.gain,
            // v − (I − S S⁺)² v + S a Δt.
            Transfer::Xpic => self.before * 2.0 - self.smoothed + self.velocity - self.before,
        }
    }
}

/// What is asked for besides velocity and its gradient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Wanted {
    pub(super) before: bool,
    pub(super) affine: bool,
    pub(super) smoothed: bool,
    pub(super) gain: bool,
}

impl Wanted {
    /// The velocity at the beginning of the step alone.
    pub(super) const BEFORE: Self = Self { before: true, affine: false, smoothed: false, gain: false };

    /// What a transfer needs.
    pub(super) fn by(transfer: Transfer, kernel: Kernel) -> Self {
        Self {
            before: matches!(transfer, Transfer::Flip(_) | Transfer::Xpic),
            affine: (transfer == Transfer::Apic && kernel != Kernel::Bilinear) || transfer == Transfer::Aflip,
            smoothed: transfer == Transfer::Xpic,
            gain: transfer == Transfer::Aflip,
        }
    }
}

/// 1/D of the kernels whose D = Σ w (x_i − x_p)² is the same everywhere [1/m²] (Jiang et al. 2015).
pub(super) fn inverse_spread(kernel: Kernel, cell_size: f64) -> Option<f64> {
    match kernel {
        Kernel::Quadratic => Some(4.0 / (cell_size * cell_size)),
        Kernel::Cubic => Some(3.0 / (cell_size * cell_size)),
        Kernel::Bilinear | Kernel::Gimp => None,
    }
}

/// Affine weights (x_i − x_p) w / D along one axis [1/m], with D = Σ w (x_i − x_p)², which is zero for no kernel but
/// the bilinear one.
#[inline(always)]
fn affine_weights<const L: usize>(arm: &[f64; L], weight: &[f64; L], inverse_spread: Option<f64>) -> [f64; L] {
    let turning = std::array::from_fn(|a| weight[a] * arm[a]);
    let inverse = match inverse_spread {
        Some(inverse) => inverse,
        None => 1.0 / dot(&turning, arm),
    };
    turning.map(|turning| turning * inverse)
}

/// Σ of the products, those at even places and those at odd ones apart.
#[inline(always)]
fn dot<const L: usize>(values: &[f64; L], weights: &[f64; L]) -> f64 {
    let mut sums = [0.0; 2];
    for a in 0..L {
        sums[a % 2] += values[a] * weights[a];
    }
    sums[0] + sums[1]
}

/// The last of `values`, from `at` on, and 0 after them.
#[cold]
fn last_values<const L: usize>(values: &[f64], at: usize) -> [f64; L] {
    std::array::from_fn(|a| values.get(at + a).copied().unwrap_or_default())
}

/// The `values` of a stencil of `W` rows, which begin at `rows`, summed up over these by `first` and by `second`
/// weights: one sum for each column. Columns beyond the stencil hold what is there.
#[inline(always)]
fn columns<const W: usize, const L: usize>(
    values: &[f64],
    rows: &[usize; kernel::MAX_WIDTH],
    first: &[f64; kernel::MAX_WIDTH],
    second: &[f64; kernel::MAX_WIDTH],
) -> [[f64; L]; 2] {
    let (mut by_first, mut by_second) = ([0.0; L], [0.0; L]);
    for b in 0..W {
        let last;
        let row = match values[rows[b]..].first_chunk::<L>() {
            Some(row) => row,
            None => {
                last = last_values(values, rows[b]);
                &last
            }
        };
        for a in 0..L {
            by_first[a] += first[b] * row[a];
        }
        for a in 0..L {
            by_second[a] += second[b] * row[a];
        }
    }
    [by_first, by_second]
}

/// The weights of a particle.
#[derive(Clone, Copy)]
struct Weights<const L: usize> {
    /// First node of each row.
    rows: [usize; kernel::MAX_WIDTH],
    /// Weights [–], their derivatives and affine weights [1/m] of the columns.
    x: [f64; L],
    dx: [f64; L],
    ax: [f64; L],
    /// The same of the rows.
    y: [f64; kernel::MAX_WIDTH],
    dy: [f64; kernel::MAX_WIDTH],
    ay: [f64; kernel::MAX_WIDTH],
}

/// Sums over the rows of a stencil, column by column, along both axes: by the weights of the rows and by their
/// derivatives or affine weights.
#[derive(Clone, Copy)]
struct Columns<const L: usize> {
    moved: [[[f64; L]; 2]; 2],
    strained: [[[f64; L]; 2]; 2],
    turned: [[[f64; L]; 2]; 2],
    before: [[[f64; L]; 2]; 2],
    smoothed: [[[f64; L]; 2]; 2],
}

impl<const L: usize> Columns<L> {
    const NONE: Self = Self {
        moved: [[[0.0; L]; 2]; 2],
        strained: [[[0.0; L]; 2]; 2],
        turned: [[[0.0; L]; 2]; 2],
        before: [[[0.0; L]; 2]; 2],
        smoothed: [[[0.0; L]; 2]; 2],
    };

    /// Sums up what is wanted over the `W` rows of a stencil.
    #[inline(always)]
    fn fill<const W: usize>(&mut self, weights: &Weights<L>, nodes: &Nodes, wanted: Wanted) {
        let Weights { rows, y, dy, ay, .. } = weights;
        for axis in 0..2 {
            self.moved[axis] = columns::<W, L>(&nodes.after[axis], rows, y, dy);
            if W == 2 && !nodes.remapped[axis].is_empty() {
                self.strained[axis] = columns::<W, L>(&nodes.remapped[axis], rows, y, dy);
            }
            if wanted.affine {
                let turning = if wanted.gain { &nodes.gain[axis] } else { &nodes.after[axis] };
                self.turned[axis] = columns::<W, L>(turning, rows, y, ay);
            }
            if wanted.before {
                self.before[axis] = columns::<W, L>(&nodes.before[axis], rows, y, dy);
            }
            if wanted.smoothed {
                self.smoothed[axis] = columns::<W, L>(&nodes.smoothed[axis], rows, y, dy);
            }
        }
    }

    /// Sums up the columns.
    #[inline(always)]
    fn gathered<const W: usize>(&self, weights: &Weights<L>, nodes: &Nodes, wanted: Wanted) -> Gathered {
        let Weights { x, dx, ax, .. } = weights;
        let strained = if W == 2 && !nodes.remapped[0].is_empty() { &self.strained } else { &self.moved };
        let across = |sums: &[[[f64; L]; 2]; 2]| Vector::new(dot(&sums[0][0], x), dot(&sums[1][0], x));
        let slopes = |sums: &[[[f64; L]; 2]; 2], slope: &[f64; L]| {
            let [along_x, along_y] = sums;
            Matrix::new(dot(&along_x[0], slope), dot(&along_x[1], x), dot(&along_y[0], slope), dot(&along_y[1], x))
        };
        let mut g = Gathered { velocity: across(&self.moved), gradient: slopes(strained, dx), ..Gathered::default() };
        if wanted.affine {
            g.affine = slopes(&self.turned, ax);
            g.gain = across(&self.turned);
        }
        if wanted.before {
            g.before = across(&self.before);
        }
        if wanted.smoothed {
            g.smoothed = across(&self.smoothed);
        }
        g
    }
}

/// Where particles gather from.
#[derive(Debug, Clone, Copy)]
pub(super) struct FromGrid<'a> {
    pub(super) setup: &'a Setup,
    pub(super) lattice: &'a Lattice,
    pub(super) nodes: &'a Nodes,
}

impl<'a> FromGrid<'a> {
    /// Finds the nodes of particles that follow each other.
    pub(super) fn walker(&self) -> Walker<'a> {
        Walker::new(&self.lattice.grid)
    }

    /// What one particle gathers, the velocity at the beginning of the step included.
    pub(super) fn gather_one(&self, particle: usize, point: &MaterialPoint) -> Gathered {
        self.gather_any(&mut self.walker(), particle, point, Wanted::BEFORE)
    }

    /// `value` of what each of `points` gathers.
    pub(super) fn gather_all<T: Send>(
        &self,
        points: &[MaterialPoint],
        wanted: Wanted,
        value: impl Fn(&MaterialPoint, &Gathered) -> T + Send + Sync,
    ) -> Vec<T> {
        let of = |walker: &mut Walker<'_>, p: usize| value(&points[p], &self.gather_any(walker, p, &points[p], wanted));
        let particles = 0..points.len();
        if self.setup.is_parallel() {
            particles.into_par_iter().map_init(|| self.walker(), of).collect()
        } else {
            let mut walker = self.walker();
            particles.map(|p| of(&mut walker, p)).collect()
        }
    }

    fn gather_any(&self, walker: &mut Walker<'_>, particle: usize, point: &MaterialPoint, wanted: Wanted) -> Gathered {
        match kernel::width(self.lattice.kernel) {
            2 => self.gather::<2, 2>(walker, particle, point, wanted),
            3 => self.gather::<3, 4>(walker, particle, point, wanted),
            _ => self.gather::<4, 4>(walker, particle, point, wanted),
        }
    }

    /// What a particle gathers by a kernel that reaches `W` nodes per axis, `L` numbers side by side.
    #[inline(always)]
    fn gather<const W: usize, const L: usize>(
        &self,
        walker: &mut Walker<'_>,
        particle: usize,
        point: &MaterialPoint,
        wanted: Wanted,
    ) -> Gathered {
        if let Some(entries) = self.lattice.stencils.of(particle) {
            return self.gather_divided::<W>(entries, point, wanted);
        }
        let weights = self.weights::<W, L>(walker, point, wanted);
        let mut columns = Columns::NONE;
        columns.fill::<W>(&weights, self.nodes, wanted);
        columns.gathered::<W>(&weights, self.nodes, wanted)
    }

    /// The weights of a particle that no crack divides.
    #[inline(always)]
    fn weights<const W: usize, const L: usize>(
        &self,
        walker: &mut Walker<'_>,
        point: &MaterialPoint,
        wanted: Wanted,
    ) -> Weights<L> {
        let grid = &self.lattice.grid;
        let stencil = self.lattice.stencil(point.position);
        let (x, y) = (first(&stencil.weight[0]), stencil.weight[1]);
        let (dx, dy) = (first(&stencil.gradient[0]), stencil.gradient[1]);
        let (ax, ay) = match wanted.affine {
            // The affine weights of the bilinear kernel are its gradients.
            true if W == 2 => (dx, dy),
            true => {
                let arm_x: [f64; L] = arms(stencil.first[0], grid.origin.x, grid.cell_size, point.position.x);
                let arm_y = arms(stencil.first[1], grid.origin.y, grid.cell_size, point.position.y);
                let inverse = inverse_spread(self.lattice.kernel, grid.cell_size);
                (affine_weights(&arm_x, &x, inverse), affine_weights(&arm_y, &y, inverse))
            }
            false => ([0.0; L], [0.0; kernel::MAX_WIDTH]),
        };
        // The grid has been laid for all stencils.
        let rows = walker.rows(stencil.first, W).unwrap_or_default();
        Weights { rows, x, dx, ax, y, dy, ay }
    }

    /// The same for a particle that cracks divide.
    pub(super) fn gather_divided<const W: usize>(
        &self,
        entries: &[Entry],
        point: &MaterialPoint,
        wanted: Wanted,
    ) -> Gathered {
        let nodes = self.nodes;
        let stencil = self.lattice.stencil(point.position);
        let mut g = Gathered::default();
        let mut spread = Vector::zeros();
        let grid = &self.lattice.grid;
        for axis in 0..2 {
            let arms: [f64; W] = arms(stencil.first[axis], grid.origin[axis], grid.cell_size, point.position[axis]);
            for a in 0..W {
                spread[axis] += stencil.weight[axis][a] * arms[a] * arms[a];
            }
        }
        for e in entries {
            let d = e.field as usize;
            let v = nodes.velocity(d);
            g.velocity += v * e.weight;
            let strain = match &nodes.remapped {
                [x, y] if !x.is_empty() => Vector::new(x[d], y[d]),
                _ => v,
            };
            g.gradient += strain * e.gradient.transpose();
            if wanted.before {
                g.before += nodes.velocity_before(d) * e.weight;
            }
            if wanted.affine {
                let t = if wanted.gain { nodes.gain(d) } else { v };
                g.gain += t * e.weight;
                let arm = if W == 2 { e.gradient } else { self.lattice.arm(e, point.position) * e.weight };
                g.affine += t * arm.transpose();
            }
            if wanted.smoothed {
                g.smoothed += Vector::new(nodes.smoothed[0][d], nodes.smoothed[1][d]) * e.weight;
            }
        }
        if wanted.affine && W != 2 {
            for axis in 0..2 {
                g.affine.column_mut(axis).unscale_mut(spread[axis]);
            }
        }
        g
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wide::{Loop, run_in_all};

    /// What all particles gather.
    struct All<'a, const W: usize, const L: usize> {
        from: FromGrid<'a>,
        points: &'a [MaterialPoint],
        wanted: Wanted,
    }

    impl<const W: usize, const L: usize> Loop for All<'_, W, L> {
        type Output = Vec<[f64; 14]>;

        #[inline(always)]
        fn run(self) -> Self::Output {
            let mut walker = self.from.walker();
            let mut numbers = Vec::new();
            for (p, point) in self.points.iter().enumerate() {
                let g = self.from.gather::<W, L>(&mut walker, p, point, self.wanted);
                let (v, b, s, r) = (g.velocity, g.before, g.smoothed, g.gain);
                let (d, c) = (g.gradient, g.affine);
                numbers.push([v.x, v.y, b.x, b.y, s.x, s.y, r.x, r.y, d.m11, d.m12, d.m21, d.m22, c.m12, c.m21]);
            }
            numbers
        }
    }

    /// Truth: the instructions that every machine has, and the sums over all nodes one by one.
    #[test]
    fn all_instructions_gather_the_same_bits() {
        for kernel in [Kernel::Bilinear, Kernel::Gimp, Kernel::Quadratic, Kernel::Cubic] {
            let (setup, points, lattice) = super::super::tests::shaken(kernel);
            let nodes = super::super::tests::waving(&lattice);
            let from = FromGrid { setup: &setup, lattice: &lattice, nodes: &nodes };
            let wanted = Wanted { before: true, affine: true, smoothed: true, gain: true };
            let points = &points.point;
            let found = match kernel::width(kernel) {
                2 => run_in_all(|| All::<2, 2> { from, points, wanted }),
                3 => run_in_all(|| All::<3, 4> { from, points, wanted }),
                _ => run_in_all(|| All::<4, 4> { from, points, wanted }),
            };
            let bits = |all: &[[f64; 14]]| all.iter().flatten().map(|value| value.to_bits()).collect::<Vec<_>>();
            for (name, all) in &found[1..] {
                assert!(bits(all) == bits(&found[0].1), "{name}, {kernel:?}");
            }
            for (point, found) in points.iter().zip(&found[0].1) {
                let expected = one_by_one(&lattice, &nodes, point);
                // At most 16 terms of up to 1/h = 10 in size, over D = h²/6 at the least where they are affine.
                let off = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(off < 1e-11, "{kernel:?}: {found:?} {expected:?}");
            }
        }
    }

    /// The sums of a particle over its nodes.
    fn one_by_one(lattice: &Lattice, nodes: &Nodes, point: &MaterialPoint) -> [f64; 14] {
        let stencil = lattice.stencil(point.position);
        let at = lattice.grid.stencil(&stencil);
        let all = || (0..stencil.width).flat_map(|b| (0..stencil.width).map(move |a| (a, b)));
        let arm = |a: usize, b: usize| at.place(a, b) - point.position;
        let mut spread = Vector::zeros();
        all().for_each(|(a, b)| spread += arm(a, b).component_mul(&arm(a, b)) * stencil.weight(a, b));
        let sum = |values: &[f64], weight: &dyn Fn(usize, usize) -> f64| {
            all().map(|(a, b)| values[at.at(a, b).unwrap_or_default()] * weight(a, b)).sum::<f64>()
        };
        let weight = |a: usize, b: usize| stencil.weight(a, b);
        let slope = |axis: usize| move |a: usize, b: usize| stencil.weight_gradient(a, b)[axis];
        let affine = |axis: usize| {
            move |a: usize, b: usize| match stencil.width {
                2 => stencil.weight_gradient(a, b)[axis],
                _ => stencil.weight(a, b) * arm(a, b)[axis] / spread[axis],
            }
        };
        let [vx, vy] = [0, 1].map(|axis: usize| &nodes.after[axis]);
        [
            sum(vx, &weight),
            sum(vy, &weight),
            sum(&nodes.before[0], &weight),
            sum(&nodes.before[1], &weight),
            sum(&nodes.smoothed[0], &weight),
            sum(&nodes.smoothed[1], &weight),
            sum(&nodes.gain[0], &weight),
            sum(&nodes.gain[1], &weight),
            sum(vx, &slope(0)),
            sum(vx, &slope(1)),
            sum(vy, &slope(0)),
            sum(vy, &slope(1)),
            sum(&nodes.gain[0], &affine(1)),
            sum(&nodes.gain[1], &affine(0)),
        ]
    }
}
