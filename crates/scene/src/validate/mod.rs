//! What a scene must fulfil to be simulated.

mod cracks;
mod curve;
mod motion;
mod name;
mod region;
mod settings;
mod toughness;

// What is checked while it is read, where the file still says what was meant.
#[cfg(feature = "load")]
pub(crate) use {
    cracks::{MOST_GENERATIONS, leaves, no_tip, validate_strength},
    curve::{Clock, validate_curve, validate_factor, validate_schedule, validate_speed},
    region::{overlap, validate_region},
    toughness::{outside, validate_corners},
};

use crate::fault::{Check, KeyPath, SceneFault, short};
use crate::range::{
    ACCELERATION, ANGULAR_VELOCITY, COORDINATE, CRACK_SPEED, CRITICAL_COMPRESSION, CRITICAL_STRETCH, DENSITY,
    FRACTURE_TOUGHNESS, HARDENING, ITEMS, POISSON_RATIO, Range, VELOCITY, YOUNG_MODULUS,
};
use crate::scene::Scene;
use motion::validate_collider;
use name::{unique_name, validate_file_name, validate_word};

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
            region::validate_region(
                &path.then("shape"),
                &format!("the outline of body `{}`", body.name),
                &body.region,
            )?;
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
                let shared = region::overlap(&a.region, &b.region);
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
