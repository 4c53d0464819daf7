//! Resolution, solver, growth, frames and output of a scene file.

use super::{Ease, Switch};
use crate::range::{
    ACUTE, AREA, BENDING, CELLS, CRITICAL_COMPRESSION, CRITICAL_STRETCH, DAMPING, FRACTION, FRAME, FRAME_RATE,
    FRICTION, HARDENING, LENGTH, RELEASE_RATIO, SMOOTHING_CELLS, SPEED_FACTOR, TIME_STEP, UNIT, WALL_CELLS, WIDTH,
    pairs,
};
use crate::scene::Plasticity;
use crate::settings::*;
use crate::take_settings::{HeldParticles, Precision};
use schemars::JsonSchema;
use serde::de::Visitor;
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;

/// Resolution.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct GridKeys {
    /// Distance between neighbouring particles in m. Default: the larger side of the bodies' bounding box / 128.
    #[schemars(transform = LENGTH.bounds())]
    pub particle_spacing: Option<f64>,
    /// Distance between neighbouring grid nodes in m, a whole number of particle spacings in the total formulation.
    /// Default: two of them.
    #[schemars(transform = LENGTH.bounds())]
    pub cell_size: Option<f64>,
    /// How far polylines may be off the curves that were drawn in m. Default: a fiftieth of a cell or a quarter of a
    /// millimetre per metre of the body, whichever is less.
    #[schemars(transform = LENGTH.bounds())]
    pub chord_error: Option<f64>,
    /// Instead of spacing and size: the coarsest particles with which the highest K of each tip is within so much, in
    /// per cent, as `"2%"`.
    #[schemars(regex(pattern = r"^[0-9.eE+-]+ *%$"))]
    pub accuracy: Option<String>,
    /// Instead of all of these: the finest particles with which a run takes no longer than so long, meshes included, as
    /// `"30s"`, `"5min"` or `"2h"`.
    #[schemars(regex(pattern = r"^[0-9.eE+-]+ *(s|min|h)$"))]
    pub budget: Option<String>,
}

/// Solver settings; each defaults to the preset's value.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SolverKeys {
    /// Settings to start from: `standard` (default, recommended) or `thesis` (the scheme of Fumoto 2022).
    pub preset: SolverPreset,
    /// Where kernels live: `auto`, `total` or `updated` Lagrangian.
    pub formulation: Option<Formulation>,
    /// What to do when the total formulation leaves its range: `stop` or `switch` to the updated one.
    pub on_distortion: Option<OnDistortion>,
    /// Interpolation: `bilinear`, `gimp`, `quadratic` or `cubic`.
    pub kernel: Option<Kernel>,
    /// Grid to particle transfer (updated formulation): `pic`, `{ flip = 0.95 }`, `apic`, `aflip` or `xpic`.
    pub transfer: Option<Transfer>,
    /// Time step in s, or `"auto"` (default): chosen from the stability limit.
    pub time_step: TimeStep,
    /// Fraction of the stability limit that is used, above 0 up to 1.
    #[schemars(transform = FRACTION.bounds())]
    pub courant: Option<f64>,
    /// Damping: velocities decay as exp(-damping t), in 1/s.
    #[schemars(transform = DAMPING.bounds())]
    pub damping: Option<f64>,
    /// Whether the two faces of a crack push on each other.
    pub crack_contact: Option<bool>,
    /// Coulomb friction between crack faces; `inf`: they stick.
    #[schemars(transform = FRICTION.bounds())]
    pub crack_friction: Option<f64>,
    /// How the material around a tip is divided: `line_crossing` or `partly_cut`.
    pub tip_division: Option<TipDivision>,
    /// How the energy release rate is measured: `contour` or `domain`.
    pub j_method: Option<JMethod>,
    /// Radius of the contour or domain, in cells. Default: four cells, or 3/8 of the way to the nearest edge, kink or
    /// other crack, but at most six.
    #[schemars(transform = CELLS.bounds())]
    pub j_radius: Option<f64>,
    /// Whether the dynamic area term is added to the energy release rate.
    pub area_term: Option<bool>,
    /// How modes are told apart: `opening_displacement` or `interaction`.
    pub mode_split: Option<ModeSplit>,
}

