//! What moves and holds the bodies: colliders, loads, supports, velocities.

use super::shapes::{center_of_area, rectangle};
use super::{Resolved, Resolver};
use crate::curve::Curve;
use crate::document::*;
use crate::fault::{KeyPath, SceneFault};
use crate::frame::Pose;
use crate::range::{ANGULAR_VELOCITY, COORDINATE, VELOCITY};
use crate::scene::*;
use crate::validate::validate_region;
use fissure_plane::{Point, Region, Vector};

impl<'d> Resolver<'d> {
    pub(super) fn colliders(&self, tolerance: f64) -> Resolved<Vec<Collider>> {
        self.document.collider.iter().enumerate().map(|(i, keys)| self.collider(i, keys, tolerance)).collect()
    }

    pub(super) fn collider(&self, i: usize, keys: &ColliderKeys, tolerance: f64) -> Resolved<Collider> {
        let path = KeyPath::item("collider", i);
        let shape_path = path.then("shape");
        let name = keys.name.clone().unwrap_or_else(|| format!("collider-{}", i + 1));
        if self.document.collider[..i].iter().any(|c| c.name.as_ref() == Some(&name)) {
            let message = format!("two colliders are called `{name}`");
            return Err(SceneFault::new(path.then("name"), message, "give each its own name"));
        }
        let from_region = |region: Region| {
            let center = center_of_area(std::slice::from_ref(&region));
            let ring = region.exterior.iter().map(|p| Point::from(p - center)).collect();
            (ColliderShape::Polygon { ring }, center)
        };
        let (shape, origin) = match &keys.shape {
            ColliderShapeKeys::HalfPlane(h) => {
                COORDINATE.check_pair(shape_path.then("half_plane"), "the point of the half-plane", h.point)?;
                (ColliderShape::HalfPlane { normal: unit(Vector::from(h.normal)) }, Point::from(h.point))
            }
            ColliderShapeKeys::Disc(d) => {
                COORDINATE.check_pair(shape_path.then("disc"), "the centre of the disc", d.center)?;
                (ColliderShape::Disc { radius: d.radius }, Point::from(d.center))
            }
            ColliderShapeKeys::Box(b) => {
                let region = rectangle(&shape_path.then("box"), b.min, b.max)?;
                let (low, high) = region.bounds();
                (ColliderShape::Box { half_extents: (high - low) / 2.0 }, nalgebra::center(&low, &high))
            }
            ColliderShapeKeys::Polygon(corners) => {
                let shape = Shape::Polygon(PolygonKeys { exterior: corners.clone(), holes: Vec::new() });
                let region = self.regions(&shape_path, &shape, tolerance)?.swap_remove(0);
                validate_region(&shape_path, &format!("the outline of collider `{name}`"), &region)?;
                from_region(region)
            }
            ColliderShapeKeys::Svg(id) => {
                let mut regions = self.regions(&shape_path, &Shape::Svg(id.clone()), tolerance)?;
                if regions.len() != 1 || !regions[0].holes.is_empty() {
                    let holes: usize = regions.iter().map(|r| r.holes.len()).sum();
                    let message = format!("`{id}` has {} outlines and {holes} holes", regions.len());
                    return Err(SceneFault::new(shape_path, message, "a collider is one outline without holes"));
                }
                from_region(regions.swap_remove(0))
            }
        };
        let still = [Keyframe { time: 0.0, position: [0.0; 2], angle: 0.0 }];
        let keyframes = if keys.keyframes.is_empty() { &still[..] } else { &keys.keyframes };
        let keyframes = keyframes
            .iter()
            .map(|k| {
                let pose = Pose { position: origin + Vector::from(k.position), angle: k.angle.to_radians() };
                (k.time, pose)
            })
            .collect();
        Ok(Collider { name, shape, keyframes, contact: keys.contact, friction: keys.friction })
    }

