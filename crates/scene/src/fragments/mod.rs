//! The parts that cracks cut bodies into, with the boundary of each, at rest.
//!
//! Rings and cracks are lines with material beside them: a ring on its left, a crack on both sides. They meet in
//! vertices: at the corners that they share, where a crack ends on a ring or on another crack, and where cracks cross.
//! Walking with the material on the left, and at each vertex into the next line on that side, one comes back to where
//! one began: that is a boundary. Those that run counter-clockwise bound a fragment from outside; the others, and
//! cracks that are on their own, lie within one.
//!
//! So a fragment is what lines close off on all sides, however narrow what holds it may be before, and which edges
//! bound it does not depend on how far its faces have moved.

mod lines;
mod walk;

use crate::frame::{CrackEnd, CrackFrame, Frame, ParticleFrame};
use fissure_plane::{Point, RingRows};
use lines::Lines;
use std::cmp::Reverse;
use std::collections::BTreeMap;

/// A line that bounds material, seen with the material on its left. Lines are known by their place in the lists that
/// [`Fragments::new`] was given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Line {
    /// A ring.
    Ring(usize),
    /// The face above a crack, from its start to its end.
    Above(usize),
    /// The face below a crack, from its end to its start.
    Below(usize),
}

/// An edge of a boundary: a segment of a line, or the part of one between two vertices on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundaryEdge {
    /// What it is an edge of.
    pub line: Line,
    /// The two points of the line that its segment joins, in the direction of the walk.
    pub points: [usize; 2],
    /// Where on the segment it begins and ends: 0 is the first of the two points, 1 the second.
    pub span: [f64; 2],
    /// Its ends at rest [m].
    pub rest: [Point; 2],
}

/// A closed walk along edges with the material on the left.
pub type Boundary = Vec<BoundaryEdge>;

/// A part of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Fragment {
    /// Index of the body.
    pub body: u32,
    /// Its boundaries: the first from outside, counter-clockwise, the others of holes and of cracks in it.
    pub boundaries: Vec<Boundary>,
}

/// A ring at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RestRing<'a> {
    /// Index of the body.
    pub body: u32,
    /// Its points [m], open, the material on the left.
    pub points: &'a [Point],
}

/// A crack at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RestCrack<'a> {
    /// Index of the crack, by which others name it.
    pub crack: u32,
    /// Index of the body.
    pub body: u32,
    /// Its points from start to end [m].
    pub points: &'a [Point],
    /// What its first and its last point are.
    pub ends: [CrackEnd; 2],
}

impl<'a> From<&'a CrackFrame> for RestCrack<'a> {
    fn from(crack: &'a CrackFrame) -> Self {
        Self { crack: crack.crack, body: crack.body, points: &crack.rest, ends: [crack.start, crack.end] }
    }
}

/// All fragments of all bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct Fragments {
    list: Vec<Fragment>,
    /// What the outer boundary of each contains.
    insides: Vec<RingRows>,
    /// The fragments of each body, the smallest first.
    of_body: BTreeMap<u32, Vec<usize>>,
}

impl Fragments {
    /// The fragments of bodies with these rings and cracks, all numbers finite: body by body, each in the order of its
    /// first edge.
    ///
    /// A crack that says that it ends on a ring or a crack that does not pass there is led to the nearest place of it;
    /// one that ends on a crack that is not among `cracks` ends in the material.
    pub fn new(rings: &[RestRing<'_>], cracks: &[RestCrack<'_>]) -> Self {
        let (list, insides) = walk::fragments(&Lines::new(rings, cracks));
        let mut of_body = BTreeMap::<u32, Vec<usize>>::new();
        for (i, fragment) in list.iter().enumerate() {
            of_body.entry(fragment.body).or_default().push(i);
        }
        of_body.values_mut().for_each(|own| own.sort_by(|&i, &j| insides[i].1.total_cmp(&insides[j].1)));
        Self { list, insides: insides.into_iter().map(|(rows, _)| rows).collect(), of_body }
    }

    /// The fragments of a frame; lines are known by their place in its lists.
    pub fn of_frame(frame: &Frame) -> Self {
        let rings: Vec<RestRing<'_>> =
            frame.outlines.iter().map(|o| RestRing { body: o.body, points: &o.rest }).collect();
        let cracks: Vec<RestCrack<'_>> = frame.cracks.iter().map(RestCrack::from).collect();
        Self::new(&rings, &cracks)
    }

    /// The fragments.
    pub fn list(&self) -> &[Fragment] {
        &self.list
    }

    /// The fragment of `body` that holds `place` at rest: of several around it, the smallest. A place on a crack
    /// belongs to one side of it.
    pub fn at(&self, body: u32, place: Point) -> Option<usize> {
        match self.of_body.get(&body)?.as_slice() {
            &[only] => Some(only),
            own => own.iter().copied().find(|&i| self.insides[i].contains(place)),
        }
    }

    /// The number of each fragment in the simulation: that of most of the particles in it at rest, of equally many the
    /// lowest; none where there is no particle.
    pub fn numbers(&self, particles: &ParticleFrame) -> Vec<Option<u32>> {
        let mut votes = vec![BTreeMap::<u32, usize>::new(); self.list.len()];
        for p in 0..particles.len() {
            if let Some(fragment) = self.at(particles.body[p], particles.rest[p]) {
                *votes[fragment].entry(particles.piece[p]).or_default() += 1;
            }
        }
        let winner = |votes: BTreeMap<u32, usize>| {
            votes.into_iter().max_by_key(|&(piece, count)| (count, Reverse(piece))).map(|(piece, _)| piece)
        };
        votes.into_iter().map(winner).collect()
    }
}

/// What a boundary contains, and its area [m²].
fn inside(boundary: &[BoundaryEdge]) -> (RingRows, f64) {
    let ring: Vec<Point> = boundary.iter().map(|edge| edge.rest[0]).collect();
    (RingRows::new([ring.as_slice()]), fissure_plane::signed_area(&ring))
}

#[cfg(test)]
mod tests;
