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
    use crate::Elastic;
    use crate::test_scenes::{add_crack, free_body, rectangle, set_motion};
    use fissure_scene::{
        BoxSide, Collider, ColliderShape, Contact, Curve, Kernel, Matrix, Point, Pose, Scene, Selection, Support,
        Vector,
    };

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

    /// Truth: the closed form of a bar that is drawn out evenly, free to become thinner: with Ψ = μ|F − R|² + λ(J−1)²/2
    /// the stretch across is t = (2μ + λs)/(2μ + λs²).
    #[test]
    fn a_bar_drawn_out_goes_on_with_its_energy_and_stress() {
        let (length, height) = (6.0, 2.0);
        for stretch in [1.1, 1.5, 1.8] {
            let mut scene = free_body(rectangle([0.0, 0.0], [length, height]), 0.25);
            scene.solver.formulation = Formulation::Total;
            scene.solver.on_distortion = OnDistortion::Switch;
            scene.solver.kernel = Kernel::Bilinear;
            let elastic = Elastic::new(&scene.materials[0], scene.plane);
            let wave = elastic.dilatational_wave_speed();
            scene.solver.damping = wave / length;
            let drawn = (stretch - 1.0) * length / (0.05 * wave);
            for (side, velocity) in [(BoxSide::Left, 0.0), (BoxSide::Right, 0.05 * wave)] {
                scene.supports.push(Support {
                    selection: Selection::Edge { side, bodies: None },
                    velocity: [Some(velocity), None],
                    curve: Curve { points: vec![(0.0, 1.0), (drawn, 1.0), (drawn * (1.0 + 1e-9), 0.0)] },
                });
            }
            scene.frames.last = scene.frames.first + 2;
            scene.frames.rate = 1.0 / (drawn + 4.0 * length / wave);
            let mut simulation = Simulation::new(&scene).unwrap();
            simulation.advance(&mut |_| std::ops::ControlFlow::Continue(())).unwrap();
            let (mu, lambda) = (elastic.mu, elastic.lambda);
            let across = (2.0 * mu + lambda * stretch) / (2.0 * mu + lambda * stretch * stretch);
            let gradient = Matrix::new(stretch - 1.0, 0.0, 0.0, across - 1.0);
            let energy = length * height * crate::energy_density(&gradient, mu, lambda);
            let stress = crate::first_piola_stress(&gradient, mu, lambda);
            // Strain and kinetic energy, and the pull along the bar, by the closed form.
            let found = |simulation: &Simulation| {
                let gradients = simulation.frame().particles.deformation_gradient;
                let pull = |f: &Matrix| crate::first_piola_stress(&(f - Matrix::identity()), mu, lambda).m11;
                let pull = gradients.iter().map(pull).sum::<f64>() / gradients.len() as f64;
                let energies = simulation.energies();
                [energies.strain / energy, pull / stress.m11, energies.kinetic / energy]
            };
            let [strain, pull, kinetic] = found(&simulation);
            assert!((strain - 1.0).abs() < 2e-3 && (pull - 1.0).abs() < 2e-3 && kinetic < 1e-3, "{strain} {pull}");
            let error = SimulationError::OutOfRange { time: 0.0, x: 0.0, y: 0.0, cause: String::new() };
            simulation.switch_formulation(error).unwrap();
            let [strain_now, pull_now, kinetic_now] = found(&simulation);
            assert!((strain_now - strain).abs() < 1e-12 && (pull_now - pull).abs() < 1e-12 && kinetic_now <= kinetic);
            // The grid of the other formulation moves it a little, wherever the particles are on it.
            simulation.one_step(0.5 * simulation.solver.stable_time_step(), false).unwrap();
            let [strain, pull, kinetic] = found(&simulation);
            assert!((strain - 1.0).abs() < 1e-2 && (pull - 1.0).abs() < 1e-2 && kinetic < 2e-3, "{strain} {pull}");
        }
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
