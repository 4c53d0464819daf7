//! What a particle gathers from the grid at its place.

use super::lattice::Lattice;
use super::nodes::Nodes;
use super::particles_to_grid::{arms, first};
use super::points::{MaterialPoint, Motion};
use super::setup::Setup;
use crate::grid::entries::Entry;
use crate::grid::kernel::{self, Stencil};
use crate::grid::walker::Walker;
use crate::threads::prelude::*;
use fissure_scene::{Kernel, Matrix, Transfer, Vector};

/// What a particle gathers from the grid.
#[derive(Debug, Clone, Copy, Default)]
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
    smoothed: Vector,
    /// What the particle's velocity gains [m/s], with [`Transfer::Aflip`].
    gain: Vector,
}

impl Gathered {
    /// What the particle does in a step of `time_step` [s].
    pub(super) fn motion(&self, time_step: f64) -> Motion {
        Motion { acceleration: (self.velocity - self.before) / time_step, velocity_gradient: self.gradient }
    }

    /// New velocity of a particle of velocity `v` by a transfer.
    #[inline]
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
    affine: bool,
    smoothed: bool,
    gain: bool,
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

/// Affine weights (x_i − x_p) w / D along one axis [1/m], with D = Σ w (x_i − x_p)², which is zero for no kernel but
/// the bilinear one.
#[inline]
fn affine_weights<const W: usize>(arm: &[f64; W], weight: &[f64]) -> [f64; W] {
    let mut d = 0.0;
    for a in 0..W {
        d += weight[a] * arm[a] * arm[a];
    }
    std::array::from_fn(|a| weight[a] * arm[a] / d)
}

/// Σ `values` times `weights` over the places from `at` on.
#[inline(always)]
fn along<const W: usize>(values: &[f64], at: usize, weights: &[f64; W]) -> f64 {
    let mut sum = 0.0;
    if let Some(values) = values[at..].first_chunk::<W>() {
        for a in 0..W {
            sum += values[a] * weights[a];
        }
    }
    sum
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
            2 => self.gather::<2>(walker, particle, point, wanted),
            3 => self.gather::<3>(walker, particle, point, wanted),
            _ => self.gather::<4>(walker, particle, point, wanted),
        }
    }

    /// What a particle gathers by a kernel that reaches `W` nodes per axis.
    #[inline(always)]
    pub(super) fn gather<const W: usize>(
        &self,
        walker: &mut Walker<'_>,
        particle: usize,
        point: &MaterialPoint,
        wanted: Wanted,
    ) -> Gathered {
        let grid = &self.lattice.grid;
        let h = grid.cell_size;
        let nodes = self.nodes;
        let stencil = self.lattice.stencil(point.position);
        let arm_x: [f64; W] = arms(stencil.first[0], grid.origin.x, h, point.position.x);
        let arm_y: [f64; W] = arms(stencil.first[1], grid.origin.y, h, point.position.y);
        if let Some(entries) = self.lattice.stencils.of(particle) {
            return self.gather_divided::<W>(entries, point, &stencil, wanted, [arm_x, arm_y]);
        }
        let mut g = Gathered::default();
        let x: [f64; W] = first(&stencil.weight[0]);
        let dx: [f64; W] = first(&stencil.gradient[0]);
        let (ax, ay) = match wanted.affine {
            // The affine weights of the bilinear kernel are its gradients.
            true if W == 2 => (dx, first(&stencil.gradient[1])),
            true => (affine_weights(&arm_x, &stencil.weight[0]), affine_weights(&arm_y, &stencil.weight[1])),
            false => ([0.0; W], [0.0; W]),
        };
        let turning = if wanted.gain { &nodes.gain } else { &nodes.after };
        // The grid has been laid for all stencils.
        let rows = walker.rows(stencil.first, W).unwrap_or_default();
        for b in 0..W {
            let at = rows[b];
            let (wy, gy) = (stencil.weight[1][b], stencil.gradient[1][b]);
            for axis in 0..2 {
                let v = along(&nodes.after[axis], at, &x);
                g.velocity[axis] += wy * v;
                let strain = if W == 2 && !nodes.remapped[axis].is_empty() { &nodes.remapped } else { &nodes.after };
                g.gradient[(axis, 0)] += wy * along(&strain[axis], at, &dx);
                g.gradient[(axis, 1)] += gy * if W == 2 { along(&strain[axis], at, &x) } else { v };
                if wanted.before {
                    g.before[axis] += wy * along(&nodes.before[axis], at, &x);
                }
                if wanted.affine {
                    let t = if wanted.gain { along(&nodes.gain[axis], at, &x) } else { v };
                    g.gain[axis] += wy * t;
                    g.affine[(axis, 0)] += wy * along(&turning[axis], at, &ax);
                    g.affine[(axis, 1)] += ay[b] * t;
                }
                if wanted.smoothed {
                    g.smoothed[axis] += wy * along(&nodes.smoothed[axis], at, &x);
                }
            }
        }
        g
    }

    /// The same for a particle that cracks divide.
    fn gather_divided<const W: usize>(
        &self,
        entries: &[Entry],
        point: &MaterialPoint,
        stencil: &Stencil,
        wanted: Wanted,
        arms: [[f64; W]; 2],
    ) -> Gathered {
        let nodes = self.nodes;
        let mut g = Gathered::default();
        let mut spread = Vector::zeros();
        for axis in 0..2 {
            for a in 0..W {
                spread[axis] += stencil.weight[axis][a] * arms[axis][a] * arms[axis][a];
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
