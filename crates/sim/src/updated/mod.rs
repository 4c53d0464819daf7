//! Updated Lagrangian Material Point Method: particles carry everything, every step has a fresh background grid.
//!
//! The scheme of the thesis (Fumoto 2022, section 3.1; MPM after Stomakhin et al. 2013, explicit cracks after Nairn 2003) with its errata
//! corrected, and beside it other kernels and transfers. Stress is updated last in a step (USL), from the velocities at the end of it: positions and
//! deformations then advance with one and the same velocity field, the symplectic Euler scheme.
//!
//! Where this differs from the thesis: the displacement jump of crack contact takes the gradient of displacement into account (`contact`),
//! and nodes without material are left out of the motion of crack points and outlines by a linear fit (`faces`).

mod boundary;
mod contact;
mod faces;
mod look;
mod memory;
mod plastic;
mod stability;
mod stencils;
#[cfg(test)]
mod tests;
mod transfer;

use crate::SimulationError;
use crate::boundary::collider::Obstacle;
use crate::crack::Crack;
use crate::crack::cracks::{Cracks, TipId};
use crate::crack::division::{CrackLine, Division, TipCut};
use crate::faces::outlines::Outlines;
use crate::grid::Grid;
use crate::grid::kernel;
use crate::material::elastic::Elastic;
use crate::particles::Particles;
use crate::saved::{self, Fits};
use crate::solver::{Continuation, Observed, SlidingTips, Snapshot, Solver, SolverEnergies};
use contact::ContactPair;
use faces::{CrackNow, Tracer};
use fissure_scene::{
    CrackFrame, Kernel, Matrix, OutlineFrame, ParticleFrame, Point, Scene, SolverSettings, Transfer, Vector,
};
use plastic::PlasticPart;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use stencils::{Cut, Nodes, RowOrder};

/// What every particle carries; one cache line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct MaterialPoint {
    /// x_p [m].
    position: Point,
    /// v_p [m/s].
    velocity: Vector,
    /// H = F_E − I [–]: a strain of 1e-9 keeps its digits.
    elastic_gradient: Matrix,
}

/// The state that cannot be laid anew from the scene and the cracks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct State {
    /// One entry per particle.
    points: Vec<MaterialPoint>,
    /// Affine velocity C_p [1/s] of each particle; empty unless the transfer is APIC.
    affine: Vec<Matrix>,
    /// Plastic part of each particle; empty when every material is elastic.
    plastic: Vec<PlasticPart>,
    /// Where the cracks are now.
    cracks: Vec<CrackNow>,
    /// The rings of the bodies, doubled at mouths.
    outlines: Outlines<Tracer>,
    /// Work done by loads, gravity, supports and colliders so far [J/m].
    external_work: f64,
}

/// Whether particles carry an affine velocity.
fn has_affine(scene: &Scene) -> bool {
    scene.solver.transfer == Transfer::Apic
}

/// Whether particles carry a plastic part.
fn is_plastic(scene: &Scene) -> bool {
    scene.materials.iter().any(|m| m.plasticity.is_some())
}

impl State {
    /// Checks a state that was read: that its numbers are finite, and that it fits the scene, its number of `particles`
    /// and the cracks.
    fn check(&self, scene: &Scene, particles: usize, cracks: &Cracks) -> Fits {
        let counts = [self.points.len(), self.affine.len(), self.plastic.len()];
        let expected =
            [particles, if has_affine(scene) { particles } else { 0 }, if is_plastic(scene) { particles } else { 0 }];
        saved::ensure(counts == expected, "its number of particles")?;
        for point in &self.points {
            let numbers = point.position.iter().chain(&point.velocity).chain(&point.elastic_gradient);
            saved::finite("a particle", numbers)?;
        }
        saved::finite("a particle", self.affine.iter().flatten())?;
        for part in &self.plastic {
            saved::finite("a particle", part.gradient.iter().chain([&part.hardening]))?;
        }
        let fits = |(now, crack): (&CrackNow, &Crack)| now.rest == crack.points && now.is_even();
        let same = self.cracks.len() == cracks.len() && self.cracks.iter().zip(cracks.iter()).all(fits);
        saved::ensure(same, "the place of a crack")?;
        self.cracks.iter().try_for_each(|now| saved::finite("a crack", now.numbers()))?;
        self.outlines.check(scene)?;
        self.outlines.vertices().try_for_each(|tracer| tracer.check(cracks.len()))?;
        saved::finite("its work", [&self.external_work])
    }
}

