//! J and the interaction integral of a tip on whose faces nothing presses from outside, many points at a time.
//!
//! The sums are those of [`domain`](super::domain), which has the formulas and their sources, to the bit: each point
//! goes through the same operations, and points are added in the same order.

mod sums;

use super::domain::{DomainIntegrals, JUMP_REACH, take_contacts};
use super::frame::turn;
use super::zone::FaceContact;
use crate::crack::crossing::Side;
use crate::material::elastic::Elastic;
#[cfg(test)]
use crate::wide::Loop;
use crate::wide::run_widest;
use fissure_plane::{Matrix, Point, Vector};
use sums::{Sums, Way};

/// Points of a batch.
const BATCH: usize = 32;

/// One number of each point of a batch: loops over them have several side by side.
type Numbers = [f64; BATCH];

/// Points as they are in the world.
#[derive(Debug, Clone, Copy)]
struct Batch {
    /// Place at rest [m].
    rest: [Numbers; 2],
    /// 1 above the crack and −1 below it, seen from the tip; 1 ahead of it.
    side: Numbers,
    /// [m²].
    volume: Numbers,
    /// [kg/m³].
    density: Numbers,
    /// Moduli of the plane state [Pa].
    lambda: Numbers,
    mu: Numbers,
    /// Displacement gradient, row by row [–].
    strain: [Numbers; 4],
    /// [m/s].
    velocity: [Numbers; 2],
    /// Change of the velocity along e1 [1/s].
    velocity_slope: [Numbers; 2],
    /// [m/s²].
    acceleration: [Numbers; 2],
}

impl Batch {
    /// Points without volume.
    const NONE: Self = Self {
        rest: [[0.0; BATCH]; 2],
        side: [1.0; BATCH],
        volume: [0.0; BATCH],
        density: [0.0; BATCH],
        lambda: [0.0; BATCH],
        mu: [0.0; BATCH],
        strain: [[0.0; BATCH]; 4],
        velocity: [[0.0; BATCH]; 2],
        velocity_slope: [[0.0; BATCH]; 2],
        acceleration: [[0.0; BATCH]; 2],
    };
}

/// A point where it stands.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Standing {
    /// At rest [m].
    pub(crate) place: Point,
    /// The face of the crack that it sees, as a side of the frame of the tip.
    pub(crate) side: Side,
    /// Volume per unit thickness [m²].
    pub(crate) volume: f64,
    /// Its material.
    pub(crate) material: u32,
    /// Whether it is what of a particle lies across a crack, which does not count for the turn of what is around.
    pub(crate) is_far: bool,
}

/// How a point moves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moving {
    /// Displacement gradient [–].
    pub(crate) strain: Matrix,
    /// [m/s].
    pub(crate) velocity: Vector,
    /// Change of the velocity along e1 [1/s].
    pub(crate) velocity_slope: Vector,
    /// [m/s²].
    pub(crate) acceleration: Vector,
}

/// The points around a tip on whose faces nothing presses from outside, and what these do to each other.
#[derive(Debug, Clone)]
pub(crate) struct FreeZone {
    /// Where the tip is at rest [m].
    tip: Point,
    /// Unit vector ahead of it.
    ahead: Vector,
    /// Time by which velocities are ahead of the rest [s].
    half_step: f64,
    batches: Vec<Batch>,
    material: Vec<u32>,
    /// Numbers of those that are far, rising.
    far: Vec<usize>,
    /// Mean displacement gradient, once it has been asked for [–].
    mean: Matrix,
    /// As in [`TipZone`](super::zone::TipZone), but with forces of the world.
    pub(crate) contacts: Vec<FaceContact>,
}

impl FreeZone {
    /// No points yet; room for so many.
    pub(crate) fn new(tip: Point, ahead: Vector, half_step: f64, room: usize) -> Self {
        let batches = Vec::with_capacity(room.div_ceil(BATCH));
        let (material, far, contacts) = (Vec::with_capacity(room), Vec::new(), Vec::new());
        Self { tip, ahead, half_step, batches, material, far, mean: Matrix::zeros(), contacts }
    }

