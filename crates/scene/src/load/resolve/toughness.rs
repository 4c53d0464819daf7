//! Patches of toughness: shapes with a factor, and pictures.

use super::{Resolved, Resolver};
use crate::document::ToughnessKeys;
use crate::fault::{KeyPath, SceneFault};
use crate::load::picture::Picture;
use crate::range::TOUGHNESS_FACTOR;
use crate::scene::Scene;
use crate::toughness::{ToughnessImage, ToughnessKind, ToughnessPatch};
use crate::validate::{outside, overlap, validate_corners};
use fissure_plane::{Point, Vector, bounds};

/// Factors that stand for black and white unless the scene says otherwise: a crack needs a 25th of the energy in black.
const BLACK: f64 = 0.2;
const WHITE: f64 = 1.0;
/// Pixels smaller than this, in particle spacings, are averaged: stress is not known any finer, and the manifest of a
/// take, which is written with every frame, keeps the image.
const SMALLEST_PIXEL: f64 = 1.0;

impl<'d> Resolver<'d> {
    pub(super) fn toughness(&mut self, scene: &Scene, tolerance: f64) -> Resolved<Vec<ToughnessPatch>> {
        let mut patches = Vec::new();
        for (i, keys) in self.document.toughness.iter().enumerate() {
            let path = KeyPath::item("toughness", i);
            let kinds = self.toughness_kinds(i, &path, keys, scene, tolerance)?;
            let bodies: Vec<Option<usize>> = match &keys.body {
                Some(_) => self.bodies(path.then("body"), keys.body.as_deref(), scene)?.into_iter().map(Some).collect(),
                None => vec![None],
            };
            for body in bodies {
                patches.extend(kinds.iter().map(|kind| ToughnessPatch { body, kind: kind.clone() }));
            }
            self.origin.toughness.resize(patches.len(), i);
        }
        Ok(patches)
    }

    fn toughness_kinds(
        &self,
        index: usize,
        path: &KeyPath,
        keys: &ToughnessKeys,
        scene: &Scene,
        tolerance: f64,
    ) -> Resolved<Vec<ToughnessKind>> {
        let fault = |key: &str, message: &str, remedy: &str| Err(SceneFault::new(path.then(key), message, remedy));
        let bodies = self.bodies(path.then("body"), keys.body.as_deref(), scene)?;
        match (&keys.shape, keys.factor, self.pictures.get(index).and_then(Option::as_ref)) {
            (Some(_), _, Some(_)) => fault(
                "image",
                "both a `shape` and an `image` are given",
                "keep one, or write two `[[toughness]]`: they multiply",
            ),
            (_, Some(_), Some(_)) => fault(
                "factor",
                "`factor` belongs to a `shape`",
                "say what black and white stand for: `black = ...`, `white = ...`",
            ),
            (None, _, None) => fault(
                "shape",
                "a toughness has neither `shape` nor `image`",
                "add `shape = ...` with `factor = ...`, or `image = \"...png\"`",
            ),
            (Some(_), None, None) => {
                fault("factor", "`shape` lacks its factor", "add `factor = ...`: 1 changes nothing")
            }
            (Some(shape), Some(factor), None) => {
                let only_images = [
                    ("black", keys.black.is_some()),
                    ("white", keys.white.is_some()),
                    ("min", keys.min.is_some()),
                    ("max", keys.max.is_some()),
                ];
                if let Some((key, _)) = only_images.iter().find(|(_, given)| *given) {
                    return fault(key, &format!("`{key}` belongs to an `image`"), "a `shape` has a `factor`");
                }
                let shape_path = path.then("shape");
                let regions = self.sound_regions(&shape_path, "the outline of the toughness", shape, tolerance)?;
                for region in &regions {
                    if bodies.iter().all(|&b| overlap(region, &scene.bodies[b].region) == 0.0) {
                        return Err(outside(shape_path, "the shape does not overlap any body it applies to"));
                    }
                }
                Ok(regions.into_iter().map(|region| ToughnessKind::Region { region, factor }).collect())
            }
            (None, None, Some(picture)) => {
                let corners: Vec<Point> =
                    bodies.iter().flat_map(|&b| scene.bodies[b].region.exterior.clone()).collect();
                let (low, high) = bounds(&corners);
                let (min, max) = (keys.min.map_or(low, Point::from), keys.max.map_or(high, Point::from));
                validate_corners(path, min, max)?;
                let (black, white) = (keys.black.unwrap_or(BLACK), keys.white.unwrap_or(WHITE));
                TOUGHNESS_FACTOR.check(path.then("black"), "the factor of black", black)?;
                TOUGHNESS_FACTOR.check(path.then("white"), "the factor of white", white)?;
                let image = painted(picture, [min, max], [black, white], SMALLEST_PIXEL * scene.particle_spacing);
                Ok(vec![ToughnessKind::Image(image)])
            }
        }
    }
}

/// A picture on a rectangle, in pixels of at least `smallest` [m] unless it has larger ones.
fn painted(picture: &Picture, [min, max]: [Point; 2], [black, white]: [f64; 2], smallest: f64) -> ToughnessImage {
    let most: Vector = (max - min) / smallest;
    // A cast saturates; a rectangle much larger than the bodies only keeps all pixels.
    let (columns, rows, light) = picture.averaged(most.x.ceil().max(1.0) as usize, most.y.ceil().max(1.0) as usize);
    // In this form black and white are themselves to the bit.
    let factors = light.iter().map(|&light| black * (1.0 - light) + white * light).collect();
    ToughnessImage { min, max, columns, rows, factors }
}
