//! Binary glTF 2.0 of a whole sequence: each frame is there in its time.

use super::gltf_animation::{Film, Motion};
#[cfg(feature = "files")]
use super::gltf_document::made_by;
use super::gltf_document::{Document, ObjectExtras};
use super::sequence_file::{About, Sequence};
use super::{FileFormat, FormatError, Shot};
use crate::provenance::Provenance;
use fissure_scene::Part;
use gltf::json::{Index, Node};

/// One GLB file for all frames: a node per frame, `frame_0001`, with the objects of the frame; an animation gives each
/// the scale 1 in its time and 0 at others. Materials are shared.
pub(crate) struct GltfSequence;

impl FileFormat for GltfSequence {
    fn extension(&self, _: Part) -> &'static str {
        "glb"
    }

    fn frame(&self, shot: &Shot<'_>) -> Result<Vec<u8>, FormatError> {
        super::sequence_file::of_one(self, shot)
    }

    fn sequence(&self) -> Option<Box<dyn Sequence>> {
        Some(Box::new(Frames::default()))
    }

    #[cfg(feature = "files")]
    fn maker(&self, bytes: &[u8]) -> Option<String> {
        made_by(bytes)
    }
}

/// The frames so far.
#[derive(Default)]
struct Frames {
    document: Option<Document>,
    film: Film,
    /// The node of each frame.
    nodes: Vec<Index<Node>>,
    first: Option<Provenance>,
}

impl Sequence for Frames {
    fn add(&mut self, shot: &Shot<'_>) -> Result<(), FormatError> {
        let document = self.document.get_or_insert_with(|| Document::new(shot.scene.frames.time_scale()));
        self.film.playback = shot.scene.frames.playback;
        self.film.numbers.push(shot.provenance.frame);
        self.first.get_or_insert_with(|| shot.provenance.clone());
        let name = format!("frame_{:04}", shot.provenance.frame);
        let mut children = Vec::new();
        for mesh in shot.objects {
            // Names are unique in a file, whoever reads it.
            let named = format!("{}_{name}", mesh.name);
            children.extend(document.node_named(mesh, named, &ObjectExtras { piece: mesh.piece })?);
        }
        let children = (!children.is_empty()).then_some(children);
        self.nodes.push(document.root.push(Node { name: Some(name), children, ..Node::default() }));
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<Vec<u8>, FormatError> {
        let Self { document, film, nodes, first } = *self;
        let (Some(mut document), Some(first)) = (document, first) else { return Err(FormatError::NoFrames) };
        let mut motion = Motion::default();
        for (i, &node) in nodes.iter().enumerate() {
            motion.show(&mut document, node, [film.time(i), film.time(i + 1)], film.end());
        }
        motion.finish(&mut document);
        document.finish(nodes, &first, &About::new(&first, &film))
    }
}