    /// Unit vector ahead of the tip.
    pub(crate) fn ahead(&self) -> Vector {
        self.ahead
    }

    /// Adds a point that does not move yet; gives its number.
    pub(crate) fn add(&mut self, point: &Standing, of: &Elastic) -> usize {
        let number = self.material.len();
        let k = number % BATCH;
        if k == 0 {
            self.batches.push(Batch::NONE);
        }
        self.material.push(point.material);
        if point.is_far {
            self.far.push(number);
        }
        let batch = &mut self.batches[number / BATCH];
        (batch.rest[0][k], batch.rest[1][k]) = (point.place.x, point.place.y);
        (batch.side[k], batch.volume[k]) = (point.side.sign(), point.volume);
        (batch.density[k], batch.lambda[k], batch.mu[k]) = (of.density, of.lambda, of.mu);
        number
    }

    /// Lets a point move.
    #[inline(always)]
    pub(crate) fn set(&mut self, number: usize, moving: &Moving) {
        let (batch, k) = (&mut self.batches[number / BATCH], number % BATCH);
        let Moving { strain, velocity, velocity_slope, acceleration } = moving;
        (batch.strain[0][k], batch.strain[1][k]) = (strain.m11, strain.m12);
        (batch.strain[2][k], batch.strain[3][k]) = (strain.m21, strain.m22);
        (batch.velocity[0][k], batch.velocity[1][k]) = (velocity.x, velocity.y);
        (batch.velocity_slope[0][k], batch.velocity_slope[1][k]) = (velocity_slope.x, velocity_slope.y);
        (batch.acceleration[0][k], batch.acceleration[1][k]) = (acceleration.x, acceleration.y);
    }

