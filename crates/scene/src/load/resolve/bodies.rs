//! Materials and bodies.

use super::shapes::center_of_area;
use super::{Resolved, Resolver};
use crate::document::MaterialKeys;
use crate::fault::{KeyPath, SceneFault, nearest};
use crate::geometry::{Point, Vector};
use crate::presets::{material_preset, material_presets};
use crate::scene::*;

impl<'d> Resolver<'d> {
    pub(super) fn materials_and_bodies(&mut self, tolerance: f64) -> Resolved<(Vec<Material>, Vec<Body>)> {
        let mut materials: Vec<Material> = Vec::new();
        let mut bodies = Vec::new();
        for (i, keys) in self.document.material.iter().enumerate() {
            let path = KeyPath::item("material", i);
            if self.document.material[..i].iter().any(|m| m.name == keys.name) {
                let message = format!("two materials are called `{}`", keys.name);
                return Err(SceneFault::new(path.then("name"), message, "give each its own name"));
            }
            materials.push(self.material(&path, keys, 0)?);
            self.material_origin.push(Some(i));
        }
        for (i, keys) in self.document.body.iter().enumerate() {
            let path = KeyPath::item("body", i);
            let known = materials.iter().position(|m| m.name == keys.material);
            let material = match (known, material_preset(&keys.material)) {
                (Some(index), _) => index,
                (None, Some(preset)) => {
                    materials.push(preset);
                    self.material_origin.push(None);
                    materials.len() - 1
                }
                (None, None) => return Err(self.unknown_material(path.then("material"), &keys.material)),
            };
            let regions = self.regions(&path.then("shape"), &keys.shape, tolerance)?;
            let several = regions.len() > 1;
            for (k, region) in regions.into_iter().enumerate() {
                let name = if several { format!("{}.{}", keys.name, k + 1) } else { keys.name.clone() };
                let mut velocities = Vec::new();
                if keys.velocity != [0.0; 2] || keys.angular_velocity != 0.0 {
                    velocities.push(InitialVelocity {
                        selection: Selection::Body(bodies.len()),
                        velocity: Vector::from(keys.velocity),
                        angular_velocity: keys.angular_velocity,
                        center: keys.center.map_or_else(|| center_of_area(&region), Point::from),
                    });
                }
                bodies.push(Body { name, region, material, inclusions: Vec::new(), velocities });
                self.body_origin.push(i);
            }
        }
        Ok((materials, bodies))
    }

    pub(super) fn unknown_material(&self, path: KeyPath, name: &str) -> SceneFault {
        let mut known: Vec<String> = self.document.material.iter().map(|m| m.name.clone()).collect();
        known.extend(
            material_presets()
                .into_iter()
                .map(|m| m.name)
                .filter(|n| !self.document.material.iter().any(|m| &m.name == n)),
        );
        SceneFault::new(path, format!("there is no material `{name}`"), nearest(name, &known))
    }

    /// A `[[material]]` with its base filled in. `depth` counts bases, to find circles.
    pub(super) fn material(&self, path: &KeyPath, keys: &MaterialKeys, depth: usize) -> Resolved<Material> {
        let own_preset = material_preset(&keys.name);
        let base = match &keys.base {
            Some(_) if depth > self.document.material.len() => {
                let message = format!("the bases of material `{}` run in a circle", keys.name);
                return Err(SceneFault::new(
                    path.then("base"),
                    message,
                    "base it on a material that comes with Fissure",
                ));
            }
            Some(name) => {
                let other = self.document.material.iter().position(|m| &m.name == name && name != &keys.name);
                match (other, material_preset(name)) {
                    (Some(i), _) => {
                        Some(self.material(&KeyPath::item("material", i), &self.document.material[i], depth + 1)?)
                    }
                    (None, Some(preset)) => Some(preset),
                    (None, None) => return Err(self.unknown_material(path.then("base"), name)),
                }
            }
            None => own_preset,
        };
        let value = |own: Option<f64>, key: &str, of: fn(&Material) -> f64| {
            own.or_else(|| base.as_ref().map(of)).ok_or_else(|| {
                let message = format!("material `{}` has neither `{key}` nor a `base` to take it from", keys.name);
                SceneFault::new(path.clone(), message, format!("add `{key} = ...` or `base = \"glass\"`"))
            })
        };
        let snow = material_preset("snow").and_then(|m| m.plasticity);
        Ok(Material {
            young_modulus: value(keys.young_modulus, "young_modulus", |m| m.young_modulus)?,
            poisson_ratio: value(keys.poisson_ratio, "poisson_ratio", |m| m.poisson_ratio)?,
            density: value(keys.density, "density", |m| m.density)?,
            fracture_toughness: value(keys.fracture_toughness, "fracture_toughness", |m| m.fracture_toughness)?,
            limiting_speed: keys.limiting_speed.or_else(|| base.as_ref().and_then(|m| m.limiting_speed)),
            plasticity: match (keys.plasticity, snow) {
                (Some(own), Some(snow)) => own.resolve(snow),
                _ => base.and_then(|m| m.plasticity),
            },
            name: keys.name.clone(),
        })
    }

    /// Index of the one body called `name`.
    pub(super) fn body(&self, path: KeyPath, name: &str, scene: &Scene) -> Resolved<usize> {
        let names: Vec<&str> = scene.bodies.iter().map(|b| b.name.as_str()).collect();
        names
            .iter()
            .position(|n| *n == name)
            .ok_or_else(|| SceneFault::new(path, format!("there is no body `{name}`"), nearest(name, &names)))
    }
}
