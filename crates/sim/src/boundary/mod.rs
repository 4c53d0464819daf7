//! What acts on bodies from outside, whatever the formulation.

pub(crate) mod collider;
pub(crate) mod constraints;
pub(crate) mod edges;
pub(crate) mod loads;
pub(crate) mod pressure;
pub(crate) mod selector;
pub(crate) mod supports;
