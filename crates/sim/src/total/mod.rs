//! Total Lagrangian Material Point Method: kernels live on the reference lattice, are computed once, and change only where a crack grows.
//!
//! De Vaucorbeil, Nguyen & Hutchinson 2020. Nodes keep displacement and velocity from step to step, so nothing is lost in transfers:
//! P = ∂Ψ/∂F, H = F − I = Σ_i u_i ⊗ ∇₀w_ip, f_i = −Σ_p V_p P_p ∇₀w_ip, then v += Δt f/m and u += Δt v (symplectic Euler, the
//! leapfrog). Rotation and finite stretch are exact; extreme distortion and plastic flow are out of range.

mod boundary;
mod contact;
mod cut;
mod look;
mod memory;
mod reader;
mod recut;
mod refresh;
mod rows;
#[cfg(test)]
mod tests;
mod tie;

use crate::SimulationError;
use crate::boundary::collider::Obstacle;
use crate::crack::Crack;
use crate::crack::cracks::{Cracks, ENDS, TipId};
use crate::crack::crossing::Side;
use crate::crack::division::{CrackLine, Division, TipCut};
use crate::faces::outlines::Outlines;
use crate::grid::Grid;
use crate::grid::fields::Fields;
use crate::grid::kernel;
use crate::material::elastic::Elastic;
use crate::particles::Particles;
use crate::saved::{self, Fits};
use crate::solver::{Handover, Observed, Release, Solver, SolverEnergies};
use boundary::{Constraint, PointForce};
use contact::ContactPair;
use cut::{CutParticles, Probe};
use fissure_scene::{
    CrackEnd, CrackFrame, End, Kernel, OutlineFrame, ParticleFrame, Point, Scene, SolverSettings, TipDivision, Vector,
};
use rows::{CellRows, RowConstants, Run};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;
use tie::Ties;

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
    /// Runs of uncut cells above each row of nodes.
    runs: Vec<Vec<Run>>,
    /// The rings as probes, doubled at mouths.
    outlines: Outlines<Probe>,
    /// Faces of the cracks, above and below.
    faces: Vec<[Vec<Probe>; 2]>,
    /// Work done by loads, supports and colliders so far [J/m].
    external_work: f64,
    /// What holds the sides of nodes at tips together.
    ties: Ties,
    /// Where each tip was when nodes were last split for it. It has slid on since, within its increment; what is cut anew for other cracks is cut for it as it
    /// was, or nodes at the edge of what is cut anew would be split by halves.
    cut_at: BTreeMap<TipId, Point>,
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
    particles: Arc<Particles>,
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

