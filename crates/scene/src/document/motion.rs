//! What moves and holds the bodies of a scene file: colliders, loads, supports, velocities.

use super::{Ease, Shape};
use crate::range::{
    ANGULAR_VELOCITY, COORDINATE, CURVE_FACTOR, DEGREES, FORCE, FRICTION, LENGTH, PRESSURE, TIME, TRACTION, VELOCITY,
    pairs,
};
use crate::scene::{BoxSide, Contact};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A rigid obstacle.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ColliderKeys {
    /// Name, unique among the colliders. Default: `collider-1`, `collider-2`, ...
    pub name: Option<String>,
    /// Where it is, before `keyframes` move it. Required.
    pub shape: ColliderShapeKeys,
    /// What happens at contact: `separate` (default; pushed out, may leave), `slip` (stays on the surface, slides) or
    /// `stick` (takes the collider's velocity).
    #[serde(default)]
    pub contact: Contact,
    /// Coulomb friction for `separate` and `slip`. Default: 0.
    #[serde(default)]
    #[schemars(transform = FRICTION.bounds())]
    pub friction: f64,
    /// Motion: at rest before the first keyframe and after the last. Default: at rest.
    #[serde(default)]
    pub keyframes: Vec<Keyframe>,
    /// How it goes from one keyframe to the next: `linear` (default), `in` (slow at first), `out` (slow at last) or
    /// `in-out`.
    #[serde(default)]
    pub ease: Ease,
}

/// Shape of a collider: one of these.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ColliderShapeKeys {
    /// Everything on one side of a line. Turns about `point`.
    HalfPlane(HalfPlaneKeys),
    /// Disc. Turns about its centre.
    Disc(DiscKeys),
    /// Axis-parallel rectangle. Turns about its centre.
    Box(BoxKeys),
    /// Simple polygon `[[x, y], ...]` in m. Turns about its centre of area.
    Polygon(#[schemars(transform = COORDINATE.bounds())] Vec<[f64; 2]>),
    /// Element of the drawing, by id: one closed outline without holes. Turns about its centre of area.
    Svg(String),
}

/// Everything on one side of a line.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HalfPlaneKeys {
    /// A point [x, y] of the surface in m.
    #[schemars(transform = COORDINATE.bounds())]
    pub point: [f64; 2],
    /// Direction [x, y] out of the obstacle; any length. Default: up.
    #[serde(default = "up")]
    pub normal: [f64; 2],
}

fn up() -> [f64; 2] {
    [0.0, 1.0]
}

/// Disc.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DiscKeys {
    /// Centre [x, y] in m.
    #[schemars(transform = COORDINATE.bounds())]
    pub center: [f64; 2],
    /// Radius in m.
    #[schemars(transform = LENGTH.bounds())]
    pub radius: f64,
}

/// Axis-parallel rectangle.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxKeys {
    /// Lower left corner [x, y] in m.
    #[schemars(transform = COORDINATE.bounds())]
    pub min: [f64; 2],
    /// Upper right corner [x, y] in m.
    #[schemars(transform = COORDINATE.bounds())]
    pub max: [f64; 2],
}

/// Where a collider is at one moment, relative to where it was drawn.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Keyframe {
    /// Time in s; rising from keyframe to keyframe.
    #[schemars(transform = TIME.bounds())]
    pub time: f64,
    /// Displacement [x, y] in m.
    #[serde(default)]
    #[schemars(transform = COORDINATE.bounds())]
    pub position: [f64; 2],
    /// Turn in degrees, counter-clockwise.
    #[serde(default)]
    #[schemars(transform = DEGREES.bounds())]
    pub angle: f64,
}

/// Which material is meant. Without any key: everything. `body` alone: that body; `edge` and a drawn line may be
/// combined with `body`. The name of a body of several parts means all of them, `name.1` one part.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Select {
    /// The layer of particles along one side of the bodies' bounding box: `left`, `right`, `bottom` or `top`. Of a body
    /// of several parts that is the box around all of them: the layer is of the parts that reach that side.
    pub edge: Option<BoxSide>,
    /// Name of a body.
    pub body: Option<String>,
    /// Material inside a shape (its edges included).
    pub region: Option<Shape>,
    /// Element of the drawing, by id. An open line selects the layer of particles along the edge it is drawn on, not
    /// farther than a particle spacing from it; a closed shape selects the material inside it.
    pub svg: Option<String>,
    /// Material within `radius` of these points [[x, y], ...] in m.
    #[schemars(transform = COORDINATE.bounds())]
    pub near: Option<Vec<[f64; 2]>>,
    /// Distance in m; needs `near`.
    #[schemars(transform = LENGTH.bounds())]
    pub radius: Option<f64>,
    /// Name of a crack: both its faces, for a load with a `pressure`. The name of a crack in several pieces means all
    /// of them, `name.1` one piece.
    pub crack: Option<String>,
}

