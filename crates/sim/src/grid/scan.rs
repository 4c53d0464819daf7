//! Which places of a lattice lie inside a region, found row by row along its rings: work goes with the length of the
//! rings and with what is found, not with the box around them.

use fissure_plane::{Point, Region, Vector, orientation};
use std::ops::Range;

/// Places at `anchor` + s (i + ½, j + ½).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Places {
    /// Corner from which places are counted [m].
    pub(crate) anchor: Point,
    /// Distance between places s [m].
    pub(crate) spacing: f64,
}

impl Places {
    /// Where the place (i, j) is [m].
    pub(crate) fn at(&self, i: i32, j: i32) -> Point {
        self.anchor + Vector::new(f64::from(i) + 0.5, f64::from(j) + 0.5) * self.spacing
    }

    /// Calls `visit` with a row and a run of columns for all places inside `region`: those that [`Region::contains`].
    /// Rows rise, and columns within them.
    pub(crate) fn for_each_run_inside(&self, region: &Region, mut visit: impl FnMut(i32, Range<i32>)) {
        let (low, high) = region.bounds();
        let box_low = ((low - self.anchor) / self.spacing).map(|t| t.floor() as i32);
        let box_high = ((high - self.anchor) / self.spacing).map(|t| t.ceil() as i32);
        let columns = box_low.x..box_high.x + 1;
        let mut coming = edges_from_above(region);
        let mut met: Vec<Edge> = Vec::new();
        let mut ends: Vec<i32> = Vec::new();
        for j in box_low.y..=box_high.y {
            let y = self.at(0, j).y;
            while let Some(edge) = coming.pop_if(|edge| edge.low() <= y) {
                met.push(edge);
            }
            met.retain(|edge| edge.high() > y);
            ends.clear();
            ends.extend(met.iter().map(|edge| self.first_beyond(edge, j, &columns)));
            ends.sort_unstable();
            // A ray to the right of a place crosses all edges but those whose first place beyond lies at or before it.
            for run in ends.chunks_exact(2).filter(|run| run[0] < run[1]) {
                visit(j, run[0]..run[1]);
            }
        }
    }

    /// The first of `columns` in row `j` that does not lie to the left of an edge, or the end of them.
    fn first_beyond(&self, edge: &Edge, j: i32, columns: &Range<i32>) -> i32 {
        let row = self.at(0, j).y;
        let part = (row - edge.from.y) / (edge.to.y - edge.from.y);
        let x = edge.from.x + (edge.to.x - edge.from.x) * part;
        let mut column = (((x - self.anchor.x) / self.spacing - 0.5) as i32).clamp(columns.start, columns.end);
        // Exact, where the guess is off by its rounding.
        while column > columns.start && !edge.is_right_of(self.at(column - 1, j)) {
            column -= 1;
        }
        while column < columns.end && edge.is_right_of(self.at(column, j)) {
            column += 1;
        }
        column
    }
}

/// An edge of a ring that is not level.
#[derive(Debug, Clone, Copy)]
struct Edge {
    from: Point,
    to: Point,
}

impl Edge {
    fn low(&self) -> f64 {
        self.from.y.min(self.to.y)
    }

    fn high(&self) -> f64 {
        self.from.y.max(self.to.y)
    }

    /// Whether it passes to the right of a point at its height.
    fn is_right_of(&self, point: Point) -> bool {
        let turn = orientation(self.from, self.to, point);
        if self.to.y > self.from.y { turn > 0.0 } else { turn < 0.0 }
    }
}

/// The edges of a region, the lowest last.
fn edges_from_above(region: &Region) -> Vec<Edge> {
    let mut edges: Vec<Edge> = region
        .rings()
        .flat_map(|ring| (0..ring.len()).map(move |k| Edge { from: ring[k], to: ring[(k + 1) % ring.len()] }))
        .filter(|edge| edge.from.y != edge.to.y)
        .collect();
    edges.sort_by(|a, b| b.low().total_cmp(&a.low()));
    edges
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    proptest! {
        /// Truth: the test of every place of the box. Corners lie on places, on rows and anywhere; rings may cross,
        /// where the even-odd rule counts.
        #[test]
        fn runs_are_the_places_inside(
            corners in prop::collection::vec((-20_i32..20, -20_i32..20, 0.0..1.0_f64), 3..12),
            hole in prop::collection::vec((-20_i32..20, -20_i32..20, 0.0..1.0_f64), 3..6),
            snaps in any::<bool>(),
        ) {
            let places = Places { anchor: Point::new(-3.7, 1.3), spacing: 0.25 };
            let corner = |&(i, j, t): &(i32, i32, f64)| {
                let on = places.at(i, j);
                if snaps && t < 0.7 { on } else { on + Vector::new(t, 1.0 - t) * 0.25 }
            };
            let region = Region {
                exterior: corners.iter().map(corner).collect(),
                // Within the rows of the exterior, which bound the search.
                holes: vec![hole.iter().map(corner).collect()],
            };
            let (low, high) = region.bounds();
            let within = |p: Point| p.y >= low.y && p.y <= high.y && p.x >= low.x && p.x <= high.x;
            let mut found = BTreeSet::new();
            let mut order = Vec::new();
            places.for_each_run_inside(&region, |j, columns| {
                order.push((j, columns.start));
                found.extend(columns.map(|i| (j, i)).filter(|&(j, i)| within(places.at(i, j))));
            });
            prop_assert!(order.is_sorted());
            let all = (-30..30).flat_map(|j| (-30..30).map(move |i| (j, i)));
            let inside = |&(j, i): &(i32, i32)| within(places.at(i, j)) && region.contains(places.at(i, j));
            prop_assert_eq!(found, all.filter(inside).collect::<BTreeSet<_>>());
        }
    }
}
