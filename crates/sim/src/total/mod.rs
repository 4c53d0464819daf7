//! Total Lagrangian Material Point Method: kernels live on the reference lattice, are computed once, and change only where a crack grows.
//!
//! De Vaucorbeil, Nguyen & Hutchinson 2020. Nodes keep displacement and velocity from step to step, so nothing is lost in transfers:
//! P = ∂Ψ/∂F, H = F − I = Σ_i u_i ⊗ ∇₀w_ip, f_i = −Σ_p V_p P_p ∇₀w_ip, then v += Δt f/m and u += Δt v (symplectic Euler, the
//! leapfrog). Rotation and finite stretch are exact; extreme distortion and plastic flow are out of range.

mod boundary;
mod contact;
mod cut;
mod look;
mod recut;
mod refresh;
mod rows;
#[cfg(test)]
mod tests;
mod tie;

use crate::SimulationError;
use crate::collider::Obstacle;
use crate::crack::{Crack, slot};
use crate::crossing::Side;
use crate::division::{CrackLine, Division, TipCut};
use crate::elastic::Elastic;
use crate::fields::Fields;
use crate::grid::Grid;
use crate::kernel;
use crate::particles::Particles;
use crate::solver::{Handover, Observed, Release, Solver, SolverEnergies};
use boundary::{Constraint, PointForce};
use contact::ContactPair;
use cut::{CutParticles, Probe};
use fissure_scene::{
    CrackEnd, CrackFrame, End, Kernel, Matrix, OutlineFrame, ParticleFrame, Point, Scene, SolverSettings, TipDivision,
    Vector,
};
use rows::{NodeRows, RowConstants, Run};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use tie::{Ties, TipKey, key};

/// A vector at every field, x and y apart.
type FieldVectors = [Vec<f64>; 2];

/// The state that cannot be laid anew from the scene and the cracks.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct State {
    /// Fields at nodes.
    fields: Fields,
    /// Mass of each field [kg/m].
    mass: Vec<f64>,
    /// Displacement u [m].
    displacement: FieldVectors,
    /// Velocity v at half steps [m/s].
    velocity: FieldVectors,
    /// Particles on the general path with their stencils.
    cut: CutParticles,
    /// Runs of uncut cells in each row of cells.
    runs: Vec<Vec<Run>>,
    /// The rings as probes, doubled at mouths.
    outlines: Vec<Vec<Probe>>,
    /// Faces of the cracks, above and below.
    faces: Vec<[Vec<Probe>; 2]>,
    /// Work done by loads, supports and colliders so far [J/m].
    external_work: f64,
    /// What holds the sides of nodes at tips together.
    ties: Ties,
    /// Where each tip was when nodes were last split for it. It has slid on since, within its increment; what is cut anew for other cracks is cut for it as it
    /// was, or nodes at the edge of what is cut anew would be split by halves.
    cut_at: BTreeMap<TipKey, Point>,
    /// Velocities and displacements belong to the same moment: the next kick takes half a step, after which velocities are half a step ahead. A
    /// whole kick here would more than double the amplitude of the shortest waves.
    in_step: bool,
    /// Length of the last step [s].
    last_step: f64,
}

/// The total Lagrangian solver.
#[derive(Debug)]
pub(crate) struct Total {
    scene: Scene,
    settings: SolverSettings,
    elastic: Vec<Elastic>,
    particles: Particles,
    /// Particle at each place of the particle lattice.
    lattice: ParticleLattice,
    grid: Grid,
    division: Division,
    colliders: Vec<Obstacle>,
    state: State,
    // What follows is made from the state.
    inverse_mass: Vec<f64>,
    acceleration: FieldVectors,
    force: FieldVectors,
    loads: Vec<Vec<PointForce>>,
    constraints: Vec<Constraint>,
    contacts: Vec<ContactPair>,
    surface: Vec<boundary::SurfaceNode>,
    steps_since_check: u32,
}

