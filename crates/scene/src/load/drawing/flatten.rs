//! Curves as polylines, and how much work an element may make.

use super::grid::GridPoint;
use super::limits::{MOST_CROSSINGS, MOST_PAIRS, MOST_POINTS};
use crate::load::chord::Chord;
use crate::load::seating::Complaint;
use fissure_plane::Point;
use kurbo::{BezPath, CubicBez, PathEl, PathSeg, QuadBez};

/// A drawing is single precision: to flatten finer than this part of a curve's size has no meaning.
const FINEST: f64 = 1.0 / (1 << 22) as f64;

/// What may still be spent on one element.
pub(super) struct Budget {
    points: usize,
    crossings: usize,
    pairs: usize,
}

impl Budget {
    /// That of one element.
    pub(super) fn of_element() -> Self {
        Self { points: MOST_POINTS, crossings: MOST_CROSSINGS, pairs: MOST_PAIRS }
    }

    fn spend_points(&mut self, count: usize) -> Result<(), Complaint> {
        self.points = self.points.checked_sub(count).ok_or_else(|| {
            let message = format!("its curves need more than {MOST_POINTS} points at this resolution");
            (message, "simplify its paths in the SVG editor, or choose a larger particle spacing".to_owned())
        })?;
        Ok(())
    }

    /// Takes off as many crossings as `rings` have with themselves and each other.
    pub(super) fn spend_crossings<'a>(
        &mut self,
        rings: impl Iterator<Item = &'a [GridPoint]>,
    ) -> Result<(), Complaint> {
        let mut edges: Vec<[GridPoint; 2]> = rings
            .flat_map(|ring| (0..ring.len()).map(move |i| [ring[i], ring[(i + 1) % ring.len()]]))
            .map(|[a, b]| if a.x <= b.x { [a, b] } else { [b, a] })
            .collect();
        edges.sort_by_key(|[a, _]| a.x);
        let mut open: Vec<[GridPoint; 2]> = Vec::new();
        for e in edges {
            open.retain(|[_, b]| b.x >= e[0].x);
            let (low, high) = (e[0].y.min(e[1].y), e[0].y.max(e[1].y));
            let crossing =
                open.iter().filter(|f| f[0].y.max(f[1].y) >= low && f[0].y.min(f[1].y) <= high && cross(&e, f));
            let spent = crossing.count();
            let left = (self.crossings.checked_sub(spent), self.pairs.checked_sub(open.len()));
            let (Some(crossings), Some(pairs)) = left else { return Err(Self::too_many_crossings()) };
            (self.crossings, self.pairs) = (crossings, pairs);
            open.push(e);
        }
        Ok(())
    }

    /// What is told when crossings, or places where outlines run along each other, are too many.
    pub(super) fn too_many_crossings() -> Complaint {
        let message = format!("its outlines cross too often to be resolved (more than {MOST_CROSSINGS} times)");
        (message, "simplify its paths in the SVG editor".into())
    }
}

/// Whether two edges cross other than in their ends; near ones may be told wrongly.
fn cross([a, b]: &[GridPoint; 2], [c, d]: &[GridPoint; 2]) -> bool {
    let turn = |p: &GridPoint, q: &GridPoint, r: &GridPoint| {
        (q.x - p.x) as f64 * (r.y - p.y) as f64 - (q.y - p.y) as f64 * (r.x - p.x) as f64
    };
    turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0
}

/// A polyline and whether it is closed.
pub(super) type Polyline = (Vec<Point>, bool);

/// The subpaths of a path, flattened to `tolerance` [m], each with whether it is closed (by Z or by ending where it
/// began). `chords` receives those of its curves.
pub(super) fn flatten(
    path: &BezPath,
    tolerance: f64,
    budget: &mut Budget,
    mut chords: Option<&mut Vec<Chord>>,
) -> Result<Vec<Polyline>, Complaint> {
    let tolerance = tolerance.max(FINEST * path.control_box().size().max_side());
    let mut lines: Vec<Polyline> = Vec::new();
    let (mut start, mut last) = (kurbo::Point::ORIGIN, kurbo::Point::ORIGIN);
    let mut begun = false;
    for &element in path.elements() {
        match element {
            PathEl::MoveTo(p) => (start, last, begun) = (p, p, false),
            PathEl::ClosePath => {
                if let (Some((_, closed)), true) = (lines.last_mut(), begun) {
                    *closed = true;
                }
                (last, begun) = (start, false);
            }
            _ => {
                if !begun {
                    lines.push((vec![Point::new(last.x, last.y)], false));
                    begun = true;
                }
                let Some((points, _)) = lines.last_mut() else { continue };
                let before = points.len();
                kurbo::flatten([PathEl::MoveTo(last), element], tolerance, |piece| {
                    if let PathEl::LineTo(p) = piece {
                        points.push(Point::new(p.x, p.y));
                    }
                });
                budget.spend_points(points.len() - before)?;
                let curve = match element {
                    PathEl::QuadTo(p, q) => Some(PathSeg::Quad(QuadBez::new(last, p, q))),
                    PathEl::CurveTo(p, q, r) => Some(PathSeg::Cubic(CubicBez::new(last, p, q, r))),
                    _ => None,
                };
                if let (Some(chords), Some(curve)) = (&mut chords, curve) {
                    chords.extend(Chord::of_curve(curve, &points[before - 1..]));
                }
                last = element.end_point().unwrap_or(last);
            }
        }
    }
    for (points, closed) in &mut lines {
        let gap = (points[0] - points[points.len() - 1]).norm();
        *closed = *closed || (points.len() > 3 && gap <= tolerance * 1e-3);
    }
    Ok(lines)
}
