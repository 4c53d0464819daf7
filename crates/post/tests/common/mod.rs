//! Frames with known geometry.
#![allow(dead_code, unreachable_pub)]

pub mod cracked_square;

use fissure_post::PostOptions;
use fissure_scene::{
    Body, CrackEnd, CrackFrame, Curve, Formed, Formulation, Frame, FrameSettings, GrowthSettings, JMethod, Kernel,
    Material, ModeSplit, OnDistortion, OutlineFrame, OutputSettings, Part, ParticleFrame, PlaneState, Point, Region,
    Scene, SolverSettings, SurfaceSettings, TipDivision, Transfer, UpAxis, Vector,
};

/// A scene with one body.
pub fn scene(region: Region) -> Scene {
    let material = Material {
        name: "glass".into(),
        young_modulus: 7e10,
        poisson_ratio: 0.2,
        density: 2500.0,
        fracture_toughness: 0.75e6,
        limiting_speed: None,
        plasticity: None,
    };
    Scene {
        name: "sample".into(),
        hash: "0".repeat(64),
        plane: PlaneState::Strain,
        materials: vec![material],
        bodies: vec![Body {
            name: "plate".into(),
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
        particle_spacing: 0.5,
        cell_size: 1.0,
        solver: SolverSettings {
            formulation: Formulation::Auto,
            on_distortion: OnDistortion::Stop,
            kernel: Kernel::Bilinear,
            transfer: Transfer::Pic,
            time_step: None,
            courant: 0.9,
            damping: 0.0,
            crack_contact: true,
            crack_friction: 0.0,
            tip_division: TipDivision::PartlyCut,
            j_method: JMethod::Domain,
            j_radius: None,
            area_term: true,
            mode_split: ModeSplit::Interaction,
        },
        growth: GrowthSettings {
            enabled: true,
            increment: 0.25,
            bending: 1.0,
            speed_limit: 0.9,
            speed_curve: Curve::default(),
            branching: None,
        },
        frames: FrameSettings { first: 1, last: 10, rate: 24.0, playback: 24.0 },
        output: OutputSettings {
            thickness: 0.3,
            formats: Vec::new(),
            parts: vec![Part::Cracked],
            up: UpAxis::Z,
            smallest_fragment: 0.0,
            walls: Default::default(),
            surfaces: SurfaceSettings { smoothing: 0.0, ..Default::default() },
            opening: None,
            explode: None,
            attributes: Vec::new(),
        },
    }
}

pub fn options(scene: &Scene) -> PostOptions {
    PostOptions::from(&scene.output)
}

/// The square 0 ≤ x, y ≤ `size`.
pub fn square(size: f64) -> Region {
    let exterior = [(0.0, 0.0), (size, 0.0), (size, size), (0.0, size)].map(|(x, y)| Point::new(x, y)).to_vec();
    Region { exterior, holes: Vec::new() }
}

/// A crack: rest positions, and how far each face has moved.
#[derive(Debug, Clone)]
pub struct Opened {
    pub rest: Vec<Point>,
    pub above: Vec<Vector>,
    pub below: Vec<Vector>,
    pub start: CrackEnd,
    pub end: CrackEnd,
}

impl Opened {
    /// Both faces move by half of `opening` along the normal of the line from first to last point.
    pub fn symmetric(rest: Vec<Point>, opening: &[f64], start: CrackEnd, end: CrackEnd) -> Self {
        let along = (rest[rest.len() - 1] - rest[0]).normalize();
        let normal = Vector::new(-along.y, along.x);
        let above: Vec<Vector> = opening.iter().map(|o| 0.5 * o * normal).collect();
        let below = above.iter().map(|v| -v).collect();
        Self { rest, above, below, start, end }
    }

    pub fn face(&self, moved: &[Vector]) -> Vec<Point> {
        self.rest.iter().zip(moved).map(|(x, u)| x + u).collect()
    }
}

/// The frame of a body that is at rest but for its cracks: rings with `per_side` tracers on each edge, two at mouths.
pub fn frame(region: &Region, per_side: usize, cracks: &[Opened]) -> Frame {
    let mut outlines = Vec::new();
    for (index, ring) in region.rings().enumerate() {
        outlines.push(outline(index as u32, ring, per_side, cracks));
    }
    let crack_frames = cracks.iter().enumerate().map(|(i, c)| CrackFrame {
        crack: i as u32,
        body: 0,
        rest: c.rest.clone(),
        above: c.face(&c.above),
        below: c.face(&c.below),
        above_velocity: c.above.clone(),
        below_velocity: c.below.clone(),
        formed: Some((0..c.rest.len()).map(|k| Formed { time: 0.01 * k as f64, mode_1: 1e6 * k as f64 }).collect()),
        start: c.start,
        end: c.end,
    });
    let mut frame = Frame { number: 1, time: 0.0, outlines, cracks: crack_frames.collect(), ..Frame::default() };
    frame.particles = particles(region, |_| (0, Vector::zeros()));
    frame
}

fn outline(index: u32, ring: &[Point], per_side: usize, cracks: &[Opened]) -> OutlineFrame {
    let mut outline = OutlineFrame { body: 0, ring: index, ..OutlineFrame::default() };
    let mut add = |rest: Point, moved: Vector| {
        outline.rest.push(rest);
        outline.position.push(rest + moved);
        outline.velocity.push(moved);
    };
    for i in 0..ring.len() {
        let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
        // (where on the edge, rest, moved before, moved behind)
        let mut stops: Vec<(f64, Point, Vector, Option<Vector>)> = (0..per_side)
            .map(|k| k as f64 / per_side as f64)
            .map(|s| (s, a + s * (b - a), Vector::zeros(), None))
            .collect();
        for crack in cracks {
            let last = crack.rest.len() - 1;
            // Walking the ring with the material on the left, a crack that starts here has its left side behind us.
            let ends = [(crack.start, 0, &crack.above, &crack.below), (crack.end, last, &crack.below, &crack.above)];
            for (_, at, first, second) in ends.into_iter().filter(|e| e.0 == CrackEnd::Mouth) {
                let (rest, along) = (crack.rest[at], b - a);
                let s = (rest - a).dot(&along) / along.norm_squared();
                let off = (a + s * along - rest).norm();
                if off < 1e-9 * along.norm() && (0.0..1.0).contains(&s) {
                    stops.retain(|stop| (stop.0 - s).abs() > 1e-9);
                    stops.push((s, rest, first[at], Some(second[at])));
                }
            }
        }
        stops.sort_by(|x, y| x.0.total_cmp(&y.0));
        for (_, rest, first, second) in stops {
            add(rest, first);
            if let Some(second) = second {
                add(rest, second);
            }
        }
    }
    outline
}

/// Particles on a 20 × 20 lattice inside `region`; `state` gives fragment and displacement.
pub fn particles(region: &Region, state: impl Fn(Point) -> (u32, Vector)) -> ParticleFrame {
    let (low, high) = region.bounds();
    let mut particles = ParticleFrame::default();
    for i in 0..400 {
        let (u, v) = ((f64::from(i % 20) + 0.5) / 20.0, (f64::from(i / 20) + 0.5) / 20.0);
        let rest = Point::new(low.x + u * (high.x - low.x), low.y + v * (high.y - low.y));
        if region.contains(rest) {
            let (piece, moved) = state(rest);
            particles.id.push(i as u32);
            particles.body.push(0);
            particles.piece.push(piece);
            particles.rest.push(rest);
            particles.position.push(rest + moved);
            particles.velocity.push(Vector::zeros());
            particles.deformation_gradient.push(fissure_scene::Matrix::identity());
            particles.cauchy_stress.push(fissure_scene::Matrix::zeros());
        }
    }
    particles
}

/// A frame cut clean through along x = size / 2 whose halves have moved as rigid bodies: `turn` [rad] about their
/// centres, then `shift` [m]. The right half is fragment 1.
pub fn halves(size: f64, motions: [(f64, Vector); 2]) -> (Scene, Frame) {
    let region = square(size);
    let middle = 0.5 * size;
    let moved = |right: bool, rest: Point| {
        let center = Point::new(if right { 0.75 } else { 0.25 } * size, middle);
        let (turn, shift) = motions[usize::from(right)];
        center + nalgebra::Rotation2::new(turn) * (rest - center) + shift - rest
    };
    // From bottom to top: the left half is above.
    let rest: Vec<Point> = (0..=8).map(|i| Point::new(middle, size * f64::from(i) / 8.0)).collect();
    let above = rest.iter().map(|&x| moved(false, x)).collect();
    let below = rest.iter().map(|&x| moved(true, x)).collect();
    let crack = Opened { rest, above, below, start: CrackEnd::Mouth, end: CrackEnd::Mouth };
    let mut frame = frame(&region, 3, &[crack]);
    for outline in &mut frame.outlines {
        for i in 0..outline.rest.len() {
            let rest = outline.rest[i];
            if rest.x != middle {
                outline.position[i] = rest + moved(rest.x > middle, rest);
            }
        }
    }
    let mut particles = particles(&region, |x| (u32::from(x.x > middle), moved(x.x > middle, x)));
    for (rest, gradient) in particles.rest.iter().zip(&mut particles.deformation_gradient) {
        *gradient = nalgebra::Rotation2::new(motions[usize::from(rest.x > middle)].0).into_inner();
    }
    frame.particles = particles;
    (scene(region), frame)
}

/// Points from `a` to `b`, those between moved by `wander` across.
pub fn path(a: Point, b: Point, wander: &[f64]) -> Vec<Point> {
    let last = wander.len() - 1;
    let across = Vector::new(a.y - b.y, b.x - a.x).normalize();
    let place = |(k, off): (usize, &f64)| {
        let off = if k == 0 || k == last { 0.0 } else { *off };
        a + (k as f64 / last as f64) * (b - a) + off * across
    };
    wander.iter().enumerate().map(place).collect()
}
