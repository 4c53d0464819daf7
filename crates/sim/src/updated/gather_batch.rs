//! What many particles gather from the grid at once: the same sums as those of one, number by number side by side.

use super::gather::{FromGrid, Gathered, Wanted, inverse_spread};
use super::lattice::Lattice;
use super::particles_to_grid::arm;
use super::points::MaterialPoint;
use crate::grid::walker::Walker;
use fissure_scene::{Kernel, Matrix, Vector};

/// Particles of a batch.
pub(super) const BATCH: usize = 16;

/// One number of each particle of a batch: loops over them have several side by side.
type Numbers = [f64; BATCH];

/// Weights of stencils of `W` nodes along one axis.
struct Weights<const W: usize> {
    lowest: [i32; BATCH],
    /// [–].
    weight: [Numbers; W],
    /// Derivatives [1/m].
    slope: [Numbers; W],
    /// Affine weights (x_i − x_p) w / D [1/m], where they are wanted.
    affine: [Numbers; W],
}

impl<const W: usize> Weights<W> {
    const NONE: Self =
        Self { lowest: [0; BATCH], weight: [[0.0; BATCH]; W], slope: [[0.0; BATCH]; W], affine: [[0.0; BATCH]; W] };

    #[inline(always)]
    fn fill(&mut self, places: &Numbers, lattice: &Lattice, axis: usize, kernel: Kernel, affine: bool) {
        let (origin, h) = (lattice.grid.origin[axis], lattice.grid.cell_size);
        for k in 0..BATCH {
            let stencil = lattice.axis_stencil(kernel, axis, places[k]);
            self.lowest[k] = stencil.first;
            for a in 0..W {
                self.weight[a][k] = stencil.weight[a];
                self.slope[a][k] = stencil.gradient[a];
            }
        }
        if !affine {
            return;
        }
        if kernel == Kernel::Bilinear {
            // The affine weights of the bilinear kernel are its gradients.
            self.affine = self.slope;
            return;
        }
        for k in 0..BATCH {
            let (mut turning, mut even, mut odd) = ([0.0; W], 0.0, 0.0);
            for a in 0..W {
                let arm = arm(self.lowest[k], a, origin, h, places[k]);
                turning[a] = self.weight[a][k] * arm;
                *(if a % 2 == 0 { &mut even } else { &mut odd }) += turning[a] * arm;
            }
            let inverse = inverse_spread(kernel, h).unwrap_or(1.0 / (even + odd));
            for a in 0..W {
                self.affine[a][k] = turning[a] * inverse;
            }
        }
    }
}

/// What a batch gathers of one component of a velocity.
struct Sums {
    /// [m/s].
    value: Numbers,
    /// Along x and y, by the derivatives or by the affine weights [1/s].
    slopes: [Numbers; 2],
}

impl Sums {
    const NONE: Self = Self { value: [0.0; BATCH], slopes: [[0.0; BATCH]; 2] };

    /// As [`Sums::fill`], and those by `affine` weights into `turned`.
    #[inline(always)]
    fn fill_with<const W: usize>(
        &mut self,
        values: &[[Numbers; W]; W],
        [x, y]: [&[Numbers; W]; 2],
        [dx, dy]: [&[Numbers; W]; 2],
        [ax, ay]: [&[Numbers; W]; 2],
        turned: &mut Self,
    ) {
        for k in 0..BATCH {
            let (mut value, mut along_x, mut along_y) = ([0.0; 2], [0.0; 2], [0.0; 2]);
            let (mut turned_x, mut turned_y) = ([0.0; 2], [0.0; 2]);
            for a in 0..W {
                let (mut by_weight, mut by_slope, mut by_affine) = (0.0, 0.0, 0.0);
                for b in 0..W {
                    by_weight += y[b][k] * values[b][a][k];
                    by_slope += dy[b][k] * values[b][a][k];
                    by_affine += ay[b][k] * values[b][a][k];
                }
                value[a % 2] += by_weight * x[a][k];
                along_x[a % 2] += by_weight * dx[a][k];
                along_y[a % 2] += by_slope * x[a][k];
                turned_x[a % 2] += by_weight * ax[a][k];
                turned_y[a % 2] += by_affine * x[a][k];
            }
            self.value[k] = value[0] + value[1];
            self.slopes[0][k] = along_x[0] + along_x[1];
            self.slopes[1][k] = along_y[0] + along_y[1];
            turned.value[k] = self.value[k];
            turned.slopes[0][k] = turned_x[0] + turned_x[1];
            turned.slopes[1][k] = turned_y[0] + turned_y[1];
        }
    }