/// A little less than rock rubs with, .6 to .85 (Byerlee 1978, Pure Appl. Geophys. 116, 615). Without any, what has
/// fallen on something slides off it in the end.
const FRICTION_OF_DRY_SOLIDS: f64 = 0.5;

/// What has fallen lies: nothing that breaks is so elastic that it springs back as waves alone would throw it.
const RESTITUTION_OF_FRAGMENTS: f64 = 0.2;

/// What bodies and fragments do to each other where they touch (total formulation; in the updated one the grid keeps
/// them apart, without friction).
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ContactKeys {
    /// Coulomb friction between surfaces; `inf`: they stick. Default: 0.5. Between the two faces of one crack it is
    /// `solver.crack_friction`, against a collider that collider's.
    #[schemars(transform = FRICTION.bounds())]
    pub friction: f64,
    /// Pairs of materials with a friction of their own.
    pub pairs: Vec<PairFrictionKeys>,
    /// The part of the speed, with which their elasticity throws them back, that whole bodies keep when they land; 1:
    /// all. Total formulation. Default: 1.
    #[schemars(transform = UNIT.bounds())]
    pub restitution: f64,
    /// The part of the speed, with which their elasticity throws them back, that pieces keep when they land that have
    /// broken off a body. Default: 0.2.
    #[schemars(transform = UNIT.bounds())]
    pub fragment_restitution: f64,
}

impl Default for ContactKeys {
    fn default() -> Self {
        Self {
            friction: FRICTION_OF_DRY_SOLIDS,
            pairs: Vec::new(),
            restitution: 1.0,
            fragment_restitution: RESTITUTION_OF_FRAGMENTS,
        }
    }
}

/// Friction between two materials.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PairFrictionKeys {
    /// The two materials, in any order; twice the same for what is made of it. Required.
    pub materials: [String; 2],
    /// Coulomb friction; `inf`: they stick. Required.
    #[schemars(transform = FRICTION.bounds())]
    pub friction: f64,
}

/// A time step: `"auto"` or seconds.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum TimeStep {
    /// Chosen from the stability limit.
    #[default]
    #[schemars(with = "AutoWord")]
    Auto,
    /// Seconds.
    Seconds(#[schemars(transform = TIME_STEP.bounds())] f64),
}

#[derive(JsonSchema)]
#[schemars(rename_all = "snake_case")]
#[allow(dead_code, reason = "only describes a word to the JSON schema")]
enum AutoWord {
    Auto,
}

impl<'de> Deserialize<'de> for TimeStep {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct TimeStepVisitor;
        impl Visitor<'_> for TimeStepVisitor {
            type Value = TimeStep;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("\"auto\" or a number of seconds")
            }
            fn visit_str<E: serde::de::Error>(self, word: &str) -> Result<TimeStep, E> {
                if word == "auto" {
                    Ok(TimeStep::Auto)
                } else {
                    Err(E::invalid_value(serde::de::Unexpected::Str(word), &self))
                }
            }
            fn visit_f64<E>(self, seconds: f64) -> Result<TimeStep, E> {
                Ok(TimeStep::Seconds(seconds))
            }
            fn visit_i64<E>(self, seconds: i64) -> Result<TimeStep, E> {
                Ok(TimeStep::Seconds(seconds as f64))
            }
        }
        deserializer.deserialize_any(TimeStepVisitor)
    }
}

/// Growth of cracks.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct GrowthKeys {
    /// Whether cracks grow. Default: true.
    pub enabled: Option<bool>,
    /// Length of one increment, in cells: how far a tip goes before it looks for its direction again.
    #[schemars(transform = CELLS.bounds())]
    pub increment: Option<f64>,
    /// How much cracks bend: 0 straight on, 1 physical (default), above 1 exaggerated. Changes the direction only,
    /// never the moment.
    #[schemars(transform = BENDING.bounds())]
    pub bending: Option<f64>,
    /// Highest speed of a tip as a fraction of the Rayleigh wave speed, above 0 up to 1.
    #[schemars(transform = FRACTION.bounds())]
    pub speed_limit: Option<f64>,
    /// Factor on `speed_limit` over time: [[frame, factor], ...] with rising frames; 0 holds all tips.
    #[schemars(transform = pairs(FRAME, SPEED_FACTOR))]
    pub speed_keyframes: Vec<[f64; 2]>,
    /// How that factor goes from one keyframe to the next: `linear` (default), `in` (slow at first), `out` (slow at
    /// last) or `in-out`.
    pub speed_ease: Ease,
    /// Whether tips divide into two. `false` (default), `true`, or values.
    pub branching: Option<Switch<BranchingKeys>>,
}