/// A load: give exactly one of `force`, `traction`, `pressure` and `per_point`.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadKeys {
    /// Material the load acts on. Default: everything.
    #[serde(default)]
    pub select: Select,
    /// Total force [x, y] per metre of thickness in N/m, shared among all the selected material by its volume.
    #[schemars(transform = FORCE.bounds())]
    pub force: Option<[f64; 2]>,
    /// Force per area [x, y] in Pa on the selected edge; needs `select = { edge = ... }` or an open line of the
    /// drawing.
    #[schemars(transform = TRACTION.bounds())]
    pub traction: Option<[f64; 2]>,
    /// Pressure in Pa on the selected edges or, with `select = { crack = ... }`, on both faces of a crack, on what it
    /// grows and on what branches off it. It pushes into the material, along the normal of the edge or face as it is
    /// then. A selected body or region means all edges of it.
    #[schemars(transform = PRESSURE.bounds())]
    pub pressure: Option<f64>,
    /// Forces on single particles.
    pub per_point: Option<Vec<PointForce>>,
    /// Factor over time, [[time in s, factor], ...] with rising times. Default: always 1.
    #[serde(default)]
    #[schemars(transform = pairs(TIME, CURVE_FACTOR))]
    pub curve: Vec<[f64; 2]>,
    /// How the factor goes from one point of `curve` to the next: `linear` (default), `in` (slow at first), `out` (slow
    /// at last) or `in-out`.
    #[serde(default)]
    pub ease: Ease,
}

/// A force on the particle nearest to a point.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointForce {
    /// Place [x, y] in m.
    #[schemars(transform = COORDINATE.bounds())]
    pub at: [f64; 2],
    /// Force [x, y] per metre of thickness in N/m.
    #[schemars(transform = FORCE.bounds())]
    pub force: [f64; 2],
}

/// A support: give `fix`, or `velocity_x` and/or `velocity_y`, or `displacement_x` and/or `displacement_y`.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SupportKeys {
    /// Material that is held. Default: everything.
    #[serde(default)]
    pub select: Select,
    /// Directions that are held still.
    pub fix: Option<Fix>,
    /// Velocity along x in m/s; without it the material is free along x.
    #[schemars(transform = VELOCITY.bounds())]
    pub velocity_x: Option<f64>,
    /// Velocity along y in m/s; without it the material is free along y.
    #[schemars(transform = VELOCITY.bounds())]
    pub velocity_y: Option<f64>,
    /// Displacement along x in m where the factor of `curve` is 1; the material is free along y unless `displacement_y`
    /// is given.
    #[schemars(transform = COORDINATE.bounds())]
    pub displacement_x: Option<f64>,
    /// Displacement along y in m where the factor of `curve` is 1.
    #[schemars(transform = COORDINATE.bounds())]
    pub displacement_y: Option<f64>,
    /// Factor on the velocity or displacement over time, [[time in s, factor], ...] with rising times. Default: always
    /// 1; a displacement needs one, which begins at 0.
    #[serde(default)]
    #[schemars(transform = pairs(TIME, CURVE_FACTOR))]
    pub curve: Vec<[f64; 2]>,
    /// How the factor goes from one point of `curve` to the next: `linear` (default), `in` (slow at first), `out` (slow
    /// at last) or `in-out`.
    #[serde(default)]
    pub ease: Ease,
}

/// Directions that are held still.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Fix {
    /// Along x.
    X,
    /// Along y.
    Y,
    /// Both.
    Both,
}

/// A velocity at the start, added to that of the bodies.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InitialVelocityKeys {
    /// Material that gets it. Default: everything.
    #[serde(default)]
    pub select: Select,
    /// Velocity [x, y] in m/s.
    #[serde(default)]
    #[schemars(transform = VELOCITY.bounds())]
    pub velocity: [f64; 2],
    /// Rotation, counter-clockwise, in rad/s.
    #[serde(default)]
    #[schemars(transform = ANGULAR_VELOCITY.bounds())]
    pub angular_velocity: f64,
    /// Centre of the rotation [x, y] in m. Default: the origin.
    #[serde(default)]
    #[schemars(transform = COORDINATE.bounds())]
    pub center: [f64; 2],
}
