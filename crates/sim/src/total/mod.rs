//! Total Lagrangian Material Point Method: kernels live on the reference lattice, are computed once, and change only
//! where a crack grows.
//!
//! De Vaucorbeil, Nguyen & Hutchinson 2020. Nodes keep displacement and velocity from step to step, so nothing is lost
//! in transfers: P = ∂Ψ/∂F, H = F − I = Σ_i u_i ⊗ ∇₀w_ip, f_i = −Σ_p V_p P_p ∇₀w_ip, then v += Δt f/m and u += Δt v
//! (symplectic Euler, the leapfrog). Rotation and finite stretch are exact; extreme distortion and plastic flow are out
//! of range.
//!
//! [`Total`] is made of parts, each of which owns its state and is handed what else it needs: the lattice with the
//! masses of its fields, their motion, the probes that ride on it, loads, supports, colliders, the contacts of crack
//! faces and of surfaces, and the ties around tips. What is made from the lattice is made anew only near a crack that
//! has grown ([`near::Near`]).

mod colliders;
mod contact;
mod cut;
mod cutting;
mod disc;
mod edge_means;
mod field_vectors;
mod free_zone;
mod held_points;
mod lattice;
mod loads;
mod look;
pub(crate) mod memory;
mod motion;
mod near;
mod pieces;
mod pressure;
mod probe;
mod probes;
mod push;
mod range;
mod reader;
mod rebound;
mod recut;
mod riders;
mod rows;
mod run;
mod segment_normals;
mod settling;
mod snapshot;
mod stability;
mod stiffening;
mod supports;
mod surfaces;
#[cfg(test)]
mod tests;
mod tie;
mod ties;
mod touching;

use crate::SimulationError;
use crate::boundary::supports::Reaction;
use crate::crack::cracks::{Cracks, TipId};
use crate::particles::Particles;
use crate::saved;
use crate::solver::{Continuation, Observed, Release, SlidingTips, Snapshot, Solver, SolverEnergies};
use crate::tip::zone::{Opening, TipZone};
use colliders::Colliders;
use contact::{Contacts, FaceForces};
use field_vectors::FieldVectors;
use fissure_plane::{Matrix, Point, Vector};
use fissure_scene::{CrackEnd, CrackFrame, OutlineFrame, ParticleFrame, Scene};
use lattice::{Lattice, Layout};
use loads::Loads;
use look::Look;
use motion::Motion;
use near::Near;
use probes::Probes;
use rebound::Rebound;
use std::sync::{Arc, OnceLock};
use stiffening::Stiffening;
use supports::{HeldStep, Supports};
use ties::Ties;
use touching::{LastImpulses, Moment, Touching};

/// The total Lagrangian solver.
#[derive(Debug)]
pub(crate) struct Total {
    scene: Scene,
    /// Rate at which velocities decay [1/s].
    damping: f64,
    lattice: Lattice,
    motion: Motion,
    probes: Probes,
    ties: Ties,
    loads: Loads,
    supports: Supports,
    colliders: Colliders,
    contacts: Contacts,
    touching: Touching,
    rebound: Rebound,
    /// Work done by loads, supports and colliders so far, to the moment of the velocities [J/m].
    external_work: f64,
    /// Work of colliders beyond that of their motion so far: see [`colliders::CollisionWork::beyond`] [J/m].
    collision_work: f64,
    /// Power of loads in the last step, and of gravity, with the velocities after it [W/m].
    power_of_loads: f64,
    power_of_gravity: f64,
    /// What each support has done so far.
    reactions: Vec<Reaction>,
    stiffening: Stiffening,
    steps_since_check: u32,
    /// What tips have given in the last step for what their cuts had left strained [J/m].
    settled: Vec<(TipId, f64)>,
    /// The largest stable step of material that is not stretched [s], once it is found; a cut changes it.
    step_at_rest: OnceLock<f64>,
}

/// What of a solver cannot be laid anew from the scene and the cracks; last the work and the reactions so far.
type Saved = (Layout, Motion, Probes, Ties, (LastImpulses, FaceForces), Done);

/// The work done so far, the power of loads and of gravity, the work of collisions; what each support has done.
type Done = ([f64; 4], Vec<Reaction>);

