//! Edges of the parts of bodies that are of another material, carried with the particles.

use crate::projection::Projection;
use fissure_plane::{Point, Region};
use fissure_scene::{Frame, ParticleFrame, Scene};
use tiny_skia::{Path, PathBuilder};

/// Stretch of an edge at which it is torn.
const TORN: f64 = 2.0;

/// The edges of all inclusions in the plane at height `z`; none where there are none.
pub(crate) fn edges(scene: &Scene, frame: &Frame, z: f64, projection: &Projection) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (index, body) in scene.bodies.iter().enumerate() {
        for ring in body.inclusions.iter().flat_map(|inclusion| rings(&inclusion.region)) {
            let mut last: Option<(Point, Point)> = None;
            for &rest in ring.iter().chain(ring.first()) {
                let moved = body.region.contains(rest).then(|| moved(&frame.particles, index as u32, rest)).flatten();
                let Some(place) = moved else {
                    last = None;
                    continue;
                };
                let [x, y, _] = projection.pixel([place.x, place.y, z]);
                // Not across an open crack.
                let is_near = |(before, at): (Point, Point)| (place - at).norm() < TORN * (rest - before).norm();
                if last.is_some_and(is_near) {
                    path.line_to(x as f32, y as f32);
                } else {
                    path.move_to(x as f32, y as f32);
                }
                last = Some((rest, place));
            }
        }
    }
    path.finish()
}

fn rings(region: &Region) -> impl Iterator<Item = &[Point]> {
    std::iter::once(&region.exterior).chain(&region.holes).map(Vec::as_slice)
}

/// Where the place `rest` of a body is: x_p + F (X − X_p) of the particle nearest to it at rest.
fn moved(particles: &ParticleFrame, body: u32, rest: Point) -> Option<Point> {
    let of_body = (0..particles.len()).filter(|&p| particles.body[p] == body);
    let distance = |p: usize| (particles.rest[p] - rest).norm_squared();
    let p = of_body.min_by(|&a, &b| distance(a).total_cmp(&distance(b)))?;
    Some(particles.position[p] + particles.deformation_gradient[p] * (rest - particles.rest[p]))
}
