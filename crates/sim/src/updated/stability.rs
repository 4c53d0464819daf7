//! The largest stable time step.

use super::points::Points;
use super::setup::Setup;
use crate::grid::kernel::axis_stencil;
use crate::material::constitutive::principal_stretches;
use crate::material::elastic::Elastic;
use crate::threads::ranges;
use fissure_scene::{Kernel, Scene, Transfer};

/// Places of a particle between two nodes at which a kernel is tried, and how far each is shifted: a node at the end of
/// a kernel's reach has no weight, but beside that end a part of the spread.
const PLACES: usize = 256;
const BESIDE: f64 = 1e-6;

/// What Σ w'²/w stands for with the bilinear kernel, where it has no bound: strains come from remapped velocities
/// there. Measured: a cracked plate that flies through the cells (FLIP) is stable at c_d Δt/h = 0.4 and gains energy at
/// 0.6.
const BILINEAR_SPREAD: f64 = 16.0;

/// Farthest that a particle may move in a step [cells].
const LONGEST_WAY: f64 = 0.4;

/// Largest stable c_d Δt / h whatever the arrangement of particles, surfaces and cracks.
///
/// K = Σ_p K_p and M = Σ_p M_p with M_p = m_p diag(w_ip), so nothing is faster than the fastest single particle by its
/// own K_p, M_p (element eigenvalue theorem, Irons & Treharne 1971), and one that is alone is as fast. Kernels are
/// products, so that Σ_i ∇w ∇wᵀ/w = diag(S, S)/h² with S = Σ w'²/w along one axis; its modes are those of dilatation,
/// ω² = (c_d/h)² S (1 + λ/(λ+2μ)), and of shear, with a minus.
///
/// How long steps may be beside 1/ω says the transfer. With T for velocities of the grid that are sent to particles and
/// back, and particles that keep the part k of what the grid does not see (affine FLIP: that of `affine_flip`; FLIP 1;
/// PIC and APIC 0),
///
///   v' = T v⁺ + k (1 − T) v,   v⁺ = v − Δt M⁻¹K u,   u' = u + Δt v⁺.
///
/// M⁻¹K and T are symmetric in the product of M. Growth sets in with u' = −u, where Δt² (1 + k (1 − T)) M⁻¹K u =
/// 2 (1 + T + k (1 − T)) u. For one particle T is a projection, with XPIC too: of its fastest mode ∇w/w its affine
/// velocity holds the part α = 1/(S D), D = Σ w (x_i − x_p)², and nothing holds the rest, so that for every k
///
///   (ω Δt)² < 4 / (2 − α),   α = 0 without an affine velocity.
///
/// With ν = 0.3 in plane strain by affine transfers: GIMP 0.52, quadratic 0.59, cubic 0.92, by others 0.42, 0.48, 0.67.
/// Plates of ten cells, at rest anywhere: affine FLIP from 0.59, 0.77, 1.24 on, FLIP from 0.55, 0.68, 1.02 on.
fn stable_number(scene: &Scene, elastic: &Elastic) -> f64 {
    let (kernel, transfer) = (scene.solver.kernel, scene.solver.transfer);
    let is_affine = matches!(transfer, Transfer::Apic | Transfer::Aflip);
    // S (2 − α).
    let spread = if kernel == Kernel::Bilinear {
        BILINEAR_SPREAD * if transfer == Transfer::Aflip { 2.0 } else { 1.0 }
    } else {
        let half_size = (0.5 * scene.particle_spacing / scene.cell_size).min(0.5);
        (0..PLACES)
            .map(|k| spread_at(k as f64 / PLACES as f64 + BESIDE, kernel, half_size, is_affine))
            .fold(0.0, f64::max)
    };
    2.0 / (spread * (1.0 + (elastic.lambda / (elastic.lambda + 2.0 * elastic.mu)).abs())).sqrt()
}

