//! Materials and bodies.

use super::chord_error::ChordError;
use super::shapes::center_of_area;
use super::{Resolved, Resolver};
use crate::document::MaterialKeys;
use crate::fault::{KeyPath, SceneFault};
use crate::load::nearest::nearest;
use crate::materials::{SNOW_PLASTICITY, material_preset, material_presets};
use crate::scene::*;
use crate::settings::PairFriction;
use crate::validate::{outside, overlap};
use fissure_plane::{Point, Vector};

impl<'d> Resolver<'d> {
    pub(super) fn materials_and_bodies(
        &mut self,
        chord_error: ChordError,
        particle_spacing: f64,
    ) -> Resolved<(Vec<Material>, Vec<Body>)> {
        let mut materials: Vec<Material> = Vec::new();
        let mut bodies = Vec::new();
        for (i, keys) in self.document.material.iter().enumerate() {
            let path = KeyPath::item("material", i);
            if self.document.material[..i].iter().any(|m| m.name == keys.name) {
                let message = format!("two materials are called `{}`", keys.name);
                return Err(SceneFault::new(path.then("name"), message, "give each its own name"));
            }
            materials.push(self.material(&path, keys, 0)?);
            self.origin.materials.push(Some(i));
        }
        for (i, keys) in self.document.body.iter().enumerate() {
            let path = KeyPath::item("body", i);
            let material = self.material_index(path.then("material"), &keys.material, &mut materials)?;
            let shape = path.then("shape");
            let (low, high) = self.shape_box(&shape, &keys.shape)?;
            let tolerance = chord_error.within((high - low).amax());
            let (regions, chords) = self.outlines(&shape, &keys.shape, tolerance)?;
            self.chords.push(chords);
            let regions = self.without_crumbs(&shape, &keys.name, regions, particle_spacing);
            self.own_names(&path, i, regions.len())?;
            let parts: Vec<usize> = (bodies.len()..bodies.len() + regions.len()).collect();
            let mut velocities = Vec::new();
            if keys.velocity != [0.0; 2] || keys.angular_velocity != 0.0 {
                velocities.push(InitialVelocity {
                    selection: Selection::Bodies(parts),
                    velocity: Vector::from(keys.velocity),
                    angular_velocity: keys.angular_velocity,
                    center: keys.center.map_or_else(|| center_of_area(&regions), Point::from),
                });
            }
            let several = regions.len() > 1;
            for (k, region) in regions.into_iter().enumerate() {
                let name = if several { part_name(&keys.name, k) } else { keys.name.clone() };
                bodies.push(Body {
                    name,
                    region,
                    material,
                    inclusions: Vec::new(),
                    velocities: velocities.clone(),
                    turns: Vec::new(),
                });
                self.origin.bodies.push(i);
            }
        }
        for (i, keys) in self.document.region.iter().enumerate() {
            self.material_index(KeyPath::item("region", i).then("material"), &keys.material, &mut materials)?;
        }
        Ok((materials, bodies))
    }

    /// That no other `[[body]]` has the name of body number `index`, or of one of its `parts`.
    fn own_names(&self, path: &KeyPath, index: usize, parts: usize) -> Resolved<()> {
        let keys = &self.document.body;
        let name = &keys[index].name;
        let own: Vec<String> = if parts > 1 { (0..parts).map(|k| part_name(name, k)).collect() } else { Vec::new() };
        for (other, body) in keys.iter().enumerate().filter(|(other, _)| *other != index) {
            if other < index && body.name == *name {
                let message = format!("two of them are called body `{name}`");
                return Err(SceneFault::new(path.then("name"), message, "give each its own name"));
            }
            if own.contains(&body.name) {
                let message = format!(
                    "body `{name}` consists of {parts} parts, and the name `{}` of one of them is that of another body",
                    body.name
                );
                return Err(SceneFault::new(
                    KeyPath::item("body", other).then("name"),
                    message,
                    "rename one of the two",
                ));
            }
        }
        Ok(())
    }

    /// Index of the material called `name`, which is added to `materials` when it comes with Fissure.
    fn material_index(&mut self, path: KeyPath, name: &str, materials: &mut Vec<Material>) -> Resolved<usize> {
        if let Some(index) = materials.iter().position(|m| m.name == name) {
            return Ok(index);
        }
        let preset = material_preset(name).ok_or_else(|| self.unknown_material(path, name))?;
        materials.push(preset);
        self.origin.materials.push(None);
        Ok(materials.len() - 1)
    }

