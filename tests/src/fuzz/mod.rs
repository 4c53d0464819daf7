//! Hostile input: targets that take bytes, and generators that make inputs for them which are nearly right.
//!
//! Every target either accepts its input or says why not. A panic, an abort, or more time or memory than its limits is
//! a mistake of the program. The binary `fuzz` runs new inputs, a test replays those in `tests/corpus`, and the crate
//! in `fuzz/` lets a coverage-guided fuzzer choose them.

mod drawing;
mod image;
mod pipeline;
mod random;
mod sample;
mod tree;

pub use random::Random;

use fissure_post::{PostOptions, post_frame};
use fissure_scene::{Attribute, Part, Precision, Scene, Take, frame_from_bytes, frame_to_bytes, load};
use fissure_sim::Simulation;
use sample::{EXAMPLES, Sample};
use std::ops::ControlFlow;
use std::path::PathBuf;
use tempfile::TempDir;
use tree::{Tree, mutate_bytes};

/// What reads the input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// A scene file.
    Scene,
    /// A drawing.
    Svg,
    /// An image that paints toughness.
    Png,
    /// A frame of a take, and the meshes of it.
    Frame,
    /// The manifest of a take.
    Manifest,
    /// A saved state, and some steps from it.
    State,
    /// A scene, all the way: steps, meshes, files, a state saved and restored.
    Pipeline,
}

impl Target {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Scene, Self::Svg, Self::Png, Self::Frame, Self::Manifest, Self::State, Self::Pipeline];

    /// Name on the command line and of the folder in the corpus.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scene => "scene",
            Self::Svg => "svg",
            Self::Png => "png",
            Self::Frame => "frame",
            Self::Manifest => "manifest",
            Self::State => "state",
            Self::Pipeline => "pipeline",
        }
    }

    /// The target called `name`.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|target| target.name() == name)
    }
}

/// Why an input was not accepted, in the words of the program.
pub type Refusal = String;

/// Where inputs are made and read: a folder, and what inputs begin from.
#[derive(Debug)]
pub struct Bench {
    folder: TempDir,
    scenes: Vec<(String, Tree)>,
    samples: Vec<Sample>,
    images: Vec<Vec<u8>>,
}

/// Steps that a simulation takes when its state is good.
const STEPS: u64 = 24;

