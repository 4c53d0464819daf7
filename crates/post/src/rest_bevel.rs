//! Bevelled edges of what is cut at rest: triangles are made at rest within the strips, and carried with them.
//!
//! ```text
//!     at rest      ┌────┬─────┐ walls           now   ╱────┬─────╲
//!                  │ ╲──┴──╱  │ strips                ╲ ╲──┴──╱  ╲
//!                  │  ╲ ╱╲ ╱  │ triangles              ╲ ╲ ╱╲ ╱   ╲
//! ```
//! Where the frame leaves no room for them strips are narrower.

use crate::bevel::{BevelCorner, LOST, NARROWED, areas};
use crate::boolean::{Edge, Shape, SourceIndex};
use crate::carrying::Carrying;
use crate::extrude::Extrusion;
use crate::interior::Interior;
use crate::rest_cut::{Divided, RestDivision, between, divided};
use crate::slot::Slot;
use crate::snap::{Grid, GridPoint};
use crate::source::{Carried, SourceEdge};
use crate::triangulate::Cap;
use crate::untangled::folded;
use fissure_scene::{Point, Vector};

/// Times that corners within are carried anew, at most, where strips have become narrower.
const PASSES: usize = 3;

/// A cap within bevels, moved with the material.
pub(crate) struct RestBevel {
    /// The cap with the boundary as it is without bevels.
    pub(crate) cap: Cap,
    /// Where its corners on the boundary go.
    pub(crate) corners: Vec<BevelCorner>,
    /// What the corners within carry.
    pub(crate) within: Vec<Carried>,
    /// Where the edges of `cap` come from, in their order.
    pub(crate) sources: Vec<SourceEdge>,
}

/// A corner of a boundary: one that was there, or a new one on the way to the next.
struct Corner {
    /// The two that were there.
    ends: [usize; 2],
    /// How far between them.
    part: f64,
    /// What the wall after it carries, there and where that ends.
    carried: [Carried; 2],
    slot: Slot,
    /// Where the wall is.
    outer: GridPoint,
}

impl Corner {
    /// What is given at both ends, here.
    fn between<T: Copy>(&self, at: impl Fn(usize) -> T, way: impl Fn(T, T, f64) -> T) -> T {
        let [p, q] = self.ends;
        if self.part == 0.0 { at(p) } else { way(at(p), at(q), self.part) }
    }

    /// How wide strips are here.
    fn width(&self, widths: &[f64]) -> f64 {
        self.between(|k| widths[k], |p, q, part| p + part * (q - p))
    }
}

