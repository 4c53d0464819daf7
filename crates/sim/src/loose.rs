//! Particles that the rest of their body does not hold.
//!
//! At a corner that points between grid lines a particle may lie alone in its cell. Its one state of strain holds three
//! of the degrees of freedom of the cell's nodes. Those that no other cell shares have two each, so that from two on
//! the corner can move without any strain: it flaps, and a load on it does work without end.

use std::ops::Range;

/// A run of particles: row, columns.
pub(crate) type Run = (i32, Range<i32>);

/// Takes loose particles off the ends of the `runs` of one body, which rise row by row; two by two particles make a
/// cell, counted from column and row zero. A body keeps its last ones.
pub(crate) fn drop_loose(runs: &mut Vec<Run>) {
    let loose: Vec<[bool; 2]> = runs
        .iter()
        // Only the ends of a run can be without a neighbour in their row.
        .map(|(row, columns)| [columns.start, columns.end - 1].map(|column| is_loose(runs, [column, *row])))
        .collect();
    let mut held = runs.clone();
    for ((_, columns), [first, last]) in held.iter_mut().zip(loose) {
        columns.start += i32::from(first);
        columns.end -= i32::from(last && columns.start < columns.end);
    }
    held.retain(|(_, columns)| columns.start < columns.end);
    if !held.is_empty() {
        *runs = held;
    }
}

/// Whether a particle is alone in its cell, and the cell shares fewer than three nodes with others.
fn is_loose(runs: &[Run], [column, row]: [i32; 2]) -> bool {
    let is_taken = |i: i32, j: i32| {
        let from = runs.partition_point(|run| run.0 < j);
        runs[from..].iter().take_while(|run| run.0 == j).any(|run| run.1.contains(&i))
    };
    if is_taken(column ^ 1, row) || is_taken(column, row ^ 1) || is_taken(column ^ 1, row ^ 1) {
        return false;
    }
    let cell = [column >> 1, row >> 1];
    let is_filled = |dx: i32, dy: i32| {
        let (i, j) = (2 * (cell[0] + dx), 2 * (cell[1] + dy));
        [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].into_iter().any(|(i, j)| is_taken(i, j))
    };
    let corners = [(-1, -1), (1, -1), (-1, 1), (1, 1)];
    let shared = corners.into_iter().filter(|&(x, y)| is_filled(x, 0) || is_filled(0, y) || is_filled(x, y));
    shared.count() < 3
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: counted by hand.
    #[test]
    fn corners_that_nothing_holds_are_dropped() {
        // Cells of two by two: a particle on top of a full cell, one beside it, one across its corner.
        let mut runs = vec![(0, 0..3), (1, 0..2), (2, 0..1)];
        drop_loose(&mut runs);
        assert_eq!(runs, [(0, 0..2), (1, 0..2)]);
        let mut runs = vec![(0, 0..2), (1, 0..2), (2, 2..3)];
        drop_loose(&mut runs);
        assert_eq!(runs, [(0, 0..2), (1, 0..2)]);
        // In the inner corner of an L three nodes are shared, and two particles in a cell hold each other.
        let steps = vec![(0, 0..4), (1, 0..4), (2, 0..3), (3, 0..2), (4, 0..2)];
        let mut runs = steps.clone();
        drop_loose(&mut runs);
        assert_eq!(runs, steps);
        // The only particle of a body stays.
        let mut runs = vec![(0, 0..1)];
        drop_loose(&mut runs);
        assert_eq!(runs, [(0, 0..1)]);
    }
}
