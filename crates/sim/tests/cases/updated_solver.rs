//! The updated Lagrangian formulation under loads, supports and colliders, against closed forms.

use crate::common::{
    DENSITY, POISSON, YOUNG, add_crack, add_traction, finite, hold, plate, pull, rectangle, run, updated,
};
use fissure_scene::{
    Body, BoxSide, Collider, ColliderShape, Contact, Frame, Kernel, Point, Pose, Scene, Selection, Transfer, Vector,
};
use fissure_sim::Simulation;
use std::f64::consts::PI;

fn edge(side: BoxSide) -> Selection {
    Selection::Edge { side, bodies: None }
}

/// A half-plane of which the surface moves along y: at `y` [m] at the time 0 with `speed` [m/s].
fn add_floor(scene: &mut Scene, y: f64, speed: f64) {
    let pose = |time: f64| Pose { position: Point::new(0.0, y + speed * time), angle: 0.0 };
    scene.colliders.push(Collider {
        name: "floor".into(),
        shape: ColliderShape::HalfPlane { normal: Vector::new(0.0, 1.0) },
        keyframes: vec![(0.0, pose(0.0)), (10.0, pose(10.0))],
        contact: Contact::Separate,
        friction: 0.0,
    });
}

/// Truth: equilibrium. A block on a floor has σ_yy = −ρ g (H − y), and does not sink in.
#[test]
fn a_floor_carries_the_weight_of_a_block() {
    let mut scene = plate([2.0, 2.0], 0.125, 1.0);
    scene.gravity = Vector::new(0.0, -10.0);
    add_floor(&mut scene, 0.0, 0.0);
    let mut simulation = Simulation::new(&updated(scene)).unwrap();
    simulation.relax(1e-6, 6000).unwrap();
    let frame = simulation.frame();
    let weight = DENSITY * 10.0 * 2.0;
    // The three cells at the floor have 94 % of the weight in the mean, but shared out unevenly.
    for row in 6..32 {
        let y = (f64::from(row) + 0.5) / 16.0;
        let particles = frame.particles.rest.iter().zip(&frame.particles.cauchy_stress);
        let stresses: Vec<f64> = particles.filter(|(x, _)| (x.y - y).abs() < 1e-6).map(|(_, s)| s.m22).collect();
        let mean = stresses.iter().sum::<f64>() / stresses.len() as f64;
        assert!((mean / weight + (1.0 - 0.5 * y)).abs() < 0.02, "{} at y = {y}", mean / weight);
    }
    let lowest = frame.particles.position.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    // The lowest cell is shortened by less than weight over stiffness.
    assert!((0.0..0.125 * weight / YOUNG).contains(&(1.0 / 32.0 - lowest)), "{lowest}");
}

/// Truth: the prescription, to round-off: velocity and way of the particles in a held region.
#[test]
fn prescribed_velocities_are_kept() {
    for transfer in [Transfer::Apic, Transfer::Pic, Transfer::Flip(1.0)] {
        let mut scene = plate([4.0, 2.0], 0.25, 1e-3);
        let layer = |from: f64, to: f64| Selection::Region(rectangle([from, -0.1], [to, 2.1]));
        hold(&mut scene, layer(-0.1, 0.12), [Some(-0.3), Some(0.1)]);
        hold(&mut scene, layer(3.88, 4.1), [Some(0.0), None]);
        let mut scene = updated(scene);
        scene.solver.transfer = transfer;
        let mut simulation = Simulation::new(&scene).unwrap();
        let frame = run(&mut simulation, 5).unwrap();
        let p = &frame.particles;
        let mut held = 0;
        for k in 0..p.len() {
            let way = p.position[k] - p.rest[k];
            if p.rest[k].x < 0.125 {
                held += 1;
                assert_eq!(p.velocity[k], Vector::new(-0.3, 0.1));
                assert!((way - Vector::new(-0.3, 0.1) * frame.time).norm() < 1e-14, "{way}");
            } else if p.rest[k].x > 3.875 {
                held += 1;
                assert_eq!((p.velocity[k].x, way.x), (0.0, 0.0));
            }
        }
        assert_eq!(held, 32);
    }
}

/// (kinetic + strain energy gained) / work done by what acts.
fn gain(frame: &Frame, first: &Frame) -> f64 {
    let held = |f: &Frame| f.energies.kinetic + f.energies.strain;
    (held(frame) - held(first)) / frame.energies.external_work
}

