//! The background lattice: where nodes are and how they are numbered.

use fissure_scene::{Point, Vector};
use serde::{Deserialize, Serialize};

/// A regular lattice of nodes; node (i, j) lies at `origin` + h (i, j) and has the number j · `columns` + i.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Grid {
    /// Position of node (0, 0) [m].
    pub(crate) origin: Point,
    /// Distance between nodes h [m].
    pub(crate) cell_size: f64,
    /// Nodes along x.
    pub(crate) columns: usize,
    /// Nodes along y.
    pub(crate) rows: usize,
}

impl Grid {
    /// The lattice that has a node at `anchor` and leaves `margin` cells around the box from `low` to `high`.
    pub(crate) fn around(anchor: Point, low: Point, high: Point, cell_size: f64, margin: i64) -> Self {
        // A box edge that lies on a grid line up to rounding counts as on it.
        let slack = 1e-9;
        let first = ((low - anchor) / cell_size).map(|t| (t + slack).floor() as i64 - margin);
        let last = ((high - anchor) / cell_size).map(|t| (t - slack).ceil() as i64 + margin);
        Self {
            origin: anchor + Vector::new(first.x as f64, first.y as f64) * cell_size,
            cell_size,
            columns: (last.x - first.x + 1) as usize,
            rows: (last.y - first.y + 1) as usize,
        }
    }

    /// Number of nodes.
    pub(crate) fn len(&self) -> usize {
        self.columns * self.rows
    }

    /// Position of a node [m].
    pub(crate) fn position(&self, node: usize) -> Point {
        let (i, j) = (node % self.columns, node / self.columns);
        self.origin + Vector::new(i as f64, j as f64) * self.cell_size
    }

    /// Position in units of cells, relative to node (0, 0).
    pub(crate) fn in_cells(&self, point: Point) -> Vector {
        (point - self.origin) / self.cell_size
    }

    /// The cell that holds `point`: lower left node (i, j); may lie outside the lattice.
    pub(crate) fn cell(&self, point: Point) -> (i64, i64) {
        let x = self.in_cells(point);
        (x.x.floor() as i64, x.y.floor() as i64)
    }
}