/// Steps between two checks that everything is still finite and in range.
const STEPS_BETWEEN_CHECKS: u32 = 8;

impl Total {
    /// Lays the lattice and cuts it by the initial cracks.
    ///
    /// # Errors
    /// When the bodies reach too far, or a load or support selects nothing.
    pub(crate) fn new(scene: &Scene, particles: Arc<Particles>, cracks: &Cracks) -> Result<Self, SimulationError> {
        let mut lattice = Self::lattice(scene, particles, cracks)?;
        lattice.cut_all();
        let probes = Probes::new(scene, &lattice, cracks);
        let mut motion = Motion::initial(scene, &lattice);
        let ties = Ties::new(&lattice, &mut motion, cracks);
        let falling = motion.power_of_gravity(lattice.mass(), scene.gravity);
        let done = ([0.0, 0.0, falling, 0.0], vec![Reaction::default(); scene.supports.len()]);
        Self::of_parts(scene, lattice, (motion, probes, ties, LastImpulses::default(), done), cracks)
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
        let mut lattice = Self::lattice(scene, particles, cracks)?;
        let (mut layout, mut motion, probes, ties, (impulses, face_forces), done): Saved = saved::from_bytes(state)?;
        let fields = layout.fields.len();
        layout.cut.number_rows(lattice.particles.len());
        layout.far.number_rows(lattice.particles.len());
        lattice.check(&layout, cracks.len())?;
        motion.check(fields)?;
        probes.check(fields, scene, cracks)?;
        ties.check(fields, lattice.grid.len(), cracks.len())?;
        impulses.check()?;
        saved::finite("the work done so far", &done.0)?;
        Reaction::check(&done.1, scene.supports.len())?;
        motion.resize(fields);
        lattice.set_layout(layout);
        let mut total = Self::of_parts(scene, lattice, (motion, probes, ties, impulses, done), cracks)?;
        total.contacts.set_forces(&face_forces)?;
        Ok(total)
    }

    fn lattice(scene: &Scene, particles: Arc<Particles>, cracks: &Cracks) -> Result<Lattice, SimulationError> {
        let mut lattice = Lattice::new(scene, particles, tie::split_ahead(scene.growth.increment))?;
        lattice.set_cracks(cracks);
        Ok(lattice)
    }

    fn of_parts(
        scene: &Scene,
        lattice: Lattice,
        (motion, probes, ties, impulses, done): (Motion, Probes, Ties, LastImpulses, Done),
        cracks: &Cracks,
    ) -> Result<Self, SimulationError> {
        let stiffening = Stiffening::new(&lattice.materials);
        let friction = scene.solver.crack_contact.then_some(scene.solver.crack_friction);
        Ok(Self {
            damping: scene.solver.damping,
            loads: Loads::new(scene, &lattice, cracks)?,
            supports: Supports::new(scene, &lattice, &ties)?,
            colliders: Colliders::new(scene, &lattice),
            contacts: Contacts::new(friction, &lattice, cracks),
            touching: Touching::new(scene, impulses),
            rebound: Rebound::new(scene),
            scene: scene.clone(),
            lattice,
            motion,
            probes,
            ties,
            external_work: done.0[0],
            power_of_loads: done.0[1],
            power_of_gravity: done.0[2],
            collision_work: done.0[3],
            reactions: done.1,
            stiffening,
            steps_since_check: 0,
            settled: Vec::new(),
            step_at_rest: OnceLock::new(),
        })
    }