/// The updated Lagrangian solver.
#[derive(Debug)]
pub(crate) struct Updated {
    scene: Scene,
    settings: SolverSettings,
    elastic: Vec<Elastic>,
    particles: Arc<Particles>,
    colliders: Vec<Obstacle>,
    /// Per load: (particle, force at a curve factor of 1 [N/m]).
    loads: Vec<Vec<(u32, Vector)>>,
    /// Particles that each support holds.
    held: Vec<Vec<u32>>,
    /// Largest stable c_d Δt / h of each material [–].
    stable_number: Vec<f64>,
    state: State,
    // What follows is made anew in every step.
    division: Division,
    /// The nodes that particles reach; none before the first step.
    grid: Grid,
    nodes: Nodes,
    order: RowOrder,
    cut: Cut,
    /// What each particle did in the last step, for a look between steps; empty in a scene without a crack, and before the first step.
    motion: Vec<Motion>,
    /// Overlapping fields at cracks.
    contacts: Vec<ContactPair>,
}

/// The motion of a particle in a step.
#[derive(Debug, Clone, Copy, Default)]
struct Motion {
    /// [m/s²].
    acceleration: Vector,
    /// ∇v [1/s].
    velocity_gradient: Matrix,
}

impl Updated {
    /// Lays particles, crack points and outlines at rest, with their first velocities.
    ///
    /// # Errors
    /// When a load or support selects nothing.
    pub(crate) fn new(scene: &Scene, particles: Arc<Particles>, cracks: &Cracks) -> Result<Self, SimulationError> {
        let count = particles.len();
        let points = particles
            .rest
            .iter()
            .map(|&position| MaterialPoint { position, velocity: Vector::zeros(), elastic_gradient: Matrix::zeros() })
            .collect();
        let state = State {
            points,
            affine: if has_affine(scene) { vec![Matrix::zeros(); count] } else { Vec::new() },
            plastic: if is_plastic(scene) { vec![PlasticPart::NONE; count] } else { Vec::new() },
            cracks: cracks.iter().map(CrackNow::at_rest).collect(),
            outlines: Outlines::default(),
            external_work: 0.0,
        };
        let mut solver = Self::around(scene, particles, state)?;
        solver.lay_outlines(cracks);
        solver.set_initial_velocities();
        Ok(solver)
    }

    /// Goes on from a state of the other formulation.
    ///
    /// Every particle keeps its deformation, so strain energy stays to round-off (but for what ties at tips held), and takes the velocity of the grid where it
    /// is, so momentum stays to round-off and kinetic energy can only fall, by the motion that is shorter than a particle's stencil.
    ///
    /// # Errors
    /// When a load or support selects nothing.
    pub(crate) fn continued(
        scene: &Scene,
        particles: Arc<Particles>,
        cracks: &Cracks,
        continuation: Continuation,
    ) -> Result<Self, SimulationError> {
        let mut solver = Self::new(scene, particles, cracks)?;
        let state = &mut solver.state;
        for (point, (position, velocity, gradient)) in state.points.iter_mut().zip(continuation.particles) {
            *point = MaterialPoint { position, velocity, elastic_gradient: gradient };
        }
        for (now, frame) in state.cracks.iter_mut().zip(&continuation.cracks) {
            now.take_over(frame);
        }
        solver.take_over_outlines(&continuation.outlines);
        solver.state.external_work = continuation.external_work;
        Ok(solver)
    }

