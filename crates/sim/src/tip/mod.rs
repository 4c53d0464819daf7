//! What a crack tip feels: the material around it, and what its integrals make of that.

pub(crate) mod bend;
pub(crate) mod contour;
pub(crate) mod contours;
pub(crate) mod domain;
mod face_terms;
mod face_traction;
pub(crate) mod frame;
pub(crate) mod gauge;
mod reciprocal;
pub(crate) mod side_by_side;
pub(crate) mod stress_intensity;
pub(crate) mod williams;
pub(crate) mod zone;
