//! Parts of other materials and patches of toughness.

use super::region::overlap;
use super::region::validate_region;
use crate::fault::Check;
use crate::fault::{KeyPath, SceneFault};
use crate::range::{COORDINATE, TOUGHNESS_FACTOR};
use crate::scene::{Body, Inclusion, Scene};
use crate::toughness::{ToughnessImage, ToughnessKind, ToughnessPatch};
use fissure_plane::Point;

impl Scene {
    pub(super) fn validate_inclusion(&self, path: &KeyPath, inclusion: &Inclusion, body: &Body) -> Check {
        if inclusion.material >= self.materials.len() {
            let message = format!("a part of body `{}` has material number {}", body.name, inclusion.material);
            let remedy = format!("there are {}, numbered from 0", self.materials.len());
            return Err(SceneFault::new(path.then("material"), message, remedy));
        }
        let path = path.then("shape");
        validate_region(&path, "the outline of the part", &inclusion.region)?;
        if overlap(&inclusion.region, &body.region) == 0.0 {
            return Err(outside(path, &format!("the part does not overlap body `{}`", body.name)));
        }
        Ok(())
    }

    pub(super) fn validate_toughness(&self, path: &KeyPath, patch: &ToughnessPatch) -> Check {
        if let Some(body) = patch.body.filter(|&b| b >= self.bodies.len()) {
            let message = format!("a toughness has body number {body}");
            let remedy = format!("there are {}, numbered from 0", self.bodies.len());
            return Err(SceneFault::new(path.then("body"), message, remedy));
        }
        match &patch.kind {
            ToughnessKind::Region { region, factor } => {
                TOUGHNESS_FACTOR.check(path.then("factor"), "the factor on the toughness", *factor)?;
                validate_region(&path.then("shape"), "the outline of the toughness", region)
            }
            ToughnessKind::Image(image) => validate_image(path, image),
        }
    }
}

fn validate_image(path: &KeyPath, image: &ToughnessImage) -> Check {
    validate_corners(path, image.min, image.max)?;
    let path = path.then("image");
    if image.columns == 0 || image.rows == 0 || image.factors.len() != image.columns * image.rows {
        let (columns, rows) = (image.columns, image.rows);
        let message = format!("{} factors are given for {columns} x {rows} pixels", image.factors.len());
        return Err(SceneFault::new(path, message, "give one factor for each pixel, and at least one pixel"));
    }
    image.factors.iter().try_for_each(|&f| TOUGHNESS_FACTOR.check(path.clone(), "a factor on the toughness", f))
}

/// The rectangle of an image.
pub(crate) fn validate_corners(path: &KeyPath, min: Point, max: Point) -> Check {
    COORDINATE.check_pair(path.then("min"), "`min`", [min.x, min.y])?;
    COORDINATE.check_pair(path.then("max"), "`max`", [max.x, max.y])?;
    if min.x < max.x && min.y < max.y {
        return Ok(());
    }
    let message = format!("min = [{}, {}] is not below and left of max = [{}, {}]", min.x, min.y, max.x, max.y);
    Err(SceneFault::new(path.then("min"), message, "min is the lower left corner, max the upper right one"))
}

/// The fault of a shape that lies where no body is.
pub(crate) fn outside(path: KeyPath, message: &str) -> SceneFault {
    SceneFault::new(path, message, "move or enlarge the shape so that it reaches into the body")
}