    /// Goes on from what [`Solver::save`] gave, bit for bit. `cracks` are those of the same moment.
    ///
    /// # Errors
    /// [`SimulationError::BadState`] when the bytes are damaged or belong to another scene.
    pub(crate) fn restore(
        scene: &Scene,
        particles: Arc<Particles>,
        cracks: &Cracks,
        bytes: &[u8],
    ) -> Result<Self, SimulationError> {
        let state: State = saved::from_bytes(bytes)?;
        state.check(scene, particles.len(), cracks)?;
        Self::around(scene, particles, state)
    }

    fn around(scene: &Scene, particles: Arc<Particles>, state: State) -> Result<Self, SimulationError> {
        let elastic: Vec<Elastic> = scene.materials.iter().map(|m| Elastic::new(m, scene.plane)).collect();
        let stable_number = elastic.iter().map(|e| stability::stable_number(scene, e)).collect();
        let mut solver = Self {
            settings: scene.solver,
            elastic,
            colliders: scene.colliders.iter().map(Obstacle::new).collect(),
            loads: Vec::new(),
            held: Vec::new(),
            stable_number,
            state,
            division: Division::new(
                &[],
                scene.solver.tip_division,
                TipCut::PLAIN,
                scene.cell_size,
                scene.particle_spacing,
                0.0,
            ),
            grid: Grid::default(),
            nodes: Nodes::default(),
            order: RowOrder::default(),
            cut: Cut::default(),
            motion: Vec::new(),
            contacts: Vec::new(),
            scene: scene.clone(),
            particles,
        };
        solver.loads = solver.forces_of_loads()?;
        solver.held = solver.particles_of_supports()?;
        Ok(solver)
    }

    fn has_cracks(&self) -> bool {
        !self.state.cracks.is_empty()
    }

    /// Cells in the boxes around the segments of all cracks where they are now: what a division lists.
    fn crack_cells(&self) -> f64 {
        let segments = self.state.cracks.iter().flat_map(|now| now.position.windows(2));
        segments.map(|w| ((w[1] - w[0]).abs() / self.scene.cell_size).add_scalar(1.0).product()).sum()
    }

    /// Cells that cracks may reach over: far more than lie in the bodies.
    fn most_crack_cells(&self) -> f64 {
        (4.0 * self.particles.len() as f64).max(1e6)
    }

    /// The cracks where they are now, ready to divide pairs.
    fn division_now(&self, cracks: &Cracks) -> Division {
        // A line from a particle inside the body to a node outside may pass a mouth by as much as the kernel reaches.
        let reach = 0.5 * kernel::width(self.settings.kernel) as f64;
        let beyond = 2.0 * reach * self.scene.cell_size;
        // Lines that are torn too long end the next step; till then they lie at rest.
        let holds = self.crack_cells() <= self.most_crack_cells();
        let points = |crack: &Crack, now: &CrackNow| if holds { now.position.clone() } else { crack.points.clone() };
        let lines: Vec<CrackLine> = cracks
            .iter()
            .zip(&self.state.cracks)
            .enumerate()
            .map(|(i, (crack, now))| crack.line(i, points(crack, now), beyond))
            .collect();
        Division::new(
            &lines,
            self.settings.tip_division,
            TipCut::PLAIN,
            self.scene.cell_size,
            self.scene.particle_spacing,
            reach,
        )
    }

    /// Elastic constants (μ, λ) of a particle, hardening included [Pa].
    #[inline]
    fn moduli(&self, particle: usize) -> (f64, f64) {
        let elastic = &self.elastic[self.particles.material[particle] as usize];
        match self.state.plastic.get(particle) {
            None => (elastic.mu, elastic.lambda),
            Some(part) => (elastic.mu * part.hardening, elastic.lambda * part.hardening),
        }
    }

    /// H = F − I of a particle, elastic and plastic part together.
    fn total_gradient(&self, particle: usize) -> Matrix {
        let h = self.state.points[particle].elastic_gradient;
        match self.state.plastic.get(particle) {
            None => h,
            Some(part) => part.gradient - Matrix::identity() + h * part.gradient,
        }
    }
}

