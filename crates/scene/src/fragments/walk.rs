//! Walks along lines with the material on the left, and the fragments that they bound.

use super::lines::Lines;
use super::{Boundary, BoundaryEdge, Fragment, Line, inside};
use fissure_plane::{Point, RingRows, orientation};
use std::cmp::Ordering;

/// An edge with the vertices it joins, and the one that runs the other way on the other side of the crack.
#[derive(Debug, Clone, Copy)]
struct Way {
    body: u32,
    edge: BoundaryEdge,
    from: usize,
    to: usize,
    twin: Option<usize>,
}

/// A boundary before it is known what it bounds.
struct Loop {
    body: u32,
    boundary: Boundary,
    /// Area within [m²]; zero, exactly, where it runs to and fro.
    area: f64,
    /// What it hangs together with.
    component: usize,
    /// Whether it passes all that it hangs together with.
    is_all: bool,
}

impl Loop {
    /// Whether there is nothing within, nor around: it runs between two cracks that lie on each other.
    fn is_nothing(&self) -> bool {
        self.area == 0.0 && !self.is_all
    }
}

/// The fragments that `lines` bound, and what the outer boundary of each contains with its area [m²].
pub(super) fn fragments(lines: &Lines) -> (Vec<Fragment>, Vec<(RingRows, f64)>) {
    let ways = ways(lines);
    let loops = loops(lines, &ways);
    let mut order: Vec<usize> = (0..loops.len()).collect();
    order.sort_by_key(|&i| loops[i].body);
    let outer: Vec<usize> = order.iter().copied().filter(|&i| loops[i].area > 0.0).collect();
    let insides: Vec<_> = outer.iter().map(|&i| inside(&loops[i].boundary)).collect();
    let mut found: Vec<Fragment> =
        outer.iter().map(|&i| Fragment { body: loops[i].body, boundaries: vec![loops[i].boundary.clone()] }).collect();
    for &i in order.iter().filter(|&&i| loops[i].area <= 0.0 && !loops[i].is_nothing()) {
        let hole = &loops[i];
        let place = hole.boundary[0].rest[0];
        // What hangs together with a hole touches it, but does not lie around it.
        let is_around = |&k: &usize| {
            let other = &loops[outer[k]];
            other.body == hole.body && other.component != hole.component && insides[k].0.contains(place)
        };
        let around = (0..outer.len()).filter(is_around);
        let smallest = around.min_by(|&k, &m| insides[k].1.total_cmp(&insides[m].1));
        // Nothing is around a crack that lies outside of its body.
        let of_body = || (0..outer.len()).find(|&k| loops[outer[k]].body == hole.body);
        if let Some(k) = smallest.or_else(of_body) {
            found[k].boundaries.push(hole.boundary.clone());
        }
    }
    (found, insides)
}

fn ways(lines: &Lines) -> Vec<Way> {
    let mut ways = Vec::new();
    for segment in &lines.segments {
        let [first, last] = segment.points;
        for pair in segment.stops.windows(2) {
            let [(begin, from), (end, to)] = [pair[0], pair[1]];
            if from == to {
                continue;
            }
            let rest = [from, to].map(|vertex| lines.places[vertex]);
            let edge = BoundaryEdge { line: segment.line, points: [first, last], span: [begin, end], rest };
            let number = ways.len();
            let twin = matches!(segment.line, Line::Above(_)).then_some(number + 1);
            ways.push(Way { body: segment.body, edge, from, to, twin });
            if let Line::Above(crack) = segment.line {
                let edge = BoundaryEdge {
                    line: Line::Below(crack),
                    points: [last, first],
                    span: [1.0 - end, 1.0 - begin],
                    rest: [rest[1], rest[0]],
                };
                ways.push(Way { body: segment.body, edge, from: to, to: from, twin: Some(number) });
            }
        }
    }
    ways
}

/// The way after each: the next one clockwise from where one came, which keeps the material on the left. Every way is
/// the next of one other, whatever the lines.
fn following(lines: &Lines, ways: &[Way]) -> Vec<usize> {
    let mut leaving: Vec<Vec<usize>> = vec![Vec::new(); lines.places.len()];
    for (w, way) in ways.iter().enumerate() {
        leaving[way.from].push(w);
    }
    let mut next = Vec::with_capacity(ways.len());
    for way in ways {
        let here = &mut leaving[way.to];
        let (at, back) = (lines.places[way.to], way.edge.rest[0]);
        let turn = |&w: &usize| ways[w].edge.rest[1];
        let first = (0..here.len()).min_by(|&i, &j| clockwise(at, back, turn(&here[i]), turn(&here[j])));
        // As many ways arrive at a vertex as leave it: rings and faces are closed.
        next.push(first.map_or(usize::MAX, |i| here.swap_remove(i)));
    }
    next
}

/// Which of the directions from `at` to `p` and to `q` comes first when turning clockwise from that to `back`; that to
/// `back` itself comes last.
fn clockwise(at: Point, back: Point, p: Point, q: Point) -> Ordering {
    let quarter = |x: Point| match orientation(at, back, x) {
        side if side < 0.0 => 0,
        side if side > 0.0 => 2,
        _ if (x - at).dot(&(back - at)) < 0.0 => 1,
        _ => 3,
    };
    // Of two on the same side the first has the other to its right.
    let turn = orientation(at, p, q);
    quarter(p).cmp(&quarter(q)).then(turn.partial_cmp(&0.0).unwrap_or(Ordering::Equal))
}

fn loops(lines: &Lines, ways: &[Way]) -> Vec<Loop> {
    let next = following(lines, ways);
    let components = components(lines, ways);
    let mut sizes = vec![0; components.len()];
    ways.iter().for_each(|way| sizes[components[way.from]] += 1);
    let mut loop_of = vec![usize::MAX; ways.len()];
    let mut found: Vec<Vec<usize>> = Vec::new();
    for start in 0..ways.len() {
        let mut members = Vec::new();
        let mut w = start;
        while loop_of.get(w) == Some(&usize::MAX) {
            loop_of[w] = found.len();
            members.push(w);
            w = next[w];
        }
        if !members.is_empty() {
            found.push(members);
        }
    }
    let of = |(number, members): (usize, Vec<usize>)| {
        let first = &ways[members[0]];
        // Of a crack that is passed on both sides nothing is left, not even rounding.
        let is_single = |w: &&usize| ways[**w].twin.is_none_or(|twin| loop_of[twin] != number);
        let origin = first.edge.rest[0];
        let twice = |w: &usize| {
            let [a, b] = ways[*w].edge.rest.map(|p| p - origin);
            a.perp(&b)
        };
        let area = 0.5 * members.iter().filter(is_single).map(twice).sum::<f64>();
        let boundary = members.iter().map(|&w| ways[w].edge).collect();
        let is_all = members.len() == sizes[components[first.from]];
        Loop { body: first.body, boundary, area, component: components[first.from], is_all }
    };
    found.into_iter().enumerate().map(of).collect()
}

/// For each vertex the lowest one that ways lead to from there.
fn components(lines: &Lines, ways: &[Way]) -> Vec<usize> {
    fn root(parent: &mut [usize], mut v: usize) -> usize {
        while parent[v] != v {
            parent[v] = parent[parent[v]];
            v = parent[v];
        }
        v
    }
    let mut parent: Vec<usize> = (0..lines.places.len()).collect();
    for way in ways {
        let (a, b) = (root(&mut parent, way.from), root(&mut parent, way.to));
        parent[a.max(b)] = a.min(b);
    }
    (0..parent.len()).map(|v| root(&mut parent, v)).collect()
}
