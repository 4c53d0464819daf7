//! Internal forces of whole rows of uncut cells, without branches.
//!
//! On a lattice of 2×2 particles per cell and bilinear kernels the stencil is the same in every uncut cell, so a run of
//! such cells is one loop over contiguous arrays, and an elastic particle in it needs no state at all: H = Σ u_i ⊗
//! ∇w_ip.

use super::field_vectors::FieldVectors;
use super::lattice::Lattice;
use super::run::Run;
use crate::grid::Grid;
use crate::wide::{Loop, run_widest};
use std::ops::Range;

/// Cells treated at once.
const BLOCK: usize = 32;

/// Elastic constants of a run, with lengths folded in.
#[derive(Debug, Clone, Copy)]
struct RowConstants {
    /// 2μ V_p / h and λ V_p / h: stress times particle volume over cell size [N/m].
    two_mu: f64,
    lambda: f64,
    /// 1/h [1/m].
    inverse_cell_size: f64,
}

/// The rows of uncut cells.
#[derive(Debug, Clone, Copy)]
struct CellRows<'a> {
    /// Runs above each row of nodes.
    runs: &'a [Vec<Run>],
    grid: &'a Grid,
    /// Of each material.
    constants: &'a [RowConstants],
    /// Displacements of all fields.
    u: &'a FieldVectors,
    /// Nodes from which on a block of rows is shared out.
    part: usize,
}

impl CellRows<'_> {
    /// Makes `forces`, which begin at node `start`, those of the cells above `rows` of nodes; the first of `rows` is
    /// an even one.
    ///
    /// Two neighbouring rows of cells share a row of nodes. There the even row comes first and the odd one after it,
    /// whatever the blocks and the threads, so that the sums are always the same: the odd row where two blocks meet
    /// waits for both.
    fn make_forces(&self, rows: Range<usize>, start: usize, forces: [&mut [f64]; 2]) {
        let [force_x, force_y] = forces;
        let middle = (rows.start + rows.len() / 2).next_multiple_of(2);
        if force_x.len() <= self.part || middle + 1 >= rows.end {
            run_widest(Block { cells: *self, rows, start, forces: [force_x, force_y] });
            return;
        }
        let at = self.grid.row(middle).nodes.start;
        let (lower_x, upper_x) = force_x.split_at_mut(at - start);
        let (lower_y, upper_y) = force_y.split_at_mut(at - start);
        crate::threads::join(
            || self.make_forces(rows.start..middle - 1, start, [lower_x, lower_y]),
            || self.make_forces(middle..rows.end, at, [upper_x, upper_y]),
        );
        run_widest(Seam { cells: *self, row: middle - 1, start, forces: [force_x, force_y] });
    }

    /// Adds the forces of the cells above a row of nodes.
    #[inline(always)]
    fn add_row(&self, row: usize, start: usize, forces: &mut [&mut [f64]; 2]) {
        for &run in &self.runs[row] {
            let lower = run.lower as usize..(run.lower + run.count + 1) as usize;
            let upper = run.upper as usize..(run.upper + run.count + 1) as usize;
            let u = [&self.u[0], &self.u[1]];
            let u = [[&u[0][lower.clone()], &u[0][upper.clone()]], [&u[1][lower.clone()], &u[1][upper.clone()]]];
            let [force_x, force_y] = forces;
            let (lower_x, upper_x) = force_x.split_at_mut(upper.start - start);
            let (lower_y, upper_y) = force_y.split_at_mut(upper.start - start);
            let lower = lower.start - start..lower.end - start;
            let forces = [
                [&mut lower_x[lower.clone()], &mut upper_x[..upper.len()]],
                [&mut lower_y[lower], &mut upper_y[..upper.len()]],
            ];
            add_forces(self.constants[run.material as usize], u, forces);
        }
    }
}

/// Rows that one thread goes through.
struct Block<'a> {
    cells: CellRows<'a>,
    rows: Range<usize>,
    start: usize,
    forces: [&'a mut [f64]; 2],
}

