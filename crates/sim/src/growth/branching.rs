//! Division of a tip into two.
//!
//! A tip that is given enough energy for two may divide: when what it would release at rest reaches a multiple of G_c =
//! K_c²/E'. A tip that runs takes the speed at which it releases G_c and no more, J = g(v) G with G that of a tip at
//! rest in its place and g(v) ≈ 1 − v/c_R (Freund 1990, section 6.4); what it has to spare shows in its speed. Where
//! real cracks divide depends on the process zone as well, which a sharp crack does not have; so the multiple, the
//! angle and the distance are the scene's.

use super::advance::LAST_LIGAMENT;
use super::barrier::first_barrier;
use super::heading::way;
use super::load::critical_release;
use crate::crack::assessment::Assessment;
use crate::crack::cracks::{Cracks, TipId};
use crate::material::elastic::Elastic;
use crate::tip::frame::turned;
use fissure_scene::{Point, Scene};

/// Length of new branches, in cells. At the default angle their tips are then 3.6 cells apart: each has the smallest
/// radius of an integral for itself. With 2 cells each tip feels the faces of the other, and the branches turn back and
/// meet.
const FIRST_LENGTH: f64 = 4.0;

/// Least 1 − v/c_R: a tip near c_R tells no more of what there is.
const LEAST_FACTOR: f64 = 0.05;

/// The points of the two branches of a tip, from the tip on and without it, left and right as seen along the crack;
/// none when the tip does not divide.
pub(crate) fn branches(
    cracks: &Cracks,
    id: TipId,
    assessed: &Assessment,
    scene: &Scene,
    elastic: &[Elastic],
) -> Option<[Vec<Point>; 2]> {
    let branching = scene.growth.branching?;
    let tip = cracks.tip(id)?;
    let from = cracks.position(id);
    let body = &scene.bodies[cracks.of(id).body as usize];
    let enough = branching.release_ratio * critical_release(cracks, id, assessed, scene, elastic);
    let follows_exactly = tip.guide.as_ref().is_some_and(|g| g.strength() >= 1.0);
    let fastest = elastic[body.material_at(from)].rayleigh_wave_speed();
    let at_rest = tip.pace.j_integral / (1.0 - tip.pace.speed / fastest).max(LEAST_FACTOR);
    if follows_exactly || at_rest < enough || tip.since_division < branching.spacing {
        return None;
    }
    let toward = way(cracks, id, assessed, scene);
    let h = scene.cell_size;
    let step = scene.growth.increment * h;
    let count = (FIRST_LENGTH * h / step).ceil() as usize;
    let branch = |angle: f64| {
        let along = turned(toward, angle);
        let clear = from + along * (count as f64 * step + LAST_LIGAMENT * h);
        first_barrier(cracks, id, &body.region, from, clear)
            .is_none()
            .then(|| (1..=count).map(|k| from + along * (step * k as f64)).collect::<Vec<Point>>())
    };
    Some([branch(branching.half_angle)?, branch(-branching.half_angle)?])
}