    /// Friction between pairs of materials.
    pub(super) fn pair_frictions(&mut self, materials: &mut Vec<Material>) -> Resolved<Vec<PairFriction>> {
        let mut pairs = Vec::new();
        for (i, keys) in self.document.contact.pairs.iter().enumerate() {
            let path = KeyPath::setting("contact", "pairs").then(i).then("materials");
            let [first, second] = &keys.materials;
            let first = self.material_index(path.clone(), first, materials)?;
            let second = self.material_index(path, second, materials)?;
            pairs.push(PairFriction { materials: [first, second], friction: keys.friction });
        }
        Ok(pairs)
    }

    /// Puts the parts of other materials into their bodies.
    pub(super) fn inclusions(&mut self, scene: &mut Scene, tolerance: f64) -> Resolved<()> {
        for (i, keys) in self.document.region.iter().enumerate() {
            let path = KeyPath::item("region", i);
            let material = self.material_index(path.then("material"), &keys.material, &mut scene.materials)?;
            let bodies = self.bodies(path.then("body"), keys.body.as_deref(), scene)?;
            let shape = path.then("shape");
            for region in self.sound_regions(&shape, "the outline of the region", &keys.shape, tolerance)? {
                let mut parts = 0;
                for &body in &bodies {
                    let body = &mut scene.bodies[body];
                    if overlap(&region, &body.region) > 0.0 {
                        body.inclusions.push(Inclusion { region: region.clone(), material });
                        parts += 1;
                    }
                }
                if parts == 0 {
                    let whose = keys.body.as_ref().map_or("any body".into(), |name| format!("body `{name}`"));
                    return Err(outside(shape, &format!("the region does not overlap {whose}")));
                }
            }
        }
        Ok(())
    }

    /// The bodies called `name`: one, or all parts of a drawing of several outlines; without a name all there are. A
    /// part has a name of its own.
    pub(super) fn bodies(&self, path: KeyPath, name: Option<&str>, scene: &Scene) -> Resolved<Vec<usize>> {
        let Some(name) = name else { return Ok((0..scene.bodies.len()).collect()) };
        let drawn_as = |b: usize| self.document.body[self.origin.bodies[b]].name.as_str();
        let made_of: Vec<usize> = (0..scene.bodies.len()).filter(|&b| drawn_as(b) == name).collect();
        if !made_of.is_empty() {
            return Ok(made_of);
        }
        let parts: Vec<&str> = scene.bodies.iter().map(|b| b.name.as_str()).collect();
        if let Some(part) = parts.iter().position(|part| *part == name) {
            return Ok(vec![part]);
        }
        let mut known: Vec<&str> = self.document.body.iter().map(|b| b.name.as_str()).collect();
        known.extend(parts.iter().filter(|part| !self.document.body.iter().any(|b| b.name == **part)));
        Err(SceneFault::new(path, format!("there is no body `{name}`"), nearest(name, &known)))
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
                    (None, None) if *name == keys.name => {
                        let message = format!("material `{name}` is its own base");
                        let remedy = "base it on another one, such as `base = \"pmma\"`, or give all its values";
                        return Err(SceneFault::new(path.then("base"), message, remedy));
                    }
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
        Ok(Material {
            young_modulus: value(keys.young_modulus, "young_modulus", |m| m.young_modulus)?,
            poisson_ratio: value(keys.poisson_ratio, "poisson_ratio", |m| m.poisson_ratio)?,
            density: value(keys.density, "density", |m| m.density)?,
            fracture_toughness: value(keys.fracture_toughness, "fracture_toughness", |m| m.fracture_toughness)?,
            limiting_speed: keys.limiting_speed.or_else(|| base.as_ref().and_then(|m| m.limiting_speed)),
            plasticity: match keys.plasticity {
                Some(own) => own.values().map(|values| values.resolve(SNOW_PLASTICITY)),
                None => base.and_then(|m| m.plasticity),
            },
            name: keys.name.clone(),
        })
    }
}

/// Name of a part of a body, counted from 0.
fn part_name(body: &str, part: usize) -> String {
    format!("{body}.{}", part + 1)
}
