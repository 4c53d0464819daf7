//! The largest stable time step.

use super::points::Points;
use super::setup::Setup;
use crate::grid::kernel::axis_stencil;
use crate::material::constitutive::principal_stretches;
use crate::material::elastic::Elastic;
use fissure_scene::{Kernel, Scene, Transfer};

/// Places of a particle between two nodes at which a kernel is tried.
const PLACES: usize = 256;

/// What Σ w'²/w stands for with the bilinear kernel, where it has no bound: strains come from remapped velocities
/// there. Measured: a cracked plate that flies through the cells (FLIP) is stable at c_d Δt/h = 0.4 and gains energy at
/// 0.6.
const BILINEAR_SPREAD: f64 = 16.0;

/// Largest stable c_d Δt / h whatever the arrangement of particles, surfaces and cracks: 2/ω̂ with a bound ω̂ on all
/// frequencies.
///
/// K = Σ_p K_p and M = Σ_p M_p with M_p = m_p diag(w_ip), so no frequency is above the largest of a single particle's
/// K_p, M_p (element eigenvalue theorem, Irons & Treharne 1971). Kernels are products, so that Σ_i ∇w ∇wᵀ/w =
/// diag(S, S)/h² with S = Σ w'²/w along one axis, and a particle's largest frequency is that of dilatation:
/// ω² ≤ (c_d/h)² S (1 + λ/(λ+2μ)). S: GIMP 9.3, quadratic 6, cubic 3.2. With ν = 0.3 in plane strain: GIMP 0.55,
/// quadratic 0.68, cubic 0.94; measured on a cracked plate at rest and in flight: stable at 0.57, 0.62, 0.96, unstable
/// at 0.68, 0.78, 1.15.
fn stable_number(scene: &Scene, elastic: &Elastic) -> f64 {
    let (kernel, transfer) = (scene.solver.kernel, scene.solver.transfer);
    // S, and the part of a particle's fastest mode that its affine velocity holds.
    let (spread, held) = if kernel == Kernel::Bilinear {
        (BILINEAR_SPREAD, 0.0)
    } else {
        let half_size = (0.5 * scene.particle_spacing / scene.cell_size).min(0.5);
        let at = |k: usize| {
            let stencil = axis_stencil(kernel, half_size, (k as f64 + 0.5) / PLACES as f64);
            let parts = || stencil.weight.iter().zip(&stencil.gradient).enumerate().filter(|(_, (w, _))| **w > 0.0);
            let mean: f64 = parts().map(|(a, (w, _))| w * a as f64).sum();
            let inertia: f64 = parts().map(|(a, (w, _))| w * (a as f64 - mean).powi(2)).sum();
            let spread: f64 = parts().map(|(_, (w, g))| g * g / w).sum();
            (spread, 1.0 / (spread * inertia))
        };
        (0..PLACES).map(at).fold((0.0, 1.0), |worst, here| if here.0 > worst.0 { here } else { worst })
    };
    let kept = if transfer == Transfer::Aflip { affine_flip_limit(held) } else { 1.0 };
    2.0 * kept / (spread * (1.0 + elastic.lambda / (elastic.lambda + 2.0 * elastic.mu))).sqrt()
}

/// Part of the stable step that is left with affine FLIP for a mode of which particles hold the part α.
///
/// Particles that keep all of their velocity take up α of what forces change, but the material moves with all of it:
/// v' = v − α ω²Δt u, u' = u + Δt (v − ω²Δt u). Both eigenvalues are within the unit circle while (ωΔt)² < 4/(2 − α).
/// The fastest mode of a particle is ∇w/w, of which the affine velocity holds α = 1/(S D), D = Σ w (x_i − x_p)²: .67
/// with the quadratic kernel, .94 with the cubic one. A plate with a crack that was brought to rest at .9 of the limit
/// without this held 240 times its strain energy after 14,000 steps, in its corners.
fn affine_flip_limit(held: f64) -> f64 {
    (1.0 / (2.0 - held.min(1.0))).sqrt()
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

    /// Largest stable step for the present state [s]: h N / (c + |v|) with the fastest wave c (stretch and hardening
    /// included) and the fastest particle; no particle moves by more than half a cell.
    pub(super) fn largest_step(&self, setup: &Setup, points: &Points) -> f64 {
        let h = setup.scene.cell_size;
        let mut rate = 0.0_f64;
        let mut speed_squared = 0.0_f64;
        for point in &points.point {
            speed_squared = speed_squared.max(point.velocity.norm_squared());
        }
        // Held particles may stand still now and move in the next step.
        for support in &setup.scene.supports {
            let factor = support.curve.points.iter().fold(1.0_f64, |a, p| a.max(p.1.abs()));
            let v: f64 = support.velocity.iter().flatten().map(|v| v * v).sum();
            speed_squared = speed_squared.max(v * factor * factor);
        }
        let speed = speed_squared.sqrt();
        for (p, point) in points.point.iter().enumerate() {
            let material = setup.particles.material[p] as usize;
            // The tangent of P Fᵀ grows with the square of the largest stretch.
            let [stretch, _] = principal_stretches(&point.elastic_gradient);
            let hardening = points.plastic.get(p).map_or(1.0, |part| part.hardening.sqrt());
            let wave = setup.elastic[material].dilatational_wave_speed() * stretch.max(1.0) * hardening;
            rate = rate.max((wave + speed) / (self.number[material] * h));
        }
        let step = 1.0 / rate;
        if speed > 0.0 { step.min(0.5 * h / speed) } else { step }
    }
}
