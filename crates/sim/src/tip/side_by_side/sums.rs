//! The sums over the points of a zone, batch by batch.

use super::{BATCH, Batch, FreeZone, Numbers, Wanted};
use crate::material::elastic::Elastic;
use crate::tip::domain::{CORE, INNER_RADIUS};
use crate::wide::Loop;
use fissure_plane::{Matrix, Point};
use std::f64::consts::PI;

/// The way from the world into the frame of a tip.
pub(super) struct Way {
    pub(super) tip: Point,
    pub(super) frame: Matrix,
    /// What takes the turn of the surroundings back, and that less 1.
    pub(super) back: Matrix,
    pub(super) back_minus_one: Matrix,
}

impl Way {
    /// A vector of the world, in the frame of the tip.
    #[inline(always)]
    fn vector(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (b, f) = (&self.back, &self.frame);
        let (x, y) = (b.m11 * x + b.m12 * y, b.m21 * x + b.m22 * y);
        [f.m11 * x + f.m12 * y, f.m21 * x + f.m22 * y]
    }

    /// `back` times a tensor of the world plus `more`, in the frame of the tip; row by row.
    #[inline(always)]
    fn tensor(&self, [a, b, c, d]: [f64; 4], more: &Matrix) -> [f64; 4] {
        let (t, f) = (&self.back, &self.frame);
        let (a, b, c, d) = (
            t.m11 * a + t.m12 * c + more.m11,
            t.m11 * b + t.m12 * d + more.m12,
            t.m21 * a + t.m22 * c + more.m21,
            t.m21 * b + t.m22 * d + more.m22,
        );
        let (a, b, c, d) = (f.m11 * a + f.m12 * c, f.m11 * b + f.m12 * d, f.m21 * a + f.m22 * c, f.m21 * b + f.m22 * d);
        [a * f.m11 + b * f.m12, a * f.m21 + b * f.m22, c * f.m11 + d * f.m12, c * f.m21 + d * f.m22]
    }
}

/// What a batch comes to on the way: in the frame of the tip.
struct Scratch {
    place: [Numbers; 2],
    /// q [–] and ∇q [1/m].
    weight: Numbers,
    slope: [Numbers; 2],
    gradient: [Numbers; 4],
    stress: [Numbers; 4],
    energy: Numbers,
    /// What points add to J and to the interaction integral of each mode.
    release: Numbers,
    mutual: [Numbers; 2],
}

impl Scratch {
    const NONE: Self = Self {
        place: [[0.0; BATCH]; 2],
        weight: [0.0; BATCH],
        slope: [[0.0; BATCH]; 2],
        gradient: [[0.0; BATCH]; 4],
        stress: [[0.0; BATCH]; 4],
        energy: [0.0; BATCH],
        release: [0.0; BATCH],
        mutual: [[0.0; BATCH]; 2],
    };

    /// Places, q and its slope: see [`weight`](crate::tip::domain::weight).
    #[inline(always)]
    fn place(&mut self, batch: &Batch, way: &Way, [inner, outer]: [f64; 2]) {
        let f = &way.frame;
        for k in 0..BATCH {
            let (x, y) = (batch.rest[0][k] - way.tip.x, batch.rest[1][k] - way.tip.y);
            let (x, y) = (f.m11 * x + f.m12 * y, f.m21 * x + f.m22 * y);
            let r = (x * x + y * y).sqrt();
            let t = (r - inner) / (outer - inner);
            let q = 1.0 - t * t * t * (10.0 - t * (15.0 - 6.0 * t));
            let slope = -30.0 * t * t * (1.0 - t) * (1.0 - t) / (outer - inner) / r;
            let q = if r >= outer { 0.0 } else { q };
            let q = if r <= inner { 1.0 } else { q };
            let slope = if r <= inner || q == 0.0 { 0.0 } else { slope };
            (self.place[0][k], self.place[1][k], self.weight[k]) = (x, y, q);
            (self.slope[0][k], self.slope[1][k]) = (x * slope, y * slope);
        }
    }