impl Bench {
    /// Lays out what inputs begin from: the examples, small simulations, some images.
    ///
    /// # Panics
    /// When there is no folder for temporary files, or an example does not load.
    #[allow(clippy::expect_used, reason = "without a bench there is nothing to run")]
    pub fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder for temporary files");
        let examples = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../examples");
        let mut scenes = Vec::new();
        for name in EXAMPLES {
            let own = folder.path().join(name);
            std::fs::create_dir(&own).expect("a folder");
            for entry in std::fs::read_dir(examples.join(name)).expect("the example").flatten() {
                std::fs::copy(entry.path(), own.join(entry.file_name())).expect("a file of the example");
            }
            let text = std::fs::read_to_string(own.join("scene.toml")).expect("a scene");
            let table: toml::Table = toml::from_str(&text).expect("a scene");
            scenes.push((name.to_owned(), Tree::from(toml::Value::Table(table))));
        }
        let samples = sample::samples(folder.path());
        Self { folder, scenes, samples, images: image::plain() }
    }

    /// The input number `index` of the sequence `seed`.
    pub fn input(&self, target: Target, seed: u64, index: u64) -> Vec<u8> {
        let random = &mut Random::new(seed, index);
        match target {
            Target::Scene => self.scene_input(random),
            Target::Svg => {
                let mut bytes = drawing::drawing(random).into_bytes();
                if random.once_in(6) {
                    mutate_bytes(&mut bytes, random);
                }
                bytes
            }
            Target::Png => {
                let number = random.below(self.images.len());
                image::mutated(&self.images[number], random)
            }
            Target::Frame => {
                let mut bytes = random.pick(&self.samples).frame.clone();
                sample::mutate_frame(&mut bytes, random);
                bytes
            }
            Target::Manifest => self.manifest_input(random),
            Target::State => {
                let number = random.below(self.samples.len());
                let mut bytes = self.samples[number].state.clone();
                mutate_bytes(&mut bytes, random);
                bytes.insert(0, number as u8);
                bytes
            }
            Target::Pipeline => pipeline::scene(random).into_bytes(),
        }
    }

    fn scene_input(&self, random: &mut Random) -> Vec<u8> {
        // Text is slow to lay out, and one example is all text.
        let last = if random.once_in(100) { self.scenes.len() } else { self.scenes.len() - 1 };
        let (name, tree) = &self.scenes[random.below(last)];
        let mut tree = tree.clone();
        for _ in 0..1 + random.below(4) {
            let other = random.below(self.scenes.len());
            tree.mutate(random, &self.scenes[other].1);
        }
        let mut bytes = format!("# example: {name}\n{}", tree.to_toml_document()).into_bytes();
        if random.once_in(10) {
            let mut body = bytes.split_off(name.len() + 12);
            mutate_bytes(&mut body, random);
            bytes.extend(body);
        }
        bytes
    }

    fn manifest_input(&self, random: &mut Random) -> Vec<u8> {
        let sample = random.pick(&self.samples);
        let mut tree = sample.manifest.clone();
        for _ in 0..1 + random.below(3) {
            tree.mutate(random, &sample.manifest);
        }
        let mut bytes = sample::sealed(&tree).into_bytes();
        if random.once_in(10) {
            mutate_bytes(&mut bytes, random);
        }
        bytes
    }

    /// Gives `input` to `target`.
    ///
    /// # Errors
    /// Why it is not accepted; that is as good as accepting it.
    pub fn run(&self, target: Target, input: &[u8]) -> Result<(), Refusal> {
        match target {
            Target::Scene => self.run_scene(input),
            Target::Svg => self.run_file("svg", "drawing.svg", DRAWN, input),
            Target::Png => self.run_file("png", "image.png", PAINTED, input),
            Target::Frame => self.run_frame(input),
            Target::Manifest => self.run_manifest(input),
            Target::State => self.run_state(input),
            Target::Pipeline => pipeline::run(self.folder.path(), input),
        }
    }

    fn run_scene(&self, input: &[u8]) -> Result<(), Refusal> {
        let first = input.split(|&b| b == b'\n').next().unwrap_or_default();
        let named = first.strip_prefix(b"# example: ").and_then(|name| std::str::from_utf8(name).ok());
        let folder = self.folder.path().join(named.filter(|name| EXAMPLES.contains(name)).unwrap_or(EXAMPLES[0]));
        let path = folder.join("scene.toml");
        std::fs::write(&path, input).map_err(|e| e.to_string())?;
        let scene = load(&path, &[]).map_err(told)?;
        // What loads is sound, and can be kept in a take.
        scene.validate().map_err(|fault| format!("loaded, but {fault}"))?;
        Ok(())
    }

    fn run_file(&self, folder: &str, name: &str, scene: &str, input: &[u8]) -> Result<(), Refusal> {
        let folder = self.folder.path().join(folder);
        std::fs::create_dir_all(&folder).map_err(|e| e.to_string())?;
        std::fs::write(folder.join(name), input).map_err(|e| e.to_string())?;
        let path = folder.join("scene.toml");
        std::fs::write(&path, scene).map_err(|e| e.to_string())?;
        load(&path, &[]).map_err(told)?;
        Ok(())
    }

    fn run_frame(&self, input: &[u8]) -> Result<(), Refusal> {
        let frame = frame_from_bytes(input, None).map_err(|e| e.to_string())?;
        // Equal frames give equal bytes, whatever the file had besides.
        let again = frame_to_bytes(&frame, Precision::Double, None)
            .and_then(|bytes| frame_from_bytes(&bytes, None))
            .map_err(|e| e.to_string())?;
        let sample = &self.samples[0];
        post_frame(&sample.scene, &again, &everything(&sample.scene)).map_err(|e| e.to_string())?;
        Ok(())
    }

    fn run_manifest(&self, input: &[u8]) -> Result<(), Refusal> {
        let folder = &self.samples[0].take;
        std::fs::write(folder.join("manifest.json"), input).map_err(|e| e.to_string())?;
        let take = Take::open(folder).map_err(|e| e.to_string())?;
        for number in take.frame_numbers().into_iter().take(3) {
            let frame = take.frame(number).map_err(|e| e.to_string())?;
            post_frame(take.scene(), &frame, &everything(take.scene())).map_err(|e| e.to_string())?;
        }
        Ok(())
    }

    fn run_state(&self, input: &[u8]) -> Result<(), Refusal> {
        let (number, bytes) = input.split_first().ok_or("empty")?;
        let scene = &self.samples[usize::from(*number) % self.samples.len()].scene;
        let mut simulation = Simulation::restore(scene, bytes).map_err(|e| e.to_string())?;
        let mut steps = 0;
        let mut watch = |_: &fissure_sim::Progress| {
            steps += 1;
            if steps < STEPS { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        };
        simulation.advance(&mut watch).map_err(|e| e.to_string())?;
        frame_to_bytes(&simulation.frame(), Precision::Double, None).map_err(|e| e.to_string())?;
        Ok(())
    }
}

impl Default for Bench {
    fn default() -> Self {
        Self::new()
    }
}

/// Options that make every part.
fn everything(scene: &Scene) -> PostOptions {
    let parts = vec![Part::Cracked, Part::Body, Part::Faces, Part::Collider, Part::Particles];
    PostOptions { parts, attributes: Attribute::ALL.to_vec(), ..PostOptions::from(&scene.output) }
}

/// A refusal without the folder of the bench, which differs from run to run.
fn told(error: fissure_scene::LoadError) -> Refusal {
    let line = error.line().map_or_else(String::new, |line| format!("{line}: "));
    format!("{line}{}; {}", error.message, error.remedy)
}

/// A scene around a drawing.
const DRAWN: &str =
    "[drawing]\nfile = 'drawing.svg'\nwidth = 1.0\n[[body]]\nname = 'b'\nmaterial = 'pmma'\nshape = { svg = 'b' }\n";
/// A scene around an image.
const PAINTED: &str = "[[body]]\nname = 'b'\nmaterial = 'pmma'\nshape = { rectangle = { min = [0, 0], max = [1, 1] } }\n\
    [[toughness]]\nimage = 'image.png'\n";
