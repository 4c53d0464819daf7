//! Small simulations whose frames, states and takes inputs begin from.

use super::random::Random;
use super::tree::{Tree, mutate_bytes};
use fissure_files::Folder;
use fissure_scene::{Frame, Precision, Provenance, Scene, TakeWriter, frame_to_bytes, load};
use fissure_sim::Simulation;
use sha2::{Digest, Sha256};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// The examples whose scenes are mutated; the one with text is the last.
pub(super) const EXAMPLES: [&str; 8] =
    ["pull", "drop-glass", "drop-snow", "pull-guided", "three-holes", "two-materials", "painted", "logo"];

/// A plate with a hole, cracks that meet, a guide, a second body and a moving obstacle.
const PLATE: &str = r#"
gravity = [0, -9.81]
[[body]]
name = "plate"
material = "pmma"
shape = { polygon = { exterior = [[0, 0], [1, 0], [1, 1], [0, 1]], holes = [[[0.7, 0.7], [0.8, 0.7], [0.8, 0.8], [0.7, 0.8]]] } }
[[body]]
name = "ball"
material = "glass"
shape = { circle = { center = [0.5, 1.4], radius = 0.2 } }
velocity = [0, -1]
[[crack]]
name = "notch"
line = [[0, 0.5], [0.3, 0.5], [0.5, 0.55]]
guide = "path"
[[crack]]
line = [[0.3, 0.5], [0.3, 0.7]]
[[guide]]
name = "path"
line = [[0.5, 0.55], [1.1, 0.6]]
strength = 0.5
[[collider]]
name = "floor"
shape = { half_plane = { point = [0, -0.1] } }
[[collider]]
name = "wheel"
shape = { disc = { center = [0.5, 1.9], radius = 0.1 } }
keyframes = [{ time = 0 }, { time = 1, position = [0.1, 0.1], angle = 30 }]
[[load]]
select = { edge = "top", body = "plate" }
traction = [0, 1e6]
[[support]]
select = { edge = "bottom", body = "plate" }
fix = "both"
[grid]
particle_spacing = 0.05
[frames]
range = "1-4"
rate = 4e3
"#;

/// The plate by other means; what the solver keeps differs.
const KINDS: [&[&str]; 3] = [
    &[],
    &["solver.formulation=updated", "solver.transfer=apic", "body.ball.material=snow"],
    &["solver.preset=thesis", "solver.transfer=pic"],
];

/// A simulation after some frames.
#[derive(Debug)]
pub(super) struct Sample {
    pub(super) scene: Scene,
    pub(super) frame: Vec<u8>,
    pub(super) state: Vec<u8>,
    /// Folder of a take of it.
    pub(super) take: PathBuf,
    pub(super) manifest: Tree,
}

/// The simulations, with takes in `folder`.
#[allow(clippy::expect_used, reason = "without samples there is nothing to run")]
pub(super) fn samples(folder: &Path) -> Vec<Sample> {
    let scene_file = folder.join("sample.toml");
    std::fs::write(&scene_file, PLATE).expect("a scene");
    let sample = |(i, overrides): (usize, &&[&str])| {
        let overrides: Vec<String> = overrides.iter().map(|set| (*set).to_owned()).collect();
        let scene = load(&scene_file, &overrides).expect("the sample loads");
        let mut simulation = Simulation::new(&scene).expect("the sample is laid");
        let mut frames: Vec<Frame> = vec![simulation.frame()];
        for _ in 0..2 {
            simulation.advance(&mut |_| ControlFlow::Continue(())).expect("the sample runs");
            frames.push(simulation.frame());
        }
        let take = folder.join(format!("sample-{i}.take"));
        let provenance = Provenance { tool_version: "0".into(), seed: 0 };
        let mut writer = TakeWriter::replace(&Folder::new(&take), &scene, provenance).expect("a take");
        frames.iter().for_each(|frame| writer.write_frame(frame, None).expect("a frame"));
        let text = std::fs::read_to_string(take.join("manifest.json")).expect("a manifest");
        let manifest: serde_json::Value = serde_json::from_str(&text).expect("a manifest");
        Sample {
            frame: frame_to_bytes(&frames[2], Precision::Double, None).expect("a frame"),
            state: simulation.save().expect("a state"),
            scene,
            take,
            manifest: Tree::from(manifest),
        }
    };
    KINDS.iter().enumerate().map(sample).collect()
}

/// A manifest with the checksum that it must end in.
pub(super) fn sealed(manifest: &Tree) -> String {
    let mut manifest = manifest.clone();
    if let Tree::Table(entries) = &mut manifest {
        entries.retain(|(key, _)| key != "check");
    }
    let mut text = String::new();
    manifest.to_json(&mut text);
    let body = text.strip_suffix('}').unwrap_or(&text);
    let digest: String = Sha256::digest(body).iter().map(|byte| format!("{byte:02x}")).collect();
    format!("{body},\n  \"check\": \"{digest}\"\n}}\n")
}

/// Changes a safetensors file: its header as JSON, or its numbers.
pub(super) fn mutate_frame(bytes: &mut Vec<u8>, random: &mut Random) {
    let header = bytes.first_chunk::<8>().map_or(0, |length| u64::from_le_bytes(*length) as usize) + 8;
    match random.below(6) {
        0 => mutate_bytes(bytes, random),
        1 => {
            let Some(text) = bytes.get(8..header) else { return };
            let Ok(json) = serde_json::from_slice::<serde_json::Value>(text) else { return };
            let (mut tree, mut text) = (Tree::from(json), String::new());
            let before = tree.clone();
            tree.mutate(random, &before);
            tree.to_json(&mut text);
            let length = (text.len() as u64).to_le_bytes();
            bytes.splice(..header, length.into_iter().chain(text.into_bytes()));
        }
        _ => {
            // Numbers of eight bytes, or two of four, where numbers stand.
            for _ in 0..1 + random.below(6) {
                let at = header + 8 * random.below(bytes.len().saturating_sub(header) / 8);
                let value = match random.below(3) {
                    0 => random.bits() & 0x0000_0003_0000_0007,
                    1 => random.plain().to_bits(),
                    _ => random.hostile().to_bits(),
                };
                if let Some(place) = bytes.get_mut(at..at + 8) {
                    place.copy_from_slice(&value.to_le_bytes());
                }
            }
        }
    }
}
