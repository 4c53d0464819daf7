//! Where lines touch themselves or each other.

use crate::{Point, orientation, segments_touch};

/// An edge of a ring or a piece of a polyline.
#[derive(Debug, Clone, Copy)]
struct Edge {
    a: Point,
    b: Point,
    line: usize,
    index: usize,
}

/// The first place found where lines touch themselves or each other, other than at the joints of their edges.
///
/// `closed`: the lines are rings. Sweeps over x, so that it is fast when edges are short.
pub fn find_crossing(lines: &[&[Point]], closed: bool) -> Option<Point> {
    let mut edges = Vec::new();
    for (line, points) in lines.iter().enumerate() {
        let count = if closed { points.len() } else { points.len().saturating_sub(1) };
        edges.extend((0..count).map(|i| Edge { a: points[i], b: points[(i + 1) % points.len()], line, index: i }));
    }
    edges.sort_by(|e, f| e.a.x.min(e.b.x).total_cmp(&f.a.x.min(f.b.x)));
    let mut open: Vec<Edge> = Vec::new();
    for e in edges {
        let left = e.a.x.min(e.b.x);
        open.retain(|f| f.a.x.max(f.b.x) >= left);
        for f in &open {
            let length = lines[e.line].len();
            if e.a.y.max(e.b.y) >= f.a.y.min(f.b.y)
                && f.a.y.max(f.b.y) >= e.a.y.min(e.b.y)
                && touch_wrongly(&e, f, length, closed)
            {
                return Some(meeting_point(&e, f));
            }
        }
        open.push(e);
    }
    None
}

/// Whether two edges share more than the joint that neighbours share.
fn touch_wrongly(e: &Edge, f: &Edge, length: usize, closed: bool) -> bool {
    let follows = |e: &Edge, f: &Edge| {
        e.line == f.line && (e.index + 1 == f.index || (closed && f.index == 0 && e.index + 1 == length))
    };
    let (first, second) = match (follows(e, f), follows(f, e)) {
        (true, true) => return false, // A ring of two points: caught by its area.
        (true, false) => (e, f),
        (false, true) => (f, e),
        (false, false) => return segments_touch(e.a, e.b, f.a, f.b),
    };
    // Neighbours touch wrongly when the second runs back over the first.
    let (there, back) = (first.b - first.a, second.b - second.a);
    let runs_back = there.dot(&back) < 0.0;
    // A turned drawing keeps the folds of its lines to rounding only. What encloses an area has no fold.
    let is_fold = !closed && there.perp(&back).abs() <= FOLD * there.norm() * back.norm();
    runs_back && (is_fold || orientation(first.a, first.b, second.b) == 0.0)
}

/// A line that turns by half a turn to within this angle runs back over itself [rad]: more than rounding, less than
/// anybody draws.
const FOLD: f64 = 1e-6;

fn meeting_point(e: &Edge, f: &Edge) -> Point {
    let joints = [(e.b, f.a), (f.b, e.a)].into_iter();
    if let Some((joint, _)) =
        joints.filter(|_| e.line == f.line && e.index.abs_diff(f.index) == 1).find(|(p, q)| p == q)
    {
        return joint;
    }
    let (d, g, w) = (e.b - e.a, f.b - f.a, f.a - e.a);
    let determinant = d.x * g.y - d.y * g.x;
    if determinant == 0.0 {
        // Collinear: an end point that lies on the other edge.
        return if (e.a - f.a).dot(&(e.a - f.b)) <= 0.0 { e.a } else { e.b };
    }
    e.a + d * ((w.x * g.y - w.y * g.x) / determinant)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64, half: f64) -> Vec<Point> {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .iter()
            .map(|(u, v)| Point::new(x + half * u, y + half * v))
            .collect()
    }

    #[test]
    fn crossings_are_found_and_joints_are_not() {
        let bow = [(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)].map(|(x, y)| Point::new(x, y));
        assert_eq!(find_crossing(&[&bow], true), Some(Point::new(1.0, 1.0)));
        assert_eq!(find_crossing(&[&square(0.0, 0.0, 1.0)], true), None);
        let spike = [(0.0, 0.0), (2.0, 0.0), (1.0, 0.0)].map(|(x, y)| Point::new(x, y));
        assert!(find_crossing(&[&spike], false).is_some());
        assert!(find_crossing(&[&square(0.0, 0.0, 1.0), &square(2.0, 0.0, 1.0)], true).is_some());
    }

    /// Truth: the construction. A line that runs back over itself does so at any turn, where rounding moves its points
    /// off each other.
    #[test]
    fn folds_are_found_at_any_turn() {
        for turn in 0..1000 {
            let rotation = nalgebra::Rotation2::new(f64::from(turn) * 0.0063);
            let placed = |list: [(f64, f64); 3]| list.map(|(x, y)| rotation * Point::new(x, y));
            let fold = placed([(0.3, 0.1), (0.3, -4.4), (0.3, 1.5)]);
            assert_eq!(find_crossing(&[&fold], false), Some(fold[1]));
            assert_eq!(find_crossing(&[&placed([(0.3, 0.1), (0.3, -4.4), (0.3001, 1.5)])], false), None);
        }
    }
}
