//! Whether the material is finite and within what the formulation can follow.

use super::field_vectors::FieldVectors;
use super::lattice::Lattice;
use super::motion::Motion;
use crate::SimulationError;
use crate::material::constitutive::principal_stretches;

/// Volume ratio below which the total Lagrangian formulation is out of its range.
const SMALLEST_VOLUME_RATIO: f64 = 0.2;

/// Principal stretch above which it is.
const LARGEST_STRETCH: f64 = 3.0;

/// With no component of H above this, ‖H‖ is at most twice it, so that the singular values of F lie between 0.5 and 1.5
/// and det F is at least 0.25: within the range.
const SOUND_STRAIN: f64 = 0.25;

/// Whether every particle is finite and within the range of the formulation at the time `time` [s].
///
/// # Errors
/// When one is not.
pub(super) fn check_range(lattice: &Lattice, motion: &Motion, time: f64) -> Result<(), SimulationError> {
    let whole_cells_are_sound = largest_edge_strain(lattice, &motion.displacement) < SOUND_STRAIN;
    let mut reader = lattice.reader();
    for p in 0..lattice.particles.len() {
        if whole_cells_are_sound && lattice.layout.cut.entries_of(p).is_none() {
            continue;
        }
        let now = reader.motion(p, motion);
        let (h, place) = (now.strain, lattice.particles.rest[p] + now.displacement);
        let fail = |cause: String| SimulationError::Unstable { time, x: place.x, y: place.y, cause };
        let volume_ratio = 1.0 + crate::volume_change(&h);
        if !volume_ratio.is_finite() {
            return Err(fail(format!(
                "particle {p} has lost its finite state; use a smaller `solver.courant` or weaker loads"
            )));
        }
        let [stretch, _] = principal_stretches(&h);
        if volume_ratio < SMALLEST_VOLUME_RATIO || stretch > LARGEST_STRETCH {
            return Err(SimulationError::OutOfRange {
                time,
                x: place.x,
                y: place.y,
                cause: format!(
                    "particle {p} is stretched to {stretch:.2} with a volume ratio of {volume_ratio:.2}, out of the range of the \
                     total Lagrangian formulation (below {LARGEST_STRETCH} and above {SMALLEST_VOLUME_RATIO})"
                ),
            });
        }
    }
    Ok(())
}

/// Largest difference of displacement along an edge of an uncut cell, over its length. A bound for every such cell: no
/// component of H in it is larger. NaN gives infinity.
fn largest_edge_strain(lattice: &Lattice, u: &FieldVectors) -> f64 {
    let mut largest = 0.0_f64;
    for u in u {
        let mut look = |a: f64, b: f64| {
            let difference = (a - b).abs();
            largest = if difference <= f64::MAX { largest.max(difference) } else { f64::INFINITY };
        };
        for run in lattice.layout.runs.iter().flatten() {
            let [lower, upper] =
                [run.lower, run.upper].map(|first| &u[first as usize..(first + run.count + 1) as usize]);
            [lower, upper].into_iter().for_each(|row| row.windows(2).for_each(|w| look(w[0], w[1])));
            lower.iter().zip(upper).for_each(|(a, b)| look(*a, *b));
        }
    }
    largest / lattice.grid.cell_size
}
