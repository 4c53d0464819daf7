//! Settings that a scene file and the solver share word for word.

use crate::curve::Curve;
use serde::{Deserialize, Serialize};

/// How stress out of the plane is treated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "load", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum PlaneState {
    /// Thick body: no strain out of the plane.
    #[default]
    Strain,
    /// Thin body: no stress out of the plane.
    Stress,
}

/// A named set of solver settings to start from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "load", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum SolverPreset {
    /// The recommended settings.
    #[default]
    Standard,
    /// The scheme of Fumoto 2022: updated Lagrangian, cubic B-spline, PIC, 16-segment contour of 2 cells without area
    /// term, crack opening displacement split, half-cell growth. About 10 to 20 % off in K_I.
    Thesis,
}

/// Where kernels live.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "load", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Formulation {
    /// Total where every material is elastic and strains are expected to be small, updated elsewhere.
    #[default]
    Auto,
    /// Total Lagrangian: kernels on the reference lattice, computed once.
    Total,
    /// Updated Lagrangian: kernels on the current positions, computed every step.
    Updated,
}

/// Interpolation between particles and grid nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "load", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Kernel {
    /// Bilinear hat on the particle position.
    Bilinear,
    /// Bilinear hat averaged over the particle's domain (uniform GIMP).
    Gimp,
    /// Quadratic B-spline.
    Quadratic,
    /// Cubic B-spline.
    Cubic,
}

/// How velocities go back from the grid to the particles (updated Lagrangian only).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "load", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Transfer {
    /// Grid velocity only; damps every wave.
    Pic,
    /// `flip` parts of the grid's velocity change added to the particle, the rest PIC; 1 is pure FLIP.
    Flip(#[cfg_attr(feature = "load", schemars(transform = crate::range::UNIT.bounds()))] f64),
    /// Affine PIC.
    Apic,
    /// Affine FLIP: the grid's changes of velocity and of its gradient are added to what the particle has, little of
    /// which fades.
    Aflip,
    /// Extended PIC of order 2.
    Xpic,
}

/// How the energy release rate is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "load", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum JMethod {
    /// Integral over a circle of 16 segments.
    Contour,
    /// Integral over a disc, particles as quadrature points.
    Domain,
}

/// How J is split into K_I and K_II.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "load", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ModeSplit {
    /// By the ratio of opening and sliding of the crack faces behind the tip.
    OpeningDisplacement,
    /// By the interaction integral with Williams' fields.
    Interaction,
}

/// How the material around a tip inside a cell is divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "load", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum TipDivision {
    /// By line crossing alone: the effective tip jumps from node to node.
    LineCrossing,
    /// The effective tip moves smoothly. Total formulation: nodes are split before the tip reaches them, and springs
    /// that soften as it passes hold their sides together. Updated formulation: particles at the tip are partly cut.
    PartlyCut,
}

/// What to do when the total Lagrangian formulation leaves its range.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "load", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum OnDistortion {
    /// Stop with the particle, the time and the remedy.
    #[default]
    Stop,
    /// Hand over to the updated Lagrangian formulation.
    Switch,
}

/// The solver's settings, complete: every choice made.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SolverSettings {
    /// Where kernels live.
    pub formulation: Formulation,
    /// What to do when the total formulation leaves its range.
    pub on_distortion: OnDistortion,
    /// Interpolation.
    pub kernel: Kernel,
    /// Grid to particle transfer.
    pub transfer: Transfer,
    /// The user's own time step [s]; none: chosen from the stability limit.
    pub time_step: Option<f64>,
    /// Fraction of the stability limit that is used, 0 to 1.
    pub courant: f64,
    /// Damping rate: velocities decay as exp(-damping t) [1/s].
    pub damping: f64,
    /// Contact between the two faces of a crack.
    pub crack_contact: bool,
    /// Coulomb friction between crack faces; infinite: stick.
    #[serde(with = "crate::infinite")]
    pub crack_friction: f64,
    /// Material around the tip.
    pub tip_division: TipDivision,
    /// How J is measured.
    pub j_method: JMethod,
    /// Radius of contour or domain, in cells; none: as there is room.
    pub j_radius: Option<f64>,
    /// Whether the dynamic area term is added to J.
    pub area_term: bool,
    /// How J is split.
    pub mode_split: ModeSplit,
}

/// What bodies and fragments do to each other where they touch, complete.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ContactSettings {
    /// Coulomb friction between surfaces; infinite: stick.
    #[serde(with = "crate::infinite")]
    pub friction: f64,
    /// Pairs of materials with a friction of their own; of two that name the same pair the later one holds.
    pub pairs: Vec<PairFriction>,
    /// The part of the speed, with which elasticity alone would throw them back, that bodies keep when they land [–].
    pub restitution: f64,
    /// The same of what has broken off a body.
    pub fragment_restitution: f64,
}

