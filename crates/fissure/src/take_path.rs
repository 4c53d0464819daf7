//! Which take is meant, and which of its frames.

use crate::exit::Exit;
use crate::failure::Failure;
use crate::frame_set::FrameSet;
use fissure_scene::Take;
use std::path::{Path, PathBuf};

/// The take meant by `path`: itself, or the one in a folder of meshes.
///
/// # Errors
/// When it is a file, or the folder holds several.
pub(crate) fn take_in(path: &Path) -> Result<PathBuf, Failure> {
    if path.is_file() {
        return Err(Failure::new(
            Exit::File,
            format!("`{}` is a file, and a take is a folder", path.display()),
            "name the folder that `fissure sim` or `fissure run` wrote, or the take in it",
        ));
    }
    let is_take = |path: &Path| path.extension().is_some_and(|extension| extension == "take") && path.is_dir();
    let Ok(entries) = std::fs::read_dir(path) else { return Ok(path.to_owned()) };
    if is_take(path) {
        return Ok(path.to_owned());
    }
    let mut takes: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|p| is_take(p)).collect();
    takes.sort();
    match takes.as_slice() {
        // Whatever it is called, it may be a take.
        [] => Ok(path.to_owned()),
        [only] => Ok(only.clone()),
        several => {
            let names: Vec<String> = several.iter().take(6).map(|take| format!("`{}`", take.display())).collect();
            let message = format!("the folder `{}` holds {} takes", path.display(), several.len());
            Err(Failure::new(Exit::Usage, message, format!("name one of them: {}", names.join(", "))))
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
