//! From frames to files: a [`Frame`](fissure_scene::Frame) becomes checked [`Mesh`]es ([`post_frame`]), these become
//! GLB and PLY files ([`write_frame`]), and a [`Manifest`] lists them. Knows nothing of the solver: a take on disk can
//! be posted again with another thickness.
//!
//! The stages of a cracked body, one module each:
//! 1. `snap`: all positions go onto a power-of-two grid that is exact in `f32`.
//! 2. `pieces`, `edges`: the fragments of the frame ([`fissure_scene::Fragments`]) get the numbers of the simulation,
//!    and each its own boundary: edges of moved rings and crack faces that know the rest position, velocity and arc
//!    length of the material at their ends. `outline`: a body without its cracks.
//!    `smooth`: paths of cracks without their zigzag. `rest_cut`: triangles at rest that the material carries, in place
//!    of steps 3 to 7, `carrying`; `sight`: on which side of cracks, `drawn_along`: with faces that are shown
//!    elsewhere, `untangled`: without folds; `rest_room`: no corners beside each other, `rest_needles`: no needles at
//!    rest, `parted_corners`, `pressed_corners`: those in one place, at rest or now, kept apart.
//!    `drawn_out`: no point leaves the particles of its fragment. `closed`: cracks within a fragment are closed where
//!    they are hardly open.
//! 3. `boolean`: a fragment is where its own edges wind around a place at least once. An open crack in it takes one
//!    off; where its faces overlap one is added, so cracks that are closed have no walls, unless all are to have some
//!    (`held_open`), or cracks are shown wider than they are (`widening`). Fragments may turn, fly
//!    apart, touch and come to lie on each other as they like: each keeps its walls.
//! 4. `slivers`: what is mere rounding goes.
//! 5. `pinch`: contours that touch in a point are parted, so that the solid is manifold for every reader.
//! 6. `short_edges`, `needles`: edges that readers which merge by distance would close are taken out, and corners that
//!    are so sharp that these would close them end bluntly.
//!    `narrows`: necks and channels narrower than that are cut and closed: triangles in them would have shorter edges.
//!    `tidied` has these in their order.
//! 7. `overlaps`, `lattice`: fragments that lie in each other a little share the middle; then steps 4 to 6 once more.
//!    `ways_apart`, `rest_apart`: the same for triangles that stay, by moving their corners.
//! 8. `triangulate`, `interior`, `extrude`: caps of triangles without small angles, and walls, with normals, texture
//!    coordinates, velocities and material slots. `solids`, `rest_solids`: all steps from 3 on, for both cuts.
//!    `relief`, `rough_lines`, `rough_walls`: walls of cracks that are not plane, `bevel`: edges that are not sharp,
//!    where asked for.
//! 9. [`Mesh::check`]: closed, manifold, oriented, volume = area × thickness, in the precision of the file.
//! 10. `formats`: the bytes of files, one module per format; `write`, `manifest`: the files, with the feature `files`,
//!     which is on by default.
//!
//! Promised: every solid that is returned has passed the check, and each fragment that holds a particle is one solid in
//! every frame, unless `smallest_fragment` leaves it out. Not promised: that solids stay apart that the simulation lets
//! overlap by more than .4 cells in the mean; openings below two grid steps (4e-6 m in a body of 20 m) may
//! be shown closed.

#[cfg(test)]
extern crate self as fissure_post;

#[doc(hidden)]
pub mod bench;
mod bevel;
mod body_names;
mod body_size;
mod boolean;
mod carrying;
mod closed;
mod colliders;
#[cfg(test)]
#[path = "../tests/common/mod.rs"]
mod common;
mod cracked;
mod drawn_along;
mod drawn_curve;
mod drawn_out;
mod edges;
mod error;
mod explode;
mod extrude;
mod faces;
mod formats;
mod held_open;
mod history;
mod interior;
mod joined;
mod lattice;
#[cfg(feature = "files")]
mod manifest;
mod mesh;
mod narrows;
mod needles;
mod opening;
mod options;
mod outline;
mod overlaps;
mod packed;
mod parted_corners;
mod particles;
mod pieces;
mod pinch;
mod post;
mod pressed_corners;
mod provenance;
#[cfg(feature = "files")]
mod record;
mod relief;
mod rest_apart;
mod rest_bevel;
#[cfg(test)]
mod rest_boundary;
mod rest_cut;
mod rest_needles;
mod rest_room;
mod rest_solids;
mod rigid;
mod rough_lines;
mod rough_walls;
#[cfg(feature = "files")]
mod sequences;
mod short_edges;
mod sight;
mod slivers;
mod slot;
mod smooth;
mod snap;
mod solids;
mod source;
mod thinned;
mod tidied;
mod triangulate;
mod two_sides;
mod untangled;
mod ways_apart;
mod widening;
#[cfg(feature = "files")]
mod write;
#[cfg(feature = "files")]
mod write_error;

pub use error::PostError;
pub use formats::{FormatError, Sequence, Shot, encode, sequence};
pub use history::History;
#[cfg(feature = "files")]
pub use manifest::Manifest;
pub use mesh::{Content, Mesh, MeshDefect, Vertex};
pub use options::PostOptions;
pub use post::{FrameMeshes, post_frame};
pub use provenance::Provenance;
#[cfg(feature = "files")]
pub use record::{FileRecord, ObjectRecord, SequenceRecord, file_name};
#[cfg(feature = "files")]
pub use sequences::Sequences;
pub use slot::Slot;
#[cfg(feature = "files")]
pub use write::{write_companions, write_frame};
#[cfg(feature = "files")]
pub use write_error::WriteError;
