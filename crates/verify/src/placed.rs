//! A simulation somewhere on the grid, read as if it were where the case has built it.

use crate::placement::Placement;
use fissure_scene::{Energies, Frame, Scene, TipRecord, Vector};
use fissure_sim::{Counts, Simulation, SimulationError};
use std::ops::ControlFlow;

/// A simulation of a placed scene. What is read from it is in the frame of the scene that was placed.
pub(crate) struct Placed {
    simulation: Simulation,
    placement: Placement,
}

/// A [`Placed`] simulation at one moment.
#[derive(Clone, Copy)]
pub(crate) struct Moment<'s> {
    simulation: &'s Simulation,
    placement: Placement,
}

impl Placed {
    /// Sets up `scene` at the place that it can have nearest to `placement`.
    ///
    /// # Errors
    /// When the solver refuses the scene.
    pub(crate) fn new(scene: &Scene, placement: Placement) -> Result<Self, SimulationError> {
        let placement = placement.fitted(scene);
        Ok(Self { simulation: Simulation::new(&placement.place(scene))?, placement })
    }

    /// Brings it to rest; see [`Simulation::relax`].
    pub(crate) fn relax(&mut self, tolerance: f64, most_steps: u64) -> Result<u64, SimulationError> {
        self.simulation.relax(tolerance, most_steps)
    }

    /// Runs to the next frame.
    pub(crate) fn advance(&mut self) -> Result<(), SimulationError> {
        self.simulation.advance(&mut |_| ControlFlow::Continue(()))?;
        Ok(())
    }

    /// Runs to the next frame; `watch` sees each step, and ends the run by breaking. Whether it did not.
    pub(crate) fn advance_observed(
        &mut self,
        watch: &mut dyn FnMut(Moment<'_>) -> ControlFlow<()>,
    ) -> Result<bool, SimulationError> {
        let placement = self.placement;
        self.simulation.advance_observed(&mut |simulation, _| watch(Moment { simulation, placement }))
    }

    /// As it is now.
    pub(crate) fn now(&self) -> Moment<'_> {
        Moment { simulation: &self.simulation, placement: self.placement }
    }

    /// Whether all frames are done.
    pub(crate) fn is_finished(&self) -> bool {
        self.simulation.is_finished()
    }

    /// Number of particles.
    pub(crate) fn particles(&self) -> usize {
        self.simulation.particles()
    }

    /// Steps so far, those to rest left out.
    pub(crate) fn steps(&self) -> u64 {
        self.simulation.steps()
    }

    /// What the run has done so far.
    pub(crate) fn counts(&self) -> Counts {
        self.simulation.counts()
    }
}

impl Moment<'_> {
    /// Time [s].
    pub(crate) fn time(&self) -> f64 {
        self.simulation.time()
    }

    /// The tips.
    pub(crate) fn tips(&self) -> Vec<TipRecord> {
        self.simulation.tips().into_iter().map(|tip| self.placement.natural_tip(tip)).collect()
    }

    /// Energies [J/m].
    pub(crate) fn energies(&self) -> Energies {
        self.simulation.energies()
    }

    /// Linear momentum [N s/m], and angular momentum about the origin [N s].
    pub(crate) fn momenta(&self) -> (Vector, f64) {
        self.placement.natural_momenta(self.simulation.momenta())
    }

    /// Everything.
    pub(crate) fn frame(&self) -> Frame {
        self.placement.natural_frame(self.simulation.frame())
    }
}
