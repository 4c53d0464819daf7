//! J and K of a tip over several radii side by side: what they differ by is the error of the measurement.

use super::gauge::{Gauge, area_term, without_overlap};
use crate::StressIntensity;
use crate::crack::cracks::{Cracks, TipId};
use crate::solver::Observed;
use crate::tip::domain::domain_integrals;
use fissure_scene::End;

/// The radii, in cells.
const RADII: [f64; 5] = [2.0, 3.0, 4.0, 5.0, 6.0];
/// The kernel averages around the points of a circle reach beyond it by so much, in cells.
pub(super) const KERNEL_REACH: f64 = 2.0;

/// What is measured at a tip over one radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContourReading {
    /// Index of the crack, as in [`TipRecord`](fissure_scene::TipRecord).
    pub crack: u32,
    /// Which of its ends.
    pub end: End,
    /// The radius at rest, in cells.
    pub cells: f64,
    /// The same [m].
    pub radius: f64,
    /// J of the domain integral over the disc, with inertia [J/m²].
    pub domain: f64,
    /// J over the circle alone [J/m²]. It lacks what moves within; at rest it is the same.
    pub contour: f64,
    /// J over the circle with the inertia of what is within it [J/m²].
    pub contour_with_inertia: f64,
    /// K_I and K_II of the interaction integral over the disc.
    pub modes: StressIntensity,
}

impl Gauge<'_> {
    /// Measures one tip over 2, 3, 4, 5 and 6 cells, as far as nothing that would spoil an integral is within: an
    /// outline, another crack, a bend, other material.
    pub(crate) fn contours(&self, moment: &dyn Observed, cracks: &Cracks, id: TipId) -> Vec<ContourReading> {
        let h = self.scene.cell_size;
        let widest = RADII.into_iter().fold(0.0, f64::max);
        let room = self.free_radii(cracks, id, widest * h)[1];
        let within: Vec<f64> = RADII.into_iter().filter(|&cells| cells * h <= room).collect();
        let Some(&outermost) = within.last() else { return Vec::new() };
        let mut zone = moment.tip_zone(cracks, id, (outermost + KERNEL_REACH) * h);
        zone.center_on_crack(h);
        zone.take_off_mean_velocity();
        let Some(tip) = self.material_at_tip(&zone) else { return Vec::new() };
        let opening = moment.opening(cracks, id, zone.into);
        let read = |&cells: &f64| {
            let radius = cells * h;
            let found = domain_integrals(&zone, self.elastic, tip, h, radius, true);
            let modes = StressIntensity { mode_1: found.mode_1, mode_2: found.mode_2 };
            let contour = self.circle_j(&zone, opening, radius);
            ContourReading {
                crack: id.crack as u32,
                end: id.end,
                cells,
                radius,
                domain: found.j_integral,
                contour,
                contour_with_inertia: contour + area_term(&zone, radius),
                modes: if self.scene.solver.crack_contact { without_overlap(modes, found.closed) } else { modes },
            }
        };
        within.iter().map(read).collect()
    }
}