/// Which particle stands where on the particle lattice.
#[derive(Debug)]
struct ParticleLattice {
    first: [i32; 2],
    columns: i32,
    rows: i32,
    particle: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl ParticleLattice {
    fn new(particles: &Particles) -> Self {
        let low = particles.place.iter().fold([i32::MAX; 2], |a, p| [a[0].min(p[0]), a[1].min(p[1])]);
        let high = particles.place.iter().fold([i32::MIN; 2], |a, p| [a[0].max(p[0]), a[1].max(p[1])]);
        let (columns, rows) = (high[0] - low[0] + 1, high[1] - low[1] + 1);
        let mut particle = vec![NONE; (columns as usize) * (rows as usize)];
        for (p, place) in particles.place.iter().enumerate() {
            particle[((place[1] - low[1]) * columns + place[0] - low[0]) as usize] = p as u32;
        }
        Self { first: low, columns, rows, particle }
    }

    fn at(&self, i: i32, j: i32) -> Option<usize> {
        let (i, j) = (i - self.first[0], j - self.first[1]);
        if i < 0 || j < 0 || i >= self.columns || j >= self.rows {
            return None;
        }
        Some(self.particle[(j * self.columns + i) as usize]).filter(|&p| p != NONE).map(|p| p as usize)
    }
}

impl Total {
    /// Lays the lattice and cuts it by the initial cracks.
    pub(crate) fn new(scene: &Scene, particles: Particles, cracks: &[Crack]) -> Result<Self, SimulationError> {
        let (mut low, mut high) = fissure_scene::bounds(&[]);
        for body in &scene.bodies {
            let (l, h) = body.region.bounds();
            (low, high) = (low.inf(&l), high.sup(&h));
        }
        // The wider kernels reach one node beyond the cell.
        let margin = if kernel::width(scene.solver.kernel) == 2 { 0 } else { 1 };
        let grid = Grid::around(particles.anchor, low, high, scene.cell_size, margin);
        let elastic = scene.materials.iter().map(|m| Elastic::new(m, scene.plane)).collect();
        let lattice = ParticleLattice::new(&particles);
        let zeros = || [vec![0.0; grid.len()], vec![0.0; grid.len()]];
        let state = State {
            fields: Fields::new(grid.len()),
            mass: vec![0.0; grid.len()],
            displacement: zeros(),
            velocity: zeros(),
            cut: CutParticles::new(particles.len()),
            runs: vec![Vec::new(); grid.rows - 1],
            outlines: Vec::new(),
            faces: Vec::new(),
            external_work: 0.0,
            ties: Ties::default(),
            cut_at: BTreeMap::new(),
            in_step: true,
            last_step: 0.0,
        };
        let mut solver = Self {
            scene: scene.clone(),
            settings: scene.solver,
            elastic,
            lattice,
            grid,
            division: Self::division_of(scene, cracks, &BTreeMap::new()),
            colliders: scene.colliders.iter().map(Obstacle::new).collect(),
            state,
            inverse_mass: Vec::new(),
            acceleration: zeros(),
            force: zeros(),
            loads: Vec::new(),
            constraints: Vec::new(),
            contacts: Vec::new(),
            surface: Vec::new(),
            particles,
            steps_since_check: 0,
        };
        solver.cut_all();
        solver.lay_probes(cracks);
        solver.set_initial_velocities();
        solver.lay_ties(cracks);
        solver.refresh(cracks)?;
        Ok(solver)
    }

    /// Goes on from a saved state.
    ///
    /// # Errors
    /// When the state is not one of this scene.
    pub(crate) fn restore(
        scene: &Scene,
        particles: Particles,
        cracks: &[Crack],
        state: &[u8],
    ) -> Result<Self, SimulationError> {
        let mut solver = Self::new(scene, particles, cracks)?;
        solver.state = crate::saved::from_bytes(state)?;
        solver.division = Self::division_of(scene, cracks, &solver.state.cut_at);
        solver.refresh(cracks)?;
        Ok(solver)
    }

