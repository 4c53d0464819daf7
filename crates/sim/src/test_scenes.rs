//! Small scenes built in code, for tests of the solvers.

use fissure_scene::{
    Body, Crack, Curve, Formulation, FrameSettings, GrowthSettings, InitialVelocity, JMethod, Kernel, Material,
    ModeSplit, OnDistortion, OutputSettings, PlaneState, Point, Region, Scene, Selection, SolverSettings, TipDivision,
    Transfer, UpAxis, Vector,
};

/// A rectangle from `low` to `high` [m].
pub(crate) fn rectangle(low: [f64; 2], high: [f64; 2]) -> Region {
    let exterior = vec![Point::from(low), Point::new(high[0], low[1]), Point::from(high), Point::new(low[0], high[1])];
    Region { exterior, holes: Vec::new() }
}

/// One body in the shape of `region`, of E = 1000 Pa, ν = 0.3, ρ = 1 kg/m³, in plane strain; nothing acts on it. Two
/// particles per cell and axis, particle spacing `spacing` [m]; updated Lagrangian, cubic, PIC.
pub(crate) fn free_body(region: Region, spacing: f64) -> Scene {
    Scene {
        name: "test".into(),
        hash: String::new(),
        plane: PlaneState::Strain,
        materials: vec![Material {
            name: "test".into(),
            young_modulus: 1000.0,
            poisson_ratio: 0.3,
            density: 1.0,
            fracture_toughness: 1.0,
            limiting_speed: None,
            plasticity: None,
        }],
        bodies: vec![Body {
            name: "body".into(),
            region,
            material: 0,
            inclusions: Vec::new(),
            velocities: Vec::new(),
            turns: Vec::new(),
        }],
        cracks: Vec::new(),
        toughness: Vec::new(),
        contact: Default::default(),
        take: Default::default(),
        colliders: Vec::new(),
        gravity: Vector::zeros(),
        loads: Vec::new(),
        supports: Vec::new(),
        particle_spacing: spacing,
        cell_size: 2.0 * spacing,
        solver: SolverSettings {
            formulation: Formulation::Updated,
            on_distortion: OnDistortion::Stop,
            kernel: Kernel::Cubic,
            transfer: Transfer::Pic,
            time_step: None,
            courant: 0.5,
            damping: 0.0,
            crack_contact: true,
            crack_friction: 0.0,
            tip_division: TipDivision::LineCrossing,
            j_method: JMethod::Domain,
            j_radius: None,
            area_term: true,
            mode_split: ModeSplit::Interaction,
        },
        growth: GrowthSettings {
            enabled: false,
            increment: 0.5,
            bending: 1.0,
            speed_limit: 1.0,
            speed_curve: Curve::default(),
            branching: None,
        },
        frames: FrameSettings { first: 1, last: 2, rate: 24.0, playback: 24.0 },
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

/// Adds a crack through `points` [m] to the first body, without live tips.
pub(crate) fn add_crack(scene: &mut Scene, points: &[[f64; 2]]) {
    scene.cracks.push(Crack {
        name: format!("crack {}", scene.cracks.len()),
        body: 0,
        points: points.iter().map(|&p| Point::from(p)).collect(),
        start_live: false,
        end_live: false,
        start_guide: None,
        end_guide: None,
        crosses: false,
    });
}

/// Adds the shape of the first body once more, moved by `away` [m].
pub(crate) fn add_body(scene: &mut Scene, away: [f64; 2]) {
    let mut body = scene.bodies[0].clone();
    body.name = format!("body {}", scene.bodies.len());
    body.region.exterior.iter_mut().for_each(|p| *p += Vector::from(away));
    body.velocities.clear();
    scene.bodies.push(body);
}

/// Gives the places in `selection` of the first body an initial velocity: `velocity` plus `angular_velocity` around
/// `center`.
pub(crate) fn set_motion(
    scene: &mut Scene,
    selection: Selection,
    velocity: [f64; 2],
    angular_velocity: f64,
    center: [f64; 2],
) {
    scene.bodies[0].velocities.push(InitialVelocity {
        selection,
        velocity: Vector::from(velocity),
        angular_velocity,
        center: Point::from(center),
    });
}

/// A constant factor of 1.
pub(crate) fn always() -> Curve {
    Curve::default()
}
