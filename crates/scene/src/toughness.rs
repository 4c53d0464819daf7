//! Toughness that varies in space: factors on the fracture toughness of the material, over regions or painted.

use fissure_plane::{Point, Region, Vector};
use serde::{Deserialize, Serialize};

/// Factors on the fracture toughness K_Ic of a body, or of all bodies. Places are those of the body at rest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ToughnessPatch {
    /// Index of the body it applies to; none: all.
    pub body: Option<usize>,
    /// Where, and how much.
    pub kind: ToughnessKind,
}

/// How toughness varies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum ToughnessKind {
    /// One factor over a region, 1 elsewhere.
    Region {
        /// Where.
        region: Region,
        /// Factor, above 0.
        factor: f64,
    },
    /// Painted.
    Image(ToughnessImage),
}

/// Factors painted on a rectangle, 1 elsewhere.
///
/// Bilinear between the centres of pixels; in the half pixel along the border as on the nearest line between centres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ToughnessImage {
    /// Lowest corner of the rectangle [m].
    pub min: Point,
    /// Highest corner [m].
    pub max: Point,
    /// Pixels along x.
    pub columns: usize,
    /// Pixels along y.
    pub rows: usize,
    /// A factor above 0 for each pixel, row by row from the lowest y, in each row from the lowest x.
    pub factors: Vec<f64>,
}

impl ToughnessPatch {
    /// Factor on the fracture toughness of body number `body` at a place of it at rest [m].
    pub(crate) fn factor(&self, body: usize, place: Point) -> f64 {
        if self.body.is_some_and(|b| b != body) {
            return 1.0;
        }
        match &self.kind {
            ToughnessKind::Region { region, factor } if region.contains(place) => *factor,
            ToughnessKind::Region { .. } => 1.0,
            ToughnessKind::Image(image) => image.factor(place),
        }
    }
}

impl ToughnessImage {
    /// Factor at `place` [m].
    pub fn factor(&self, place: Point) -> f64 {
        let (from_low, size) = (place - self.min, self.max - self.min);
        let within = |x: f64, length: f64| (0.0..=length).contains(&x);
        if !within(from_low.x, size.x) || !within(from_low.y, size.y) {
            return 1.0;
        }
        let pixels = Vector::new(self.columns as f64, self.rows as f64);
        // In pixels, measured from the centre of the lowest one.
        let at = from_low.component_mul(&pixels).component_div(&size) - Vector::new(0.5, 0.5);
        let split = |x: f64, count: usize| {
            let x = x.clamp(0.0, (count - 1) as f64);
            let low = x.floor() as usize;
            (low, (low + 1).min(count - 1), x - x.floor())
        };
        let ((left, right, u), (bottom, top, v)) = (split(at.x, self.columns), split(at.y, self.rows));
        let row = |row: usize| {
            let pixel = |column: usize| self.factors[row * self.columns + column];
            (1.0 - u) * pixel(left) + u * pixel(right)
        };
        (1.0 - v) * row(bottom) + v * row(top)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: a bilinear field sampled at pixel centres is reproduced between them to round-off, the nearest value
    /// beyond, 1 outside.
    #[test]
    fn images_reproduce_bilinear_fields() {
        let (columns, rows, pixel) = (4_usize, 3_usize, Vector::new(0.5, 2.0));
        let min = Point::new(-1.0, 3.0);
        let field = |p: Point| 5.0 + 0.3 * p.x + 0.2 * p.y - 0.1 * p.x * p.y;
        let center = |i: usize, j: usize| min + Vector::new((i as f64 + 0.5) * pixel.x, (j as f64 + 0.5) * pixel.y);
        let factors = (0..rows).flat_map(|j| (0..columns).map(move |i| field(center(i, j)))).collect();
        let image = ToughnessImage { min, max: min + Vector::new(2.0, 6.0), columns, rows, factors };
        for (u, v) in [(0.0, 0.0), (0.4, 0.3), (1.0, 0.9), (2.7, 1.6), (3.0, 2.0)] {
            let place = center(0, 0) + Vector::new(u * pixel.x, v * pixel.y);
            assert!((image.factor(place) - field(place)).abs() < 1e-12, "{u} {v}");
        }
        assert_eq!(image.factor(min), image.factor(center(0, 0)));
        assert_eq!(image.factor(image.max), image.factor(center(3, 2)));
        assert_eq!(image.factor(Point::new(1.01, 5.0)), 1.0);
        assert_eq!(image.factor(Point::new(0.0, 2.99)), 1.0);
    }
}