    fn division_of(scene: &Scene, cracks: &[Crack], cut_at: &BTreeMap<TipKey, Point>) -> Division {
        // A line from a particle inside the body to a node outside may pass a mouth by as much as the kernel reaches.
        let reach = 0.5 * kernel::width(scene.solver.kernel) as f64;
        let beyond = 2.0 * reach * scene.cell_size;
        let points = |i: usize, c: &Crack| {
            let mut points = c.points.clone();
            let last = points.len() - 1;
            for (end, at) in [(End::Start, 0), (End::End, last)] {
                if let (CrackEnd::Tip, Some(&place)) = (c.ends[slot(end)], cut_at.get(&key(i, end))) {
                    points[at] = place;
                }
            }
            points
        };
        let lines: Vec<CrackLine> = cracks.iter().enumerate().map(|(i, c)| c.line(i, points(i, c), beyond)).collect();
        let cut = TipCut::tied(tie::split_ahead(scene.growth.increment));
        Division::new(&lines, scene.solver.tip_division, cut, scene.cell_size, scene.particle_spacing, reach)
    }

    /// Calls `visit` with every particle in a box, which may be a row larger, row by row.
    fn for_each_particle_in(&self, low: Point, high: Point, mut visit: impl FnMut(usize)) {
        let s = self.particles.spacing;
        let first = ((low - self.particles.anchor) / s).map(|t| t.floor() as i32);
        let last = ((high - self.particles.anchor) / s).map(|t| t.ceil() as i32);
        for j in first.y..=last.y {
            for i in first.x..=last.x {
                if let Some(p) = self.lattice.at(i, j) {
                    visit(p);
                }
            }
        }
    }

    /// Whether uncut cells can go as rows.
    fn has_rows(&self) -> bool {
        self.settings.kernel == Kernel::Bilinear
            && (self.scene.cell_size - 2.0 * self.particles.spacing).abs() < 1e-12 * self.scene.cell_size
    }

    /// Displacement gradient H = F − I of a particle.
    fn strain_of(&self, particle: usize) -> Matrix {
        self.gradient(particle, &self.state.displacement) + self.state.cut.misfit_of(particle)
    }

    /// Gradient at a particle of field values `u`.
    fn gradient(&self, particle: usize, u: &FieldVectors) -> Matrix {
        let mut h = Matrix::zeros();
        self.for_each_entry(particle, |field, _, g| {
            let v = [u[0][field], u[1][field]];
            h.m11 += v[0] * g.x;
            h.m12 += v[0] * g.y;
            h.m21 += v[1] * g.x;
            h.m22 += v[1] * g.y;
        });
        h
    }

    /// Value of a field vector at a particle.
    fn value(&self, particle: usize, u: &FieldVectors) -> Vector {
        let mut value = Vector::zeros();
        self.for_each_entry(particle, |field, w, _| value += Vector::new(u[0][field], u[1][field]) * w);
        value
    }

    /// Calls `visit` with (field, weight, gradient) for every entry of the stencil of a particle.
    fn for_each_entry(&self, particle: usize, mut visit: impl FnMut(usize, f64, Vector)) {
        if let Some(entries) = self.state.cut.entries_of(particle) {
            for e in entries {
                visit(e.field as usize, e.weight, Vector::new(e.gradient[0], e.gradient[1]));
            }
        } else {
            let stencil = self.stencil(self.particles.rest[particle]);
            for b in 0..stencil.width {
                for a in 0..stencil.width {
                    visit(self.stencil_node(&stencil, a, b), stencil.weight(a, b), stencil.weight_gradient(a, b));
                }
            }
        }
    }

