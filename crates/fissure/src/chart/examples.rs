//! The scenes of a folder of examples.

use crate::exit::Exit;
use crate::failure::Failure;
use std::path::{Path, PathBuf};

/// A scene of its own folder.
#[derive(Debug)]
pub(super) struct Example {
    /// That of its folder.
    pub(super) name: String,
    /// The scene file.
    pub(super) file: PathBuf,
}

/// All folders with a scene in `folder`, by name.
///
/// # Errors
/// When there is none.
pub(super) fn examples(folder: &Path) -> Result<Vec<Example>, Failure> {
    let entries = std::fs::read_dir(folder).map_err(|error| missing(folder, &error.to_string()))?;
    let example = |entry: std::fs::DirEntry| {
        let file = entry.path().join("scene.toml");
        let name = entry.file_name().into_string().ok()?;
        file.is_file().then_some(Example { name, file })
    };
    let mut found: Vec<Example> = entries.flatten().filter_map(example).collect();
    found.sort_by(|a, b| a.name.cmp(&b.name));
    if found.is_empty() {
        return Err(missing(folder, "no folder in it has a scene.toml"));
    }
    Ok(found)
}

fn missing(folder: &Path, why: &str) -> Failure {
    Failure::new(
        Exit::File,
        format!("no examples in `{}`: {why}", folder.display()),
        "say where they are with --examples, or name a chart that needs none: accuracy, stability, speed, features, dial",
    )
}
