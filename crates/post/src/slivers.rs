//! Polygons that are no more than rounding.

use crate::boolean::{Edge, Shape, twice_area};

/// Thinnest polygon or hole that is more than rounding, in grid steps of mean width.
const THINNEST: f64 = 2.0;

/// Fills holes and drops polygons that are no more than rounding: of a mean width below two grid steps.
///
/// Faces that touch leave a chain of such slivers; their walls would be hidden faces in a closed crack.
pub(crate) fn without_slivers(shapes: Vec<Shape>) -> Vec<Shape> {
    let mut kept = shapes;
    for shape in &mut kept {
        let mut first = true;
        shape.retain(|contour| std::mem::take(&mut first) || !is_sliver(contour));
    }
    kept.retain(|shape| shape.first().is_some_and(|outer| !is_sliver(outer)));
    kept
}

/// Fills holes of a mean width below `narrowest` grid steps that have edges of cracks only, which `is_inside` knows.
pub(crate) fn fill_narrow_holes(shapes: &mut [Shape], narrowest: f64, is_inside: impl Fn(&Edge) -> bool) {
    for shape in shapes {
        let mut first = true;
        shape
            .retain(|hole| std::mem::take(&mut first) || !is_narrower(hole, narrowest) || !hole.iter().all(&is_inside));
    }
}

/// Whether a contour encloses no more than rounding.
pub(crate) fn is_sliver(contour: &[Edge]) -> bool {
    is_narrower(contour, THINNEST)
}

/// Whether a contour encloses something of a mean width of `width` grid steps at most.
pub(crate) fn is_narrower(contour: &[Edge], width: f64) -> bool {
    let length: f64 = contour.iter().map(|e| ((e.b.x - e.a.x) as f64).hypot((e.b.y - e.a.y) as f64)).sum();
    // A strip of width w and length l has area w l and circumference 2 l.
    twice_area(contour).unsigned_abs() as f64 <= width * length
}
