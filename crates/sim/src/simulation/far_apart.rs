//! Bodies that are far apart do not know of each other.
#![allow(clippy::unwrap_used)]

use super::Simulation;
use crate::test_scenes::{add_body, add_crack, free_body, rectangle, set_motion};
use fissure_scene::{BoxSide, Formulation, InitialVelocity, Kernel, Load, LoadKind, Point, Scene, Selection, Vector};

/// A cracked plate that turns while one of its sides is pulled, by given steps.
fn plate(formulation: Formulation) -> Scene {
    let mut scene = free_body(rectangle([0.0, 0.0], [4.0, 4.0]), 0.125);
    scene.solver.formulation = formulation;
    if formulation == Formulation::Total {
        scene.solver.kernel = Kernel::Bilinear;
    }
    scene.solver.time_step = Some(1e-3);
    add_crack(&mut scene, &[[0.0, 2.03], [2.1, 2.33]]);
    set_motion(&mut scene, Selection::All, [3.0, 1.0], 2.0, [2.0, 2.0]);
    scene.loads.push(Load {
        selection: Selection::Edge { side: BoxSide::Top, bodies: Some(vec![0]) },
        kind: LoadKind::Traction(Vector::new(0.0, 5.0)),
        curve: crate::test_scenes::always(),
    });
    scene
}

/// Truth: the plate alone, bit for bit. The other one lies above and to the right, so that places are counted from the
/// same corner, and flies away.
#[test]
fn a_body_far_away_changes_no_bit() {
    for formulation in [Formulation::Total, Formulation::Updated] {
        let alone = plate(formulation);
        let mut both = alone.clone();
        add_body(&mut both, [1e5, 4e4]);
        both.bodies[1].velocities.push(InitialVelocity {
            selection: Selection::All,
            velocity: Vector::new(40.0, -30.0),
            angular_velocity: 1.0,
            center: Point::new(1e5, 4e4),
        });
        let run = |scene: &Scene| {
            let mut simulation = Simulation::new(scene).unwrap();
            (0..40).for_each(|_| simulation.one_step(1e-3, false).unwrap());
            simulation.frame()
        };
        let (alone, both) = (run(&alone), run(&both));
        let count = alone.particles.position.len();
        assert_eq!(both.particles.position.len(), 2 * count);
        assert_eq!(alone.particles.position, both.particles.position[..count], "{formulation:?}");
        assert_eq!(alone.particles.cauchy_stress, both.particles.cauchy_stress[..count]);
        assert_eq!(alone.outlines[0], both.outlines[0]);
        assert_eq!(alone.cracks, both.cracks);
    }
}
