//! What a scene must fulfil to be simulated. Every range is written here, once.

mod cracks;
mod curve;
mod motion;
mod region;
mod settings;
mod toughness;

#[cfg(test)]
pub(crate) use cracks::leaves;
pub(crate) use cracks::no_tip;
pub(crate) use cracks::validate_strength;
pub(crate) use curve::{Clock, validate_schedule, validate_speed};
pub(crate) use region::{overlap, validate_region};
pub(crate) use toughness::{outside, validate_corners};

use crate::document::PolygonKeys;
use crate::fault::{KeyPath, SceneFault, short};
use crate::geometry::{Point, Vector};
use crate::scene::Scene;
use motion::validate_collider;

type Check = Result<(), SceneFault>;

/// A range of numbers and the words for it.
#[derive(Clone, Copy)]
struct Range {
    holds: fn(f64) -> bool,
    words: &'static str,
}

const POSITIVE: Range = Range { holds: |v| v > 0.0 && v.is_finite(), words: "a finite number above 0" };
const NOT_NEGATIVE: Range = Range { holds: |v| v >= 0.0 && v.is_finite(), words: "a finite number of at least 0" };
const FRICTION: Range = Range { holds: |v| v >= 0.0, words: "at least 0 (inf: stick)" };
const FINITE: Range = Range { holds: f64::is_finite, words: "finite" };
const FRACTION: Range = Range { holds: |v| v > 0.0 && v <= 1.0, words: "above 0 and at most 1" };
const UNIT: Range = Range { holds: |v| (0.0..=1.0).contains(&v), words: "from 0 to 1" };
const POISSON: Range = Range { holds: |v| v > -1.0 && v < 0.5, words: "above -1 and below 0.5" };
const SPREAD: Range = Range { holds: |v| (0.0..1.0).contains(&v), words: "at least 0 and below 1" };
const ABOVE_ONE: Range = Range { holds: |v| v > 1.0 && v.is_finite(), words: "a finite number above 1" };
const ACUTE: Range = Range { holds: |v| v > 0.0 && v < 90.0, words: "above 0 and below 90 degrees" };
const BELOW_ONE: Range = Range { holds: |v| v > 0.0 && v < 1.0, words: "above 0 and below 1" };

impl Range {
    fn check(self, path: KeyPath, what: &str, value: f64) -> Check {
        if (self.holds)(value) {
            return Ok(());
        }
        Err(SceneFault::new(path, format!("{what} is {value}"), format!("it must be {}", self.words)))
    }
}

/// That both components are finite.
pub(crate) fn finite_pair(path: KeyPath, what: &str, value: [f64; 2]) -> Check {
    value.into_iter().try_for_each(|v| FINITE.check(path.clone(), what, v))
}

/// That all points are finite.
pub(crate) fn finite_points(path: &KeyPath, what: &str, points: &[Point]) -> Check {
    points.iter().try_for_each(|p| finite_pair(path.clone(), what, [p.x, p.y]))
}

/// That a scale is above 0.
pub(crate) fn positive(path: KeyPath, what: &str, value: f64) -> Check {
    POSITIVE.check(path, what, value)
}

/// That a number is finite.
pub(crate) fn finite(path: KeyPath, what: &str, value: f64) -> Check {
    FINITE.check(path, what, value)
}

/// That a number is finite and at least 0.
pub(crate) fn not_negative(path: KeyPath, what: &str, value: f64) -> Check {
    NOT_NEGATIVE.check(path, what, value)
}

/// That a spread relative to a mean leaves something.
pub(crate) fn spread(path: KeyPath, what: &str, value: f64) -> Check {
    SPREAD.check(path, what, value)
}

/// That an inline polygon has corners to make rings of.
pub(crate) fn enough_corners(path: &KeyPath, polygon: &PolygonKeys) -> Check {
    std::iter::once(&polygon.exterior).chain(&polygon.holes).find(|ring| ring.len() < 3).map_or(Ok(()), |ring| {
        Err(SceneFault::new(
            path.clone(),
            format!("a ring has {} corners", ring.len()),
            "a ring needs at least 3 corners",
        ))
    })
}

