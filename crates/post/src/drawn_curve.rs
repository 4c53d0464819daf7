//! Which way the curves run that outlines were drawn as.

use fissure_plane::distance_to_segment;
use fissure_scene::{OutlineFrame, Point, Scene, Vector};

/// For each edge of a ring of a frame the directions at rest of the curve that was drawn, at its start and at its end,
/// along the ring; zeros where that is a line. None where nothing is told of the ring.
///
/// The ring holds all corners of what was drawn, or two ends of a crack near each, and more between them: an edge is a
/// part of the chord that is nearest to its middle.
pub(crate) fn tangents(scene: &Scene, outline: &OutlineFrame) -> Vec<[Vector; 2]> {
    let Some(body) = scene.bodies.get(outline.body as usize) else { return Vec::new() };
    let number = outline.ring as usize;
    let (Some(ring), Some(turns)) = (body.region.rings().nth(number), body.turns.get(number)) else {
        return Vec::new();
    };
    let count = ring.len();
    if turns.len() != count || outline.rest.is_empty() {
        return Vec::new();
    }
    let chord = |k: usize| [ring[k % count], ring[(k + 1) % count]];
    let distance = |k: usize, place: Point| distance_to_segment(place, chord(k)[0], chord(k)[1]);
    let middle = |i: usize| nalgebra::center(&outline.rest[i], &outline.rest[(i + 1) % outline.rest.len()]);
    let first = middle(0);
    let nearest = (0..count).min_by(|&k, &m| distance(k, first).total_cmp(&distance(m, first)));
    let mut at = nearest.unwrap_or(0);
    let mut of_edge = |i: usize| {
        let place = middle(i);
        while distance(at + 1, place) < distance(at, place) {
            at += 1;
        }
        let [turn, to] = turns[at % count];
        if [turn, to] == [0.0; 2] {
            return [Vector::zeros(); 2];
        }
        let [a, b] = chord(at);
        let along = b - a;
        let ends = [outline.rest[i], outline.rest[(i + 1) % outline.rest.len()]];
        ends.map(|end| {
            let part = ((end - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            nalgebra::Rotation2::new(turn + part * (to - turn)) * along.normalize()
        })
    };
    (0..outline.rest.len()).map(&mut of_edge).collect()
}
