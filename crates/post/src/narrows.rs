//! Places where a polygon, or what lies between its edges, is narrower than readers may merge vertices by: necks of
//! material, which are cut, and channels, which are closed. Triangles without small angles would need edges as short.
//!
//! ```text
//!     ╲______╱                ╲__  __╱                              
//!      ______      becomes     __  __       where it is material that is narrow
//!     ╱      ╲                ╱      ╲
//! ```

use crate::boolean::{Contour, Edge, Operation, Shape, SourceIndex, combine};
use crate::pinch::diamond;
use crate::short_edges::Growth;
use crate::slot::Slot;
use crate::snap::{GridPoint, turn};
use crate::source::SourceEdge;

/// What is less wide is narrow, as a part of the shortest edge: readers merge over half of that, and edges of triangles
/// are about as short as what they lie in is wide.
const NARROW: f64 = 0.6;
/// Half diagonal of what parts a narrow place, as a part of the shortest edge: its sides are farther from its centre
/// than half of what is narrow is wide.
const RADIUS: f64 = 0.75;

/// Parts `shapes` at their necks and closes channels, or widens these where polygons may hardly grow. `least` is the
/// shortest edge in grid steps; `sources` receives the new ones. Tells whether there were any narrow places.
pub(crate) fn part_narrows(shapes: &mut Vec<Shape>, least: f64, growth: Growth, sources: &mut Vec<SourceEdge>) -> bool {
    let found = narrows(shapes, NARROW * least, sources);
    for operation in [Operation::Cut, Operation::Fill] {
        let of_kind = |narrow: &&Narrow| narrow.is_material || growth == Growth::Hardly;
        let chosen = found.iter().filter(|narrow| of_kind(narrow) == (operation == Operation::Cut));
        let diamonds: Vec<Contour> =
            chosen.map(|narrow| diamond(narrow.center, (RADIUS * least) as i64, narrow.source, sources)).collect();
        if !diamonds.is_empty() {
            *shapes = combine(shapes, operation, &diamonds);
        }
    }
    !found.is_empty()
}

/// A narrow place.
struct Narrow {
    center: GridPoint,
    /// Whether it is narrow material; what lies between material otherwise.
    is_material: bool,
    /// An edge beside it.
    source: SourceIndex,
}

/// The corners of polygons with an edge nearer than `distance` that does not end there, one place for each.
/// Those between edges that were drawn are as they were drawn.
fn narrows(shapes: &[Shape], distance: f64, sources: &[SourceEdge]) -> Vec<Narrow> {
    let reach = distance.ceil() as i64;
    let mut edges: Vec<&Edge> = shapes.iter().flatten().flatten().collect();
    edges.sort_unstable_by_key(|edge| edge.a.x.min(edge.b.x));
    let mut corners: Vec<(&Edge, &Edge)> = shapes
        .iter()
        .flatten()
        .flat_map(|contour| contour.iter().cycle().skip(contour.len() - 1).zip(contour))
        .collect();
    corners.sort_unstable_by_key(|(_, after)| after.a.x);
    let is_drawn = |edge: &Edge| sources[edge.source.0 as usize].slot == Slot::Outside;
    let (mut next, mut beside) = (0, Vec::<&Edge>::new());
    let mut found = Vec::new();
    for (before, after) in corners {
        let corner = after.a;
        beside.retain(|edge| edge.a.x.max(edge.b.x) + reach >= corner.x);
        while next < edges.len() && edges[next].a.x.min(edges[next].b.x) - reach <= corner.x {
            beside.push(edges[next]);
            next += 1;
        }
        let corner_is_drawn = is_drawn(before) && is_drawn(after);
        let near = beside.iter().filter(|edge| {
            let (low, high) = (edge.a.y.min(edge.b.y), edge.a.y.max(edge.b.y));
            low - reach <= corner.y && corner.y <= high + reach && edge.a != corner && edge.b != corner
        });
        let near = near.map(|edge| (squared_distance(corner, edge), *edge));
        let Some((squared, edge)) = near.min_by(|p, q| p.0.total_cmp(&q.0)) else { continue };
        if squared >= distance * distance || (corner_is_drawn && is_drawn(edge)) {
            continue;
        }
        let (x, y) = nearest(corner, edge);
        let center =
            GridPoint::new((0.5 * (corner.x as f64 + x)).round() as i64, (0.5 * (corner.y as f64 + y)).round() as i64);
        let to = GridPoint::new(x.round() as i64, y.round() as i64);
        found.push(Narrow { center, is_material: is_left_of(before, after, to), source: edge.source });
    }
    found
}

