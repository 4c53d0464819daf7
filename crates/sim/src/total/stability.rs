//! How fast the discrete material can move: the largest stable step, and the frequency of the present motion.

use super::field_vectors::FieldVectors;
use super::internal_forces;
use super::lattice::Lattice;
use super::motion::Motion;
use super::ties::Ties;
use crate::threads::{dot, of_blocks};

/// Rounds of the Lanczos iteration. On a plate of 20 × 40 cells with an edge crack 40 rounds give 3.4910e8 1/s², 300
/// rounds 3.4914e8.
const LANCZOS_ROUNDS: usize = 40;

/// What the largest Ritz value may still miss.
const RITZ_MARGIN: f64 = 1.01;

/// Largest stable step 2/ω_max [s] of the linearised discrete operator, cut cells included.
///
/// Lanczos iteration on M^-½ K M^-½: its largest Ritz value closes in on ω_max² from below, much faster than a power
/// iteration (Parlett 1998).
pub(super) fn largest_time_step(lattice: &Lattice) -> f64 {
    let fields = lattice.field_count();
    let root: Vec<f64> = lattice.inverse_mass.iter().map(|m| m.sqrt()).collect();
    // A fixed start with all wavelengths in it, the shortest most, and the divided nodes, where the stiffest modes sit,
    // stressed.
    let mut q: FieldVectors = [0, 1].map(|axis: i32| {
        lattice
            .places_of_fields()
            .enumerate()
            .map(|(d, [i, j])| {
                if root[d] == 0.0 {
                    return 0.0;
                }
                let sign = if (i + axis * (i + j)) & 1 == 0 { 1.0 } else { -1.0 };
                // Numbered as if all nodes of the box were there, so that it is the same however much of it is empty.
                let number = match d.checked_sub(lattice.grid.len()) {
                    None => lattice.grid.number_in_box([i, j]),
                    Some(further) => lattice.grid.nodes_of_box() + further as i64,
                };
                let jitter = (number.rem_euclid(1009) * 7919 + i64::from(axis) * 104_729) % 1009;
                let jitter = jitter as f64 / 1009.0;
                let divided = if d >= lattice.grid.len() { 4.0 } else { 1.0 };
                sign * (0.5 + jitter) * divided
            })
            .collect()
    });
    let norm = of_both(&mut q, |_, _, q| dot(q, q)).sqrt();
    if norm == 0.0 {
        return f64::INFINITY;
    }
    let mut biggest = divide(&mut q, norm, &root);
    let mut before: FieldVectors = [vec![0.0; fields], vec![0.0; fields]];
    let mut scaled = before.clone();
    let mut force: FieldVectors = [Vec::new(), Vec::new()];
    let (mut alphas, mut betas): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    for _ in 0..LANCZOS_ROUNDS {
        if biggest == 0.0 {
            break;
        }
        // K M^-½ q by the forces of a displacement so small that the law is linear to round-off.
        let amplitude = 1e-7 * lattice.grid.cell_size / biggest;
        of_both(&mut scaled, |axis, start, scaled| {
            for ((scaled, q), root) in scaled.iter_mut().zip(&q[axis][start..]).zip(&root[start..]) {
                *scaled = q * root * amplitude;
            }
            0.0
        });
        lattice.internal_forces(&scaled, false, &mut force);
        let beta = betas.last().copied().unwrap_or(0.0);
        let alpha = of_both(&mut force, |axis, start, force| {
            let lists = root[start..].iter().zip(&before[axis][start..]);
            for (force, (root, before)) in force.iter_mut().zip(lists) {
                *force = -*force * root / amplitude - beta * before;
            }
            dot(force, &q[axis][start..start + force.len()])
        });
        let next = of_both(&mut force, |axis, start, force| {
            for (force, q) in force.iter_mut().zip(&q[axis][start..]) {
                *force -= alpha * q;
            }
            dot(force, force)
        });
        alphas.push(alpha);
        let beta = next.sqrt();
        if beta <= 1e-12 * alpha.abs() {
            break;
        }
        betas.push(beta);
        biggest = divide(&mut force, beta, &root);
        std::mem::swap(&mut before, &mut q);
        std::mem::swap(&mut q, &mut force);
    }
    let n = alphas.len();
    let tridiagonal = nalgebra::DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 => alphas[i],
        1 => betas[i.min(j)],
        _ => 0.0,
    });
    let largest = tridiagonal.symmetric_eigenvalues().max();
    2.0 / (RITZ_MARGIN * largest).sqrt()
}

/// The sum of what `work` makes of the blocks of both components, given the axis and the place of the first number.
fn of_both(vectors: &mut FieldVectors, work: impl Fn(usize, usize, &mut [f64]) -> f64 + Sync + Send) -> f64 {
    let mut sum = 0.0;
    for (axis, numbers) in vectors.iter_mut().enumerate() {
        sum += of_blocks(numbers, |start, block| work(axis, start, block)).iter().sum::<f64>();
    }
    sum
}

/// Divides all of a vector and gives the largest product of its size with a `root`.
fn divide(vector: &mut FieldVectors, by: f64, root: &[f64]) -> f64 {
    let largest = |start: usize, block: &mut [f64]| {
        let mut largest = 0.0_f64;
        for (x, root) in block.iter_mut().zip(&root[start..]) {
            *x /= by;
            largest = largest.max((*x * root).abs());
        }
        largest
    };
    vector.iter_mut().flat_map(|numbers| of_blocks(numbers, largest)).fold(0.0, f64::max)
}

/// Rayleigh quotient ω² = v·K v / v·M v [1/s²] of the present velocities; none at rest.
pub(super) fn rayleigh_quotient(lattice: &Lattice, ties: &Ties, motion: &Motion) -> Option<f64> {
    let v = &motion.velocity;
    let speed = v.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
    if speed == 0.0 {
        return None;
    }
    // K v by a difference of forces over a displacement along v that is small beside a cell and large beside round-off.
    let step = 1e-6 * lattice.grid.cell_size / speed;
    let moved: FieldVectors =
        [0, 1].map(|axis| motion.displacement[axis].iter().zip(&v[axis]).map(|(u, v)| u + step * v).collect());
    let (mut here, mut there) = (FieldVectors::default(), FieldVectors::default());
    internal_forces(lattice, ties, &motion.displacement, &mut here);
    internal_forces(lattice, ties, &moved, &mut there);
    let change = |axis: usize, d: usize| (here[axis][d] - there[axis][d]) / step;
    let (mut stiffness, mut mass) = (0.0, 0.0);
    for (axis, velocity) in v.iter().enumerate() {
        for (d, &speed) in velocity.iter().enumerate() {
            stiffness += speed * change(axis, d);
            mass += speed * speed * lattice.mass()[d];
        }
    }
    (mass > 0.0 && stiffness > 0.0).then(|| stiffness / mass)
}
