//! Edges of bodies as chains with hats along them: what supports hold is means of the velocity, weighted with hats.

use super::selector::Selector;
use crate::grid::coverage::cuts;
use fissure_plane::{Point, Vector};
use fissure_scene::{OutlineStretch, Scene, Selection};

/// The edges that a selection holds: those that it names, or that lie in its region.
pub(crate) fn edges_of(scene: &Scene, selection: &Selection) -> Vec<Chain> {
    let selector = Selector::new(scene, selection);
    let stretches = match selector {
        Selector::Side(_) | Selector::Outline(_) | Selector::Region { .. } => selector.parts(scene),
        Selector::All | Selector::Bodies(_) | Selector::Near { .. } => Vec::new(),
    };
    Chain::of(scene, &stretches)
}

/// A weighted mean of the velocity along an edge: (field, weight); weights add up to 1.
pub(crate) type EdgeMean = Vec<(u32, f64)>;

/// Of the length of an edge.
const ROUND_OFF: f64 = 1e-9;

/// Stretches of an outline that follow on each other.
#[derive(Debug, Clone)]
pub(crate) struct Chain {
    pub(crate) body: usize,
    /// Its corners, both ends included [m].
    pub(crate) points: Vec<Point>,
    /// Length of the way to each corner [m].
    pub(crate) way: Vec<f64>,
    pub(crate) is_closed: bool,
    /// Whether other material of the body lies beyond its start and its end.
    pub(crate) goes_on: [bool; 2],
}

/// The place of a chain that is nearest to another place.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OnChain {
    /// How far away the other place is [m].
    pub(crate) distance: f64,
    /// Length of the way to it [m].
    pub(crate) way: f64,
    /// Itself [m].
    pub(crate) place: Point,
    /// Whether it is an end of the chain, beyond which the other place lies.
    pub(crate) is_beyond: bool,
}

/// A place of Gauss' rule along a chain.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgePlace {
    /// At rest [m].
    pub(crate) place: Point,
    /// A hair into the material [m].
    pub(crate) inside: Vector,
    /// The hats that are not zero there: the index of each, with its value times the length that the place stands for
    /// [m].
    pub(crate) hats: [(usize, f64); 2],
}

impl Chain {
    /// The chains that `stretches` make.
    pub(crate) fn of(scene: &Scene, stretches: &[OutlineStretch]) -> Vec<Self> {
        let mut chains: Vec<Self> = Vec::new();
        let mut left: Vec<&OutlineStretch> = stretches.iter().filter(|s| s.from != s.to).collect();
        while !left.is_empty() {
            let first = left.remove(0);
            let mut chain = Self {
                body: first.body,
                points: vec![first.from, first.to],
                way: vec![0.0],
                is_closed: false,
                goes_on: [false; 2],
            };
            let mut take = |matches: &dyn Fn(&OutlineStretch) -> bool| {
                left.iter().position(|s| s.body == first.body && matches(s)).map(|index| left.remove(index))
            };
            while let Some(next) = take(&|s| s.from == chain.points[chain.points.len() - 1]) {
                chain.points.push(next.to);
            }
            while let Some(before) = take(&|s| s.to == chain.points[0]) {
                chain.points.insert(0, before.from);
            }
            chain.is_closed = chain.points[0] == chain.points[chain.points.len() - 1];
            chain.goes_on = chain.looked_beyond(scene);
            chain.way.extend(chain.points.windows(2).scan(0.0, |sum, p| {
                *sum += (p[1] - p[0]).norm();
                Some(*sum)
            }));
            chains.push(chain);
        }
        chains
    }

    fn looked_beyond(&self, scene: &Scene) -> [bool; 2] {
        let p = &self.points;
        let last = p.len() - 1;
        [(p[0], p[0] - p[1], -1.0), (p[last], p[last] - p[last - 1], 1.0)].map(|(end, way, sign)| {
            let ahead = way.normalize() * (0.25 * scene.cell_size);
            let inside = Vector::new(-ahead.y, ahead.x) * sign;
            scene.bodies[self.body].region.contains(end + ahead + inside)
        })
    }

