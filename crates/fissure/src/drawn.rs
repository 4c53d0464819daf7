//! Scenes made of a drawing alone, and where they are written.

use crate::args::SceneArguments;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::invocation::quoted;
use crate::report::Report;
use fissure_files::Folder;
use fissure_scene::{Draft, DraftOptions, Loaded};
use std::io;
use std::path::{Component, Path, PathBuf};

/// The scene's file in its folder.
const SCENE_FILE: &str = "scene.toml";

/// What a stage wants of a scene made of a drawing, or of any other.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wanted<'a> {
    /// Thickness of the solids [m], if it is given.
    pub(crate) thickness: Option<f64>,
    /// Whether the scene of a drawing is written beside the output.
    pub(crate) written: bool,
    /// The output folder, if it is given.
    pub(crate) output: Option<&'a Path>,
}

/// Whether the scene asked for is a drawing.
pub(crate) fn is_drawing(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("svg"))
}

/// That nothing is asked for that only a drawing needs.
///
/// # Errors
/// When it is.
pub(crate) fn refuse_options(arguments: &SceneArguments) -> Result<(), Failure> {
    let given = [("--material", arguments.material.is_some()), ("--width", arguments.width.is_some())];
    match given.iter().find(|(_, given)| *given) {
        None => Ok(()),
        Some((option, _)) => {
            let message = format!("`{option}` is for drawings, and `{}` is none", arguments.scene.display());
            Err(Failure::new(Exit::Usage, message, "say it in the scene file, or with `--set KEY=VALUE`"))
        }
    }
}

/// Makes the scene of a drawing, shows it, writes it if it is wanted, and loads it with `overrides` on top.
///
/// # Errors
/// When the drawing does not say what is what, the scene cannot be simulated, or an edited scene is in the way.
pub(crate) fn load(
    arguments: &SceneArguments,
    overrides: &[String],
    wanted: &Wanted<'_>,
    report: &Report,
) -> Result<Loaded, Failure> {
    let drawing = &arguments.scene;
    let Some(material) = arguments.material.clone() else {
        let known: Vec<String> = fissure_scene::material_presets().into_iter().map(|m| m.name).collect();
        let message = format!("`{}` is a drawing, and does not say what its bodies are made of", drawing.display());
        return Err(Failure::new(Exit::Usage, message, format!("add `--material NAME`: {}", known.join(", "))));
    };
    let name = drawing.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let folder = wanted.output.map_or_else(|| Path::new("out").join(&name), Path::to_owned);
    let options = DraftOptions { name, material, thickness: wanted.thickness, width: arguments.width };
    let draft = fissure_scene::draft(drawing, &reference(&folder, drawing)?, &options)?;
    let path = folder.join(SCENE_FILE);
    // Loaded before it is written: what cannot be simulated leaves nothing behind.
    let loaded = draft.load(&path, overrides)?;
    if wanted.written {
        write(&Folder::new(&folder), &draft, overrides, wanted, report)?;
    } else {
        report.note(draft.text());
    }
    Ok(loaded)
}

/// Shows the scene and writes it into `folder`, unless one that somebody has edited is there.
fn write(
    folder: &Folder,
    draft: &Draft,
    overrides: &[String],
    wanted: &Wanted<'_>,
    report: &Report,
) -> Result<(), Failure> {
    let path = folder.place(SCENE_FILE)?;
    let command = command(&path, overrides, wanted);
    let there = folder.read(SCENE_FILE)?;
    let there = there.as_ref().map(|bytes| String::from_utf8_lossy(bytes));
    if there.as_ref().is_some_and(|text| !Draft::is_untouched(text)) {
        let message =
            format!("`{}` was changed since it was made of a drawing, or was not made of one", path.display());
        let remedy = format!("run what is there: `{command}`; or move it away, or name another folder with `--output`");
        return Err(Failure::new(Exit::Usage, message, remedy));
    }
    report.note(draft.text());
    if there.is_none_or(|text| text != draft.text()) {
        folder.make()?;
        folder.write(SCENE_FILE, draft.text().as_bytes())?;
        folder.sync()?;
    }
    report.note(&format!("this scene is in {}; edit it as you like and run it: {command}", path.display()));
    Ok(())
}

/// The command that runs the scene that was made, into the same folder.
fn command(path: &Path, overrides: &[String], wanted: &Wanted<'_>) -> String {
    let mut words = vec!["fissure run".to_owned(), quoted(&path.to_string_lossy())];
    words.extend(wanted.output.map(|folder| format!("--output {}", quoted(&folder.to_string_lossy()))));
    words.extend(overrides.iter().map(|set| format!("--set {}", quoted(set))));
    words.join(" ")
}

/// The drawing as seen from `folder`, so that both can be moved together; from the root where they share no folder.
fn reference(folder: &Path, drawing: &Path) -> Result<String, Failure> {
    let refused = |path: &Path| {
        let path = path.to_path_buf();
        move |error: io::Error| {
            let message = format!("cannot find `{}`: {error}", path.display());
            Failure::new(Exit::File, message, "check the path and its permissions")
        }
    };
    let drawing = drawing.canonicalize().map_err(refused(drawing))?;
    let folder = canonical_of_missing(folder).map_err(refused(folder))?;
    let shared = drawing.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    let from_root = drawing.components().take_while(|c| !matches!(c, Component::Normal(_))).count();
    let parts: PathBuf = if shared > from_root {
        let up = folder.components().skip(shared).map(|_| Component::ParentDir);
        up.chain(drawing.components().skip(shared)).collect()
    } else {
        drawing
    };
    let text = parts.to_str().ok_or_else(|| {
        let message = format!("the path `{}` is no Unicode text, and a scene file cannot name it", parts.display());
        Failure::new(Exit::Usage, message, "rename the drawing, or the folder it is in")
    })?;
    // Every system reads slashes.
    Ok(text.replace(std::path::MAIN_SEPARATOR, "/"))
}

/// The path without links and detours of a folder that may not be there yet.
fn canonical_of_missing(folder: &Path) -> io::Result<PathBuf> {
    let absolute = std::path::absolute(folder)?;
    let there = absolute.ancestors().find(|above| above.exists()).unwrap_or(&absolute);
    let missing = absolute.strip_prefix(there).unwrap_or(Path::new(""));
    Ok(there.canonicalize()?.join(missing))
}
