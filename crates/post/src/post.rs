//! From a frame to meshes.

use crate::colliders::collider_meshes;
use crate::cracked::body_meshes;
use crate::faces::face_meshes;
use crate::mesh::{Mesh, MeshDefect};
use crate::particles::particle_meshes;
use fissure_scene::{Frame, OutputSettings, Part, Point, Scene, UpAxis, Vector};

/// How a frame becomes meshes. Made from [`OutputSettings`], then changed at will.
#[derive(Debug, Clone, PartialEq)]
pub struct PostOptions {
    /// Thickness of solids, half on each side of the drawing plane [m]; above 0.
    pub thickness: f64,
    /// Walls that turn by less than this look smooth [rad].
    pub crease_angle: f64,
    /// Polygons of less area are left out [m²].
    pub smallest_fragment: f64,
    /// What to make.
    pub parts: Vec<Part>,
    /// Up axis of formats that do not fix it.
    pub up: UpAxis,
}

impl From<&OutputSettings> for PostOptions {
    /// The settings of a scene, with a crease angle of 30 degrees.
    fn from(output: &OutputSettings) -> Self {
        Self {
            thickness: output.thickness,
            crease_angle: 30.0_f64.to_radians(),
            smallest_fragment: output.smallest_fragment,
            parts: output.parts.clone(),
            up: output.up,
        }
    }
}

/// The meshes of one frame, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameMeshes {
    /// Where they come from.
    pub provenance: Provenance,
    /// Up axis of formats that do not fix it.
    pub up: UpAxis,
    /// Meshes of each part that was asked for, in that order.
    pub parts: Vec<(Part, Vec<Mesh>)>,
}

/// Where a file comes from; written into it.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Provenance {
    /// Name and version of this program.
    pub tool: String,
    /// Name of the scene.
    pub scene: String,
    /// Hash of the scene.
    pub scene_hash: String,
    /// Frame number.
    pub frame: i64,
    /// Time [s].
    pub time: f64,
}

/// Why a frame cannot become meshes.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PostError {
    /// An option is out of its range.
    #[error("{name} is {value}; it must be a finite number {range}")]
    Option {
        /// Which.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// Fields of the frame do not belong together, or to the scene.
    #[error("frame {frame}: {what}; the take is damaged or of another scene, simulate it again")]
    Inconsistent {
        /// Frame number.
        frame: i64,
        /// What does not fit.
        what: String,
    },
    /// What is to be shown lies too far from the origin for its size.
    #[error(
        "frame {frame}: `{name}` lies up to {reach:e} m from the origin, where single precision, in which meshes are written, has steps of \
         {step:e} m; it is only {size:e} m large. Let the scene move less far, or about the origin"
    )]
    TooFar {
        /// Frame number.
        frame: i64,
        /// Body or collider.
        name: String,
        /// Distance from the origin [m].
        reach: f64,
        /// Distance of neighbouring numbers there [m].
        step: f64,
        /// Size of the body or collider [m].
        size: f64,
    },
    /// Contours that touch could not be parted.
    #[error(
        "frame {frame}: the boundary of body `{body}` touches itself at ({x}, {y}) m in a way that could not be parted"
    )]
    Pinch {
        /// Frame number.
        frame: i64,
        /// Name of the body.
        body: String,
        /// Where, x [m].
        x: f64,
        /// Where, y [m].
        y: f64,
    },
    /// A solid is not one.
    #[error("frame {frame}: the solid `{mesh}` is not valid: {defect}")]
    Defect {
        /// Frame number.
        frame: i64,
        /// Name of the mesh.
        mesh: String,
        /// What is wrong, and where.
        #[source]
        defect: MeshDefect,
    },
}

/// Makes the meshes of one frame, and checks that each solid is one. Deterministic; frames may be processed in any
/// order on any thread.
///
/// # Errors
/// See [`PostError`]; all name the frame.
pub fn post_frame(scene: &Scene, frame: &Frame, options: &PostOptions) -> Result<FrameMeshes, PostError> {
    check_options(options)?;
    check_frame(scene, frame)?;
    let mut parts = Vec::with_capacity(options.parts.len());
    for &part in &options.parts {
        let meshes = match part {
            Part::Cracked => body_meshes(scene, frame, options, true)?,
            Part::Body => body_meshes(scene, frame, options, false)?,
            Part::Faces => face_meshes(scene, frame, options),
            Part::Collider => collider_meshes(scene, frame, options)?,
            Part::Particles => particle_meshes(scene, frame),
        };
        for mesh in &meshes {
            let defect = |defect| PostError::Defect { frame: frame.number, mesh: mesh.name.clone(), defect };
            mesh.check().map_err(defect)?;
        }
        parts.push((part, meshes));
    }
    let provenance = Provenance {
        tool: concat!("fissure ", env!("CARGO_PKG_VERSION")).to_owned(),
        scene: scene.name.clone(),
        scene_hash: scene.hash.clone(),
        frame: frame.number,
        time: frame.time,
    };
    Ok(FrameMeshes { provenance, up: options.up, parts })
}

