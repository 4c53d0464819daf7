//! Small plausible scenes, all the way: loaded, laid, some steps, meshes, files, and a state saved and restored.

use super::random::Random;
use super::tree::Tree;
use super::{Refusal, everything, told};
use fissure_files::Folder;
use fissure_post::{post_frame, write_frame};
use fissure_scene::{Format, Precision, Scene, frame_from_bytes, frame_to_bytes, load};
use fissure_sim::Simulation;
use std::fmt::Write;
use std::ops::ControlFlow;
use std::path::Path;

/// More particles than this take too long for a quick look.
const MOST_PARTICLES: f64 = 20_000.0;
/// Spacings along the larger side of the box around all bodies, likewise.
const MOST_ALONG_A_SIDE: f64 = 2_000.0;
/// Steps at most, over all frames.
const MOST_STEPS: u64 = 60;
/// Frames that are computed.
const FRAMES: usize = 2;

/// A scene.
pub(super) fn scene(random: &mut Random) -> String {
    let mut text = String::new();
    let side = 10.0_f64.powi(random.below(9) as i32 - 5);
    let place = |random: &mut Random, low: f64, high: f64| side * (low + (high - low) * random.unit());
    if random.once_in(3) {
        let _ = writeln!(text, "gravity = [0, {}]", -random.unit() * 100.0);
    }
    if random.once_in(3) {
        text.push_str("plane = \"stress\"\n");
    }
    let materials = ["pmma", "glass", "snow", "jello"];
    body(&mut text, "a", materials[random.below(materials.len())], &outline(random, side, 0.0), random);
    if random.once_in(2) {
        body(&mut text, "b", materials[random.below(materials.len())], &outline(random, side, 1.5 * side), random);
    }
    for _ in 0..random.below(4) {
        let _ = write!(text, "[[crack]]\nline = [");
        for _ in 0..2 + random.below(3) {
            let _ = write!(text, "[{:e}, {:e}], ", place(random, -0.6, 0.6), place(random, -0.6, 0.6));
        }
        text.push_str("]\n");
        if random.once_in(3) {
            let _ = writeln!(text, "tips = \"{}\"", random.pick(&["both", "start", "end", "none"]));
        }
    }
    motion(&mut text, random, side);
    settings(&mut text, random, side);
    if random.once_in(3)
        && let Ok(table) = toml::from_str::<toml::Table>(&text)
    {
        let mut tree = Tree::from(toml::Value::Table(table));
        let before = tree.clone();
        tree.mutate(random, &before);
        text = tree.to_toml_document();
    }
    text
}

fn outline(random: &mut Random, side: f64, shift: f64) -> String {
    let half = 0.5 * side * (0.2 + 0.8 * random.unit());
    match random.below(4) {
        0 => format!("{{ circle = {{ center = [{shift:e}, 0], radius = {half:e} }} }}"),
        1 => format!(
            "{{ rectangle = {{ min = [{:e}, {:e}], max = [{:e}, {:e}] }} }}",
            shift - half,
            -half,
            shift + half,
            half
        ),
        2 => {
            let thin = 0.1 * half;
            format!(
                "{{ rectangle = {{ min = [{:e}, {:e}], max = [{:e}, {:e}] }} }}",
                shift - half,
                -thin,
                shift + half,
                thin
            )
        }
        _ => {
            // A star, which crosses itself nowhere.
            let corners = 3 + random.below(20);
            let corner = |i: usize, random: &mut Random| {
                let (sine, cosine) = (std::f64::consts::TAU * i as f64 / corners as f64).sin_cos();
                let reach = half * (0.2 + 0.8 * random.unit());
                format!("[{:e}, {:e}]", shift + reach * cosine, reach * sine)
            };
            let corners: Vec<String> = (0..corners).map(|i| corner(i, random)).collect();
            format!("{{ polygon = [{}] }}", corners.join(", "))
        }
    }
}

fn body(text: &mut String, name: &str, material: &str, shape: &str, random: &mut Random) {
    let _ = write!(text, "[[body]]\nname = \"{name}\"\nmaterial = \"{material}\"\nshape = {shape}\n");
    if random.once_in(2) {
        let _ = writeln!(text, "velocity = [{}, {}]", random.plain(), random.plain());
    }
    if random.once_in(4) {
        let _ = writeln!(text, "angular_velocity = {}", random.plain());
    }
}

