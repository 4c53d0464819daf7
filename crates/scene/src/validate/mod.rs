//! What a scene must fulfil to be simulated. Every range is written here, once.

mod bounds;
mod count;
mod cracks;
mod curve;
mod motion;
mod name;
mod range;
mod region;
mod settings;
mod toughness;

pub(crate) use bounds::pairs;
pub(crate) use count::*;
#[cfg(test)]
pub(crate) use cracks::leaves;
pub(crate) use cracks::{no_tip, validate_strength};
pub(crate) use curve::{Clock, validate_schedule, validate_speed};
pub(crate) use range::*;
pub(crate) use region::{overlap, validate_region};
pub(crate) use toughness::{outside, validate_corners};

use crate::document::PolygonKeys;
use crate::fault::{KeyPath, SceneFault, short};
use crate::scene::Scene;
use fissure_plane::Vector;
use motion::validate_collider;
use name::{validate_file_name, validate_word};

type Check = Result<(), SceneFault>;

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
    /// and inside of what it belongs to. [`crate::load`] gives scenes that pass; scenes made in code should call it
    /// too.
    ///
    /// Paths of faults count items as in this scene.
    ///
    /// # Errors
    /// The first fault found.
    pub fn validate(&self) -> Check {
        let gravity = self.gravity;
        validate_file_name(KeyPath::top("name"), &self.name)?;
        self.validate_counts()?;
        ACCELERATION.check_pair(KeyPath::top("gravity"), "gravity", [gravity.x, gravity.y])?;
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

    /// That there are not too many of anything.
    fn validate_counts(&self) -> Check {
        let arrays = [
            ("material", self.materials.len()),
            ("body", self.bodies.len()),
            ("crack", self.cracks.len()),
            ("toughness", self.toughness.len()),
            ("collider", self.colliders.len()),
            ("load", self.loads.len()),
            ("support", self.supports.len()),
        ];
        arrays.into_iter().try_for_each(|(key, count)| ITEMS.check(&KeyPath::top(key), &format!("`{key}`"), count))
    }

    fn validate_materials(&self) -> Check {
        for (i, m) in self.materials.iter().enumerate() {
            let path = KeyPath::item("material", i);
            validate_word(path.then("name"), "material", &m.name)?;
            let check = |key: &str, words: &str, range: Range, value: f64| {
                range.check(path.then(key), &format!("{words} of material `{}`", m.name), value)
            };
            check("young_modulus", "Young's modulus", YOUNG_MODULUS, m.young_modulus)?;
            check("poisson_ratio", "Poisson's ratio", POISSON_RATIO, m.poisson_ratio)?;
            check("density", "density", DENSITY, m.density)?;
            check("fracture_toughness", "fracture toughness", FRACTURE_TOUGHNESS, m.fracture_toughness)?;
            if let Some(speed) = m.limiting_speed {
                check("limiting_speed", "the highest crack speed", CRACK_SPEED, speed)?;
            }
            if let Some(p) = m.plasticity {
                check("plasticity", "critical compression", CRITICAL_COMPRESSION, p.critical_compression)?;
                check("plasticity", "critical stretch", CRITICAL_STRETCH, p.critical_stretch)?;
                check("plasticity", "hardening", HARDENING, p.hardening)?;
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
            ITEMS.check(&path, &format!("body `{}` with its parts", body.name), body.inclusions.len())?;
            body.inclusions.iter().enumerate().try_for_each(part)?;
            ITEMS.check(&path, &format!("body `{}` with its velocities", body.name), body.velocities.len())?;
            for v in &body.velocities {
                let what = format!("the initial velocity of body `{}`", body.name);
                VELOCITY.check_pair(path.then("velocity"), &what, [v.velocity.x, v.velocity.y])?;
                ANGULAR_VELOCITY.check(path.then("angular_velocity"), &what, v.angular_velocity)?;
                COORDINATE.check_pair(path.then("center"), &what, [v.center.x, v.center.y])?;
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
    validate_word(path.then("name"), what, name)
}

/// A unit vector, or the vector itself when it has no direction (which [`Scene::validate`] reports).
pub(crate) fn unit(v: Vector) -> Vector {
    v.try_normalize(0.0).unwrap_or(v)
}
