//! The words of `scene.toml`, exactly as a user writes them. [`crate::load()`] turns them into a [`crate::Scene`].
//!
//! Every key is optional unless its documentation says otherwise; unknown keys are refused. The doc comments are the
//! JSON schema's descriptions.

mod geometry;
mod motion;
mod settings;

pub use geometry::*;
pub use motion::*;
pub use settings::*;

use crate::settings::PlaneState;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A scene file. All values are in SI units: metres, seconds, kilograms, newtons, pascals; y points up.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(title = "Fissure scene")]
pub struct Document {
    /// Name of the scene, used as prefix of the files it makes. Default: the folder's name when the file is called
    /// `scene.toml`, otherwise the file's name without extension.
    pub name: Option<String>,
    /// Plane strain (thick bodies, the default) or plane stress (thin plates).
    pub plane: PlaneState,
    /// Acceleration of gravity [x, y] in m/s². Default: none.
    pub gravity: [f64; 2],
    /// The SVG drawing that `svg = "id"` refers to.
    pub drawing: Option<Drawing>,
    /// Materials of your own, and changes to the ones that come with Fissure.
    pub material: Vec<MaterialKeys>,
    /// Bodies; at least one.
    pub body: Vec<BodyKeys>,
    /// Cracks that are there from the start.
    pub crack: Vec<CrackKeys>,
    /// Drawn paths that crack tips follow.
    pub guide: Vec<GuideKeys>,
    /// Rigid obstacles.
    pub collider: Vec<ColliderKeys>,
    /// Forces and tractions.
    pub load: Vec<LoadKeys>,
    /// Supports: fixed material and material that moves as told.
    pub support: Vec<SupportKeys>,
    /// Velocities at the start.
    pub initial_velocity: Vec<InitialVelocityKeys>,
    /// Resolution.
    pub grid: GridKeys,
    /// Solver; every key defaults to the value of the preset.
    pub solver: SolverKeys,
    /// Growth of cracks; every key defaults to the value of the solver's preset.
    pub growth: GrowthKeys,
    /// Which frames to compute.
    pub frames: FrameKeys,
    /// Which meshes to write.
    pub output: OutputKeys,
}

/// A body.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BodyKeys {
    /// Name, unique among the bodies. Required. A drawing of several separate outlines gives the bodies `name.1`, `name.2`, ...
    pub name: String,
    /// Material: `pmma`, `glass`, `snow`, `jello` or the name of a `[[material]]`. Required.
    pub material: String,
    /// Where the body is. Required.
    pub shape: Shape,
    /// Velocity at the start [x, y] in m/s.
    #[serde(default)]
    pub velocity: [f64; 2],
    /// Rotation at the start, counter-clockwise, in rad/s.
    #[serde(default)]
    pub angular_velocity: f64,
    /// Centre of the rotation [x, y] in m. Default: the body's centre of area.
    pub center: Option<[f64; 2]>,
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
    pub young_modulus: Option<f64>,
    /// Poisson's ratio, above -1 and below 0.5.
    pub poisson_ratio: Option<f64>,
    /// Density in kg/m³.
    pub density: Option<f64>,
    /// Fracture toughness K_Ic in Pa·√m.
    pub fracture_toughness: Option<f64>,
    /// Highest speed of a crack tip in m/s. Default: only `growth.speed_limit` holds.
    pub limiting_speed: Option<f64>,
    /// `false`: elastic; `true`: snow's plasticity; or its values.
    pub plasticity: Option<PlasticityKeys>,
}

/// A crack that is there from the start.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CrackKeys {
    /// Name, unique among the cracks. Default: `crack-1`, `crack-2`, ...
    pub name: Option<String>,
    /// Body the crack runs in. Default: the one body it lies in.
    pub body: Option<String>,
    /// Its line, open. Ends that stick out of the body are cut off at the outline. Required.
    pub line: Line,
    /// Which ends may grow. Default: every end that lies inside the body.
    pub tips: Option<Tips>,
    /// Name of the guide that the only live tip follows.
    pub guide: Option<String>,
    /// Name of the guide that the tip at the first point follows.
    pub guide_start: Option<String>,
    /// Name of the guide that the tip at the last point follows.
    pub guide_end: Option<String>,
}

/// Ends of a crack that may grow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Tips {
    /// The first point.
    Start,
    /// The last point.
    End,
    /// Both ends.
    Both,
    /// Neither.
    None,
}

/// A drawn path for a crack tip. It begins at the tip, or runs along the crack first.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GuideKeys {
    /// Name that cracks refer to. Required.
    pub name: String,
    /// Its line, open. Required.
    pub line: Line,
}