/// S (2 − α) of a particle at `x` [cells], as in [`stable_number`] [–].
fn spread_at(x: f64, kernel: Kernel, half_size: f64, is_affine: bool) -> f64 {
    let stencil = axis_stencil(kernel, half_size, x);
    let parts = || stencil.weight.iter().zip(&stencil.gradient).enumerate().filter(|(_, (w, _))| **w > 0.0);
    let mean: f64 = parts().map(|(a, (w, _))| w * a as f64).sum();
    let inertia: f64 = parts().map(|(a, (w, _))| w * (a as f64 - mean).powi(2)).sum();
    let spread: f64 = parts().map(|(_, (w, g))| g * g / w).sum();
    if is_affine { 2.0 * spread - 1.0 / inertia } else { 2.0 * spread }
}

/// Bounds on the time step.
#[derive(Debug)]
pub(super) struct Stability {
    /// Largest stable c_d Δt / h of each material [–].
    number: Vec<f64>,
}

impl Stability {
    pub(super) fn of(setup: &Setup) -> Self {
        Self { number: setup.elastic.iter().map(|elastic| stable_number(&setup.scene, elastic)).collect() }
    }

    /// Largest stable step for the present state [s]: h N / c with the fastest wave c (stretch and hardening included);
    /// no particle moves by more than [`LONGEST_WAY`].
    ///
    /// A body that flies is as stable as one at rest, at any speed: plates of ten cells to .6 c. Only with the bilinear
    /// kernel, whose gradients jump between cells, its speed adds to that of waves.
    pub(super) fn largest_step(&self, setup: &Setup, points: &Points) -> f64 {
        let h = setup.scene.cell_size;
        let speed = largest_speed(setup, points);
        let carried = if setup.scene.solver.kernel == Kernel::Bilinear { speed } else { 0.0 };
        let rate_of = |p: usize| {
            let (material, point) = (setup.particles.material[p] as usize, &points.point[p]);
            // The tangent of P Fᵀ grows with the square of the largest stretch.
            let [stretch, _] = principal_stretches(&point.elastic_gradient);
            let hardening = points.plastic.get(p).map_or(1.0, |part| part.hardening.sqrt());
            let wave = setup.elastic[material].dilatational_wave_speed() * stretch.max(1.0) * hardening;
            (wave + carried) / (self.number[material] * h)
        };
        let fastest = ranges(points.point.len(), |particles| particles.map(rate_of).fold(0.0, f64::max));
        let rate = fastest.into_iter().fold(speed / (LONGEST_WAY * h), f64::max);
        1.0 / rate
    }
}

