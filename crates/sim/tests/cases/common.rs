//! Scenes built in code, and runs of them. Every `Scene` literal of these tests is here.

use fissure_scene::{
    Body, BoxSide, Crack, Curve, Formulation, Frame, FrameSettings, Guide, InitialVelocity, Load, LoadKind, Material,
    OutputSettings, PlaneState, Point, Region, Scene, Selection, SolverPreset, Support, UpAxis, Vector, solver_preset,
    updated_kernel,
};
use fissure_sim::{Simulation, SimulationError};
use std::ops::ControlFlow;

/// E [Pa] of [`plate`].
pub(crate) const YOUNG: f64 = 1e9;
/// ν of [`plate`].
pub(crate) const POISSON: f64 = 0.3;
/// ρ [kg/m³] of [`plate`].
pub(crate) const DENSITY: f64 = 1000.0;

/// A rectangle from `low` to `high` [m].
pub(crate) fn rectangle(low: [f64; 2], high: [f64; 2]) -> Region {
    let exterior = vec![Point::from(low), Point::new(high[0], low[1]), Point::from(high), Point::new(low[0], high[1])];
    Region { exterior, holes: Vec::new() }
}

/// A plate from the origin to `size` [m] in cells of `cell_size` [m], standard preset, total Lagrangian, plane strain,
/// cracks free to grow; nothing acts on it. Frames: the first only, `frame_time` [s] apart once there are more.
pub(crate) fn plate(size: [f64; 2], cell_size: f64, frame_time: f64) -> Scene {
    let (mut solver, growth) = solver_preset(SolverPreset::Standard);
    solver.formulation = Formulation::Total;
    Scene {
        name: "case".into(),
        hash: String::new(),
        plane: PlaneState::Strain,
        materials: vec![Material {
            name: "stiff".into(),
            young_modulus: YOUNG,
            poisson_ratio: POISSON,
            density: DENSITY,
            fracture_toughness: 1e4,
            limiting_speed: None,
            plasticity: None,
        }],
        bodies: vec![Body {
            name: "plate".into(),
            region: rectangle([0.0; 2], size),
            material: 0,
            inclusions: Vec::new(),
            velocities: Vec::new(),
            turns: Vec::new(),
        }],
        cracks: Vec::new(),
        colliders: Vec::new(),
        toughness: Vec::new(),
        contact: Default::default(),
        take: Default::default(),
        gravity: Vector::zeros(),
        loads: Vec::new(),
        supports: Vec::new(),
        particle_spacing: 0.5 * cell_size,
        cell_size,
        solver,
        growth,
        frames: FrameSettings { first: 0, last: 0, rate: 1.0 / frame_time, playback: 24.0 },
        output: OutputSettings {
            thickness: 1.0,
            formats: Vec::new(),
            parts: Vec::new(),
            up: UpAxis::Z,
            smallest_fragment: 0.0,
            walls: Default::default(),
            surfaces: Default::default(),
            opening: None,
            explode: None,
            attributes: Vec::new(),
        },
    }
}

/// The same scene in the updated Lagrangian formulation.
pub(crate) fn updated(mut scene: Scene) -> Scene {
    scene.solver.formulation = Formulation::Updated;
    scene.solver.kernel = updated_kernel();
    scene
}

/// Adds a crack through `points` [m]; ends inside the body are live tips.
pub(crate) fn add_crack(scene: &mut Scene, points: &[[f64; 2]]) {
    scene.cracks.push(Crack {
        name: format!("crack {}", scene.cracks.len()),
        body: 0,
        points: points.iter().map(|&p| Point::from(p)).collect(),
        start_live: true,
        end_live: true,
        start_guide: None,
        end_guide: None,
        crosses: false,
    });
}

/// A path to follow through `points` [m].
pub(crate) fn guide(points: &[[f64; 2]]) -> Guide {
    let points = points.iter().map(|&p| Point::from(p)).collect();
    Guide { name: "guide".into(), points, strength: 1.0, schedule: Curve::default(), branches: Vec::new() }
}

/// Adds a traction [Pa] on a side of the box.
pub(crate) fn add_traction(scene: &mut Scene, side: BoxSide, traction: [f64; 2]) {
    scene.loads.push(Load {
        selection: Selection::Edge { side, bodies: None },
        kind: LoadKind::Traction(Vector::from(traction)),
        curve: Curve::default(),
    });
}

/// Tractions of `stress` [Pa] on top and bottom, outwards.
pub(crate) fn pull(scene: &mut Scene, stress: f64) {
    add_traction(scene, BoxSide::Top, [0.0, stress]);
    add_traction(scene, BoxSide::Bottom, [0.0, -stress]);
}

/// Prescribes the velocity of a selection [m/s].
pub(crate) fn hold(scene: &mut Scene, selection: Selection, velocity: [Option<f64>; 2]) {
    scene.supports.push(Support { selection, velocity, curve: Curve::default() });
}

/// Adds an initial velocity [m/s] within `selection`.
pub(crate) fn set_velocity(scene: &mut Scene, selection: Selection, velocity: [f64; 2]) {
    scene.bodies[0].velocities.push(InitialVelocity {
        selection,
        velocity: Vector::from(velocity),
        angular_velocity: 0.0,
        center: Point::origin(),
    });
}

/// Runs `count` more frames.
pub(crate) fn run(simulation: &mut Simulation, count: usize) -> Result<Frame, SimulationError> {
    for _ in 0..count {
        simulation.advance(&mut |_| ControlFlow::Continue(()))?;
    }
    Ok(simulation.frame())
}

/// Checks that a frame holds finite numbers only.
pub(crate) fn finite(name: &str, frame: &Frame) {
    let particles = &frame.particles;
    let vectors = particles.velocity.iter().chain(frame.outlines.iter().flat_map(|o| &o.velocity));
    let vectors = vectors.chain(frame.cracks.iter().flat_map(|c| c.above_velocity.iter().chain(&c.below_velocity)));
    assert!(vectors.flatten().all(|x| x.is_finite()), "{name}: velocities");
    let points = particles.position.iter().chain(frame.outlines.iter().flat_map(|o| &o.position));
    let points = points.chain(frame.cracks.iter().flat_map(|c| c.rest.iter().chain(&c.above).chain(&c.below)));
    assert!(points.flat_map(|p| p.iter()).all(|x| x.is_finite()), "{name}: places");
    let tensors = particles.deformation_gradient.iter().chain(&particles.cauchy_stress);
    assert!(tensors.flatten().all(|x| x.is_finite()), "{name}: deformations and stresses");
    for t in &frame.tips {
        let numbers = [t.position.x, t.position.y, t.direction, t.j_integral, t.mode_1, t.mode_2, t.kink_angle];
        let more = [t.equivalent, t.fracture_toughness, t.speed, t.length, t.contour_radius];
        assert!(numbers.iter().chain(&more).all(|x| x.is_finite()), "{name}: {t:?}");
        assert!(t.kink_angle.to_degrees().abs() < 70.53 && t.equivalent >= 0.0, "{name}: {t:?}");
    }
    let e = frame.energies;
    assert!([e.kinetic, e.strain, e.external_work, e.crack].iter().all(|x| x.is_finite()), "{name}: {e:?}");
}
