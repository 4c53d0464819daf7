//! Turns what a user wrote into a [`Scene`]: names become indices, shapes become regions, defaults become numbers.

mod bodies;
mod bridges;
mod chord_error;
mod cracks;
mod crumbs;
mod flaws;
mod guides;
mod ligaments;
mod motion;
mod narrow_bodies;
mod origin;
mod selection;
mod settings;
mod shapes;
mod short_cracks;
mod toughness;
mod wish;

use self::chord_error::ChordError;
use super::chord::{Chord, turns};
use super::drawing::LoadedDrawing;
use super::picture::Picture;
use crate::document::Document;
use crate::fault::{KeyPath, SceneFault, Warning};
use crate::range::{ITEMS, LENGTH};
use crate::scene::Scene;
use crate::settings::ContactSettings;
use crate::take_settings::TakeSettings;
use crate::wish::Wish;
use fissure_plane::Vector;
use std::cell::RefCell;

pub(super) use guides::TOLERANCE as GUIDE_TOLERANCE;
pub(crate) use origin::Origin;

type Resolved<T> = Result<T, SceneFault>;

/// Particles along the larger side of the bodies' box, unless the scene says otherwise.
const DEFAULT_RESOLUTION: f64 = 128.0;

/// Resolves one document.
pub(crate) struct Resolver<'d> {
    document: &'d Document,
    drawing: Option<&'d LoadedDrawing>,
    /// For each `[[toughness]]`: its image, if it has one.
    pictures: &'d [Option<Picture>],
    default_name: String,
    origin: Origin,
    /// For each `[[body]]` the chords of the curves of its shape.
    chords: Vec<Vec<Chord>>,
    /// What will hardly go well, told while resolving. Paths count items as in the document.
    warnings: RefCell<Vec<Warning>>,
}

/// A document, resolved.
#[derive(Debug)]
pub(crate) struct Resolution {
    pub(crate) scene: Scene,
    /// What takes the place of its resolution.
    pub(crate) wish: Option<Wish>,
    pub(crate) origin: Origin,
    /// Paths count items as in the document.
    pub(crate) warnings: Vec<Warning>,
}

impl<'d> Resolver<'d> {
    pub(crate) fn new(
        document: &'d Document,
        drawing: Option<&'d LoadedDrawing>,
        pictures: &'d [Option<Picture>],
        default_name: String,
    ) -> Self {
        let origin = Origin { frames_by_range: document.frames.range.is_some(), ..Origin::default() };
        Self { document, drawing, pictures, default_name, origin, chords: Vec::new(), warnings: RefCell::default() }
    }

    /// Tells something that will hardly go well; the path counts items as in the document.
    pub(super) fn warn(&self, warning: Warning) {
        self.warnings.borrow_mut().push(warning);
    }

    /// The scene, validated, with what was told on the way.
    pub(crate) fn resolve(mut self) -> Resolved<Resolution> {
        let (wish, scene) = (self.wish()?, self.scene()?);
        Ok(Resolution { scene, wish, origin: self.origin, warnings: self.warnings.into_inner() })
    }

    fn scene(&mut self) -> Resolved<Scene> {
        let document = self.document;
        if document.body.is_empty() {
            return Err(SceneFault::new(KeyPath::top("body"), "the scene has no body", "add a `[[body]]`"));
        }
        self.count_items()?;
        let (low, high) = self.bodies_box()?;
        let side = (high.x - low.x).max(high.y - low.y);
        // A body without extent is told of by the check of its outline.
        if side > 0.0 {
            LENGTH.check(KeyPath::top("body"), "the larger side of the box around all bodies", side)?;
        }
        let particle_spacing = document.grid.particle_spacing.unwrap_or(side / DEFAULT_RESOLUTION);
        if document.grid.particle_spacing.is_some() {
            LENGTH.check(KeyPath::setting("grid", "particle_spacing"), "the particle spacing", particle_spacing)?;
        }
        let cell_size = document.grid.cell_size.unwrap_or(2.0 * particle_spacing);
        let chord_error = ChordError::new(&document.grid, particle_spacing, cell_size)?;
        let tolerance = chord_error.within(side);
        let (materials, bodies) = self.materials_and_bodies(chord_error, particle_spacing)?;
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
            take: TakeSettings { particles: document.take.particles, precision: document.take.precision },
            output: self.output(side, &frames, cell_size)?,
            colliders: self.colliders(tolerance)?,
            cracks: Vec::new(),
            toughness: Vec::new(),
            loads: Vec::new(),
            supports: Vec::new(),
            materials,
            bodies,
            solver,
            contact: ContactSettings {
                friction: document.contact.friction,
                pairs: Vec::new(),
                restitution: document.contact.restitution,
                fragment_restitution: document.contact.fragment_restitution,
            },
            growth,
        };
        scene.loads = self.loads(&scene, tolerance)?;
        scene.supports = self.supports(&scene, tolerance)?;
        self.initial_velocities(&mut scene, tolerance)?;
        // The bodies must be sound before anything is fitted into them.
        scene.validate().map_err(|fault| self.origin.in_document(fault))?;
        self.narrow_bodies(&scene);
        self.inclusions(&mut scene, tolerance)?;
        scene.contact.pairs = self.pair_frictions(&mut scene.materials)?;
        scene.toughness = self.toughness(&scene, tolerance)?;
        self.cracks(&mut scene, tolerance)?;
        self.flaws(&mut scene, tolerance)?;
        self.pressed_cracks(&mut scene)?;
        // Mouths of cracks have become corners by now.
        for (body, &number) in scene.bodies.iter_mut().zip(&self.origin.bodies) {
            body.turns = turns(&body.region, &self.chords[number]);
        }
        scene.validate().map_err(|fault| self.origin.in_document(fault))?;
        self.short_cracks(&scene);
        self.ligaments(&scene);
        self.bridges(&scene);
        Ok(scene)
    }

    /// That no array of the document has too many items, before anything is made of them.
    fn count_items(&self) -> Resolved<()> {
        let d = self.document;
        let arrays = [
            ("material", d.material.len()),
            ("body", d.body.len()),
            ("region", d.region.len()),
            ("toughness", d.toughness.len()),
            ("crack", d.crack.len()),
            ("flaws", d.flaws.len()),
            ("guide", d.guide.len()),
            ("collider", d.collider.len()),
            ("load", d.load.len()),
            ("support", d.support.len()),
            ("initial_velocity", d.initial_velocity.len()),
            ("contact", d.contact.pairs.len()),
        ];
        arrays.into_iter().try_for_each(|(key, count)| ITEMS.check(&KeyPath::top(key), &format!("`{key}`"), count))
    }
}