    fn stencil(&self, place: Point) -> kernel::Stencil {
        let x = self.grid.in_cells(place);
        let half_size = 0.5 * self.particles.spacing / self.grid.cell_size;
        kernel::Stencil::new(self.settings.kernel, half_size, [x.x, x.y], 1.0 / self.grid.cell_size)
    }

    fn stencil_node(&self, stencil: &kernel::Stencil, a: usize, b: usize) -> usize {
        let column = (stencil.first[0] + a as i32).clamp(0, self.grid.columns as i32 - 1) as usize;
        let row = (stencil.first[1] + b as i32).clamp(0, self.grid.rows as i32 - 1) as usize;
        row * self.grid.columns + column
    }

    /// Internal forces for the displacement `u` into `force`.
    fn internal_forces(&self, u: &FieldVectors, force: &mut FieldVectors) {
        self.lattice_forces(u, true, force);
        self.state.ties.add_forces(u, force);
    }

    /// The same without the ties, with or without misfits.
    fn lattice_forces(&self, u: &FieldVectors, with_misfits: bool, force: &mut FieldVectors) {
        let fields = self.state.fields.len();
        for f in force.iter_mut() {
            f.clear();
            f.resize(fields, 0.0);
        }
        let columns = self.grid.columns;
        let volume = self.particles.spacing * self.particles.spacing;
        let inverse_cell_size = 1.0 / self.grid.cell_size;
        let constants: Vec<RowConstants> = self
            .elastic
            .iter()
            .map(|e| RowConstants {
                two_mu: 2.0 * e.mu * volume * inverse_cell_size,
                lambda: e.lambda * volume * inverse_cell_size,
                inverse_cell_size,
            })
            .collect();
        let nodes = self.grid.len();
        let [force_x, force_y] = force;
        let row_forces = |row: usize, fx: &mut [f64], fy: &mut [f64]| {
            // fx, fy: the two rows of nodes below and above the row of cells.
            let at = row * columns;
            let u = NodeRows {
                lower: [&u[0][at..at + columns], &u[1][at..at + columns]],
                upper: [&u[0][at + columns..at + 2 * columns], &u[1][at + columns..at + 2 * columns]],
            };
            let (lower_x, upper_x) = fx.split_at_mut(columns);
            let (lower_y, upper_y) = fy.split_at_mut(columns);
            for &run in &self.state.runs[row] {
                rows::add_forces(run, constants[run.material as usize], &u, [lower_x, lower_y, upper_x, upper_y]);
            }
        };
        // Two neighbouring rows of cells share a row of nodes: even rows first, then odd ones, each pass without a shared node. The order
        // of additions at a node is the same for any number of threads.
        for parity in 0..2 {
            let start = parity * columns;
            let fx = &mut force_x[start.min(nodes)..nodes];
            let fy = &mut force_y[start.min(nodes)..nodes];
            let pairs = fx.chunks_exact_mut(2 * columns).zip(fy.chunks_exact_mut(2 * columns)).enumerate();
            if nodes >= PARALLEL_NODES && rayon::current_num_threads() > 1 {
                use rayon::prelude::*;
                fx.par_chunks_exact_mut(2 * columns)
                    .zip(fy.par_chunks_exact_mut(2 * columns))
                    .enumerate()
                    .with_min_len(PARALLEL_NODES / (8 * columns) + 1)
                    .for_each(|(pair, (fx, fy))| row_forces(2 * pair + parity, fx, fy));
            } else {
                pairs.for_each(|(pair, (fx, fy))| row_forces(2 * pair + parity, fx, fy));
            }
        }
        self.add_cut_forces(u, with_misfits, force_x, force_y);
    }

    fn kinetic(&self) -> f64 {
        let v = &self.state.velocity;
        let twice: f64 =
            (0..self.state.mass.len()).map(|d| self.state.mass[d] * (v[0][d] * v[0][d] + v[1][d] * v[1][d])).sum();
        0.5 * twice + self.state.ties.kinetic_energy(&self.state.velocity)
    }

