//! The drawing plane as SVG, in mm: fragments as they are cut, cracks with their opening, tips.

use super::numbers::{xml, xml_comment};
use super::{FileFormat, FormatError, Shot, origin_line};
use crate::mesh::Mesh;
use crate::slot::Slot;
use fissure_scene::{CrackFrame, End, Part, Point, Scene, TipRecord};
use std::collections::HashMap;
use std::fmt::Write;

/// SVG, 1 user unit for 1 mm, y up in the scene.
pub(crate) struct Drawing;

/// Millimetres per metre.
const MM: f64 = 1e3;
/// Room around the drawing, in parts of its larger side.
const MARGIN: f64 = 0.05;

impl FileFormat for Drawing {
    fn extension(&self, _: Part) -> &'static str {
        "svg"
    }

    fn frame(&self, shot: &Shot<'_>) -> Result<Vec<u8>, FormatError> {
        let (low, high) = bounds(shot.scene, shot.objects);
        let side = (high - low).amax();
        let (low, size) = (low.coords.add_scalar(-MARGIN * side), (high - low).add_scalar(2.0 * MARGIN * side));
        let paper = Paper::of(side);
        let [x, y, width, height] = [low.x, -(low.y + size.y), size.x, size.y].map(|way| paper.millimetres(way));
        // As thick as a line on paper is to a drawing that fills the page.
        let line = paper.millimetres(side / 1000.0);
        let mut text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_owned();
        let _ = writeln!(text, "{}", xml_comment(&origin_line(shot.provenance)));
        let _ = writeln!(
            text,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" \
             viewBox=\"{x} {y} {width} {height}\">"
        );
        let _ = writeln!(text, "<g id=\"fragments\" fill=\"#d5dade\" stroke=\"#30363b\" stroke-width=\"{line}\">");
        shot.objects.iter().for_each(|object| fragment(&mut text, object, paper));
        let _ = writeln!(text, "</g>\n<g id=\"cracks\" fill=\"none\" stroke=\"#c0392b\" stroke-width=\"{line}\">");
        shot.frame.cracks.iter().for_each(|crack| faces(&mut text, crack, paper));
        let _ = writeln!(text, "</g>\n<g id=\"tips\" fill=\"#c0392b\">");
        let live = shot.frame.tips.iter().filter(|tip| tip.state.is_live());
        live.for_each(|record| tip(&mut text, record, 3.0 * line, paper));
        text.push_str("</g>\n</svg>\n");
        Ok(text.into_bytes())
    }

    /// The comment in the second line.
    #[cfg(feature = "files")]
    fn maker(&self, bytes: &[u8]) -> Option<String> {
        let head = b"<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- ";
        bytes.starts_with(head).then(|| super::after_mark(bytes, "<!-- ")).flatten()
    }
}

/// How fine places are told.
#[derive(Clone, Copy)]
struct Paper {
    /// Steps of a millimetre.
    steps: f64,
}

impl Paper {
    /// For a drawing with this larger side [m]: a nanometre, which no drawing program resolves, or what that is to a
    /// drawing of 1 cm, so that areas of smaller ones are right, too.
    fn of(side: f64) -> Self {
        let digits = (-2.0 - side.log10()).ceil().clamp(0.0, 12.0);
        Self { steps: 1e6 * 10.0_f64.powi(digits as i32) }
    }

    fn millimetres(self, metres: f64) -> f64 {
        let rounded = (metres * MM * self.steps).round() / self.steps;
        // Not −0.
        if rounded.is_finite() { rounded + 0.0 } else { metres * MM }
    }

    fn place(self, p: Point) -> [f64; 2] {
        [self.millimetres(p.x), self.millimetres(-p.y)]
    }
}