    /// Sums up `values` of the nodes, by columns first.
    #[inline(always)]
    fn fill<const W: usize>(
        &mut self,
        values: &[[Numbers; W]; W],
        [x, y]: [&[Numbers; W]; 2],
        [dx, dy]: [&[Numbers; W]; 2],
    ) {
        for k in 0..BATCH {
            let (mut value, mut along_x, mut along_y) = ([0.0; 2], [0.0; 2], [0.0; 2]);
            for a in 0..W {
                let (mut by_weight, mut by_slope) = (0.0, 0.0);
                for b in 0..W {
                    by_weight += y[b][k] * values[b][a][k];
                    by_slope += dy[b][k] * values[b][a][k];
                }
                value[a % 2] += by_weight * x[a][k];
                along_x[a % 2] += by_weight * dx[a][k];
                along_y[a % 2] += by_slope * x[a][k];
            }
            self.value[k] = value[0] + value[1];
            self.slopes[0][k] = along_x[0] + along_x[1];
            self.slopes[1][k] = along_y[0] + along_y[1];
        }
    }
}

/// Vectors and matrices of all particles of a batch, one after the other as particles hold them: put together number by
/// number just before they are used, they would have to be waited for.
struct Packed {
    value: [[f64; 2]; BATCH],
    /// By columns.
    slopes: [[f64; 4]; BATCH],
}

impl Packed {
    const NONE: Self = Self { value: [[0.0; 2]; BATCH], slopes: [[0.0; 4]; BATCH] };

    #[inline(always)]
    fn fill(&mut self, [x, y]: &[Sums; 2]) {
        for k in 0..BATCH {
            self.value[k] = [x.value[k], y.value[k]];
        }
        for k in 0..BATCH {
            self.slopes[k] = [x.slopes[0][k], y.slopes[0][k], x.slopes[1][k], y.slopes[1][k]];
        }
    }

    #[inline(always)]
    fn value(&self, k: usize) -> Vector {
        Vector::new(self.value[k][0], self.value[k][1])
    }

    #[inline(always)]
    fn slopes(&self, k: usize) -> Matrix {
        let [xx, yx, xy, yy] = self.slopes[k];
        Matrix::new(xx, xy, yx, yy)
    }
}

/// Neighbouring particles that gather at once, as if no crack divided them, by a kernel of `W` nodes along an axis.
pub(super) struct Batch<const W: usize> {
    places: [Numbers; 2],
    along: [Weights<W>; 2],
    /// First node of each row of each stencil.
    rows: [[usize; BATCH]; W],
    /// Both components at the nodes of the stencils, row by row.
    values: [[[Numbers; W]; W]; 2],
    /// Sums of both components.
    sums: [Sums; 2],
    /// The same by affine weights, where these go with the velocities themselves.
    sums_turned: [Sums; 2],
    moved: Packed,
    strained: Packed,
    turned: Packed,
    before: Packed,
    smoothed: Packed,
}

impl<const W: usize> Batch<W> {
    pub(super) const NONE: Self = Self {
        places: [[0.0; BATCH]; 2],
        along: [Weights::NONE; 2],
        rows: [[0; BATCH]; W],
        values: [[[[0.0; BATCH]; W]; W]; 2],
        sums: [Sums::NONE; 2],
        sums_turned: [Sums::NONE; 2],
        moved: Packed::NONE,
        strained: Packed::NONE,
        turned: Packed::NONE,
        before: Packed::NONE,
        smoothed: Packed::NONE,
    };

    /// Works out what `points` gather, at most [`BATCH`].
    #[inline(always)]
    pub(super) fn fill(
        &mut self,
        from: &FromGrid<'_>,
        walker: &mut Walker<'_>,
        points: &[MaterialPoint],
        wanted: Wanted,
    ) {
        for (k, point) in points.iter().enumerate().take(BATCH) {
            (self.places[0][k], self.places[1][k]) = (point.position.x, point.position.y);
        }
        // Known where the loops are compiled, the kernel takes no branches in them.
        match (W, from.lattice.kernel) {
            (2, _) => self.weigh(from.lattice, Kernel::Bilinear, wanted.affine),
            (4, _) => self.weigh(from.lattice, Kernel::Cubic, wanted.affine),
            (_, Kernel::Gimp) => self.weigh(from.lattice, Kernel::Gimp, wanted.affine),
            _ => self.weigh(from.lattice, Kernel::Quadratic, wanted.affine),
        }
        let count = points.len().min(BATCH);
        for k in 0..count {
            // The grid has been laid for all stencils.
            let rows = walker.rows([self.along[0].lowest[k], self.along[1].lowest[k]], W).unwrap_or_default();
            // One by one: put together and read as a whole at once, they would have to be waited for.
            for b in 0..W {
                self.rows[b][k] = rows[b];
            }
        }
        self.gather(from, count, wanted);
    }

    #[inline(always)]
    fn weigh(&mut self, lattice: &Lattice, kernel: Kernel, affine: bool) {
        self.along[0].fill(&self.places[0], lattice, 0, kernel, affine);
        self.along[1].fill(&self.places[1], lattice, 1, kernel, affine);
    }

