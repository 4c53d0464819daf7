//! How wide bodies are.

use fissure_scene::{KeyPath, Region, Scene, Warning};

/// Cells across a body, at least: bending needs that many to be bending.
const FEWEST_CELLS: f64 = 8.0;

/// Width of a region [m]: the smaller side of the rectangle that has its area and its perimeter, holes counted. Exact
/// for rectangles however they are turned; of a thin ring it is about its thickness, of a disc the side of the square
/// of its area.
pub(super) fn width(region: &Region) -> f64 {
    let area = region.area();
    let perimeter: f64 =
        region.rings().flat_map(|ring| (0..ring.len()).map(|i| (ring[(i + 1) % ring.len()] - ring[i]).norm())).sum();
    let half = 0.25 * perimeter;
    match half * half - area {
        beyond if beyond > 0.0 => half - beyond.sqrt(),
        _ => area.sqrt(),
    }
}

/// Bodies with fewer than eight cells across.
pub(super) fn narrow_bodies(scene: &Scene) -> Vec<Warning> {
    let narrow = |(index, body): (usize, &fissure_scene::Body)| {
        let cells = width(&body.region) / scene.cell_size;
        // A body of exactly so many cells is not narrow for being rounded.
        (cells < FEWEST_CELLS * (1.0 - 1e-6)).then(|| {
            let message = format!(
                "body `{}` is only about {cells:.1} cells wide: it will be too stiff, and cracks in it see its edges",
                body.name
            );
            let spacing = super::samples::two_digits(scene.particle_spacing * cells / FEWEST_CELLS, f64::floor);
            let remedy = format!("set `grid.particle_spacing` to {spacing} m or less for {FEWEST_CELLS} cells");
            Warning::new(KeyPath::item("body", index).then("shape"), message, remedy)
        })
    };
    scene.bodies.iter().enumerate().filter_map(narrow).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_scenes::rectangle;
    use fissure_scene::Point;

    /// Truth: the sides of rectangles, and the thickness of a thin ring.
    #[test]
    fn widths_are_those_of_plain_shapes() {
        for (w, h) in [(1.0, 1.0), (1.0, 7.0), (30.0, 2.0)] {
            for angle in [0.0_f64, 0.3, 1.2] {
                let mut region = rectangle([0.0, 0.0], [w, h]);
                let turn = nalgebra::Rotation2::new(angle);
                region.exterior.iter_mut().for_each(|p| *p = turn * *p);
                // Of a square it is half the perimeter less a root of zero: round-off of 1e-16 becomes 1e-8.
                assert!((width(&region) - f64::min(w, h)).abs() < 1e-7, "{w} {h} {angle}");
            }
        }
        let circle = |r: f64, way: f64| -> Vec<Point> {
            (0..720)
                .map(|k| f64::from(k) * way / 720.0 * std::f64::consts::TAU)
                .map(|a| Point::new(r * a.cos(), r * a.sin()))
                .collect()
        };
        let ring = Region { exterior: circle(10.0, 1.0), holes: vec![circle(9.0, -1.0)] };
        // A strip of width w as long as the ring, 19 π m, has two ends more, which the width makes up for: w²/(L − w) =
        // 0.017 m.
        assert!((width(&ring) - 1.0 - 0.017).abs() < 1e-3, "{}", width(&ring));
    }
}