    /// Displacement gradients, stresses and energies: see [`crate::first_piola_stress`].
    #[inline(always)]
    fn strain(&mut self, batch: &Batch, way: &Way) {
        let none = Matrix::zeros();
        for k in 0..BATCH {
            let [h11, h12, h21, h22] = [0, 1, 2, 3].map(|at| batch.strain[at][k]);
            let (mu, lambda) = (batch.mu[k], batch.lambda[k]);
            let (a, b) = (2.0 + h11 + h22, h21 - h12);
            let r = (a * a + b * b).sqrt();
            let (ahead, behind) = (b * b / (r * (r + a)), (r - a) / r);
            let one_minus_cosine = if a > 0.0 { ahead } else { behind };
            let sine = b / r;
            let (one_minus_cosine, sine) = if r == 0.0 { (0.0, 0.0) } else { (one_minus_cosine, sine) };
            let d = [h11 + one_minus_cosine, h12 + sine, h21 - sine, h22 + one_minus_cosine];
            let change = h11 + h22 + (h11 * h22 - h12 * h21);
            let pressure = lambda * change;
            let cofactor = [1.0 + h22, -h21, -h12, 1.0 + h11];
            let mut piola = [0.0; 4];
            for at in 0..4 {
                piola[at] = 2.0 * mu * d[at] + pressure * cofactor[at];
            }
            let squares = (d[0] * d[0] + d[2] * d[2]) + (d[1] * d[1] + d[3] * d[3]);
            self.energy[k] = mu * squares + 0.5 * lambda * change * change;
            let (stress, gradient) = (way.tensor(piola, &none), way.tensor([h11, h12, h21, h22], &way.back_minus_one));
            for at in 0..4 {
                self.stress[at][k] = stress[at];
                self.gradient[at][k] = gradient[at];
            }
        }
    }

    /// What points add to J: see [`domain_integrals`](crate::tip::domain::domain_integrals).
    #[inline(always)]
    fn release(&mut self, batch: &Batch, dynamic: bool) {
        let moves = if dynamic { 1.0 } else { 0.0 };
        for k in 0..BATCH {
            let [s11, s12, s21, s22] = [0, 1, 2, 3].map(|at| self.stress[at][k]);
            let (u1, u2) = (self.gradient[0][k], self.gradient[2][k]);
            let (vx, vy) = (batch.velocity[0][k], batch.velocity[1][k]);
            let (along, across) = (self.slope[0][k], self.slope[1][k]);
            let inertia = batch.density[k] * moves;
            let kinetic = 0.5 * inertia * (vx * vx + vy * vy);
            let flux = (s11 * u1 + s21 * u2) * along + (s12 * u1 + s22 * u2) * across;
            let flux = flux - (self.energy[k] + kinetic) * along;
            let gained = batch.acceleration[0][k] * u1 + batch.acceleration[1][k] * u2;
            let carried = vx * batch.velocity_slope[0][k] + vy * batch.velocity_slope[1][k];
            self.release[k] = batch.volume[k] * (flux + inertia * (gained - carried) * self.weight[k]);
        }
    }

    /// What points add to the interaction integrals: see [`domain_integrals`](crate::tip::domain::domain_integrals) and
    /// [`crate::williams_fields`].
    #[inline(always)]
    fn mutual(&mut self, batch: &Batch, dynamic: bool, tip: &Elastic) {
        let moves = if dynamic { 1.0 } else { 0.0 };
        let (mu, kolosov) = (tip.mu, tip.kolosov);
        for k in 0..BATCH {
            let [x, y] = beside_crack([self.place[0][k], self.place[1][k]], batch.side[k]);
            let [x, y] = out_of_core([x, y], batch.volume[k]);
            let radius = (x * x + y * y).sqrt();
            let larger = (0.5 + 0.5 * (x.abs() / radius)).sqrt();
            let smaller = 0.5 * y.abs() / (radius * larger);
            let s = if x < 0.0 { larger } else { smaller };
            let c = if x < 0.0 { smaller } else { larger };
            let s = s.copysign(y);
            let (s3, c3) = (s * (3.0 - 4.0 * s * s), c * (4.0 * c * c - 3.0));
            let size = 1.0 / (2.0 * PI * radius).sqrt();
            let turn = -size * (kolosov + 1.0) / (4.0 * mu);
            let shear = c * (1.0 - s * s3);
            let of_modes = [
                ([1.0 - s * s3, s * c3, 1.0 + s * s3].map(|of| size * c * of), turn * s),
                ([-s * (2.0 + c * c3), shear, s * c * c3].map(|of| size * of), turn * c),
            ];
            let [g11, g12, g21, g22] = [0, 1, 2, 3].map(|at| self.gradient[at][k]);
            let (e11, e12, e22) = ((g11 + g11) * 0.5, (g12 + g21) * 0.5, (g22 + g22) * 0.5);
            let (pressure, twice) = (batch.lambda[k] * (e11 + e22), 2.0 * batch.mu[k]);
            let (s11, s12, s22) = (pressure + e11 * twice, e12 * twice, pressure + e22 * twice);
            let (along, across) = (self.slope[0][k], self.slope[1][k]);
            let inertia = batch.density[k] * moves;
            let (ax, ay) = (batch.acceleration[0][k], batch.acceleration[1][k]);
            for (mode, ([t11, t12, t22], rotation)) in of_modes.into_iter().enumerate() {
                let (u1, u2) = {
                    let mean = 0.25 * (3.0 - kolosov) * (t11 + t22);
                    ((t11 - mean) / (2.0 * mu), t12 / (2.0 * mu) + rotation)
                };
                let mutual = t11 * e11 + t12 * e12 + t12 * e12 + t22 * e22;
                let flux_x = (s11 * u1 + s12 * u2) + (t11 * g11 + t12 * g21);
                let flux_y = (s12 * u1 + s22 * u2) + (t12 * g11 + t22 * g21);
                let flux = (flux_x * along + flux_y * across) - mutual * along;
                let area = inertia * (ax * u1 + ay * u2) * self.weight[k];
                self.mutual[mode][k] = batch.volume[k] * (flux + area);
            }
        }
    }
}

