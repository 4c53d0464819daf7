//! Which take is meant, and which of its frames.

use crate::exit::Exit;
use crate::failure::Failure;
use crate::frame_set::FrameSet;
use fissure_scene::{Take, TakeError};
use std::path::{Path, PathBuf};

/// Most folders that a message names.
const MOST_NAMED: usize = 6;

/// Opens the take meant by `path`, and says where it is.
///
/// # Errors
/// When there is none, or none that can be read.
pub(crate) fn open(path: &Path) -> Result<(PathBuf, Take), Failure> {
    let place = take_in(path)?;
    match Take::open(&place) {
        Ok(take) => Ok((place, take)),
        Err(TakeError::NotATake { cause, .. }) => Err(no_take(path, &cause)),
        Err(error) => Err(error.into()),
    }
}

/// That the folder at `path` neither is nor holds a take, and what to name instead.
fn no_take(path: &Path, cause: &str) -> Failure {
    let shown = path.display();
    let message = if path.is_dir() {
        format!("the folder `{shown}` is no take and holds none: {cause}")
    } else {
        format!("there is no folder `{shown}`")
    };
    let holds_another = |folder: &Path| takes_in(folder).iter().any(|take| take != path);
    let around: Vec<PathBuf> = match path.parent() {
        Some(parent) if path.is_dir() && holds_another(parent) => vec![parent.to_owned()],
        _ => folders_in(path).filter(|folder| holds_another(folder)).collect(),
    };
    let remedy = if around.is_empty() {
        "name the folder that `fissure run` or `fissure sim` wrote, or the folder ending in `.take` in it".to_owned()
    } else {
        format!("name the folder of a run: {}", named(&around))
    };
    Failure::new(Exit::File, message, remedy)
}

/// The folders in a folder, in order; none where it cannot be read.
fn folders_in(path: &Path) -> impl Iterator<Item = PathBuf> {
    let entries = std::fs::read_dir(path).into_iter().flatten();
    let mut folders: Vec<PathBuf> = entries.filter_map(|e| Some(e.ok()?.path())).filter(|p| p.is_dir()).collect();
    folders.sort();
    folders.into_iter()
}

fn is_take(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "take") && path.is_dir()
}

/// What is called a take in a folder.
fn takes_in(path: &Path) -> Vec<PathBuf> {
    folders_in(path).filter(|folder| is_take(folder)).collect()
}

/// The first of some folders, for people.
fn named(folders: &[PathBuf]) -> String {
    let names: Vec<String> = folders.iter().take(MOST_NAMED).map(|folder| format!("`{}`", folder.display())).collect();
    names.join(", ")
}

/// The take meant by `path`: itself, or the one in a folder of meshes.
///
/// # Errors
/// When it is a file, or the folder holds several.
fn take_in(path: &Path) -> Result<PathBuf, Failure> {
    if path.is_file() {
        return Err(Failure::new(
            Exit::File,
            format!("`{}` is a file, and a take is a folder", path.display()),
            "name the folder that `fissure sim` or `fissure run` wrote, or the take in it",
        ));
    }
    if is_take(path) {
        return Ok(path.to_owned());
    }
    match takes_in(path).as_slice() {
        // Whatever it is called, it may be a take.
        [] => Ok(path.to_owned()),
        [only] => Ok(only.clone()),
        several => {
            let message = format!("the folder `{}` holds {} takes", path.display(), several.len());
            Err(Failure::new(Exit::Usage, message, format!("name one of them: {}", named(several))))
        }
    }
}

/// The folder that holds the take at `path`.
pub(crate) fn folder_of(path: &Path) -> PathBuf {
    path.canonicalize().ok().and_then(|path| path.parent().map(Path::to_owned)).unwrap_or_default()
}

/// The numbers of the frames of a take that are asked for, in order; all where none are.
///
/// # Errors
/// When the take holds no frames, or not those.
pub(crate) fn chosen_frames(take: &Take, path: &Path, frames: Option<&FrameSet>) -> Result<Vec<i64>, Failure> {
    let held = take.frame_numbers();
    let (Some(&first), Some(&last)) = (held.first(), held.last()) else {
        return Err(Failure::new(
            Exit::File,
            format!("`{}` holds no frames yet", path.display()),
            "wait for the first one, or `fissure run` its scene again",
        ));
    };
    if let Some(frames) = frames {
        frames.must_be_in(first, last, "the take")?;
    }
    Ok(held.into_iter().filter(|&number| frames.is_none_or(|frames| frames.contains(number))).collect())
}