/// When a tip divides into two, and how.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct BranchingKeys {
    /// A tip divides when what it would release at rest is this many times what one tip needs, above 1. Default: 3.
    #[schemars(transform = RELEASE_RATIO.bounds())]
    pub release_ratio: Option<f64>,
    /// Angle in degrees between each new tip and the old direction, above 0 and below 90. Default: 27.
    #[schemars(transform = ACUTE.bounds())]
    pub half_angle: Option<f64>,
    /// Least length of crack in m between two divisions. Default: 12 cells.
    #[schemars(transform = LENGTH.bounds())]
    pub spacing: Option<f64>,
}

/// Which frames to compute. The first one is the state at rest, time 0.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct FrameKeys {
    /// Number of the first frame, at least 0. Default: 1.
    #[schemars(range(min = 0))]
    pub first: Option<i64>,
    /// Number of the last frame. Default: 47 frames after the first.
    pub last: Option<i64>,
    /// First and last frame in one, as `"1-48"`; instead of `first` and `last`.
    pub range: Option<String>,
    /// Frames per second of simulated time. Default: 24. Cracks are fast: slow motion needs thousands.
    #[schemars(transform = FRAME_RATE.bounds())]
    pub rate: Option<f64>,
    /// Frames per second at which the sequence is shown. Default: 24. Velocities of meshes are per second of playback.
    #[schemars(transform = FRAME_RATE.bounds())]
    pub playback: Option<f64>,
}

/// What the take holds of particles: less is smaller on disk, and says less. The saved state has all of them.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TakeKeys {
    /// Which particles: `full` (default) all, `surface` those within a cell of an outline or a crack, or `none`.
    pub particles: HeldParticles,
    /// Numbers of particles in `double` (default) or in `single` precision.
    pub precision: Precision,
}

/// Which meshes to write.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct OutputKeys {
    /// Thickness of the solids in m. Default: a tenth of the larger side of the bodies' bounding box.
    #[schemars(transform = LENGTH.bounds())]
    pub thickness: Option<f64>,
    /// File formats: `glb`, `ply`, `obj`, `usda`, `vtk`, `svg`, `glb_sequence`, `glb_rigid`. Default: `glb` and `ply`.
    pub formats: Vec<Format>,
    /// What to write: `cracked` (default), `body`, `faces`, `collider`, `particles`.
    pub parts: Vec<Part>,
    /// Axis that points up in PLY files: `y` or `z` (default). GLB is always y up.
    pub up: UpAxis,
    /// Fragments of less area than this in m² are dropped. Default: 0, none.
    #[schemars(transform = AREA.bounds())]
    pub smallest_fragment: f64,
    /// Cracks inside a fragment with walls: `open` (default), or `all`, closed ones too.
    pub walls: Walls,
    /// Longest edges of triangles within the caps in m, for displacement and bending. Default: as long as may be.
    #[schemars(transform = LENGTH.bounds())]
    pub cap_size: Option<f64>,
    /// Where the material is cut: `opening` (default) as it is in each frame, `rest` once for all frames until a crack
    /// grows, so that vertices keep their numbers.
    pub cut: Cut,
    /// How far the paths of cracks that grew freely may be moved to be smooth, in cells. Default: 0.5; 0: not at all.
    #[schemars(transform = SMOOTHING_CELLS.bounds())]
    pub smoothing: f64,
    /// How long edges of crack walls may be where their path is straight, in cells: 0.5 makes meshes of half the size.
    /// Default: 0, as cracks grew, about a quarter of a cell.
    #[schemars(transform = WALL_CELLS.bounds())]
    pub wall_step: f64,
    /// How rough the walls of cracks are shown. Default: as the cracks are.
    pub roughness: Option<RoughnessKeys>,
    /// Width in m of a bevel on the edges between walls of cracks and caps: at most a quarter of a cell and of the
    /// thickness. Default: 0, none.
    #[schemars(transform = WIDTH.bounds())]
    pub bevel: f64,
    /// Whether meshes have a second set of texture coordinates, in metres at rest, in GLB, PLY and USD. Default: false.
    pub uv_in_metres: bool,
    /// What crack walls tell of how they came about, in GLB, PLY, USD and VTK: `crack_age`, `mouth_distance`, `mode_1`.
    /// Default: nothing.
    pub attributes: Vec<Attribute>,
    /// How wide cracks are shown. Default: as they are.
    pub opening: Option<OpeningKeys>,
    /// How far fragments are shown apart. Default: where they are.
    pub explode: Option<ExplodeKeys>,
}

