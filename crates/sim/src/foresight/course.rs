//! How far tips have to go, and how far they may come.

use super::toughness;
use crate::boundary::collider::Obstacle;
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

/// Part of the way ahead that tips make where there are so many cracks that they end on each other's new parts.
const SHARED_WAY: f64 = 0.5;
/// So many live tips in a scene share their ways.
const MANY_TIPS: usize = 16;
/// Looks at a tip that nothing loads yet, as a part of those at one that something does.
const IDLE_LOOKS: f64 = 0.4;
/// A tip is live for so many times as long as the crossing of its way takes: it waits for its load as well.
const LIVE_CROSSINGS: f64 = 2.0;
/// Mean speed of a running tip as a part of its limit.
const MEAN_SPEED: f64 = 0.8;

/// What cracks are expected to do over all frames, roughly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Course {
    /// Length by which they grow [m].
    pub(crate) growth: f64,
    /// How long their tips are looked at, all together [s]: one that has come to the end of its way no longer is, one
    /// that nothing loads seldom.
    pub(crate) watched: f64,
}

impl Course {
    /// The course of the cracks of `scene`.
    pub(crate) fn of(scene: &Scene, elastic: &[Elastic]) -> Self {
        let end = scene.frames.time(scene.frames.last);
        let tips: Vec<DrawnTip<'_>> = DrawnTip::all(scene).collect();
        let mut course = Self { growth: 0.0, watched: end * tips.len() as f64 };
        if !scene.growth.enabled {
            return course;
        }
        let reached = toughness::greatest_loads(scene, elastic);
        let contact = first_contact(scene, end);
        let running = (end - contact).max(0.0);
        course.watched -= (1.0 - IDLE_LOOKS) * contact * tips.len() as f64;
        let part = if tips.len() >= MANY_TIPS { SHARED_WAY } else { 1.0 };
        // Supports that move open cracks as slowly as they move.
        let is_slow = scene.loads.is_empty() && !scene.supports.is_empty();
        for tip in &tips {
            let moves = tip.is_scheduled() || reached.get(tip.index).is_none_or(|&load| load >= 1.0);
            let speed = MEAN_SPEED * tip.speed_limit(scene, elastic);
            let way = part * tip.way(scene);
            if !moves || !way.is_finite() {
                continue;
            }
            course.growth += way.min(speed * running);
            if !tip.is_scheduled() && !is_slow && speed > 0.0 {
                course.watched -= (running - LIVE_CROSSINGS * running.min(way / speed)).max(0.0);
            }
        }
        course
    }
}

/// When something first acts on a crack [s]: at once, unless the bodies have to fall or fly onto a collider first.
fn first_contact(scene: &Scene, end: f64) -> f64 {
    const TIMES: u32 = 256;
    if scene.colliders.is_empty() || !scene.loads.is_empty() || !scene.supports.is_empty() {
        return 0.0;
    }
    let closest = |body: &fissure_scene::Body, time: f64| {
        let v: Vector = body.velocities.iter().map(|v| v.velocity).sum();
        let moved = v * time + scene.gravity * (0.5 * time * time);
        let distance = |collider: &fissure_scene::Collider| {
            let obstacle = Obstacle::new(collider);
            let placed = obstacle.at(time);
            let corners = body.region.exterior.iter().map(|p| placed.surface(p + moved).distance);
            let center =
                Region { exterior: body.region.exterior.iter().map(|p| p + moved).collect(), holes: Vec::new() };
            let at = placed.pose().position;
            let around = if center.contains(at) { 0.0 } else { f64::INFINITY };
            let near = center.distance_to_rings(at);
            // A disc smaller than the edges of the outline is near their middles.
            let disc = match collider.shape {
                fissure_scene::ColliderShape::Disc { radius } => near - radius,
                _ => f64::INFINITY,
            };
            corners.fold(around.min(disc), f64::min)
        };
        scene.colliders.iter().map(distance).fold(f64::INFINITY, f64::min)
    };
    let touches = |time: &f64| scene.bodies.iter().any(|body| closest(body, *time) <= scene.particle_spacing);
    (0..=TIMES).map(|k| end * f64::from(k) / f64::from(TIMES)).find(touches).unwrap_or(end)
}
