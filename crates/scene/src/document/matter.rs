//! Bodies, materials and toughness of a scene file.

use super::{PlasticityValues, Shape, Switch};
use crate::range::{
    ANGULAR_VELOCITY, COORDINATE, CRACK_SPEED, DENSITY, FRACTURE_TOUGHNESS, POISSON_RATIO, TOUGHNESS_FACTOR, VELOCITY,
    YOUNG_MODULUS,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A body.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BodyKeys {
    /// Name, unique among the bodies. Required. A drawing of several separate outlines gives a body of several parts,
    /// `name.1`, `name.2`, ...: its name means all of them, that of a part the part.
    pub name: String,
    /// Material: `pmma`, `glass`, `snow`, `jello` or the name of a `[[material]]`. Required.
    pub material: String,
    /// Where the body is. Required.
    pub shape: Shape,
    /// Velocity at the start [x, y] in m/s.
    #[serde(default)]
    #[schemars(transform = VELOCITY.bounds())]
    pub velocity: [f64; 2],
    /// Rotation at the start, counter-clockwise, in rad/s.
    #[serde(default)]
    #[schemars(transform = ANGULAR_VELOCITY.bounds())]
    pub angular_velocity: f64,
    /// Centre of the rotation [x, y] in m. Default: the body's centre of area, all parts together.
    #[schemars(transform = COORDINATE.bounds())]
    pub center: Option<[f64; 2]>,
}

/// A part of a body that is of another material, firmly bonded to the rest. Where parts overlap the later one holds.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionKeys {
    /// Body it is a part of. Default: every body the shape overlaps.
    pub body: Option<String>,
    /// Material of the part. Required.
    pub material: String,
    /// Where it is; only what lies inside the body counts. Required.
    pub shape: Shape,
}

/// A material: values not given are taken from `base`.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MaterialKeys {
    /// Name that bodies refer to. Required. The name of a material that comes with Fissure changes that one.
    pub name: String,
    /// Material to take the values from that are not given here.
    pub base: Option<String>,
    /// Young's modulus in Pa.
    #[schemars(transform = YOUNG_MODULUS.bounds())]
    pub young_modulus: Option<f64>,
    /// Poisson's ratio, above -1 and below 0.5.
    #[schemars(transform = POISSON_RATIO.bounds())]
    pub poisson_ratio: Option<f64>,
    /// Density in kg/m³.
    #[schemars(transform = DENSITY.bounds())]
    pub density: Option<f64>,
    /// Fracture toughness K_Ic in Pa·√m.
    #[schemars(transform = FRACTURE_TOUGHNESS.bounds())]
    pub fracture_toughness: Option<f64>,
    /// Highest speed of a crack tip in m/s. Default: only `growth.speed_limit` holds.
    #[schemars(transform = CRACK_SPEED.bounds())]
    pub limiting_speed: Option<f64>,
    /// `false`: elastic; `true`: snow's plasticity; or its values.
    pub plasticity: Option<Switch<PlasticityValues>>,
}

/// A factor on the fracture toughness: over a `shape` (with `factor`), or painted (an `image`). Where several apply
/// they multiply.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ToughnessKeys {
    /// Body it applies to. Default: all.
    pub body: Option<String>,
    /// Where `factor` applies.
    pub shape: Option<Shape>,
    /// Factor on the fracture toughness inside `shape`, above 0.
    #[schemars(transform = TOUGHNESS_FACTOR.bounds())]
    pub factor: Option<f64>,
    /// PNG, relative to the scene file, that paints the factor in shades of grey. Colours count by their luminance,
    /// what is transparent counts as white. Detail finer than the particle spacing is averaged.
    pub image: Option<PathBuf>,
    /// Factor where the image is black, above 0. Default: 0.2.
    #[schemars(transform = TOUGHNESS_FACTOR.bounds())]
    pub black: Option<f64>,
    /// Factor where the image is white, above 0. Default: 1.
    #[schemars(transform = TOUGHNESS_FACTOR.bounds())]
    pub white: Option<f64>,
    /// Lower left corner [x, y] in m of the rectangle the image covers. Default: of the bounding box of its bodies.
    #[schemars(transform = COORDINATE.bounds())]
    pub min: Option<[f64; 2]>,
    /// Upper right corner [x, y] in m of the rectangle the image covers. Default: of the bounding box of its bodies.
    #[schemars(transform = COORDINATE.bounds())]
    pub max: Option<[f64; 2]>,
}
