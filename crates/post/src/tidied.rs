//! Polygons without what is shorter or narrower than programs merge vertices by.

use crate::boolean::Edge;
use crate::error::PostError;
use crate::lattice::Enclosed;
use crate::narrows::part_narrows;
use crate::needles::blunt_needles;
use crate::pinch::part_pinches;
use crate::short_edges::{Growth, without_short_edges};
use crate::slivers::{drop_narrow_parts, fill_narrow_holes, without_slivers};
use crate::slot::Slot;
use crate::solids::Solids;
use crate::source::{Carried, SourceEdge};
use fissure_scene::{Region, Walls};

/// What an edge may become shorter by as its ends go to the grid, in grid steps.
const ROUNDING: f64 = 3.0;
/// Where needles and narrow places have gone there may be others beside them; so many times at most.
const ROUNDS: usize = 8;

impl Solids<'_> {
    /// Parts contours that touch or nearly do, and takes short edges out of them.
    pub(crate) fn tidy(&self, of: &mut Enclosed, growth: Growth) -> Result<(), PostError> {
        self.tidy_once(of, growth)?;
        if self.options.walls != Walls::All {
            for _ in 0..ROUNDS {
                if !part_narrows(&mut of.shapes, of.least, growth, &mut of.sources) {
                    break;
                }
                self.tidy_once(of, growth)?;
            }
        }
        Ok(())
    }

    fn tidy_once(&self, of: &mut Enclosed, growth: Growth) -> Result<(), PostError> {
        let body = &self.scene.bodies[of.body as usize];
        let parted =
            part_pinches(std::mem::take(&mut of.shapes), &mut of.sources, 0.25 * of.least).map_err(|place| {
                let place = of.grid.place(place);
                PostError::Pinch { frame: self.frame.number, body: body.name.clone(), x: place.x, y: place.y }
            })?;
        of.shapes = without_slivers(parted);
        let sources = &mut of.sources;
        let is_drawn = |edge: &Edge, source: &SourceEdge| is_drawn(&body.region, edge, source);
        if self.options.walls == Walls::All {
            without_short_edges(&mut of.shapes, of.least, growth, sources, is_drawn);
            return Ok(());
        }
        let wide = if of.least > 0.0 { of.least + ROUNDING } else { 0.0 };
        for _ in 0..ROUNDS {
            let is_inside = |edge: &Edge| sources[edge.source.0 as usize].slot == Slot::Inside;
            fill_narrow_holes(&mut of.shapes, of.least, is_inside);
            drop_narrow_parts(&mut of.shapes, of.least, is_inside);
            without_short_edges(&mut of.shapes, of.least, growth, sources, is_drawn);
            if !blunt_needles(&mut of.shapes, wide, growth, sources) {
                break;
            }
        }
        Ok(())
    }
}

/// Whether an edge is one that was drawn, from corner to corner.
fn is_drawn(region: &Region, edge: &Edge, source: &SourceEdge) -> bool {
    let is_corner = |carried: &Carried| region.rings().flatten().any(|corner| *corner == carried.rest);
    let is_whole = (edge.a, edge.b) == (source.a, source.b);
    is_whole && source.slot == Slot::Outside && source.carried.iter().all(is_corner)
}