    pub(super) fn loads(&self, scene: &Scene, tolerance: f64) -> Resolved<Vec<Load>> {
        let each = |(i, keys): (usize, &LoadKeys)| {
            let path = KeyPath::item("load", i);
            let kind = match (keys.force, keys.traction, &keys.per_point) {
                (Some(f), None, None) => LoadKind::Force(Vector::from(f)),
                (None, Some(t), None) => LoadKind::Traction(Vector::from(t)),
                (None, None, Some(forces)) => {
                    LoadKind::PerPoint(forces.iter().map(|f| (Point::from(f.at), Vector::from(f.force))).collect())
                }
                _ => {
                    let message = "a load needs exactly one of `force`, `traction` and `per_point`";
                    return Err(SceneFault::new(path, message, "keep one of them, or write several `[[load]]`"));
                }
            };
            Ok(Load {
                selection: self.selection(&path, &keys.select, scene, tolerance)?,
                kind,
                curve: curve(&keys.curve),
            })
        };
        self.document.load.iter().enumerate().map(each).collect()
    }

    pub(super) fn supports(&self, scene: &Scene, tolerance: f64) -> Resolved<Vec<Support>> {
        let each = |(i, keys): (usize, &SupportKeys)| {
            let path = KeyPath::item("support", i);
            let velocity = match (keys.fix, keys.velocity_x, keys.velocity_y) {
                (Some(Fix::X), None, None) => [Some(0.0), None],
                (Some(Fix::Y), None, None) => [None, Some(0.0)],
                (Some(Fix::Both), None, None) => [Some(0.0); 2],
                (None, x, y) if x.is_some() || y.is_some() => [x, y],
                (None, ..) => {
                    let message = "a support holds nothing";
                    return Err(SceneFault::new(path, message, "add `fix = \"both\"`, `velocity_x` or `velocity_y`"));
                }
                (Some(_), ..) => {
                    let message = "both `fix` and a velocity are given";
                    return Err(SceneFault::new(
                        path.then("fix"),
                        message,
                        "to hold still in one direction give it the velocity 0",
                    ));
                }
            };
            let selection = self.selection(&path, &keys.select, scene, tolerance)?;
            Ok(Support { selection, velocity, curve: curve(&keys.curve) })
        };
        self.document.support.iter().enumerate().map(each).collect()
    }

    pub(super) fn initial_velocities(&self, scene: &mut Scene, tolerance: f64) -> Resolved<()> {
        for (i, keys) in self.document.initial_velocity.iter().enumerate() {
            let path = KeyPath::item("initial_velocity", i);
            VELOCITY.check_pair(path.then("velocity"), "the initial velocity", keys.velocity)?;
            ANGULAR_VELOCITY.check(path.then("angular_velocity"), "the rotation", keys.angular_velocity)?;
            COORDINATE.check_pair(path.then("center"), "the centre of rotation", keys.center)?;
            let selection = self.selection(&path, &keys.select, scene, tolerance)?;
            let of = match &selection {
                Selection::Bodies(bodies) | Selection::Edge { bodies: Some(bodies), .. } => bodies.clone(),
                _ => (0..scene.bodies.len()).collect(),
            };
            for body in of {
                let body = &mut scene.bodies[body];
                body.velocities.push(InitialVelocity {
                    selection: selection.clone(),
                    velocity: Vector::from(keys.velocity),
                    angular_velocity: keys.angular_velocity,
                    center: Point::from(keys.center),
                });
            }
        }
        Ok(())
    }
}

fn curve(list: &[[f64; 2]]) -> Curve {
    Curve { points: pairs(list) }
}

pub(super) fn pairs(list: &[[f64; 2]]) -> Vec<(f64, f64)> {
    list.iter().map(|&[at, value]| (at, value)).collect()
}

/// A unit vector, or the vector itself when it has no direction (which [`Scene::validate`] reports).
fn unit(v: Vector) -> Vector {
    v.try_normalize(0.0).unwrap_or(v)
}
