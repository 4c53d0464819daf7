//! Turns what a user wrote into a [`Scene`]: names become indices, shapes become regions, defaults become numbers.

use super::cracks::{Complaint, fit_guide, seat_crack};
use super::drawing::LoadedDrawing;
use crate::document::*;
use crate::fault::{Key, KeyPath, SceneFault, nearest, show};
use crate::frame::Pose;
use crate::geometry::{Point, Region, Vector, bounds, polyline_length, signed_area};
use crate::outline::{circle_ring, clean_ring, find_crossing, oriented};
use crate::presets::{material_preset, material_presets, solver_preset, updated_kernel};
use crate::scene::*;
use crate::settings::*;
use crate::validate::{enough_corners, finite_pair, finite_points, live_mouth, positive, unit, validate_region};

type Resolved<T> = Result<T, SceneFault>;

/// Particles along the larger side of the bodies' box, unless the scene says otherwise.
const DEFAULT_RESOLUTION: f64 = 128.0;
/// Curves are flattened to this part of the particle spacing.
const FLATTENING: f64 = 1.0 / 20.0;
/// Crack ends this near to the outline, in particle spacings, lie on it: twice what flattening may move the outline by.
const MOUTH_TOLERANCE: f64 = 2.0 * FLATTENING;
/// A guide this near to the tip or crack, in particle spacings, starts there or runs along it.
const GUIDE_TOLERANCE: f64 = 0.5;

/// Resolves one document.
pub(crate) struct Resolver<'d> {
    document: &'d Document,
    drawing: Option<&'d LoadedDrawing>,
    default_name: String,
    /// For each body of the scene: which `[[body]]` it comes from.
    body_origin: Vec<usize>,
    /// For each material of the scene: which `[[material]]` it comes from.
    material_origin: Vec<Option<usize>>,
}

impl<'d> Resolver<'d> {
    pub(crate) fn new(document: &'d Document, drawing: Option<&'d LoadedDrawing>, default_name: String) -> Self {
        Self { document, drawing, default_name, body_origin: Vec::new(), material_origin: Vec::new() }
    }

    /// The scene, validated.
    pub(crate) fn scene(mut self) -> Resolved<Scene> {
        let document = self.document;
        if document.body.is_empty() {
            return Err(SceneFault::new(KeyPath::top("body"), "the scene has no body", "add a `[[body]]`"));
        }
        let (low, high) = self.bodies_box()?;
        let side = (high.x - low.x).max(high.y - low.y);
        let particle_spacing = document.grid.particle_spacing.unwrap_or(side / DEFAULT_RESOLUTION);
        if document.grid.particle_spacing.is_some() {
            positive(KeyPath::setting("grid", "particle_spacing"), "the particle spacing", particle_spacing)?;
        }
        // A spacing larger than the bodies is reported by the validation; the shapes must not depend on it until then.
        let tolerance = FLATTENING * particle_spacing.min(side / 16.0);
        let (materials, bodies) = self.materials_and_bodies(tolerance)?;
        let (solver, growth) = self.solver(&materials)?;
        let mut scene = Scene {
            name: document.name.clone().unwrap_or_else(|| self.default_name.clone()),
            hash: String::new(),
            plane: document.plane,
            gravity: Vector::from(document.gravity),
            particle_spacing,
            cell_size: document.grid.cell_size.unwrap_or(2.0 * particle_spacing),
            frames: self.frames()?,
            output: self.output(side)?,
            colliders: self.colliders(tolerance)?,
            cracks: Vec::new(),
            toughness: Vec::new(),
            loads: Vec::new(),
            supports: Vec::new(),
            materials,
            bodies,
            solver,
            growth,
        };
        scene.loads = self.loads(&scene, tolerance)?;
        scene.supports = self.supports(&scene, tolerance)?;
        self.initial_velocities(&mut scene, tolerance)?;
        // The bodies must be sound before cracks are fitted into them.
        scene.validate().map_err(|fault| self.in_document(fault))?;
        self.cracks(&mut scene, tolerance)?;
        scene.validate().map_err(|fault| self.in_document(fault))?;
        Ok(scene)
    }

