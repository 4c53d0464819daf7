//! From frames to files: a [`Frame`](fissure_scene::Frame) becomes checked [`Mesh`]es ([`post_frame`]), these become
//! GLB and PLY files ([`write_frame`]), and a [`Manifest`] lists them. Knows nothing of the solver: a take on disk can
//! be posted again with another thickness.
//!
//! The stages of a cracked body, one module each:
//! 1. `snap`: all positions go onto a power-of-two grid that is exact in `f32`.
//! 2. `outline`, `opening`: the moved rings and the opening polygons of the cracks become boundary edges, each of which
//!    knows the rest position, velocity and arc length of the material at its ends.
//!    `seam`: where a crack ends on a ring or on another crack, that boundary is parted if the solver has not done so.
//! 3. `boolean`: material is where the edges wind around a place at least once. An open crack takes one off; where
//!    faces overlap one is added, so closed cracks have no walls; fragments may turn and fly apart as they like.
//! 4. `pieces`: slivers that are mere rounding go; polygons get the fragment numbers of the simulation.
//! 5. `pinch`: contours that touch in a point are parted, so that the solid is manifold for every reader.
//! 6. `triangulate`, `extrude`: caps and walls, with normals, texture coordinates, velocities and material slots.
//! 7. [`Mesh::check`]: closed, manifold, oriented, volume = area × thickness, in the precision of the file.
//! 8. `glb`, `ply`: the bytes of files; `write`, `manifest`: the files, with the feature `files`, which is on by
//!    default.
//!
//! Promised: every solid that is returned has passed the check. Not promised: that polygons of different bodies, or of
//! fragments that the simulation lets overlap in different bodies, stay apart; openings below two grid steps (4e-6 m in
//! a body of 20 m) may be shown closed.

#[doc(hidden)]
pub mod bench;
mod boolean;
mod colliders;
mod cracked;
mod error;
mod extrude;
mod faces;
mod glb;
#[cfg(feature = "files")]
mod manifest;
mod mesh;
mod opening;
mod options;
#[cfg(feature = "files")]
mod origin;
mod outline;
mod packed;
mod particles;
mod pieces;
mod pinch;
mod ply;
mod post;
mod provenance;
#[cfg(feature = "files")]
mod record;
mod seam;
mod slot;
mod snap;
mod source;
mod triangulate;
#[cfg(feature = "files")]
mod write;
#[cfg(feature = "files")]
mod write_error;

pub use error::PostError;
pub use glb::{GlbError, to_glb};
#[cfg(feature = "files")]
pub use manifest::Manifest;
pub use mesh::{Content, Mesh, MeshDefect, Vertex};
pub use options::PostOptions;
pub use ply::to_ply;
pub use post::{FrameMeshes, post_frame};
pub use provenance::Provenance;
#[cfg(feature = "files")]
pub use record::{FileRecord, file_name};
pub use slot::Slot;
#[cfg(feature = "files")]
pub use write::write_frame;
#[cfg(feature = "files")]
pub use write_error::WriteError;
