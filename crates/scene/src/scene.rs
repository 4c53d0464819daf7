//! A scene, complete and validated: everything in SI units, every reference resolved.

use crate::curve::Curve;
use crate::frame::{End, Pose};
use crate::settings::{ContactSettings, FrameSettings, GrowthSettings, OutputSettings, PlaneState, SolverSettings};
use crate::take_settings::TakeSettings;
use crate::toughness::ToughnessPatch;
use fissure_plane::{Point, Region, Vector};
use serde::{Deserialize, Serialize};

/// What the solver is asked to compute. Made by [`crate::load`]; every number is finite and in its range.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Name, used as prefix of files.
    pub name: String,
    /// [`Scene::simulation_hash`]: of all that the frames depend on.
    pub hash: String,
    /// Plane strain or plane stress.
    pub plane: PlaneState,
    /// Materials that bodies refer to by index.
    pub materials: Vec<Material>,
    /// Bodies.
    pub bodies: Vec<Body>,
    /// Initial cracks.
    pub cracks: Vec<Crack>,
    /// Where bodies are tougher or weaker than their material; see [`Scene::toughness_factor`].
    pub toughness: Vec<ToughnessPatch>,
    /// Rigid obstacles.
    pub colliders: Vec<Collider>,
    /// Acceleration of gravity [m/s²].
    pub gravity: Vector,
    /// Loads.
    pub loads: Vec<Load>,
    /// Supports and prescribed motions.
    pub supports: Vec<Support>,
    /// Distance between neighbouring particles [m].
    pub particle_spacing: f64,
    /// Distance between neighbouring grid nodes h [m].
    pub cell_size: f64,
    /// Solver.
    pub solver: SolverSettings,
    /// What bodies and fragments do to each other.
    pub contact: ContactSettings,
    /// Growth of cracks.
    pub growth: GrowthSettings,
    /// Frames.
    pub frames: FrameSettings,
    /// What the take holds of particles.
    #[serde(default)]
    pub take: TakeSettings,
    /// Output.
    pub output: OutputSettings,
}

impl Scene {
    /// Factor on the fracture toughness of body number `body` at a place of it at rest [m]: the product of all patches
    /// there.
    pub fn toughness_factor(&self, body: usize, place: Point) -> f64 {
        self.toughness.iter().map(|patch| patch.factor(body, place)).product()
    }
}

/// Material constants.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Name.
    pub name: String,
    /// Young's modulus E [Pa].
    pub young_modulus: f64,
    /// Poisson's ratio ν [–].
    pub poisson_ratio: f64,
    /// Density ρ [kg/m³].
    pub density: f64,
    /// Fracture toughness K_Ic [Pa·√m].
    pub fracture_toughness: f64,
    /// Highest speed of a crack tip in this material [m/s]; none: only [`GrowthSettings::speed_limit`] holds.
    pub limiting_speed: Option<f64>,
    /// Plasticity; none: elastic.
    pub plasticity: Option<Plasticity>,
}

/// Snow plasticity (Stomakhin et al. 2013).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Plasticity {
    /// Critical compression θ_c [–].
    pub critical_compression: f64,
    /// Critical stretch θ_s [–].
    pub critical_stretch: f64,
    /// Hardening ξ [–].
    pub hardening: f64,
}

/// A body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// Name.
    pub name: String,
    /// Where it is at rest.
    pub region: Region,
    /// Index of its material.
    pub material: usize,
    /// Parts of another material; where they overlap the later one holds.
    pub inclusions: Vec<Inclusion>,
    /// Initial velocities, added up.
    pub velocities: Vec<InitialVelocity>,
    /// How curves that were drawn turn off the region: for each of its rings and each edge of that the angles from the
    /// edge to the curve at its start and its end, counter-clockwise [rad]; zeros along lines. Empty where only lines
    /// were drawn, and in takes that do not say it. It decides how walls are shaded and nothing else.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub turns: Vec<Vec<[f64; 2]>>,
}

