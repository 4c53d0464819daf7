//! The one place where scenes of cases are put together.

use fissure_scene::{
    Body, BoxSide, Crack, Curve, FrameSettings, GrowthSettings, Load, LoadKind, Material, OutlineStretch,
    OutputSettings, PlaneState, Point, Region, Scene, Selection, SolverPreset, Support, UpAxis, Vector, solver_preset,
};

/// A scene in the making: one body on one lattice, standard settings, growth off, nothing acts.
#[derive(Debug, Clone)]
pub(crate) struct Problem {
    pub(crate) scene: Scene,
}

/// Elastic constants, density and toughness as a material.
pub(crate) fn material(young_modulus: f64, poisson_ratio: f64, density: f64, fracture_toughness: f64) -> Material {
    Material {
        name: "elastic".into(),
        young_modulus,
        poisson_ratio,
        density,
        fracture_toughness,
        limiting_speed: None,
        plasticity: None,
    }
}

/// Young's modulus of [`linear_material`] [Pa].
pub(crate) const LINEAR_YOUNG: f64 = 1e9;

/// A material for problems at rest, ν = 0.3: so stiff that stresses of some 1e3 Pa make strains of 1e-6, and the
/// problem is linear. Never breaks.
pub(crate) fn linear_material() -> Material {
    material(LINEAR_YOUNG, 0.3, 1000.0, 1e30)
}

/// An axis-parallel rectangle from its lowest to its highest corner [m].
pub(crate) fn rectangle(low: (f64, f64), high: (f64, f64)) -> Region {
    let corners = [(low.0, low.1), (high.0, low.1), (high.0, high.1), (low.0, high.1)];
    Region { exterior: corners.map(|(x, y)| Point::new(x, y)).to_vec(), holes: Vec::new() }
}

/// A disc around the origin as a polygon of 256 corners [m]; one of them is exactly on its left.
pub(crate) fn disc(radius: f64) -> Region {
    let corner = |k: u16| {
        let (sine, cosine) = (std::f64::consts::TAU * f64::from(k) / 256.0).sin_cos();
        // The sine of π is not zero in floating point.
        if k == 128 { Point::new(-radius, 0.0) } else { Point::new(radius * cosine, radius * sine) }
    };
    Region { exterior: (0..256).map(corner).collect(), holes: Vec::new() }
}

/// A straight stretch of the outline of the only body, the material to its left [m].
pub(crate) fn stretch(from: (f64, f64), to: (f64, f64)) -> Selection {
    let [from, to] = [from, to].map(|(x, y)| Point::new(x, y));
    Selection::Outline(vec![OutlineStretch { body: 0, from, to }])
}

impl Problem {
    /// A body of one material, two by two particles in each cell of `cell_size` [m].
    pub(crate) fn new(name: &str, region: Region, material: Material, plane: PlaneState, cell_size: f64) -> Self {
        let (solver, growth) = solver_preset(SolverPreset::Standard);
        let scene = Scene {
            name: name.into(),
            hash: String::new(),
            plane,
            materials: vec![material],
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
            particle_spacing: 0.5 * cell_size,
            cell_size,
            solver,
            growth: GrowthSettings { enabled: false, ..growth },
            frames: FrameSettings { first: 0, last: 1, rate: 1.0, playback: 24.0 },
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
        };
        Self { scene }
    }

    /// Solved by a preset instead of the standard settings; growth stays off.
    pub(crate) fn preset(mut self, preset: SolverPreset) -> Self {
        let (solver, growth) = solver_preset(preset);
        self.scene.solver = solver;
        self.scene.growth = GrowthSettings { enabled: false, ..growth };
        self
    }

    /// For a state at rest with open cracks: no inertia in J, no contact.
    pub(crate) fn at_rest(mut self) -> Self {
        self.scene.solver.area_term = false;
        self.scene.solver.crack_contact = false;
        self
    }

    /// Cracks may grow.
    pub(crate) fn growing(mut self) -> Self {
        self.scene.growth.enabled = true;
        self
    }

    /// Runs until `time` [s] in `frames` frames; the solver looks at its stability limit after each.
    pub(crate) fn until(mut self, time: f64, frames: u32) -> Self {
        self.scene.frames =
            FrameSettings { first: 0, last: i64::from(frames), rate: f64::from(frames) / time, playback: 24.0 };
        self
    }

    /// A crack; `live`: whether its first and its last point are tips. Ends on a ring become corners of it.
    pub(crate) fn crack(mut self, points: &[(f64, f64)], live: [bool; 2]) -> Self {
        let points: Vec<Point> = points.iter().map(|&(x, y)| Point::new(x, y)).collect();
        for end in [points[0], points[points.len() - 1]] {
            make_corner(&mut self.scene.bodies[0].region, end, 1e-9 * self.scene.cell_size);
        }
        self.scene.cracks.push(Crack {
            name: format!("crack {}", self.scene.cracks.len() + 1),
            body: 0,
            points,
            start_live: live[0],
            end_live: live[1],
            start_guide: None,
            end_guide: None,
            crosses: false,
        });
        self
    }

    /// A traction [Pa] on a whole side.
    pub(crate) fn traction(self, side: BoxSide, x: f64, y: f64) -> Self {
        self.load(Selection::Edge { side, bodies: None }, LoadKind::Traction(Vector::new(x, y)), Curve::default())
    }

    /// Any load.
    pub(crate) fn load(mut self, selection: Selection, kind: LoadKind, curve: Curve) -> Self {
        self.scene.loads.push(Load { selection, kind, curve });
        self
    }

    /// A prescribed constant velocity [m/s], none: free.
    pub(crate) fn support(mut self, selection: Selection, velocity: [Option<f64>; 2]) -> Self {
        self.scene.supports.push(Support { selection, velocity, curve: Curve::default() });
        self
    }
}

/// Makes `point` a corner of the ring that passes through it within `tolerance` [m], if there is one.
fn make_corner(region: &mut Region, point: Point, tolerance: f64) {
    for ring in std::iter::once(&mut region.exterior).chain(&mut region.holes) {
        for i in 0..ring.len() {
            let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
            if (a - point).norm() <= tolerance || (b - point).norm() <= tolerance {
                return;
            }
            let along = b - a;
            let t = (point - a).dot(&along) / along.norm_squared();
            if (0.0..=1.0).contains(&t) && (a + along * t - point).norm() <= tolerance {
                ring.insert(i + 1, point);
                return;
            }
        }
    }
}
