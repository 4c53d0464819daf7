//! Updated Lagrangian Material Point Method: particles carry everything, every step has a fresh background grid.
//!
//! The scheme of the thesis (Fumoto 2022, section 3.1; MPM after Stomakhin et al. 2013, explicit cracks after Nairn
//! 2003) with its errata corrected, and beside it other kernels and transfers. Stress is updated last in a step (USL),
//! from the velocities at the end of it: positions and deformations then advance with one and the same velocity field,
//! the symplectic Euler scheme.
//!
//! Where this differs from the thesis: the displacement jump of crack contact takes the gradient of displacement into
//! account (`contact`), and nodes without material are left out of the motion of crack points and outlines by a linear
//! fit (`material_velocity`).
//!
//! | part | what it owns |
//! |---|---|
//! | `Setup` | the scene and what was laid from it; never changes |
//! | `Points` | what particles carry |
//! | `Faces` | where cracks and outlines are |
//! | `Lattice` | the grid of a step, and which particle reaches which field of it |
//! | `Nodes` | mass, momentum, force and velocity of fields |
//! | `Loads`, `Supports`, `Colliders`, `Contacts` | what acts on fields and particles |

mod affine_flip;
mod beside;
mod colliders;
mod contact;
mod cut;
mod edge_layer;
mod faces;
mod gather;
mod gather_batch;
mod grid_to_particles;
mod lattice;
mod light_fields;
mod loads;
mod look;
mod material_velocity;
mod memory;
mod nodes;
mod particles_to_grid;
mod plastic;
mod points;
mod pressure;
mod remap;
mod setup;
mod shares;
mod snapshot;
mod stability;
mod supports;
mod survey;
#[cfg(test)]
mod tests;
mod tracer;
mod tracers;

use crate::SimulationError;
use crate::boundary::supports::Reaction;
use crate::crack::cracks::{Cracks, TipId};
use crate::particles::Particles;
use crate::saved;
use crate::solver::{Continuation, Observed, SlidingTips, Solver};
use colliders::Colliders;
use contact::{Contacts, CrackSurroundings};
use faces::Faces;
use fissure_scene::{Kernel, Scene, Transfer};
use gather::FromGrid;
use grid_to_particles::ParticleStep;
use lattice::Lattice;
use light_fields::relieve_light_fields;
use loads::Loads;
use look::MidStep;
use material_velocity::MaterialVelocity;
use nodes::Nodes;
use particles_to_grid::ToGrid;
use points::{MaterialPoint, Motion, Points};
use remap::{remapped_velocities, smoothed_velocities};
use setup::Setup;
use stability::Stability;
use std::sync::Arc;
use supports::{HeldStep, Supports};

/// The updated Lagrangian solver.
#[derive(Debug)]
pub(crate) struct Updated {
    setup: Setup,
    stability: Stability,
    loads: Loads,
    supports: Supports,
    colliders: Colliders,
    /// Rate at which velocities decay [1/s].
    damping: f64,
    /// Whether the velocities of particles belong to this moment, as after [`Solver::stop_now`], not to half a step
    /// before it.
    starts_now: bool,
    // The state that cannot be laid anew from the scene and the cracks.
    points: Points,
    faces: Faces,
    /// Work done by loads, gravity, supports and colliders so far [J/m].
    external_work: f64,
    /// What each support has done so far.
    reactions: Vec<Reaction>,
    /// Work done in the last step [J/m].
    work_of_step: f64,
    // What follows is made anew in every step.
    lattice: Lattice,
    nodes: Nodes,
    contacts: Contacts,
}

impl Updated {
    /// Lays particles, crack points and outlines at rest, with their first velocities.
    ///
    /// # Errors
    /// When a load or support selects nothing.
    pub(crate) fn new(scene: &Scene, particles: Arc<Particles>, cracks: &Cracks) -> Result<Self, SimulationError> {
        let setup = Setup::new(scene, particles);
        let (points, faces) = (Points::at_rest(&setup), Faces::at_rest(scene, cracks));
        let reactions = vec![Reaction::default(); scene.supports.len()];
        Self::around(setup, points, faces, cracks, (0.0, reactions))
    }