impl Extrusion<'_> {
    /// `cap`, which was made at rest, with triangles within its bevels. `at_rest`: where its corners on the boundary go
    /// at rest, on `rest_grid`. The sources are to be `first` and those after it of their object. None where nothing is
    /// bevelled.
    pub(crate) fn rest_bevel(
        &self,
        cap: &Cap,
        at_rest: &[BevelCorner],
        first: usize,
        division: RestDivision,
        rest_grid: Grid,
        (interior, piece): (&Interior<'_>, u32),
    ) -> Option<RestBevel> {
        if at_rest.iter().all(|corner| corner.drop == 0.0) {
            return None;
        }
        let mut bevels = at_rest.iter();
        let line = |contour: &Vec<Edge>| {
            let place = |(edge, corner): (&Edge, &BevelCorner)| match corner.drop {
                0.0 => self.source(edge).carried[0].rest,
                _ => rest_grid.place(corner.point),
            };
            contour.iter().zip(&mut bevels).map(place).collect()
        };
        let lines: Vec<Vec<Point>> = cap.shape.iter().map(line).collect();
        let mut found = divided(&lines, division, rest_grid)?;
        if self.has_new_beside_tips(cap, &found.new) {
            found = divided(&lines, RestDivision { keeps_edges: true, ..division }, rest_grid)?;
        }
        let Divided { new, within, triangles } = found;
        let (corners, mut places) = self.rest_bevel_corners(cap, &lines, &new);
        places.extend(&within);
        let mut widths: Vec<f64> = at_rest.iter().map(|corner| corner.drop / self.grid.step).collect();
        let (_, mut ways) = self.widths(cap);
        let starts: Vec<GridPoint> = cap.shape.iter().flatten().map(|edge| edge.a).collect();
        let outer: Vec<GridPoint> = corners.iter().map(|corner| corner.outer).collect();
        let mut shape = outer_shape(cap, &corners, &outer, first);
        let speeds: Vec<Vector> = corners.iter().map(|corner| corner.carried[0].velocity).collect();
        let carrying = Carrying { interior, grid: self.grid, piece, places: &places, triangles: &triangles };
        let mut shown = shown_at(&corners, &starts, &widths, &ways);
        let mut carried = carrying.corners(&shown, &speeds, false);
        for _ in 0..PASSES {
            let mut narrows = false;
            loop {
                carried.now[..corners.len()].copy_from_slice(&shown);
                let cramped = cramped(&shape, &corners, &widths, &shown, &folded(&carried.now, &triangles), &triangles);
                let to_narrow =
                    (0..widths.len()).filter(|&k| cramped[k] && widths[k] > 0.0 && ways[k] != Vector::zeros());
                let to_narrow: Vec<usize> = to_narrow.collect();
                if to_narrow.is_empty() {
                    break;
                }
                narrows = true;
                // What is hardly wide stands upright; what is folded then is so without strips.
                for k in to_narrow {
                    if NARROWED * widths[k] < LOST {
                        ways[k] = Vector::zeros();
                    } else {
                        widths[k] *= NARROWED;
                    }
                }
                shown = shown_at(&corners, &starts, &widths, &ways);
            }
            if !narrows {
                break;
            }
            carried = carrying.corners(&shown, &speeds, false);
        }
        let bad = folded(&carried.now, &triangles).len();
        if bad > 0 {
            // Corners that have turned over follow their own particles, with the wall below them.
            let unfolded = carrying.corners(&shown, &speeds, true);
            let left = folded(&unfolded.now, &triangles);
            let moved = |(k, corner): (usize, &Corner)| {
                let (to, from, Corner { outer, .. }) = (unfolded.now[k], shown[k], corner);
                GridPoint::new(outer.x + to.x - from.x, outer.y + to.y - from.y)
            };
            let outer: Vec<GridPoint> = corners.iter().enumerate().map(moved).collect();
            let moved = outer_shape(cap, &corners, &outer, first);
            let no_room = cramped(&moved, &corners, &widths, &unfolded.now, &[], &triangles);
            if left.len() < bad && !no_room.contains(&true) {
                shape = moved;
                shown.copy_from_slice(&unfolded.now[..corners.len()]);
                carried = unfolded;
            }
        }
        let corner = |(k, corner): (usize, &Corner)| {
            let rest = corner.between(|k| at_rest[k].drop, |p, q, part| p + part * (q - p));
            let drop = corner.width(&widths) * self.grid.step;
            let part = if rest == 0.0 { 0.0 } else { drop / rest };
            BevelCorner { point: shown[k], at_rest: part * (places[k] - corner.carried[0].rest), drop }
        };
        let velocities = &carried.velocities;
        Some(RestBevel {
            corners: corners.iter().enumerate().map(corner).collect(),
            within: (corners.len()..places.len()).map(|k| Carried::within(places[k], velocities[k])).collect(),
            sources: sources(&shape, &corners),
            cap: Cap { shape, within: carried.now[corners.len()..].to_vec(), triangles },
        })
    }

    /// Whether there are `new` corners in edges that end at the tip of a crack. Its faces are kept apart at the corners
    /// that were there, and lie nearer to each other between the tip and the first of these.
    fn has_new_beside_tips(&self, cap: &Cap, new: &[Vec<Vec<Point>>]) -> bool {
        cap.shape.iter().zip(new).any(|(contour, new)| {
            (0..contour.len()).any(|i| {
                let before = (i + contour.len() - 1) % contour.len();
                let [start, end] = [self.source(&contour[before]).carried[0], self.source(&contour[i]).carried[1]];
                start.rest == end.rest && !(new[before].is_empty() && new[i].is_empty())
            })
        })
    }

    /// The corners on the boundary, contour after contour, and where those within strips are at rest [m], when `lines`
    /// have `new` ones in their edges.
    fn rest_bevel_corners(
        &self,
        cap: &Cap,
        lines: &[Vec<Point>],
        new: &[Vec<Vec<Point>>],
    ) -> (Vec<Corner>, Vec<Point>) {
        let (mut corners, mut places) = (Vec::new(), Vec::new());
        let mut first = 0;
        for ((contour, line), new) in cap.shape.iter().zip(lines).zip(new) {
            for (i, (edge, new)) in contour.iter().zip(new).enumerate() {
                let next = (i + 1) % contour.len();
                let (source, [start, end]) = (self.source(edge), [line[i], line[next]]);
                let part = |rest: &Point| (rest - start).norm() / (end - start).norm();
                let parts: Vec<f64> = std::iter::once(0.0).chain(new.iter().map(part)).chain([1.0]).collect();
                let carried = |part: f64| match part {
                    0.0 => source.carried[0],
                    1.0 => source.carried[1],
                    _ => source.carried[0].between(&source.carried[1], part),
                };
                for (pair, rest) in parts.windows(2).zip(std::iter::once(&start).chain(new)) {
                    let outer = if pair[0] == 0.0 { edge.a } else { between(edge, pair[0]) };
                    corners.push(Corner {
                        ends: [first + i, first + next],
                        part: pair[0],
                        carried: [carried(pair[0]), carried(pair[1])],
                        slot: source.slot,
                        outer,
                    });
                    places.push(*rest);
                }
            }
            first += contour.len();
        }
        (corners, places)
    }
}

