//! What is around vertices of surfaces: the edges in the bins near them.

use super::nearing::Nearing;
use super::surface::Surface;
use fissure_plane::{Point, Vector};
use std::ops::Range;

/// A distance may be off by this part of it, from rounding.
const ROUND_OFF: f64 = 1e-9;

/// An edge where it is now.
#[derive(Debug, Clone, Copy, Default)]
struct Placed {
    middle: Point,
    /// All places within the reach of the edge are within this distance of its middle, squared [m²].
    reach_squared: f64,
}

/// What the edges of a bin have in common.
#[derive(Debug, Clone, Copy)]
struct Summary {
    /// Least and greatest displacement of their ends [m].
    displacements: (Vector, Vector),
    /// First and last body.
    bodies: (u32, u32),
    /// First and last piece.
    pieces: (u32, u32),
    /// Whether all lie on cracks.
    is_on_crack: bool,
}

impl Summary {
    fn of(surface: &Surface, place: &[Point], edge: u32) -> Self {
        let ends = [Some(edge), surface.next(edge)].into_iter().flatten();
        let of_end = |v: u32| {
            let vertex = surface.vertex(v);
            let moved = place[v as usize] - vertex.rest;
            let [bodies, pieces] = [vertex.body, vertex.piece].map(|number| (number, number));
            Self { displacements: (moved, moved), bodies, pieces, is_on_crack: vertex.is_on_crack }
        };
        ends.map(of_end).fold(of_end(edge), Self::with)
    }

    fn with(self, other: Self) -> Self {
        let ((low, high), (other_low, other_high)) = (self.displacements, other.displacements);
        let both = |own: (u32, u32), other: (u32, u32)| (own.0.min(other.0), own.1.max(other.1));
        Self {
            displacements: (low.inf(&other_low), high.sup(&other_high)),
            bodies: both(self.bodies, other.bodies),
            pieces: both(self.pieces, other.pieces),
            is_on_crack: self.is_on_crack && other.is_on_crack,
        }
    }
}

/// What is around the vertices of some bins.
pub(super) struct Surroundings<'a> {
    nearing: &'a Nearing,
    /// As [`Nearing::edges`] has them; only those around the bins that are looked at are right.
    placed: Vec<Placed>,
    /// Of each bin, the same.
    summaries: Vec<Option<Summary>>,
    /// What moves less than this relative to each other has moved alike [m]: within one piece, and otherwise.
    slides: [f64; 2],
    /// The bin that was asked for last.
    bin: Option<usize>,
    /// Where its edges and those of the bins beside it are.
    ranges: [Range<usize>; 3],
    is_calm: bool,
}

impl<'a> Surroundings<'a> {
    /// Looks at the edges of the bins that are `wanted`, for vertices at `place` [m]; others are not within `reach` [m]
    /// of what is asked for. `slides`: what moves less than this relative to each other has moved alike [m], within
    /// one piece and otherwise.
    pub(super) fn new(
        nearing: &'a Nearing,
        (surface, place): (&Surface, &[Point]),
        wanted: &[bool],
        reach: f64,
        slides: [f64; 2],
    ) -> Self {
        let mut placed = vec![Placed::default(); nearing.edges().len()];
        let mut summaries = vec![None; nearing.count()];
        for bin in (0..nearing.count()).filter(|&bin| wanted[bin]) {
            let range = nearing.range_of(bin..bin + 1);
            let edges = &nearing.edges()[range.clone()];
            for (placed, &edge) in placed[range].iter_mut().zip(edges) {
                let Some(next) = surface.next(edge) else { continue };
                let (from, to) = (place[edge as usize], place[next as usize]);
                let farthest = (reach + 0.5 * (to - from).norm()) * (1.0 + ROUND_OFF);
                *placed = Placed { middle: from + (to - from) * 0.5, reach_squared: farthest * farthest };
            }
            summaries[bin] = edges.iter().map(|&edge| Summary::of(surface, place, edge)).reduce(Summary::with);
        }
        Self { nearing, placed, summaries, slides, bin: None, ranges: [0..0, 0..0, 0..0], is_calm: true }
    }

    /// Goes to a vertex. Returns whether all edges within its reach are crack faces of one body that have moved alike.
    pub(super) fn are_calm_at(&mut self, vertex: u32) -> bool {
        let bin = self.nearing.bin_of(vertex);
        if self.bin != Some(bin) {
            self.bin = Some(bin);
            let bins = self.nearing.bins_around(bin);
            self.ranges = bins.clone().map(|bins| self.nearing.range_of(bins));
            let summaries = bins.into_iter().flat_map(|bins| &self.summaries[bins]).flatten();
            self.is_calm = summaries.copied().reduce(Summary::with).is_none_or(|all| {
                let (low, high) = all.displacements;
                let slide = self.slides[usize::from(all.pieces.0 != all.pieces.1)];
                all.is_on_crack && all.bodies.0 == all.bodies.1 && (high - low).norm() < slide
            });
        }
        self.is_calm
    }

    /// All edges within the reach of a place in the bin that was gone to, and some beyond it.
    pub(super) fn edges(&self, place: Point) -> impl Iterator<Item = u32> {
        let all = self.ranges.iter().flat_map(|range| range.clone().zip(&self.placed[range.clone()]));
        let near = all.filter(move |(_, p)| (p.middle - place).norm_squared() <= p.reach_squared);
        near.map(|(k, _)| self.nearing.edges()[k])
    }
}
