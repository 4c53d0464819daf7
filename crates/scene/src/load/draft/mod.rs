//! A scene made of a drawing alone: the names of its elements say what they are, a pull that makes the cracks run is
//! added, and resolution and time come from the sizes drawn.

mod layout;
mod pull;
mod roles;
mod sketch;
mod text;
mod unused_lines;

use super::drawing::LoadedDrawing;
use super::error::{DRAWING, LoadError, LoadErrorKind};
use super::loaded::Loaded;
use super::seating::Complaint;
use crate::document::{Drawing, Origin};
use crate::fault::Warning;
use crate::load::nearest::nearest;
use crate::materials::{material_preset, material_presets};
use layout::Layout;
use sha2::{Digest, Sha256};
use sketch::Sketch;
use std::path::{Path, PathBuf};
use unused_lines::unused_lines;
use usvg::roxmltree;

/// What a drawing does not say.
#[derive(Debug, Clone, PartialEq)]
pub struct DraftOptions {
    /// Name of the scene.
    pub name: String,
    /// Material of the bodies: one that comes with Fissure.
    pub material: String,
    /// Thickness of the solids [m]; none: a tenth of their size.
    pub thickness: Option<f64>,
    /// What the width of the drawing spans [m]; none: what its units say.
    pub width: Option<f64>,
}

/// A scene file made of a drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct Draft {
    text: String,
    drawing: PathBuf,
    reference: PathBuf,
    warnings: Vec<Warning>,
}

/// What the last line of a draft begins with; the SHA-256 of all before it follows.
const MARK: &str = "# Made anew from the drawing as long as nothing above is changed: ";

impl Draft {
    fn new(contents: String, drawing: &Path, reference: &str, warnings: Vec<Warning>) -> Self {
        let mark = format!("\n{MARK}{}\n", digest(&contents));
        Self { text: contents + &mark, drawing: drawing.into(), reference: reference.into(), warnings }
    }

    /// The text of the scene file.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether `text` is a draft that nobody has changed.
    pub fn is_untouched(text: &str) -> bool {
        let parts = text.rsplit_once(MARK).and_then(|(above, mark)| Some((above.strip_suffix('\n')?, mark)));
        parts.is_some_and(|(above, mark)| mark.trim_end() == digest(above))
    }

    /// Loads the scene as if its file were at `path`, which need not be written yet. Its warnings tell of the drawing,
    /// too.
    ///
    /// # Errors
    /// As [`load`](super::load).
    pub fn load(&self, path: &Path, overrides: &[String]) -> Result<Loaded, LoadError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let locate = |file: &Path| if file == self.reference { self.drawing.clone() } else { folder.join(file) };
        let mut loaded = super::load_text(path, self.text.clone(), overrides, locate)?;
        loaded.warnings.extend(self.warnings.iter().cloned());
        Ok(loaded)
    }
}

fn digest(text: &str) -> String {
    Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// A scene for the drawing at `drawing`; it refers to it by `reference`, which is relative to the folder of the scene.
///
/// Elements, groups and layers whose id or label is `body`, `crack`, `guide` or `collider` are what they say. In a
/// drawing that calls nothing a body, the only shape is one, with open lines beside it as cracks; where nothing has a
/// name at all, everything is.
///
/// # Errors
/// When the drawing cannot be read, or does not say what is what.
pub fn draft(drawing: &Path, reference: &str, options: &DraftOptions) -> Result<Draft, LoadError> {
    let told = |(message, remedy): Complaint| scene_error(drawing, message, remedy);
    let Some(material) = material_preset(&options.material) else {
        let known: Vec<String> = material_presets().into_iter().map(|m| m.name).collect();
        let argument = PathBuf::from(format!("--material {}", options.material));
        let message = format!("there is no material `{}`", options.material);
        return Err(scene_error(&argument, message, nearest(&options.material, &known)));
    };
    let keys = Drawing {
        file: drawing.into(),
        width: options.width,
        metres_per_unit: None,
        origin: Origin::Center,
        font: None,
    };
    let text = DRAWING.read_text(drawing)?;
    let unsized_drawing = |fault: crate::fault::SceneFault| {
        let remedy = "say how many metres its width spans: `--width 0.2` (or give the drawing a width in mm, cm or in)";
        scene_error(drawing, fault.message, remedy.to_owned())
    };
    let loaded = LoadedDrawing::parse(&keys, drawing, text.clone(), None, unsized_drawing)?;
    // Within its limits, for it has been read.
    let parsing = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    let document = roxmltree::Document::parse_with_options(&text, parsing)
        .map_err(|e| LoadError::file(drawing, format!("not valid SVG: {e}"), "save it again in an SVG editor"))?;
    let elements = roles::elements(&document);
    let sketch = Sketch::of(&elements, &loaded).map_err(told)?;
    let layout = Layout::of(&sketch, &loaded, &material).map_err(told)?;
    let warnings = unused_lines(&elements, &sketch, layout.notch.is_some()).into_iter().collect();
    Ok(Draft::new(text::scene_file(&sketch, &layout, reference, options), drawing, reference, warnings))
}

fn scene_error(path: &Path, message: String, remedy: String) -> LoadError {
    LoadError { kind: LoadErrorKind::Scene, ..LoadError::file(path, message, remedy) }
}