/// Speed of the fastest particle or support [m/s]: what is held may stand still now and move in the next step.
fn largest_speed(setup: &Setup, points: &Points) -> f64 {
    let speed_squared = |p: usize| points.point[p].velocity.norm_squared();
    let of_blocks = ranges(points.point.len(), |particles| particles.map(speed_squared).fold(0.0, f64::max));
    let of_particles = of_blocks.into_iter().fold(0.0, f64::max);
    let of_supports = setup.scene.supports.iter().map(|support| {
        let factor = support.curve.points.iter().fold(1.0_f64, |a, p| a.max(p.1.abs()));
        let v: f64 = support.velocity.iter().flatten().map(|v| v * v).sum();
        v * factor * factor
    });
    of_supports.fold(of_particles, f64::max).sqrt()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::grid::kernel::AxisStencil;
    use nalgebra::DMatrix;

    /// λ/(λ+2μ) at ν = 0.3 in plane strain.
    const SHARE: f64 = 3.0 / 7.0;

    /// Largest stable c_d Δt/h of a square of `side` by `side` particles half a cell apart that stays where it is, at
    /// the worst of some places in its cells, with affine PIC and the quadratic kernel: Δt² K ≤ 2 M (1 + T).
    fn of_square(side: usize) -> f64 {
        let places = || (0..4).flat_map(|k| [1e-4, 0.125].map(|beside| 0.25 * f64::from(k) + beside));
        // Both axes are alike.
        let all = places().flat_map(|x| places().filter(move |y| *y <= x).map(move |y| of_square_at(side, [x, y])));
        all.fold(f64::INFINITY, f64::min)
    }

    fn of_square_at(side: usize, at: [f64; 2]) -> f64 {
        let stencils = |x: f64| -> Vec<_> {
            (0..side)
                .map(|i| (x + 2.0 + 0.5 * i as f64, axis_stencil(Kernel::Quadratic, 0.0, x + 2.0 + 0.5 * i as f64)))
                .collect()
        };
        let (along, upwards) = (stencils(at[0]), stencils(at[1]));
        let width = side / 2 + 5;
        let nodes = width * width;
        let mut mass = vec![0.0; nodes];
        // Rows: strains of particles, with the root of their stiffness; what the affine transfer keeps of velocities.
        let mut strains: Vec<Vec<(usize, f64)>> = Vec::new();
        let mut kept: Vec<Vec<(usize, f64)>> = Vec::new();
        let mu = 0.5 * (1.0 - SHARE);
        let (sum, difference) = ((0.5 * (1.0 + SHARE)).sqrt(), mu.sqrt());
        for (x, sx) in &along {
            for (y, sy) in &upwards {
                let inertia = |place: f64, s: &AxisStencil| -> f64 {
                    (0..3).map(|a| s.weight[a] * (f64::from(s.first + a as i32) - place).powi(2)).sum()
                };
                let (root_x, root_y) = (inertia(*x, sx).sqrt(), inertia(*y, sy).sqrt());
                let mut strain = vec![Vec::new(); 3];
                let mut velocity = vec![Vec::new(); 3];
                for (a, b) in (0..9).map(|k| (k / 3, k % 3)) {
                    let place = [sx.first + a as i32, sy.first + b as i32];
                    let node = place[0] as usize + width * place[1] as usize;
                    let w = sx.weight[a] * sy.weight[b];
                    let [g, k] = [sx.gradient[a] * sy.weight[b], sx.weight[a] * sy.gradient[b]];
                    mass[node] += w;
                    // Dilatation, stretch of one axis against the other, shear: energies (1+s)/2, μ, μ.
                    strain[0].extend([(2 * node, sum * g), (2 * node + 1, sum * k)]);
                    strain[1].extend([(2 * node, difference * g), (2 * node + 1, -difference * k)]);
                    strain[2].extend([(2 * node, difference * k), (2 * node + 1, difference * g)]);
                    velocity[0].push((node, w));
                    velocity[1].push((node, w * (f64::from(place[0]) - x) / root_x));
                    velocity[2].push((node, w * (f64::from(place[1]) - y) / root_y));
                }
                strains.extend(strain);
                kept.extend(velocity);
            }
        }
        let scaled = |rows: &[Vec<(usize, f64)>], axes: usize| {
            let mut matrix = DMatrix::<f64>::zeros(rows.len(), axes * nodes);
            for (i, row) in rows.iter().enumerate() {
                for &(j, value) in row {
                    let m = mass[j / axes];
                    matrix[(i, j)] += if m > 1e-12 { value / m.sqrt() } else { 0.0 };
                }
            }
            matrix
        };
        let (strain, kept) = (scaled(&strains, 2), scaled(&kept, 1));
        let transfer = DMatrix::identity(nodes, nodes) + kept.transpose() * &kept;
        let both =
            DMatrix::from_fn(2 * nodes, 2 * nodes, |i, j| if i % 2 == j % 2 { transfer[(i / 2, j / 2)] } else { 0.0 });
        // Of L⁻¹ K L⁻ᵀ with M (1 + T) = L Lᵀ.
        let lower = both.cholesky().unwrap().l();
        let rows = lower.solve_lower_triangular(&strain.transpose()).unwrap();
        (2.0 / (rows.transpose() * rows).symmetric_eigenvalues().max()).sqrt()
    }

    /// Truth: the eigenvalues of squares of particles. One alone is stable to what is promised; of a whole plate that
    /// stays at the worst place a quarter longer steps would be, of four particles together a seventh: no more could
    /// be promised of bodies that may be any number of such, whatever was made of the masses that are there.
    #[test]
    fn plates_that_rest_are_stable_to_a_quarter_more_than_one_particle() {
        let spread = (0..PLACES).map(|k| spread_at(k as f64 / PLACES as f64 + BESIDE, Kernel::Quadratic, 0.25, true));
        let promised = 2.0 / (spread.fold(0.0, f64::max) * (1.0 + SHARE)).sqrt();
        for (side, expected) in [(1, 1.0), (2, 1.14), (10, 1.246)] {
            let part = of_square(side) / promised;
            assert!((part - expected).abs() < 0.008, "{side}: {part}");
        }
    }
}
