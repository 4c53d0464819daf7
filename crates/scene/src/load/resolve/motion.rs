//! What moves and holds the bodies: colliders, loads, supports, velocities.

use super::selection::combined;
use super::shapes::{center_of_area, rectangle};
use super::{Resolved, Resolver};
use crate::curve::Curve;
use crate::document::*;
use crate::fault::{KeyPath, SceneFault};
use crate::frame::Pose;
use crate::range::{ANGULAR_VELOCITY, COORDINATE, VELOCITY};
use crate::scene::*;
use crate::validate::{validate_curve, validate_region};
use fissure_plane::{Point, Region, Vector};
use nalgebra::Vector3;

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
        let drawn: Vec<(f64, Vector3<f64>)> =
            keyframes.iter().map(|k| (k.time, Vector3::new(k.position[0], k.position[1], k.angle))).collect();
        let pose =
            |(time, at): (f64, Vector3<f64>)| (time, Pose { position: origin + at.xy(), angle: at.z.to_radians() });
        let keyframes = keys.ease.between(&drawn).into_iter().map(pose).collect();
        Ok(Collider { name, shape, keyframes, contact: keys.contact, friction: keys.friction })
    }

    pub(super) fn loads(&self, scene: &Scene, tolerance: f64) -> Resolved<Vec<Load>> {
        let each = |(i, keys): (usize, &LoadKeys)| {
            let path = KeyPath::item("load", i);
            let kind = match (keys.force, keys.traction, keys.pressure, &keys.per_point) {
                (Some(f), None, None, None) => LoadKind::Force(Vector::from(f)),
                (None, Some(t), None, None) => LoadKind::Traction(Vector::from(t)),
                (None, None, Some(p), None) if keys.select.crack.is_some() => LoadKind::FacePressure(Vec::new(), p),
                (None, None, Some(p), None) => LoadKind::Pressure(p),
                (None, None, None, Some(forces)) => {
                    LoadKind::PerPoint(forces.iter().map(|f| (Point::from(f.at), Vector::from(f.force))).collect())
                }
                _ => {
                    let message = "a load needs exactly one of `force`, `traction`, `pressure` and `per_point`";
                    return Err(SceneFault::new(path, message, "keep one of them, or write several `[[load]]`"));
                }
            };
            let selection = match &kind {
                LoadKind::FacePressure(..) => faces_alone(&path, &keys.select)?,
                _ => self.selection(&path, &keys.select, scene, tolerance)?,
            };
            Ok(Load { selection, kind, curve: curve(&path, &keys.curve, keys.ease)? })
        };
        self.document.load.iter().enumerate().map(each).collect()
    }

    /// Finds the cracks whose faces loads press on.
    pub(super) fn pressed_cracks(&self, scene: &mut Scene) -> Resolved<()> {
        for (i, (keys, load)) in self.document.load.iter().zip(&mut scene.loads).enumerate() {
            if let (LoadKind::FacePressure(cracks, _), Some(name)) = (&mut load.kind, &keys.select.crack) {
                *cracks =
                    self.cracks_called(KeyPath::item("load", i).then("select").then("crack"), name, &scene.cracks)?;
            }
        }
        Ok(())
    }

    pub(super) fn supports(&self, scene: &Scene, tolerance: f64) -> Resolved<Vec<Support>> {
        let each = |(i, keys): (usize, &SupportKeys)| {
            let path = KeyPath::item("support", i);
            let (velocity, curve) = prescribed(&path, keys)?;
            Ok(Support { selection: self.selection(&path, &keys.select, scene, tolerance)?, velocity, curve })
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

/// The selection of a pressure on the faces of a crack, which names nothing else.
fn faces_alone(path: &KeyPath, select: &Select) -> Resolved<Selection> {
    let ways = [
        ("edge", select.edge.is_some()),
        ("body", select.body.is_some()),
        ("region", select.region.is_some()),
        ("near", select.near.is_some() || select.radius.is_some()),
        ("svg", select.svg.is_some()),
    ];
    match ways.into_iter().find(|(_, given)| *given) {
        Some((key, _)) => Err(combined(path.then("select"), &format!("`crack` and `{key}`"))),
        None => Ok(Selection::All),
    }
}

/// A factor over time.
///
/// # Errors
/// When the points that were written down are none of a curve.
fn curve(path: &KeyPath, list: &[[f64; 2]], ease: Ease) -> Resolved<Curve> {
    let drawn = Curve { points: pairs(list) };
    validate_curve(path, &drawn)?;
    Ok(Curve { points: ease.between(&drawn.points) })
}

/// Velocity along x and y and its factor over time, of a support that prescribes velocities or displacements.
fn prescribed(path: &KeyPath, keys: &SupportKeys) -> Resolved<([Option<f64>; 2], Curve)> {
    let velocity = [keys.velocity_x, keys.velocity_y];
    let displacement = [keys.displacement_x, keys.displacement_y];
    let is_given = |of: [Option<f64>; 2]| of.iter().any(Option::is_some);
    match (keys.fix, is_given(velocity), is_given(displacement)) {
        (Some(fix), false, false) => {
            let held = |is_held: bool| is_held.then_some(0.0);
            Ok(([held(fix != Fix::Y), held(fix != Fix::X)], curve(path, &keys.curve, keys.ease)?))
        }
        (None, true, false) => Ok((velocity, curve(path, &keys.curve, keys.ease)?)),
        (None, false, true) => way(path, displacement, &curve(path, &keys.curve, keys.ease)?.points),
        (None, false, false) => {
            let remedy = "add `fix = \"both\"`, `velocity_x`, `velocity_y`, `displacement_x` or `displacement_y`";
            Err(SceneFault::new(path.clone(), "a support holds nothing", remedy))
        }
        (None, true, true) => {
            let message = "both a velocity and a displacement are given, but there is one `curve`";
            Err(SceneFault::new(path.clone(), message, "write two supports of the same selection"))
        }
        (Some(_), ..) => {
            let message = "both `fix` and a velocity or displacement are given";
            let remedy = "to hold still in one direction give it the velocity 0";
            Err(SceneFault::new(path.then("fix"), message, remedy))
        }
    }
}

/// Part of the shortest time between two points of a way over time within which its speed changes at a point: too short
/// to be seen, long enough for times to rise.
const TURN: f64 = 1e-6;

/// Displacements [m] at a factor of 1 and the way over time as velocities with their factor over time.
fn way(path: &KeyPath, displacement: [Option<f64>; 2], points: &[(f64, f64)]) -> Resolved<([Option<f64>; 2], Curve)> {
    for (key, way) in ["displacement_x", "displacement_y"].into_iter().zip(displacement) {
        COORDINATE.check(path.then(key), "the displacement of a support", way.unwrap_or(0.0))?;
    }
    let of_curve = path.then("curve");
    match points.first() {
        Some(&(_, 0.0)) => (),
        Some(&(_, first)) => {
            let message = format!("the way of a support begins at a factor of {first}, a jump from where it stands");
            return Err(SceneFault::new(of_curve.then(0), message, "let the curve begin at 0"));
        }
        None => {
            let message = "a displacement without a curve would be a jump";
            return Err(SceneFault::new(of_curve, message, "add for instance `curve = [[0.0, 0.0], [0.01, 1.0]]`"));
        }
    }
    let slopes: Vec<f64> = points.windows(2).map(|p| (p[1].1 - p[0].1) / (p[1].0 - p[0].0)).collect();
    let shortest = points.windows(2).map(|p| p[1].0 - p[0].0).fold(f64::INFINITY, f64::min);
    let steepest = slopes.iter().fold(0.0_f64, |most, slope| most.max(slope.abs()));
    if steepest == 0.0 {
        return Ok((displacement.map(|way| way.map(|_| 0.0)), Curve::default()));
    }
    for (key, way) in ["displacement_x", "displacement_y"].into_iter().zip(displacement) {
        let speed = way.unwrap_or(0.0) * steepest;
        VELOCITY.check(path.then(key), "the highest speed on the way of a support", speed)?;
    }
    let turn = 0.5 * TURN * shortest;
    let mut factors: Vec<(f64, f64)> = Vec::with_capacity(2 * points.len());
    for (k, &(time, _)) in points.iter().enumerate() {
        // Half before the point and half after it, so that the way is right at both ends.
        let before = if k == 0 { 0.0 } else { slopes[k - 1] };
        let after = slopes.get(k).copied().unwrap_or(0.0);
        factors.push((time - turn, before / steepest));
        factors.push((time + turn, after / steepest));
    }
    Ok((displacement.map(|way| way.map(|way| way * steepest)), Curve { points: factors }))
}

pub(super) fn pairs(list: &[[f64; 2]]) -> Vec<(f64, f64)> {
    list.iter().map(|&[at, value]| (at, value)).collect()
}

/// A unit vector, or the vector itself when it has no direction (which [`Scene::validate`] reports).
fn unit(v: Vector) -> Vector {
    v.try_normalize(0.0).unwrap_or(v)
}