/// Whether the way to `to` from the corner between two edges leads to their left, into the material.
fn is_left_of(before: &Edge, after: &Edge, to: GridPoint) -> bool {
    let [left_of_before, left_of_after] = [turn(before.a, before.b, to) > 0, turn(after.a, after.b, to) > 0];
    if turn(before.a, before.b, after.b) > 0 {
        left_of_before && left_of_after
    } else {
        left_of_before || left_of_after
    }
}

/// The place on `edge` nearest to `point`.
fn nearest(point: GridPoint, edge: &Edge) -> (f64, f64) {
    let along = ((edge.b.x - edge.a.x) as f64, (edge.b.y - edge.a.y) as f64);
    let from = ((point.x - edge.a.x) as f64, (point.y - edge.a.y) as f64);
    let part = (from.0 * along.0 + from.1 * along.1) / (along.0 * along.0 + along.1 * along.1);
    let part = part.clamp(0.0, 1.0);
    (edge.a.x as f64 + part * along.0, edge.a.y as f64 + part * along.1)
}

fn squared_distance(point: GridPoint, edge: &Edge) -> f64 {
    let (x, y) = nearest(point, edge);
    (point.x as f64 - x).powi(2) + (point.y as f64 - y).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boolean::{material, twice_area};
    use crate::source::Carried;
    use fissure_scene::{Point, Vector};
    use proptest::prelude::*;

    const LEAST: f64 = 1000.0;

    fn shapes(rings: &[Vec<(i64, i64)>], slot: Slot) -> (Vec<Shape>, Vec<SourceEdge>) {
        let carried = [Carried::within(Point::origin(), Vector::zeros()); 2];
        let point = |&(x, y): &(i64, i64)| GridPoint::new(x, y);
        let edges = rings.iter().flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
        let sources: Vec<SourceEdge> =
            edges.map(|(a, b)| SourceEdge { a: point(a), b: point(b), carried, slot }).collect();
        (material(&sources), sources)
    }

    fn area(shapes: &[Shape]) -> f64 {
        0.5 * shapes.iter().flatten().map(|contour| twice_area(contour)).sum::<i128>() as f64
    }

    /// Two blocks with a neck between corners that are `width` apart; turned inside out, a ring with a channel.
    fn neck(width: i64) -> Vec<(i64, i64)> {
        let half = width / 2;
        vec![(-9000, -9000), (0, -half), (9000, -9000), (9000, 9000), (0, width - half), (-9000, 9000)]
    }

    proptest! {
        /// Truth: by hand. Blocks that hang together by less than is merged fall apart, slots as narrow are bridged,
        /// or widened where nothing may grow; what is wider, and what was drawn, stays as it is. What changes is the
        /// diamond.
        #[test]
        fn necks_are_cut_and_channels_closed(width in 4..2000_i64, is_channel: bool, hardly: bool, drawn: bool) {
            let block = vec![(-20_000, -20_000), (20_000, -20_000), (20_000, 20_000), (-20_000, 20_000)];
            let mut ring = neck(width);
            let rings = if is_channel { ring.reverse(); vec![block, ring] } else { vec![ring] };
            let (mut shapes, mut sources) = shapes(&rings, if drawn { Slot::Outside } else { Slot::Inside });
            let (before, contours) = (area(&shapes), shapes.iter().flatten().count());
            let growth = if hardly { Growth::Hardly } else { Growth::Allowed };
            let found = part_narrows(&mut shapes, LEAST, growth, &mut sources);
            prop_assert_eq!(found, (width as f64) < NARROW * LEAST && !drawn);
            let more = area(&shapes) - before;
            let diamond = 2.0 * (RADIUS * LEAST).powi(2);
            let parts = shapes.iter().flatten().count() - contours;
            match (found, is_channel, hardly) {
                (false, ..) => prop_assert_eq!((more, parts), (0.0, 0)),
                (true, true, false) => prop_assert!(more > 0.0 && more < diamond && parts == 1, "{more} {parts}"),
                (true, true, true) => prop_assert!(more < 0.0 && more > -diamond && parts == 0, "{more} {parts}"),
                (true, false, _) => prop_assert!(more < 0.0 && more > -diamond && parts == 1, "{more} {parts}"),
            }
        }
    }
}
