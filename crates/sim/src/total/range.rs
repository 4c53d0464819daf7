//! Whether the material is finite and within what the formulation can follow.

use super::field_vectors::FieldVectors;
use super::lattice::Lattice;
use super::motion::Motion;
use super::run::Run;
use crate::SimulationError;
use crate::material::constitutive::principal_stretches;
use crate::threads;
use crate::wide::{Loop, run_widest};
use fissure_plane::Matrix;
use std::ops::Range;

/// Volume ratio below which the total Lagrangian formulation is out of its range.
const SMALLEST_VOLUME_RATIO: f64 = 0.2;

/// Principal stretch above which it is.
const LARGEST_STRETCH: f64 = 3.0;

/// Whether every particle is finite and within the range of the formulation at the time `time` [s]. Gives whether no
/// whole cell is stretched by more than the roots of `calm`, one of each material [–].
///
/// # Errors
/// When one is not.
pub(super) fn check_range(
    lattice: &Lattice,
    motion: &Motion,
    time: f64,
    calm: &[f64],
) -> Result<bool, SimulationError> {
    let mut reader = lattice.reader();
    let mut is_in_range = |p| is_in_range(&reader.strain(p, &motion.displacement));
    let cells = look_at_whole_cells(lattice, &motion.displacement, calm);
    if cells.are_in_range && lattice.layout.cut.particles().all(&mut is_in_range) {
        return Ok(cells.are_calm);
    }
    match (0..lattice.particles.len()).find(|&p| !is_in_range(p)) {
        Some(particle) => Err(out_of_range(lattice, motion, time, particle)),
        None => Ok(cells.are_calm),
    }
}

/// Whether a particle with the displacement gradient `h` is finite and within the range.
fn is_in_range(h: &Matrix) -> bool {
    let volume_ratio = 1.0 + crate::volume_change(h);
    // The largest stretch is at most ‖F‖.
    let is_surely_short = (Matrix::identity() + h).norm_squared() <= LARGEST_STRETCH * LARGEST_STRETCH;
    volume_ratio.is_finite()
        && volume_ratio >= SMALLEST_VOLUME_RATIO
        && (is_surely_short || principal_stretches(h)[0] <= LARGEST_STRETCH)
}

/// What a particle that is not finite, or out of the range, ends the run with.
fn out_of_range(lattice: &Lattice, motion: &Motion, time: f64, particle: usize) -> SimulationError {
    let now = lattice.reader().motion(particle, motion);
    let (h, place) = (now.strain, lattice.particles.rest[particle] + now.displacement);
    let volume_ratio = 1.0 + crate::volume_change(&h);
    if !volume_ratio.is_finite() {
        let cause =
            format!("particle {particle} has lost its finite state; use a smaller `solver.courant` or weaker loads");
        return SimulationError::Unstable { time, x: place.x, y: place.y, cause };
    }
    let [stretch, _] = principal_stretches(&h);
    let cause = format!(
        "particle {particle} is stretched to {stretch:.2} with a volume ratio of {volume_ratio:.2}, out of the range of the \
         total Lagrangian formulation (below {LARGEST_STRETCH} and above {SMALLEST_VOLUME_RATIO})"
    );
    SimulationError::OutOfRange { time, x: place.x, y: place.y, cause }
}

/// What is seen of uncut cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Cells {
    /// Whether every particle of them is finite and within the range, however the material has moved and turned.
    are_in_range: bool,
    /// Whether none is stretched by more than is calm.
    are_calm: bool,
}

impl Cells {
    const SOUND: Self = Self { are_in_range: true, are_calm: true };

    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Self { are_in_range: self.are_in_range & other.are_in_range, are_calm: self.are_calm & other.are_calm }
    }
}

/// Looks at all uncut cells.
fn look_at_whole_cells(lattice: &Lattice, u: &FieldVectors, calm: &[f64]) -> Cells {
    let rows = 0..lattice.grid.rows();
    let part = threads::part(lattice.grid.len());
    let rows_of_part = rows.len() / (lattice.grid.len() / part.max(1)).max(1);
    look_at_rows(lattice, u, calm, rows, rows_of_part.max(1))
}

/// Looks at the uncut cells in `rows`, shared out in parts of at most `part` rows.
fn look_at_rows(lattice: &Lattice, u: &FieldVectors, calm: &[f64], rows: Range<usize>, part: usize) -> Cells {
    if rows.len() <= part {
        return run_widest(Rows {
            runs: &lattice.layout.runs[rows],
            u,
            calm,
            inverse_cell_size: 1.0 / lattice.grid.cell_size,
        });
    }
    let middle = rows.start + rows.len() / 2;
    let (lower, upper) = threads::join(
        || look_at_rows(lattice, u, calm, rows.start..middle, part),
        || look_at_rows(lattice, u, calm, middle..rows.end, part),
    );
    lower.and(upper)
}

/// Rows of uncut cells that are looked at.
struct Rows<'a> {
    runs: &'a [Vec<Run>],
    u: &'a FieldVectors,
    /// Squares of stretches that are calm, of each material.
    calm: &'a [f64],
    inverse_cell_size: f64,
}

impl Loop for Rows<'_> {
    type Output = Cells;

    #[inline(always)]
    fn run(self) -> Cells {
        let [u_x, u_y] = self.u;
        let mut cells = Cells::SOUND;
        for run in self.runs.iter().flatten() {
            let lower = run.lower as usize..(run.lower + run.count + 1) as usize;
            let upper = run.upper as usize..(run.upper + run.count + 1) as usize;
            let u = [[&u_x[lower.clone()], &u_x[upper.clone()]], [&u_y[lower], &u_y[upper]]];
            cells = cells.and(look(u, self.calm[run.material as usize], self.inverse_cell_size));
            if !cells.are_in_range {
                break;
            }
        }
        cells
    }
}

