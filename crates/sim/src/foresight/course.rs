//! How far tips may come.

use super::drawn_tip::DrawnTip;
use super::toughness;
use crate::boundary::collider::Obstacle;
use crate::material::elastic::Elastic;
use fissure_plane::{Region, Vector, polyline_length};
use fissure_scene::{BranchKind, Guide, GuideBranch, Scene};

/// Part of the way ahead that tips make where there are so many cracks that they end on each other's new parts.
const SHARED_WAY: f64 = 0.5;
/// So many live tips in a scene share their ways.
const MANY_TIPS: usize = 16;
/// Looks at a tip that nothing loads yet, as a part of those at one that something does.
const IDLE_LOOKS: f64 = 0.4;
/// A tip is live for so many times as long as the crossing of its way takes: it waits for its load as well.
const LIVE_CROSSINGS: f64 = 2.0;
/// What a tip may feel at most is twice what it does feel, in the median: below so much of its toughness it stays.
const LIKELY_TO_MOVE: f64 = 2.0;
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
            let moves = tip.is_scheduled()
                || reached.get(tip.index).is_none_or(|&load| load >= LIKELY_TO_MOVE || load.is_nan());
            let speed = MEAN_SPEED * tip.speed_limit(scene, elastic);
            let way = part * tip.way(scene);
            if !moves || !way.is_finite() {
                continue;
            }
            course.growth += way.min(speed * running) + tip.crack.guide(tip.end).map_or(0.0, length_of_branches);
            if !tip.is_scheduled() && !is_slow && speed > 0.0 {
                course.watched -= (running - LIVE_CROSSINGS * running.min(way / speed)).max(0.0);
            }
        }
        course
    }
}

/// Length of all that branches off a guide, at any depth [m].
fn length_of_branches(guide: &Guide) -> f64 {
    let of = |branch: &GuideBranch| match &branch.kind {
        BranchKind::Begins { guide, .. } => polyline_length(&guide.points) + length_of_branches(guide),
        BranchKind::Drawn { .. } => 0.0,
    };
    guide.branches.iter().map(of).sum()
}

/// When something first acts on a crack [s]: at once, unless the bodies have to fall or fly onto a collider first.
pub(super) fn first_contact(scene: &Scene, end: f64) -> f64 {
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
