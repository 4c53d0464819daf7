//! Binary glTF 2.0 of a whole sequence: fragments that move as rigid bodies are nodes that move.

use super::gltf_animation::{Film, Motion};
use super::gltf_document::Document;
#[cfg(feature = "files")]
use super::gltf_document::made_by;
use super::sequence_file::{About, Sequence};
use super::{FileFormat, FormatError, Shot};
use crate::body_names::body_names;
use crate::mesh::{Content, Mesh, Vertex, object_name};
use crate::provenance::Provenance;
use crate::rigid::{RigidMotion, corners};
use fissure_scene::{Part, Point, Scene, Vector};
use gltf::json::{Index, Node};
use serde::Serialize;
use std::collections::BTreeMap;

/// One GLB file for all frames, in which a fragment keeps its mesh as long as it moves as a rigid body.
///
/// A node is one fragment over some frames: its mesh is that of the first of them, its origin the middle of the
/// fragment, and an animation moves and turns it. It ends where the particles of the fragment are off the motion of a
/// rigid body by more than [`TOLERANCE`] of its size, or its outline is, or where it breaks; another node with another
/// mesh follows. So a fragment that deforms has a mesh for each frame, as in a sequence, and one that flies has one.
/// The extras of a node tell its
/// `piece`, its `first` and `last` frame, and the greatest `rigid_error` in them [m].
pub(crate) struct RigidGltf;

/// How far a particle or a side of the outline may be off, in parts of the fragment's larger side: a pixel in a
/// picture of a thousand.
const TOLERANCE: f64 = 1e-3;

impl FileFormat for RigidGltf {
    fn extension(&self, _: Part) -> &'static str {
        "rigid.glb"
    }

    fn frame(&self, shot: &Shot<'_>) -> Result<Vec<u8>, FormatError> {
        super::sequence_file::of_one(self, shot)
    }

    fn sequence(&self) -> Option<Box<dyn Sequence>> {
        Some(Box::new(Spans::default()))
    }

    #[cfg(feature = "files")]
    fn maker(&self, bytes: &[u8]) -> Option<String> {
        made_by(bytes)
    }
}

/// The spans of all fragments so far.
#[derive(Default)]
struct Spans {
    film: Film,
    first: Option<Provenance>,
    time_scale: f64,
    /// Those that may go on, by the name of the object.
    open: BTreeMap<String, Span>,
    /// Those that are over.
    done: Vec<Span>,
}

/// One fragment over some frames.
struct Span {
    /// Its mesh in the first of them, about its middle.
    mesh: Mesh,
    /// Its middle then [m].
    middle: Point,
    /// Its particles, by their ids.
    particles: Vec<u32>,
    /// Their corners in the first frame [m].
    corners: Vec<Point>,
    /// Most that one may be off [m].
    tolerance: f64,
    /// Index of the first frame in the film.
    start: usize,
    /// Motion since the first frame, in each.
    motions: Vec<RigidMotion>,
    /// The most that a corner or a side of the outline is off in any of them [m].
    error: f64,
}

/// What is told of a node.
#[derive(Serialize)]
struct SpanExtras {
    piece: u32,
    first: i64,
    last: i64,
    rigid_error: f64,
}