impl Scene {
    /// Checks that every number is finite and in its range, every index exists, and the geometry is simple, oriented
    /// and inside of what it belongs to. [`crate::load`] gives scenes that pass; scenes made in code should call it too.
    ///
    /// Paths of faults count items as in this scene.
    ///
    /// # Errors
    /// The first fault found.
    pub fn validate(&self) -> Check {
        let gravity = self.gravity;
        finite_pair(KeyPath::top("gravity"), "gravity", [gravity.x, gravity.y])?;
        self.validate_materials()?;
        self.validate_bodies()?;
        self.validate_resolution()?;
        self.validate_settings()?;
        self.colliders.iter().enumerate().try_for_each(|(i, c)| validate_collider(&KeyPath::item("collider", i), c))?;
        self.loads.iter().enumerate().try_for_each(|(i, l)| self.validate_load(&KeyPath::item("load", i), l))?;
        self.supports
            .iter()
            .enumerate()
            .try_for_each(|(i, s)| self.validate_support(&KeyPath::item("support", i), s))?;
        self.toughness
            .iter()
            .enumerate()
            .try_for_each(|(i, t)| self.validate_toughness(&KeyPath::item("toughness", i), t))?;
        self.validate_cracks()
    }

    fn validate_materials(&self) -> Check {
        for (i, m) in self.materials.iter().enumerate() {
            let path = KeyPath::item("material", i);
            let check = |key: &str, words: &str, range: Range, value: f64| {
                range.check(path.then(key), &format!("{words} of material `{}`", m.name), value)
            };
            check("young_modulus", "Young's modulus", POSITIVE, m.young_modulus)?;
            check("poisson_ratio", "Poisson's ratio", POISSON, m.poisson_ratio)?;
            check("density", "density", POSITIVE, m.density)?;
            check("fracture_toughness", "fracture toughness", POSITIVE, m.fracture_toughness)?;
            if let Some(speed) = m.limiting_speed {
                check("limiting_speed", "the highest crack speed", POSITIVE, speed)?;
            }
            if let Some(p) = m.plasticity {
                check("plasticity", "critical compression", BELOW_ONE, p.critical_compression)?;
                check("plasticity", "critical stretch", POSITIVE, p.critical_stretch)?;
                check("plasticity", "hardening", NOT_NEGATIVE, p.hardening)?;
            }
        }
        Ok(())
    }

    fn validate_bodies(&self) -> Check {
        if self.bodies.is_empty() {
            return Err(SceneFault::new(KeyPath::top("body"), "the scene has no body", "add a `[[body]]`"));
        }
        for (i, body) in self.bodies.iter().enumerate() {
            let path = KeyPath::item("body", i);
            unique_name(&path, "body", &body.name, self.bodies[..i].iter().map(|b| b.name.as_str()))?;
            if body.material >= self.materials.len() {
                let message = format!("body `{}` has material number {}", body.name, body.material);
                let remedy = format!("there are {}, numbered from 0", self.materials.len());
                return Err(SceneFault::new(path.then("material"), message, remedy));
            }
            validate_region(&path.then("shape"), &format!("the outline of body `{}`", body.name), &body.region)?;
            let part = |(k, inclusion)| self.validate_inclusion(&path.then("inclusions").then(k), inclusion, body);
            body.inclusions.iter().enumerate().try_for_each(part)?;
            for v in &body.velocities {
                let what = format!("the initial velocity of body `{}`", body.name);
                finite_pair(path.then("velocity"), &what, [v.velocity.x, v.velocity.y])?;
                FINITE.check(path.then("angular_velocity"), &what, v.angular_velocity)?;
                finite_pair(path.then("center"), &what, [v.center.x, v.center.y])?;
                self.validate_selection(&path, &v.selection)?;
            }
        }
        self.validate_overlaps()
    }

    /// Bodies may abut but not overlap.
    fn validate_overlaps(&self) -> Check {
        for (i, a) in self.bodies.iter().enumerate() {
            for b in &self.bodies[..i] {
                let shared = overlap(&a.region, &b.region);
                if shared > 0.0 {
                    return Err(SceneFault::new(
                        KeyPath::item("body", i).then("shape"),
                        format!("body `{}` overlaps body `{}` by {} m²", a.name, b.name, short(shared)),
                        "move them apart or make them one body",
                    ));
                }
            }
        }
        Ok(())
    }
}

fn unique_name<'a>(path: &KeyPath, what: &str, name: &str, mut before: impl Iterator<Item = &'a str>) -> Check {
    if name.is_empty() || before.any(|b| b == name) {
        let message = if name.is_empty() {
            format!("a {what} has an empty name")
        } else {
            format!("two of them are called {what} `{name}`")
        };
        return Err(SceneFault::new(path.then("name"), message, "give each its own name"));
    }
    Ok(())
}

/// A unit vector, or the vector itself when it has no direction (which [`Scene::validate`] reports).
pub(crate) fn unit(v: Vector) -> Vector {
    v.try_normalize(0.0).unwrap_or(v)
}
