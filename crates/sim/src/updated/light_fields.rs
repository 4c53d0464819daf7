//! Fields that are too light for their stiffness.
//!
//! Beside a tip a field may consist of small shares b of a few particles. Its mass goes with b, but the force on it
//! also with ∇b, which does not vanish with b: it would be thrown off, and strain its particles without bound. Such a
//! field moves with the heaviest field of its node as far as it must: of the difference of their accelerations only the
//! part β = `LARGEST_RATIO` (c_d/h)² m/k is left, with m and k = Σ (λ+2μ) V |∇w|² its own. The momentum of both
//! together stays, the inverse mass matrix stays symmetric, and forces in balance stay in balance.

use super::lattice::Lattice;
use super::nodes::Nodes;
use super::points::Points;
use super::setup::Setup;
use fissure_scene::{Kernel, TipDivision, Vector};

/// Largest stiffness over mass of a field, in units of (c_d/h)², that is left alone. Measured at 95 % of the stable
/// step with 68 places of a tip: with 1 a plate gains no energy in 400 steps by any kernel, with 2 the cubic one gains,
/// with 4 it fails.
const LARGEST_RATIO: f64 = 1.0;

/// Takes the forces on light fields to the heaviest fields of their nodes, as far as they are too large for them.
pub(super) fn relieve_light_fields(setup: &Setup, points: &Points, lattice: &Lattice, nodes: &mut Nodes) {
    let settings = &setup.scene.solver;
    // The bilinear kernel takes its strains from velocities that particles have, which no share can throw off.
    let smooth = settings.kernel != Kernel::Bilinear;
    if settings.tip_division != TipDivision::PartlyCut || !smooth || lattice.fields.further_count() == 0 {
        return;
    }
    let mut stiffness = vec![0.0; nodes.mass.len()];
    let mut speed_squared = 0.0_f64;
    for (p, entries) in lattice.stencils.iter() {
        let (mu, lambda) = points.moduli(setup, p);
        let modulus = (lambda + 2.0 * mu) * setup.particles.volume[p];
        speed_squared = speed_squared.max(modulus / setup.particles.mass[p]);
        for e in entries {
            stiffness[e.field as usize] += modulus * e.gradient.norm_squared();
        }
    }
    let most = LARGEST_RATIO * speed_squared / (setup.scene.cell_size * setup.scene.cell_size);
    for node in lattice.divided_nodes() {
        let mass = |field: usize| nodes.mass[field];
        let heaviest = lattice.fields_of(node).max_by(|&a, &b| mass(a).total_cmp(&mass(b)).then(b.cmp(&a)));
        let Some(heaviest) = heaviest else { continue };
        for light in lattice.fields_of(node) {
            let part = most * nodes.mass[light] / stiffness[light];
            // NaN for a field without mass and stiffness.
            if light == heaviest || nodes.mass[light] <= 0.0 || part.is_nan() || part >= 1.0 {
                continue;
            }
            let (m, heavy) = (nodes.mass[light], nodes.mass[heaviest]);
            let [fx, fy] = &mut nodes.after;
            let (f, g) = (Vector::new(fx[light], fy[light]), Vector::new(fx[heaviest], fy[heaviest]));
            let mean = (f + g) / (m + heavy);
            let apart = (f / m - g / heavy) * (part * m * heavy / (m + heavy));
            (fx[light], fy[light]) = (m * mean.x + apart.x, m * mean.y + apart.y);
            (fx[heaviest], fy[heaviest]) = (heavy * mean.x - apart.x, heavy * mean.y - apart.y);
        }
    }
}
