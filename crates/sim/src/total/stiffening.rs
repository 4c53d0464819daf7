//! How much faster waves run where the material is stretched: the linearised operator is that of the material at rest.

use super::field_vectors::FieldVectors;
use super::run::Run;
use crate::material::elastic::Elastic;

/// Up to so many times the square of the highest frequency at rest [–] the limit at rest holds: fewer steps are taken
/// than it allows, and material that is strained by less than some per cents costs nothing.
const CALM: f64 = 1.1;

/// What waves of a material are at rest.
#[derive(Debug, Clone, Copy)]
struct Waves {
    /// Square of the speed of dilatation, by that of the fastest material [–].
    speed_squared: f64,
    /// λ/(λ+2μ), at least 0 [–].
    share: f64,
}

impl Waves {
    /// Bound on the square of a wave speed where the largest stretch has the square `stretch_squared`, by that of the
    /// fastest material at rest [–].
    ///
    /// Of motions a⊗N the second derivative of Ψ = μ|F − R|² + λ(J−1)²/2 is at most 2μ + λ (cof F N·a)², because J is
    /// linear along them, and |cof F N| is at most the largest stretch. It is as much for N across the stretch.
    fn stiffened(self, stretch_squared: f64) -> f64 {
        self.speed_squared * (1.0 + self.share * (stretch_squared - 1.0))
    }

    /// Square of the stretch up to which they are no faster than [`CALM`] allows.
    fn calm_stretch(self) -> f64 {
        // What is stretched by much less is out of range.
        (1.0 + (CALM / self.speed_squared - 1.0) / self.share).min(100.0)
    }
}

/// How much the material is stiffened by its stretch, now and when the steps of a run were planned.
#[derive(Debug)]
pub(super) struct Stiffening {
    /// Of each material.
    waves: Vec<Waves>,
    /// Square of the stretch of each material below which nothing is stiffened.
    calm: Vec<f64>,
    /// Square of the highest frequency by that at rest [–].
    now: f64,
    planned: f64,
}

impl Stiffening {
    /// That of material at rest.
    pub(super) fn new(elastic: &[Elastic]) -> Self {
        let squared = |e: &Elastic| e.dilatational_wave_speed().powi(2);
        let fastest = elastic.iter().map(squared).fold(0.0, f64::max);
        let of = |e: &Elastic| Waves {
            speed_squared: squared(e) / fastest,
            share: (e.lambda / (e.lambda + 2.0 * e.mu)).max(0.0),
        };
        let waves: Vec<Waves> = elastic.iter().map(of).collect();
        let calm = waves.iter().map(|waves| waves.calm_stretch()).collect();
        Self { waves, calm, now: 1.0, planned: 1.0 }
    }

    /// Square of the stretch of each material below which nothing is stiffened [–].
    pub(super) fn calm(&self) -> &[f64] {
        &self.calm
    }

    /// Steps are planned with what is now.
    pub(super) fn plan(&mut self) {
        self.planned = self.now;
    }

    /// The stable step by that at rest [–].
    pub(super) fn part_of_step(&self) -> f64 {
        1.0 / self.now.sqrt()
    }

    /// The stable step by that when steps were planned [–]; none where it is the same.
    pub(super) fn change(&self) -> Option<f64> {
        (self.now != self.planned).then(|| (self.planned / self.now).sqrt())
    }

    /// Nothing is stretched by more than is calm.
    pub(super) fn rest(&mut self) {
        self.now = 1.0;
    }

    /// Looks at all whole cells of `rows` at the displacements `u`. Cells that are cut have whole ones beside them.
    pub(super) fn look(&mut self, rows: &[Vec<Run>], u: &FieldVectors, cell_size: f64) {
        let mut most = 1.0_f64;
        for run in rows.iter().flatten() {
            let waves = self.waves[run.material as usize];
            for k in 0..run.count as usize {
                let stretch = squared_stretch(u, run.lower as usize + k, run.upper as usize + k, cell_size);
                most = most.max(waves.stiffened(stretch));
            }
        }
        self.now = if most > CALM { most } else { 1.0 };
    }
}

/// Bound on the square of the largest stretch in a cell, of what its lower and upper edge make with its left and right
/// one: F in it is a mean of these.
fn squared_stretch(u: &FieldVectors, lower: usize, upper: usize, cell_size: f64) -> f64 {
    let edge = |from: usize, to: usize, rest: [f64; 2]| {
        [0, 1].map(|axis: usize| rest[axis] + (u[axis][to] - u[axis][from]) / cell_size)
    };
    let along = [edge(lower, lower + 1, [1.0, 0.0]), edge(upper, upper + 1, [1.0, 0.0])];
    let across = [edge(lower, upper, [0.0, 1.0]), edge(lower + 1, upper + 1, [0.0, 1.0])];
    let pairs = along.iter().flat_map(|b| across.iter().map(move |a| (b, a)));
    pairs.map(|(b, a)| larger_square(norm_squared(b) + norm_squared(a), b[0] * a[1] - b[1] * a[0])).fold(0.0, f64::max)
}

