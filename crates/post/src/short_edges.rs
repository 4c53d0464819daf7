//! Edges so short that readers that merge vertices by distance would close them.

use crate::boolean::{Contour, Edge, Shape, SourceIndex};
use crate::snap::{GridPoint, turn};
use crate::source::{Carried, SourceEdge};

/// Whether polygons may become larger where short edges are taken out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Growth {
    /// By no more than the square of a short edge has a few hundredths of: they lie beside others.
    Hardly,
    /// Wherever that changes the area less.
    Allowed,
}

/// What a polygon may hardly grow by, as a part of the square of the shortest edge.
const HARDLY: f64 = 0.02;

/// Takes edges shorter than `least` grid steps out of the contours of `shapes`, one of their ends each: the one without
/// which the area changes less, if it may; and contours that have no longer ones. `sources` receives the edges that
/// take their place. Edges that `is_drawn` stay, and so do those that are needed to keep contours apart.
pub(crate) fn without_short_edges(
    shapes: &mut Vec<Shape>,
    least: f64,
    growth: Growth,
    sources: &mut Vec<SourceEdge>,
    is_drawn: impl Fn(&Edge, &SourceEdge) -> bool,
) {
    let is_short =
        |edge: &Edge, sources: &[SourceEdge]| length(edge) < least && !is_drawn(edge, &sources[edge.source.0 as usize]);
    let most_growth = match growth {
        Growth::Hardly => (2.0 * HARDLY * least * least) as i128,
        Growth::Allowed => i128::MAX,
    };
    for shape in shapes.iter_mut() {
        let outer = shape.first().is_some_and(|outer| outer.iter().all(|edge| is_short(edge, sources)));
        shape.retain(|contour| !outer && !contour.iter().all(|edge| is_short(edge, sources)));
    }
    shapes.retain(|shape| !shape.is_empty());
    for index in 0..shapes.len() {
        for number in 0..shapes[index].len() {
            // What cannot go yet may go when a corner beside it has gone.
            loop {
                let contour = &shapes[index][number];
                let mut short = (0..contour.len()).filter(|&i| is_short(&contour[i], sources));
                let Some(first) = short.find_map(|found| without(shapes, contour, found, most_growth)) else { break };
                merge(&mut shapes[index][number], first, sources);
            }
        }
    }
}

/// The first of the two edges that one may take the place of, so that edge `found` of `contour`, one of `shapes`, is
/// gone; none if the contour would then touch another one, have no area, or grow by more than half of `most_growth`.
fn without(shapes: &[Shape], contour: &Contour, found: usize, most_growth: i128) -> Option<usize> {
    let count = contour.len();
    let mut ways = [(found + count - 1) % count, found];
    if turned(contour, ways[0]).unsigned_abs() > turned(contour, ways[1]).unsigned_abs() {
        ways.swap(0, 1);
    }
    // Where the contour turns right, material comes to it.
    let may_go = |first: usize| -turned(contour, first) <= most_growth && is_free(shapes, contour, first);
    ways.into_iter().find(|&first| count > 3 && may_go(first))
}

fn length(edge: &Edge) -> f64 {
    ((edge.b.x - edge.a.x) as f64).hypot((edge.b.y - edge.a.y) as f64)
}

/// Twice the area of the triangle of an edge and the one after it.
fn turned(contour: &Contour, first: usize) -> i128 {
    let second = &contour[(first + 1) % contour.len()];
    turn(contour[first].a, contour[first].b, second.b)
}

/// Whether no corner lies in or on the triangle between an edge with the one after it and the edge that replaces both.
fn is_free(shapes: &[Shape], contour: &Contour, first: usize) -> bool {
    let second = contour[(first + 1) % contour.len()];
    let (a, b, c) = (contour[first].a, second.a, second.b);
    let [low_x, high_x] = [a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x)];
    let [low_y, high_y] = [a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y)];
    let is_outside = |p: GridPoint| {
        if p.x < low_x || p.x > high_x || p.y < low_y || p.y > high_y {
            return true;
        }
        let sides = [turn(a, b, p), turn(b, c, p), turn(c, a, p)];
        p == a || p == b || p == c || (sides.iter().any(|s| *s > 0) && sides.iter().any(|s| *s < 0))
    };
    a != c && shapes.iter().flatten().flatten().all(|edge| is_outside(edge.a))
}

