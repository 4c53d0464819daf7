//! Rings made ready for many questions of what they contain.

use crate::{Point, bounds, is_left_of};

/// Rows that a set of rings is sorted into, at most.
const MOST_ROWS: usize = 1024;

/// The edges of rings sorted into horizontal rows, so that a point is tested against those of its own row only.
#[derive(Debug, Clone, PartialEq)]
pub struct RingRows {
    low: Point,
    high: Point,
    height: f64,
    /// The edges of each row, row after row.
    edges: Vec<[Point; 2]>,
    /// Where the edges of each row begin, and where those of the last one end.
    begins: Vec<usize>,
}

impl RingRows {
    /// The rows of `rings`, each open.
    pub fn new<'a>(rings: impl IntoIterator<Item = &'a [Point]>) -> Self {
        let edges: Vec<[Point; 2]> =
            rings.into_iter().flat_map(|ring| (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]])).collect();
        let starts: Vec<Point> = edges.iter().map(|edge| edge[0]).collect();
        let (low, high) = bounds(&starts);
        let count = edges.len().clamp(1, MOST_ROWS);
        let height = (high.y - low.y) / count as f64;
        let mut rows = Self { low, high, height, edges: Vec::new(), begins: vec![0; count + 1] };
        let of_edge = |rows: &Self, [a, b]: [Point; 2]| rows.row(a.y.min(b.y))..=rows.row(a.y.max(b.y));
        for &edge in &edges {
            of_edge(&rows, edge).for_each(|row| rows.begins[row + 1] += 1);
        }
        (0..count).for_each(|row| rows.begins[row + 1] += rows.begins[row]);
        let mut free = rows.begins.clone();
        let mut sorted = vec![[low; 2]; rows.begins[count]];
        for edge in edges {
            for row in of_edge(&rows, edge) {
                sorted[free[row]] = edge;
                free[row] += 1;
            }
        }
        Self { edges: sorted, ..rows }
    }

    fn row(&self, y: f64) -> usize {
        (((y - self.low.y) / self.height) as usize).min(self.begins.len() - 2)
    }

    /// Whether `point` lies inside, as [`Region::contains`](crate::Region::contains) says of the same rings. An edge
    /// that runs to and fro counts for nothing.
    pub fn contains(&self, point: Point) -> bool {
        let Self { low, high, .. } = self;
        let is_in_box = point.x >= low.x && point.y >= low.y && point.x <= high.x && point.y <= high.y;
        if !is_in_box {
            return false;
        }
        let row = self.row(point.y);
        let edges = &self.edges[self.begins[row]..self.begins[row + 1]];
        edges.iter().fold(false, |inside, &[a, b]| inside != is_left_of(a, b, point))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Region;
    use proptest::prelude::*;

    proptest! {
        /// Truth: the test against all edges, on coordinates that often meet.
        #[test]
        fn rows_contain_what_the_region_does(
            ring in proptest::collection::vec((-4..5_i32, -4..5_i32), 3..12),
            hole in proptest::collection::vec((-4..5_i32, -4..5_i32), 3..6),
            point in (-9..10_i32, -9..10_i32),
        ) {
            let place = |&(x, y): &(i32, i32)| Point::new(0.1 * f64::from(x), 0.1 * f64::from(y));
            let exterior: Vec<Point> = ring.iter().map(place).collect();
            let region = Region { exterior, holes: vec![hole.iter().map(place).collect()] };
            let point = Point::new(0.05 * f64::from(point.0), 0.05 * f64::from(point.1));
            prop_assert_eq!(RingRows::new(region.rings()).contains(point), region.contains(point));
        }
    }
}