impl Default for ContactSettings {
    /// Without friction or loss.
    fn default() -> Self {
        Self { friction: 0.0, pairs: Vec::new(), restitution: 1.0, fragment_restitution: 1.0 }
    }
}

/// Friction between two materials.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PairFriction {
    /// Indices of the materials, in any order; may be equal.
    pub materials: [usize; 2],
    /// Coulomb friction; infinite: stick.
    #[serde(with = "crate::infinite")]
    pub friction: f64,
}

impl ContactSettings {
    /// Coulomb friction between surfaces of two materials, given by their indices.
    pub fn friction_between(&self, first: usize, second: usize) -> f64 {
        let is_pair = |pair: &&PairFriction| pair.materials == [first, second] || pair.materials == [second, first];
        self.pairs.iter().rev().find(is_pair).map_or(self.friction, |pair| pair.friction)
    }
}

/// When and where cracks grow, complete.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GrowthSettings {
    /// Whether cracks grow at all.
    pub enabled: bool,
    /// Length of one increment, in cells: how far a tip goes before it looks for its direction again.
    pub increment: f64,
    /// Scales K_II in the direction of growth only: 0 straight, 1 physical, above 1 exaggerated.
    pub bending: f64,
    /// Highest speed of a tip as a fraction of the Rayleigh wave speed, 0 to 1.
    pub speed_limit: f64,
    /// Factor on `speed_limit` over time; empty: always 1.
    pub speed_curve: Curve,
    /// Division of tips into two; none: a tip stays one.
    pub branching: Option<Branching>,
}

/// When a tip divides into two, and how.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Branching {
    /// What a tip would release at rest, over G_c, from which on it divides; above 1.
    pub release_ratio: f64,
    /// Angle between each new tip and the old direction [rad].
    pub half_angle: f64,
    /// Least length of crack between two divisions [m].
    pub spacing: f64,
}

/// Which frames to write.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FrameSettings {
    /// Number of the first frame: the state at rest, time 0.
    pub first: i64,
    /// Number of the last frame.
    pub last: i64,
    /// Frames per second of simulated time [1/s].
    pub rate: f64,
    /// Frames per second at which the sequence is shown [1/s].
    #[serde(default = "usual_playback")]
    pub playback: f64,
}

/// Frames per second of a film.
pub(crate) const PLAYBACK: f64 = 24.0;

fn usual_playback() -> f64 {
    PLAYBACK
}

impl FrameSettings {
    /// Time of the frame `number` [s].
    pub fn time(&self, number: i64) -> f64 {
        (number - self.first) as f64 / self.rate
    }

    /// Seconds of simulated time per second of playback: below 1 in slow motion.
    pub fn time_scale(&self) -> f64 {
        self.playback / self.rate
    }

    /// Number of frames.
    pub fn count(&self) -> usize {
        (self.last - self.first + 1).max(0) as usize
    }
}

/// A part of the scene that can be written as a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "load", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// The body with its cracks cut out, extruded.
    Cracked,
    /// The body without its cracks, extruded.
    Body,
    /// The crack faces, as a surface.
    Faces,
    /// The colliders, extruded.
    Collider,
    /// The particles, as points.
    Particles,
}

/// A mesh file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "load", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Format {
    /// Binary glTF 2.0.
    Glb,
    /// Binary PLY.
    Ply,
    /// Wavefront OBJ with its materials.
    Obj,
    /// Universal Scene Description as text: a file per frame, and one that plays them all.
    Usda,
    /// VTK files for ParaView: surfaces, particles with their stress, and a list with the times.
    Vtk,
    /// The drawing plane as SVG, in mm: fragments, cracks and tips (part `cracked`).
    Svg,
    /// Binary glTF 2.0 of the whole sequence: each frame is there in its time.
    GlbSequence,
    /// Binary glTF 2.0 of the whole sequence: fragments that move as rigid bodies are nodes that move (part `cracked`).
    GlbRigid,
}

impl Format {
    /// All of them.
    pub const ALL: [Self; 8] =
        [Self::Glb, Self::Ply, Self::Obj, Self::Usda, Self::Vtk, Self::Svg, Self::GlbSequence, Self::GlbRigid];

    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Glb => "glb",
            Self::Ply => "ply",
            Self::Obj => "obj",
            Self::Usda => "usda",
            Self::Vtk => "vtk",
            Self::Svg => "svg",
            Self::GlbSequence => "glb_sequence",
            Self::GlbRigid => "glb_rigid",
        }
    }

    /// Whether files of this format show `part`.
    pub fn shows(self, part: Part) -> bool {
        match self {
            Self::Glb | Self::Ply | Self::Obj | Self::Usda | Self::Vtk | Self::GlbSequence => true,
            Self::Svg | Self::GlbRigid => part == Part::Cracked,
        }
    }
}

