//! The words of `scene.toml`, exactly as a user writes them. [`crate::load()`] turns them into a [`crate::Scene`].
//!
//! Every key is optional unless its documentation says otherwise; unknown keys are refused. The doc comments are the
//! JSON schema's descriptions.

mod cracks;
mod ease;
mod geometry;
mod matter;
mod motion;
mod settings;
mod switch;

pub use cracks::*;
pub use ease::Ease;
pub use geometry::*;
pub use matter::*;
pub use motion::*;
pub use settings::*;
pub use switch::Switch;

use crate::range::ACCELERATION;
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
    #[schemars(transform = ACCELERATION.bounds())]
    pub gravity: [f64; 2],
    /// The SVG drawing that `svg = "id"` refers to.
    pub drawing: Option<Drawing>,
    /// Materials of your own, and changes to the ones that come with Fissure.
    pub material: Vec<MaterialKeys>,
    /// Bodies; at least one.
    pub body: Vec<BodyKeys>,
    /// Parts of bodies that are of another material.
    pub region: Vec<RegionKeys>,
    /// Where bodies are tougher or weaker than their material.
    pub toughness: Vec<ToughnessKeys>,
    /// Cracks that are there from the start.
    pub crack: Vec<CrackKeys>,
    /// Small cracks scattered at random.
    pub flaws: Vec<FlawsKeys>,
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
    /// What bodies and fragments do to each other where they touch.
    pub contact: ContactKeys,
    /// Growth of cracks; every key defaults to the value of the solver's preset.
    pub growth: GrowthKeys,
    /// Which frames to compute.
    pub frames: FrameKeys,
    /// What the take holds of particles.
    pub take: TakeKeys,
    /// Which meshes to write.
    pub output: OutputKeys,
}
