//! Contact of surfaces: of bodies, of fragments, and of far parts of one body.
//!
//! What touches are the outlines and the crack faces that are carried along and shown in the end, as chains of vertices
//! ([`surface::Surface`]). A vertex that comes to an edge of something else is kept out of it by an impulse along the
//! normal of that edge, shared out to the fields that carry the vertex and the edge by their weights: equal and
//! opposite, so that momentum is kept to round-off, and where the surfaces are drawn, not where nodes are.
//!
//! - [`neighbours`]: which vertices can come to which edges before the next look.
//! - [`nearing`]: how much nearer to each other these may have come.
//! - [`meeting`]: the nearest edge of a vertex, the gap and the normal.
//! - [`impulses`]: impulses of all meetings together.
//! - [`friction`]: Coulomb's cone.

pub(crate) mod friction;
pub(crate) mod impulses;
pub(crate) mod meeting;
mod nearing;
pub(crate) mod neighbours;
pub(crate) mod surface;
mod surroundings;