/// The box around all bodies at rest and all that is shown: the same in all frames as long as nothing leaves it.
fn bounds(scene: &Scene, objects: &[Mesh]) -> (Point, Point) {
    let at_rest = scene.bodies.iter().flat_map(|body| <[Point; 2]>::from(body.region.bounds()));
    let now = objects.iter().flat_map(|o| &o.vertices).map(|v| Point::new(v.position[0], v.position[1]));
    fissure_plane::bounds(&at_rest.chain(now).collect::<Vec<_>>())
}

/// The section of a solid: the edges of its front cap.
fn fragment(text: &mut String, mesh: &Mesh, paper: Paper) {
    let front = |i: u32| mesh.vertices[i as usize].normal[2] > 0.5;
    let mut next = HashMap::new();
    let caps = mesh.slot(Slot::Outside).iter().filter(|t| t.iter().all(|&i| front(i)));
    let edges: Vec<[u32; 2]> = caps.flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    let known: std::collections::HashSet<[u32; 2]> = edges.iter().copied().collect();
    for &[a, b] in edges.iter().filter(|[a, b]| !known.contains(&[*b, *a])) {
        next.insert(a, b);
    }
    let mut path = String::new();
    // In the order of the triangles, so that the bytes do not depend on that of a map.
    for [start, _] in edges {
        let mut here = start;
        let mut command = 'M';
        while let Some(there) = next.remove(&here) {
            let position = mesh.vertices[here as usize].position;
            let [x, y] = paper.place(Point::new(position[0], position[1]));
            let _ = write!(path, "{command}{x} {y}");
            (here, command) = (there, 'L');
        }
        if command == 'L' {
            path.push('Z');
        }
    }
    let _ = writeln!(text, "<path id=\"{}\" data-piece=\"{}\" d=\"{path}\"/>", xml(&mesh.name), mesh.piece);
}

/// Both faces of a crack as one line around its opening, with its length at rest and its greatest opening in mm.
fn faces(text: &mut String, crack: &CrackFrame, paper: Paper) {
    let mut path = String::new();
    let around = crack.above.iter().chain(crack.below.iter().rev());
    for (i, point) in around.enumerate() {
        let [x, y] = paper.place(*point);
        let _ = write!(path, "{}{x} {y}", if i == 0 { 'M' } else { 'L' });
    }
    let length: f64 = crack.rest.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
    let opening = crack.above.iter().zip(&crack.below).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    let [length, opening] = [length, opening].map(|way| paper.millimetres(way));
    let number = crack.crack;
    let _ = writeln!(
        text,
        "<path id=\"crack_{number:04}\" data-length=\"{length}\" data-opening=\"{opening}\" d=\"{path}Z\"/>"
    );
}

/// A tip that may grow, with what was measured there, in Pa·√m and J/m².
fn tip(text: &mut String, tip: &TipRecord, radius: f64, paper: Paper) {
    let [x, y] = paper.place(tip.position);
    let end = if tip.end == End::Start { "start" } else { "end" };
    let TipRecord { crack, mode_1, mode_2, j_integral, .. } = tip;
    let _ = writeln!(
        text,
        "<circle id=\"tip_{crack:04}_{end}\" cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" data-k1=\"{mode_1:e}\" \
         data-k2=\"{mode_2:e}\" data-j=\"{j_integral:e}\"/>"
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: by hand. What is told of a rectangle is its area within 1e-6, whether it is as large as a hall or as
    /// small as a hair is thick; a nanometre is what larger ones are told to.
    #[test]
    fn areas_of_small_bodies_are_right() {
        for side in [30.0, 1.0, 0.0213, 0.0097, 2.3e-4, 6.7e-5, 1.9e-6] {
            let paper = Paper::of(side);
            let [x, y] = paper.place(Point::new(side / 3.0, -2.0 * side / 3.0));
            assert!((x * y * 1e-6 / (2.0 / 9.0 * side * side) - 1.0).abs() < 1e-6, "{side}");
            assert!(side < 0.01 || paper.steps == 1e6);
        }
    }
}
