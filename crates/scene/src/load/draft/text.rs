//! The scene of a drawing as the text of a scene file.

use super::DraftOptions;
use super::layout::Layout;
use super::pull::{Pull, SURPLUS};
use super::sketch::{Sketch, listed};
use fissure_plane::Point;
use std::fmt::Write;

/// Frames of the sequence.
const FRAMES: u32 = 60;
/// Frames that a crack takes which branches off another.
const BRANCH: u32 = 10;

/// The scene file, with comments for whoever goes on from here. The scene refers to its drawing by `reference`.
pub(super) fn scene_file(sketch: &Sketch, layout: &Layout, reference: &str, options: &DraftOptions) -> String {
    let mut text =
        "# Made from a drawing; change what you like and run it. `fissure schema` lists all keys.\n".to_owned();
    // Writing to a string does not fail.
    let _ = writeln!(text, "name = {}", quoted(&options.name));
    let _ = writeln!(text, "\n[drawing]\nfile = {}", quoted(reference));
    if let Some(width) = options.width {
        let _ = writeln!(text, "width = {width}   # metres that its width spans");
    }
    if !sketch.unused.is_empty() {
        let unused = listed(sketch.unused.iter());
        let _ = writeln!(text, "# Called neither body, crack, guide nor collider, and not used: {unused}.");
    }
    for (id, name) in sketch.bodies.iter().zip(names("body", sketch.bodies.len())) {
        let material = quoted(&options.material);
        let _ =
            writeln!(text, "\n[[body]]\nname = \"{name}\"\nmaterial = {material}\nshape = {{ svg = {} }}", quoted(id));
    }
    cracks(&mut text, sketch, layout);
    for (id, name) in sketch.colliders.iter().zip(names("collider", sketch.colliders.len())) {
        let _ = writeln!(text, "\n[[collider]]\nname = \"{name}\"\nshape = {{ svg = {} }}", quoted(id));
    }
    let why = format!(
        "\n# Nothing in a drawing says what breaks it: these loads pull both ends apart, across the crack, in the end with {SURPLUS}\n\
         # times what the crack needs by the formula for a strip. Take them away, or make them stronger or weaker."
    );
    let _ = writeln!(text, "{why}");
    layout.pulls.iter().for_each(|pull| loads(&mut text, pull));
    let _ = writeln!(
        text,
        "[grid]\nparticle_spacing = {}   # m; cells are twice as large",
        rounded(layout.particle_spacing, 3)
    );
    let duration = layout.pulls.iter().map(|pull| pull.duration).fold(0.0, f64::max);
    let rate = rounded(f64::from(FRAMES - 1) / duration, 2);
    let _ = writeln!(
        text,
        "\n[frames]\nrange = \"1-{FRAMES}\"\nrate = {rate}   # frames per second of simulated time: slow motion"
    );
    if let Some(thickness) = options.thickness {
        let _ = writeln!(text, "\n[output]\nthickness = {thickness}   # m");
    }
    text
}

fn cracks(text: &mut String, sketch: &Sketch, layout: &Layout) {
    let guides = names("guide", sketch.guides.len());
    let lines = sketch.cracks.iter().map(|id| format!("line = {{ svg = {} }}", quoted(id)));
    let notch = layout
        .notch
        .map(|[a, b]| format!("# No crack is drawn: this notch starts one.\nline = [{}, {}]", place(a), place(b)));
    let lines: Vec<String> = lines.chain(notch).collect();
    for (index, (line, name)) in lines.iter().zip(names("crack", lines.len())).enumerate() {
        let _ = writeln!(text, "\n[[crack]]\nname = \"{name}\"\n{line}");
        for (guided, guide) in layout.guided.iter().zip(&guides) {
            if let Some((crack, key)) = guided
                && *crack == index
            {
                let _ = writeln!(text, "{key} = \"{guide}\"");
            }
        }
    }
    for ((id, name), guided) in sketch.guides.iter().zip(&guides).zip(&layout.guided) {
        let _ = writeln!(text, "\n[[guide]]\nname = \"{name}\"\nline = {{ svg = {} }}", quoted(id));
        if guided.is_none() {
            let _ = writeln!(text, "duration = {BRANCH}   # frames it takes when the other guide's crack has passed");
        }
    }
}

fn loads(text: &mut String, pull: &Pull) {
    for (band, force) in pull.bands.iter().zip([pull.force, -pull.force]) {
        let corners: Vec<String> = band.iter().map(|p| place(*p)).collect();
        let _ = writeln!(text, "[[load]]\nselect = {{ region = {{ polygon = [{}] }} }}", corners.join(", "));
        let (x, y) = (rounded(force.x, 3), rounded(force.y, 3));
        let _ = writeln!(text, "force = [{x}, {y}]   # in all, N per metre of thickness");
        let _ = writeln!(text, "curve = [[0, 0], [{}, 1]]   # time in s, factor\n", rounded(pull.rise, 3));
    }
}

/// `word`, or `word-1`, `word-2`, ... when there are several.
fn names(word: &str, count: usize) -> Vec<String> {
    if count == 1 { vec![word.to_owned()] } else { (1..=count).map(|i| format!("{word}-{i}")).collect() }
}

/// A text as TOML has it.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn place(point: Point) -> String {
    format!("[{}, {}]", rounded(point.x, 6), rounded(point.y, 6))
}

/// A number with so many digits, as TOML has it.
fn rounded(value: f64, digits: usize) -> String {
    let value: f64 = format!("{value:.*e}", digits - 1).parse().unwrap_or(value);
    // Zero has no sign here.
    let value = value + 0.0;
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = if value != 0.0 && !(1e-4..1e7).contains(&value.abs()) {
        write!(text, "{value:e}")
    } else {
        write!(text, "{value}")
    };
    text
}
