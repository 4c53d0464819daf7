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

/// Drops what lies apart from the rest, with a mean width below `narrowest` grid steps and an edge of a crack, which
/// `is_inside` knows: hairs between cracks that are shown wider than they are, and splinters beside an outline. The
/// largest part stays.
pub(crate) fn drop_narrow_parts(shapes: &mut Vec<Shape>, narrowest: f64, is_inside: impl Fn(&Edge) -> bool) {
    let area = |shape: &Shape| shape.iter().map(|contour| twice_area(contour)).sum::<i128>();
    let Some(largest) = shapes.iter().map(area).max() else { return };
    let is_hair = |outer: &[Edge]| is_narrower(outer, narrowest) && outer.iter().any(&is_inside);
    shapes.retain(|shape| area(shape) == largest || !shape.first().is_some_and(|outer| is_hair(outer)));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boolean::SourceIndex;
    use crate::snap::GridPoint;

    /// A rectangle; `source` tells outlines, 0, from cracks, 1.
    fn rectangle([x, y]: [i64; 2], [width, height]: [i64; 2], source: u32) -> Shape {
        let corners =
            [(x, y), (x + width, y), (x + width, y + height), (x, y + height)].map(|(x, y)| GridPoint::new(x, y));
        let next = corners.into_iter().cycle().skip(1);
        vec![corners.into_iter().zip(next).map(|(a, b)| Edge { a, b, source: SourceIndex(source) }).collect()]
    }

    /// Truth: by hand. A hair along a crack goes; what is wider, what was drawn and what is all there is stays.
    #[test]
    fn hairs_between_cracks_go() {
        let parts = || {
            let (hair, wider) = (rectangle([0, 0], [60, 9_000], 1), rectangle([500, 0], [300, 9_000], 1));
            vec![hair, rectangle([1000, 0], [60, 9_000], 0), wider]
        };
        let is_inside = |edge: &Edge| edge.source == SourceIndex(1);
        let mut shapes = parts();
        drop_narrow_parts(&mut shapes, 100.0, is_inside);
        assert_eq!(shapes, parts()[1..]);
        let mut hair = vec![rectangle([0, 0], [60, 9_000], 1)];
        drop_narrow_parts(&mut hair, 100.0, is_inside);
        assert_eq!(hair.len(), 1);
    }
}
