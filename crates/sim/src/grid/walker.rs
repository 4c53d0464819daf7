//! Finding the nodes of stencils.

use super::kernel::{MAX_WIDTH, Stencil};
use super::{BAND, Grid, band_of, row_in_band};
use fissure_plane::Point;

/// Finds the nodes of stencils, at next to no cost where each is close to the one before.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Walker<'a> {
    grid: &'a Grid,
    /// The spans that were found last in an even and in an odd band.
    found: [Found; 2],
}

/// A span with what it takes to number its nodes.
#[derive(Debug, Clone, Copy)]
struct Found {
    band: i32,
    first: i32,
    end: i32,
    /// Node in the first column of the lowest row of the band.
    node: usize,
    /// Nodes in a row of the band.
    width: usize,
}

impl<'a> Walker<'a> {
    /// A walker that has not found anything yet.
    pub(crate) fn new(grid: &'a Grid) -> Self {
        Self { grid, found: [Found { band: i32::MIN, first: 0, end: 0, node: 0, width: 0 }; 2] }
    }

    /// First node of each row of a stencil of `width` nodes per axis whose lowest node is at `lowest`; none unless all
    /// of its nodes exist.
    #[inline(always)]
    pub(crate) fn rows(&mut self, lowest: [i32; 2], width: usize) -> Option<[usize; MAX_WIDTH]> {
        let [i, j] = lowest;
        let (band, row) = (band_of(j), row_in_band(j));
        let lower = self.span(band, i, width)?;
        let (at, step) = (lower.node + (i - lower.first) as usize + row * lower.width, lower.width);
        let mut rows = [0; MAX_WIDTH];
        for b in 0..width {
            rows[b] = at + b * step;
        }
        if row + width > BAND {
            let upper = self.span(band + 1, i, width)?;
            let at = upper.node + (i - upper.first) as usize;
            for b in BAND - row..width {
                rows[b] = at + (row + b - BAND) * upper.width;
            }
        }
        Some(rows)
    }

    /// The lowest node of such a stencil; none unless all of its nodes exist.
    #[inline(always)]
    pub(crate) fn lowest_node(&mut self, lowest: [i32; 2], width: usize) -> Option<usize> {
        let [i, j] = lowest;
        let (band, row) = (band_of(j), row_in_band(j));
        if row + width > BAND {
            self.span(band + 1, i, width)?;
        }
        let lower = self.span(band, i, width)?;
        Some(lower.node + (i - lower.first) as usize + row * lower.width)
    }

    /// The span of `band` that holds `width` columns from `column` on.
    #[inline(always)]
    fn span(&mut self, band: i32, column: i32, width: usize) -> Option<&Found> {
        let last = &mut self.found[(band & 1) as usize];
        if !last.holds(band, column, width) {
            *last = self.grid.find(band, column).filter(|found| found.holds(band, column, width))?;
        }
        Some(last)
    }
}

impl Found {
    #[inline(always)]
    fn holds(&self, band: i32, column: i32, width: usize) -> bool {
        self.band == band && self.first <= column && column + width as i32 <= self.end
    }
}

impl Grid {
    /// The nodes of a stencil.
    pub(crate) fn stencil(&self, stencil: &Stencil) -> StencilNodes<'_> {
        let rows = Walker::new(self).rows(stencil.first, stencil.width);
        StencilNodes { grid: self, lowest: stencil.first, width: stencil.width, rows }
    }

    #[cold]
    fn find(&self, band: i32, column: i32) -> Option<Found> {
        let index = self.bands.index_of(band)?;
        let span = self.bands.span_with(index, column)?;
        Some(Found {
            band,
            first: span.first,
            end: span.end,
            node: self.first_node[index] as usize + span.number as usize,
            width: self.width(index),
        })
    }
}

/// The nodes of a stencil, some of which may not exist; (a, b) counts them along x and y.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StencilNodes<'a> {
    grid: &'a Grid,
    lowest: [i32; 2],
    width: usize,
    /// First node of each row, where all nodes exist.
    rows: Option<[usize; MAX_WIDTH]>,
}

impl StencilNodes<'_> {
    /// The nodes of the stencil that differ from (a, b) by one, in a first.
    pub(crate) fn near(&self, a: usize, b: usize) -> impl Iterator<Item = usize> {
        let beside = |k: usize| [k.wrapping_sub(1), k + 1].into_iter().filter(|&k| k < self.width);
        let places = beside(a).map(move |a| (a, b)).chain(beside(b).map(move |b| (a, b)));
        places.chain(beside(a).flat_map(move |a| beside(b).map(move |b| (a, b)))).filter_map(|(a, b)| self.at(a, b))
    }

    /// Where node (a, b) of the stencil is, be it there or not [m].
    pub(crate) fn place(&self, a: usize, b: usize) -> Point {
        self.grid.place([self.lowest[0].wrapping_add(a as i32), self.lowest[1].wrapping_add(b as i32)])
    }

    /// Node (a, b) of the stencil.
    pub(crate) fn at(&self, a: usize, b: usize) -> Option<usize> {
        match self.rows {
            Some(rows) => Some(rows[b] + a),
            None => self.grid.node([self.lowest[0].checked_add(a as i32)?, self.lowest[1].checked_add(b as i32)?]),
        }
    }
}
