//! From the particles to the grid.
//!
//! Particles go to the grid by bands of rows of nodes. A band and the one its particles reach above it lie in one piece
//! of memory, and the pieces of every other band do not touch: all even bands at once, then all odd ones. The order of
//! additions at a node is then the same for any number of threads.

use super::lattice::Lattice;
use super::nodes::Nodes;
use super::points::Points;
use super::setup::Setup;
use crate::grid::walker::Walker;
use crate::grid::{kernel, pieces};
use crate::threads::prelude::*;
use fissure_scene::{Matrix, Vector};

/// What goes to the grid.
#[derive(Debug, Clone, Copy)]
pub(super) struct ToGrid<'a> {
    pub(super) setup: &'a Setup,
    pub(super) points: &'a Points,
    pub(super) lattice: &'a Lattice,
}

/// The nodes that the particles of one band reach.
struct Piece<'a> {
    /// Index of the band.
    band: usize,
    /// Its first node.
    start: usize,
    mass: &'a mut [f64],
    momentum: [&'a mut [f64]; 2],
    force: [&'a mut [f64]; 2],
}

/// The same, for the momentum alone.
struct MomentumPiece<'a> {
    band: usize,
    start: usize,
    momentum: [&'a mut [f64]; 2],
}

/// The first `W` of all weights.
#[inline(always)]
pub(super) fn first<const W: usize>(all: &[f64; kernel::MAX_WIDTH]) -> [f64; W] {
    std::array::from_fn(|a| all[a])
}

/// From a particle at `place` to each of the nodes of its stencil along one axis [m].
#[inline]
pub(super) fn arms<const W: usize>(first: i32, origin: f64, cell_size: f64, place: f64) -> [f64; W] {
    std::array::from_fn(|a| (origin - place) + f64::from(first + a as i32) * cell_size)
}

/// Adds `value` of 0 to W − 1 to the places from `at` on. Fixed sizes keep the loop free of checks.
#[inline(always)]
fn add<const W: usize>(values: &mut [f64], at: usize, value: impl Fn(usize) -> f64) {
    if let Some(values) = values[at..].first_chunk_mut::<W>() {
        for a in 0..W {
            values[a] += value(a);
        }
    }
}

/// The particles of one band that no crack divides. As arguments of their own the parts are known not to overlap the
/// piece, so that what is read from them need not be read again after each addition.
fn band_to_grid<const W: usize, const AFFINE: bool>(
    setup: &Setup,
    points: &Points,
    lattice: &Lattice,
    piece: &mut Piece<'_>,
) {
    let grid = &lattice.grid;
    let h = grid.cell_size;
    let mut walker = Walker::new(grid);
    for &p in lattice.particles_of_band(piece.band) {
        let p = p as usize;
        if lattice.stencils.of(p).is_some() {
            continue;
        }
        let point = &points.point[p];
        let stencil = lattice.stencil(point.position);
        // The grid has been laid for all stencils.
        let Some(rows) = walker.rows(stencil.first, W) else { continue };
        let m = setup.particles.mass[p];
        let tension = points.stress_times_volume(setup, p, point);
        let x: [f64; W] = first(&stencil.weight[0]);
        let dx: [f64; W] = first(&stencil.gradient[0]);
        let mut arm_x = [0.0; W];
        let mut affine = Matrix::zeros();
        if AFFINE {
            arm_x = arms(stencil.first[0], grid.origin.x, h, point.position.x);
            affine = points.affine[p];
        }
        let arm_y: [f64; W] = arms(stencil.first[1], grid.origin.y, h, point.position.y);
        for b in 0..W {
            let at = rows[b] - piece.start;
            let (wy, gy) = (stencil.weight[1][b], stencil.gradient[1][b]);
            let mw = m * wy;
            add::<W>(piece.mass, at, |a| mw * x[a]);
            for axis in 0..2 {
                let v = point.velocity[axis];
                if AFFINE {
                    let v = v + affine[(axis, 1)] * arm_y[b];
                    add::<W>(piece.momentum[axis], at, |a| mw * x[a] * (v + affine[(axis, 0)] * arm_x[a]));
                } else {
                    let mv = mw * v;
                    add::<W>(piece.momentum[axis], at, |a| mv * x[a]);
                }
                // f_i −= V_p0 τ_p ∇w_ip.
                let (t1, t2) = (tension[(axis, 0)] * wy, tension[(axis, 1)] * gy);
                add::<W>(piece.force[axis], at, |a: usize| -(t1 * dx[a] + t2 * x[a]));
            }
        }
    }
}

impl ToGrid<'_> {
    /// Mass, momentum and the forces of the stresses (thesis eq. 2, 5): afterwards `mass`, `before` and `after` of
    /// `nodes` hold these sums.
    pub(super) fn send(&self, nodes: &mut Nodes) {
        match kernel::width(self.lattice.kernel) {
            2 => self.all_bands::<2>(nodes),
            3 => self.all_bands::<3>(nodes),
            _ => self.all_bands::<4>(nodes),
        }
        self.divided_to_grid(nodes);
    }

    fn all_bands<const W: usize>(&self, nodes: &mut Nodes) {
        for parity in 0..2 {
            let bands = self.lattice.bands(parity);
            let ranges = || bands.clone().map(|(_, nodes)| nodes);
            let [px, py] = &mut nodes.before;
            let [fx, fy] = &mut nodes.after;
            let mut all: Vec<Piece<'_>> = pieces(&mut nodes.mass, ranges())
                .zip(pieces(px, ranges()))
                .zip(pieces(py, ranges()))
                .zip(pieces(fx, ranges()))
                .zip(pieces(fy, ranges()))
                .zip(bands.clone())
                .map(|(((((mass, px), py), fx), fy), (band, nodes))| Piece {
                    band,
                    start: nodes.start,
                    mass,
                    momentum: [px, py],
                    force: [fx, fy],
                })
                .collect();
            let Self { setup, points, lattice } = *self;
            let run = |piece: &mut Piece<'_>| match points.affine.is_empty() {
                true => band_to_grid::<W, false>(setup, points, lattice, piece),
                false => band_to_grid::<W, true>(setup, points, lattice, piece),
            };
            if self.setup.is_parallel() {
                all.par_iter_mut().for_each(run);
            } else {
                all.iter_mut().for_each(run);
            }
        }
    }

    /// The same for the particles that cracks divide.
    fn divided_to_grid(&self, nodes: &mut Nodes) {
        for (p, entries) in self.lattice.stencils.iter() {
            let point = &self.points.point[p];
            let m = self.setup.particles.mass[p];
            let tension = self.points.stress_times_volume(self.setup, p, point);
            let affine = self.points.affine.get(p);
            for e in entries {
                let d = e.field as usize;
                let v = affine.map_or(point.velocity, |c| point.velocity + c * self.lattice.arm(e, point.position));
                let force = tension * e.gradient;
                nodes.mass[d] += m * e.weight;
                for axis in 0..2 {
                    nodes.before[axis][d] += m * e.weight * v[axis];
                    nodes.after[axis][d] -= force[axis];
                }
            }
        }
    }

    /// Mean of the `velocities` of the particles at each field of the given `mass`.
    pub(super) fn mean(&self, velocities: &[Vector], mass: &[f64]) -> [Vec<f64>; 2] {
        let mut momentum = [vec![0.0; mass.len()], vec![0.0; mass.len()]];
        for parity in 0..2 {
            let bands = self.lattice.bands(parity);
            let ranges = || bands.clone().map(|(_, nodes)| nodes);
            let [px, py] = &mut momentum;
            let mut all: Vec<MomentumPiece<'_>> = pieces(px, ranges())
                .zip(pieces(py, ranges()))
                .zip(bands.clone())
                .map(|((px, py), (band, nodes))| MomentumPiece { band, start: nodes.start, momentum: [px, py] })
                .collect();
            let run = |piece: &mut MomentumPiece<'_>| self.band_momentum(velocities, piece);
            if self.setup.is_parallel() {
                all.par_iter_mut().for_each(run);
            } else {
                all.iter_mut().for_each(run);
            }
        }
        for (p, entries) in self.lattice.stencils.iter() {
            for e in entries {
                let v = velocities[p];
                let m = self.setup.particles.mass[p] * e.weight;
                momentum[0][e.field as usize] += m * v.x;
                momentum[1][e.field as usize] += m * v.y;
            }
        }
        for values in &mut momentum {
            for (v, m) in values.iter_mut().zip(mass) {
                *v = if *m > 0.0 { *v / m } else { 0.0 };
            }
        }
        momentum
    }

    fn band_momentum(&self, velocities: &[Vector], piece: &mut MomentumPiece<'_>) {
        let [px, py] = &mut piece.momentum;
        let mut walker = Walker::new(&self.lattice.grid);
        for &p in self.lattice.particles_of_band(piece.band) {
            let p = p as usize;
            if self.lattice.stencils.of(p).is_some() {
                continue;
            }
            let stencil = self.lattice.stencil(self.points.point[p].position);
            let Some(rows) = walker.rows(stencil.first, stencil.width) else { continue };
            for b in 0..stencil.width {
                let at = rows[b] - piece.start;
                for a in 0..stencil.width {
                    let v = velocities[p];
                    let mw = self.setup.particles.mass[p] * stencil.weight(a, b);
                    px[at + a] += mw * v.x;
                    py[at + a] += mw * v.y;
                }
            }
        }
    }
}