impl Sequence for Spans {
    fn add(&mut self, shot: &Shot<'_>) -> Result<(), FormatError> {
        let index = self.film.numbers.len();
        self.film.playback = shot.scene.frames.playback;
        self.film.numbers.push(shot.provenance.frame);
        self.time_scale = shot.scene.frames.time_scale();
        self.first.get_or_insert_with(|| shot.provenance.clone());
        let mut before = std::mem::take(&mut self.open);
        for mesh in shot.objects {
            let (particles, corners) = body_of(mesh, shot.scene)
                .map(|body| corners(shot.frame, body, mesh.piece, shot.scene.particle_spacing))
                .unwrap_or_default();
            let mut known = before.remove(&mesh.name);
            if !known.as_mut().is_some_and(|span| span.goes_on(mesh, &particles, &corners)) {
                let next = Span::new(mesh, particles, corners, index);
                self.done.extend(known.replace(next));
            }
            self.open.extend(known.map(|span| (mesh.name.clone(), span)));
        }
        self.done.extend(before.into_values());
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<Vec<u8>, FormatError> {
        let Self { film, first, time_scale, open, mut done } = *self;
        let Some(first) = first else { return Err(FormatError::NoFrames) };
        done.extend(open.into_values());
        done.sort_by(|a, b| (a.start, &a.mesh.name).cmp(&(b.start, &b.mesh.name)));
        let mut document = Document::new(time_scale);
        let (mut motion, mut nodes) = (Motion::default(), Vec::new());
        for span in done {
            nodes.extend(span.write(&mut document, &mut motion, &film)?);
        }
        motion.finish(&mut document);
        document.finish(nodes, &first, &About::new(&first, &film))
    }
}

/// The box around a mesh in the plane, with each vertex where `place` says [m].
fn box_of(mesh: &Mesh, place: impl Fn(&Vertex) -> Point) -> (Point, Point) {
    fissure_plane::bounds(&mesh.vertices.iter().map(place).collect::<Vec<_>>())
}

/// How far apart the sides of two boxes are, at most [m].
fn apart(a: (Point, Point), b: (Point, Point)) -> f64 {
    (a.0 - b.0).amax().max((a.1 - b.1).amax())
}

/// The body that a fragment is of.
fn body_of(mesh: &Mesh, scene: &Scene) -> Option<u32> {
    let is_of = |body: &String| object_name(body, "piece", mesh.piece) == mesh.name;
    body_names(scene).iter().position(is_of).map(|body| body as u32)
}

impl Span {
    fn new(mesh: &Mesh, particles: Vec<u32>, corners: Vec<Point>, start: usize) -> Self {
        let (low, high) = fissure_plane::bounds(&corners);
        let has_size = !corners.is_empty();
        let middle = if has_size { nalgebra::center(&low, &high) } else { Point::origin() };
        let tolerance = if has_size { TOLERANCE * (high - low).amax() } else { 0.0 };
        let mesh = mesh.clone().moved(-middle.coords);
        let still = RigidMotion { angle: 0.0, shift: Vector::zeros() };
        Self { mesh, middle, particles, corners, tolerance, start, motions: vec![still], error: 0.0 }
    }

    /// Whether the fragment, which is now `mesh` and whose particles are at `corners`, has moved on as a rigid body; if
    /// so it has been noted.
    fn goes_on(&mut self, mesh: &Mesh, particles: &[u32], corners: &[Point]) -> bool {
        if self.particles != particles || particles.is_empty() {
            return false;
        }
        let (motion, error) = RigidMotion::fit(&self.corners, corners);
        // The outline may change where no particle moves: by what is smaller than one, or by a crack that comes in.
        let here = |v: &Vertex| motion.apply(self.middle + Vector::new(v.position[0], v.position[1]));
        let now = |v: &Vertex| Point::new(v.position[0], v.position[1]);
        let error = error.max(apart(box_of(&self.mesh, here), box_of(mesh, now)));
        let area = |mesh: &Mesh| if let Content::Solid { area, .. } = mesh.content { area } else { 0.0 };
        let is_as_large = (area(mesh) - area(&self.mesh)).abs() <= 2.0 * TOLERANCE * area(mesh);
        if error > self.tolerance || !is_as_large {
            return false;
        }
        self.error = self.error.max(error);
        self.motions.push(motion);
        true
    }

    /// Adds the node of the span. Vertices of one that moves have no velocity of their own.
    fn write(
        mut self,
        document: &mut Document,
        motion: &mut Motion,
        film: &Film,
    ) -> Result<Option<Index<Node>>, FormatError> {
        let numbers = &film.numbers[self.start..self.start + self.motions.len()];
        let (first, last) = (numbers[0], numbers[numbers.len() - 1]);
        if self.motions.len() > 1 {
            self.mesh.vertices.iter_mut().for_each(|vertex| vertex.velocity = [0.0; 3]);
        }
        let about = SpanExtras { piece: self.mesh.piece, first, last, rigid_error: self.error };
        let name = format!("{}_frame_{first:04}", self.mesh.name);
        let Some(node) = document.node_named(&self.mesh, name, &about)? else { return Ok(None) };
        if let Some(node) = document.root.nodes.get_mut(node.value()) {
            node.translation = Some([self.middle.x as f32, self.middle.y as f32, 0.0]);
        }
        let end = self.start + self.motions.len();
        motion.show(document, node, [film.time(self.start), film.time(end)], film.end());
        if self.motions.len() > 1 {
            let times: Vec<f32> = (self.start..end).map(|index| film.time(index)).collect();
            let pose = |motion: &RigidMotion| (motion.apply(self.middle).coords.into(), motion.angle);
            motion.carry(document, node, &times, &self.motions.iter().map(pose).collect::<Vec<_>>());
        }
        Ok(Some(node))
    }
}
