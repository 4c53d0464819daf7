//! What a body hands on through the section that a crack lies in, and the stress intensity that this makes: handbook
//! solutions.

use super::drawn_tip::DrawnTip;
use super::samples::{PlacedForce, Samples};
use fissure_scene::{Point, Scene, Vector};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

/// Stiffness of inertia beside that of a support: it decides only where no support holds.
const INERTIA: f64 = 1e-9;

/// The straight section through a tip and its crack.
#[derive(Debug, Clone, Copy)]
pub(super) struct Section {
    tip: Point,
    ahead: Vector,
    /// From the tip to where the body ends ahead of it, or another crack is [m].
    ligament: f64,
    /// From the tip to the other end of the crack [m].
    length: f64,
    /// From the other end to where the body ends behind it [m]; none where the crack opens there.
    behind: Option<f64>,
}

impl Section {
    /// The section of a tip.
    pub(super) fn of(scene: &Scene, tip: &DrawnTip<'_>) -> Self {
        let (place, other, ahead) = (tip.place(), tip.other_end(), tip.ahead());
        let body = &scene.bodies[tip.crack.body];
        let (low, high) = body.region.bounds();
        let on_outline = body.region.distance_to_rings(other) <= 1e-6 * (high - low).norm();
        let trunk = scene.cracks.iter().find(|c| !std::ptr::eq(*c, tip.crack) && c.points.contains(&other));
        let longer = trunk.map_or(0.0, |trunk| fissure_plane::polyline_length(&trunk.points));
        let ligament = tip.free_way(scene, place, ahead).min((high - low).norm());
        let behind = tip.free_way(scene, other, -ahead).min((high - low).norm());
        let length = (place - other).norm() + longer;
        Self { tip: place, ahead, ligament, length, behind: (!on_outline && trunk.is_none()).then_some(behind) }
    }

    /// Half the length of an inner crack, the length of one from the edge [m]: what √(πa) is taken of.
    pub(super) fn a(&self) -> f64 {
        if self.behind.is_some() { 0.5 * self.length } else { self.length }
    }

    /// Width of the section, crack included [m].
    pub(super) fn width(&self) -> f64 {
        self.length + self.ligament + self.behind.unwrap_or(0.0)
    }

    /// Length of the crack within it [m].
    pub(super) fn length_of_crack(&self) -> f64 {
        self.length
    }

    fn center(&self) -> Point {
        self.tip + self.ahead * (0.5 * (self.ligament - self.length - self.behind.unwrap_or(0.0)))
    }

    /// Normal force, shear force [N/m] and moment about the middle [N] that `forces` on the left of the section hand on
    /// through it.
    pub(super) fn resultants(&self, forces: &[PlacedForce]) -> [f64; 3] {
        let (normal, center) = (Vector::new(-self.ahead.y, self.ahead.x), self.center());
        let left = forces.iter().filter(|f| normal.dot(&(f.place - self.tip)) > 0.0);
        left.fold([0.0; 3], |[n, v, m], f| {
            let moment = (f.place - center).perp(&f.force);
            [n + f.force.dot(&normal), v + f.force.dot(&self.ahead), m + moment]
        })
    }

    /// Stress intensity that resultants make at rest [Pa·√m], whatever their sign: what closes a crack may swing back
    /// and open it.
    ///
    /// Tada, Paris & Irwin: single edge crack in tension, bending and shear; centre crack with the secant factor.
    pub(super) fn stress_intensity(&self, [normal, shear, moment]: [f64; 3]) -> f64 {
        let (a, width) = (self.a(), self.width());
        let (tension, bending, sliding) = match self.behind {
            None => {
                let part = (a / width).clamp(1e-6, 0.95);
                let q = 0.5 * PI * part;
                let root = (q.tan() / q).sqrt() / q.cos();
                (
                    root * (0.752 + 2.02 * part + 0.37 * (1.0 - q.sin()).powi(3)),
                    root * (0.923 + 0.199 * (1.0 - q.sin()).powi(4)),
                    (1.122 - 0.561 * part + 0.085 * part * part + 0.18 * part.powi(3)) / (1.0 - part).sqrt(),
                )
            }
            Some(behind) => {
                let part = (a / (a + self.ligament.min(behind))).clamp(1e-6, 0.95);
                let secant = (0.5 * PI * part).cos().recip().sqrt();
                (secant, secant, secant)
            }
        };
        let opening = normal.abs() / width * tension + 6.0 * moment.abs() / (width * width) * bending;
        let shearing = shear.abs() / width * sliding;
        // A crack under shear kinks, and feels up to 2/√3 times K_II.
        (PI * a).sqrt() * opening.hypot(1.16 * shearing)
    }
}

/// All forces on one body at the factors `factors` of the loads: loads, gravity, reactions of supports and inertia. In
/// balance: the body is taken for a rigid one on springs at its supports, and on far weaker ones everywhere, which is
/// d'Alembert's inertia where no support holds.
pub(super) fn balanced_forces(scene: &Scene, samples: &Samples, body: usize, factors: &[f64]) -> Vec<PlacedForce> {
    let particles = &samples.particles;
    let own: Vec<usize> = (0..particles.len()).filter(|&p| particles.body[p] as usize == body).collect();
    let mass: f64 = own.iter().map(|&p| particles.mass[p]).sum();
    let middle = own.iter().fold(Vector::zeros(), |sum, &p| sum + particles.rest[p].coords * particles.mass[p]) / mass;
    let held = scene.supports.iter().zip(&samples.supports).flat_map(|(support, places)| {
        let axes = support.velocity.map(|v| f64::from(u8::from(v.is_some())));
        places.iter().filter(|p| p.0 == body).map(move |p| (p.1, axes))
    });
    let inertia = own.iter().map(|&p| (particles.rest[p], [INERTIA * particles.mass[p] / mass; 2]));
    let springs: Vec<(Point, [f64; 2])> = held.chain(inertia).collect();
    let mut forces: Vec<PlacedForce> = Vec::new();
    for (load, factor) in samples.loads.iter().zip(factors) {
        forces.extend(load.iter().filter(|f| f.body == body).map(|f| PlacedForce { force: f.force * *factor, ..*f }));
    }
    if scene.gravity != Vector::zeros() {
        let weight =
            |&p: &usize| PlacedForce { body, place: particles.rest[p], force: scene.gravity * particles.mass[p] };
        forces.extend(own.iter().map(weight));
    }
    let (low, high) = scene.bodies[body].region.bounds();
    let size = (high - low).norm();
    // Displacement along x and y, and turn times size: a rigid motion moves a place by its rows.
    let rows = |place: Point| {
        let arm = (place.coords - middle) / size;
        [Vector3::new(1.0, 0.0, -arm.y), Vector3::new(0.0, 1.0, arm.x)]
    };
    let mut stiffness = Matrix3::zeros();
    for &(place, axes) in &springs {
        for (row, k) in rows(place).into_iter().zip(axes) {
            stiffness += row * row.transpose() * k;
        }
    }
    let pushed = forces.iter().fold(Vector3::zeros(), |sum, f| {
        let [x, y] = rows(f.place);
        sum + x * f.force.x + y * f.force.y
    });
    let Some(motion) = stiffness.lu().solve(&pushed) else { return forces };
    forces.extend(springs.iter().map(|&(place, axes)| {
        let [x, y] = rows(place);
        PlacedForce { body, place, force: -Vector::new(axes[0] * x.dot(&motion), axes[1] * y.dot(&motion)) }
    }));
    forces
}
