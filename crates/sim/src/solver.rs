//! What a formulation is asked, by who asks: the run that steps it, the frames that read it, and tips that slide.

use crate::SimulationError;
use crate::boundary::supports::Reaction;
use crate::crack::cracks::{Cracks, TipId};
use crate::tip::side_by_side::FreeZone;
use crate::tip::zone::{Opening, TipZone};
use fissure_scene::{CrackFrame, Matrix, OutlineFrame, ParticleFrame, Point, Vector};

/// A formulation of the solver, as the run sees it.
pub(crate) trait Solver: Snapshot + Observed + std::fmt::Debug + Send {
    /// Largest stable time step for the present state [s].
    fn stable_time_step(&self) -> f64;

    /// What [`Solver::stable_time_step`] is by now, as well as can be told at little cost; `planned`: what it was when
    /// the run began [s]. None where it has not moved.
    fn moving_time_step(&self, planned: f64) -> Option<f64>;

    /// Goes from `time` to `time` + `time_step`. `observe` is called in mid-step, when displacements, velocities and
    /// accelerations belong to one moment.
    ///
    /// # Errors
    /// When the state is no longer finite or leaves the range of the formulation.
    fn step(
        &mut self,
        cracks: &Cracks,
        time: f64,
        time_step: f64,
        observe: &mut dyn FnMut(&dyn Observed),
    ) -> Result<(), SimulationError>;

    /// Looks whether the state is sound at `time` [s].
    ///
    /// # Errors
    /// When it is no longer finite or has left the range of the formulation.
    fn check(&self, time: f64) -> Result<(), SimulationError>;

    /// Divides the material by the cracks as they are now: `changed` ends have got new points at rest since the last
    /// call, or have become something else. Returns the energy that this has taken out of the body, as far as it is
    /// known [J/m].
    fn recut(&mut self, cracks: &Cracks, changed: &[TipId]) -> f64;

    /// The solver as one whose tips can go a part of an increment; none where they jump from one to the next.
    fn sliding(&self) -> Option<&dyn SlidingTips>;

    /// As [`Solver::sliding`], to let them.
    fn sliding_mut(&mut self) -> Option<&mut dyn SlidingTips>;

    /// A run of steps begins, to the next frame or part of the way: what is remembered to save work is found anew, so
    /// that a run that goes on from here gives the same.
    fn begin_run(&mut self);

    /// A frame ends: what was laid where tips were is laid where they are, as it is when a run goes on from here.
    fn end_frame(&mut self, cracks: &Cracks);

    /// Whether surfaces have touched in the last step.
    fn is_touching(&self) -> bool;

    /// Sets all velocities to zero.
    fn stop(&mut self);

    /// Sets all velocities to zero now: those that the next step begins with are of half a step before.
    fn stop_now(&mut self) {
        self.stop();
    }

    /// Lets velocities decay as exp(−rate t) from now on [1/s].
    fn set_damping(&mut self, rate: f64);
}

/// What can be read from a solver between two steps.
pub(crate) trait Snapshot {
    /// Adds to `frame`, which has what some particles are at rest, how these move.
    fn add_motions(&self, frame: &mut ParticleFrame);

    /// The rings of all bodies.
    fn outline_frames(&self) -> Vec<OutlineFrame>;

    /// The cracks with both faces.
    fn crack_frames(&self, cracks: &Cracks) -> Vec<CrackFrame>;

    /// Energies now.
    fn energies(&self) -> SolverEnergies;

    /// What each support has done so far.
    fn reactions(&self) -> &[Reaction];

    /// What the sum of kinetic and strain energy lacks because its velocities are those of half a step before [J/m].
    /// Costs an evaluation of all forces.
    fn energy_of_lag(&self) -> f64;

    /// Energy that a sound body may have beyond the work that is counted [J/m]: what came in over half of the last
    /// step, where energies belong to moments half a step apart and [`Solver::energy_of_lag`] does not know by how
    /// much they differ; what obstacles have given to waves of the lattice that bounced against them.
    fn work_in_doubt(&self) -> f64;

    /// Kinetic energy [J/m]; cheap, unlike the other energies.
    fn kinetic_energy(&self) -> f64;