fn motion(text: &mut String, random: &mut Random, side: f64) {
    if random.once_in(2) {
        let edge = random.pick(&["left", "right", "top", "bottom"]);
        let traction = 10.0_f64.powi(random.below(10) as i32);
        let _ = writeln!(text, "[[load]]\nselect = {{ edge = \"{edge}\" }}\ntraction = [0, {traction:e}]");
    }
    if random.once_in(3) {
        let _ = writeln!(
            text,
            "[[load]]\nper_point = [{{ at = [0, 0], force = [{}, {}] }}]",
            random.plain(),
            random.plain()
        );
    }
    if random.once_in(2) {
        let edge = random.pick(&["left", "right", "top", "bottom"]);
        let held = random.pick(&["fix = \"both\"", "fix = \"x\"", "velocity_y = 1.0", "velocity_x = -3.0"]);
        let _ = writeln!(text, "[[support]]\nselect = {{ edge = \"{edge}\" }}\n{held}");
    }
    if random.once_in(3) {
        let shape = match random.below(3) {
            0 => format!("half_plane = {{ point = [0, {:e}] }}", -0.6 * side),
            1 => format!("disc = {{ center = [0, {:e}], radius = {:e} }}", 0.8 * side, 0.2 * side),
            _ => format!("box = {{ min = [{:e}, {:e}], max = [{side:e}, {:e}] }}", -side, -side, -0.5 * side),
        };
        let contact = random.pick(&["separate", "slip", "stick"]);
        let _ = writeln!(
            text,
            "[[collider]]\nshape = {{ {shape} }}\ncontact = \"{contact}\"\nfriction = {}",
            random.unit()
        );
    }
}

fn settings(text: &mut String, random: &mut Random, side: f64) {
    let _ = writeln!(text, "[grid]\nparticle_spacing = {:e}", side / (4.0 + 40.0 * random.unit()));
    text.push_str("[solver]\n");
    let choices: [(&str, &[&str]); 9] = [
        ("preset", &["\"standard\"", "\"thesis\""]),
        ("formulation", &["\"total\"", "\"updated\"", "\"auto\""]),
        ("kernel", &["\"bilinear\"", "\"gimp\"", "\"quadratic\"", "\"cubic\""]),
        ("transfer", &["\"pic\"", "\"apic\"", "\"aflip\"", "\"xpic\"", "{ flip = 0.9 }"]),
        ("tip_division", &["\"line_crossing\"", "\"partly_cut\""]),
        ("j_method", &["\"contour\"", "\"domain\""]),
        ("mode_split", &["\"interaction\"", "\"opening_displacement\""]),
        ("on_distortion", &["\"stop\"", "\"switch\""]),
        ("crack_contact", &["true", "false"]),
    ];
    for (key, values) in choices {
        if random.once_in(3) {
            let _ = writeln!(text, "{key} = {}", random.pick(values));
        }
    }
    if random.once_in(3) {
        text.push_str("[growth]\nbranching = true\n");
    }
}

/// Takes a scene all the way.
pub(super) fn run(folder: &Path, input: &[u8]) -> Result<(), Refusal> {
    let path = folder.join("pipeline.toml");
    std::fs::write(&path, input).map_err(|e| e.to_string())?;
    let mut scene = load(&path, &[]).map_err(told)?;
    quicken(&mut scene)?;
    let mut simulation = Simulation::new(&scene).map_err(|e| e.to_string())?;
    let mut steps = 0;
    let mut watch = |_: &fissure_sim::Progress| {
        steps += 1;
        if steps < MOST_STEPS { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    };
    for _ in 0..FRAMES {
        let frame = simulation.frame();
        let bytes = frame_to_bytes(&frame, Precision::Double, None).map_err(|e| e.to_string())?;
        let again = frame_from_bytes(&bytes, None).map_err(|e| format!("a frame of ours is refused: {e}"))?;
        if frame_to_bytes(&again, Precision::Double, None).map_err(|e| e.to_string())? != bytes {
            return Err(unsound("a frame comes back as another"));
        }
        let meshes = post_frame(&scene, &frame, &everything(&scene)).map_err(|e| e.to_string())?;
        write_frame(&Folder::new(folder), &scene, &frame, &meshes, &Format::ALL).map_err(|e| e.to_string())?;
        let state = simulation.save().map_err(|e| e.to_string())?;
        let restored =
            Simulation::restore(&scene, &state).map_err(|e| unsound(&format!("a state of ours is refused: {e}")))?;
        if restored.save().map_err(|e| e.to_string())? != state {
            return Err(unsound("a state comes back as another"));
        }
        if !simulation.advance(&mut watch).map_err(|e| e.to_string())? {
            break;
        }
    }
    Ok(())
}

/// Makes frames so short that each takes few steps; refuses what is large.
fn quicken(scene: &mut Scene) -> Result<(), Refusal> {
    let area: f64 = scene.bodies.iter().map(|b| b.region.area()).sum();
    let boxes = scene.bodies.iter().map(|b| b.region.bounds());
    let (low, high) = boxes.reduce(|(a, b), (c, d)| (a.inf(&c), b.sup(&d))).ok_or("no body")?;
    let s = scene.particle_spacing;
    if area / (s * s) > MOST_PARTICLES || (high - low).amax() / s > MOST_ALONG_A_SIDE {
        return Err("large".into());
    }
    let speed = scene.materials.iter().map(|m| (m.young_modulus / m.density).sqrt()).fold(0.0, f64::max);
    scene.frames.rate = (0.5 * speed / scene.cell_size).clamp(1e-9, 1e15);
    scene.frames.last = scene.frames.last.min(scene.frames.first + FRAMES as i64);
    scene.validate().map_err(|fault| fault.to_string())
}

/// A mistake of the program that panics nowhere by itself.
#[allow(clippy::panic, reason = "the fuzzer counts panics")]
fn unsound(what: &str) -> Refusal {
    panic!("{what}")
}