    /// Goes on from a state of the other formulation.
    ///
    /// Every particle keeps its deformation, so strain energy stays to round-off (but for what ties at tips held), and
    /// takes the velocity of the grid where it is, so momentum stays to round-off and kinetic energy can only fall, by
    /// the motion that is shorter than a particle's stencil.
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
        for (point, &(position, velocity, gradient)) in solver.points.point.iter_mut().zip(&continuation.particles) {
            *point = MaterialPoint { position, velocity, elastic_gradient: gradient };
        }
        solver.faces.set(&continuation);
        solver.external_work = continuation.external_work;
        solver.reactions = continuation.reactions;
        Ok(solver)
    }

    /// Goes on from what [`Snapshot::save`](crate::solver::Snapshot::save) gave, bit for bit. `cracks` are those of the
    /// same moment.
    ///
    /// # Errors
    /// [`SimulationError::BadState`] when the bytes are damaged or belong to another scene.
    pub(crate) fn restore(
        scene: &Scene,
        particles: Arc<Particles>,
        cracks: &Cracks,
        bytes: &[u8],
    ) -> Result<Self, SimulationError> {
        let (points, faces, external_work, reactions): (Points, Faces, f64, Vec<Reaction>) = saved::from_bytes(bytes)?;
        points.check(scene, particles.len())?;
        faces.check(scene, cracks, particles.len())?;
        saved::finite("its work", [&external_work])?;
        Reaction::check(&reactions, scene.supports.len())?;
        Self::around(Setup::new(scene, particles), points, faces, cracks, (external_work, reactions))
    }

    fn around(
        setup: Setup,
        points: Points,
        faces: Faces,
        cracks: &Cracks,
        (external_work, reactions): (f64, Vec<Reaction>),
    ) -> Result<Self, SimulationError> {
        Ok(Self {
            stability: Stability::of(&setup),
            loads: Loads::new(&setup, cracks, &faces)?,
            supports: Supports::new(&setup)?,
            colliders: Colliders::of(&setup.scene),
            damping: setup.scene.solver.damping,
            starts_now: false,
            points,
            faces,
            external_work,
            reactions,
            work_of_step: 0.0,
            lattice: Lattice::new(&setup),
            nodes: Nodes::default(),
            contacts: Contacts::default(),
            setup,
        })
    }

    /// Lays the grid of a step around the particles and sorts out who reaches what.
    ///
    /// # Errors
    /// When material has gone so far away that the grid would become too large, or has torn a crack apart.
    fn lay_grid(&mut self, cracks: &Cracks, time: f64) -> Result<(), SimulationError> {
        if !self.lattice.lay(&self.setup, &self.points.point) {
            return Err(self.points.left(time));
        }
        if self.has_cracks() {
            self.faces.check_length(&self.setup, time)?;
            self.lattice.divide(&self.points.point, self.faces.division(&self.setup, cracks));
        }
        self.nodes.clear(self.lattice.fields.len());
        Ok(())
    }

    /// Sends mass, momentum, stresses and loads to the nodes and lets these move by them; `middle`: time in the middle
    /// of the step [s].
    fn move_nodes(&mut self, middle: f64, time_step: f64) {
        let Self { setup, points, faces, lattice, nodes, loads, .. } = self;
        ToGrid { setup, points, lattice }.send(nodes);
        loads.add_forces(points, faces, lattice, setup, middle, nodes);
        relieve_light_fields(setup, points, lattice, nodes);
        let kick = if std::mem::take(&mut self.starts_now) { 0.5 * time_step } else { time_step };
        nodes.update_velocities(setup.scene.gravity, self.damping, kick);
        if setup.scene.solver.transfer == Transfer::Xpic {
            nodes.smoothed =
                smoothed_velocities(&ToGrid { setup, points, lattice }, &FromGrid { setup, lattice, nodes });
        }
    }

    /// Where the faces of cracks overlap.
    fn overlaps(&self) -> Contacts {
        let Self { setup, points, lattice, .. } = self;
        CrackSurroundings { setup, points, lattice, cracks: &self.faces.cracks }.overlaps()
    }

    /// Contact of crack faces, supports and colliders on nodes.
    fn constrain_nodes(&mut self, middle: f64, time_step: f64) {
        self.contacts = self.overlaps();
        let friction = self.setup.scene.solver.crack_friction;
        self.contacts.resolve(&mut self.nodes, friction, time_step);
        let Self { setup, points, lattice, nodes, reactions, .. } = self;
        let step = HeldStep { middle, time_step };
        self.external_work += self.supports.hold_nodes(setup, points, lattice, step, nodes, reactions);
        self.external_work += self.colliders.collide_nodes(lattice, middle, nodes);
        if !(self.supports.is_empty() && self.colliders.is_empty()) {
            self.contacts.resolve(nodes, friction, time_step);
        }
        if setup.scene.solver.transfer == Transfer::Aflip {
            nodes.find_gain(affine_flip::kept(setup, time_step));
        }
    }

    /// Counts the work of loads and gravity.
    fn count_work(&mut self, middle: f64, time_step: f64) {
        let power = self.loads.power(&self.points, &self.faces, &self.source(), middle)
            + self.nodes.power_of_gravity(&self.setup);
        self.external_work += power * time_step;
    }

    /// Moves cracks and outlines with the velocities on the grid.
    fn advance_faces(&mut self, cracks: &Cracks, time_step: f64) {
        let Self { setup, lattice, nodes, .. } = self;
        let material = MaterialVelocity { setup, lattice, nodes };
        self.faces.advance_cracks(cracks, &material, time_step);
        self.faces.advance_outlines(&material, time_step);
    }

    /// Deforms and moves the particles.
    ///
    /// # Errors
    /// When a particle is no longer finite, is turned inside out, or moves by more than a cell.
    fn advance_particles(&mut self, time: f64, time_step: f64) -> Result<(), SimulationError> {
        let middle = time + 0.5 * time_step;
        let has_cracks = self.has_cracks();
        let Self { setup, points, lattice, nodes, supports, reactions, .. } = self;
        let held_step = HeldStep { middle, time_step };
        let obstacles = self.colliders.at(middle);
        if lattice.kernel == Kernel::Bilinear {
            let (to, from) = (ToGrid { setup, points, lattice }, FromGrid { setup, lattice, nodes });
            nodes.remapped = remapped_velocities(&to, &from, &obstacles, supports, held_step);
        }
        points.motion.resize(if has_cracks { points.point.len() } else { 0 }, Motion::default());
        let held = supports.places(points);
        let mut lowest = lattice.take_lowest(points.point.len());
        let step = ParticleStep { from: FromGrid { setup, lattice, nodes }, obstacles, time_step };
        let (work, survey) = step.advance(points, &mut lowest);
        lattice.put_lowest(lowest.0, lowest.1, survey);
        // What supports hold is put where it belongs after that.
        lattice.ahead = held.iter().all(Vec::is_empty).then_some(survey);
        self.external_work += supports.hold_particles(setup, &held, held_step, points, reactions);
        self.external_work +=
            work.map_err(|failure| failure.at(points.point[failure.particle].position, time + time_step))?;
        Ok(())
    }

    /// Where particles gather from.
    fn source(&self) -> FromGrid<'_> {
        FromGrid { setup: &self.setup, lattice: &self.lattice, nodes: &self.nodes }
    }

    fn has_cracks(&self) -> bool {
        !self.faces.cracks.is_empty()
    }
}

