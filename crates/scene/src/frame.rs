//! What the solver says of one moment: the crate `sim` makes frames, the crate `post` reads them.

use fissure_plane::{Matrix, Point, Vector};
use serde::{Deserialize, Serialize};

/// The state of a simulation at one moment.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Frame {
    /// Frame number as written in file names.
    pub number: i64,
    /// Time since the start of the simulation [s].
    pub time: f64,
    /// The material points.
    pub particles: ParticleFrame,
    /// The rings of all bodies, carried with the material.
    pub outlines: Vec<OutlineFrame>,
    /// The cracks, in the order of the scene; cracks born later follow.
    pub cracks: Vec<CrackFrame>,
    /// One record for each crack tip that is or was live.
    pub tips: Vec<TipRecord>,
    /// Energy budget.
    pub energies: Energies,
    /// Pose of each collider, in the order of the scene.
    pub colliders: Vec<Pose>,
    /// What each support does, in the order of the scene.
    pub supports: Vec<SupportRecord>,
}

/// Material points, one entry per particle in every field, in the order of `id`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ParticleFrame {
    /// Identity, stable over frames.
    pub id: Vec<u32>,
    /// Index of the body in the scene.
    pub body: Vec<u32>,
    /// Fragment the particle belongs to; 0 until a body breaks. Stable over frames.
    pub piece: Vec<u32>,
    /// Position at rest X_p [m].
    pub rest: Vec<Point>,
    /// Mass per unit thickness m_p [kg/m]; none in takes of older versions.
    pub mass: Option<Vec<f64>>,
    /// Position x_p [m].
    pub position: Vec<Point>,
    /// Velocity v_p [m/s].
    pub velocity: Vec<Vector>,
    /// Deformation gradient F [–], total (elastic times plastic).
    pub deformation_gradient: Vec<Matrix>,
    /// Cauchy stress σ in the plane [Pa], world frame.
    pub cauchy_stress: Vec<Matrix>,
}

impl ParticleFrame {
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.id.len()
    }

    /// The particles with these numbers, in this order. Of what the frame does not have of its particles, such as how
    /// they move, it has nothing either.
    pub fn chosen(&self, numbers: &[usize]) -> Self {
        fn of<T: Copy>(values: &[T], numbers: &[usize]) -> Vec<T> {
            if values.is_empty() { Vec::new() } else { numbers.iter().map(|&p| values[p]).collect() }
        }
        Self {
            id: of(&self.id, numbers),
            body: of(&self.body, numbers),
            piece: of(&self.piece, numbers),
            rest: of(&self.rest, numbers),
            mass: self.mass.as_ref().map(|mass| of(mass, numbers)),
            position: of(&self.position, numbers),
            velocity: of(&self.velocity, numbers),
            deformation_gradient: of(&self.deformation_gradient, numbers),
            cauchy_stress: of(&self.cauchy_stress, numbers),
        }
    }

    /// Whether there are no particles.
    pub fn is_empty(&self) -> bool {
        self.id.is_empty()
    }
}

/// One ring of a body as tracers that move with the material.
///
/// Where a crack mouths at the ring, two tracers share one rest position: the first moves with the material before the
/// mouth (in ring order), the second with the material behind it. Their current positions are, to the bit, the end
/// points of the two faces of that crack.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct OutlineFrame {
    /// Index of the body in the scene.
    pub body: u32,
    /// Ring of the body: 0 the exterior (counter-clockwise), then the holes (clockwise).
    pub ring: u32,
    /// Rest positions [m]; open ring.
    pub rest: Vec<Point>,
    /// Current positions [m].
    pub position: Vec<Point>,
    /// Velocities [m/s].
    pub velocity: Vec<Vector>,
}

/// One crack: a polyline with two faces.
///
/// "Above" is the left side when walking from the start to the end of the crack.
/// Where another crack ends on this one, two points share one rest position (and one face).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CrackFrame {
    /// Index of the crack.
    pub crack: u32,
    /// Index of the body it runs in.
    pub body: u32,
    /// Rest positions of the crack points [m], from start to end.
    pub rest: Vec<Point>,
    /// Face above, x_a [m].
    pub above: Vec<Point>,
    /// Face below, x_b [m].
    pub below: Vec<Point>,
    /// Velocity of the face above [m/s].
    pub above_velocity: Vec<Vector>,
    /// Velocity of the face below [m/s].
    pub below_velocity: Vec<Vector>,
    /// How each point came about; none in takes of older versions.
    pub formed: Option<Vec<Formed>>,
    /// What the first point is.
    pub start: CrackEnd,
    /// What the last point is.
    pub end: CrackEnd,
}