/// Name of an object, `owner_kind_0001`, of letters, digits, `_` and `-` only: viewers strip or rewrite others.
pub(crate) fn object_name(owner: &str, kind: &str, number: u32) -> String {
    let plain = |c: char| if c.is_alphanumeric() || c == '-' { c } else { '_' };
    format!("{}_{kind}_{number:04}", owner.chars().map(plain).collect::<String>())
}

fn check_options(options: &PostOptions) -> Result<(), PostError> {
    let positive = |name, value: f64| {
        let fine = value.is_finite() && value as f32 > 0.0 && (value as f32).is_finite();
        if fine {
            Ok(())
        } else {
            Err(PostError::Option { name, value, range: "above 0 that single precision can hold" })
        }
    };
    let not_negative = |name, value: f64| {
        let fine = value.is_finite() && value >= 0.0;
        if fine { Ok(()) } else { Err(PostError::Option { name, value, range: "of at least 0" }) }
    };
    positive("thickness", options.thickness)?;
    not_negative("smallest_fragment", options.smallest_fragment)?;
    not_negative("crease_angle", options.crease_angle)
}

/// Checks what all stages rely on: equal lengths, known bodies, finite numbers.
fn check_frame(scene: &Scene, frame: &Frame) -> Result<(), PostError> {
    let ensure = |fine: bool, what: &dyn Fn() -> String| {
        if fine { Ok(()) } else { Err(PostError::Inconsistent { frame: frame.number, what: what() }) }
    };
    let known = |body: u32| (body as usize) < scene.bodies.len();
    for (i, outline) in frame.outlines.iter().enumerate() {
        let what = |fault: &str| format!("outline {i} {fault}");
        let count = outline.rest.len();
        ensure(known(outline.body), &|| {
            what(&format!("belongs to body {}, which the scene does not have", outline.body))
        })?;
        let same = [outline.position.len(), outline.velocity.len()] == [count; 2];
        ensure(same, &|| what("has unequal numbers of positions and velocities"))?;
        let finite = points_finite(&[&outline.rest, &outline.position]) && vectors_finite(&[&outline.velocity]);
        ensure(finite, &|| what("has a number that is not finite"))?;
    }
    for crack in &frame.cracks {
        let what = |fault: &str| format!("crack {} {fault}", crack.crack);
        let count = crack.rest.len();
        ensure(known(crack.body), &|| what(&format!("belongs to body {}, which the scene does not have", crack.body)))?;
        let lengths = [crack.above.len(), crack.below.len(), crack.above_velocity.len(), crack.below_velocity.len()];
        ensure(lengths == [count; 4], &|| what("has faces of unequal numbers of points"))?;
        let finite = points_finite(&[&crack.rest, &crack.above, &crack.below])
            && vectors_finite(&[&crack.above_velocity, &crack.below_velocity]);
        ensure(finite, &|| what("has a number that is not finite"))?;
    }
    let particles = &frame.particles;
    let lengths = [particles.body.len(), particles.piece.len(), particles.position.len(), particles.velocity.len()];
    ensure(lengths == [particles.len(); 4], &|| "particle fields have unequal lengths".to_owned())?;
    ensure(particles.body.iter().all(|&b| known(b)), &|| "a particle belongs to an unknown body".to_owned())?;
    let finite = points_finite(&[&particles.position]) && vectors_finite(&[&particles.velocity]);
    ensure(finite, &|| "a particle has a number that is not finite".to_owned())
}

fn points_finite(lists: &[&Vec<Point>]) -> bool {
    lists.iter().all(|list| list.iter().all(|p| p.x.is_finite() && p.y.is_finite()))
}

fn vectors_finite(lists: &[&Vec<Vector>]) -> bool {
    lists.iter().all(|list| list.iter().all(|v| v.x.is_finite() && v.y.is_finite()))
}
