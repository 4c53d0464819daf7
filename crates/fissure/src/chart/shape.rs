//! What a frame looks like, as words of a table: outlines, crack faces and floors, and the strokes that these are drawn
//! with.

use fissure_chart::Stroke;
use fissure_plane::{Point, simplified};
use fissure_scene::{ColliderShape, Frame, Scene, Vector};

/// Places this near to the line without them are left out [thousandths of the size of the bodies]: a tenth of a pixel,
/// as four panels share the width of a page.
const UNSEEN: f64 = 0.5;
/// How far a floor is drawn to both sides of the middle of the bodies [of their size].
const FLOOR: f64 = 0.6;

/// All lines of a frame as words: outlines as `o`, cracks as `c`, floors as `f`, each with places in whole thousandths
/// of the size of the bodies at rest, without those that nobody sees.
pub(super) fn shape(scene: &Scene, frame: &Frame) -> String {
    let outlines = frame.outlines.iter().map(|o| o.position.iter().chain(o.position.first()).copied().collect());
    let faces = frame.cracks.iter().flat_map(|c| [c.above.clone(), c.below.clone()]);
    words(scene, outlines, faces)
}

/// The same of a scene that has not begun.
pub(super) fn shape_at_start(scene: &Scene) -> String {
    let closed = |ring: &Vec<Point>| ring.iter().chain(ring.first()).copied().collect();
    let outlines = scene.bodies.iter().flat_map(|b| std::iter::once(&b.region.exterior).chain(&b.region.holes));
    words(scene, outlines.map(closed), scene.cracks.iter().map(|crack| crack.points.clone()))
}

fn words(
    scene: &Scene,
    outlines: impl Iterator<Item = Vec<Point>>,
    cracks: impl Iterator<Item = Vec<Point>>,
) -> String {
    let corners: Vec<Point> = scene.bodies.iter().flat_map(|body| body.region.exterior.iter().copied()).collect();
    let (low, high) = fissure_plane::bounds(&corners);
    let (size, middle) = ((high - low).amax(), low + 0.5 * (high - low));
    let line = |(kind, points): (char, Vec<Point>)| {
        let line: Vec<Point> = points.iter().map(|p| Point::from((p - low) * (1000.0 / size))).collect();
        let places = simplified(&line, UNSEEN).into_iter().map(|p| format!("{:.0} {:.0}", p.x, p.y));
        format!("{kind} {}", places.collect::<Vec<_>>().join(" "))
    };
    let floors = scene.colliders.iter().filter_map(|collider| {
        let ColliderShape::HalfPlane { normal } = collider.shape else { return None };
        let (_, pose) = collider.keyframes.first()?;
        let (sine, cosine) = pose.angle.sin_cos();
        let along = Vector::new(sine * normal.x + cosine * normal.y, sine * normal.y - cosine * normal.x);
        let point = pose.position;
        let nearest = point + along * along.dot(&(middle - point));
        Some([-FLOOR, FLOOR].map(|part| Point::from(nearest + along * (part * size))).to_vec())
    });
    let of = |kind: char| move |points: Vec<Point>| line((kind, points));
    outlines.map(of('o')).chain(cracks.map(of('c'))).chain(floors.map(of('f'))).collect::<Vec<_>>().join(";")
}

/// The lines that [`shape`] has written.
pub(super) fn strokes(shape: &str) -> Vec<Stroke> {
    let stroke = |line: &str| {
        let mut words = line.split(' ');
        let colour = match words.next() {
            Some("c") => 1,
            Some("f") => 7,
            _ => 0,
        };
        let numbers: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
        Stroke { colour, points: numbers.chunks_exact(2).map(|p| (p[0], p[1])).collect() }
    };
    shape.split(';').map(stroke).collect()
}