    /// The material of the point nearest to the tip, of these; none: there are no points.
    pub(crate) fn material_at_tip<'e>(&self, elastic: &'e [Elastic]) -> Option<&'e Elastic> {
        if elastic.len() == 1 {
            return (!self.material.is_empty()).then(|| &elastic[0]);
        }
        let distance = |&number: &usize| {
            let (batch, k) = (&self.batches[number / BATCH], number % BATCH);
            let arm = Point::new(batch.rest[0][k], batch.rest[1][k]) - self.tip;
            (self.frame() * arm).norm_squared()
        };
        let by_distance = |a: &usize, b: &usize| distance(a).total_cmp(&distance(b));
        (0..self.material.len()).min_by(by_distance).map(|nearest| &elastic[self.material[nearest] as usize])
    }

    /// From the world into the frame of the tip.
    pub(crate) fn frame(&self) -> Matrix {
        Matrix::new(self.ahead.x, self.ahead.y, -self.ahead.y, self.ahead.x)
    }

    /// The integrals over a disc; K only where that is `wanted`.
    pub(crate) fn integrals(&mut self, wanted: &Wanted<'_>) -> DomainIntegrals {
        let sums = run_widest(self.sums(wanted));
        self.with_contacts(wanted, sums)
    }

    /// The integrals of the sums over all points, which these have been left by in the frame of the tip.
    fn with_contacts(&self, wanted: &Wanted<'_>, (mut j, mut m): (f64, [f64; 2])) -> DomainIntegrals {
        let &Wanted { tip, cell_size, outer, .. } = wanted;
        let opened = m[0] > 0.0;
        let into = self.frame() * self.back();
        let contacts: Vec<FaceContact> =
            self.contacts.iter().map(|of| FaceContact { force: into * of.force, ..*of }).collect();
        let slope = |behind: f64| self.slope_of_sliding(behind, JUMP_REACH * cell_size);
        let taken = take_contacts(&contacts, tip, [cell_size, outer], (&mut j, &mut m), slope);
        let [mode_1, mode_2] = m.map(|m| 0.5 * tip.effective_modulus * m);
        j -= taken.of_tip * mode_2;
        DomainIntegrals { j_integral: j, mode_1, mode_2, closed: taken.pressed && !opened }
    }

    /// See [`slope_of_sliding`](super::domain::slope_of_sliding).
    fn slope_of_sliding(&self, behind: f64, reach: f64) -> f64 {
        let mut means = [(0.0, 0.0); 2];
        for number in 0..self.material.len() {
            let (batch, k) = (&self.batches[number / BATCH], number % BATCH);
            let arm = Vector::new(batch.rest[0][k], batch.rest[1][k]) - Vector::new(-behind, 0.0);
            if arm.norm_squared() < reach * reach {
                let mean = &mut means[usize::from(batch.side[k] < 0.0)];
                *mean = (mean.0 + batch.strain[0][k] * batch.volume[k], mean.1 + batch.volume[k]);
            }
        }
        match means {
            [(above, of_above), (below, of_below)] if of_above > 0.0 && of_below > 0.0 => {
                above / of_above - below / of_below
            }
            _ => 0.0,
        }
    }

    /// What takes the turn of the surroundings back.
    fn back(&self) -> Matrix {
        let mean = self.mean;
        // Rigid turn R of the surroundings (polar decomposition of the mean F).
        turn(2.0 + mean.m11 + mean.m22, mean.m21 - mean.m12).0.transpose()
    }

    fn sums<'a>(&'a mut self, wanted: &Wanted<'a>) -> Sums<'a> {
        let mean = self.mean_strain();
        self.mean = mean;
        let (_, back_minus_one) = turn(2.0 + mean.m11 + mean.m22, mean.m12 - mean.m21);
        let way = Way { tip: self.tip, frame: self.frame(), back: self.back(), back_minus_one };
        Sums { zone: self, way, wanted: *wanted }
    }

    /// Mean displacement gradient of particles where they stand.
    fn mean_strain(&self) -> Matrix {
        let mut sums = [0.0; 4];
        let mut far = self.far.iter().copied().peekable();
        for number in 0..self.material.len() {
            if far.next_if_eq(&number).is_some() {
                continue;
            }
            let batch = &self.batches[number / BATCH];
            (0..4).for_each(|k| sums[k] += batch.strain[k][number % BATCH]);
        }
        let [a, b, c, d] = sums;
        Matrix::new(a, b, c, d) / (self.material.len() - self.far.len()).max(1) as f64
    }
}

/// What is wanted of a zone.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wanted<'a> {
    /// The material at the tip.
    pub(crate) tip: &'a Elastic,
    /// [m].
    pub(crate) cell_size: f64,
    /// Radius of the disc [m].
    pub(crate) outer: f64,
    /// With the area terms of inertia.
    pub(crate) dynamic: bool,
    /// K too.
    pub(crate) modes: bool,
}

impl<'a> Wanted<'a> {
    /// J and K over the disc of radius `outer` [m] around a tip in the material `tip`.
    pub(crate) fn new(tip: &'a Elastic, cell_size: f64, outer: f64, dynamic: bool) -> Self {
        Self { tip, cell_size, outer, dynamic, modes: true }
    }
}

#[cfg(test)]
impl FreeZone {
    /// What all instructions that the machine has give, by their names.
    pub(crate) fn integrals_in_all(&self, wanted: &Wanted<'_>) -> Vec<(&'static str, DomainIntegrals)> {
        let found = crate::wide::run_in_all(|| Own { zone: self.clone(), wanted: *wanted });
        found.into_iter().map(|(name, (zone, sums))| (name, zone.with_contacts(wanted, sums))).collect()
    }
}

/// The sums over a zone of its own.
#[cfg(test)]
struct Own<'a> {
    zone: FreeZone,
    wanted: Wanted<'a>,
}

#[cfg(test)]
impl Loop for Own<'_> {
    type Output = (FreeZone, (f64, [f64; 2]));

    #[inline(always)]
    fn run(mut self) -> Self::Output {
        let sums = self.zone.sums(&self.wanted).run();
        (self.zone, sums)
    }
}
