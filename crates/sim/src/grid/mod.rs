//! The background lattice: which nodes there are, where they are and how they are numbered.
//!
//! Only nodes near material exist, so that memory goes with the material and not with the box around it. Rows of nodes
//! come in bands of [`BAND`]. A band has spans of columns, which all its rows share; nodes are numbered band by band,
//! row by row, columns rising:
//!
//! ```text
//!   row 5        14 15 16 17      band 1: columns 2 to 5
//!   row 4        10 11 12 13
//!   row 3    7 8          9       band 0: columns 0 to 1 and 5; here bands of two rows instead of four, from row 2 on
//!   row 2    4 5          6
//! ```
//!
//! A run of nodes side by side is a run of numbers, and a band with the one above it is one piece of memory.

pub(crate) mod coverage;
pub(crate) mod entries;
pub(crate) mod fields;
pub(crate) mod kernel;
mod laying;
pub(crate) mod owners;
pub(crate) mod scan;
pub(crate) mod spans;
pub(crate) mod walker;

use crate::grid::spans::{Span, SpanRows};
use fissure_scene::{Point, Vector};
use std::ops::Range;

/// Rows of nodes in a band: at least one less than the widest kernel reaches, so that no stencil lies in more than two.
pub(crate) const BAND: usize = 4;

/// Spans with no more columns than this between them become one: a few nodes without material cost less than one more
/// span.
const LARGEST_GAP: i32 = 8;

/// More columns or rows than this are not counted.
const MOST_CELLS: f64 = (1 << 30) as f64;

/// The nodes of a regular lattice that are near material; node (i, j) lies at `origin` + h (i, j).
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Grid {
    /// Position of node (0, 0) [m].
    pub(crate) origin: Point,
    /// Distance between nodes h [m].
    pub(crate) cell_size: f64,
    /// Columns and rows of the box around everything.
    extent: [i64; 2],
    /// Spans of each band, numbered from the first node of a row on.
    bands: SpanRows,
    /// First node of each band; one more at the end.
    first_node: Vec<u32>,
}

/// A row of nodes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct GridRow {
    /// Its place on the lattice.
    pub(crate) row: i32,
    /// Its nodes.
    pub(crate) nodes: Range<usize>,
}

fn band_of(row: i32) -> i32 {
    row.div_euclid(BAND as i32)
}

fn row_in_band(row: i32) -> usize {
    row.rem_euclid(BAND as i32) as usize
}

impl Grid {
    /// A lattice that has a node at `anchor` and node (0, 0) `margin` cells below and to the left of the box from `low`
    /// to `high`; it has no node yet. None when the box is too large to count its cells.
    pub(crate) fn around(anchor: Point, low: Point, high: Point, cell_size: f64, margin: i64) -> Option<Self> {
        // A box edge that lies on a grid line up to rounding counts as on it.
        let slack = 1e-9;
        let (from, to) = ((low - anchor) / cell_size, (high - anchor) / cell_size);
        if !from.iter().chain(&to).all(|cells| cells.abs() < MOST_CELLS) {
            return None;
        }
        let first = from.map(|t| (t + slack).floor() as i64 - margin);
        let last = to.map(|t| (t - slack).ceil() as i64 + margin);
        Some(Self {
            origin: anchor + Vector::new(first.x as f64, first.y as f64) * cell_size,
            cell_size,
            extent: [last.x - first.x + 1, last.y - first.y + 1],
            bands: SpanRows::default(),
            first_node: Vec::new(),
        })
    }

    /// Number of nodes.
    pub(crate) fn len(&self) -> usize {
        self.first_node.last().map_or(0, |&node| node as usize)
    }

    /// Number of spans of all bands.
    #[cfg(test)]
    fn span_count(&self) -> usize {
        self.bands.span_count()
    }

    /// The number of a node when all nodes of the box are counted, row by row.
    pub(crate) fn number_in_box(&self, [i, j]: [i32; 2]) -> i64 {
        i64::from(j).wrapping_mul(self.extent[0]).wrapping_add(i64::from(i))
    }

