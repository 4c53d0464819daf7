//! How fast the discrete material can move: the largest stable step, and the frequency of the present motion.

use super::field_vectors::FieldVectors;
use super::internal_forces;
use super::lattice::Lattice;
use super::motion::Motion;
use super::ties::Ties;
use crate::threads::{dot, of_blocks};
use crate::wide::{Loop, run_widest};

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
    let mut q = start(lattice, &root);
    let norm = of_both(&mut q, |_, _, q| run_widest(Square { q })).sqrt();
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
            run_widest(Scale { scaled, q: &q[axis][start..], root: &root[start..], amplitude });
            0.0
        });
        lattice.internal_forces(&scaled, false, &mut force);
        let beta = betas.last().copied().unwrap_or(0.0);
        let alpha = of_both(&mut force, |axis, start, force| {
            let (root, before, q) = (&root[start..], &before[axis][start..], &q[axis][start..]);
            run_widest(Next { force, root, before, q, amplitude, beta })
        });
        let next =
            of_both(&mut force, |axis, start, force| run_widest(Orthogonal { force, q: &q[axis][start..], alpha }));
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
    let largest = |start: usize, numbers: &mut [f64]| run_widest(Divide { numbers, root: &root[start..], by });
    vector.iter_mut().flat_map(|numbers| of_blocks(numbers, largest)).fold(0.0, f64::max)
}

/// Numbers that jitter takes its values from, a prime.
const JITTERS: usize = 1009;

/// A fixed start with all wavelengths in it, the shortest most, and the divided nodes, where the stiffest modes sit,
/// stressed; zero where a field has no mass, of which `root` is one over the square root.
fn start(lattice: &Lattice, root: &[f64]) -> FieldVectors {
    let jitters: [[f64; JITTERS]; 2] = [0, 1].map(|axis: usize| {
        std::array::from_fn(|number| ((number * 7919 + axis * 104_729) % JITTERS) as f64 / JITTERS as f64)
    });
    let mut start: FieldVectors = [0, 1].map(|_| Vec::with_capacity(root.len()));
    for (d, [i, j]) in lattice.places_of_fields().enumerate() {
        if root[d] == 0.0 {
            start.iter_mut().for_each(|numbers| numbers.push(0.0));
            continue;
        }
        // Numbered as if all nodes of the box were there, so that it is the same however much of it is empty.
        let number = match d.checked_sub(lattice.grid.len()) {
            None => lattice.grid.number_in_box([i, j]),
            Some(further) => lattice.grid.nodes_of_box() + further as i64,
        };
        let number = number.rem_euclid(JITTERS as i64) as usize;
        let divided = if d >= lattice.grid.len() { 4.0 } else { 1.0 };
        for (axis, numbers) in (0..).zip(&mut start) {
            let sign = if (i + axis * (i + j)) & 1 == 0 { 1.0 } else { -1.0 };
            numbers.push(sign * (0.5 + jitters[axis as usize][number]) * divided);
        }
    }
    start
}

/// q · q.
struct Square<'a> {
    q: &'a [f64],
}

impl Loop for Square<'_> {
    type Output = f64;

    #[inline(always)]
    fn run(self) -> f64 {
        dot(self.q, self.q)
    }
}

/// A displacement along M^-½ q.
struct Scale<'a> {
    scaled: &'a mut [f64],
    q: &'a [f64],
    root: &'a [f64],
    amplitude: f64,
}

impl Loop for Scale<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for ((scaled, q), root) in self.scaled.iter_mut().zip(self.q).zip(self.root) {
            *scaled = q * root * self.amplitude;
        }
    }
}

/// Makes the forces M^-½ K M^-½ q − β q_before, and gives their product with q.
struct Next<'a> {
    force: &'a mut [f64],
    root: &'a [f64],
    before: &'a [f64],
    q: &'a [f64],
    amplitude: f64,
    beta: f64,
}

