//! Laying the nodes of a grid: where stencils reach, and how the nodes there are numbered.

use super::spans::Span;
use super::{BAND, Grid, LARGEST_GAP, band_of};

/// Neighbouring cells that particles are in, while a grid is laid.
#[derive(Debug, Clone, Copy)]
struct Patch {
    /// Band of the cells.
    band: i32,
    /// Lowest and highest band that stencils from there reach.
    reached: [i32; 2],
    /// First and last column of the cells.
    columns: [i32; 2],
}

impl Grid {
    /// Takes over the nodes of `before`. They are of use when both have the same places; that is returned.
    pub(crate) fn take_nodes(&mut self, before: &mut Self) -> bool {
        self.bands = std::mem::take(&mut before.bands);
        self.first_node = std::mem::take(&mut before.first_node);
        self.origin == before.origin && self.cell_size == before.cell_size
    }

    /// Makes the nodes of all stencils of `width` nodes per axis whose lowest nodes are `lowest`, with `room` more
    /// cells around each.
    pub(crate) fn lay(&mut self, lowest: impl Iterator<Item = [i32; 2]>, width: usize, room: i32) {
        let reach = width as i32 - 1 + room;
        let mut patches: Vec<Patch> = Vec::new();
        for [i, j] in lowest {
            let (band, reached) = (band_of(j), [band_of(j - room), band_of(j + reach)]);
            match patches.last_mut() {
                // Particles side by side follow each other.
                Some(p) if p.band == band && i >= p.columns[0] - LARGEST_GAP && i <= p.columns[1] + LARGEST_GAP => {
                    p.columns = [p.columns[0].min(i), p.columns[1].max(i)];
                    p.reached = [p.reached[0].min(reached[0]), p.reached[1].max(reached[1])];
                }
                _ => patches.push(Patch { band, reached, columns: [i, i] }),
            }
        }
        let columns = |p: &Patch| (p.columns[0] - room, p.columns[1] + reach + 1);
        let mut runs: Vec<(i32, (i32, i32))> =
            patches.iter().flat_map(|p| (p.reached[0]..=p.reached[1]).map(move |band| (band, columns(p)))).collect();
        runs.sort_unstable();
        runs.dedup_by(|next, run| {
            let joins = next.0 == run.0 && next.1.0 <= run.1.1 + LARGEST_GAP;
            if joins {
                run.1.1 = run.1.1.max(next.1.1);
            }
            joins
        });
        self.number(&runs);
    }

    /// Numbers the nodes of (band, (first column, column after the last)), which are sorted.
    fn number(&mut self, runs: &[(i32, (i32, i32))]) {
        self.bands.clear();
        self.first_node.clear();
        let mut node = 0;
        for of_band in runs.chunk_by(|a, b| a.0 == b.0) {
            self.first_node.push(node);
            let mut number = 0;
            for &(band, (first, end)) in of_band {
                self.bands.push(band, Span { first, end, number });
                number += (end - first) as u32;
            }
            node += number * BAND as u32;
        }
        self.first_node.push(node);
    }
}