    /// A moment at which velocities are ahead by `half_step` [s].
    fn look(&self, half_step: f64) -> Look<'_> {
        let Self { lattice, motion, probes, ties, contacts, loads, .. } = self;
        Look { lattice, motion, probes, ties, contacts, loads, half_step }
    }

    /// Looks at which surfaces are near each other, and which pieces there are.
    fn look_at_surfaces(&mut self, cracks: &Cracks, kick: f64, time_step: f64) {
        let Self { scene, lattice, motion, probes, touching, .. } = self;
        touching.look(&Moment { scene, lattice, probes, cracks, kick, time_step }, motion);
    }

    /// Surfaces that touch, at the time `middle` [s] of a step. Whether any is near enough.
    fn touch(&mut self, cracks: &Cracks, middle: f64, kick: f64, time_step: f64) -> bool {
        if !self.touching.is_near() {
            return false;
        }
        // What a support holds gives way to nothing.
        self.apply_supports(middle, time_step, kick);
        let Self { scene, lattice, motion, probes, touching, supports, .. } = self;
        let moment = Moment { scene, lattice, probes, cracks, kick, time_step };
        touching.resolve(&moment, supports.held(), motion);
        true
    }

    /// Supports over a step around the time `middle` [s], after a kick of `kick` [s].
    fn apply_supports(&mut self, middle: f64, time_step: f64, kick: f64) {
        let step = HeldStep { middle, time_step, gain: motion::force_of_impulse(self.damping, kick) };
        let Self { scene, lattice, motion, reactions, .. } = self;
        self.external_work += self.supports.apply(&scene.supports, step, lattice.mass(), motion, reactions);
    }

    /// Supports, then colliders, at the time `middle` [s] of a step, after a kick of `kick` [s].
    fn apply_boundaries(&mut self, middle: f64, time_step: f64, kick: f64) {
        self.apply_supports(middle, time_step, kick);
        let gain = motion::force_of_impulse(self.damping, kick);
        let Self { lattice, ties, motion, rebound, .. } = self;
        let pushed = &mut |push| {
            if rebound.is_on() {
                rebound.add(push)
            }
        };
        let work = self.colliders.apply(middle, gain, (lattice, ties), motion, pushed);
        self.external_work += work.of_motion;
        self.collision_work += work.beyond;
    }

    /// What loads do from the moment of the velocities to that of the displacements [J/m].
    fn work_of_lag(&self) -> f64 {
        self.motion.lag() * (self.power_of_loads + self.power_of_gravity)
    }

    /// Checks now and then that the run is sound.
    fn watch(&mut self, time: f64) -> Result<(), SimulationError> {
        self.steps_since_check += 1;
        if self.steps_since_check < STEPS_BETWEEN_CHECKS {
            return Ok(());
        }
        self.steps_since_check = 0;
        if range::check_range(&self.lattice, &self.motion, time, self.stiffening.calm())? {
            self.stiffening.rest();
        } else {
            self.look_at_stretch();
        }
        Ok(())
    }

    /// Sees how much the stretched material is stiffened.
    fn look_at_stretch(&mut self) {
        let Self { lattice, motion, stiffening, .. } = self;
        stiffening.look(&lattice.layout.runs, &motion.displacement, lattice.grid.cell_size);
    }
}

/// Internal forces for the displacement `u` into `force`: of the material, then of the ties.
fn internal_forces(lattice: &Lattice, ties: &Ties, u: &FieldVectors, force: &mut FieldVectors) {
    lattice.internal_forces(u, true, force);
    ties.add_forces(u, force);
}

impl Solver for Total {
    fn stable_time_step(&self) -> f64 {
        let at_rest = self.step_at_rest.get_or_init(|| stability::largest_time_step(&self.lattice));
        at_rest * self.stiffening.part_of_step()
    }

    fn moving_time_step(&self, planned: f64) -> Option<f64> {
        self.stiffening.change().map(|change| planned * change)
    }