impl Loop for Next<'_> {
    type Output = f64;

    #[inline(always)]
    fn run(self) -> f64 {
        let Self { force, root, before, q, amplitude, beta } = self;
        for (force, (root, before)) in force.iter_mut().zip(root.iter().zip(before)) {
            *force = -*force * root / amplitude - beta * before;
        }
        dot(force, &q[..force.len()])
    }
}

/// Takes off what lies along q, and gives the square of what is left.
struct Orthogonal<'a> {
    force: &'a mut [f64],
    q: &'a [f64],
    alpha: f64,
}

impl Loop for Orthogonal<'_> {
    type Output = f64;

    #[inline(always)]
    fn run(self) -> f64 {
        for (force, q) in self.force.iter_mut().zip(self.q) {
            *force -= self.alpha * q;
        }
        dot(self.force, self.force)
    }
}

/// See [`divide`].
struct Divide<'a> {
    numbers: &'a mut [f64],
    root: &'a [f64],
    by: f64,
}

impl Loop for Divide<'_> {
    type Output = f64;

    #[inline(always)]
    fn run(self) -> f64 {
        // Some beside each other; which of them is the largest does not depend on how many.
        const BESIDE: usize = 8;
        let Self { numbers, root, by } = self;
        let root = &root[..numbers.len()];
        let mut largest = [0.0_f64; BESIDE];
        for (numbers, root) in numbers.chunks_mut(BESIDE).zip(root.chunks(BESIDE)) {
            for ((x, root), largest) in numbers.iter_mut().zip(root).zip(&mut largest) {
                *x /= by;
                let size = (*x * root).abs();
                *largest = if size > *largest { size } else { *largest };
            }
        }
        largest.into_iter().fold(0.0, f64::max)
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wide::run_in_all;
    use proptest::prelude::*;

    proptest! {
        /// Truth: the formulas number by number, to the bit, with all instructions that the machine has.
        #[test]
        fn rounds_are_what_their_formulas_say(
            lists in prop::collection::vec(prop::array::uniform4(-2.0_f64..2.0), 0..40), amplitude in 1e-9_f64..1.0,
            alpha in -3.0_f64..3.0,
        ) {
            let list = |k: usize| -> Vec<f64> { lists.iter().map(|numbers| numbers[k]).collect() };
            let (force, q, before, root) = (list(0), list(1), list(2), list(3));
            let all = 0..force.len();
            let next: Vec<f64> = all.clone().map(|d| -force[d] * root[d] / amplitude - alpha * before[d]).collect();
            let orthogonal: Vec<f64> = all.clone().map(|d| force[d] - alpha * q[d]).collect();
            let divided: Vec<f64> = all.clone().map(|d| force[d] / amplitude).collect();
            let largest = all.map(|d| (divided[d] * root[d]).abs()).fold(0.0, f64::max);
            let wanted = [(dot(&next, &q), next), (dot(&orthogonal, &orthogonal), orthogonal), (largest, divided)];
            for (k, wanted) in wanted.into_iter().enumerate() {
                for instructions in 0..run_in_all(|| Square { q: &q }).len() {
                    let mut numbers = force.clone();
                    let number = {
                        let mut lists: Vec<Vec<f64>> = vec![force.clone(); 3];
                        let mut free = lists.iter_mut();
                        let mut own = || free.next().map_or(Default::default(), Vec::as_mut_slice);
                        let found = match k {
                            0 => run_in_all(|| Next { force: own(), root: &root, before: &before, q: &q, amplitude, beta: alpha }),
                            1 => run_in_all(|| Orthogonal { force: own(), q: &q, alpha }),
                            _ => run_in_all(|| Divide { numbers: own(), root: &root, by: amplitude }),
                        };
                        numbers.clone_from(&lists[instructions]);
                        found[instructions].1
                    };
                    prop_assert_eq!((number, numbers), wanted.clone(), "{} {}", k, instructions);
                }
            }
        }
    }
}
