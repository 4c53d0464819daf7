//! Animations of glTF: nodes that are there for a while, and that move.

use super::gltf_document::Document;
use gltf::json::accessor::Type;
use gltf::json::animation::{Animation, Channel, Interpolation, Property, Sampler, Target};
use gltf::json::validation::Checked::Valid;
use gltf::json::{Accessor, Index, Node};

/// The one animation of a document in the making.
#[derive(Default)]
pub(super) struct Motion {
    channels: Vec<Channel>,
    samplers: Vec<Sampler>,
}

impl Motion {
    /// Shows `node` from the first to the second of `span`, within a film that ends at `end` [s of playback]: its scale
    /// is 1 then and 0 at other times. Who does not play the film sees what is there at its beginning.
    pub(super) fn show(&mut self, document: &mut Document, node: Index<Node>, span: [f32; 2], end: f32) {
        let [from, until] = span;
        let mut keys = Vec::new();
        if from > 0.0 {
            keys.push((0.0, 0.0));
            if let Some(node) = document.root.nodes.get_mut(node.value()) {
                node.scale = Some([0.0; 3]);
            }
        }
        keys.push((from, 1.0));
        keys.push(if until < end { (until, 0.0) } else { (end, 1.0) });
        let times: Vec<f32> = keys.iter().map(|key| key.0).collect();
        let scales: Vec<f32> = keys.iter().flat_map(|key| [key.1; 3]).collect();
        let input = document.times(&times);
        let output = document.keys(&scales, keys.len(), Type::Vec3);
        self.channel(node, Property::Scale, Interpolation::Step, input, output);
    }

    /// Moves `node`: at each of `times` [s of playback] to a place [m], turned by an angle about z [rad]. Evenly
    /// between.
    pub(super) fn carry(
        &mut self,
        document: &mut Document,
        node: Index<Node>,
        times: &[f32],
        poses: &[([f64; 2], f64)],
    ) {
        let places: Vec<f32> = poses.iter().flat_map(|([x, y], _)| [*x as f32, *y as f32, 0.0]).collect();
        let turn = |angle: f64| [0.0, 0.0, (0.5 * angle).sin() as f32, (0.5 * angle).cos() as f32];
        let turns: Vec<f32> = poses.iter().flat_map(|&(_, angle)| turn(angle)).collect();
        let input = document.times(times);
        let output = document.keys(&places, poses.len(), Type::Vec3);
        self.channel(node, Property::Translation, Interpolation::Linear, input, output);
        let output = document.keys(&turns, poses.len(), Type::Vec4);
        self.channel(node, Property::Rotation, Interpolation::Linear, input, output);
    }

    /// Adds the animation to its document; one that moves nothing is none.
    pub(super) fn finish(self, document: &mut Document) {
        if self.channels.is_empty() {
            return;
        }
        let (channels, samplers) = (self.channels, self.samplers);
        let name = Some("cracking".to_owned());
        document.root.animations.push(Animation { extensions: None, extras: None, channels, name, samplers });
    }

    fn channel(
        &mut self,
        node: Index<Node>,
        property: Property,
        interpolation: Interpolation,
        input: Index<Accessor>,
        output: Index<Accessor>,
    ) {
        let sampler = Index::new(self.samplers.len() as u32);
        let interpolation = Valid(interpolation);
        self.samplers.push(Sampler { extensions: None, extras: None, input, interpolation, output });
        let target = Target { extensions: None, extras: None, node, path: Valid(property) };
        self.channels.push(Channel { sampler, target, extensions: None, extras: None });
    }
}

/// The frames of a film so far.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Film {
    /// Frame numbers, rising.
    pub(super) numbers: Vec<i64>,
    /// Frames per second of playback [1/s].
    pub(super) playback: f64,
}

impl Film {
    /// When the frame at `index` of the film begins [s of playback]; beyond the last, when the film ends.
    pub(super) fn time(&self, index: usize) -> f32 {
        let first = self.numbers.first().copied().unwrap_or_default();
        let end = self.numbers.last().map_or(0, |last| last + 1);
        let number = self.numbers.get(index).copied().unwrap_or(end);
        ((number - first) as f64 / self.playback) as f32
    }

    /// When it ends [s of playback].
    pub(super) fn end(&self) -> f32 {
        self.time(self.numbers.len())
    }
}
