//! Shapes that are drawn side by side, joined along the edge they share.
//!
//! Two shapes that abut are each flattened and rounded by themselves, which leaves hair-thin gaps between them. Where
//! an edge of one shape faces an edge of another closer than `reach`, the strip between them is added.

use super::grid::GridPoint;
use super::limits::MOST_STRIPS;

/// A strip counts from so many times its reach in length on: edges that meet in a corner only are no shared edge.
const SHORTEST: f64 = 4.0;
/// How far a strip goes into the shapes on both sides, as a part of the reach, so that rounding leaves no gap.
const GRIP: f64 = 0.125;

/// An edge of a shape, material on its left.
#[derive(Clone, Copy)]
struct Edge {
    shape: usize,
    a: [f64; 2],
    b: [f64; 2],
}

/// The strips between edges of different shapes that face each other within `reach` [grid steps], counter-clockwise;
/// none when there are too many.
///
/// `shapes`: the rings of each, exteriors counter-clockwise, holes clockwise.
pub(super) fn bridges<'a>(
    shapes: impl Iterator<Item = Vec<&'a [GridPoint]>>,
    reach: f64,
) -> Option<Vec<Vec<GridPoint>>> {
    let mut edges: Vec<Edge> = Vec::new();
    for (shape, rings) in shapes.enumerate() {
        for ring in rings {
            let place = |p: &GridPoint| [p.x as f64, p.y as f64];
            edges.extend((0..ring.len()).map(|i| Edge {
                shape,
                a: place(&ring[i]),
                b: place(&ring[(i + 1) % ring.len()]),
            }));
        }
    }
    edges.sort_by(|e, f| e.a[0].min(e.b[0]).total_cmp(&f.a[0].min(f.b[0])));
    let (mut open, mut strips) = (Vec::<Edge>::new(), Vec::new());
    for e in edges {
        let left = e.a[0].min(e.b[0]) - reach;
        open.retain(|f| f.a[0].max(f.b[0]) >= left);
        let (low, high) = (e.a[1].min(e.b[1]) - reach, e.a[1].max(e.b[1]) + reach);
        for f in open.iter().filter(|f| f.shape != e.shape && f.a[1].max(f.b[1]) >= low && f.a[1].min(f.b[1]) <= high) {
            strips.extend(strip(&e, f, reach));
        }
        if strips.len() > MOST_STRIPS {
            return None;
        }
        open.push(e);
    }
    Some(strips)
}

/// The strip between two edges, where they run in opposite directions, outsides facing, within `reach`.
fn strip(e: &Edge, f: &Edge, reach: f64) -> Option<Vec<GridPoint>> {
    let length = (e.b[0] - e.a[0]).hypot(e.b[1] - e.a[1]);
    let along = [(e.b[0] - e.a[0]) / length, (e.b[1] - e.a[1]) / length];
    // In the frame of `e`: x along it, y to its left, where its material is.
    let seen = |p: [f64; 2]| {
        let d = [p[0] - e.a[0], p[1] - e.a[1]];
        [d[0] * along[0] + d[1] * along[1], d[1] * along[0] - d[0] * along[1]]
    };
    let (late, early) = (seen(f.a), seen(f.b));
    let run = late[0] - early[0];
    if run <= 0.0 {
        return None;
    }
    let slope = (late[1] - early[1]) / run;
    let height = |x: f64| early[1] + slope * (x - early[0]);
    let (mut from, mut to) = (early[0].max(0.0), late[0].min(length));
    // The gap is to the right of `e`: heights from -reach to 0, with some room for shapes that overlap by rounding.
    for limit in [-reach, GRIP * reach] {
        let inside = |x: f64| if limit < 0.0 { height(x) >= limit } else { height(x) <= limit };
        let at = early[0] + (limit - early[1]) / slope;
        match (inside(from), inside(to)) {
            (true, true) => {}
            (true, false) => to = at,
            (false, true) => from = at,
            (false, false) => return None,
        }
    }
    let long_enough = to - from >= SHORTEST * reach;
    if !long_enough {
        return None;
    }
    let grip = GRIP * reach;
    let back = |x: f64, y: f64| {
        let place = [e.a[0] + x * along[0] - y * along[1], e.a[1] + x * along[1] + y * along[0]];
        GridPoint::new(place[0].round() as i64, place[1].round() as i64)
    };
    let corners = [(from, height(from).min(0.0) - grip), (to, height(to).min(0.0) - grip), (to, grip), (from, grip)];
    Some(corners.map(|(x, y)| back(x, y)).to_vec())
}
