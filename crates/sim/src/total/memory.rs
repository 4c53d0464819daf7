//! What the solver holds, counted before it is there.

use super::lattice::kernel_of;
use super::probe::Probe;
use crate::grid::entries::Entry;
use crate::grid::kernel;
use crate::memory::amounts::{Amounts, Need};
use fissure_scene::{Kernel, Scene};

/// Lists of a number per field: mass and its inverse; x and y of displacement, velocity, the velocity before the kick,
/// and force.
const NUMBERS_PER_FIELD: usize = 2 + 4 * 2;
/// Those of them that the state has.
const SAVED_PER_FIELD: usize = 5;
/// Numbers of a particle on the general path besides its entries: row, particle, first entry, misfit [bytes].
const CUT_PARTICLE: usize = 3 * size_of::<u32>() + size_of::<[f64; 4]>();
/// Room for entries that every probe has.
const PROBE_ENTRIES: usize = 8;
/// Numbers of a row on the general path that every particle has: of its own part and of what lies across a crack.
const ROWS_OF_PARTICLE: usize = 2;

/// What a run of `scene` holds.
pub(crate) fn need(scene: &Scene, amounts: &Amounts) -> Need {
    let has_rows = kernel_of(scene) == Kernel::Bilinear
        && (scene.cell_size - 2.0 * scene.particle_spacing).abs() < 1e-12 * scene.cell_size;
    let cut_particles = if has_rows { amounts.cut_particles } else { amounts.particles };
    let entries = kernel::width(kernel_of(scene)).pow(2) * size_of::<Entry>();
    let cut = cut_particles * (entries + CUT_PARTICLE) as f64;
    // While entries are laid they are there twice.
    let laid = cut_particles * entries as f64;
    let probe = size_of::<Probe>() + PROBE_ENTRIES * size_of::<(u32, f64)>();
    let number = size_of::<f64>();
    Need {
        solver: amounts.nodes * (NUMBERS_PER_FIELD * number) as f64
            + amounts.particles * (ROWS_OF_PARTICLE * size_of::<u32>()) as f64
            + cut
            + laid
            + amounts.outline_points * probe as f64,
        state: amounts.nodes * (SAVED_PER_FIELD * number) as f64
            + cut
            + amounts.outline_points * size_of::<Probe>() as f64,
    }
}