/// Puts one edge in the place of edge `first` and the one after it. It carries on both sides what they carry there, and
/// is a wall of the kind of the longer one.
fn merge(contour: &mut Contour, first: usize, sources: &mut Vec<SourceEdge>) {
    let second = (first + 1) % contour.len();
    let (one, two) = (contour[first], contour[second]);
    let (source_one, source_two) = (sources[one.source.0 as usize], sources[two.source.0 as usize]);
    let (mut start, mut end) = (source_one.at(one.a), source_two.at(two.b));
    let longer = if length(&one) < length(&two) { source_two } else { source_one };
    if source_one.slot != source_two.slot || source_one.at(one.b).arc != source_two.at(two.a).arc {
        // Lengths along two lines have nothing to do with each other.
        let own = |carried: Carried, point| {
            let Carried { arc, history, .. } = longer.at(point);
            Carried { arc, history, ..carried }
        };
        (start, end) = (own(start, one.a), own(end, two.b));
    }
    let source = SourceIndex(sources.len() as u32);
    sources.push(SourceEdge { a: one.a, b: two.b, carried: [start, end], slot: longer.slot });
    contour[first] = Edge { a: one.a, b: two.b, source };
    contour.remove(second);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boolean::{material, twice_area};
    use crate::slot::Slot;
    use fissure_scene::{Point, Vector};
    use proptest::prelude::*;

    /// The boundary of rings, as sources that carry nothing.
    fn sources(rings: &[Vec<(i64, i64)>]) -> Vec<SourceEdge> {
        let carried = [Carried::within(Point::origin(), Vector::zeros()); 2];
        let edges = rings.iter().flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
        let point = |&(x, y): &(i64, i64)| GridPoint::new(x, y);
        edges.map(|(a, b)| SourceEdge { a: point(a), b: point(b), carried, slot: Slot::Inside }).collect()
    }

    fn area(shapes: &[Shape]) -> f64 {
        0.5 * shapes.iter().flatten().map(|contour| twice_area(contour)).sum::<i128>() as f64
    }

    proptest! {
        /// Truth: by hand. A square with many corners in its sides, some beside the straight line, and a hole: what is
        /// left has no short edge, is closed, and differs by no more than the strips beside the short edges.
        #[test]
        fn short_edges_go_and_the_area_stays(
            steps in proptest::collection::vec((1_i64..400, -3_i64..4), 40),
            hole in 3_i64..2000,
        ) {
            let mut ring = vec![(0, 0)];
            let mut x = 0;
            for (step, off) in steps {
                x += step;
                ring.push((x, off));
            }
            let side = x + 6000;
            ring.extend([(side, 0), (side, side), (0, side)]);
            let inner = vec![(500, 3000), (500, 3000 + hole), (500 + hole, 3000 + hole), (500 + hole, 3000)];
            let mut sources = sources(&[ring, inner]);
            let mut shapes = material(&sources);
            let before = area(&shapes);
            let filled = if hole < 100 { (hole * hole) as f64 } else { 0.0 };
            let mut kept = shapes.clone();
            without_short_edges(&mut kept, 100.0, Growth::Hardly, &mut sources.clone(), |_, _| false);
            prop_assert!(area(&kept) <= before + filled + 44.0 * HARDLY * 100.0 * 100.0);
            without_short_edges(&mut shapes, 100.0, Growth::Allowed, &mut sources, |_, _| false);
            prop_assert_eq!(shapes.len(), 1);
            let holes = shapes[0].len() - 1;
            prop_assert_eq!(holes, usize::from(hole >= 100));
            for contour in &shapes[0] {
                for (edge, next) in contour.iter().zip(contour.iter().cycle().skip(1)) {
                    prop_assert_eq!(edge.b, next.a);
                    prop_assert!(length(edge) >= 100.0);
                    let source = &sources[edge.source.0 as usize];
                    prop_assert!(source.at(edge.a) == source.carried[0] && source.at(edge.b) == source.carried[1]);
                }
            }
            // The short ones lie along one side and around its ends.
            prop_assert!((area(&shapes) - before - filled).abs() <= 40.0 * 100.0 * 7.0 + 100.0 * side as f64);
        }
    }

    /// Truth: by hand. An edge whose ends cannot go without crossing the hole beside it stays.
    #[test]
    fn contours_do_not_come_to_touch() {
        let outer = vec![(0, 0), (9000, 0), (9000, 9000), (4550, 4000), (4450, 4000), (0, 9000)];
        // The tip of the hole lies in both triangles that could go.
        let hole = vec![(4500, 3000), (4400, 3000), (4499, 3999)];
        let mut sources = sources(&[outer, hole]);
        let mut shapes = material(&sources);
        let before = area(&shapes);
        without_short_edges(&mut shapes, 101.0, Growth::Allowed, &mut sources, |edge, _| {
            edge.a.y < 3999 && edge.a.x > 0
        });
        let contours = shapes[0].len();
        assert_eq!((contours, shapes.len()), (2, 1));
        assert!(area(&shapes) >= before - 1.0);
    }
}