    /// Whether it comes within a box from `low` to `high` [m].
    pub(crate) fn meets(&self, low: Point, high: Point) -> bool {
        self.points.windows(2).any(|p| p[0].sup(&p[1]) >= low && p[0].inf(&p[1]) <= high)
    }

    /// Length of the whole way [m].
    pub(crate) fn length(&self) -> f64 {
        self.way[self.way.len() - 1]
    }

    /// The place at a length of the way [m].
    pub(crate) fn place(&self, way: f64) -> Point {
        let k = (self.way.partition_point(|&corner| corner <= way).max(1) - 1).min(self.way.len() - 2);
        let [a, b] = [self.points[k], self.points[k + 1]];
        a + (b - a) * ((way - self.way[k]) / (self.way[k + 1] - self.way[k]))
    }

    /// From the edge that begins at a corner a hair into the material [m].
    pub(crate) fn inside(&self, k: usize, cell_size: f64) -> Vector {
        let [from, to] = [self.points[k], self.points[k + 1]];
        let length = self.way[k + 1] - self.way[k];
        Vector::new(from.y - to.y, to.x - from.x) * (1e-6 * cell_size / length)
    }

    /// Places along all of it for hats with these `knots` [m], two in each piece within one cell and between two knots.
    /// Cells are counted from `origin`.
    pub(crate) fn places(&self, knots: &[f64], origin: Point, cell_size: f64) -> Vec<EdgePlace> {
        let mut places = Vec::new();
        for (k, way) in self.way.windows(2).enumerate() {
            let [from, to] = [self.points[k], self.points[k + 1]];
            let [a, b] = [from, to].map(|p| (p - origin) / cell_size);
            let length = way[1] - way[0];
            let mut cuts = cuts(a, b);
            cuts.extend(knots.iter().map(|knot| (knot - way[0]) / length).filter(|t| *t > 0.0 && *t < 1.0));
            cuts.sort_unstable_by(f64::total_cmp);
            let inside = self.inside(k, cell_size);
            for cut in cuts.windows(2).filter(|cut| cut[1] - cut[0] > 1e-9) {
                // Gauss' rule of two points: hats are linear on a piece, weights of nodes at most quadratic.
                let (middle, half) = (0.5 * (cut[0] + cut[1]), 0.5 * (cut[1] - cut[0]));
                for t in [middle - half / 3.0_f64.sqrt(), middle + half / 3.0_f64.sqrt()] {
                    let hats = self.hats(knots, way[0] + length * t).map(|(knot, hat)| (knot, hat * half * length));
                    places.push(EdgePlace { place: from + (to - from) * t, inside, hats });
                }
            }
        }
        places
    }

    /// The place of edge number `k` that is nearest to `point`.
    pub(crate) fn nearest_on(&self, k: usize, point: Point) -> OnChain {
        let [from, to] = [self.points[k], self.points[k + 1]];
        let along = to - from;
        let part = (point - from).dot(&along) / along.norm_squared();
        let held = part.clamp(0.0, 1.0);
        let place = from + along * held;
        let is_last = k + 2 == self.points.len();
        OnChain {
            distance: (point - place).norm(),
            way: self.way[k] + held * (self.way[k + 1] - self.way[k]),
            place,
            is_beyond: !self.is_closed && ((k == 0 && part < -ROUND_OFF) || (is_last && part > 1.0 + ROUND_OFF)),
        }
    }

    /// The hats that are not zero at a place on the way: the index of each with its value.
    pub(crate) fn hats(&self, knots: &[f64], at: f64) -> [(usize, f64); 2] {
        let last = knots.len() - 1;
        let after = knots.partition_point(|&knot| knot <= at);
        let (before, next, gap, run) = match (after, self.is_closed) {
            (0, false) => return [(0, 1.0), (0, 0.0)],
            (0, true) => (last, 0, knots[0] + self.length() - knots[last], at + self.length() - knots[last]),
            (k, false) if k > last => return [(last, 1.0), (last, 0.0)],
            (k, true) if k > last => (last, 0, knots[0] + self.length() - knots[last], at - knots[last]),
            (k, _) => (k - 1, k, knots[k] - knots[k - 1], at - knots[k - 1]),
        };
        [(before, 1.0 - run / gap), (next, run / gap)]
    }
}
