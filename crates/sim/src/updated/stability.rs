//! The largest stable time step.

use super::points::Points;
use super::setup::Setup;
use crate::grid::kernel::axis_stencil;
use crate::material::constitutive::principal_stretches;
use crate::material::elastic::Elastic;
use fissure_scene::{Kernel, Scene};

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
    let kernel = scene.solver.kernel;
    let spread = if kernel == Kernel::Bilinear {
        BILINEAR_SPREAD
    } else {
        let half_size = (0.5 * scene.particle_spacing / scene.cell_size).min(0.5);
        let spread_at = |k: usize| -> f64 {
            let stencil = axis_stencil(kernel, half_size, (k as f64 + 0.5) / PLACES as f64);
            let parts = stencil.weight.iter().zip(&stencil.gradient).filter(|(w, _)| **w > 0.0);
            parts.map(|(w, g)| g * g / w).sum()
        };
        (0..PLACES).map(spread_at).fold(0.0, f64::max)
    };
    2.0 / (spread * (1.0 + elastic.lambda / (elastic.lambda + 2.0 * elastic.mu))).sqrt()
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