    /// A fault's path, counted as in the document.
    fn in_document(&self, mut fault: SceneFault) -> SceneFault {
        if let [Key::Name(array), Key::Index(index), ..] = fault.path.0.as_mut_slice() {
            match array.as_str() {
                "body" => *index = self.body_origin.get(*index).copied().unwrap_or(*index),
                "material" => *index = self.material_origin.get(*index).copied().flatten().unwrap_or(usize::MAX),
                _ => {}
            }
        }
        fault
    }

    fn bodies_box(&self) -> Resolved<(Point, Point)> {
        let mut corners = Vec::new();
        for (i, body) in self.document.body.iter().enumerate() {
            let (low, high) = match &body.shape {
                Shape::Rectangle(r) => (Point::from(r.min), Point::from(r.max)),
                Shape::Circle(c) => {
                    let (center, half) = (Point::from(c.center), Vector::new(c.radius, c.radius));
                    (center - half, center + half)
                }
                Shape::Polygon(polygon) => bounds(&points(&polygon.exterior)),
                Shape::Svg(id) => {
                    let path = KeyPath::item("body", i).then("shape").then("svg");
                    let drawing = self.drawing(&path, id)?;
                    drawing.bounds(id).map_err(at(&path))?
                }
            };
            corners.extend([low, high]);
        }
        Ok(bounds(&corners))
    }