/// How a point of a crack came about.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Formed {
    /// When the tip reached it, since the start of the simulation [s]; 0 where the crack was drawn.
    pub time: f64,
    /// K_I as it was measured last before [Pa·√m]; 0 where the crack was drawn, and where nothing was measured.
    pub mode_1: f64,
}

/// What the end of a crack is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CrackEnd {
    /// Inside the material; the faces meet here.
    #[default]
    Tip,
    /// On a ring of the body; the faces are apart.
    Mouth,
    /// On a face of another crack; the faces are apart.
    Junction {
        /// The crack it ends on.
        crack: u32,
    },
}

/// Which end of a crack.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// The first point.
    Start,
    /// The last point.
    End,
}

/// Life of a crack tip.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TipState {
    /// May grow, has not grown since it was last at rest.
    Resting,
    /// Is growing.
    Growing,
    /// Has grown and stands still; may start again.
    Arrested,
    /// Has left the body: the crack is cut clean through.
    LeftBody,
    /// Has met another crack and ends on it.
    MetCrack,
    /// Has reached the end of its guide and stays there.
    GuideEnded,
}

impl TipState {
    /// Whether the tip may still grow.
    pub fn is_live(self) -> bool {
        matches!(self, Self::Resting | Self::Growing | Self::Arrested)
    }

    /// Its word in tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Resting => "resting",
            Self::Growing => "growing",
            Self::Arrested => "arrested",
            Self::LeftBody => "left_body",
            Self::MetCrack => "met_crack",
            Self::GuideEnded => "guide_ended",
        }
    }
}

/// What was measured at a crack tip at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TipRecord {
    /// Index of the crack.
    pub crack: u32,
    /// Which end of it.
    pub end: End,
    /// Life of the tip.
    pub state: TipState,
    /// Current position [m].
    pub position: Point,
    /// Direction of the crack at the tip, from the x axis counter-clockwise [rad].
    pub direction: f64,
    /// J-integral in the direction of the crack [J/m²]; with the area term it is the energy release rate.
    pub j_integral: f64,
    /// Stress intensity K_I [Pa·√m], positive opening; with contact between crack faces not below zero.
    pub mode_1: f64,
    /// Stress intensity K_II [Pa·√m], positive when s12 > 0 ahead of the tip.
    pub mode_2: f64,
    /// Kink angle θ_c the criterion asks for [rad], positive counter-clockwise.
    pub kink_angle: f64,
    /// Equivalent stress intensity K_eq(θ_c) [Pa·√m].
    pub equivalent: f64,
    /// Fracture toughness K_Ic at the tip [Pa·√m].
    pub fracture_toughness: f64,
    /// Mean speed of the tip since the last frame [m/s]. A leap, over the last ligament or into two branches, counts as
    /// far as the speed limit would have let the tip run, the rest in the frames after it.
    pub speed: f64,
    /// Length of the whole crack at rest [m].
    pub length: f64,
    /// Radius of the contour or domain that was used [m]; 0 when J was not evaluated.
    pub contour_radius: f64,
    /// Whether the radius was made smaller than asked for, because of an edge, a kink or another crack.
    pub radius_shrunk: bool,
}

/// Energy budget of the whole scene, per unit thickness [J/m].
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Energies {
    /// Kinetic energy.
    pub kinetic: f64,
    /// Elastic strain energy.
    pub strain: f64,
    /// Work done so far by loads, gravity, moving supports and colliders.
    pub external_work: f64,
    /// Energy released so far into new crack surface, ∫ G da with G measured at the tips.
    pub crack: f64,
}

/// What a support does to the material, per unit thickness.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SupportRecord {
    /// Mean force on the material since the frame before; zero in the first frame [N/m].
    pub force: Vector,
    /// Work done so far [J/m].
    pub work: f64,
}

/// Position and angle of a rigid body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Where the collider's own origin is [m].
    pub position: Point,
    /// Turn, counter-clockwise [rad].
    pub angle: f64,
}