    /// Number of nodes of the box.
    pub(crate) fn nodes_of_box(&self) -> i64 {
        self.extent[0].wrapping_mul(self.extent[1])
    }

    /// Position of the place (i, j), be there a node or not [m].
    pub(crate) fn place(&self, [i, j]: [i32; 2]) -> Point {
        self.origin + Vector::new(f64::from(i), f64::from(j)) * self.cell_size
    }

    /// Position of a node [m].
    pub(crate) fn position(&self, node: usize) -> Point {
        self.place(self.place_of(node))
    }

    /// Position in units of cells, relative to node (0, 0).
    pub(crate) fn in_cells(&self, point: Point) -> Vector {
        (point - self.origin) / self.cell_size
    }

    /// The cell that holds `point`: lower left node (i, j); its nodes need not exist.
    pub(crate) fn cell(&self, point: Point) -> [i32; 2] {
        let x = self.in_cells(point);
        [x.x.floor() as i32, x.y.floor() as i32]
    }

    /// The node at (i, j).
    pub(crate) fn node(&self, [i, j]: [i32; 2]) -> Option<usize> {
        let band = self.bands.index_of(band_of(j))?;
        let span = self.bands.span_with(band, i)?;
        Some(self.band_nodes(band, row_in_band(j)).start + span.number as usize + (i - span.first) as usize)
    }

    /// Where a node is on the lattice: (i, j).
    pub(crate) fn place_of(&self, node: usize) -> [i32; 2] {
        let band = self.first_node.partition_point(|&first| first as usize <= node).saturating_sub(1);
        let width = self.width(band);
        let within = node - self.first_node[band] as usize;
        let (row, number) = (within / width, within % width);
        let spans = self.bands.spans_of(band);
        let span = spans[spans.partition_point(|span| span.number as usize <= number).saturating_sub(1)];
        let i = span.first + (number - span.number as usize) as i32;
        [i, self.bands.row(band) * BAND as i32 + row as i32]
    }

    /// All nodes, rising, with their places (i, j).
    pub(crate) fn nodes(&self) -> impl Iterator<Item = (usize, [i32; 2])> {
        let places = (0..self.rows()).flat_map(move |row| {
            let j = self.row(row).row;
            self.spans_of_row(row).iter().flat_map(move |span| (span.first..span.end).map(move |i| [i, j]))
        });
        places.enumerate()
    }

    /// The nodes of the box from `low` to `high` [m], and maybe some beside it, rising, with their places (i, j).
    pub(crate) fn nodes_around(&self, low: Point, high: Point) -> impl Iterator<Item = (usize, [i32; 2])> {
        let ([left, bottom], [right, top]) = (self.cell(low), self.cell(high));
        let first = self.bands.index_from(band_of(bottom));
        let bands =
            (first..self.bands.len()).take_while(move |&band| self.bands.row(band) <= band_of(top.saturating_add(1)));
        let rows = bands.flat_map(|band| band * BAND..(band + 1) * BAND);
        rows.flat_map(move |row| {
            let GridRow { row: j, nodes } = self.row(row);
            self.spans_of_row(row).iter().flat_map(move |span| {
                let start = nodes.start + span.number as usize;
                let columns = span.first.max(left)..span.end.min(right.saturating_add(2));
                columns.map(move |i| (start + (i - span.first) as usize, [i, j]))
            })
        })
    }

    /// Number of rows that have nodes.
    pub(crate) fn rows(&self) -> usize {
        self.bands.len() * BAND
    }

    /// The row with the given index among those that have nodes, from below.
    pub(crate) fn row(&self, index: usize) -> GridRow {
        let (band, row) = (index / BAND, index % BAND);
        GridRow { row: self.bands.row(band) * BAND as i32 + row as i32, nodes: self.band_nodes(band, row) }
    }

    /// Where the row `row` of the lattice is among those that have nodes.
    pub(crate) fn row_index(&self, row: i32) -> Option<usize> {
        Some(self.bands.index_of(band_of(row))? * BAND + row_in_band(row))
    }

