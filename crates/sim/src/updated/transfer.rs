//! The loops between particles and grid, and nothing else.
//!
//! Particles go to the grid by bands of rows of nodes. A band and the one its particles reach above it lie in one piece of memory, and the pieces of
//! every other band do not touch: all even bands at once, then all odd ones. The order of additions at a node is
//! then the same for any number of threads.

mod light;

use super::stencils::{Cut, Nodes, PARALLEL_PARTICLES};
use super::{MaterialPoint, Motion, PlasticPart, Updated};
use crate::SimulationError;
use crate::boundary::collider::PlacedObstacle;
use crate::boundary::supports::prescribed;
use crate::grid::entries::Entry;
use crate::grid::kernel;
use crate::grid::{BAND, Walker, pieces};
use crate::threads::prelude::*;
use fissure_scene::{Kernel, Matrix, Point, Transfer, Vector};
use std::ops::Range;

/// Particles that one task takes on the way back from the grid.
const CHUNK: usize = 1024;

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
    affine: Matrix,
    /// The beginning's velocity, sent to the grid and back once more [m/s] (Hammerquist & Nairn 2017).
    smoothed: Vector,
}

impl Gathered {
    /// What the particle does in a step of `time_step` [s].
    pub(super) fn motion(&self, time_step: f64) -> Motion {
        Motion { acceleration: (self.velocity - self.before) / time_step, velocity_gradient: self.gradient }
    }
}

/// What a step needs of the grid for each particle, besides velocity and its gradient.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Wanted {
    before: bool,
    affine: bool,
    smoothed: bool,
}

impl Wanted {
    fn of(transfer: Transfer, kernel: Kernel) -> Self {
        Self {
            before: matches!(transfer, Transfer::Flip(_) | Transfer::Xpic),
            affine: transfer == Transfer::Apic && kernel != Kernel::Bilinear,
            smoothed: transfer == Transfer::Xpic,
        }
    }
}

/// Affine weights (x_i − x_p) w / D along one axis [1/m], with D = Σ w (x_i − x_p)², which is zero for no kernel but the bilinear one.
#[inline]
fn affine_weights<const W: usize>(arm: &[f64; W], weight: &[f64]) -> [f64; W] {
    let mut d = 0.0;
    for a in 0..W {
        d += weight[a] * arm[a] * arm[a];
    }
    std::array::from_fn(|a| weight[a] * arm[a] / d)
}

/// The first `W` of all weights.
#[inline(always)]
fn first<const W: usize>(all: &[f64; kernel::MAX_WIDTH]) -> [f64; W] {
    std::array::from_fn(|a| all[a])
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

#[inline]
fn arms<const W: usize>(first: i32, origin: f64, cell_size: f64, place: f64) -> [f64; W] {
    std::array::from_fn(|a| (origin - place) + f64::from(first + a as i32) * cell_size)
}

/// A task on the way back from the grid.
struct Task<'a> {
    first: usize,
    points: &'a mut [MaterialPoint],
    affine: &'a mut [Matrix],
    plastic: &'a mut [PlasticPart],
    motion: &'a mut [Motion],
}

/// What a task reports.
#[derive(Debug, Default)]
struct Report {
    /// Work of colliders on particles [J/m].
    work: f64,
    failure: Option<(usize, Failure)>,
}

#[derive(Debug, Clone, Copy)]
enum Failure {
    NotFinite,
    Inverted(f64),
    TooFast(f64),
}

impl Updated {
    /// Mass, momentum and the forces of the stresses (thesis eq. 2, 5): afterwards `mass`, `before` and `after` hold these sums.
    pub(super) fn particles_to_grid(&mut self) {
        let mut nodes = std::mem::take(&mut self.nodes);
        match kernel::width(self.settings.kernel) {
            2 => self.all_bands::<2>(&mut nodes),
            3 => self.all_bands::<3>(&mut nodes),
            _ => self.all_bands::<4>(&mut nodes),
        }
        self.cut_to_grid(&mut nodes);
        self.nodes = nodes;
    }

    fn is_parallel(&self) -> bool {
        self.particles.len() >= PARALLEL_PARTICLES && crate::threads::current_num_threads() > 1
    }

    /// Every other band, with the nodes that its particles reach: none shares a node with another.
    fn bands(&self, parity: usize) -> impl Iterator<Item = (usize, Range<usize>)> + Clone {
        let bands = (0..self.grid.bands()).filter(move |&band| self.grid.band(band).rem_euclid(2) as usize == parity);
        bands.map(|band| (band, self.grid.nodes_reached_from(band)))
    }