impl Total {
    /// Lays the lattice and cuts it by the initial cracks.
    pub(crate) fn new(scene: &Scene, particles: Arc<Particles>, cracks: &Cracks) -> Result<Self, SimulationError> {
        let (mut low, mut high) = fissure_plane::bounds(&[]);
        for body in &scene.bodies {
            let (l, h) = body.region.bounds();
            (low, high) = (low.inf(&l), high.sup(&h));
        }
        // The wider kernels reach one node beyond the cell.
        let margin = if kernel::width(scene.solver.kernel) == 2 { 0 } else { 1 };
        let lattice = Grid::around(particles.anchor, low, high, scene.cell_size, margin)
            .ok_or_else(|| too_wide(scene, low, high))?;
        let mut grid = lattice.clone();
        let lowest = particles.rest.iter().map(|&place| stencil_of(scene, &lattice, place).first);
        grid.lay(lowest, kernel::width(scene.solver.kernel), 0);
        let elastic = scene.materials.iter().map(|m| Elastic::new(m, scene.plane)).collect();
        let nodes = grid.len();
        let zeros = || [vec![0.0; nodes], vec![0.0; nodes]];
        let state = State {
            fields: Fields::new(grid.len()),
            mass: vec![0.0; grid.len()],
            displacement: zeros(),
            velocity: zeros(),
            cut: CutParticles::new(particles.len()),
            runs: vec![Vec::new(); grid.rows()],
            outlines: Outlines::default(),
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
        particles: Arc<Particles>,
        cracks: &Cracks,
        state: &[u8],
    ) -> Result<Self, SimulationError> {
        let mut solver = Self::new(scene, particles, cracks)?;
        let state: State = saved::from_bytes(state)?;
        solver.check(&state, cracks)?;
        solver.state = state;
        solver.division = Self::division_of(scene, cracks, &solver.state.cut_at);
        solver.refresh(cracks)?;
        Ok(solver)
    }

    /// Checks a state that was read against the lattice and the cracks.
    fn check(&self, state: &State, cracks: &Cracks) -> Fits {
        let (nodes, fields) = (self.grid.len(), state.fields.len());
        state.fields.check(nodes, cracks.len())?;
        for values in [&state.mass].into_iter().chain(&state.displacement).chain(&state.velocity) {
            saved::ensure(values.len() == fields, "its number of fields")?;
            saved::finite("a field", values)?;
        }
        state.cut.check(self.particles.len(), fields)?;
        saved::ensure(state.runs.len() == self.grid.rows(), "its number of rows")?;
        for (index, runs) in state.runs.iter().enumerate() {
            let row = self.grid.row(index);
            let above = self.grid.row_index(row.row + 1).map_or(0..0, |above| self.grid.row(above).nodes);
            saved::ensure(runs.iter().all(|run| run.lies_in(&row.nodes, &above)), "a run of cells")?;
        }
        saved::below("a run of cells", state.runs.iter().flatten().map(|run| run.material), self.elastic.len())?;
        state.outlines.check(&self.scene)?;
        let same_points =
            |(faces, crack): (&[Vec<Probe>; 2], &Crack)| faces.iter().all(|f| f.len() == crack.points.len());
        let faces = state.faces.len() == cracks.len() && state.faces.iter().zip(cracks.iter()).all(same_points);
        saved::ensure(faces, "the faces of a crack")?;
        let probes = state.outlines.vertices().chain(state.faces.iter().flatten().flatten());
        probes.clone().try_for_each(|probe| probe.check(fields))?;
        state.ties.check(fields, nodes, cracks.len())?;
        state.cut_at.keys().try_for_each(|id| id.check(cracks.len()))?;
        let ((low, high), margin) = (fissure_plane::bounds(&self.particles.rest), Vector::repeat(self.grid.cell_size));
        let is_near = |place: &Point| *place >= low - margin && *place <= high + margin;
        saved::ensure(state.cut_at.values().all(is_near), "the place of a tip")?;
        saved::finite("its last step", [&state.external_work, &state.last_step])
    }

    fn division_of(scene: &Scene, cracks: &Cracks, cut_at: &BTreeMap<TipId, Point>) -> Division {
        // A line from a particle inside the body to a node outside may pass a mouth by as much as the kernel reaches.
        let reach = 0.5 * kernel::width(scene.solver.kernel) as f64;
        let beyond = 2.0 * reach * scene.cell_size;
        let points = |i: usize, c: &Crack| {
            let mut points = c.points.clone();
            let last = points.len() - 1;
            for (end, at) in ENDS.into_iter().zip([0, last]) {
                if let (CrackEnd::Tip, Some(&place)) = (c.end(end), cut_at.get(&TipId::new(i, end))) {
                    points[at] = place;
                }
            }
            points
        };
        let lines: Vec<CrackLine> = cracks.iter().enumerate().map(|(i, c)| c.line(i, points(i, c), beyond)).collect();
        let cut = TipCut::tied(tie::split_ahead(scene.growth.increment));
        Division::new(&lines, scene.solver.tip_division, cut, scene.cell_size, scene.particle_spacing, reach)
    }

    /// Whether uncut cells can go as rows.
    fn has_rows(&self) -> bool {
        self.settings.kernel == Kernel::Bilinear
            && (self.scene.cell_size - 2.0 * self.particles.spacing).abs() < 1e-12 * self.scene.cell_size
    }

    fn stencil(&self, place: Point) -> kernel::Stencil {
        stencil_of(&self.scene, &self.grid, place)
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
        let [force_x, force_y] = force;
        let threads = crate::threads::current_num_threads();
        let part = if self.grid.len() >= PARALLEL_NODES && threads > 1 { PARALLEL_NODES / 4 } else { usize::MAX };
        // Two neighbouring rows of cells share a row of nodes: even rows first, then odd ones, each pass without a shared node. The order
        // of additions at a node is the same for any number of threads.
        for parity in 0..2 {
            let rows = CellRows { runs: &self.state.runs, grid: &self.grid, constants: &constants, u, parity, part };
            rows.add_forces(0..self.grid.rows(), 0, [&mut *force_x, &mut *force_y]);
        }
        self.add_cut_forces(u, with_misfits, force_x, force_y);
    }

    /// Where the node of each field is on the lattice.
    fn places_of_fields(&self) -> impl Iterator<Item = [i32; 2]> {
        let further = self.grid.len()..self.state.fields.len();
        let own = self.grid.nodes().map(|(_, place)| place);
        own.chain(further.map(|field| self.grid.place_of(self.state.fields.node(field))))
    }

    fn kinetic(&self) -> f64 {
        let v = &self.state.velocity;
        let twice: f64 =
            (0..self.state.mass.len()).map(|d| self.state.mass[d] * (v[0][d] * v[0][d] + v[1][d] * v[1][d])).sum();
        0.5 * twice + self.state.ties.kinetic_energy(&self.state.velocity)
    }

    fn strain_energy(&self) -> f64 {
        let mut reader = self.reader();
        (0..self.particles.len())
            .map(|p| {
                let e = &self.elastic[self.particles.material[p] as usize];
                let h = reader.strain(p);
                self.particles.volume[p] * crate::energy_density(&h, e.mu, e.lambda)
            })
            .sum::<f64>()
            + self.state.ties.energy(&self.state.displacement)
    }
}

fn too_wide(scene: &Scene, low: Point, high: Point) -> SimulationError {
    SimulationError::TooWide { width: (high - low).amax(), cell_size: scene.cell_size }
}

fn stencil_of(scene: &Scene, grid: &Grid, place: Point) -> kernel::Stencil {
    let x = grid.in_cells(place);
    let half_size = 0.5 * scene.particle_spacing / grid.cell_size;
    kernel::Stencil::new(scene.solver.kernel, half_size, [x.x, x.y], 1.0 / grid.cell_size)
}

/// From so many nodes on, rows go to several threads; below, handing out the work costs about as much as the work. The result is the same either way.
const PARALLEL_NODES: usize = 20_000;

impl Solver for Total {
    fn stable_time_step(&self) -> f64 {
        self.lanczos_time_step()
    }

