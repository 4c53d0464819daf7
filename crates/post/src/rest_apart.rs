//! Fragments cut at rest that lie in each other a little, moved to lie beside each other: their triangles stay, their
//! corners make room ([`crate::ways_apart`]), and those within go along.

use crate::body_size::body_size;
use crate::boolean::{Edge, SourceIndex, material};
use crate::drawn_along::drawn_along;
use crate::lattice::Enclosed;
use crate::pressed_corners::part_caps;
use crate::rest_solids::{RestObject, apart};
use crate::slivers::without_slivers;
use crate::snap::{GridPoint, turn};
use crate::solids::{Boundaries, Solids, WIDEST_OVERLAP};
use crate::source::{Carried, SourceEdge};
use crate::triangulate::Cap;
use crate::untangled::untangle;
use crate::ways_apart::{Held, Ways, ways_apart};
use fissure_scene::{Point, Vector};
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::BTreeSet;

/// Times that overlaps are looked for: each leaves what edges are off the middle.
const ROUNDS: usize = 8;
/// Corners within go along that are so many triangles from the boundary that moves.
const RINGS: usize = 3;
/// Times that corners go half as far, where triangles would fold, before they stay.
const HALVES: i32 = 3;

impl Solids<'_> {
    /// Moves the boundaries of `objects` that lie in each other or in those of `others` to the middle.
    pub(crate) fn push_apart(&self, objects: &mut [RestObject], others: &Boundaries) {
        let grid = |body: u32| self.grids[body as usize];
        let enclosed = |body, piece, sources: &[SourceEdge]| {
            let shapes = without_slivers(material(sources));
            Enclosed { body, piece, grid: grid(body), shapes, sources: sources.to_vec(), least: 0.0, has_lost: false }
        };
        let mut all: Vec<Enclosed> =
            objects.iter().map(|object| enclosed(object.body, object.piece, &object.sources)).collect();
        all.extend(others.iter().map(|(&(body, piece), sources)| enclosed(body, piece, sources)));
        let mut held: Vec<Held> =
            (0..all.len()).map(|k| if k < objects.len() { Held::default() } else { Held::All }).collect();
        let mut pushed = BTreeSet::new();
        let mut numbers: Vec<usize> = (0..all.len()).collect();
        for _ in 0..ROUNDS {
            let apart = ways_apart(&all, &held, WIDEST_OVERLAP * self.scene.cell_size, self);
            let mut goes_on = false;
            for (k, ways) in apart.ways.iter().enumerate() {
                if !ways.is_empty()
                    && let Some(object) = objects.get_mut(numbers[k])
                {
                    goes_on |= object.push(ways, self.rest_width(object.body), &mut held[k]);
                    pushed.insert(numbers[k]);
                    all[k] = enclosed(object.body, object.piece, &object.sources);
                }
            }
            if !goes_on {
                break;
            }
            // What lies in nothing does not come into the next round: most of all.
            let keeps = |k: &usize| apart.meets[*k];
            numbers = (0..numbers.len()).filter(keeps).map(|k| numbers[k]).collect();
            held = (0..).zip(held).filter(|(k, _)| keeps(k)).map(|(_, held)| held).collect();
            all = (0..).zip(all).filter(|(k, _)| keeps(k)).map(|(_, of)| of).collect();
        }
        for object in pushed {
            let RestObject { body, caps, sources, .. } = &mut objects[object];
            part_caps(caps, sources, self.rest_width(*body));
        }
    }

    /// How near corners of a body may come to each other, in grid steps.
    fn rest_width(&self, body: u32) -> f64 {
        apart(self.options, body_size(self.scene, body)) / self.grids[body as usize].step
    }
}

impl RestObject {
    /// Moves corners of the boundary, known by the edges that start there, and what is within along with them, as far
    /// as no triangle folds and no two corners come nearer than `width` grid steps; others are `held` from then on.
    /// Whether any has moved or is held.
    fn push(&mut self, ways: &Ways, width: f64, held: &mut Held) -> bool {
        let mut goes_on = false;
        for (cap, within) in &mut self.caps {
            goes_on |= push_cap(cap, within, &mut self.sources, ways, width, held);
        }
        goes_on
    }
}

