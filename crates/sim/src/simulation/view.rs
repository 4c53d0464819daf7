//! What can be read from a simulation between two steps.

use super::{Counts, Simulation};
use crate::boundary::collider::Obstacle;
use crate::boundary::supports::Reaction;
use crate::material::elastic::Elastic;
use crate::solver::{Observed, SolverEnergies};
use fissure_scene::{Energies, Formulation, Frame, Pose, Scene, SupportRecord, TipRecord, Vector};

impl Simulation {
    /// The scene as it is simulated.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Whether the last frame has been reached.
    pub fn is_finished(&self) -> bool {
        self.state.frame_number >= self.scene.frames.last
    }

    /// The formulation in use; it changes in mid-run where the scene allows it.
    pub fn formulation(&self) -> Formulation {
        self.formulation
    }

    /// Number of the current frame.
    pub fn frame_number(&self) -> i64 {
        self.state.frame_number
    }

    /// Number of particles.
    pub fn particles(&self) -> usize {
        self.particles.len()
    }

    /// Steps taken so far.
    pub fn steps(&self) -> u64 {
        self.state.steps
    }

    /// Work done by this process so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Time since the start [s].
    pub fn time(&self) -> f64 {
        self.state.time
    }

    /// What was measured last at each tip that is or was live, as in a frame.
    pub fn tips(&self) -> Vec<TipRecord> {
        let observed: &dyn Observed = &*self.solver;
        let cracks = &self.state.cracks;
        let mut tips = Vec::new();
        for id in cracks.ids().filter(|&id| cracks.tip(id).is_some()) {
            let (position, ahead) = observed.tip_now(cracks, id);
            let direction = ahead.y.atan2(ahead.x);
            tips.extend(cracks.of(id).record(id, position, direction, self.state.interval));
        }
        tips
    }

    /// Elastic constants at a tip that [`Simulation::tips`] tells of; none: there is no such crack.
    pub fn elastic_at(&self, tip: &TipRecord) -> Option<&Elastic> {
        let id = self.state.cracks.ids().find(|id| id.crack == tip.crack as usize && id.end == tip.end)?;
        let cracks = &self.state.cracks;
        let body = self.scene.bodies.get(cracks.of(id).body as usize)?;
        self.elastic.get(body.material_at(cracks.position(id)))
    }

    /// Energy budget now, with the kinetic energy of half a step before in the total formulation.
    pub fn energies(&self) -> Energies {
        self.budget(self.solver.energies(), 0.0)
    }

    /// With what the kinetic energy lacks [J/m].
    fn budget(&self, of: SolverEnergies, lag: f64) -> Energies {
        Energies {
            kinetic: of.kinetic + lag,
            strain: of.strain,
            external_work: of.external_work,
            crack: self.state.crack_energy,
        }
    }

    /// Energies now, and what the kinetic one lacks because its velocities are those of half a step before [J/m]. Costs
    /// an evaluation of all forces.
    pub(super) fn measure(&self) -> (SolverEnergies, f64) {
        (self.solver.energies(), self.solver.energy_of_lag())
    }

    /// Kinetic and strain energy of one moment [J/m]. Those that [`Simulation::energies`] tells belong to moments half
    /// a step apart, so that their sum ripples. Costs an evaluation of all forces.
    pub fn energy_held(&self) -> f64 {
        let energies = self.solver.energies();
        energies.kinetic + energies.strain + self.solver.energy_of_lag()
    }

    /// Energy budget now, as in a frame, with the kinetic energy of the same moment as the strain energy. Costs an
    /// evaluation of all forces.
    pub fn energies_of_one_moment(&self) -> Energies {
        let (energies, lag) = self.measured.unwrap_or_else(|| self.measure());
        self.budget(energies, lag)
    }

    /// Kinetic energy, half a step before now in the total formulation [J/m]; cheap, unlike the other energies.
    pub fn kinetic_energy(&self) -> f64 {
        self.solver.kinetic_energy()
    }

    /// Force times time that each support has exerted on the material since the start, along x and y [N s/m].
    pub fn support_impulses(&self) -> Vec<[f64; 2]> {
        self.solver.reactions().iter().map(|reaction| reaction.impulse).collect()
    }

    /// Linear [N s/m] and angular momentum about the origin [N s] now, per unit thickness.
    pub fn momenta(&self) -> (Vector, f64) {
        self.solver.momenta()
    }

    /// The current state as a frame.
    pub fn frame(&self) -> Frame {
        self.frame_of(|_| None)
    }

    /// The current state as a frame with the particles that `choose` names, rising, none standing for all: it is given
    /// the frame with all particles, but without how these move. Takes no more memory than what is chosen needs.
    pub fn frame_of(&self, choose: impl FnOnce(&Frame) -> Option<Vec<usize>>) -> Frame {
        let mut particles = self.particles.frame_at_rest();
        particles.piece.clone_from(&self.state.fragments);
        let mut frame = Frame {
            number: self.state.frame_number,
            time: self.state.time,
            particles,
            outlines: self.solver.outline_frames(),
            cracks: self.solver.crack_frames(&self.state.cracks),
            tips: self.tips(),
            energies: self.energies_of_one_moment(),
            colliders: self.collider_poses(),
            supports: self.support_records(),
        };
        if let Some(chosen) = choose(&frame) {
            frame.particles = frame.particles.chosen(&chosen);
        }
        self.solver.add_motions(&mut frame.particles);
        frame
    }

    /// What each support does, as in a frame.
    pub fn support_records(&self) -> Vec<SupportRecord> {
        let interval = self.state.interval;
        let record = |(reaction, before): (&Reaction, &[f64; 2])| {
            let mean = |axis: usize| (reaction.impulse[axis] - before[axis]) / interval;
            let force = if interval > 0.0 { Vector::new(mean(0), mean(1)) } else { Vector::zeros() };
            SupportRecord { force, work: reaction.work }
        };
        self.solver.reactions().iter().zip(&self.state.impulses).map(record).collect()
    }

    fn collider_poses(&self) -> Vec<Pose> {
        let time = self.state.time;
        self.scene.colliders.iter().map(|c| Obstacle::new(c).at(time).pose()).collect()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use crate::Simulation;
    use crate::test_scenes::{add_crack, free_body, rectangle, set_motion};
    use fissure_scene::{Formulation, Selection};

    /// Truth: the whole frame.
    #[test]
    fn a_frame_of_some_particles_has_them_as_the_whole_one() {
        for formulation in [Formulation::Total, Formulation::Updated] {
            let mut scene = free_body(rectangle([0.0, 0.0], [4.0, 4.0]), 0.25);
            scene.solver.formulation = formulation;
            add_crack(&mut scene, &[[0.0, 2.03], [2.1, 2.03]]);
            set_motion(&mut scene, Selection::All, [3.0, 1.0], 2.0, [2.0, 2.0]);
            let mut simulation = Simulation::new(&scene).unwrap();
            for _ in 0..9 {
                simulation.one_step(1e-3, false).unwrap();
            }
            let whole = simulation.frame();
            let numbers = [3, 77, 140, 255];
            let some = simulation.frame_of(|frame| {
                assert_eq!(frame.particles.rest, whole.particles.rest);
                Some(numbers.to_vec())
            });
            assert_eq!(some.particles, whole.particles.chosen(&numbers));
            assert_eq!((some.particles.velocity.len(), &some.cracks), (4, &whole.cracks));
        }
    }
}
