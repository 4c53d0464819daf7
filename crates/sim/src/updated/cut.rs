//! Dividing the stencils of particles near cracks.

use super::lattice::Lattice;
use super::points::MaterialPoint;
use super::setup::PARALLEL_PARTICLES;
use crate::crack::division::{CrossedSet, Division};
use crate::grid::entries::Entry;
use crate::grid::spans::{Span, SpanRows};
use crate::threads::prelude::*;
use fissure_scene::{Point, Vector};

/// One pair of a divided stencil before its field has a number.
pub(super) struct Raw {
    node: u32,
    crossed: CrossedSet,
    weight: f64,
    gradient: Vector,
}

impl Lattice {
    /// Finds the particles whose stencils the cracks of `division` divide, and divides them.
    pub(super) fn divide(&mut self, points: &[MaterialPoint], division: Division) {
        self.division = division;
        let near = NearCells::of(&self.division, self.grid.cell_size);
        let candidates = points.iter().enumerate().filter(|(_, point)| near.holds(point.position));
        let particles: Vec<usize> =
            candidates.filter(|(_, p)| self.may_be_divided(p.position)).map(|(p, _)| p).collect();
        let divided = |&p: &usize| self.divided(points[p].position);
        let raws: Vec<Vec<Raw>> = if particles.len() < PARALLEL_PARTICLES / 32 {
            particles.iter().map(divided).collect()
        } else {
            particles.par_iter().map(divided).collect()
        };
        self.stencils.clear(points.len());
        for (p, raws) in particles.into_iter().zip(raws) {
            let entries = raws.into_iter().map(|raw| {
                let field = self.fields.find_or_add(raw.node as usize, None, &raw.crossed) as u32;
                Entry { field, weight: raw.weight, gradient: raw.gradient }
            });
            self.stencils.push(p, entries);
        }
    }

    /// Whether a crack may divide the stencil of a particle at `place`.
    fn may_be_divided(&self, place: Point) -> bool {
        let stencil = self.stencil(place);
        let low = self.grid.place(stencil.first);
        let high = self.grid.place(stencil.first.map(|first| first + stencil.width as i32 - 1));
        self.division.may_divide(place, low, high)
    }

    /// The divided stencil of a particle at `place`.
    fn divided(&self, place: Point) -> Vec<Raw> {
        let stencil = self.stencil(place);
        let nodes = self.grid.stencil(&stencil);
        let mut raws = Vec::with_capacity(stencil.width * stencil.width + 4);
        for b in 0..stencil.width {
            for a in 0..stencil.width {
                let (w, g) = (stencil.weight(a, b), stencil.weight_gradient(a, b));
                let Some(node) = nodes.at(a, b) else { continue };
                for share in self.division.pair(place, nodes.place(a, b)) {
                    raws.push(Raw {
                        node: node as u32,
                        weight: w * share.fraction,
                        gradient: g * share.fraction + share.gradient * w,
                        crossed: share.crossed,
                    });
                }
            }
        }
        raws
    }
}

/// The cells near cracks, for a question that every particle asks.
struct NearCells {
    spans: SpanRows,
    inverse_cell_size: f64,
}

impl NearCells {
    fn of(division: &Division, cell_size: f64) -> Self {
        let mut cells: Vec<(i32, i32)> = division.near_cells().map(|(i, j)| (j as i32, i as i32)).collect();
        cells.sort_unstable();
        let mut spans = SpanRows::default();
        for run in cells.chunk_by(|a, b| a.0 == b.0 && a.1 + 1 == b.1) {
            let (row, first) = run[0];
            spans.push(row, Span { first, end: first + run.len() as i32, number: 0 });
        }
        Self { spans, inverse_cell_size: 1.0 / cell_size }
    }

    fn holds(&self, point: Point) -> bool {
        let x = point.coords * self.inverse_cell_size;
        self.spans.number(x.x.floor() as i32, x.y.floor() as i32).is_some()
    }
}
