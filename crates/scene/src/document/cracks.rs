//! Cracks, guides and flaws of a scene file.

use super::{Ease, Line, Shape};
use crate::range::{DEGREES, DEGREES_APART, FLAW_DENSITY, FRAME, FRAMES_LONG, LENGTH, SPREAD, UNIT, pairs};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A crack that is there from the start.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CrackKeys {
    /// Name, unique among the cracks. Default: `crack-1`, `crack-2`, ...
    pub name: Option<String>,
    /// Body the crack runs in. Default: all it runs through.
    pub body: Option<String>,
    /// Its line, open. Ends that stick out of the body are cut off at the outline; an end on the line of another crack
    /// opens into that one. A line across holes, gaps or several bodies gives a crack for each piece in the material,
    /// `name.1`, `name.2`, ... from its first point on, open where it meets an outline. Required.
    pub line: Line,
    /// Which ends may grow. Default: every end that lies inside the body and on no other crack.
    pub tips: Option<Tips>,
    /// Name of the guide that the only live tip follows.
    pub guide: Option<String>,
    /// Name of the guide that the tip at the first point of the line follows.
    pub guide_start: Option<String>,
    /// Name of the guide that the tip at the last point of the line follows.
    pub guide_end: Option<String>,
    /// Whether its tips, and those of its branches, run across other cracks. Default: false, they end on them.
    #[serde(default)]
    pub crosses: bool,
}

/// Ends of a crack that may grow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Tips {
    /// The first point.
    Start,
    /// The last point.
    End,
    /// Both ends.
    #[default]
    Both,
    /// Neither.
    None,
}

impl Tips {
    /// Whether the first and the last point may grow.
    pub fn live(self) -> [bool; 2] {
        [matches!(self, Self::Start | Self::Both), matches!(self, Self::End | Self::Both)]
    }
}

/// A drawn path for a crack tip. It begins at the tip, or runs along the crack first.
///
/// A guide that no crack refers to, with an end on another guide, is a branch of that one: a crack begins there when
/// the tip on the other guide has passed. A crack with an end on a guide of strength 1 opens into the crack that
/// passes.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GuideKeys {
    /// Name that cracks refer to. Required.
    pub name: String,
    /// Its line, open. Required.
    pub line: Line,
    /// How much the path decides where the crack goes: 0 not at all, 1 (default) exactly along it, between them a blend
    /// of the drawn and the physical direction.
    #[schemars(transform = UNIT.bounds())]
    pub strength: Option<f64>,
    /// When the crack is where: [[frame, fraction of the path's length, 0 to 1], ...], frames rising, fractions never
    /// falling. Default: fracture mechanics decide when the crack grows.
    #[serde(default)]
    #[schemars(transform = pairs(FRAME, UNIT))]
    pub keyframes: Vec<[f64; 2]>,
    /// How the crack goes from one keyframe to the next: `linear` (default), `in` (slow at first), `out` (slow at last)
    /// or `in-out`.
    #[serde(default)]
    pub ease: Ease,
    /// Name of the guide that it is a branch of. Default: the one that one of its ends lies on.
    pub branch_of: Option<String>,
    /// Of a branch: frames for which it waits when the tip on the other guide has passed. Default: 0.
    #[schemars(transform = FRAMES_LONG.bounds())]
    pub delay: Option<f64>,
    /// Of a branch without `keyframes`: frames in which it runs along its guide, as `ease` says. Default: fracture
    /// mechanics decide.
    #[schemars(transform = FRAMES_LONG.bounds())]
    pub duration: Option<f64>,
}

/// Small straight cracks scattered at random: the same seed gives the same flaws on every machine. Give `density` or
/// `count`.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FlawsKeys {
    /// Name; the flaws are the cracks `name.1`, `name.2`, ... Default: `flaws-1`, `flaws-2`, ...
    pub name: Option<String>,
    /// Body they lie in. Default: all bodies.
    pub body: Option<String>,
    /// Only flaws with their centre inside this shape.
    pub shape: Option<Shape>,
    /// Flaws per m².
    #[schemars(transform = FLAW_DENSITY.bounds())]
    pub density: Option<f64>,
    /// Number of flaws.
    pub count: Option<u32>,
    /// Mean length in m. Required. Several cells, for the grid to see them as cracks.
    #[schemars(transform = LENGTH.bounds())]
    pub length: f64,
    /// Lengths vary evenly by this part of the mean, 0 to below 1. Default: 0, all of the same length.
    #[serde(default)]
    #[schemars(transform = SPREAD.bounds())]
    pub length_spread: f64,
    /// Direction in degrees, counter-clockwise from x. Default: with `angle_spread` 0, otherwise all directions.
    #[schemars(transform = DEGREES.bounds())]
    pub angle: Option<f64>,
    /// Directions vary evenly by this much to either side of `angle`, in degrees. Default: with `angle` 0, otherwise
    /// 90: all directions.
    #[schemars(transform = DEGREES_APART.bounds())]
    pub angle_spread: Option<f64>,
    /// Number that stands for one arrangement. Default: 0.
    #[serde(default)]
    pub seed: u64,
    /// Least distance in m from the outline, from cracks and from other flaws. Default: two cells.
    #[schemars(transform = LENGTH.bounds())]
    pub margin: Option<f64>,
    /// Which ends may grow. Default: both.
    #[serde(default)]
    pub tips: Tips,
}
