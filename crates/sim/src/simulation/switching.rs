//! From one formulation to the other in mid-run.

use super::Simulation;
use crate::{SimulationError, formulation};
use fissure_scene::{Formulation, OnDistortion};

impl Simulation {
    /// Goes on in the updated formulation after `error`, where that is what the scene wants.
    ///
    /// # Errors
    /// `error` itself when it is not material out of range, or the scene wants to stop.
    pub(super) fn switch_formulation(&mut self, error: SimulationError) -> Result<(), SimulationError> {
        let out_of_range = matches!(error, SimulationError::OutOfRange { .. });
        if !out_of_range || self.scene.solver.on_distortion != OnDistortion::Switch {
            return Err(error);
        }
        let Some(continuation) = self.solver.continuation(&self.state.cracks) else { return Err(error) };
        self.scene = formulation::settle(&self.scene, Formulation::Updated);
        self.solver = formulation::switch(&self.scene, self.particles.clone(), &self.state.cracks, continuation)?;
        self.formulation = Formulation::Updated;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::test_scenes::{add_crack, free_body, rectangle, set_motion};
    use fissure_scene::{Collider, ColliderShape, Contact, Kernel, Matrix, Point, Pose, Scene, Selection, Vector};

    /// A cracked block that flies, turns and swings.
    fn block() -> Scene {
        let mut scene = free_body(rectangle([0.0, 0.0], [4.0, 4.0]), 0.125);
        scene.solver.formulation = Formulation::Total;
        scene.solver.on_distortion = OnDistortion::Switch;
        scene.solver.kernel = Kernel::Bilinear;
        add_crack(&mut scene, &[[0.0, 2.03], [2.1, 2.03]]);
        set_motion(&mut scene, Selection::All, [3.0, 1.0], 2.0, [2.0, 2.0]);
        scene
    }

    fn momentum(simulation: &Simulation) -> Vector {
        let frame = simulation.frame();
        let mass = |p: usize| simulation.particles.mass[p];
        frame.particles.velocity.iter().enumerate().map(|(p, v)| v * mass(p)).sum()
    }

    /// Truth: conservation. Momentum and deformation to round-off; kinetic energy only falls, here by less than a per
    /// cent.
    #[test]
    fn a_switch_keeps_momentum_and_strain() {
        let mut simulation = Simulation::new(&block()).unwrap();
        for _ in 0..60 {
            simulation.one_step(1e-3, false).unwrap();
        }
        // The momentum of the fields is that of all particles at the speed they were given.
        let mass: f64 = simulation.particles.mass.iter().sum();
        let given = Vector::new(3.0, 1.0) * mass;
        let before = simulation.frame();
        let energies = simulation.energies();
        let error = SimulationError::OutOfRange { time: 0.0, x: 0.0, y: 0.0, cause: String::new() };
        simulation.switch_formulation(error).unwrap();
        assert_eq!(simulation.formulation(), Formulation::Updated);
        let after = simulation.frame();
        let now = simulation.energies();
        assert!((momentum(&simulation) - given).norm() < 1e-12 * given.norm(), "{:?}", momentum(&simulation));
        assert!((now.strain - energies.strain).abs() < 1e-12 * energies.strain, "{energies:?} {now:?}");
        assert!(now.kinetic <= energies.kinetic * (1.0 + 1e-12) && now.kinetic > 0.99 * energies.kinetic);
        for (a, b) in before.particles.deformation_gradient.iter().zip(&after.particles.deformation_gradient) {
            assert!((a - b).norm() < 1e-14);
        }
        assert!(before.cracks[0].above.iter().zip(&after.cracks[0].above).all(|(a, b)| (a - b).norm() < 1e-14));
        for (a, b) in before.outlines[0].position.iter().zip(&after.outlines[0].position) {
            assert!((a - b).norm() < 1e-14, "{a} {b}");
        }
        let still = |m: &Matrix| (m - Matrix::identity()).norm() < 1.0;
        simulation.one_step(1e-4, true).unwrap();
        assert!(simulation.frame().particles.deformation_gradient.iter().all(still));
    }

    /// A block that is thrown against a wall faster than the total formulation can follow goes on in the other one;
    /// asked to stop, it stops by name.
    #[test]
    fn a_crash_goes_on_in_the_updated_formulation() {
        let mut scene = free_body(rectangle([0.0, 0.0], [2.0, 2.0]), 0.125);
        scene.solver.formulation = Formulation::Total;
        scene.solver.kernel = Kernel::Bilinear;
        scene.frames.last = 5;
        scene.frames.rate = 60.0;
        set_motion(&mut scene, Selection::All, [0.0, -25.0], 0.0, [0.0, 0.0]);
        scene.colliders.push(Collider {
            name: "floor".into(),
            shape: ColliderShape::HalfPlane { normal: Vector::y() },
            keyframes: vec![(0.0, Pose { position: Point::new(0.0, -0.1), angle: 0.0 })],
            contact: Contact::Separate,
            friction: 0.0,
        });
        let run = |scene: &Scene| {
            let mut simulation = Simulation::new(scene)?;
            while !simulation.is_finished() {
                simulation.advance(&mut |_| std::ops::ControlFlow::Continue(()))?;
            }
            Ok::<_, SimulationError>(simulation.formulation())
        };
        assert!(matches!(run(&scene), Err(SimulationError::OutOfRange { .. })), "{:?}", run(&scene));
        scene.solver.on_distortion = OnDistortion::Switch;
        assert_eq!(run(&scene).unwrap(), Formulation::Updated);
    }
}