    /// Linear [N s/m] and angular momentum about the origin [N s], per unit thickness. Where velocities belong to a
    /// moment half a step before the displacements, that changes neither: it adds v × v = 0.
    fn momenta(&self) -> (Vector, f64);

    /// Rayleigh quotient ω² = v·K v / v·M v [1/s²] of the present velocities: what frequency the motion has. None where
    /// the formulation cannot tell cheaply.
    fn rayleigh_quotient(&self) -> Option<f64>;

    /// What a solver of the other formulation needs to go on from here; none where there is no other.
    fn continuation(&self, cracks: &Cracks) -> Option<Continuation>;

    /// The whole state as bytes, for going on later.
    ///
    /// # Errors
    /// [`SimulationError::NotSaved`]
    fn save(&self) -> Result<Vec<u8>, SimulationError>;
}

/// A moment of a solver at which tips can be looked at, several at once.
pub(crate) trait Observed: Sync {
    /// Whether its zones tell how a crack is bent behind its tip.
    fn tells_bends(&self) -> bool;

    /// The material within `radius` [m] of a tip.
    fn tip_zone(&self, cracks: &Cracks, id: TipId, radius: f64) -> TipZone;

    /// The opening behind a tip, and the distance at which it was taken; `into`: [`TipZone::into`].
    fn opening(&self, cracks: &Cracks, id: TipId, into: Matrix) -> Opening;

    /// As [`Observed::tip_zone`], side by side. None where something presses on faces from outside, where points do not
    /// end where the crack is drawn, and, but `with_contacts`, where faces do something to each other.
    fn free_zone(&self, _cracks: &Cracks, _id: TipId, _radius: f64, _with_contacts: bool) -> Option<FreeZone> {
        None
    }

    /// The largest distance by which the two sides of a node around a tip have come apart [m]; none where that is not
    /// known.
    fn parted_at_tip(&self, _id: TipId) -> Option<f64> {
        None
    }

    /// Current position of a tip [m] and the current direction ahead of it (unit vector).
    fn tip_now(&self, cracks: &Cracks, id: TipId) -> (Point, Vector);
}

/// A solver whose tips can go a part of an increment, as far as the energy that they release pays for.
pub(crate) trait SlidingTips {
    /// What a tip would take out of the body if it went straight on now.
    fn release(&self, cracks: &Cracks, id: TipId) -> Release;

    /// Energy that drag behind a tip has taken out of the body since the last call [J/m].
    fn take_drag(&mut self, id: TipId) -> f64;

    /// Lets the energy `energy` [J/m] that a tip has taken beyond what it needs, or that has ended since the last step,
    /// drive the faces behind it apart within the next one. Whether there are such faces.
    fn give_back(&mut self, id: TipId, energy: f64) -> bool;

    /// Energy that was to go back into the body since the last call and found no faces [J/m].
    fn take_refused(&mut self) -> f64;

    /// Energy that tips have given in the last step for what their cuts had left strained without force [J/m].
    fn take_settled(&mut self) -> Vec<(TipId, f64)>;

    /// Follows an end that has moved on along its segment since the last recut, by an increment at most.
    fn slide(&mut self, cracks: &Cracks, id: TipId);
}

/// Energy that a tip takes out of the body when it goes straight on by a distance [m] at once, everything else staying
/// as it is [J/m]. It rises, ever less steeply.
pub(crate) type Release = Box<dyn Fn(f64) -> f64>;

/// Energies that only the solver knows, per unit thickness [J/m].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct SolverEnergies {
    pub(crate) kinetic: f64,
    pub(crate) strain: f64,
    pub(crate) external_work: f64,
}

/// What the other formulation goes on from in mid-run.
#[derive(Debug, Clone)]
pub(crate) struct Continuation {
    /// Of each particle: position [m], velocity [m/s], displacement gradient H = F − I [–].
    pub(crate) particles: Vec<(Point, Vector, Matrix)>,
    /// The cracks with both faces.
    pub(crate) cracks: Vec<CrackFrame>,
    /// The rings of all bodies.
    pub(crate) outlines: Vec<OutlineFrame>,
    /// Work done so far [J/m].
    pub(crate) external_work: f64,
    /// What each support has done so far.
    pub(crate) reactions: Vec<Reaction>,
}