impl Loop for Block<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { cells, rows, start, mut forces } = self;
        for force in &mut forces {
            force.fill(0.0);
        }
        for even in rows.clone().step_by(2) {
            cells.add_row(even, start, &mut forces);
            if even > rows.start {
                cells.add_row(even - 1, start, &mut forces);
            }
        }
        if !rows.is_empty() && rows.len().is_multiple_of(2) {
            cells.add_row(rows.end - 1, start, &mut forces);
        }
    }
}

/// The row of cells between two blocks.
struct Seam<'a> {
    cells: CellRows<'a>,
    row: usize,
    start: usize,
    forces: [&'a mut [f64]; 2],
}

impl Loop for Seam<'_> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        self.cells.add_row(self.row, self.start, &mut self.forces);
    }
}

impl Lattice {
    /// Internal forces for the displacement `u` into `force`, with or without misfits.
    pub(super) fn internal_forces(&self, u: &FieldVectors, with_misfits: bool, force: &mut FieldVectors) {
        let nodes = self.grid.len();
        for f in force.iter_mut() {
            f.resize(self.field_count(), 0.0);
            // Of further fields; those of the nodes are made anew below.
            f[nodes..].fill(0.0);
        }
        let volume = self.particles.spacing * self.particles.spacing;
        let inverse_cell_size = 1.0 / self.grid.cell_size;
        let constants: Vec<RowConstants> = self
            .materials
            .iter()
            .map(|e| RowConstants {
                two_mu: 2.0 * e.mu * volume * inverse_cell_size,
                lambda: e.lambda * volume * inverse_cell_size,
                inverse_cell_size,
            })
            .collect();
        let cells = CellRows {
            runs: &self.layout.runs,
            grid: &self.grid,
            constants: &constants,
            u,
            part: crate::threads::part(nodes),
        };
        let [force_x, force_y] = &mut *force;
        cells.make_forces(0..self.grid.rows(), 0, [&mut force_x[..nodes], &mut force_y[..nodes]]);
        for cut in [&self.layout.cut, &self.layout.far] {
            cut.add_forces(&self.particles, &self.materials, u, with_misfits, force);
        }
    }
}

/// Forces of the cells of a block on their nodes at one side: x, y of the lower row, then of the upper one.
type Side<const COUNT: usize> = [[f64; COUNT]; 4];

/// Adds the internal forces f_i = −Σ_p V_p P_p ∇w_ip of a run of cells to those of its two rows of nodes.
///
/// `u`, `forces`: x, then y, each of the lower and the upper row.
#[inline(always)]
fn add_forces(constants: RowConstants, u: [[&[f64]; 2]; 2], forces: [[&mut [f64]; 2]; 2]) {
    let [[lower_x, upper_x], [lower_y, upper_y]] = forces;
    let mut forces = [lower_x, lower_y, upper_x, upper_y];
    let [[u_lower_x, u_upper_x], [u_lower_y, u_upper_y]] = u;
    let end = u_lower_x.len() - 1;
    let mut left: Side<BLOCK> = [[0.0; BLOCK]; 4];
    // One place later, beside those of the next cell on the same node.
    let mut right: Side<{ BLOCK + 1 }> = [[0.0; BLOCK + 1]; 4];
    let mut start = 0;
    while start < end {
        let count = BLOCK.min(end - start);
        cell_forces(
            count,
            constants,
            [
                &u_lower_x[start..start + count],
                &u_lower_x[start + 1..start + 1 + count],
                &u_upper_x[start..start + count],
                &u_upper_x[start + 1..start + 1 + count],
                &u_lower_y[start..start + count],
                &u_lower_y[start + 1..start + 1 + count],
                &u_upper_y[start..start + count],
                &u_upper_y[start + 1..start + 1 + count],
            ],
            &mut left,
            &mut right,
        );
        for (force, (left, right)) in forces.iter_mut().zip(left.iter().zip(&mut right)) {
            for ((f, left), right) in force[start..start + count].iter_mut().zip(left).zip(&*right) {
                *f += left + right;
            }
            right[0] = right[count];
        }
        start += count;
    }
    for (force, right) in forces.into_iter().zip(right) {
        force[end] += right[0];
    }
}