    #[inline(always)]
    fn gather(&mut self, from: &FromGrid<'_>, count: usize, wanted: Wanted) {
        let nodes = from.nodes;
        let Self { along: [x, y], rows, values, sums, sums_turned, .. } = self;
        let (weights, slopes, affine) = ([&x.weight, &y.weight], [&x.slope, &y.slope], [&x.affine, &y.affine]);
        let is_both = wanted.affine && !wanted.gain;
        for axis in 0..2 {
            read(&mut values[axis], &nodes.after[axis], rows, count);
            if is_both {
                sums[axis].fill_with(&values[axis], weights, slopes, affine, &mut sums_turned[axis]);
            } else {
                sums[axis].fill(&values[axis], weights, slopes);
            }
        }
        self.moved.fill(sums);
        if is_both {
            self.turned.fill(sums_turned);
        } else if wanted.affine {
            for axis in 0..2 {
                read(&mut values[axis], &nodes.gain[axis], rows, count);
                sums[axis].fill(&values[axis], weights, affine);
            }
            self.turned.fill(sums);
        }
        let others = [
            (W == 2 && !nodes.remapped[0].is_empty(), &nodes.remapped, &mut self.strained),
            (wanted.before, &nodes.before, &mut self.before),
            (wanted.smoothed, &nodes.smoothed, &mut self.smoothed),
        ];
        for (is_wanted, of_nodes, packed) in others {
            if is_wanted {
                for axis in 0..2 {
                    read(&mut values[axis], &of_nodes[axis], rows, count);
                    sums[axis].fill(&values[axis], weights, slopes);
                }
                packed.fill(sums);
            }
        }
    }

    /// What the particle at place `k` of those filled in gathers: `particle`, which is at `point`.
    #[inline(always)]
    pub(super) fn gathered(
        &self,
        k: usize,
        from: &FromGrid<'_>,
        particle: usize,
        point: &MaterialPoint,
        wanted: Wanted,
    ) -> Gathered {
        if let Some(entries) = from.lattice.stencils.of(particle) {
            return from.gather_divided::<W>(entries, point, wanted);
        }
        let strained = if W == 2 && !from.nodes.remapped[0].is_empty() { &self.strained } else { &self.moved };
        let mut g = Gathered { velocity: self.moved.value(k), gradient: strained.slopes(k), ..Gathered::default() };
        if wanted.affine {
            g.affine = self.turned.slopes(k);
            g.gain = self.turned.value(k);
        }
        if wanted.before {
            g.before = self.before.value(k);
        }
        if wanted.smoothed {
            g.smoothed = self.smoothed.value(k);
        }
        g
    }
}

/// Reads one component, `of_nodes`, at the nodes of the first `count` stencils, whose rows begin at `rows`.
#[inline(always)]
fn read<const W: usize>(values: &mut [[Numbers; W]; W], of_nodes: &[f64], rows: &[[usize; BATCH]; W], count: usize) {
    for k in 0..count {
        for b in 0..W {
            let Some(row) = of_nodes[rows[b][k]..].first_chunk::<W>() else { continue };
            for a in 0..W {
                values[b][a][k] = row[a];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::kernel;
    use crate::wide::{Loop, run_in_all};

    /// What all particles gather, batch by batch.
    struct All<'a, const W: usize> {
        from: FromGrid<'a>,
        points: &'a [MaterialPoint],
        wanted: Wanted,
    }

    impl<const W: usize> Loop for All<'_, W> {
        type Output = Vec<Gathered>;

        #[inline(always)]
        fn run(self) -> Self::Output {
            let Self { from, points, wanted } = self;
            let (mut walker, mut batch, mut all) = (from.walker(), Batch::<W>::NONE, Vec::new());
            for (n, points) in points.chunks(BATCH).enumerate() {
                batch.fill(&from, &mut walker, points, wanted);
                all.extend(
                    points.iter().enumerate().map(|(k, point)| batch.gathered(k, &from, n * BATCH + k, point, wanted)),
                );
            }
            all
        }
    }

    /// Truth: the same particles one by one, to the last bit, in all instructions that the machine has.
    #[test]
    fn a_batch_gathers_what_each_gathers_alone() {
        for kernel in [Kernel::Bilinear, Kernel::Gimp, Kernel::Quadratic, Kernel::Cubic] {
            let (setup, points, lattice) = super::super::tests::shaken(kernel);
            let mut nodes = super::super::tests::waving(&lattice);
            if kernel == Kernel::Bilinear {
                nodes.remapped = super::super::tests::waves(&lattice, 2.3);
            }
            let from = FromGrid { setup: &setup, lattice: &lattice, nodes: &nodes };
            let points = &points.point;
            for gain in [false, true] {
                let wanted = Wanted { before: true, affine: true, smoothed: true, gain };
                let alone = from.gather_all(points, wanted, |_, g| *g);
                let found = match kernel::width(kernel) {
                    2 => run_in_all(|| All::<2> { from, points, wanted }),
                    3 => run_in_all(|| All::<3> { from, points, wanted }),
                    _ => run_in_all(|| All::<4> { from, points, wanted }),
                };
                for (name, all) in &found {
                    for (together, alone) in all.iter().zip(&alone) {
                        assert!(together == alone, "{name}, {kernel:?}: {together:?} {alone:?}");
                    }
                    assert_eq!(all.len(), alone.len());
                }
            }
        }
    }
}