impl Solver for Updated {
    fn stable_time_step(&self) -> f64 {
        self.stability.largest_step(&self.setup, &self.points)
    }

    fn moving_time_step(&self, _planned: f64) -> Option<f64> {
        Some(self.stable_time_step())
    }

    fn step(
        &mut self,
        cracks: &Cracks,
        time: f64,
        time_step: f64,
        observe: &mut dyn FnMut(&dyn Observed),
    ) -> Result<(), SimulationError> {
        let (middle, work_before) = (time + 0.5 * time_step, self.external_work);
        self.lay_grid(cracks, time)?;
        // Thesis 3.1.1 and 3.1.2.
        self.move_nodes(middle, time_step);
        // 3.1.3 and 3.1.4.
        self.constrain_nodes(middle, time_step);
        self.count_work(middle, time_step);
        observe(&MidStep { solver: self, time_step });
        // 3.1.7: with the velocities of this step, before the particles leave their places.
        self.advance_faces(cracks, time_step);
        // 3.1.5 and 3.1.6.
        self.advance_particles(time, time_step)?;
        self.work_of_step = self.external_work - work_before;
        Ok(())
    }

    fn check(&self, _time: f64) -> Result<(), SimulationError> {
        // Every step looks at what it moves.
        Ok(())
    }

    fn recut(&mut self, cracks: &Cracks, changed: &[TipId]) -> f64 {
        self.faces.follow(cracks, changed, &self.setup, &self.points);
        self.lattice.division = self.faces.division(&self.setup, cracks);
        self.loads.follow(&self.setup, cracks, &self.faces);
        0.0
    }

    fn begin_run(&mut self) {}

    fn end_frame(&mut self, _cracks: &Cracks) {}

    fn is_touching(&self) -> bool {
        false
    }

    fn sliding(&self) -> Option<&dyn SlidingTips> {
        None
    }

    fn sliding_mut(&mut self) -> Option<&mut dyn SlidingTips> {
        None
    }

    fn stop(&mut self) {
        self.points.stop();
        self.starts_now = false;
    }

    fn stop_now(&mut self) {
        self.points.stop();
        self.starts_now = true;
    }

    fn set_damping(&mut self, rate: f64) {
        self.damping = rate;
    }
}
