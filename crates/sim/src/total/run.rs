//! Cells that are whole and side by side.

use serde::{Deserialize, Serialize};
use std::ops::Range;

/// A run of uncut cells of one material in one row of cells. Its nodes, one more than cells, are side by side in the
/// row below and in the row above.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Run {
    /// Lower left node of its first cell.
    pub(super) lower: u32,
    /// Upper left node of its first cell.
    pub(super) upper: u32,
    /// Number of cells.
    pub(super) count: u32,
    /// Material.
    pub(super) material: u32,
}

impl Run {
    /// Whether its nodes are among those of two rows.
    pub(super) fn lies_in(&self, lower: &Range<usize>, upper: &Range<usize>) -> bool {
        let within = |first: u32, nodes: &Range<usize>| {
            let end = first as usize + self.count as usize + 1;
            nodes.start <= first as usize && end <= nodes.end
        };
        within(self.lower, lower) && within(self.upper, upper)
    }

    /// Whether its cells have the lower left node `node` among them.
    pub(super) fn holds(&self, node: usize) -> bool {
        (self.lower as usize..(self.lower + self.count) as usize).contains(&node)
    }

    /// What is left to both sides of the cell with the lower left node `node`, which it holds.
    pub(super) fn without(&self, node: usize) -> impl Iterator<Item = Self> + use<> {
        let before = node as u32 - self.lower;
        let after = before + 1;
        let first = Self { count: before, ..*self };
        let second = Self { lower: self.lower + after, upper: self.upper + after, count: self.count - after, ..*self };
        [first, second].into_iter().filter(|run| run.count > 0)
    }
}
