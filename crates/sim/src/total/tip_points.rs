//! What particles do, taken into the frame of a tip: many side by side.

use super::disc::Found;
use super::lattice::Lattice;
use super::motion::Motion;
use super::reader::ParticleRates;
use crate::crack::crossing::Side;
use crate::tip::zone::QuadraturePoint;
use crate::wide::{Loop, run_widest};
use fissure_plane::{Matrix, Point, Vector};

/// What is around a tip is seen from here.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    /// The tip at rest [m].
    pub(super) tip: Point,
    /// Unit vector ahead of it, e1 of its frame.
    pub(super) ahead: Vector,
    /// Into its frame.
    pub(super) frame: Matrix,
    /// Takes the rigid turn of the surroundings back, and the same less 1.
    pub(super) back: [Matrix; 2],
    /// Time by which velocities are ahead of the rest [s].
    pub(super) half_step: f64,
}

/// A particle, or a part of one that a crack cuts: its number, its displacement gradient, how fast it moves, the share
/// of the volume that it is and the way from where the particle stands to its centre [m].
type Part = (usize, Matrix, ParticleRates, f64, Vector);

/// The points that particles are in the frame of a tip, those that a crack runs through as two; `side_of` says of a
/// place at rest which face it sees.
pub(super) fn points_of(
    lattice: &Lattice,
    motion: &Motion,
    found: Vec<Found>,
    seen: Seen,
    side_of: impl Fn(Point) -> Side,
) -> Vec<QuadraturePoint> {
    let mut parts: Vec<Part> = Vec::with_capacity(found.len() + found.len() / 4);
    let reader = lattice.reader();
    let whole = (1.0, Vector::zeros());
    for (p, strain, rates) in found {
        let own = lattice.layout.cut.part_of(p);
        let (share, way) = own.unwrap_or(whole);
        parts.push((p, strain, rates, share, way));
        // What no crack cuts has nothing across one.
        if own.is_none() {
            continue;
        }
        if let (Some(strain), Some(rates)) = (reader.far_strain(p, &motion.displacement), reader.far_rates(p, motion)) {
            let (share, way) = lattice.layout.far.part_of(p).unwrap_or(whole);
            parts.push((p, strain, rates, share, way));
        }
    }
    let sides: Vec<Side> = parts.iter().map(|(p, .., way)| side_of(lattice.particles.rest[*p] + way)).collect();
    run_widest(Taking { lattice, seen, parts: &parts, sides: &sides })
}

/// Parts that are taken into the frame at once.
const AT_ONCE: usize = 8;

/// A number of each of them.
type Lane = [f64; AT_ONCE];

/// Takes parts into the frame.
struct Taking<'a> {
    lattice: &'a Lattice,
    seen: Seen,
    parts: &'a [Part],
    sides: &'a [Side],
}

impl Loop for Taking<'_> {
    type Output = Vec<QuadraturePoint>;

    #[inline(always)]
    fn run(self) -> Vec<QuadraturePoint> {
        let Self { lattice, seen, parts, sides } = self;
        let particles = &lattice.particles;
        let mut points = Vec::with_capacity(parts.len());
        for (parts, sides) in parts.chunks(AT_ONCE).zip(sides.chunks(AT_ONCE)) {
            let mut read = Read::default();
            for (k, (p, h, rates, _, way)) in parts.iter().enumerate() {
                let (rest, e) = (particles.rest[*p], lattice.material(*p));
                put(&mut read.strain, k, [h.m11, h.m21, h.m12, h.m22]);
                let (u, v, a) = (rates.displacement, rates.velocity, rates.acceleration);
                put(&mut read.displacement, k, u.into());
                put(&mut read.velocity, k, v.into());
                let g = rates.velocity_gradient;
                put(&mut read.velocity_gradient, k, [g.m11, g.m21, g.m12, g.m22]);
                put(&mut read.acceleration, k, a.into());
                put(&mut read.rest, k, [rest.x, rest.y]);
                put(&mut read.way, k, (*way).into());
                put(&mut read.elastic, k, [e.mu, e.lambda]);
            }
            let taken = take(&seen, &read);
            for (k, ((p, _, _, share, _), side)) in parts.iter().zip(sides).enumerate() {
                let vector = |of: &[Lane; 2]| Vector::new(of[0][k], of[1][k]);
                let matrix = |of: &[Lane; 4]| Matrix::new(of[0][k], of[2][k], of[1][k], of[3][k]);
                points.push(QuadraturePoint {
                    place: vector(&taken.place),
                    displacement: vector(&taken.displacement),
                    side: *side,
                    volume: particles.volume[*p] * share,
                    stress: matrix(&taken.stress),
                    gradient: matrix(&taken.gradient),
                    energy: taken.energy[k],
                    density: lattice.material(*p).density,
                    velocity: vector(&taken.velocity),
                    velocity_slope: vector(&taken.velocity_slope),
                    acceleration: vector(&taken.acceleration),
                    material: particles.material[*p],
                });
            }
        }
        points
    }
}