/// Two vectors at a quarter of the way from `a` to `b` and from `b` to `a`.
#[inline(always)]
fn quarters(a: [f64; 2], b: [f64; 2]) -> [[f64; 2]; 2] {
    let near = |a: [f64; 2], b: [f64; 2]| [0.75 * a[0] + 0.25 * b[0], 0.75 * a[1] + 0.25 * b[1]];
    [near(a, b), near(b, a)]
}

/// Forces of `count` cells on their nodes to the left and to the right.
///
/// H e_x is the same at both particles of one height, H e_y at both of one column; and ∇w = (∓(1−b), ∓(1−a))/h and so
/// on weighs P e_x by the height and P e_y by the column. So P e_x is summed at each height and P e_y in each column
/// before either is weighed. A mirrored cell has the same sums.
#[inline(always)]
fn cell_forces(
    count: usize,
    constants: RowConstants,
    u: [&[f64]; 8],
    left: &mut Side<BLOCK>,
    right: &mut Side<{ BLOCK + 1 }>,
) {
    let RowConstants { two_mu, lambda, inverse_cell_size } = constants;
    let [x00, x10, x01, x11, y00, y10, y01, y11] = u;
    let (x00, x10, x01, x11) = (&x00[..count], &x10[..count], &x01[..count], &x11[..count]);
    let (y00, y10, y01, y11) = (&y00[..count], &y10[..count], &y01[..count], &y11[..count]);
    for k in 0..count {
        // Differences along the four edges of the cell, over h.
        let at_bottom = [(x10[k] - x00[k]) * inverse_cell_size, (y10[k] - y00[k]) * inverse_cell_size];
        let at_top = [(x11[k] - x01[k]) * inverse_cell_size, (y11[k] - y01[k]) * inverse_cell_size];
        let at_left = [(x01[k] - x00[k]) * inverse_cell_size, (y01[k] - y00[k]) * inverse_cell_size];
        let at_right = [(x11[k] - x10[k]) * inverse_cell_size, (y11[k] - y10[k]) * inverse_cell_size];
        let (along_x, along_y) = (quarters(at_bottom, at_top), quarters(at_left, at_right));
        // Of each particle, by its height and its column.
        let (mut stretch, mut turn, mut volume) = ([[0.0; 2]; 2], [[0.0; 2]; 2], [[0.0; 2]; 2]);
        for j in 0..2 {
            for i in 0..2 {
                let ([h11, h21], [h12, h22]) = (along_x[j], along_y[i]);
                // 2μ (F − R) = 2μ H + stretch and turn, without cancellation (see constitutive.rs), for any turn: 1 −
                // cosine/r = sine²/(r (r + |cosine|)), or (r + |cosine|)/r when negative.
                let cosine = 2.0 + (h11 + h22);
                let sine = h21 - h12;
                let r = (cosine * cosine + sine * sine).sqrt();
                let sum = r + cosine.abs();
                let part = two_mu / (r * sum);
                stretch[j][i] = if cosine > 0.0 { sine * sine } else { sum * sum } * part;
                turn[j][i] = sine * sum * part;
                volume[j][i] = lambda * (h11 + h22 + (h11 * h22 - h12 * h21));
            }
        }
        let (mut by_height, mut by_column) = ([[0.0; 2]; 2], [[0.0; 2]; 2]);
        for j in 0..2 {
            let v = volume[j];
            by_height[j] = [
                2.0 * two_mu * along_x[j][0]
                    + (stretch[j][0] + stretch[j][1])
                    + ((v[0] + v[1]) + (v[0] * along_y[0][1] + v[1] * along_y[1][1])),
                2.0 * two_mu * along_x[j][1]
                    - (turn[j][0] + turn[j][1])
                    - (v[0] * along_y[0][0] + v[1] * along_y[1][0]),
            ];
            let v = [volume[0][j], volume[1][j]];
            by_column[j] = [
                2.0 * two_mu * along_y[j][0] + (turn[0][j] + turn[1][j])
                    - (v[0] * along_x[0][1] + v[1] * along_x[1][1]),
                2.0 * two_mu * along_y[j][1]
                    + (stretch[0][j] + stretch[1][j])
                    + ((v[0] + v[1]) + (v[0] * along_x[0][0] + v[1] * along_x[1][0])),
            ];
        }
        let (rows, columns) = (quarters(by_height[0], by_height[1]), quarters(by_column[0], by_column[1]));
        for axis in 0..2 {
            left[axis][k] = rows[0][axis] + columns[0][axis];
            right[axis][k + 1] = columns[1][axis] - rows[0][axis];
            left[2 + axis][k] = rows[1][axis] - columns[0][axis];
            right[2 + axis][k + 1] = -(rows[1][axis] + columns[1][axis]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wide::run_in_all;
    use fissure_scene::Matrix;

    /// Truth: a rigid turn makes no stress, whatever its angle; next to half a turn r + cosine cancels.
    #[test]
    fn turned_rows_are_free_of_force() {
        let (h, count) = (0.5, 8);
        let constants = RowConstants { two_mu: 2.0, lambda: 1.5, inverse_cell_size: 1.0 / h };
        for angle in [0.1, 3.0, std::f64::consts::PI - 1e-9, std::f64::consts::PI, 3.2, 5.0, 62.9] {
            let (sine, cosine) = f64::sin_cos(angle);
            let moved = |row: f64| -> [Vec<f64>; 2] {
                let place = |i: usize| (i as f64 * h, row * h);
                let x = |i| (cosine - 1.0) * place(i).0 - sine * place(i).1;
                let y = |i| sine * place(i).0 + (cosine - 1.0) * place(i).1;
                [(0..=count).map(x).collect(), (0..=count).map(y).collect()]
            };
            let ([lx, ly], [ux, uy]) = (moved(0.0), moved(1.0));
            let mut found = [0; 4].map(|_| vec![0.0; count + 1]);
            let [fx, fy, gx, gy] = found.each_mut().map(|f| f.as_mut_slice());
            add_forces(constants, [[&lx, &ux], [&ly, &uy]], [[fx, gx], [fy, gy]]);
            let most = found.iter().flatten().fold(0.0_f64, |m, f| m.max(f.abs()));
            assert!(most < 1e-13, "{most} at {angle}");
        }
    }

    /// A run of `count` cells between two rows of nodes.
    struct OneRun<'a> {
        constants: RowConstants,
        u: [[&'a [f64]; 2]; 2],
    }

    impl Loop for OneRun<'_> {
        type Output = [Vec<f64>; 4];

        #[inline(always)]
        fn run(self) -> Self::Output {
            let mut found = [0; 4].map(|_| vec![0.0; self.u[0][0].len()]);
            let [fx, fy, gx, gy] = found.each_mut().map(|f| f.as_mut_slice());
            add_forces(self.constants, self.u, [[fx, gx], [fy, gy]]);
            found
        }
    }

    /// Truth: the instructions that every machine has. Runs of all lengths around the widths, numbers of all sizes.
    #[test]
    fn all_instructions_give_the_same_bits() {
        let constants = RowConstants { two_mu: 2.6, lambda: 2.1, inverse_cell_size: 1.0 / 0.7 };
        for count in (1..70).chain([400]) {
            let values = |seed: f64| -> Vec<f64> {
                (0..=count).map(|i| (f64::from(i) * seed).sin() * 10.0_f64.powi(i % 9 - 7)).collect()
            };
            let (lx, ly, ux, uy) = (values(1.1), values(2.3), values(3.7), values(5.3));
            let found = run_in_all(|| OneRun { constants, u: [[&lx, &ux], [&ly, &uy]] });
            let bits = |forces: &[Vec<f64>; 4]| forces.concat().iter().map(|f| f.to_bits()).collect::<Vec<_>>();
            assert!(found[0].1.concat().iter().all(|f| f.is_finite() && *f != 0.0), "{count} cells");
            for (name, forces) in &found[1..] {
                assert!(bits(forces) == bits(&found[0].1), "{name}, {count} cells");
            }
        }
    }

    /// Truth: symmetry. What is mirrored has mirrored forces, to the bit, whatever the number of cells.
    #[test]
    fn mirrored_rows_have_mirrored_forces() {
        let constants = RowConstants { two_mu: 2.6, lambda: 2.1, inverse_cell_size: 1.0 / 0.7 };
        for count in (1..70).chain([400]) {
            let values = |seed: f64| -> Vec<f64> { (0..=count).map(|i| 0.1 * (f64::from(i) * seed).sin()).collect() };
            let forces = |[lx, ux, ly, uy]: [&[f64]; 4]| OneRun { constants, u: [[lx, ux], [ly, uy]] }.run();
            let mirrored = |numbers: &[f64], sign: f64| numbers.iter().rev().map(|x| sign * x).collect::<Vec<f64>>();
            let u = [1.1, 3.7, 2.3, 5.3].map(values);
            let [lx, ux, ly, uy] = u.each_ref().map(Vec::as_slice);
            let found = forces([lx, ux, ly, uy]);
            let m = [(lx, -1.0), (ux, -1.0), (ly, 1.0), (uy, 1.0)].map(|(numbers, sign)| mirrored(numbers, sign));
            let of_mirrored = forces(m.each_ref().map(Vec::as_slice));
            for (k, sign) in [-1.0, 1.0, -1.0, 1.0].into_iter().enumerate() {
                assert!(found[k] == mirrored(&of_mirrored[k], sign), "left to right, {count} cells, {k}");
            }
            // Top to bottom.
            let minus = |numbers: &[f64]| numbers.iter().map(|y| -y).collect::<Vec<f64>>();
            let upside_down = forces([ux, lx, &minus(uy), &minus(ly)]);
            assert!(found[0] == upside_down[2] && found[1] == minus(&upside_down[3]), "top to bottom, {count} cells");
        }
    }

    /// Truth: the sum over particles of −V P ∇w with the stress of `constitutive.rs`, cell by cell.
    #[test]
    fn rows_equal_the_particle_sum() {
        let (mu, lambda, h) = (1.3, 2.1, 0.7);
        let count = 40;
        let values = |seed: f64| -> Vec<f64> { (0..=count).map(|i| 0.1 * ((i as f64) * seed).sin()).collect() };
        let (lx, ly, ux, uy) = (values(1.1), values(2.3), values(3.7), values(5.3));
        let volume = 0.25 * h * h;
        let constants =
            RowConstants { two_mu: 2.0 * mu * volume / h, lambda: lambda * volume / h, inverse_cell_size: 1.0 / h };
        let mut found = [0; 4].map(|_| vec![0.0; count + 1]);
        let [fx, fy, gx, gy] = found.each_mut().map(|f| &mut f[1..count]);
        let u = [[&lx[1..count], &ux[1..count]], [&ly[1..count], &uy[1..count]]];
        add_forces(constants, u, [[fx, gx], [fy, gy]]);
        let mut expected = [0; 4].map(|_| vec![0.0; count + 1]);
        for cell in 1..count - 1 {
            for (a, b) in [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)] {
                let gradients = [
                    (cell, 0, [-(1.0 - b) / h, -(1.0 - a) / h]),
                    (cell + 1, 0, [(1.0 - b) / h, -a / h]),
                    (cell, 2, [-b / h, (1.0 - a) / h]),
                    (cell + 1, 2, [b / h, a / h]),
                ];
                let mut gradient = Matrix::zeros();
                for (i, row, g) in gradients {
                    let (x, y) = if row == 0 { (lx[i], ly[i]) } else { (ux[i], uy[i]) };
                    gradient += Matrix::new(x * g[0], x * g[1], y * g[0], y * g[1]);
                }
                let stress = crate::first_piola_stress(&gradient, mu, lambda) * volume;
                for (i, row, g) in gradients {
                    expected[row][i] -= stress.m11 * g[0] + stress.m12 * g[1];
                    expected[row + 1][i] -= stress.m21 * g[0] + stress.m22 * g[1];
                }
            }
        }
        for (f, e) in found.iter().flatten().zip(expected.iter().flatten()) {
            assert!((f - e).abs() < 1e-14, "{f} {e}");
        }
    }
}
