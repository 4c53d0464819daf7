//! Where pressure acts: pieces of edges and of crack faces, at rest.

use crate::boundary::selector::Selector;
use crate::crack::Crack;
use crate::crack::cracks::{Cracks, TipId};
use crate::crack::crossing::Side;
use crate::grid::coverage::cuts;
use fissure_plane::{Point, Vector, distance_to_segment};
use fissure_scene::{CrackEnd, End, KeyPath, LoadKind, Scene, SceneFault, Selection};

/// How far a place beside the end of a piece lies from it, in cells: so far along the piece ...
const ALONG: f64 = 1e-5;
/// ... and so far off the face. Faces that meet at more than atan(OFF/ALONG), 6 degrees, keep it between them.
const OFF: f64 = 1e-6;
/// A mouth so near to an edge, in cells, lies on it.
const ON_EDGE: f64 = 1e-6;

/// A straight piece of an edge or of a crack face within one square of a lattice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PressedPiece {
    /// The body.
    pub(crate) body: u32,
    /// Its ends [m]; the material that is pressed on lies to the left of the way from the first to the second.
    pub(crate) ends: [Point; 2],
    /// Number of the crack and the face of it; none of an edge.
    pub(crate) face: Option<(u32, Side)>,
}

impl PressedPiece {
    /// Its middle [m].
    pub(crate) fn middle(&self) -> Point {
        nalgebra::center(&self.ends[0], &self.ends[1])
    }

    /// The place at a part of it, from 0 to 1 [m].
    pub(crate) fn at(&self, part: f64) -> Point {
        self.ends[0] + (self.ends[1] - self.ends[0]) * part
    }

    /// A place beside that, within the piece and, of a face, in the material that is pressed on [m].
    pub(crate) fn beside(&self, part: f64, cell_size: f64) -> Point {
        let way = (self.ends[1] - self.ends[0]).try_normalize(0.0).unwrap_or_default();
        let inward = if part < 0.5 { way } else { -way };
        let left = Vector::new(-way.y, way.x);
        let off = if self.face.is_some() { OFF } else { 0.0 };
        self.at(part) + (inward * ALONG + left * off) * cell_size
    }
}

/// What of the material one load presses on, in an order that the scene and the cracks alone decide, cut at the lines
/// of a lattice through `anchor`, `spacing` apart [m].
///
/// # Errors
/// When no edge is selected.
pub(crate) fn pressed_pieces(
    scene: &Scene,
    (anchor, spacing): (Point, f64),
    cracks: &Cracks,
    index: usize,
) -> Result<Vec<PressedPiece>, SceneFault> {
    let load = &scene.loads[index];
    let in_squares = |p: Point| (p - anchor) / spacing;
    match &load.kind {
        LoadKind::Pressure(_) => {
            let pieces = edge_pieces(scene, &load.selection, cracks, in_squares);
            if pieces.is_empty() { Err(no_edge(index, &load.selection)) } else { Ok(pieces) }
        }
        LoadKind::FacePressure(of, _) => {
            Ok(family(scene, cracks, of).into_iter().flat_map(|c| face_pieces(c, &cracks[c], in_squares)).collect())
        }
        _ => Ok(Vec::new()),
    }
}

/// The pieces of the selected edges, cut where cracks open at them.
fn edge_pieces(
    scene: &Scene,
    selection: &Selection,
    cracks: &Cracks,
    in_squares: impl Fn(Point) -> Vector,
) -> Vec<PressedPiece> {
    let mouths: Vec<TipId> = cracks.ids().filter(|&id| cracks.end(id) == CrackEnd::Mouth).collect();
    let mut pieces = Vec::new();
    for edge in Selector::new(scene, selection).parts(scene).into_iter().filter(|edge| edge.from != edge.to) {
        let way = edge.to - edge.from;
        let mut parts = cuts(in_squares(edge.from), in_squares(edge.to));
        for &id in mouths.iter().filter(|id| cracks.of(**id).body as usize == edge.body) {
            let place = cracks.position(id);
            if distance_to_segment(place, edge.from, edge.to) < ON_EDGE * scene.cell_size {
                parts.push(((place - edge.from).dot(&way) / way.norm_squared()).clamp(0.0, 1.0));
            }
        }
        parts.sort_unstable_by(f64::total_cmp);
        parts.dedup();
        let at = |part: f64| if part == 1.0 { edge.to } else { edge.from + way * part };
        pieces.extend(parts.windows(2).map(|part| PressedPiece {
            body: edge.body as u32,
            ends: [at(part[0]), at(part[1])],
            face: None,
        }));
    }
    pieces
}

/// Both faces of a crack.
fn face_pieces(number: usize, crack: &Crack, in_squares: impl Fn(Point) -> Vector) -> Vec<PressedPiece> {
    let mut pieces = Vec::new();
    for segment in crack.points.windows(2).filter(|segment| segment[0] != segment[1]) {
        let [a, b] = [segment[0], segment[1]];
        for part in cuts(in_squares(a), in_squares(b)).windows(2) {
            let ends = [part[0], part[1]].map(|part| if part == 1.0 { b } else { a + (b - a) * part });
            for side in [Side::Above, Side::Below] {
                // What is above lies to the left of the crack's own way.
                let ends = if side == Side::Above { ends } else { [ends[1], ends[0]] };
                pieces.push(PressedPiece { body: crack.body, ends, face: Some((number as u32, side)) });
            }
        }
    }
    pieces
}

/// Some cracks of the scene and what has branched off them.
fn family(scene: &Scene, cracks: &Cracks, of: &[usize]) -> Vec<usize> {
    let mut family = of.to_vec();
    for number in scene.cracks.len()..cracks.len() {
        if let CrackEnd::Junction { crack } = cracks.end(TipId::new(number, End::Start))
            && family.contains(&(crack as usize))
        {
            family.push(number);
        }
    }
    family
}

fn no_edge(index: usize, selection: &Selection) -> SceneFault {
    let path = KeyPath::item("load", index).then("select");
    let (why, remedy) = match selection {
        Selection::Edge { side, .. } => {
            let side = format!("{side:?}").to_lowercase();
            let why = format!("no piece of an outline lies along the {side} side of the bodies' box");
            (why, "select a `region` around the edge, or with `svg` a line along it")
        }
        _ => ("no part of an outline lies in it".to_owned(), "move it onto an edge of a body, or make it larger"),
    };
    SceneFault::new(path, format!("load {} presses on no edge: {why}", index + 1), remedy)
}
