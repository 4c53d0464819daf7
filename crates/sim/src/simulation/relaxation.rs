//! Bringing a state to rest.

use super::Simulation;
use crate::SimulationError;
use crate::solver::Solver;

/// Steps between two looks of the dynamic relaxation at least: over fewer the ripple of the shortest waves shows
/// instead of the motion that is left.
const RELAXATION_ROUND: u32 = 12;

impl Simulation {
    /// Brings the state to rest under the loads of the present time; cracks do not grow.
    ///
    /// Dynamic relaxation (Underwood 1983): velocities are damped at twice the frequency of the motion that is left,
    /// from its Rayleigh quotient, so that the slowest motion comes to rest as fast as it can. Where the formulation
    /// cannot tell that frequency, velocities are set to zero at every peak of the kinetic energy instead, those of the
    /// moment of the strains: with v = 0 half a step before, each stop may make 1/(1 − (ω Δt/2)²) of the energy of a
    /// wave of frequency ω, and short waves grow. Stops when no more than `tolerance` of the strain energy is left as
    /// kinetic energy over a whole round, or after `most_steps`. Returns the number of steps. What has only begun to
    /// move has little of that: after small changes, as growth by half a cell, a tolerance of 1e-7 or less is called
    /// for.
    ///
    /// # Errors
    /// As [`Simulation::advance`].
    pub fn relax(&mut self, tolerance: f64, most_steps: u64) -> Result<u64, SimulationError> {
        self.measured = None;
        let time_step = self.largest_time_step();
        let time = self.state.time;
        let (mut peak, mut round_peak) = (0.0, 0.0_f64);
        let mut since = 0;
        let mut steps = most_steps;
        for step in 1..=most_steps {
            self.solver.step(&self.state.cracks, time, time_step, &mut |_| ())?;
            self.counts.steps += 1;
            let kinetic = self.solver.kinetic_energy();
            since += 1;
            round_peak = round_peak.max(kinetic);
            if since < RELAXATION_ROUND {
                continue;
            }
            let rested = |kinetic: f64, solver: &dyn Solver| kinetic <= tolerance * solver.energies().strain;
            if let Some(quotient) = self.solver.rayleigh_quotient() {
                if rested(round_peak, &*self.solver) {
                    steps = step;
                    break;
                }
                self.solver.set_damping(2.0 * quotient.sqrt());
                (round_peak, since) = (0.0, 0);
            } else if kinetic < peak {
                self.solver.stop_now();
                if rested(peak, &*self.solver) {
                    steps = step;
                    break;
                }
                (peak, since) = (0.0, 0);
            } else {
                peak = kinetic.max(peak);
            }
        }
        self.solver.set_damping(self.scene.solver.damping);
        self.solver.stop();
        self.measure_all();
        Ok(steps)
    }
}