/// Moves corners of one part, as [`RestObject::push`] does.
fn push_cap(
    cap: &mut Cap,
    within: &[Carried],
    sources: &mut [SourceEdge],
    ways: &Ways,
    width: f64,
    held: &mut Held,
) -> bool {
    let outer: Vec<&Edge> = cap.shape.iter().flatten().collect();
    let count = outer.len();
    let mut now: Vec<GridPoint> = outer.iter().map(|edge| edge.a).chain(cap.within.iter().copied()).collect();
    let at_rest = outer.iter().map(|edge| sources[edge.source.0 as usize].carried[0].rest);
    let rest: Vec<Point> = at_rest.chain(within.iter().map(|carried| carried.rest)).collect();
    let moved: Vec<(usize, GridPoint)> = outer
        .iter()
        .enumerate()
        .filter_map(|(k, edge)| Some((k, *ways.get(&edge.source.0)?)))
        .filter(|&(k, to)| to != now[k])
        .collect();
    if moved.is_empty() {
        return false;
    }
    let (moves, stuck) = match whole_way(&moved, &now[..count]) {
        Some((x, y)) => {
            now.iter_mut().for_each(|place| *place = GridPoint::new(place.x + x, place.y + y));
            (true, Vec::new())
        }
        None => Patch::new(&moved, count, &cap.triangles).pushed(&mut now, &moved, &rest, width),
    };
    stuck.iter().for_each(|&corner| held.hold(outer[corner].source.0));
    if moves {
        let mut begin = 0;
        for contour in &mut cap.shape {
            let length = contour.len();
            for (i, edge) in contour.iter_mut().enumerate() {
                (edge.a, edge.b) = (now[begin + i], now[begin + (i + 1) % length]);
                let SourceIndex(source) = edge.source;
                let source = &mut sources[source as usize];
                (source.a, source.b) = (edge.a, edge.b);
            }
            begin += length;
        }
        cap.within.copy_from_slice(&now[count..]);
    }
    moves || !stuck.is_empty()
}

/// The way that all corners of a boundary go, if that is one.
fn whole_way(moved: &[(usize, GridPoint)], boundary: &[GridPoint]) -> Option<(i64, i64)> {
    let way = |&(corner, to): &(usize, GridPoint)| (to.x - boundary[corner].x, to.y - boundary[corner].y);
    let first = way(moved.first()?);
    (moved.len() == boundary.len() && moved.iter().all(|corner| way(corner) == first)).then_some(first)
}

/// The triangles around corners that move.
struct Patch {
    /// Numbers of its corners in the cap; those that stay where they are told to be first.
    corners: Vec<usize>,
    /// How many these are.
    fixed: usize,
    /// As numbers of `corners`.
    triangles: Vec<[u32; 3]>,
}

impl Patch {
    /// Those around `moved` corners of a cap whose first `count` corners are the boundary.
    fn new(moved: &[(usize, GridPoint)], count: usize, triangles: &[[u32; 3]]) -> Self {
        let mut reached: FxHashSet<u32> = moved.iter().map(|&(corner, _)| corner as u32).collect();
        for _ in 0..RINGS {
            let touched = triangles.iter().filter(|triangle| triangle.iter().any(|corner| reached.contains(corner)));
            let more: Vec<u32> = touched.flatten().copied().collect();
            reached.extend(more);
        }
        let is_free = |corner: u32| corner as usize >= count && reached.contains(&corner);
        let is_moved: FxHashSet<u32> = moved.iter().map(|&(corner, _)| corner as u32).collect();
        let is_near =
            |triangle: &&[u32; 3]| triangle.iter().any(|&corner| is_free(corner) || is_moved.contains(&corner));
        let near: Vec<[u32; 3]> = triangles.iter().filter(is_near).copied().collect();
        let mut all: Vec<u32> = near.iter().flatten().copied().collect();
        all.sort_unstable();
        all.dedup();
        let (mut corners, free): (Vec<u32>, Vec<u32>) = all.into_iter().partition(|&corner| !is_free(corner));
        let fixed = corners.len();
        corners.extend(free);
        let number: FxHashMap<u32, u32> = corners.iter().zip(0..).map(|(&corner, number)| (corner, number)).collect();
        let triangles = near.iter().map(|triangle| triangle.map(|corner| number[&corner])).collect();
        Self { corners: corners.into_iter().map(|corner| corner as usize).collect(), fixed, triangles }
    }