/// How rough the walls of cracks are shown: both faces of a crack alike, less towards the caps, outlines and tips.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RoughnessKeys {
    /// Most that a wall is moved in m: half a cell at most. Default: a fifth of a cell.
    #[schemars(transform = LENGTH.bounds())]
    pub amplitude: Option<f64>,
    /// Length in m over which a wall is moved about alike: four amplitudes or more. Default: ten amplitudes.
    #[schemars(transform = LENGTH.bounds())]
    pub length: Option<f64>,
    /// Number that stands for one relief. Default: 0.
    pub seed: u64,
}

/// How wide cracks are shown, whatever the simulation says.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct OpeningKeys {
    /// Factor on the opening: 1 (default) is what was simulated, 0 closes all cracks. Openings above two cells grow no
    /// further, so that fragments that fly apart keep their shape.
    #[schemars(transform = SPEED_FACTOR.bounds())]
    pub factor: Option<f64>,
    /// The factor over time: [[frame, factor], ...] with rising frames; instead of `factor`.
    #[schemars(transform = pairs(FRAME, SPEED_FACTOR))]
    pub keyframes: Vec<[f64; 2]>,
    /// How the factor goes from one keyframe to the next: `linear` (default), `in`, `out` or `in-out`.
    pub ease: Ease,
    /// Width in m that every crack has at least, before the factor. Default: 0.
    #[schemars(transform = WIDTH.bounds())]
    pub least: f64,
    /// Distance in m from a tip at which the least width is reached. Default: eight cells.
    #[schemars(transform = LENGTH.bounds())]
    pub falloff: Option<f64>,
}

/// How far fragments are shown apart.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ExplodeKeys {
    /// Each fragment is moved away from the middle of its body by so many times its distance from it. Default: 0.
    #[schemars(transform = SPEED_FACTOR.bounds())]
    pub factor: Option<f64>,
    /// The factor over time: [[frame, factor], ...] with rising frames; instead of `factor`.
    #[schemars(transform = pairs(FRAME, SPEED_FACTOR))]
    pub keyframes: Vec<[f64; 2]>,
    /// How the factor goes from one keyframe to the next: `linear` (default), `in`, `out` or `in-out`.
    pub ease: Ease,
}

impl Default for OutputKeys {
    fn default() -> Self {
        Self {
            thickness: None,
            formats: vec![Format::Glb, Format::Ply],
            parts: vec![Part::Cracked],
            up: UpAxis::default(),
            smallest_fragment: 0.0,
            walls: Walls::default(),
            cap_size: None,
            cut: Cut::default(),
            smoothing: SMOOTHING,
            wall_step: 0.0,
            roughness: None,
            bevel: 0.0,
            uv_in_metres: false,
            attributes: Vec::new(),
            opening: None,
            explode: None,
        }
    }
}

/// Values of snow plasticity (Stomakhin et al. 2013); each defaults to that of snow.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PlasticityValues {
    /// Critical compression θ_c: strain beyond it is plastic.
    #[schemars(transform = CRITICAL_COMPRESSION.bounds())]
    pub critical_compression: Option<f64>,
    /// Critical stretch θ_s: strain beyond it is plastic.
    #[schemars(transform = CRITICAL_STRETCH.bounds())]
    pub critical_stretch: Option<f64>,
    /// Hardening ξ: how much compressed material stiffens.
    #[schemars(transform = HARDENING.bounds())]
    pub hardening: Option<f64>,
}

impl PlasticityValues {
    /// The plasticity meant, with `snow`'s values where none are given.
    pub fn resolve(self, snow: Plasticity) -> Plasticity {
        Plasticity {
            critical_compression: self.critical_compression.unwrap_or(snow.critical_compression),
            critical_stretch: self.critical_stretch.unwrap_or(snow.critical_stretch),
            hardening: self.hardening.unwrap_or(snow.hardening),
        }
    }
}