impl Solver for Updated {
    fn stable_time_step(&self) -> f64 {
        self.largest_stable_step()
    }

    fn moving_time_step(&self) -> Option<f64> {
        Some(self.largest_stable_step())
    }

    fn step(
        &mut self,
        cracks: &Cracks,
        time: f64,
        time_step: f64,
        observe: &mut dyn FnMut(&dyn Observed),
    ) -> Result<(), SimulationError> {
        self.lay_grid(cracks, time)?;
        // Thesis 3.1.1 and 3.1.2: mass, momentum and the forces of the stresses.
        self.particles_to_grid();
        self.add_loads(time, time_step);
        self.update_grid_velocities(time_step);
        // 3.1.3 to 3.1.4.
        self.contacts = self.crack_contacts();
        self.resolve_crack_contact(time_step);
        let impulses_changed = self.hold_nodes(time, time_step) | self.collide_nodes(time, time_step);
        if impulses_changed {
            self.resolve_crack_contact(time_step);
        }
        self.count_work(time, time_step);
        observe(&look::Moment { solver: self, time_step });
        // 3.1.7: with the velocities of this step, before the particles leave their places.
        self.move_cracks(cracks, time_step);
        self.move_outlines(time_step);
        // 3.1.5 and 3.1.6.
        self.grid_to_particles(time, time_step)
    }

    fn check(&self, _time: f64) -> Result<(), SimulationError> {
        // Every step looks at what it moves.
        Ok(())
    }

    fn recut(&mut self, cracks: &Cracks, changed: &[TipId]) {
        self.take_up(cracks, changed);
    }

    fn sliding(&self) -> Option<&dyn SlidingTips> {
        None
    }

    fn sliding_mut(&mut self) -> Option<&mut dyn SlidingTips> {
        None
    }

    fn stop(&mut self) {
        self.state.points.iter_mut().for_each(|p| p.velocity = Vector::zeros());
        self.state.affine.fill(Matrix::zeros());
        self.motion.fill(Motion::default());
    }

    fn set_damping(&mut self, rate: f64) {
        self.settings.damping = rate;
    }
}

impl Snapshot for Updated {
    fn particle_frame(&self) -> ParticleFrame {
        self.frame_of_particles()
    }

    fn outline_frames(&self) -> Vec<OutlineFrame> {
        self.frames_of_outlines()
    }

    fn crack_frames(&self, cracks: &Cracks) -> Vec<CrackFrame> {
        self.frames_of_cracks(cracks)
    }

    fn energies(&self) -> SolverEnergies {
        SolverEnergies {
            kinetic: self.kinetic(),
            strain: self.strain_energy(),
            external_work: self.state.external_work,
        }
    }

    fn kinetic_energy(&self) -> f64 {
        self.kinetic()
    }

    fn momenta(&self) -> (Vector, f64) {
        // The affine part of APIC turns too: m D (C_21 − C_12), D = h²/4 (quadratic) or h²/3 (cubic) (Jiang et al. 2015).
        let d = self.scene.cell_size.powi(2) / if self.settings.kernel == Kernel::Quadratic { 4.0 } else { 3.0 };
        let (mut linear, mut angular) = (Vector::zeros(), 0.0);
        for (p, (point, mass)) in self.state.points.iter().zip(&self.particles.mass).enumerate() {
            let turning = self.state.affine.get(p).map_or(0.0, |c| d * (c.m21 - c.m12));
            linear += point.velocity * *mass;
            angular += mass * (point.position.coords.perp(&point.velocity) + turning);
        }
        (linear, angular)
    }

    fn rayleigh_quotient(&self) -> Option<f64> {
        // Its forces live on a grid that is laid anew in every step.
        None
    }

    fn continuation(&self, _cracks: &Cracks) -> Option<Continuation> {
        None
    }

    fn save(&self) -> Result<Vec<u8>, SimulationError> {
        saved::to_bytes(&self.state)
    }
}
