//! Pinch points: places where contours touch each other, or themselves, in one vertex.
//!
//! A solid extruded from a contour that passes twice through a vertex has an edge with four walls: it is not manifold,
//! and giving each pass its own copy of the vertex does not help, because readers merge equal vertices. So the contours
//! are really parted there, by a small diamond around the vertex. If the narrowest of the wedges that meet there is
//! material, the diamond is cut out: what hangs together in a point does not hang together. If it is empty, the diamond
//! is filled: faces that touch in a point are in contact. Either way the narrowest wedge ends at the rim of the
//! diamond. (Cutting always fails for long thin wedges: both sides of the empty wedge meet the rim in one grid point,
//! and that is the next pinch point.)

use crate::boolean::{Contour, Edge, Operation, Shape, SourceIndex, combine};
use crate::slot::Slot;
use crate::snap::GridPoint;
use crate::source::SourceEdge;
use rustc_hash::FxHashSet;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Least half diagonal of a diamond, in grid steps: the smallest that leaves room between the corners.
const LEAST_RADIUS: f64 = 2.0;
/// Rounding at the rim of a diamond can make a new pinch point; each round takes a diamond wider by half the first.
const ROUNDS: i64 = 10;

/// Parts the contours of `shapes` at all pinch points, by diamonds of half diagonal `radius`, in grid steps; `sources`
/// receives their edges.
///
/// Returns the place of a pinch point that could not be parted.
pub(crate) fn part_pinches(
    mut shapes: Vec<Shape>,
    sources: &mut Vec<SourceEdge>,
    radius: f64,
) -> Result<Vec<Shape>, GridPoint> {
    let first = radius.max(LEAST_RADIUS) as i64;
    for round in 0..ROUNDS {
        let pinches = pinch_points(&shapes);
        if pinches.is_empty() {
            return Ok(shapes);
        }
        let radius = first + round * first / 2;
        for operation in [Operation::Cut, Operation::Fill] {
            let chosen = pinches.iter().filter(|(_, arms)| remedy(arms) == operation);
            let diamonds: Vec<Contour> = chosen.map(|(p, arms)| diamond(*p, radius, arms[0].source, sources)).collect();
            if !diamonds.is_empty() {
                shapes = combine(&shapes, operation, &diamonds);
            }
        }
    }
    pinch_points(&shapes).into_keys().next().map_or(Ok(shapes), Err)
}

/// An edge at a vertex, seen from there.
#[derive(Debug, Clone, Copy)]
struct Arm {
    /// Towards the other end.
    direction: (i64, i64),
    /// Whether the edge starts here: then the wedge to the left of the arm is material, otherwise it is empty.
    starts: bool,
    source: SourceIndex,
}

/// The vertices that contours pass more than once, with their arms.
fn pinch_points(shapes: &[Shape]) -> BTreeMap<GridPoint, Vec<Arm>> {
    let edges = || shapes.iter().flatten().flatten();
    // Nearly always there are none.
    let mut passed = FxHashSet::with_capacity_and_hasher(edges().count(), Default::default());
    let again = edges().map(|edge| edge.a).filter(|a| !passed.insert((a.x, a.y)));
    let mut arms: BTreeMap<GridPoint, Vec<Arm>> = again.map(|vertex| (vertex, Vec::new())).collect();
    if arms.is_empty() {
        return arms;
    }
    for &Edge { a, b, source } in edges() {
        let arm =
            |from: GridPoint, to: GridPoint, starts| Arm { direction: (to.x - from.x, to.y - from.y), starts, source };
        for (at, arm) in [(a, arm(a, b, true)), (b, arm(b, a, false))] {
            if let Some(arms) = arms.get_mut(&at) {
                arms.push(arm);
            }
        }
    }
    arms
}

/// Cuts if the narrowest wedge between the arms is material, fills if it is empty.
fn remedy(arms: &[Arm]) -> Operation {
    let mut around = arms.to_vec();
    let heading = |arm: &Arm| (arm.direction.1 as f64).atan2(arm.direction.0 as f64);
    around.sort_by(|p, q| heading(p).total_cmp(&heading(q)));
    let wedge = |i: usize| {
        let ((x, y), (u, v)) = (around[i].direction, around[(i + 1) % around.len()].direction);
        let [x, y, u, v] = [x, y, u, v].map(|n| n as f64);
        // Products of grid coordinates are exact in f64, so wedges far narrower than the rounding of an angle compare
        // well.
        (x * v - y * u).atan2(x * u + y * v).rem_euclid(TAU)
    };
    let narrowest = (0..around.len()).min_by(|&i, &j| wedge(i).total_cmp(&wedge(j)));
    match narrowest {
        Some(i) if !around[i].starts => Operation::Fill,
        _ => Operation::Cut,
    }
}

/// A counter-clockwise diamond around `center` whose walls carry what the material at the centre carries.
pub(crate) fn diamond(center: GridPoint, radius: i64, near: SourceIndex, sources: &mut Vec<SourceEdge>) -> Contour {
    let carried = sources[near.0 as usize].at(center);
    let corner = |x: i64, y: i64| GridPoint::new(center.x + x * radius, center.y + y * radius);
    let corners = [corner(1, 0), corner(0, 1), corner(-1, 0), corner(0, -1)];
    (0..4)
        .map(|i| {
            let (a, b) = (corners[i], corners[(i + 1) % 4]);
            let source = SourceIndex(sources.len() as u32);
            sources.push(SourceEdge { a, b, carried: [carried; 2], slot: Slot::Inside });
            Edge { a, b, source }
        })
        .collect()
}