    fn step(
        &mut self,
        cracks: &Cracks,
        time: f64,
        time_step: f64,
        observe: &mut dyn FnMut(&dyn Observed),
    ) -> Result<(), SimulationError> {
        let middle = time + 0.5 * time_step;
        let Self { scene, lattice, motion, ties, .. } = self;
        // Forces at the displacements of the beginning.
        internal_forces(lattice, ties, &motion.displacement, &mut motion.force);
        self.loads.add_forces(&scene.loads, middle, motion);
        ties.share(&mut motion.force);
        let power_before = self.loads.power(&scene.loads, middle, motion) + self.power_of_gravity;
        // v += Δt f/m, then what changes velocities by impulses.
        let kick = motion.kick(&lattice.inverse_mass, scene.gravity, self.damping, time_step);
        ties.apply_drag(lattice, motion, cracks, kick);
        self.look_at_surfaces(cracks, kick, time_step);
        if self.contacts.are_possible() {
            let Self { lattice, ties, motion, probes, contacts, touching, .. } = self;
            contacts.resolve((lattice.mass(), ties), (probes, cracks, touching), motion, kick, time_step);
        }
        let touches = self.touch(cracks, middle, kick, time_step);
        self.apply_boundaries(middle, time_step, kick);
        if self.contacts.are_possible() && !self.colliders.is_empty() {
            let Self { lattice, ties, motion, probes, contacts, touching, .. } = self;
            contacts.resolve_again((lattice.mass(), ties), (probes, cracks, touching), motion, kick, time_step);
        }
        if touches && !self.colliders.is_empty() {
            self.touching.resolve_again(&mut self.motion);
        }
        if self.rebound.is_on() {
            let Self { lattice, motion, probes, supports, touching, rebound, .. } = self;
            if touches {
                touching.each_push(probes, &mut |push| rebound.add(push));
            }
            rebound.end_step(lattice, supports.held(), motion);
        }
        self.external_work += self.touching.keep(kick, &self.motion);
        // A force changes the kinetic energy by its impulse times the mean of the velocities before and after it. From
        // rest the impulse is half as long; what moves is moved over the whole step.
        self.power_of_loads = self.loads.power(&self.scene.loads, middle, &self.motion);
        if self.scene.gravity != Vector::zeros() {
            // Nothing but a step changes momentum, so that what is after this one is before the next.
            self.power_of_gravity = self.motion.power_of_gravity(self.lattice.mass(), self.scene.gravity);
        }
        self.external_work += 0.5 * (power_before + self.power_of_loads + self.power_of_gravity) * time_step;
        observe(&self.look(0.5 * time_step));
        // u += Δt v.
        self.motion.drift(time_step);
        self.settle(cracks, time_step);
        self.watch(time + time_step)
    }

    fn check(&self, time: f64) -> Result<(), SimulationError> {
        range::check_range(&self.lattice, &self.motion, time, self.stiffening.calm()).map(drop)
    }

    fn recut(&mut self, cracks: &Cracks, changed: &[TipId]) -> f64 {
        self.step_at_rest = OnceLock::new();
        let shifts = self.probes.added_at_starts(cracks, changed);
        let changes = self.lattice.set_cracks(cracks);
        let held = self.ties.held(&self.motion);
        let divides = changed.iter().any(|id| id.crack >= self.probes.faces.len());
        let mut lost = self.lattice.recut(&changes, divides, &mut self.motion);
        let mut boxes = changes.boxes.clone();
        if changed.iter().any(|&id| cracks.end(id) != CrackEnd::Tip) {
            let around = recut::boxes_behind(cracks, changed, self.lattice.grid.cell_size);
            lost += self.lattice.seat_more_riders(&around, &mut self.motion);
            boxes.extend(around);
        }
        let turned = std::mem::take(&mut self.lattice.turned);
        let has_mouthed = self.probes.refresh(&self.lattice, cracks, changed, (&changes, &boxes));
        let near = Near::new(&self.lattice, &boxes, shifts);
        self.loads.refresh(&near, &self.scene, &self.lattice, cracks);
        self.colliders.refresh(&near, &self.lattice);
        self.contacts.refresh(&near, &turned, &self.lattice, cracks);
        let recut = (boxes.len() == changes.boxes.len()).then_some(&self.lattice.recut[..]);
        let (retied, slowed) = self.ties.refresh(&near, recut, &self.lattice, &mut self.motion, cracks);
        self.supports.refresh(&near, &self.scene, &self.lattice, (&self.ties, &retied));
        self.touching.change(&near, has_mouthed);
        self.rebound.change();
        held - self.ties.held(&self.motion) + lost + slowed
    }

    fn begin_run(&mut self) {
        self.touching.look_again();
        self.rebound.look_again();
        self.look_at_stretch();
        self.stiffening.plan();
        self.steps_since_check = 0;
    }

    fn end_frame(&mut self, cracks: &Cracks) {
        self.contacts.lay_anew(&self.lattice, cracks);
    }

    fn is_touching(&self) -> bool {
        self.touching.is_touching()
    }

    fn sliding(&self) -> Option<&dyn SlidingTips> {
        self.lattice.has_ties().then_some(self as &dyn SlidingTips)
    }

    fn sliding_mut(&mut self) -> Option<&mut dyn SlidingTips> {
        self.lattice.has_ties().then_some(self as &mut dyn SlidingTips)
    }