    /// Moves corners of the boundary, those within along with them. Whether any has moved, and which of `moved` can go
    /// no farther.
    fn pushed(
        &self,
        now: &mut [GridPoint],
        moved: &[(usize, GridPoint)],
        rest: &[Point],
        width: f64,
    ) -> (bool, Vec<usize>) {
        let before: Vec<GridPoint> = self.corners.iter().map(|&corner| now[corner]).collect();
        let places: Vec<Point> = self.corners.iter().map(|&corner| rest[corner]).collect();
        let was_bad: FxHashSet<usize> = self.cramped(&before, width).collect();
        let mut goes: FxHashMap<usize, (Vector, i32)> = moved
            .iter()
            .map(|&(corner, to)| {
                let from = now[corner];
                (corner, (Vector::new((to.x - from.x) as f64, (to.y - from.y) as f64), 0))
            })
            .collect();
        let stuck = |goes: &FxHashMap<usize, (Vector, i32)>| {
            let mut stuck: Vec<usize> =
                goes.iter().filter(|(_, (_, halves))| *halves >= HALVES).map(|(&corner, _)| corner).collect();
            stuck.sort_unstable();
            stuck
        };
        loop {
            let way = |k: usize| match goes.get(&self.corners[k]) {
                Some((way, halves)) if *halves < HALVES => 0.5_f64.powi(*halves) * way,
                _ => Vector::zeros(),
            };
            let ways: Vec<Option<Vector>> = (0..self.corners.len()).map(|k| (k < self.fixed).then(|| way(k))).collect();
            let along = drawn_along(&ways, &places, &self.triangles);
            let go = |(from, way): (&GridPoint, &Vector)| {
                GridPoint::new(from.x + way.x.round() as i64, from.y + way.y.round() as i64)
            };
            let mut shown: Vec<GridPoint> = before.iter().zip(&along).map(go).collect();
            untangle(&mut shown, self.fixed, &places, &self.triangles);
            let bad: Vec<usize> = self.cramped(&shown, width).filter(|triangle| !was_bad.contains(triangle)).collect();
            if bad.is_empty() {
                let moves = shown != before;
                self.corners.iter().zip(shown).for_each(|(&corner, place)| now[corner] = place);
                return (moves, stuck(&goes));
            }
            let mut at: Vec<usize> =
                bad.iter().flat_map(|&k| self.triangles[k]).map(|k| self.corners[k as usize]).collect();
            at.sort_unstable();
            at.dedup();
            let slower = |(_, halves): &&mut (Vector, i32)| *halves < HALVES;
            let mut any = false;
            for corner in at {
                if let Some((_, halves)) = goes.get_mut(&corner).filter(slower) {
                    *halves += 1;
                    any = true;
                }
            }
            if !any {
                goes.values_mut().for_each(|(_, halves)| *halves += 1);
                if goes.values().all(|(_, halves)| *halves > 2 * HALVES) {
                    return (false, stuck(&goes));
                }
            }
        }
    }

    /// The triangles that are folded or have an edge shorter than `width` grid steps.
    fn cramped(&self, now: &[GridPoint], width: f64) -> impl Iterator<Item = usize> {
        let is_cramped = move |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|corner| now[corner as usize]);
            let is_short = |p: GridPoint, q: GridPoint| ((p.x - q.x) as f64).hypot((p.y - q.y) as f64) < width;
            turn(a, b, c) <= 0 || is_short(a, b) || is_short(b, c) || is_short(c, a)
        };
        (0..self.triangles.len()).filter(move |&k| is_cramped(&self.triangles[k]))
    }
}