/// What was read of some parts; matrices column by column.
#[derive(Default)]
struct Read {
    strain: [Lane; 4],
    displacement: [Lane; 2],
    velocity: [Lane; 2],
    velocity_gradient: [Lane; 4],
    acceleration: [Lane; 2],
    rest: [Lane; 2],
    way: [Lane; 2],
    /// μ and λ [Pa].
    elastic: [Lane; 2],
}

/// The same in the frame of the tip.
#[derive(Default)]
struct Taken {
    place: [Lane; 2],
    displacement: [Lane; 2],
    stress: [Lane; 4],
    gradient: [Lane; 4],
    energy: Lane,
    velocity: [Lane; 2],
    velocity_slope: [Lane; 2],
    acceleration: [Lane; 2],
}

#[inline(always)]
fn put<const N: usize>(lanes: &mut [Lane; N], k: usize, numbers: [f64; N]) {
    for (lane, number) in lanes.iter_mut().zip(numbers) {
        lane[k] = number;
    }
}

#[inline(always)]
fn take(seen: &Seen, read: &Read) -> Taken {
    let Seen { tip, ahead, frame, back: [back, back_minus_one], half_step } = *seen;
    let mut taken = Taken::default();
    let across = frame.transpose();
    for k in 0..AT_ONCE {
        let vector = |of: &[Lane; 2]| Vector::new(of[0][k], of[1][k]);
        let matrix = |of: &[Lane; 4]| Matrix::new(of[0][k], of[2][k], of[1][k], of[3][k]);
        let (h, way, [mu, lambda]) = (matrix(&read.strain), vector(&read.way), read.elastic.map(|lane| lane[k]));
        let acceleration = vector(&read.acceleration);
        let velocity = vector(&read.velocity) - acceleration * half_step;
        let arm = Vector::new(read.rest[0][k] + way.x - tip.x, read.rest[1][k] + way.y - tip.y);
        let turned = |v: Vector| times(&frame, times(&back, v));
        let into = |m: Matrix| product(&product(&frame, &m), &across);
        let stress = into(product(&back, &crate::first_piola_stress(&h, mu, lambda)));
        let gradient = into(product(&back, &h) + back_minus_one);
        let displacement = times(&back, vector(&read.displacement) + times(&h, way)) + times(&back_minus_one, arm);
        put(&mut taken.place, k, times(&frame, arm).into());
        put(&mut taken.displacement, k, times(&frame, displacement).into());
        put(&mut taken.stress, k, [stress.m11, stress.m21, stress.m12, stress.m22]);
        put(&mut taken.gradient, k, [gradient.m11, gradient.m21, gradient.m12, gradient.m22]);
        taken.energy[k] = crate::energy_density(&h, mu, lambda);
        put(&mut taken.velocity, k, turned(velocity).into());
        put(&mut taken.velocity_slope, k, turned(times(&matrix(&read.velocity_gradient), ahead)).into());
        put(&mut taken.acceleration, k, turned(acceleration).into());
    }
    taken
}

/// A matrix times a vector, in the order of `nalgebra` but inlined.
#[inline(always)]
fn times(m: &Matrix, v: Vector) -> Vector {
    Vector::new(m.m11 * v.x + m.m12 * v.y, m.m21 * v.x + m.m22 * v.y)
}

