//! Vectors at fields.

use fissure_plane::Vector;

/// A vector at every field, x and y apart.
pub(super) type FieldVectors = [Vec<f64>; 2];

/// The vector at a field.
#[inline]
pub(super) fn at(u: &FieldVectors, field: usize) -> Vector {
    Vector::new(u[0][field], u[1][field])
}