fn norm_squared([x, y]: &[f64; 2]) -> f64 {
    x * x + y * y
}

/// The square of the largest singular value of F, from ‖F‖² and det F.
fn larger_square(norm_squared: f64, determinant: f64) -> f64 {
    let apart = (norm_squared - 2.0 * determinant) * (norm_squared + 2.0 * determinant);
    0.5 * (norm_squared + apart.max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy_density;
    use fissure_plane::{Matrix, Vector};
    use proptest::prelude::*;

    proptest! {
        /// Truth: the singular values of F anywhere in a cell, from the bilinear displacements of its nodes: none is
        /// above the bound, and where F is the same in all of the cell it is reached.
        #[test]
        fn no_place_in_a_cell_is_stretched_more_than_is_said(
            moved in prop::array::uniform8(-0.5_f64..0.5), at in (0.0_f64..=1.0, 0.0_f64..=1.0), cell_size in 0.1_f64..10.0,
        ) {
            // The cell from node 0 to 1 along the lower and from 2 to 3 along the upper edge.
            let node = |k: usize| Vector::new(moved[2 * k], moved[2 * k + 1]);
            let bound = |nodes: [Vector; 4]| {
                let mut u: FieldVectors = [vec![0.0; 4], vec![0.0; 4]];
                (0..4).for_each(|k| (0..2).for_each(|axis| u[axis][k] = nodes[k][axis] * cell_size));
                squared_stretch(&u, 0, 2, cell_size)
            };
            let largest = |along: Vector, up: Vector| {
                let f = Matrix::identity() + Matrix::from_columns(&[along, up]);
                f.singular_values().max().powi(2)
            };
            let [a, b, c, d] = [0, 1, 2, 3].map(node);
            let (along, up) = ((b - a) * (1.0 - at.1) + (d - c) * at.1, (c - a) * (1.0 - at.0) + (d - b) * at.0);
            let said = bound([a, b, c, d]);
            prop_assert!(largest(along, up) <= said * (1.0 + 1e-12), "{said}");
            // The largest is at one of the corners, each of an edge along and one up.
            let corners = [b - a, d - c].map(|along| [c - a, d - b].map(|up| largest(along, up)));
            let most = corners.iter().flatten().fold(0.0, |most: f64, s| most.max(*s));
            prop_assert!((said - most).abs() < 1e-12 * said, "{said} {most}");
        }

        /// Truth: second differences of the strain energy along a⊗N. None is above the bound, and along the smaller
        /// stretch it is reached.
        #[test]
        fn no_wave_is_faster_than_the_bound(
            stretches in (0.4_f64..2.5, 0.4_f64..2.5), angles in prop::array::uniform4(0.0_f64..6.3), share in 0.0_f64..0.9,
        ) {
            let turn = |angle: f64| Matrix::new(angle.cos(), -angle.sin(), angle.sin(), angle.cos());
            let (large, small) = (stretches.0.max(stretches.1), stretches.0.min(stretches.1));
            let (left, right) = (turn(angles[0]), turn(angles[1]));
            let f = left * Matrix::new(large, 0.0, 0.0, small) * right;
            // λ + 2μ = 1.
            let (lambda, mu) = (share, 0.5 * (1.0 - share));
            let energy = |way: &Matrix, by: f64| energy_density(&(f - Matrix::identity() + way * by), mu, lambda);
            let stiffness = |a: Vector, n: Vector| {
                let (way, step) = (a * n.transpose(), 1e-4);
                (energy(&way, step) + energy(&way, -step) - 2.0 * energy(&way, 0.0)) / (step * step)
            };
            let bound = Waves { speed_squared: 1.0, share }.stiffened(large * large);
            let unit = |angle: f64| turn(angle) * Vector::x();
            prop_assert!(stiffness(unit(angles[2]), unit(angles[3])) <= bound + 1e-5);
            let across = stiffness(left * Vector::y(), right.transpose() * Vector::y());
            prop_assert!((across - bound).abs() < 1e-5, "{across} {bound}");
            let (norm, determinant) = (f.norm_squared(), f.determinant());
            prop_assert!((larger_square(norm, determinant) - large * large).abs() < 1e-9);
        }
    }
}