    fn step(
        &mut self,
        cracks: &Cracks,
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

    fn recut(&mut self, cracks: &Cracks, changed: &[TipId]) {
        self.take_up(cracks, changed);
    }

    fn slides(&self) -> bool {
        self.settings.tip_division == TipDivision::PartlyCut
    }

    fn release(&self, cracks: &Cracks, id: TipId) -> Release {
        self.release_of_ties(cracks, id)
    }

    fn take_drag(&mut self, id: TipId) -> f64 {
        self.state.ties.take_drag(id)
    }

    fn slide(&mut self, cracks: &Cracks, id: TipId) {
        self.soften_ties(cracks, id);
        self.move_last_faces(cracks, id);
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

    fn hand_over(&mut self, cracks: &Cracks) -> Option<Handover> {
        let mut reader = self.reader();
        let particles = (0..self.particles.len())
            .map(|p| {
                let motion = reader.motion(p);
                (self.particles.rest[p] + motion.displacement, motion.velocity, motion.strain)
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
        for ((d, &mass), place) in self.state.mass.iter().enumerate().zip(self.places_of_fields()) {
            let place = self.grid.place(place).coords + Vector::new(u[0][d], u[1][d]);
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

    fn crack_frames(&self, cracks: &Cracks) -> Vec<CrackFrame> {
        self.frames_of_cracks(cracks)
    }

    fn save(&self) -> Result<Vec<u8>, SimulationError> {
        saved::to_bytes(&self.state)
    }
}

/// The side of the tip frame's e2 for one end of a crack, as a side of the crack.
fn left_of_tip(end: End) -> Side {
    match end {
        End::Start => Side::Below,
        End::End => Side::Above,
    }
}
