//! Loads, supports, selections and colliders.

use super::curve::{Clock, validate_curve};
use super::region::validate_region;
use crate::fault::Check;
use crate::fault::{KeyPath, SceneFault};
use crate::frame::Pose;
use crate::range::{
    ANGULAR_VELOCITY, COORDINATE, DEGREES, FORCE, FRICTION, INTERVAL, ITEMS, KEYFRAMES, LENGTH, PRESSURE, TIME,
    TRACTION, VELOCITY,
};
use crate::scene::*;
use fissure_plane::Region;

impl Scene {
    pub(super) fn validate_load(&self, path: &KeyPath, load: &Load) -> Check {
        self.validate_selection(path, &load.selection)?;
        validate_curve(path, &load.curve)?;
        match &load.kind {
            LoadKind::Force(f) => FORCE.check_pair(path.then("force"), "the force", [f.x, f.y]),
            LoadKind::Traction(t) => {
                TRACTION.check_pair(path.then("traction"), "the traction", [t.x, t.y])?;
                if matches!(load.selection, Selection::Edge { .. } | Selection::Outline(_)) {
                    return Ok(());
                }
                let message = "a traction acts on an edge, but none is selected";
                Err(SceneFault::new(
                    path.then("traction"),
                    message,
                    "add `select = { edge = \"...\" }` or `select = { svg = \"...\" }` with an open line along it, or give a `force`",
                ))
            }
            LoadKind::Pressure(pressure) => {
                PRESSURE.check(path.then("pressure"), "the pressure", *pressure)?;
                if !matches!(load.selection, Selection::Near { .. }) {
                    return Ok(());
                }
                let message = "a pressure acts on edges, but points are selected";
                let remedy = "select an `edge`, a `region` around it, a whole `body`, or with `svg` a line along it";
                Err(SceneFault::new(path.then("select"), message, remedy))
            }
            LoadKind::FacePressure(cracks, pressure) => {
                PRESSURE.check(path.then("pressure"), "the pressure", *pressure)?;
                match cracks.iter().find(|crack| **crack >= self.cracks.len()) {
                    None => Ok(()),
                    Some(crack) => {
                        let remedy = format!("there are {}, numbered from 0", self.cracks.len());
                        let message = format!("crack number {crack} is selected");
                        Err(SceneFault::new(path.then("select").then("crack"), message, remedy))
                    }
                }
            }
            LoadKind::PerPoint(forces) => {
                let path = path.then("per_point");
                ITEMS.check(&path, "a load", forces.len())?;
                forces.iter().enumerate().try_for_each(|(i, (at, f))| {
                    COORDINATE.check_pair(path.then(i).then("at"), "the place of a force", [at.x, at.y])?;
                    FORCE.check_pair(path.then(i).then("force"), "a force", [f.x, f.y])
                })
            }
        }
    }

    pub(super) fn validate_support(&self, path: &KeyPath, support: &Support) -> Check {
        self.validate_selection(path, &support.selection)?;
        validate_curve(path, &support.curve)?;
        for (key, v) in ["velocity_x", "velocity_y"].into_iter().zip(support.velocity) {
            VELOCITY.check(path.then(key), "the velocity of a support", v.unwrap_or(0.0))?;
        }
        Ok(())
    }