/// The axis that points up in formats that do not fix it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "load", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum UpAxis {
    /// y up, the drawing in the x–y plane.
    Y,
    /// z up, the drawing in the x–z plane.
    #[default]
    Z,
}

/// Which cracks inside a fragment have walls. Where fragments touch, each has its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "load", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Walls {
    /// Where they are open: one that is closed cannot be seen.
    #[default]
    Open,
    /// Everywhere: one that is closed is held open by a hair.
    All,
}

/// How wide cracks are shown.
///
/// A crack that is open by δ along its normal is shown open by w + (f − 1) min(w, r) with w = max(δ, l): f is the
/// factor, l the least width, smaller near a tip, and r two cells, or the least width if that is more, so that what has
/// flown apart keeps its shape.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OpeningSettings {
    /// Factor on the opening over time; 1 is what was simulated.
    pub factor: Curve,
    /// Width that every crack has at least, before the factor, far from its tips [m].
    pub least: f64,
    /// How far from a tip the least width is reached [m]; it grows with the root of the distance, as the opening of a
    /// crack in an elastic body does.
    pub falloff: f64,
}

/// What to write.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OutputSettings {
    /// Thickness of the solid [m].
    pub thickness: f64,
    /// Formats.
    pub formats: Vec<Format>,
    /// Parts of the scene.
    pub parts: Vec<Part>,
    /// Up axis of PLY files (glTF is always y up).
    pub up: UpAxis,
    /// Fragments of less area than this are dropped [m²].
    pub smallest_fragment: f64,
    /// Which cracks inside a fragment have walls.
    #[serde(default)]
    pub walls: Walls,
    /// How surfaces are made.
    #[serde(default)]
    pub surfaces: SurfaceSettings,
    /// How wide cracks are shown; none: as they are.
    #[serde(default)]
    pub opening: Option<OpeningSettings>,
    /// How far fragments are shown apart, over time: the way of each from the middle of its body, in parts of what it
    /// is; none: where they are.
    #[serde(default)]
    pub explode: Option<Curve>,
    /// What crack walls tell of how they came about.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub attributes: Vec<Attribute>,
}

/// What crack walls can tell of how they came about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "load", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Attribute {
    /// Time since the tip was there [s of simulated time].
    CrackAge,
    /// Way along cracks to the mouth that the crack began at [m].
    MouthDistance,
    /// K_I at the tip when it was there [Pa·√m].
    #[serde(rename = "mode_1")]
    Mode1,
}

impl Attribute {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::CrackAge, Self::MouthDistance, Self::Mode1];

    /// Its name in scenes and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::CrackAge => "crack_age",
            Self::MouthDistance => "mouth_distance",
            Self::Mode1 => "mode_1",
        }
    }
}

/// Where the material is cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "load", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Cut {
    /// As it is in each frame: outlines and crack faces, moved, with all openings taken off.
    #[default]
    Opening,
    /// At rest: triangles that the material carries along, the same from frame to frame until a crack grows.
    Rest,
}

/// How surfaces are made.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SurfaceSettings {
    /// Length of the edges within caps, at most; none: as long as may be [m].
    pub cap_size: Option<f64>,
    /// Where the material is cut.
    pub cut: Cut,
    /// How far the paths of cracks may be moved to be smooth, in cells.
    pub smoothing: f64,
    /// How long edges of crack walls may be where their path is straight, in cells; 0: as cracks grew.
    #[serde(skip_serializing_if = "is_zero")]
    pub wall_step: f64,
    /// How rough the walls of cracks are shown; none: as the cracks are.
    pub roughness: Option<Roughness>,
    /// How wide the edges between walls of cracks and caps are bevelled [m]; 0: not at all.
    pub bevel: f64,
    /// Whether meshes have a second set of texture coordinates, in metres.
    pub uv_in_metres: bool,
}

/// How rough the walls of cracks are shown.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Roughness {
    /// Most that a wall is moved [m].
    pub amplitude: f64,
    /// Length over which it is moved about alike [m].
    pub length: f64,
    /// Number that stands for one relief.
    pub seed: u64,
}

impl Default for SurfaceSettings {
    fn default() -> Self {
        let cut = Cut::default();
        Self {
            cap_size: None,
            cut,
            smoothing: SMOOTHING,
            wall_step: 0.0,
            roughness: None,
            bevel: 0.0,
            uv_in_metres: false,
        }
    }
}

/// A key that is not there is 0, so that takes from before it was known go on.
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// Half a cell: what the solver resolves of a path.
pub(crate) const SMOOTHING: f64 = 0.5;
