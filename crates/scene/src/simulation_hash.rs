//! What the frames of a scene depend on, as one number.

use crate::scene::Scene;
use crate::settings::{OutputSettings, PLAYBACK};
use sha2::{Digest, Sha256};

impl Scene {
    /// SHA-256 over all that the frames of this scene depend on, in hexadecimal, and over nothing else: not over names,
    /// the output, how walls are shaded, how many frames there are, or how the scene was written down. Scenes of the
    /// same hash give the same frames.
    pub fn simulation_hash(&self) -> String {
        let mut scene = self.clone();
        scene.hash.clear();
        let names = [&mut scene.name].into_iter().chain(scene.materials.iter_mut().map(|m| &mut m.name));
        let names = names.chain(scene.bodies.iter_mut().map(|b| &mut b.name));
        let names = names.chain(scene.colliders.iter_mut().map(|c| &mut c.name));
        names.for_each(String::clear);
        for crack in &mut scene.cracks {
            crack.name.clear();
            let guides = [&mut crack.start_guide, &mut crack.end_guide];
            guides.into_iter().flatten().for_each(|guide| guide.for_each_mut(&mut |guide| guide.name.clear()));
        }
        scene.bodies.iter_mut().for_each(|body| body.turns.clear());
        scene.frames.last = scene.frames.first;
        scene.frames.playback = PLAYBACK;
        // Each field by its name, so that a new one is thought of here.
        let OutputSettings {
            thickness,
            formats,
            parts,
            up,
            smallest_fragment,
            walls,
            surfaces,
            opening,
            explode,
            attributes,
        } = &mut scene.output;
        (*thickness, *smallest_fragment) = (0.0, 0.0);
        (*up, *walls, *surfaces) = Default::default();
        (*opening, *explode) = (None, None);
        formats.clear();
        parts.clear();
        attributes.clear();
        let mut hasher = Sha256::new();
        // Plain data with names for keys always serialises; a hash takes every byte.
        let _ = serde_json::to_writer(&mut hasher, &scene);
        hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }
}
