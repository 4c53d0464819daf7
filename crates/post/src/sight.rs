//! Which particles lie on one side of all cracks and outlines with a place at rest.
//!
//! What lies next to a crack moves as the particles on its own side do, however near those on the other side are: with
//! the crack open they may be anywhere. The paths of cracks are smoothed for output, so that a particle may come to lie
//! on the other side of one; those between the path and the smooth path tell nothing of either side.

use crate::smooth::SmoothCracks;
use fissure_plane::orientation;
use fissure_scene::{Frame, Point};
use rustc_hash::FxHashMap;

/// The lines of a body at rest.
#[derive(Debug)]
pub(crate) struct Sight {
    /// Width of a bin [m].
    width: f64,
    /// Segments of outlines and smooth paths, by the bins that they are in.
    segments: FxHashMap<[i32; 2], Vec<[Point; 2]>>,
    /// What lies between segments of paths and those of smooth paths.
    strips: FxHashMap<[i32; 2], Vec<[Point; 4]>>,
}

impl Sight {
    /// The outlines of `body` in `frame` and its `cracks`, in bins of some `width` [m].
    pub(crate) fn new(frame: &Frame, body: u32, cracks: &SmoothCracks<'_>, width: f64) -> Self {
        let mut sight = Self { width, segments: FxHashMap::default(), strips: FxHashMap::default() };
        for outline in frame.outlines.iter().filter(|outline| outline.body == body) {
            let rest = &outline.rest;
            rest.iter().zip(rest.iter().cycle().skip(1)).for_each(|(&a, &b)| sight.add([a, b]));
        }
        let of_body = cracks.cracks.iter().zip(&cracks.offsets).filter(|(crack, _)| crack.body == body);
        for (crack, offsets) in of_body {
            for k in 1..crack.rest.len() {
                let [a, b] = [k - 1, k].map(|k| crack.rest[k]);
                let [p, q] = [a + offsets[k - 1], b + offsets[k]];
                sight.add([p, q]);
                if p != a || q != b {
                    let strip = [a, b, q, p];
                    for bin in bins(&strip, width) {
                        sight.strips.entry(bin).or_default().push(strip);
                    }
                }
            }
        }
        sight
    }

    fn add(&mut self, [a, b]: [Point; 2]) {
        // Piece by piece, so that a long segment is not in all bins of the box around it.
        let count = ((b - a).norm() / self.width).ceil().max(1.0);
        let place = |k: f64| a + (b - a) * (k / count);
        for k in 0..count as u64 {
            for bin in bins(&[place(k as f64), place(k as f64 + 1.0)], self.width) {
                self.segments.entry(bin).or_default().push([a, b]);
            }
        }
    }

    /// Whether a particle at rest at `particle` tells how the material moves that is at `place`.
    pub(crate) fn reaches(&self, place: Point, particle: Point) -> bool {
        let near = |bin: [i32; 2]| self.segments.get(&bin).into_iter().flatten();
        let way = [place, particle];
        let is_hidden = || bins(&way, self.width).flat_map(near).any(|&wall| cross(way, wall));
        let mut strips = bins(&[particle], self.width).flat_map(|bin| self.strips.get(&bin).into_iter().flatten());
        !strips.any(|strip| contains(strip, particle)) && !is_hidden()
    }
}

/// The bins that the box around `points` is in.
fn bins(points: &[Point], width: f64) -> impl Iterator<Item = [i32; 2]> + use<> {
    let (low, high) = fissure_plane::bounds(points);
    let [low, high] = [low, high].map(|p| [p.x, p.y].map(|x| (x / width).floor() as i32));
    (low[0]..=high[0]).flat_map(move |column| (low[1]..=high[1]).map(move |row| [column, row]))
}

/// Whether the way from `a` to `b` leads across a wall from `c` to `d` or through one of its ends.
fn cross([a, b]: [Point; 2], [c, d]: [Point; 2]) -> bool {
    orientation(c, d, a) * orientation(c, d, b) < 0.0 && orientation(a, b, c) * orientation(a, b, d) <= 0.0
}

/// Whether a point lies in a quadrilateral, which may cross itself.
fn contains(strip: &[Point; 4], point: Point) -> bool {
    let sides = (0..4).map(|k| [strip[k], strip[(k + 1) % 4]]);
    sides.filter(|[a, b]| fissure_plane::is_left_of(*a, *b, point)).count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use fissure_scene::{CrackFrame, OutlineFrame, Vector};
    use std::borrow::Cow;

    /// Truth: the drawing. A square with a crack along y = 1 up to x = 1, bent for output to y = 1.2 in its middle.
    #[test]
    fn only_what_is_on_the_same_side_is_reached() {
        let rest = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)].map(|(x, y)| Point::new(x, y)).to_vec();
        let frame = Frame { outlines: vec![OutlineFrame { rest, ..OutlineFrame::default() }], ..Frame::default() };
        let rest = vec![Point::new(0.0, 1.0), Point::new(0.5, 1.0), Point::new(1.0, 1.0)];
        let bend = |height: f64| vec![Vector::zeros(), Vector::new(0.0, height), Vector::zeros()];
        for width in [0.07, 0.3, 5.0] {
            let sight = |height: f64| {
                let crack = CrackFrame { rest: rest.clone(), ..CrackFrame::default() };
                let cracks = SmoothCracks { cracks: Cow::Owned(vec![crack]), offsets: vec![bend(height)] };
                Sight::new(&frame, 0, &cracks, width)
            };
            let reaches = |sight: &Sight, from: (f64, f64), to: (f64, f64)| {
                sight.reaches(Point::new(from.0, from.1), Point::new(to.0, to.1))
            };
            let straight = sight(0.0);
            assert!(!reaches(&straight, (0.5, 0.9), (0.5, 1.1)) && !reaches(&straight, (0.4, 1.1), (0.6, 0.9)));
            assert!(reaches(&straight, (0.5, 1.05), (0.4, 1.1)) && reaches(&straight, (1.2, 0.9), (1.2, 1.1)));
            assert!(!reaches(&straight, (1.9, 1.5), (2.1, 1.5)), "beyond the outline");
            // Between y = 1 and 1.2 lie particles of the upper side, now below the path.
            let bent = sight(0.2);
            assert!(!reaches(&bent, (0.5, 0.9), (0.5, 1.1)) && !reaches(&bent, (0.5, 1.3), (0.5, 1.1)));
            assert!(reaches(&bent, (0.5, 1.1), (0.5, 0.9)) && reaches(&bent, (0.5, 1.3), (0.6, 1.25)));
        }
    }
}