    fn strain_energy(&self) -> f64 {
        (0..self.particles.len())
            .map(|p| {
                let e = &self.elastic[self.particles.material[p] as usize];
                let h = self.strain_of(p);
                self.particles.volume[p] * crate::energy_density(&h, e.mu, e.lambda)
            })
            .sum::<f64>()
            + self.state.ties.energy(&self.state.displacement)
    }
}

/// From so many nodes on, rows go to several threads; below, handing out the work costs about as much as the work. The result is the same either way.
const PARALLEL_NODES: usize = 20_000;

impl Solver for Total {
    fn stable_time_step(&self) -> f64 {
        self.lanczos_time_step()
    }

    fn step(
        &mut self,
        cracks: &[Crack],
        time: f64,
        time_step: f64,
        observe: &mut dyn FnMut(&dyn Observed),
    ) -> Result<(), SimulationError> {
        let mut force = std::mem::take(&mut self.force);
        self.internal_forces(&self.state.displacement, &mut force);
        self.force = force;
        self.apply_loads(time + 0.5 * time_step);
        self.state.ties.share(&mut self.force);
        let kick = if self.state.in_step { 0.5 * time_step } else { time_step };
        self.state.in_step = false;
        let decay = (-self.settings.damping * kick).exp();
        // Damped leapfrog v' = α v + β a is stable up to ω² Δt β = 2 (1 + α); this β keeps the limit where it is without damping.
        let push = 0.5 * (1.0 + decay) * kick;
        let gravity = self.scene.gravity;
        for axis in 0..2 {
            let g = gravity[axis];
            let (velocity, acceleration) = (&mut self.state.velocity[axis], &mut self.acceleration[axis]);
            let force = &self.force[axis];
            for d in 0..velocity.len() {
                let before = velocity[d];
                // Fields without mass have an inverse mass of zero and stay where they are.
                let moving = if self.inverse_mass[d] > 0.0 { g } else { 0.0 };
                velocity[d] = before * decay + push * (force[d] * self.inverse_mass[d] + moving);
                acceleration[d] = before;
            }
        }
        self.apply_drag(cracks, kick);
        if self.settings.crack_contact && !self.contacts.is_empty() {
            self.release_crack_contact();
            self.resolve_crack_contact(kick, time_step);
        }
        self.apply_constraints_and_colliders(time, time_step);
        if self.settings.crack_contact && !self.contacts.is_empty() && !self.colliders.is_empty() {
            self.resolve_crack_contact(kick, time_step);
        }
        for axis in 0..2 {
            let (velocity, acceleration) = (&self.state.velocity[axis], &mut self.acceleration[axis]);
            for d in 0..velocity.len() {
                acceleration[d] = (velocity[d] - acceleration[d]) / kick;
            }
        }
        self.count_work(time + 0.5 * time_step, time_step);
        let moment = look::Moment { solver: self, half_step: 0.5 * time_step };
        observe(&moment);
        for axis in 0..2 {
            let (velocity, displacement) = (&self.state.velocity[axis], &mut self.state.displacement[axis]);
            for d in 0..velocity.len() {
                displacement[d] += time_step * velocity[d];
            }
        }
        self.settle(time_step);
        self.state.last_step = time_step;
        self.watch(time + time_step)
    }

    fn check(&self, time: f64) -> Result<(), SimulationError> {
        self.check_range(time)
    }

    fn recut(&mut self, cracks: &[Crack], changed: &[(usize, End)]) {
        self.take_up(cracks, changed);
    }

    fn slides(&self) -> bool {
        self.settings.tip_division == TipDivision::PartlyCut
    }

    fn release(&self, cracks: &[Crack], crack: usize, end: End) -> Release {
        self.release_of_ties(&cracks[crack], crack, end)
    }

    fn take_drag(&mut self, crack: usize, end: End) -> f64 {
        self.state.ties.take_drag(crack, end)
    }

