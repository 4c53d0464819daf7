//! The live tips of a drawing, and the way ahead of them.

use crate::material::elastic::Elastic;
use fissure_plane::{Point, Region, Vector, polyline_length};
use fissure_scene::{Crack, End, Scene};

/// A live tip of the drawing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DrawnTip<'s> {
    /// Index of its crack.
    pub(crate) index: usize,
    pub(crate) crack: &'s Crack,
    pub(crate) end: End,
}

impl<'s> DrawnTip<'s> {
    /// All live tips of a scene.
    pub(crate) fn all(scene: &'s Scene) -> impl Iterator<Item = Self> {
        scene.cracks.iter().enumerate().flat_map(|(index, crack)| {
            let live = [(End::Start, crack.start_live), (End::End, crack.end_live)];
            live.into_iter().filter(|&(_, live)| live).map(move |(end, _)| Self { index, crack, end })
        })
    }

    /// Where it is [m].
    pub(crate) fn place(&self) -> Point {
        self.along(0)
    }

    /// The direction ahead of it.
    pub(crate) fn ahead(&self) -> Vector {
        (self.along(0) - self.along(1)).try_normalize(0.0).unwrap_or_else(Vector::x)
    }

    /// The other end of the crack [m].
    pub(crate) fn other_end(&self) -> Point {
        self.along(self.crack.points.len().saturating_sub(1))
    }

    /// The point of the crack so many points behind the tip.
    fn along(&self, behind: usize) -> Point {
        let points = &self.crack.points;
        let last = points.len() - 1;
        points[match self.end {
            End::Start => behind.min(last),
            End::End => last - behind.min(last),
        }]
    }

    /// Whether a schedule moves it, whatever the load.
    pub(crate) fn is_scheduled(&self) -> bool {
        self.crack.guide(self.end).is_some_and(|guide| !guide.schedule.points.is_empty())
    }

    /// Way ahead of it to the end of its guide, or straight on to an outline or another crack [m].
    pub(crate) fn way(&self, scene: &Scene) -> f64 {
        match self.crack.guide(self.end).filter(|guide| guide.strength >= 1.0) {
            Some(guide) => polyline_length(&guide.points),
            None => self.free_way(scene, self.place(), self.ahead()),
        }
    }

    /// Way from `from` in the direction `toward` to an outline or another crack of its body [m].
    pub(crate) fn free_way(&self, scene: &Scene, from: Point, toward: Vector) -> f64 {
        let region = &scene.bodies[self.crack.body].region;
        let others = scene.cracks.iter().enumerate().filter(|(i, c)| *i != self.index && c.body == self.crack.body);
        let cracks = others.flat_map(|(_, c)| c.points.windows(2).map(|w| (w[0], w[1])));
        edges(region).chain(cracks).filter_map(|(a, b)| meeting(from, toward, a, b)).fold(f64::INFINITY, f64::min)
    }

    /// Highest speed it may ever have [m/s].
    pub(crate) fn speed_limit(&self, scene: &Scene, elastic: &[Elastic]) -> f64 {
        let material = scene.bodies[self.crack.body].material_at(self.place());
        let curve = &scene.growth.speed_curve.points;
        let most = if curve.is_empty() { 1.0 } else { curve.iter().map(|p| p.1).fold(0.0, f64::max) };
        let directed = scene.growth.speed_limit * most * elastic[material].rayleigh_wave_speed();
        scene.materials[material].limiting_speed.map_or(directed, |own| directed.min(own))
    }
}

fn edges(region: &Region) -> impl Iterator<Item = (Point, Point)> {
    region.rings().flat_map(|ring| (0..ring.len()).map(|i| (ring[i], ring[(i + 1) % ring.len()])))
}

/// Distance along a ray to a segment [m]; none where they do not meet, and where the ray begins on it.
fn meeting(from: Point, toward: Vector, a: Point, b: Point) -> Option<f64> {
    let (along, to) = (b - a, a - from);
    let turn = toward.perp(&along);
    let (distance, part) = (to.perp(&along) / turn, to.perp(&toward) / turn);
    let begins = 1e-9 * along.norm();
    (distance > begins && (0.0..=1.0).contains(&part)).then_some(distance)
}