/// Where the cap has its corners on the boundary when those that were there move so many `widths` along their `ways`,
/// in grid steps from where they `start`.
fn shown_at(corners: &[Corner], starts: &[GridPoint], widths: &[f64], ways: &[Vector]) -> Vec<GridPoint> {
    let place = |k: usize| Vector::new(starts[k].x as f64, starts[k].y as f64) + widths[k] * ways[k];
    let shown = |corner: &Corner| {
        if corner.width(widths) == 0.0 {
            return corner.outer;
        }
        let place = corner.between(place, |p, q, part| p + part * (q - p));
        GridPoint::new(place.x.round() as i64, place.y.round() as i64)
    };
    corners.iter().map(shown).collect()
}

/// Which corners that were there have strips without room beside them: strips or triangles that are `folded`.
fn cramped(
    shape: &Shape,
    corners: &[Corner],
    widths: &[f64],
    shown: &[GridPoint],
    folded: &[usize],
    triangles: &[[u32; 3]],
) -> Vec<bool> {
    let mut is_cramped = vec![false; widths.len()];
    let mut mark = |k: usize| corners[k].ends.into_iter().for_each(|end| is_cramped[end] = true);
    let mut begin = 0;
    for contour in shape {
        for (i, edge) in contour.iter().enumerate() {
            let [p, q] = [begin + i, begin + (i + 1) % contour.len()];
            let [over_both, over_start] = areas(edge, shown[p], shown[q]);
            let is_wide = [p, q].map(|k| corners[k].width(widths) > 0.0);
            if (is_wide[1] && over_both <= 0.0) || (is_wide[0] && over_start <= 0.0) {
                [p, q].into_iter().for_each(&mut mark);
            }
        }
        begin += contour.len();
    }
    let of_folded = folded.iter().flat_map(|&k| triangles[k]).map(|k| k as usize);
    of_folded.filter(|&k| k < corners.len()).for_each(mark);
    is_cramped
}

/// The boundary of `cap` through all `corners`, which are `outer`; each edge has a source of its own, from `first` on.
fn outer_shape(cap: &Cap, corners: &[Corner], outer: &[GridPoint], first: usize) -> Shape {
    let (mut shape, mut begin, mut end) = (Shape::with_capacity(cap.shape.len()), 0, 0);
    for contour in &cap.shape {
        end += contour.len();
        let length = corners[begin..].iter().take_while(|corner| corner.ends[0] < end).count();
        let edge = |i: usize| Edge {
            a: outer[begin + i],
            b: outer[begin + (i + 1) % length],
            source: SourceIndex((first + begin + i) as u32),
        };
        shape.push((0..length).map(edge).collect());
        begin += length;
    }
    shape
}

/// Where the edges of `shape` come from, whose corners are `corners`.
fn sources(shape: &Shape, corners: &[Corner]) -> Vec<SourceEdge> {
    let (mut sources, mut begin) = (Vec::with_capacity(corners.len()), 0);
    for contour in shape {
        for (i, edge) in contour.iter().enumerate() {
            let Corner { carried, slot, .. } = corners[begin + i];
            sources.push(SourceEdge { a: edge.a, b: edge.b, carried, slot });
        }
        begin += contour.len();
    }
    sources
}