    fn slide(&mut self, cracks: &[Crack], crack: usize, end: End) {
        self.soften_ties(&cracks[crack], crack, end);
        self.move_last_faces(&cracks[crack], crack, end);
    }

    fn observed(&self) -> &dyn Observed {
        self
    }

    fn kinetic_energy(&self) -> f64 {
        self.kinetic()
    }

    fn stop(&mut self) {
        self.state.velocity.iter_mut().for_each(|v| v.fill(0.0));
        self.acceleration.iter_mut().for_each(|a| a.fill(0.0));
        self.state.last_step = 0.0;
        self.state.in_step = true;
    }

    fn hand_over(&mut self, cracks: &[Crack]) -> Option<Handover> {
        let u = &self.state.displacement;
        let particles = (0..self.particles.len())
            .map(|p| {
                let position = self.particles.rest[p] + self.value(p, u);
                (position, self.value(p, &self.state.velocity), self.strain_of(p))
            })
            .collect();
        Some(Handover {
            particles,
            cracks: self.frames_of_cracks(cracks),
            outlines: self.frames_of_outlines(),
            external_work: self.state.external_work,
        })
    }

    fn rayleigh_quotient(&self) -> Option<f64> {
        let v = &self.state.velocity;
        let speed = v.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
        if speed == 0.0 {
            return None;
        }
        // K v by a difference of forces over a displacement along v that is small beside a cell and large beside round-off.
        let step = 1e-6 * self.grid.cell_size / speed;
        let moved: FieldVectors =
            [0, 1].map(|axis| self.state.displacement[axis].iter().zip(&v[axis]).map(|(u, v)| u + step * v).collect());
        let (mut here, mut there) = (FieldVectors::default(), FieldVectors::default());
        self.internal_forces(&self.state.displacement, &mut here);
        self.internal_forces(&moved, &mut there);
        let change = |axis: usize, d: usize| (here[axis][d] - there[axis][d]) / step;
        let (mut stiffness, mut mass) = (0.0, 0.0);
        for (axis, velocity) in v.iter().enumerate() {
            for (d, &speed) in velocity.iter().enumerate() {
                stiffness += speed * change(axis, d);
                mass += speed * speed * self.state.mass[d];
            }
        }
        (mass > 0.0 && stiffness > 0.0).then(|| stiffness / mass)
    }

    fn set_damping(&mut self, rate: f64) {
        self.settings.damping = rate;
    }

    fn momenta(&self) -> (Vector, f64) {
        let (u, v) = (&self.state.displacement, &self.state.velocity);
        let (mut linear, mut angular) = (Vector::zeros(), 0.0);
        for (d, &mass) in self.state.mass.iter().enumerate() {
            let place = self.grid.position(self.state.fields.node(d)).coords + Vector::new(u[0][d], u[1][d]);
            let momentum = Vector::new(v[0][d], v[1][d]) * mass;
            linear += momentum;
            angular += place.perp(&momentum);
        }
        angular += self.state.ties.spin(u, v);
        (linear, angular)
    }

    fn energies(&self) -> SolverEnergies {
        SolverEnergies {
            kinetic: self.kinetic(),
            strain: self.strain_energy(),
            external_work: self.state.external_work,
        }
    }

    fn particle_frame(&self) -> ParticleFrame {
        self.frame_of_particles()
    }

    fn outline_frames(&self) -> Vec<OutlineFrame> {
        self.frames_of_outlines()
    }

    fn crack_frames(&self, cracks: &[Crack]) -> Vec<CrackFrame> {
        self.frames_of_cracks(cracks)
    }

    fn save(&self) -> Vec<u8> {
        crate::saved::to_bytes(&self.state)
    }
}

/// The side of the tip frame's e2 for one end of a crack, as a side of the crack.
fn left_of_tip(end: End) -> Side {
    match end {
        End::Start => Side::Below,
        End::End => Side::Above,
    }
}
