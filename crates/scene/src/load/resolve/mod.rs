//! Turns what a user wrote into a [`Scene`]: names become indices, shapes become regions, defaults become numbers.

mod bodies;
mod cracks;
mod flaws;
mod motion;
mod settings;
mod shapes;
mod toughness;

use super::drawing::LoadedDrawing;
use super::picture::Picture;
use crate::document::Document;
use crate::fault::{Key, KeyPath, SceneFault};
use crate::geometry::Vector;
use crate::scene::Scene;
use crate::validate::positive;

type Resolved<T> = Result<T, SceneFault>;

/// Particles along the larger side of the bodies' box, unless the scene says otherwise.
const DEFAULT_RESOLUTION: f64 = 128.0;
/// Curves are flattened to this part of the particle spacing.
const FLATTENING: f64 = 1.0 / 20.0;

/// Resolves one document.
pub(crate) struct Resolver<'d> {
    document: &'d Document,
    drawing: Option<&'d LoadedDrawing>,
    /// For each `[[toughness]]`: its image, if it has one.
    pictures: &'d [Option<Picture>],
    default_name: String,
    /// For each body of the scene: which `[[body]]` it comes from.
    body_origin: Vec<usize>,
    /// For each material of the scene: which `[[material]]` it comes from.
    material_origin: Vec<Option<usize>>,
    /// For each patch of toughness of the scene: which `[[toughness]]` it comes from.
    toughness_origin: Vec<usize>,
}

impl<'d> Resolver<'d> {
    pub(crate) fn new(
        document: &'d Document,
        drawing: Option<&'d LoadedDrawing>,
        pictures: &'d [Option<Picture>],
        default_name: String,
    ) -> Self {
        let (body_origin, material_origin, toughness_origin) = (Vec::new(), Vec::new(), Vec::new());
        Self { document, drawing, pictures, default_name, body_origin, material_origin, toughness_origin }
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
        let cell_size = document.grid.cell_size.unwrap_or(2.0 * particle_spacing);
        let frames = self.frames()?;
        let solver = self.solver(&materials);
        let growth = self.growth(&frames, cell_size)?;
        let mut scene = Scene {
            name: document.name.clone().unwrap_or_else(|| self.default_name.clone()),
            hash: String::new(),
            plane: document.plane,
            gravity: Vector::from(document.gravity),
            particle_spacing,
            cell_size,
            frames,
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
        // The bodies must be sound before anything is fitted into them.
        scene.validate().map_err(|fault| self.in_document(fault))?;
        self.inclusions(&mut scene, tolerance)?;
        scene.toughness = self.toughness(&scene, tolerance)?;
        self.cracks(&mut scene, tolerance)?;
        self.flaws(&mut scene, tolerance)?;
        scene.validate().map_err(|fault| self.in_document(fault))?;
        Ok(scene)
    }

    /// A fault's path, counted as in the document.
    fn in_document(&self, mut fault: SceneFault) -> SceneFault {
        if let [Key::Name(array), Key::Index(index), ..] = fault.path.0.as_mut_slice() {
            match array.as_str() {
                "body" => *index = self.body_origin.get(*index).copied().unwrap_or(*index),
                "material" => *index = self.material_origin.get(*index).copied().flatten().unwrap_or(usize::MAX),
                "toughness" => *index = self.toughness_origin.get(*index).copied().unwrap_or(*index),
                // Only cracks that were scattered come after those that were drawn.
                "crack" if *index >= self.document.crack.len() => fault.path = KeyPath::top("flaws"),
                _ => {}
            }
        }
        fault
    }
}