/// Looks at a run of cells of which stretches to the root of `calm` are calm; `u`: x, then y, each of the lower and the
/// upper row.
///
/// Within a cell the columns of F are means of opposite edges: F e₁ = (1−b) b₀ + b b₁ with the lower and the upper edge
/// as they are now, over h, and F e₂ = (1−a) a₀ + a a₁ with the left and the right one. So det F lies among the four
/// products b × a of the corners, and the largest stretch, at most ‖F‖, is bounded by the longest edges of both pairs.
/// Its square is at most L where x² − ‖F‖² x + (det F)², of which the squares of both stretches are the roots, is not
/// negative at L, and L is beyond the middle between them.
#[inline(always)]
fn look(u: [[&[f64]; 2]; 2], calm: f64, inverse_cell_size: f64) -> Cells {
    let [[x0, x1], [y0, y1]] = u;
    let count = x0.len() - 1;
    let (x00, x01, y00, y01) = (&x0[..count], &x1[..count], &y0[..count], &y1[..count]);
    let (x10, x11, y10, y11) = (&x0[1..=count], &x1[1..=count], &y0[1..=count], &y1[1..=count]);
    let along = |difference: f64| 1.0 + difference * inverse_cell_size;
    let across = |difference: f64| difference * inverse_cell_size;
    let mut cells = Cells::SOUND;
    for k in 0..count {
        let bottom = [along(x10[k] - x00[k]), across(y10[k] - y00[k])];
        let top = [along(x11[k] - x01[k]), across(y11[k] - y01[k])];
        let left = [across(x01[k] - x00[k]), along(y01[k] - y00[k])];
        let right = [across(x11[k] - x10[k]), along(y11[k] - y10[k])];
        let squared = |edge: [f64; 2]| edge[0] * edge[0] + edge[1] * edge[1];
        let area = |b: [f64; 2], a: [f64; 2]| b[0] * a[1] - b[1] * a[0];
        // Comparisons with what is not a number are false.
        for (b, a) in [(bottom, left), (bottom, right), (top, left), (top, right)] {
            let (area, sum) = (area(b, a), squared(b) + squared(a));
            cells.are_in_range &= area >= SMALLEST_VOLUME_RATIO;
            cells.are_in_range &= sum <= LARGEST_STRETCH * LARGEST_STRETCH;
            cells.are_calm &= (calm - sum) * calm + area * area >= 0.0;
            cells.are_calm &= sum <= 2.0 * calm;
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Truth: `is_in_range`, particle by particle. A cell of which a particle is out of range is never passed; one
        /// that is only turned, stretched a little and moved far away always is. One is calm only where all particles
        /// are.
        #[test]
        fn cells_in_range_have_particles_in_range(
            corners in prop::array::uniform8(-1.2_f64..1.2),
            strain in prop::array::uniform4(-0.2_f64..0.2),
            angle in -4.0_f64..4.0,
            away in -1e3_f64..1e3,
            calm in 1.0_f64..4.0,
        ) {
            let pass = |c: [f64; 8]| {
                look([[&[c[0], c[1]], &[c[2], c[3]]], [&[c[4], c[5]], &[c[6], c[7]]]], calm, 1.0)
            };
            let gradients = [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)].map(|(a, b)| {
                let slope = |u: &[f64]| [
                    (1.0 - b) * (u[1] - u[0]) + b * (u[3] - u[2]),
                    (1.0 - a) * (u[2] - u[0]) + a * (u[3] - u[1]),
                ];
                let [[h11, h12], [h21, h22]] = [slope(&corners[..4]), slope(&corners[4..])];
                Matrix::new(h11, h12, h21, h22)
            });
            prop_assert!(!pass(corners).are_in_range || gradients.iter().all(is_in_range));
            let is_calm = |h: &Matrix| principal_stretches(h)[0].powi(2) <= calm;
            prop_assert!(!pass(corners).are_calm || gradients.iter().all(is_calm));
            let (sine, cosine) = angle.sin_cos();
            let f = Matrix::new(cosine, -sine, sine, cosine)
                * (Matrix::identity() + Matrix::new(strain[0], strain[1], strain[2], strain[3]));
            let h = f - Matrix::identity();
            let moved = [(h.m11, h.m12), (h.m21, h.m22)].map(|(x, y)| [away, away + x, away + y, away + x + y]);
            let moved = pass([moved[0], moved[1]].concat().try_into().unwrap_or([f64::NAN; 8]));
            prop_assert!(moved.are_in_range);
            // Alike everywhere, so that nothing is bounded but what is.
            let squared = principal_stretches(&h)[0].powi(2);
            prop_assert!((squared - calm).abs() < 1e-9 || moved.are_calm == (squared < calm));
        }
    }

    #[test]
    fn what_is_no_number_is_out_of_range() {
        for value in [f64::NAN, f64::INFINITY] {
            let row = [0.0, value, 0.0];
            assert!(!look([[&row, &[0.0; 3]], [&[0.0; 3], &[0.0; 3]]], 2.0, 1.0).are_in_range);
            assert!(!is_in_range(&Matrix::new(0.0, value, 0.0, 0.0)));
        }
    }
}
