//! Cracks that are short for the grid.

use super::Resolver;
use crate::fault::{KeyPath, Warning, short};
use crate::scene::{Crack, Guide, Scene};
use fissure_plane::polyline_length;

/// Cells along a crack, at least: the integrals around a tip reach four cells far, and further back the crack has to be
/// there as well.
const FEWEST_CELLS: f64 = 8.0;

impl Resolver<'_> {
    /// Warns of cracks that the grid hardly sees.
    pub(super) fn short_cracks(&self, scene: &Scene) {
        let drawn = self.origin.cracks.len();
        let cells = |crack: &Crack| polyline_length(&crack.points) / scene.cell_size;
        // A schedule moves a tip whatever is measured at it.
        let measured =
            |live: bool, guide: &Option<Guide>| live && guide.as_ref().is_none_or(|g| g.schedule.points.is_empty());
        let is_measured = |c: &Crack| measured(c.start_live, &c.start_guide) || measured(c.end_live, &c.end_guide);
        // A crack of exactly so many cells is not short for being flattened.
        let is_short = |crack: &&Crack| is_measured(crack) && cells(crack) < 0.999 * FEWEST_CELLS;
        let remedy = |cells: f64| {
            let spacing = scene.particle_spacing * cells / FEWEST_CELLS;
            format!("make it longer, or set `grid.particle_spacing` to {} m or less", short(spacing))
        };
        for (i, crack) in scene.cracks.iter().enumerate().take(drawn).filter(|(_, crack)| is_short(crack)) {
            let (cells, name) = (cells(crack), &crack.name);
            let message =
                format!("crack `{name}` is {cells:.1} cells long: below {FEWEST_CELLS} its tips are measured badly");
            self.warn(Warning::new(KeyPath::item("crack", self.origin.cracks[i]).then("line"), message, remedy(cells)));
        }
        let flaws = &scene.cracks[drawn..];
        let Some(shortest) = flaws.iter().filter(is_short).map(cells).min_by(f64::total_cmp) else { return };
        let message = format!(
            "{} of {} flaws are shorter than {FEWEST_CELLS} cells, the shortest has {shortest:.1}: their tips are measured badly",
            flaws.iter().filter(is_short).count(),
            flaws.len()
        );
        self.warn(Warning::new(KeyPath::top("flaws"), message, remedy(shortest)));
    }
}
