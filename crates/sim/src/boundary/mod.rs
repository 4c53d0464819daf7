//! What acts on bodies from outside, whatever the formulation.

pub(crate) mod collider;
pub(crate) mod selector;