/// See [`beside_crack`](crate::tip::domain::beside_crack).
#[inline(always)]
fn beside_crack([x, y]: [f64; 2], side: f64) -> [f64; 2] {
    let distance = (x * x + y * y).sqrt();
    let is_across = x < 0.0 && y * side < 1e-9 * distance;
    [if is_across { -distance } else { x }, if is_across { 0.0_f64.copysign(side) } else { y }]
}

/// See [`out_of_core`](crate::tip::domain::out_of_core).
#[inline(always)]
fn out_of_core([x, y]: [f64; 2], volume: f64) -> [f64; 2] {
    let (distance, least) = ((x * x + y * y).sqrt(), CORE * volume.sqrt());
    let by = least / distance;
    let (x, y) = if distance >= least { (x, y) } else { (x * by, y * by) };
    if distance > 0.0 { [x, y] } else { [least, 0.0] }
}

/// The sums over all points.
pub(super) struct Sums<'a> {
    pub(super) zone: &'a mut FreeZone,
    pub(super) way: Way,
    pub(super) wanted: Wanted<'a>,
}

impl Loop for Sums<'_> {
    type Output = (f64, [f64; 2]);

    #[inline(always)]
    fn run(self) -> (f64, [f64; 2]) {
        let Self { zone, way, wanted: Wanted { tip, cell_size, outer, dynamic, modes } } = self;
        let (count, half_step) = (zone.material.len(), zone.half_step);
        let (mut mass, mut momentum) = (0.0, [0.0; 2]);
        for (number, batch) in zone.batches.iter_mut().enumerate() {
            for k in 0..BATCH {
                let acceleration = [batch.acceleration[0][k], batch.acceleration[1][k]];
                let ahead = [0, 1].map(|axis| batch.velocity[axis][k] - acceleration[axis] * half_step);
                let [velocity, acceleration] = [ahead, acceleration].map(|of| way.vector(of));
                let slope = way.vector([batch.velocity_slope[0][k], batch.velocity_slope[1][k]]);
                for axis in 0..2 {
                    batch.velocity[axis][k] = velocity[axis];
                    batch.acceleration[axis][k] = acceleration[axis];
                    batch.velocity_slope[axis][k] = slope[axis];
                }
            }
            // One after the other, as they stand.
            for k in 0..BATCH.min(count - number * BATCH) {
                let own = batch.density[k] * batch.volume[k];
                mass += own;
                (0..2).for_each(|axis| momentum[axis] += batch.velocity[axis][k] * own);
            }
        }
        let mean = if mass > 0.0 { momentum.map(|of| of / mass) } else { [0.0; 2] };
        let (mut j, mut m) = (0.0, [0.0; 2]);
        let mut scratch = Scratch::NONE;
        for (number, batch) in zone.batches.iter_mut().enumerate() {
            for axis in 0..2 {
                for k in 0..BATCH {
                    batch.velocity[axis][k] -= mean[axis];
                }
            }
            scratch.place(batch, &way, [INNER_RADIUS * cell_size, outer]);
            scratch.strain(batch, &way);
            scratch.release(batch, dynamic);
            if modes {
                scratch.mutual(batch, dynamic, tip);
            }
            (batch.rest, batch.strain[0]) = (scratch.place, scratch.gradient[0]);
            for k in 0..BATCH.min(count - number * BATCH) {
                j += scratch.release[k];
                (0..2).for_each(|mode| m[mode] += scratch.mutual[mode][k]);
            }
        }
        (j, m)
    }
}