/// Truth: energy. What loads, supports, gravity and colliders do is what the body gains, as long as the transfer loses
/// nothing (FLIP).
#[test]
fn work_is_the_energy_gained() {
    let mut cases: Vec<(&str, Scene)> = Vec::new();
    let body = || plate([4.0, 2.0], 0.125, 1e-3);
    let mut scene = body();
    add_traction(&mut scene, BoxSide::Right, [1e6, 0.0]);
    cases.push(("traction", scene));
    let mut scene = body();
    hold(&mut scene, edge(BoxSide::Left), [Some(-1.0), None]);
    cases.push(("support", scene));
    let mut scene = body();
    scene.gravity = Vector::new(3.0, -10.0);
    cases.push(("gravity", scene));
    let mut scene = body();
    add_floor(&mut scene, -0.01, 1.0);
    cases.push(("collider", scene));
    for (name, scene) in cases {
        let mut scene = updated(scene);
        scene.solver.transfer = Transfer::Flip(1.0);
        let mut simulation = Simulation::new(&scene).unwrap();
        let first = simulation.frame();
        let frame = run(&mut simulation, 5).unwrap();
        finite(name, &frame);
        let ratio = gain(&frame, &first);
        match name {
            // v at the end of a step does the work, and Σ v Δt over n steps is (n + 1)/n times the way: the kick that
            // starts a leapfrog should be half a step.
            "gravity" => {
                let steps = simulation.steps() as f64;
                assert!((ratio - steps / (steps + 1.0)).abs() < 1e-10, "{ratio}");
            }
            // Measured: 0.976 and 0.978; 0.993 and 0.984 at a step of an eighteenth.
            "traction" | "support" => assert!((0.97..1.0).contains(&ratio), "{name}: {ratio}"),
            // Contact takes the velocity of approach and gives none back: at most the energy of a row of cells, one of
            // eight. Measured: 0.936, and 0.932 at 0.7 of the step.
            _ => assert!((0.875..1.0).contains(&ratio), "{name}: {ratio}"),
        }
    }
}

/// Truth: free fall, y = −g t² / 2 but for the half step at the start, without strain. Within a single frame the block
/// becomes faster than its waves; steps that were planned at rest would carry it over several cells at once.
#[test]
fn steps_become_shorter_while_a_block_becomes_faster() {
    let (gravity, time) = (5e4, 0.1);
    let mut scene = plate([2.0, 1.0], 0.125, time);
    scene.gravity = Vector::new(0.0, -gravity);
    let mut simulation = Simulation::new(&updated(scene)).unwrap();
    let frame = run(&mut simulation, 1).unwrap();
    let way = 0.5 * gravity * time * time;
    for k in 0..frame.particles.len() {
        let fallen = frame.particles.rest[k].y - frame.particles.position[k].y;
        assert!((fallen / way - 1.0).abs() < 1.5e-3, "{fallen}");
        assert!(frame.particles.cauchy_stress[k].norm() < 1e-6 * YOUNG);
    }
}

/// Truth: σ² (1 − ν²)/(2 E) per area under a stress σ, in plates that lie within a cell as a second body says. With
/// velocities that are zero half a step before each stop short waves grow, with these kernels and transfers
/// without bound.
#[test]
fn coming_to_rest_lets_no_waves_grow() {
    let (stress, size) = (1e4, [5.0, 10.0]);
    let expected = stress * stress * (1.0 - POISSON * POISSON) / (2.0 * YOUNG) * size[0] * size[1];
    for (kernel, transfer) in [(Kernel::Gimp, Transfer::Aflip), (Kernel::Bilinear, Transfer::Flip(1.0))] {
        for shift in [[0.5, 0.5], [0.63, 0.28], [0.05, 0.73]] {
            let mut scene = updated(plate(size, 1.0, 1.0));
            (scene.solver.kernel, scene.solver.transfer) = (kernel, transfer);
            pull(&mut scene, stress);
            scene.loads.iter_mut().for_each(|load| load.selection = of_first_body(&load.selection));
            let corner = [-8.0 - shift[0], -8.0 - shift[1]];
            let body = Body { region: rectangle(corner, corner.map(|x| x + 2.0)), ..scene.bodies[0].clone() };
            scene.bodies.push(body);
            let mut simulation = Simulation::new(&scene).unwrap();
            simulation.relax(1e-8, 2000).unwrap();
            let part = simulation.energies().strain / expected;
            assert!((part - 1.0).abs() < 0.2, "{kernel:?} {transfer:?} {shift:?}: {part}");
        }
    }
}

/// The same edge of the first body alone.
fn of_first_body(selection: &Selection) -> Selection {
    match selection {
        Selection::Edge { side, .. } => Selection::Edge { side: *side, bodies: Some(vec![0]) },
        other => other.clone(),
    }
}

/// Truth: K_I of an edge crack, a/W = 0.4, H/W = 2: 2.1127 σ √(πa) (own finite element solution, converged to 1e-4).
#[test]
fn an_edge_crack_is_within_the_known_error_of_the_kernel() {
    for y in [10.0, 10.13, 10.25, 10.4] {
        let mut scene = plate([10.0, 20.0], 0.5, 1.0);
        scene.growth.enabled = false;
        scene.solver.crack_contact = false;
        scene.solver.area_term = false;
        add_crack(&mut scene, &[[0.0, y], [4.0, y]]);
        pull(&mut scene, 1e4);
        let mut simulation = Simulation::new(&updated(scene)).unwrap();
        simulation.relax(1e-8, 8000).unwrap();
        let t = simulation.frame().tips[0];
        let reference = 2.1127 * 1e4 * (4.0 * PI).sqrt();
        let of_j = (t.j_integral * YOUNG / (1.0 - POISSON * POISSON)).sqrt();
        // Measured: −0.6 to 2.5 % too much, the most on a grid line; K_II up to 0.1 %.
        for mode_1 in [t.mode_1, of_j] {
            assert!((-0.01..0.03).contains(&(mode_1 / reference - 1.0)), "{mode_1} at {y}");
        }
        assert!((t.mode_2 / reference).abs() < 2e-3, "{t:?}");
    }
}