/// A matrix times another, as [`times`].
#[inline(always)]
fn product(a: &Matrix, b: &Matrix) -> Matrix {
    Matrix::new(
        a.m11 * b.m11 + a.m12 * b.m21,
        a.m11 * b.m12 + a.m12 * b.m22,
        a.m21 * b.m11 + a.m22 * b.m21,
        a.m21 * b.m12 + a.m22 * b.m22,
    )
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::test_scenes::{free_body, rectangle};
    use crate::wide::run_in_all;
    use proptest::prelude::*;
    use std::sync::Arc;

    /// `part` in the frame, vector by vector and matrix by matrix.
    fn one_by_one(lattice: &Lattice, seen: &Seen, (p, h, rates, share, way): Part, side: Side) -> QuadraturePoint {
        let Seen { tip, ahead, frame, back: [back, back_minus_one], half_step } = *seen;
        let (particles, e) = (&lattice.particles, lattice.material(p));
        let into = |m: Matrix| frame * m * frame.transpose();
        let arm = particles.rest[p] + way - tip;
        let velocity = rates.velocity - rates.acceleration * half_step;
        QuadraturePoint {
            place: frame * arm,
            displacement: frame * (back * (rates.displacement + h * way) + back_minus_one * arm),
            side,
            volume: particles.volume[p] * share,
            stress: into(back * crate::first_piola_stress(&h, e.mu, e.lambda)),
            gradient: into(back * h + back_minus_one),
            energy: crate::energy_density(&h, e.mu, e.lambda),
            density: e.density,
            velocity: frame * (back * velocity),
            velocity_slope: frame * (back * (rates.velocity_gradient * ahead)),
            acceleration: frame * (back * rates.acceleration),
            material: particles.material[p],
        }
    }

    proptest! {
        /// Truth: the products that `nalgebra` makes, part by part, to the bit, with all instructions that the machine
        /// has. Parts that fill the lanes and that do not, turned by any angle, strained by much and by nothing.
        #[test]
        fn parts_side_by_side_are_taken_as_they_are_one_by_one(
            numbers in prop::collection::vec(prop::array::uniform16(-1.0_f64..1.0), 0..30), angles in [0.0_f64..6.3, 0.0_f64..6.3],
            half_step in 0.0_f64..1e-3, size in prop::sample::select(vec![0.0, 1e-9, 1e-3, 3.0]),
        ) {
            let scene = free_body(rectangle([0.0, 0.0], [1.0, 1.0]), 0.125);
            let particles = Arc::new(crate::particles::Particles::fill(&scene).unwrap());
            let lattice = Lattice::new(&scene, particles, 0.0).unwrap();
            let turn = |angle: f64| Matrix::new(angle.cos(), angle.sin(), -angle.sin(), angle.cos());
            let [frame, back] = angles.map(turn);
            let ahead = Vector::new(frame.m11, frame.m12);
            let seen = Seen { tip: Point::new(0.4, 0.6), ahead, frame, back: [back, back - Matrix::identity()], half_step };
            let part = |(k, n): (usize, &[f64; 16])| {
                let strain = Matrix::new(n[0], n[1], n[2], n[3]) * size;
                let rates = ParticleRates {
                    displacement: Vector::new(n[4], n[5]),
                    velocity: Vector::new(n[6], n[7]),
                    velocity_gradient: Matrix::new(n[8], n[9], n[10], n[11]),
                    acceleration: Vector::new(n[12], n[13]),
                };
                (k, strain, rates, n[14].abs(), Vector::new(n[14], n[15]) * 0.01)
            };
            let parts: Vec<Part> = numbers.iter().enumerate().map(part).collect();
            let sides: Vec<Side> = numbers.iter().map(|n| if n[0] > 0.0 { Side::Above } else { Side::Below }).collect();
            let wanted: Vec<QuadraturePoint> =
                parts.iter().zip(&sides).map(|(part, side)| one_by_one(&lattice, &seen, *part, *side)).collect();
            let taking = || Taking { lattice: &lattice, seen, parts: &parts, sides: &sides };
            for (instructions, found) in run_in_all(taking) {
                prop_assert_eq!(format!("{:?}", found), format!("{:?}", wanted), "{}", instructions);
            }
        }
    }
}