    fn drawing(&self, path: &KeyPath, id: &str) -> Resolved<&'d LoadedDrawing> {
        self.drawing.ok_or_else(|| {
            let message = format!("`svg = \"{id}\"` needs a drawing, but the scene has none");
            SceneFault::new(path.clone(), message, "add `[drawing]` with `file = \"...svg\"`")
        })
    }

    /// The regions a shape consists of: one, or several for a drawing of separate outlines.
    fn regions(&self, path: &KeyPath, shape: &Shape, tolerance: f64) -> Resolved<Vec<Region>> {
        match shape {
            Shape::Rectangle(r) => rectangle(&path.then("rectangle"), r.min, r.max).map(|r| vec![r]),
            Shape::Circle(c) => {
                let path = path.then("circle");
                finite_pair(path.then("center"), "the centre of the circle", c.center)?;
                positive(path.then("radius"), "the radius of the circle", c.radius)?;
                Ok(vec![Region {
                    exterior: circle_ring(Point::from(c.center), c.radius, tolerance),
                    holes: Vec::new(),
                }])
            }
            Shape::Polygon(polygon) => {
                let path = path.then("polygon");
                enough_corners(&path, polygon)?;
                let ring = |list: &[[f64; 2]], outer: bool| oriented(clean_ring(&points(list), 0.0), outer);
                Ok(vec![Region {
                    exterior: ring(&polygon.exterior, true),
                    holes: polygon.holes.iter().map(|h| ring(h, false)).collect(),
                }])
            }
            Shape::Svg(id) => {
                let path = path.then("svg");
                self.drawing(&path, id)?.regions(id, tolerance).map_err(at(&path))
            }
        }
    }

    fn materials_and_bodies(&mut self, tolerance: f64) -> Resolved<(Vec<Material>, Vec<Body>)> {
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

    fn unknown_material(&self, path: KeyPath, name: &str) -> SceneFault {
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
    fn material(&self, path: &KeyPath, keys: &MaterialKeys, depth: usize) -> Resolved<Material> {
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

    fn solver(&self, materials: &[Material]) -> Resolved<(SolverSettings, GrowthSettings)> {
        let (keys, growth_keys) = (&self.document.solver, &self.document.growth);
        let (mut s, mut g) = solver_preset(keys.preset);
        let flows = materials.iter().any(|m| m.plasticity.is_some());
        s.formulation = keys.formulation.unwrap_or(s.formulation);
        let moves_through_grid = s.formulation == Formulation::Updated || (s.formulation == Formulation::Auto && flows);
        if keys.preset == SolverPreset::Standard && moves_through_grid {
            s.kernel = updated_kernel();
        }
        s.on_distortion = keys.on_distortion.unwrap_or(s.on_distortion);
        s.kernel = keys.kernel.unwrap_or(s.kernel);
        s.transfer = keys.transfer.unwrap_or(s.transfer);
        s.time_step = match keys.time_step {
            TimeStep::Auto => s.time_step,
            TimeStep::Seconds(seconds) => Some(seconds),
        };
        s.courant = keys.courant.unwrap_or(s.courant);
        s.damping = keys.damping.unwrap_or(s.damping);
        s.crack_contact = keys.crack_contact.unwrap_or(s.crack_contact);
        s.crack_friction = keys.crack_friction.unwrap_or(s.crack_friction);
        s.tip_division = keys.tip_division.unwrap_or(s.tip_division);
        s.j_method = keys.j_method.unwrap_or(s.j_method);
        s.j_radius = keys.j_radius.unwrap_or(s.j_radius);
        s.area_term = keys.area_term.unwrap_or(s.area_term);
        s.mode_split = keys.mode_split.unwrap_or(s.mode_split);
        g.enabled = growth_keys.enabled.unwrap_or(g.enabled);
        g.increment = growth_keys.increment.unwrap_or(g.increment);
        g.bending = growth_keys.bending.unwrap_or(g.bending);
        g.speed_limit = growth_keys.speed_limit.unwrap_or(g.speed_limit);
        Ok((s, g))
    }

    fn frames(&self) -> Resolved<FrameSettings> {
        let keys = &self.document.frames;
        let rate = keys.rate.unwrap_or(24.0);
        let Some(range) = &keys.range else {
            let first = keys.first.unwrap_or(1);
            return Ok(FrameSettings { first, last: keys.last.unwrap_or(first.saturating_add(47)), rate });
        };
        let path = KeyPath::setting("frames", "range");
        if keys.first.is_some() || keys.last.is_some() {
            let message = format!("both `range = \"{range}\"` and `first` or `last` are given");
            return Err(SceneFault::new(path, message, "give the range or its ends"));
        }
        let ends = range.split_once('-').and_then(|(a, b)| Some((a.trim().parse().ok()?, b.trim().parse().ok()?)));
        let (first, last) = ends.ok_or_else(|| {
            SceneFault::new(path, format!("`{range}` is not a range of frames"), "write it as `range = \"1-48\"`")
        })?;
        Ok(FrameSettings { first, last, rate })
    }

    fn output(&self, side: f64) -> Resolved<OutputSettings> {
        let keys = &self.document.output;
        if keys.formats.is_empty() || keys.parts.is_empty() {
            let key = if keys.formats.is_empty() { "formats" } else { "parts" };
            let message = format!("`{key}` is empty: there is nothing to write");
            return Err(SceneFault::new(
                KeyPath::setting("output", key),
                message,
                "name at least one, or leave it out",
            ));
        }
        Ok(OutputSettings {
            thickness: keys.thickness.unwrap_or(0.1 * side),
            formats: keys.formats.clone(),
            parts: keys.parts.clone(),
            up: keys.up,
            smallest_fragment: keys.smallest_fragment,
        })
    }

    fn colliders(&self, tolerance: f64) -> Resolved<Vec<Collider>> {
        self.document.collider.iter().enumerate().map(|(i, keys)| self.collider(i, keys, tolerance)).collect()
    }

    fn collider(&self, i: usize, keys: &ColliderKeys, tolerance: f64) -> Resolved<Collider> {
        let path = KeyPath::item("collider", i);
        let shape_path = path.then("shape");
        let name = keys.name.clone().unwrap_or_else(|| format!("collider-{}", i + 1));
        if self.document.collider[..i].iter().any(|c| c.name.as_ref() == Some(&name)) {
            let message = format!("two colliders are called `{name}`");
            return Err(SceneFault::new(path.then("name"), message, "give each its own name"));
        }
        let from_region = |region: Region| {
            let center = center_of_area(&region);
            let ring = region.exterior.iter().map(|p| Point::from(p - center)).collect();
            (ColliderShape::Polygon { ring }, center)
        };
        let (shape, origin) = match &keys.shape {
            ColliderShapeKeys::HalfPlane(h) => {
                finite_pair(shape_path.then("half_plane"), "the point of the half-plane", h.point)?;
                (ColliderShape::HalfPlane { normal: unit(Vector::from(h.normal)) }, Point::from(h.point))
            }
            ColliderShapeKeys::Disc(d) => {
                finite_pair(shape_path.then("disc"), "the centre of the disc", d.center)?;
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

    fn selection(&self, path: &KeyPath, select: &Select, scene: &Scene, tolerance: f64) -> Resolved<Selection> {
        let path = path.then("select");
        let body = match &select.body {
            Some(name) => Some(self.body(path.then("body"), name, scene)?),
            None => None,
        };
        let combined = |keys: &str| {
            SceneFault::new(path.clone(), format!("a selection cannot combine {keys}"), "select by one of them")
        };
        match (select.edge, &select.region, &select.near) {
            (Some(_), Some(_), _) => Err(combined("`edge` and `region`")),
            (Some(_), _, Some(_)) => Err(combined("`edge` and `near`")),
            (_, Some(_), Some(_)) => Err(combined("`region` and `near`")),
            (None, Some(_), _) | (None, _, Some(_)) if body.is_some() => {
                Err(combined("`body` with `region` or `near`"))
            }
            _ if select.radius.is_some() != select.near.is_some() => {
                let message = "`near` and `radius` belong together";
                Err(SceneFault::new(path, message, "write `select = { near = [[x, y]], radius = ... }`"))
            }
            (Some(side), None, None) => Ok(Selection::Edge { side, body }),
            (None, Some(shape), None) => {
                let path = path.then("region");
                let mut regions = self.regions(&path, shape, tolerance)?;
                if regions.len() != 1 {
                    let message = format!("the shape has {} separate outlines", regions.len());
                    return Err(SceneFault::new(path, message, "select one outline at a time"));
                }
                Ok(Selection::Region(regions.swap_remove(0)))
            }
            (None, None, Some(near)) => {
                Ok(Selection::Near { points: points(near), radius: select.radius.unwrap_or_default() })
            }
            (None, None, None) => Ok(body.map_or(Selection::All, Selection::Body)),
        }
    }

    /// Index of the one body called `name`.
    fn body(&self, path: KeyPath, name: &str, scene: &Scene) -> Resolved<usize> {
        let names: Vec<&str> = scene.bodies.iter().map(|b| b.name.as_str()).collect();
        names
            .iter()
            .position(|n| *n == name)
            .ok_or_else(|| SceneFault::new(path, format!("there is no body `{name}`"), nearest(name, &names)))
    }

    fn loads(&self, scene: &Scene, tolerance: f64) -> Resolved<Vec<Load>> {
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

    fn supports(&self, scene: &Scene, tolerance: f64) -> Resolved<Vec<Support>> {
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

    fn initial_velocities(&self, scene: &mut Scene, tolerance: f64) -> Resolved<()> {
        for (i, keys) in self.document.initial_velocity.iter().enumerate() {
            let path = KeyPath::item("initial_velocity", i);
            finite_pair(path.then("velocity"), "the initial velocity", keys.velocity)?;
            finite_pair(path.then("angular_velocity"), "the rotation", [keys.angular_velocity, 0.0])?;
            finite_pair(path.then("center"), "the centre of rotation", keys.center)?;
            let selection = self.selection(&path, &keys.select, scene, tolerance)?;
            let only = match &selection {
                Selection::Body(body) | Selection::Edge { body: Some(body), .. } => Some(*body),
                _ => None,
            };
            for (_, body) in scene.bodies.iter_mut().enumerate().filter(|(b, _)| only.is_none_or(|o| o == *b)) {
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

    fn line(&self, path: &KeyPath, line: &Line, tolerance: f64) -> Resolved<Vec<Point>> {
        let points = match line {
            Line::Points(list) => points(list),
            Line::Svg(id) => {
                let path = path.then("svg");
                self.drawing(&path, id)?.line(id, tolerance).map_err(at(&path))?
            }
        };
        finite_points(path, "a point of the line", &points)?;
        if points.len() < 2 || polyline_length(&points) == 0.0 {
            let message = match points.first() {
                Some(&p) => format!("the line has zero length, it lies at {} m", show(p)),
                None => "the line has no points".to_owned(),
            };
            return Err(SceneFault::new(path.clone(), message, "give it at least two different points"));
        }
        if let Some(at) = find_crossing(&[&points], false) {
            let message = format!("the line crosses itself at {} m", show(at));
            return Err(SceneFault::new(path.clone(), message, "draw it without a loop"));
        }
        Ok(points)
    }

    fn cracks(&self, scene: &mut Scene, tolerance: f64) -> Resolved<()> {
        for (i, keys) in self.document.crack.iter().enumerate() {
            let path = KeyPath::item("crack", i);
            let name = keys.name.clone().unwrap_or_else(|| format!("crack-{}", i + 1));
            let line_path = path.then("line");
            let line = self.line(&line_path, &keys.line, tolerance)?;
            let body = self.body_of_crack(&path, keys, &name, &line, scene)?;
            let reach = MOUTH_TOLERANCE * scene.particle_spacing;
            let body_name = scene.bodies[body].name.clone();
            let seated = seat_crack(&line, &mut scene.bodies[body].region, reach).map_err(|(message, remedy)| {
                let message = format!("crack `{name}` is not inside body `{body_name}`: {message}");
                SceneFault::new(line_path.clone(), message, remedy)
            })?;
            let live = live_ends(&path, keys.tips, &name, &seated.points, seated.mouths)?;
            let mut crack = Crack {
                body,
                start_live: live[0],
                end_live: live[1],
                start_guide: None,
                end_guide: None,
                points: seated.points,
                name,
            };
            self.guides(&path, keys, &mut crack, &line, GUIDE_TOLERANCE * scene.particle_spacing, tolerance)?;
            scene.cracks.push(crack);
        }
        Ok(())
    }

    fn body_of_crack(
        &self,
        path: &KeyPath,
        keys: &CrackKeys,
        name: &str,
        line: &[Point],
        scene: &Scene,
    ) -> Resolved<usize> {
        let candidates: Vec<usize> = match &keys.body {
            // A drawing of several outlines: any of the bodies made from it.
            Some(wanted) => {
                let exact = scene.bodies.iter().position(|b| &b.name == wanted);
                let several =
                    (0..scene.bodies.len()).filter(|&b| &self.document.body[self.body_origin[b]].name == wanted);
                exact.map_or_else(|| several.collect(), |b| vec![b])
            }
            None => (0..scene.bodies.len()).collect(),
        };
        match (candidates.as_slice(), &keys.body) {
            ([only], _) => return Ok(*only),
            ([], Some(wanted)) => return self.body(path.then("body"), wanted, scene),
            _ => {}
        }
        let inside: Vec<usize> = candidates
            .iter()
            .copied()
            .filter(|&b| {
                let region = &scene.bodies[b].region;
                let middles = line.windows(2).map(|w| nalgebra::center(&w[0], &w[1]));
                line.iter().copied().chain(middles).any(|p| region.contains(p))
            })
            .collect();
        match inside.as_slice() {
            [only] => Ok(*only),
            [] => {
                let message = format!("crack `{name}` is outside of every body (it starts at {} m)", show(line[0]));
                Err(SceneFault::new(path.then("line"), message, "move it into a body"))
            }
            several => {
                let names: Vec<_> = several.iter().map(|&b| format!("`{}`", scene.bodies[b].name)).collect();
                let message = format!("crack `{name}` runs through the bodies {}", names.join(", "));
                Err(SceneFault::new(path.then("line"), message, "say which one it belongs to: `body = \"...\"`"))
            }
        }
    }

    /// Fits the guides of one crack; `drawn` is its line before it was cut at the outline, `reach` how far off a guide may be.
    fn guides(
        &self,
        path: &KeyPath,
        keys: &CrackKeys,
        crack: &mut Crack,
        drawn: &[Point],
        reach: f64,
        tolerance: f64,
    ) -> Resolved<()> {
        let only_live = match (crack.start_live, crack.end_live) {
            (true, false) => Some(0),
            (false, true) => Some(1),
            _ => None,
        };
        let mut wanted =
            [keys.guide_start.as_ref().map(|g| (g, "guide_start")), keys.guide_end.as_ref().map(|g| (g, "guide_end"))];
        if let Some(guide) = &keys.guide {
            let Some(end) = only_live.filter(|&end| wanted[end].is_none()) else {
                let message = format!("`guide = \"{guide}\"` needs exactly one live tip without a guide of its own");
                return Err(SceneFault::new(
                    path.then("guide"),
                    message,
                    "use `guide_start` or `guide_end`, or name one end in `tips`",
                ));
            };
            wanted[end] = Some((guide, "guide"));
        }
        for (end, (guide, key)) in wanted.into_iter().enumerate().filter_map(|(end, w)| Some((end, w?))) {
            let path = path.then(key);
            let live = [crack.start_live, crack.end_live][end];
            let (Some(&tip), true) = ([crack.points.first(), crack.points.last()][end], live) else {
                let word = ["start", "end"][end];
                let message =
                    format!("guide `{guide}` leads the {word} of crack `{}`, which is no live tip", crack.name);
                return Err(SceneFault::new(path, message, "guide a live tip"));
            };
            let names: Vec<&str> = self.document.guide.iter().map(|g| g.name.as_str()).collect();
            let Some(index) = names.iter().position(|n| n == guide) else {
                return Err(SceneFault::new(path, format!("there is no guide `{guide}`"), nearest(guide, &names)));
            };
            let line_path = KeyPath::item("guide", index).then("line");
            let line = self.line(&line_path, &self.document.guide[index].line, tolerance)?;
            let points = fit_guide(&line, tip, drawn, reach).map_err(|(message, remedy)| {
                let message = format!("guide `{guide}` does not fit crack `{}`: {message}", crack.name);
                SceneFault::new(line_path, message, remedy)
            })?;
            let fitted = Some(Guide { name: guide.clone(), points, strength: 1.0, schedule: Curve::default() });
            *[&mut crack.start_guide, &mut crack.end_guide][end] = fitted;
        }
        Ok(())
    }
}

/// Which ends are live: as named, or every end inside the body.
fn live_ends(
    path: &KeyPath,
    tips: Option<Tips>,
    name: &str,
    points: &[Point],
    mouths: [bool; 2],
) -> Resolved<[bool; 2]> {
    let live = match tips {
        None => [!mouths[0], !mouths[1]],
        Some(Tips::Start) => [true, false],
        Some(Tips::End) => [false, true],
        Some(Tips::Both) => [true, true],
        Some(Tips::None) => [false, false],
    };
    for (end, word) in ["start", "end"].into_iter().enumerate() {
        if live[end] && mouths[end] {
            return Err(live_mouth(path, name, word, points[end * (points.len() - 1)]));
        }
    }
    Ok(live)
}

fn at(path: &KeyPath) -> impl Fn(Complaint) -> SceneFault + use<'_> {
    move |(message, remedy)| SceneFault::new(path.clone(), message, remedy)
}

fn points(list: &[[f64; 2]]) -> Vec<Point> {
    list.iter().map(|&p| Point::from(p)).collect()
}

fn curve(list: &[[f64; 2]]) -> Curve {
    Curve { points: list.iter().map(|&[time, factor]| (time, factor)).collect() }
}

fn rectangle(path: &KeyPath, min: [f64; 2], max: [f64; 2]) -> Resolved<Region> {
    finite_pair(path.then("min"), "`min`", min)?;
    finite_pair(path.then("max"), "`max`", max)?;
    if min[0] >= max[0] || min[1] >= max[1] {
        let message = format!("min = {min:?} is not below and left of max = {max:?}");
        return Err(SceneFault::new(path.clone(), message, "min is the lower left corner, max the upper right one"));
    }
    let exterior = vec![min, [max[0], min[1]], max, [min[0], max[1]]].into_iter().map(Point::from).collect();
    Ok(Region { exterior, holes: Vec::new() })
}

/// Centre of area of a region.
fn center_of_area(region: &Region) -> Point {
    let Some(&origin) = region.exterior.first() else { return Point::origin() };
    let mut moment = Vector::zeros();
    for ring in region.rings() {
        for i in 0..ring.len() {
            let (p, q) = (ring[i] - origin, ring[(i + 1) % ring.len()] - origin);
            moment += (p + q) * ((p.x * q.y - q.x * p.y) / 6.0);
        }
    }
    let area: f64 = region.rings().map(signed_area).sum();
    origin + moment / area
}
