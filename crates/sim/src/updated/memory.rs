//! What the solver holds, counted before it is there.

use super::Updated;
use super::cut::Raw;
use super::plastic::PlasticPart;
use super::points::{MaterialPoint, Motion};
use super::setup::{has_affine, is_plastic};
use super::tracer::Tracer;
use crate::grid::entries::Entry;
use crate::grid::kernel;
use crate::memory::amounts::{Amounts, Need};
use fissure_scene::{Kernel, Matrix, Scene, Transfer, Vector};

/// Lists of a number per field: mass; x and y of the velocities before and after.
const NUMBERS_PER_FIELD: usize = 1 + 2 * 2;

/// Marks per node in search of contact: whether it has been visited, and whether its stencils reach a divided node.
const MARKS_PER_NODE: usize = 2;

impl Updated {
    /// What a run of `scene` holds.
    pub(crate) fn memory(scene: &Scene, amounts: &Amounts) -> Need {
        let if_any = |holds: bool, size: usize| if holds { size } else { 0 };
        let settings = &scene.solver;
        let has_cracks = !scene.cracks.is_empty();
        // Velocities that go to the grid once more.
        let gains = settings.transfer == Transfer::Aflip;
        let sends_back = settings.transfer == Transfer::Xpic || settings.kernel == Kernel::Bilinear;
        let saved = size_of::<MaterialPoint>()
            + if_any(has_affine(scene), size_of::<Matrix>())
            + if_any(is_plastic(scene), size_of::<PlasticPart>());
        // Its lowest node, where that is, and its place in the order of these; its motion and its row among those that
        // cracks divide.
        let particle = saved
            + 4 * size_of::<u32>()
            + if_any(has_cracks, size_of::<Motion>() + size_of::<u32>())
            + if_any(sends_back, size_of::<Vector>());
        // With where the particles of a node begin in that order.
        let node = NUMBERS_PER_FIELD * size_of::<f64>()
            + size_of::<u32>()
            + if_any(has_cracks, MARKS_PER_NODE * size_of::<bool>())
            + if_any(sends_back, size_of::<Vector>())
            + if_any(gains, size_of::<Vector>());
        let divided = kernel::width(settings.kernel).pow(2) * (size_of::<Entry>() + size_of::<Raw>());
        let outlines = amounts.outline_points * size_of::<Tracer>() as f64;
        Need {
            solver: amounts.particles * particle as f64
                + amounts.nodes * node as f64
                + amounts.crack_particles * divided as f64
                + outlines,
            state: amounts.particles * saved as f64 + outlines,
        }
    }
}