impl Body {
    /// Index of the material at a place of the body at rest.
    pub fn material_at(&self, place: Point) -> usize {
        self.inclusions.iter().rev().find(|i| i.region.contains(place)).map_or(self.material, |i| i.material)
    }
}

/// A part of a body of another material, perfectly bonded to the rest. It may reach beyond the body; only the common
/// part counts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Inclusion {
    /// Where it is at rest.
    pub region: Region,
    /// Index of its material.
    pub material: usize,
}

/// A part of the initial velocity field: v(X) = `velocity` + `angular_velocity` × (X − `center`) within `selection`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InitialVelocity {
    /// Where it applies.
    pub selection: Selection,
    /// Uniform part [m/s].
    pub velocity: Vector,
    /// Rotation, counter-clockwise [rad/s].
    pub angular_velocity: f64,
    /// Centre of the rotation [m].
    pub center: Point,
}

/// An initial crack.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Crack {
    /// Name.
    pub name: String,
    /// Index of the body it runs in.
    pub body: usize,
    /// Points from start to end [m].
    pub points: Vec<Point>,
    /// Whether the first point is a live tip.
    pub start_live: bool,
    /// Whether the last point is a live tip.
    pub end_live: bool,
    /// Path that the tip at the first point follows, beginning at that tip.
    pub start_guide: Option<Guide>,
    /// Path that the tip at the last point follows, beginning at that tip.
    pub end_guide: Option<Guide>,
    /// Whether its tips run across other cracks of the body instead of ending on them.
    #[serde(default)]
    pub crosses: bool,
}

impl Crack {
    /// The guide of one tip.
    pub fn guide(&self, end: End) -> Option<&Guide> {
        match end {
            End::Start => self.start_guide.as_ref(),
            End::End => self.end_guide.as_ref(),
        }
    }
}

/// A drawn path for a crack tip.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Guide {
    /// Name.
    pub name: String,
    /// Points, the first at the tip [m], at rest.
    pub points: Vec<Point>,
    /// How much the path decides the direction of growth, 0 to 1: 0 the physical direction, 1 the drawn one, a blend
    /// between.
    pub strength: f64,
    /// How far along the guide the tip may have come: (time [s], fraction of the guide's length 0 to 1), both rising.
    /// Empty: fracture mechanics decide when the crack grows.
    pub schedule: Curve,
    /// What leaves it on its way, in the order in which it is passed.
    #[serde(default)]
    pub branches: Vec<GuideBranch>,
}

impl Guide {
    /// Does the same to this guide and to all that branch off it, at any depth.
    pub fn for_each_mut(&mut self, change: &mut impl FnMut(&mut Guide)) {
        change(self);
        for branch in &mut self.branches {
            if let BranchKind::Begins { guide, .. } = &mut branch.kind {
                guide.for_each_mut(change);
            }
        }
    }
}

/// A crack that leaves a guide.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GuideBranch {
    /// Number of the point of the guide that it leaves at; never the first one.
    pub point: usize,
    /// What leaves there.
    pub kind: BranchKind,
}

/// What leaves a guide.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BranchKind {
    /// A crack that begins there when the tip on the guide has passed.
    Begins {
        /// Its own guide, from that point on.
        guide: Guide,
        /// Time from the passing on for which it waits [s].
        delay: f64,
        /// Whether the times of its schedule count from the passing on.
        from_passing: bool,
    },
    /// A crack of the scene with an end there, which opens into the one that passes.
    Drawn {
        /// Index of the crack.
        crack: usize,
        /// Its end there, no live tip.
        end: End,
    },
}