    /// The particles whose lowest nodes are in a band, row by row.
    fn particles_of_band(&self, band: usize) -> &[u32] {
        let rows = &self.order.first;
        &self.order.particles[rows[band * BAND] as usize..rows[(band + 1) * BAND] as usize]
    }

    fn all_bands<const W: usize>(&self, nodes: &mut Nodes) {
        for parity in 0..2 {
            let bands = self.bands(parity);
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
            let run = |piece: &mut Piece<'_>| match self.state.affine.is_empty() {
                true => self.band_to_grid::<W, false>(piece),
                false => self.band_to_grid::<W, true>(piece),
            };
            if self.is_parallel() {
                all.par_iter_mut().for_each(run);
            } else {
                all.iter_mut().for_each(run);
            }
        }
    }

    fn band_to_grid<const W: usize, const AFFINE: bool>(&self, piece: &mut Piece<'_>) {
        let grid = &self.grid;
        let h = grid.cell_size;
        let mut walker = Walker::new(grid);
        for &p in self.particles_of_band(piece.band) {
            let p = p as usize;
            if self.cut.stencils.of(p).is_some() {
                continue;
            }
            let point = &self.state.points[p];
            let stencil = self.stencil(point.position);
            // The grid has been laid for all stencils.
            let Some(rows) = walker.rows(stencil.first, W) else { continue };
            let m = self.particles.mass[p];
            let tension = self.stress_times_volume(p, point);
            let x: [f64; W] = first(&stencil.weight[0]);
            let dx: [f64; W] = first(&stencil.gradient[0]);
            let mut arm_x = [0.0; W];
            let mut affine = Matrix::zeros();
            if AFFINE {
                arm_x = arms(stencil.first[0], grid.origin.x, h, point.position.x);
                affine = self.state.affine[p];
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

    /// V_p0 τ_p [N], which equals V_p σ_p.
    #[inline]
    fn stress_times_volume(&self, p: usize, point: &MaterialPoint) -> Matrix {
        let (mu, lambda) = self.moduli(p);
        crate::kirchhoff_stress(&point.elastic_gradient, mu, lambda) * self.particles.volume[p]
    }

    /// The same for the particles that cracks divide.
    fn cut_to_grid(&self, nodes: &mut Nodes) {
        for (p, entries) in self.cut.stencils.iter() {
            let point = &self.state.points[p];
            let m = self.particles.mass[p];
            let tension = self.stress_times_volume(p, point);
            let affine = self.state.affine.get(p);
            for e in entries {
                let d = e.field as usize;
                let v = affine.map_or(point.velocity, |c| point.velocity + c * self.arm(e, point.position));
                let force = tension * e.gradient;
                nodes.mass[d] += m * e.weight;
                for axis in 0..2 {
                    nodes.before[axis][d] += m * e.weight * v[axis];
                    nodes.after[axis][d] -= force[axis];
                }
            }
        }
    }

    /// v = p/m at the beginning, v + Δt f/m at the end (thesis eq. 6), with gravity and damping.
    pub(super) fn update_grid_velocities(&mut self, time_step: f64) {
        self.relieve_light_fields();
        let decay = (-self.settings.damping * time_step).exp();
        let gravity = self.scene.gravity * time_step;
        let nodes = &mut self.nodes;
        for axis in 0..2 {
            let (before, after) = (&mut nodes.before[axis], &mut nodes.after[axis]);
            for ((m, v), f) in nodes.mass.iter().zip(before.iter_mut()).zip(after.iter_mut()) {
                if *m > 0.0 {
                    *v /= m;
                    *f = *v * decay + time_step * *f / m + gravity[axis];
                }
            }
        }
        if self.settings.transfer == Transfer::Xpic {
            self.smooth_velocities();
        }
    }

    /// S⁺ S v: the beginning's velocities, sent to the particles and back.
    fn smooth_velocities(&mut self) {
        let wanted = Wanted { before: true, affine: false, smoothed: false };
        let velocities = self.for_particles(|walker, p| self.gather_any(walker, p, wanted).before);
        self.nodes.smoothed = self.mean_on_grid(&velocities);
    }

    /// What `value` gives for each particle.
    fn for_particles<T: Send>(&self, value: impl Fn(&mut Walker<'_>, usize) -> T + Send + Sync) -> Vec<T> {
        let particles = 0..self.particles.len();
        if self.is_parallel() {
            particles.into_par_iter().map_init(|| Walker::new(&self.grid), value).collect()
        } else {
            let mut walker = Walker::new(&self.grid);
            particles.map(|p| value(&mut walker, p)).collect()
        }
    }

    /// Mean of the `velocities` of the particles at each field.
    fn mean_on_grid(&self, velocities: &[Vector]) -> [Vec<f64>; 2] {
        let mut momentum = [vec![0.0; self.nodes.mass.len()], vec![0.0; self.nodes.mass.len()]];
        for parity in 0..2 {
            let bands = self.bands(parity);
            let ranges = || bands.clone().map(|(_, nodes)| nodes);
            let [px, py] = &mut momentum;
            let mut all: Vec<MomentumPiece<'_>> = pieces(px, ranges())
                .zip(pieces(py, ranges()))
                .zip(bands.clone())
                .map(|((px, py), (band, nodes))| MomentumPiece { band, start: nodes.start, momentum: [px, py] })
                .collect();
            let to_band = |piece: &mut MomentumPiece<'_>| {
                let [px, py] = &mut piece.momentum;
                let mut walker = Walker::new(&self.grid);
                for &p in self.particles_of_band(piece.band) {
                    let p = p as usize;
                    if self.cut.stencils.of(p).is_some() {
                        continue;
                    }
                    let stencil = self.stencil(self.state.points[p].position);
                    let Some(rows) = walker.rows(stencil.first, stencil.width) else { continue };
                    for b in 0..stencil.width {
                        let at = rows[b] - piece.start;
                        for a in 0..stencil.width {
                            let v = velocities[p];
                            let mw = self.particles.mass[p] * stencil.weight(a, b);
                            px[at + a] += mw * v.x;
                            py[at + a] += mw * v.y;
                        }
                    }
                }
            };
            if self.is_parallel() {
                all.par_iter_mut().for_each(to_band);
            } else {
                all.iter_mut().for_each(to_band);
            }
        }
        for (p, entries) in self.cut.stencils.iter() {
            for e in entries {
                let v = velocities[p];
                let m = self.particles.mass[p] * e.weight;
                momentum[0][e.field as usize] += m * v.x;
                momentum[1][e.field as usize] += m * v.y;
            }
        }
        for values in &mut momentum {
            for (v, m) in values.iter_mut().zip(&self.nodes.mass) {
                *v = if *m > 0.0 { *v / m } else { 0.0 };
            }
        }
        momentum
    }

    /// Velocities for the strains of the bilinear kernel: the particles' new ones, sent to the grid once more (Sulsky, Zhou & Schreyer 1995).
    ///
    /// A particle that has just entered a cell reaches its far nodes with a weight w → 0 but a gradient of 1/h, so that their velocity f Δt/m
    /// grows as 1/w and would turn the particle inside out. Wider kernels have gradients that vanish with the weight.
    fn remap_velocities(&mut self, time: f64, time_step: f64) {
        let wanted = Wanted::of(self.settings.transfer, self.settings.kernel);
        let obstacles: Vec<PlacedObstacle<'_>> = self.colliders.iter().map(|c| c.at(time + 0.5 * time_step)).collect();
        let mut velocities = self.for_particles(|walker, p| {
            let g = self.gather_any(walker, p, wanted);
            let point = &self.state.points[p];
            let v = self.transferred(point.velocity, &g);
            obstacles.iter().fold(v, |v, o| o.resolve(v, point.position))
        });
        for (support, particles) in self.scene.supports.iter().zip(&self.held) {
            let prescribed = prescribed(support, time + 0.5 * time_step);
            for &p in particles {
                for held in prescribed.clone() {
                    velocities[p as usize][held.axis] = held.velocity();
                }
            }
        }
        self.nodes.remapped = self.mean_on_grid(&velocities);
    }

    /// New velocity of a particle of velocity `v` by the transfer of the scene.
    #[inline]
    fn transferred(&self, v: Vector, g: &Gathered) -> Vector {
        match self.settings.transfer {
            Transfer::Pic | Transfer::Apic => g.velocity,
            Transfer::Flip(blend) => (v + g.velocity - g.before) * blend + g.velocity * (1.0 - blend),
            // v − (I − S S⁺)² v + S a Δt.
            Transfer::Xpic => g.before * 2.0 - g.smoothed + g.velocity - g.before,
        }
    }

    /// Calls `visit` with (field, weight) for every entry of the stencil of a particle.
    pub(super) fn for_each_entry(&self, particle: usize, mut visit: impl FnMut(usize, f64)) {
        if let Some(entries) = self.cut.stencils.of(particle) {
            for e in entries {
                visit(e.field as usize, e.weight);
            }
            return;
        }
        let stencil = self.stencil(self.state.points[particle].position);
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

    /// What the particle gathers at its place at the beginning of the step.
    pub(super) fn gather_at_particle(&self, particle: usize) -> Gathered {
        let wanted = Wanted { before: true, affine: false, smoothed: false };
        self.gather_any(&mut Walker::new(&self.grid), particle, wanted)
    }

    fn gather_any(&self, walker: &mut Walker<'_>, particle: usize, wanted: Wanted) -> Gathered {
        let point = &self.state.points[particle];
        match kernel::width(self.settings.kernel) {
            2 => self.gather::<2>(walker, &self.cut, particle, point, wanted),
            3 => self.gather::<3>(walker, &self.cut, particle, point, wanted),
            _ => self.gather::<4>(walker, &self.cut, particle, point, wanted),
        }
    }

    #[inline(always)]
    fn gather<const W: usize>(
        &self,
        walker: &mut Walker<'_>,
        cut: &Cut,
        particle: usize,
        point: &MaterialPoint,
        wanted: Wanted,
    ) -> Gathered {
        let grid = &self.grid;
        let h = grid.cell_size;
        let nodes = &self.nodes;
        let stencil = self.stencil(point.position);
        let arm_x: [f64; W] = arms(stencil.first[0], grid.origin.x, h, point.position.x);
        let arm_y: [f64; W] = arms(stencil.first[1], grid.origin.y, h, point.position.y);
        if let Some(entries) = cut.stencils.of(particle) {
            return self.gather_entries::<W>(entries, point.position, &stencil, wanted, [arm_x, arm_y]);
        }
        let mut g = Gathered::default();
        let x: [f64; W] = first(&stencil.weight[0]);
        let dx: [f64; W] = first(&stencil.gradient[0]);
        let (ax, ay) = if wanted.affine {
            (affine_weights(&arm_x, &stencil.weight[0]), affine_weights(&arm_y, &stencil.weight[1]))
        } else {
            ([0.0; W], [0.0; W])
        };
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
                    g.affine[(axis, 0)] += wy * along(&nodes.after[axis], at, &ax);
                    g.affine[(axis, 1)] += ay[b] * v;
                }
                if wanted.smoothed {
                    g.smoothed[axis] += wy * along(&nodes.smoothed[axis], at, &x);
                }
            }
        }
        g
    }

    /// From a particle at `place` to the node of an entry [m].
    fn arm(&self, entry: &Entry, place: Point) -> Vector {
        self.grid.position(self.cut.fields.node(entry.field as usize)) - place
    }

    fn gather_entries<const W: usize>(
        &self,
        entries: &[Entry],
        place: Point,
        stencil: &kernel::Stencil,
        wanted: Wanted,
        arms: [[f64; W]; 2],
    ) -> Gathered {
        let nodes = &self.nodes;
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
                g.affine += v * self.arm(e, place).transpose() * e.weight;
            }
            if wanted.smoothed {
                g.smoothed += Vector::new(nodes.smoothed[0][d], nodes.smoothed[1][d]) * e.weight;
            }
        }
        if wanted.affine {
            for axis in 0..2 {
                g.affine.column_mut(axis).unscale_mut(spread[axis]);
            }
        }
        g
    }

    /// Deformation, velocity, collision and advection of all particles (thesis 3.1.5 and 3.1.6).
    ///
    /// # Errors
    /// When a particle is no longer finite, is turned inside out, or moves by more than a cell.
    pub(super) fn grid_to_particles(&mut self, time: f64, time_step: f64) -> Result<(), SimulationError> {
        if self.settings.kernel == Kernel::Bilinear {
            self.remap_velocities(time, time_step);
        }
        let mut points = std::mem::take(&mut self.state.points);
        let mut affine = std::mem::take(&mut self.state.affine);
        let mut plastic = std::mem::take(&mut self.state.plastic);
        let mut motion = std::mem::take(&mut self.motion);
        motion.resize(if self.has_cracks() { points.len() } else { 0 }, Motion::default());
        let held_places = self.held_places(&points);
        let all =
            Task { first: 0, points: &mut points, affine: &mut affine, plastic: &mut plastic, motion: &mut motion };
        let result = match self.settings.kernel {
            Kernel::Bilinear => self.all_tasks::<2>(all, time, time_step),
            Kernel::Gimp | Kernel::Quadratic => self.all_tasks::<3>(all, time, time_step),
            Kernel::Cubic => self.all_tasks::<4>(all, time, time_step),
        };
        (self.state.points, self.state.affine, self.state.plastic) = (points, affine, plastic);
        self.motion = motion;
        self.hold_particles(&held_places, time, time_step);
        match result.failure {
            None => {
                self.state.external_work += result.work;
                Ok(())
            }
            Some((particle, failure)) => Err(self.failed(particle, failure, time + time_step)),
        }
    }

    fn failed(&self, particle: usize, failure: Failure, time: f64) -> SimulationError {
        let place = self.state.points[particle].position;
        let cause = match failure {
            Failure::NotFinite => {
                format!("particle {particle} has lost its finite state; use a smaller `solver.courant` or weaker loads")
            }
            Failure::Inverted(ratio) => format!(
                "particle {particle} is turned inside out (volume ratio {ratio:.2}); use a smaller `solver.courant`, weaker loads, or \
                 a finer `grid.particle_spacing`"
            ),
            Failure::TooFast(cells) => format!(
                "particle {particle} moves by {cells:.2} cells in a step; use a smaller `solver.courant` or `solver.time_step`"
            ),
        };
        SimulationError::Unstable { time, x: place.x, y: place.y, cause }
    }

    /// Cuts what all particles carry into tasks and runs them.
    fn all_tasks<const W: usize>(&self, all: Task<'_>, time: f64, time_step: f64) -> Report {
        let mut affine = all.affine.chunks_mut(CHUNK);
        let mut plastic = all.plastic.chunks_mut(CHUNK);
        let mut motion = all.motion.chunks_mut(CHUNK);
        let cut = |(k, points)| Task {
            first: k * CHUNK,
            points,
            affine: affine.next().unwrap_or_default(),
            plastic: plastic.next().unwrap_or_default(),
            motion: motion.next().unwrap_or_default(),
        };
        let tasks: Vec<Task<'_>> = all.points.chunks_mut(CHUNK).enumerate().map(cut).collect();
        let obstacles: Vec<PlacedObstacle<'_>> = self.colliders.iter().map(|c| c.at(time + 0.5 * time_step)).collect();
        let run = |task: Task<'_>| self.task::<W>(task, &obstacles, time_step);
        let reports: Vec<Report> = if self.is_parallel() {
            tasks.into_par_iter().map(run).collect()
        } else {
            tasks.into_iter().map(run).collect()
        };
        let mut total = Report::default();
        for report in reports {
            total.work += report.work;
            total.failure = total.failure.or(report.failure);
        }
        total
    }

    fn task<const W: usize>(&self, task: Task<'_>, obstacles: &[PlacedObstacle<'_>], time_step: f64) -> Report {
        let mut walker = Walker::new(&self.grid);
        let mut wanted = Wanted::of(self.settings.transfer, self.settings.kernel);
        wanted.before |= !task.motion.is_empty();
        let farthest = self.grid.cell_size * self.grid.cell_size;
        let mut report = Report::default();
        for (k, point) in task.points.iter_mut().enumerate() {
            let p = task.first + k;
            let g = self.gather::<W>(&mut walker, &self.cut, p, point, wanted);
            if let Some(motion) = task.motion.get_mut(k) {
                *motion = g.motion(time_step);
            }
            // F_E* = (I + Δt ∇v) F_E, eq. 13.
            let h = point.elastic_gradient;
            point.elastic_gradient = h + (g.gradient + g.gradient * h) * time_step;
            if let Some(part) = task.plastic.get_mut(k)
                && let Some(law) = &self.scene.materials[self.particles.material[p] as usize].plasticity
            {
                point.elastic_gradient = part.flow(point.elastic_gradient, law);
            }
            if let Some(c) = task.affine.get_mut(k) {
                // The affine weights of the bilinear kernel are its gradients.
                *c = if W == 2 { g.gradient } else { g.affine };
            }
            point.velocity = self.transferred(point.velocity, &g);
            let mut advection = g.velocity;
            for obstacle in obstacles {
                let before = point.velocity;
                point.velocity = obstacle.resolve(before, point.position);
                if point.velocity != before {
                    let impulse = (point.velocity - before) * self.particles.mass[p];
                    report.work += impulse.dot(&obstacle.velocity(point.position));
                }
                advection = obstacle.resolve(advection, point.position);
            }
            let motion = advection * time_step;
            point.position += motion;
            let ratio = 1.0 + crate::volume_change(&point.elastic_gradient);
            if !(ratio > 0.0 && motion.norm_squared() < farthest) && report.failure.is_none() {
                let finite = ratio.is_finite() && motion.norm_squared().is_finite();
                let failure = match finite {
                    false => Failure::NotFinite,
                    true if ratio <= 0.0 => Failure::Inverted(ratio),
                    true => Failure::TooFast(motion.norm() / self.grid.cell_size),
                };
                report.failure = Some((p, failure));
            }
        }
        report
    }
}