    fn stop(&mut self) {
        self.external_work += self.work_of_lag();
        (self.power_of_loads, self.power_of_gravity) = (0.0, 0.0);
        self.motion.stop();
    }

    fn set_damping(&mut self, rate: f64) {
        self.damping = rate;
    }
}

impl Snapshot for Total {
    fn add_motions(&self, frame: &mut ParticleFrame) {
        snapshot::add_motions(&self.lattice, &self.motion, frame);
    }

    fn outline_frames(&self) -> Vec<OutlineFrame> {
        snapshot::outline_frames(&self.scene, &self.probes, &self.motion)
    }

    fn crack_frames(&self, cracks: &Cracks) -> Vec<CrackFrame> {
        snapshot::crack_frames(cracks, &self.probes, &self.motion)
    }

    fn energies(&self) -> SolverEnergies {
        SolverEnergies {
            kinetic: self.kinetic_energy(),
            strain: snapshot::strain_energy(&self.lattice, &self.ties, &self.motion),
            external_work: self.external_work + self.work_of_lag(),
        }
    }

    fn reactions(&self) -> &[Reaction] {
        &self.reactions
    }

    fn work_in_doubt(&self) -> f64 {
        self.collision_work.max(0.0)
    }

    fn energy_of_lag(&self) -> f64 {
        snapshot::energy_of_lag(&self.lattice, &self.ties, &self.motion) + self.work_of_lag()
    }

    fn kinetic_energy(&self) -> f64 {
        snapshot::kinetic_energy(&self.lattice, &self.ties, &self.motion)
    }

    fn momenta(&self) -> (Vector, f64) {
        snapshot::momenta(&self.lattice, &self.ties, &self.motion)
    }

    fn rayleigh_quotient(&self) -> Option<f64> {
        stability::rayleigh_quotient(&self.lattice, &self.ties, &self.motion)
    }

    fn continuation(&self, cracks: &Cracks) -> Option<Continuation> {
        Some(Continuation {
            particles: snapshot::places_and_motions(&self.lattice, &self.motion),
            cracks: self.crack_frames(cracks),
            outlines: self.outline_frames(),
            external_work: self.external_work + self.work_of_lag(),
            reactions: self.reactions.clone(),
        })
    }

    fn save(&self) -> Result<Vec<u8>, SimulationError> {
        let saved = (
            &self.lattice.layout,
            &self.motion,
            &self.probes,
            &self.ties,
            (self.touching.last(), self.contacts.all_forces()),
            ([self.external_work, self.power_of_loads, self.power_of_gravity, self.collision_work], &self.reactions),
        );
        saved::to_bytes(&saved)
    }
}

impl SlidingTips for Total {
    fn release(&self, cracks: &Cracks, id: TipId) -> Release {
        self.ties.release(&self.lattice, &self.motion, cracks, id)
    }

    fn take_drag(&mut self, id: TipId) -> f64 {
        self.ties.take_drag(id)
    }

    fn give_back(&mut self, id: TipId, energy: f64) -> bool {
        self.ties.give_back(&self.lattice, &self.motion, id, energy)
    }

    fn take_refused(&mut self) -> f64 {
        self.ties.take_refused()
    }

    fn take_settled(&mut self) -> Vec<(TipId, f64)> {
        std::mem::take(&mut self.settled)
    }

    fn slide(&mut self, cracks: &Cracks, id: TipId) {
        let retied = self.ties.soften(&self.lattice, cracks, id);
        self.supports.retie(&self.scene, &self.lattice, &self.ties, &retied);
        self.probes.move_last_faces(&self.lattice, cracks, id);
        self.loads.slide(id, &self.scene, &self.lattice, cracks);
    }
}

/// Between two steps.
impl Observed for Total {
    fn tells_bends(&self) -> bool {
        true
    }

    fn tip_zone(&self, cracks: &Cracks, id: TipId, radius: f64) -> TipZone {
        self.look(0.0).tip_zone(cracks, id, radius)
    }

    fn opening(&self, cracks: &Cracks, id: TipId, into: Matrix) -> Opening {
        self.look(0.0).opening(cracks, id, into)
    }

    fn tip_now(&self, cracks: &Cracks, id: TipId) -> (Point, Vector) {
        self.look(0.0).tip_now(cracks, id)
    }
}