    /// Spans of a row given by its index; their numbers count from the first node of the row on.
    pub(crate) fn spans_of_row(&self, index: usize) -> &[Span] {
        self.bands.spans_of(index / BAND)
    }

    /// Number of bands.
    pub(crate) fn bands(&self) -> usize {
        self.bands.len()
    }

    /// Place of a band on the lattice, in bands.
    pub(crate) fn band(&self, index: usize) -> i32 {
        self.bands.row(index)
    }

    /// Nodes of a band and of the one above it, where there is one: all that stencils that begin in the band reach.
    pub(crate) fn nodes_reached_from(&self, band: usize) -> Range<usize> {
        let has_next = band + 1 < self.bands.len() && self.bands.row(band + 1) == self.bands.row(band) + 1;
        let end = if has_next { band + 2 } else { band + 1 };
        self.first_node[band] as usize..self.first_node[end] as usize
    }

    /// The nodes of a band.
    pub(crate) fn nodes_of_band(&self, band: usize) -> Range<usize> {
        self.first_node[band] as usize..self.first_node[band + 1] as usize
    }

    /// Nodes in a row of a band.
    fn width(&self, band: usize) -> usize {
        (self.first_node[band + 1] - self.first_node[band]) as usize / BAND
    }

    fn band_nodes(&self, band: usize, row: usize) -> Range<usize> {
        let width = self.width(band);
        let start = self.first_node[band] as usize + row * width;
        start..start + width
    }
}

