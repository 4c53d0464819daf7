//! Why a frame cannot become meshes.

use crate::mesh::MeshDefect;
use fissure_scene::FrameFault;

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
    #[error("frame {frame}: {fault}; the take is damaged or of another scene, simulate it again")]
    Inconsistent {
        /// Frame number.
        frame: i64,
        /// What does not fit.
        fault: FrameFault,
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
