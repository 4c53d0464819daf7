//! What the two formulations have in common: the questions the rest of the crate asks a solver.

use crate::SimulationError;
use crate::crack::cracks::{Cracks, TipId};
use crate::tip::zone::TipZone;
use fissure_scene::{CrackFrame, Matrix, OutlineFrame, ParticleFrame, Point, Vector};

/// Energies that only the solver knows, per unit thickness [J/m].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct SolverEnergies {
    pub(crate) kinetic: f64,
    pub(crate) strain: f64,
    pub(crate) external_work: f64,
}

/// What one formulation hands to the other in mid-run.
#[derive(Debug, Clone)]
pub(crate) struct Handover {
    /// Of each particle: position [m], velocity [m/s], displacement gradient H = F − I [–].
    pub(crate) particles: Vec<(Point, Vector, Matrix)>,
    /// The cracks with both faces.
    pub(crate) cracks: Vec<CrackFrame>,
    /// The rings of all bodies.
    pub(crate) outlines: Vec<OutlineFrame>,
    /// Work done so far [J/m].
    pub(crate) external_work: f64,
}

/// Energy that a tip takes out of the body when it goes straight on by a distance [m] at once, everything else staying as it is [J/m]. It rises, ever less steeply.
pub(crate) type Release = Box<dyn Fn(f64) -> f64>;

/// A formulation of the solver.
pub(crate) trait Solver: std::fmt::Debug + Send {
    /// Largest stable time step for the present state [s].
    fn stable_time_step(&self) -> f64;

    /// An upper bound of [`Solver::stable_time_step`] that costs little, to be asked at every step; none where only the
    /// full computation can tell.
    fn moving_time_step(&self) -> Option<f64> {
        None
    }

    /// Goes from `time` to `time` + `time_step`. `observe` is called in mid-step, when displacements, velocities and accelerations belong to one moment.
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

    /// Takes up the cracks as they are now: `changed` ends have got new points at rest since the last call, or new ends.
    fn recut(&mut self, cracks: &Cracks, changed: &[TipId]);

    /// Whether tips can go a part of an increment; otherwise they jump from one to the next, and what follows here does nothing.
    fn slides(&self) -> bool {
        false
    }

    /// What a tip would take out of the body if it went straight on now.
    fn release(&self, _cracks: &Cracks, _id: TipId) -> Release {
        Box::new(|_| 0.0)
    }

    /// Energy that drag behind a tip has taken out of the body since the last call [J/m].
    fn take_drag(&mut self, _id: TipId) -> f64 {
        0.0
    }

    /// Takes up that an end has moved on along its segment since the last recut, by an increment at most.
    fn slide(&mut self, _cracks: &Cracks, _id: TipId) {}

    /// The solver as one that can be observed between steps.
    fn observed(&self) -> &dyn Observed;

    /// Kinetic energy [J/m]; cheap, unlike the rest of the budget.
    fn kinetic_energy(&self) -> f64;

    /// The state for a solver of the other formulation to go on with; none where there is none.
    fn hand_over(&mut self, cracks: &Cracks) -> Option<Handover>;

    /// Sets all velocities to zero.
    fn stop(&mut self);

    /// Rayleigh quotient ω² = v·K v / v·M v [1/s²] of the present velocities: what frequency the motion has. None where the formulation cannot tell cheaply.
    fn rayleigh_quotient(&self) -> Option<f64>;

    /// Lets velocities decay as exp(−rate t) from now on [1/s].
    fn set_damping(&mut self, rate: f64);

    /// Linear [N s/m] and angular momentum about the origin [N s], per unit thickness. Where velocities belong to a moment half a step before the
    /// displacements, that changes neither: it adds v × v = 0.
    fn momenta(&self) -> (Vector, f64);

    /// Energies now.
    fn energies(&self) -> SolverEnergies;

    /// The particles as a frame holds them (pieces left 0).
    fn particle_frame(&self) -> ParticleFrame;

    /// The rings of all bodies.
    fn outline_frames(&self) -> Vec<OutlineFrame>;

    /// The cracks with both faces.
    fn crack_frames(&self, cracks: &Cracks) -> Vec<CrackFrame>;

    /// The whole state, for going on later.
    fn save(&self) -> Result<Vec<u8>, SimulationError>;
}

/// A moment of a solver that can be looked at.
pub(crate) trait Observed {
    /// The material within `radius` [m] of a tip.
    fn tip_zone(&self, cracks: &Cracks, id: TipId, radius: f64) -> TipZone;

    /// Current position of a tip [m] and the current direction ahead of it (unit vector).
    fn tip_now(&self, cracks: &Cracks, id: TipId) -> (Point, Vector);
}
