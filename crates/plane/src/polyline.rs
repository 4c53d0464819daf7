//! Open polylines.

use crate::{Point, distance_to_segment};

/// Length of an open polyline [m].
pub fn polyline_length(points: &[Point]) -> f64 {
    points.windows(2).map(|w| (w[1] - w[0]).norm()).sum()
}

/// A polyline without the points that lie within `tolerance` [m] of the line without them (Douglas & Peucker 1973);
/// its ends stay.
pub fn simplified(points: &[Point], tolerance: f64) -> Vec<Point> {
    let Some(last) = points.len().checked_sub(1) else { return Vec::new() };
    let mut is_kept = vec![false; points.len()];
    (is_kept[0], is_kept[last]) = (true, true);
    let mut spans = vec![(0, last)];
    while let Some((from, to)) = spans.pop() {
        let off = |k: usize| distance_to_segment(points[k], points[from], points[to]);
        let farthest = (from + 1..to).max_by(|&a, &b| off(a).total_cmp(&off(b)));
        if let Some(k) = farthest.filter(|&k| off(k) > tolerance) {
            is_kept[k] = true;
            spans.extend([(from, k), (k, to)]);
        }
    }
    points.iter().zip(is_kept).filter(|(_, kept)| *kept).map(|(point, _)| *point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use geo::{LineString, Simplify};
    use proptest::prelude::*;

    proptest! {
        /// Truth: `geo`, on open and closed lines.
        #[test]
        fn a_simplified_line_is_that_of_geo(
            places in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64), 2..60),
            tolerance in 0.01..0.8_f64,
            closes: bool,
        ) {
            let mut line: Vec<Point> = places.iter().map(|&(x, y)| Point::new(x, y)).collect();
            if closes {
                line.push(line[0]);
            }
            let theirs: LineString = line.iter().map(|p| (p.x, p.y)).collect();
            let theirs: Vec<Point> = theirs.simplify(tolerance).0.iter().map(|p| Point::new(p.x, p.y)).collect();
            prop_assert_eq!(simplified(&line, tolerance), theirs);
        }
    }

    #[test]
    fn lines_without_a_middle_stay() {
        let (a, b) = (Point::new(0.0, 0.0), Point::new(1.0, 0.0));
        for line in [vec![], vec![a], vec![a, b], vec![a, a]] {
            assert_eq!(simplified(&line, 0.1), line);
        }
    }
}
