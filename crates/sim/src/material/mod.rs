//! Constitutive laws: formulas on small values.

pub(crate) mod constitutive;
pub(crate) mod elastic;