    pub(super) fn validate_selection(&self, path: &KeyPath, selection: &Selection) -> Check {
        let path = path.then("select");
        let body_exists = |body: usize| {
            if body < self.bodies.len() {
                return Ok(());
            }
            let remedy = format!("there are {}, numbered from 0", self.bodies.len());
            Err(SceneFault::new(path.then("body"), format!("body number {body} is selected"), remedy))
        };
        match selection {
            Selection::All | Selection::Edge { bodies: None, .. } => Ok(()),
            Selection::Bodies(bodies) | Selection::Edge { bodies: Some(bodies), .. } => {
                bodies.iter().try_for_each(|&body| body_exists(body))
            }
            Selection::Outline(stretches) => stretches.iter().try_for_each(|stretch| {
                body_exists(stretch.body)?;
                COORDINATE.check_points(&path, "a point of the selected edge", &[stretch.from, stretch.to])
            }),
            Selection::Region(region) => validate_region(&path.then("region"), "the selected region", region),
            Selection::Near { points, radius } => {
                ITEMS.check(&path.then("near"), "a selection", points.len())?;
                COORDINATE.check_points(&path.then("near"), "a point", points)?;
                LENGTH.check(path.then("radius"), "the radius", *radius)
            }
        }
    }
}

pub(super) fn validate_collider(path: &KeyPath, collider: &Collider) -> Check {
    let name = &collider.name;
    super::validate_word(path.then("name"), "collider", name)?;
    FRICTION.check(path.then("friction"), &format!("the friction of collider `{name}`"), collider.friction)?;
    let shape = path.then("shape");
    match &collider.shape {
        ColliderShape::HalfPlane { normal } => {
            if (normal.norm() - 1.0).abs() > 1e-9 || !normal.norm().is_finite() {
                let message = format!("the normal of collider `{name}` is ({}, {})", normal.x, normal.y);
                return Err(SceneFault::new(shape, message, "it must have a length above 0 and be finite"));
            }
        }
        ColliderShape::Disc { radius } => LENGTH.check(shape, &format!("the radius of collider `{name}`"), *radius)?,
        ColliderShape::Box { half_extents } => {
            for (side, v) in [("width", half_extents.x), ("height", half_extents.y)] {
                LENGTH.check(shape.clone(), &format!("half the {side} of collider `{name}`"), v)?;
            }
        }
        ColliderShape::Polygon { ring } => {
            let region = Region { exterior: ring.clone(), holes: Vec::new() };
            validate_region(&shape, &format!("the outline of collider `{name}`"), &region)?;
        }
    }
    let path = path.then("keyframes");
    if collider.keyframes.is_empty() {
        return Err(SceneFault::new(path, format!("collider `{name}` has no pose"), "give it one keyframe at least"));
    }
    KEYFRAMES.check(&path, &format!("collider `{name}`"), collider.keyframes.len())?;
    for (i, (time, pose)) in collider.keyframes.iter().enumerate() {
        let path = path.then(i);
        TIME.check(path.then("time"), "the time of a keyframe", *time)?;
        COORDINATE.check_pair(
            path.then("position"),
            "the position of a keyframe",
            [pose.position.x, pose.position.y],
        )?;
        DEGREES.check(path.then("angle"), "the angle of a keyframe", pose.angle.to_degrees())?;
    }
    collider
        .keyframes
        .windows(2)
        .enumerate()
        .try_for_each(|(i, w)| validate_motion(&path.then(i + 1), name, &w[0], &w[1]))
}

/// The motion from one keyframe to the next: time goes on, and neither speed is beyond its range.
fn validate_motion(path: &KeyPath, collider: &str, before: &(f64, Pose), after: &(f64, Pose)) -> Check {
    let interval = after.0 - before.0;
    if interval <= 0.0 {
        let what = format!("the keyframes of collider `{collider}`");
        return Err(Clock::Seconds.not_rising(path.clone(), &what, before.0, after.0));
    }
    INTERVAL.check(path.then("time"), "the time since the keyframe before", interval)?;
    let velocity = (after.1.position - before.1.position) / interval;
    let what = format!("the velocity of collider `{collider}` on the way to a keyframe");
    VELOCITY.check_pair(path.then("position"), &what, [velocity.x, velocity.y])?;
    let rotation = (after.1.angle - before.1.angle) / interval;
    ANGULAR_VELOCITY.check(
        path.then("angle"),
        &format!("the rotation of collider `{collider}` on the way to a keyframe"),
        rotation,
    )
}