/// Cuts `values` at `ranges`, which rise and do not overlap.
pub(crate) fn pieces<T>(
    values: &mut [T],
    ranges: impl Iterator<Item = Range<usize>>,
) -> impl Iterator<Item = &mut [T]> {
    let (mut rest, mut at) = (values, 0);
    ranges.map(move |range| {
        let (_, tail) = std::mem::take(&mut rest).split_at_mut(range.start - at);
        let (piece, tail) = tail.split_at_mut(range.end - range.start);
        (rest, at) = (tail, range.end);
        piece
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::walker::Walker;
    use super::*;
    use proptest::prelude::*;
    use std::collections::{BTreeMap, BTreeSet};

    fn grid() -> Grid {
        Grid::around(Point::new(-1.0, 2.0), Point::origin(), Point::new(8.0, 4.0), 0.5, 2).unwrap()
    }

    /// Places of a square of `side` cells that begins at (i, j).
    fn square(i: i32, j: i32, side: i32) -> impl Iterator<Item = [i32; 2]> {
        (0..side * side).map(move |k| [i + k % side, j + k / side])
    }

    /// Truth: the construction. What lies far away adds what it is alone, whatever lies between.
    #[test]
    fn nodes_and_spans_go_with_the_material() {
        let mut alone = grid();
        alone.lay(square(0, 0, 40), 4, 1);
        assert!(alone.len() < 50 * 50 && alone.span_count() < 15, "{} {}", alone.len(), alone.span_count());
        for away in [[1000, 0], [0, 1000], [1_000_000, 40], [40_000_000, 100_000_000]] {
            let mut both = grid();
            both.lay(square(0, 0, 40).chain(square(away[0], away[1], 40)), 4, 1);
            assert_eq!((both.len(), both.span_count()), (2 * alone.len(), 2 * alone.span_count()), "{away:?}");
        }
        // A bar along the diagonal, three cells thick: stencils that begin in a band reach over 11 columns, those of
        // the bands above and below by four more.
        let mut bar = grid();
        bar.lay((0..100_000).flat_map(|i| (0..3).map(move |k| [i + k, i])), 4, 1);
        assert!(bar.len() < 100_000 * 20, "{}", bar.len());
    }

    #[test]
    fn a_box_too_wide_to_count_is_refused() {
        let around = |high: f64| Grid::around(Point::origin(), Point::origin(), Point::new(high, 1.0), 1e-3, 1);
        assert!(around(1e6).is_some());
        for high in [2e6, 1e300, f64::INFINITY, f64::NAN] {
            assert!(around(high).is_none());
        }
    }

    proptest! {
        /// Truth: a set of all nodes that stencils reach, and their dense numbering, row by row.
        #[test]
        fn a_grid_has_the_nodes_that_stencils_reach(
            lowest in prop::collection::vec([-9_i32..30, -9_i32..30], 1..40),
            width in 2_usize..5,
            room in 0_i32..2,
        ) {
            let mut grid = grid();
            grid.lay(lowest.iter().copied(), width, room);
            let reach = width as i32 + room;
            let stencil = |&[i, j]: &[i32; 2]| {
                (j - room..j + reach).flat_map(move |row| (i - room..i + reach).map(move |column| [column, row]))
            };
            let nodes: BTreeMap<[i32; 2], usize> =
                grid.nodes().map(|(node, [i, j])| ([j, i], node)).collect();
            prop_assert_eq!(nodes.len(), grid.len());
            // Rows rise, columns within them rise.
            prop_assert!(nodes.values().copied().eq(0..grid.len()));
            for place in lowest.iter().flat_map(stencil) {
                prop_assert!(grid.node(place).is_some());
            }
            for j in -20..50 {
                for i in -20..50 {
                    prop_assert_eq!(grid.node([i, j]), nodes.get(&[j, i]).copied());
                }
            }
            for (&[j, i], &node) in &nodes {
                prop_assert_eq!(grid.place_of(node), [i, j]);
                let row = grid.row(grid.row_index(j).unwrap());
                prop_assert!(row.row == j && row.nodes.contains(&node));
            }
            // Walks agree with single questions, in any order and where nodes are missing.
            let mut walker = Walker::new(&grid);
            for j in -14..40 {
                for i in -14..40 {
                    let firsts = (0..width as i32).map(|b| grid.node([i, j + b])).collect::<Option<Vec<_>>>();
                    let lasts = (0..width as i32).all(|b| grid.node([i + width as i32 - 1, j + b]).is_some());
                    let found = walker.rows([i, j], width).map(|rows| rows[..width].to_vec());
                    prop_assert_eq!(&found, &firsts.filter(|_| lasts));
                    let lowest = walker.lowest_node([i, j], width);
                    prop_assert_eq!(lowest, found.map(|rows| rows[0]));
                }
            }
        }

        /// Truth: the test of every node.
        #[test]
        fn nodes_around_a_box_are_all_nodes_in_it(
            lowest in prop::collection::vec([-9_i32..30, -9_i32..30], 1..20),
            low in [-12.0..16.0_f64, -12.0..16.0_f64],
            size in [0.0..9.0_f64, 0.0..9.0_f64],
            snaps in any::<bool>(),
        ) {
            let mut grid = grid();
            grid.lay(lowest.into_iter(), 3, 0);
            // Edges on grid lines, too.
            let snap = |x: f64| if snaps { (2.0 * x).round() / 2.0 } else { x };
            let low = Point::new(snap(low[0]), snap(low[1]));
            let high = low + Vector::new(snap(size[0]), snap(size[1]));
            let inside = |&(_, place): &(usize, [i32; 2])| grid.place(place) >= low && grid.place(place) <= high;
            let found: BTreeSet<_> = grid.nodes_around(low, high).filter(inside).collect();
            prop_assert_eq!(found, grid.nodes().filter(inside).collect::<BTreeSet<_>>());
        }

        /// Truth: the pieces lie where their ranges say.
        #[test]
        fn pieces_are_cut_where_asked(lengths in prop::collection::vec((0_usize..4, 0_usize..4), 0..12)) {
            let mut ranges = Vec::new();
            let mut at = 0;
            for (gap, length) in lengths {
                ranges.push(at + gap..at + gap + length);
                at += gap + length;
            }
            let mut values: Vec<usize> = (0..at + 2).collect();
            let found: Vec<Vec<usize>> = pieces(&mut values, ranges.iter().cloned()).map(|p| p.to_vec()).collect();
            prop_assert_eq!(found, ranges.into_iter().map(|r| r.collect::<Vec<_>>()).collect::<Vec<_>>());
        }
    }
}