/// A shape that selects points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Selection {
    /// Everything.
    All,
    /// These bodies, whole.
    Bodies(Vec<usize>),
    /// Points within a region (edges included).
    Region(Region),
    /// Points within `radius` of one of `points` [m].
    Near {
        /// Centres [m].
        points: Vec<Point>,
        /// Distance [m].
        radius: f64,
    },
    /// The points of the particle layer along one side of the box around some bodies (or all): only what reaches that
    /// side of the box as a whole.
    Edge {
        /// Which side.
        side: BoxSide,
        /// Bodies; none: all.
        bodies: Option<Vec<usize>>,
    },
    /// The points of the particle layer along stretches of outlines; those that follow on each other meet in a point.
    Outline(Vec<OutlineStretch>),
}

/// A straight stretch of the outline of a body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OutlineStretch {
    /// The body.
    pub body: usize,
    /// Where it begins [m]; the material lies to the left of the way from here to `to`.
    pub from: Point,
    /// Where it ends [m].
    pub to: Point,
}

/// A side of a bounding box.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "load", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum BoxSide {
    /// Lowest x.
    Left,
    /// Highest x.
    Right,
    /// Lowest y.
    Bottom,
    /// Highest y.
    Top,
}

/// A load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Load {
    /// Where it applies.
    pub selection: Selection,
    /// What it is.
    pub kind: LoadKind,
    /// How it changes with time.
    pub curve: Curve,
}

/// Kinds of loads.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum LoadKind {
    /// Total force per unit thickness, shared among the selected particles by their volume [N/m].
    Force(Vector),
    /// Force per area of the selected edge [Pa]; needs [`Selection::Edge`] or [`Selection::Outline`].
    Traction(Vector),
    /// Pressure on the selected edges [Pa]: pushes into the material, along the normal of the edge as it is then.
    /// Needs [`Selection::Edge`] or [`Selection::Outline`], or takes all outlines in a region or of bodies.
    Pressure(f64),
    /// Pressure [Pa] on both faces of some cracks (numbers), on what they grow and on what branches off them; pushes
    /// into the material, along the normals of the faces as they are then. The selection does not count.
    FacePressure(Vec<usize>, f64),
    /// Force on the particle nearest to each point: (place [m], force per unit thickness [N/m]).
    PerPoint(Vec<(Point, Vector)>),
}

/// A prescribed motion of the selected material.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Support {
    /// Where it applies.
    pub selection: Selection,
    /// Prescribed velocity along x and y [m/s]; none: free in that direction.
    pub velocity: [Option<f64>; 2],
    /// How the velocity changes with time.
    pub curve: Curve,
}

impl Support {
    /// How far it has moved the material along x and y from the start to `time` [m]; 0 where it lets it go.
    pub fn displacement(&self, time: f64) -> [f64; 2] {
        let way = if time > 0.0 { self.curve.mean(0.0, time) * time } else { 0.0 };
        self.velocity.map(|velocity| velocity.unwrap_or(0.0) * way)
    }
}

/// A rigid obstacle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Collider {
    /// Name.
    pub name: String,
    /// Shape in its own frame.
    pub shape: ColliderShape,
    /// Poses over time (time [s], pose), times rising; linear between, constant outside. At least one.
    pub keyframes: Vec<(f64, Pose)>,
    /// What happens at contact.
    pub contact: Contact,
    /// Coulomb friction for slip and separate [–].
    #[serde(with = "crate::infinite")]
    pub friction: f64,
}

/// Shape of a collider in its own frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum ColliderShape {
    /// Everything below the line through the origin; `normal` (unit) points out of the obstacle.
    HalfPlane {
        /// Outward unit normal.
        normal: Vector,
    },
    /// Disc around the origin.
    Disc {
        /// Radius [m].
        radius: f64,
    },
    /// Rectangle around the origin.
    Box {
        /// Half width and half height [m].
        half_extents: Vector,
    },
    /// Simple polygon, counter-clockwise.
    Polygon {
        /// Ring [m].
        ring: Vec<Point>,
    },
}

/// What happens when material touches a collider.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "load", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Contact {
    /// Pushed out, may leave; friction along the surface.
    #[default]
    Separate,
    /// Stays on the surface once it touches, slides along it.
    Slip,
    /// Takes the collider's velocity.
    Stick,
}
