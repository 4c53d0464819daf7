//! `manifest.json`: what a take is.

use super::error::TakeError;
use super::sealed::PAGE;
use crate::scene::Scene;
use fissure_files::Folder;
use serde::{Deserialize, Serialize};

/// Name of the file.
const NAME: &str = "manifest.json";

/// What a take is, as written to `manifest.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Always [`Manifest::FORMAT`].
    pub format: String,
    /// Version of the format.
    pub version: u64,
    /// Version of the program that computed the frames.
    pub tool_version: String,
    /// [`Scene::simulation_hash`]: of all that the frames depend on.
    pub scene_hash: String,
    /// Seed of everything random.
    pub seed: u64,
    /// The whole scene, every choice made.
    pub scene: Scene,
}

/// Where a take comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Provenance {
    /// Version of the program.
    pub tool_version: String,
    /// Seed of everything random.
    pub seed: u64,
}

/// What every version of the manifest has.
#[derive(Deserialize)]
struct Head {
    format: String,
    version: u64,
}

impl Manifest {
    /// Name of the format.
    pub const FORMAT: &str = "fissure-take";
    /// Version of the format that this program writes.
    pub const VERSION: u64 = 5;
    /// The oldest version that it reads: there each frame says itself what its particles are at rest.
    pub const OLDEST: u64 = 3;
    /// The first version in which cracks say how they came about.
    pub(super) const HISTORY: u64 = 5;

    pub(super) fn new(scene: &Scene, provenance: Provenance) -> Self {
        Self {
            format: Self::FORMAT.into(),
            version: Self::VERSION,
            tool_version: provenance.tool_version,
            scene_hash: scene.hash.clone(),
            seed: provenance.seed,
            scene: scene.clone(),
        }
    }

    /// Whether the folder holds a manifest of a take, of whatever version and however damaged. None: it holds no
    /// manifest, or an empty file, in which there is nothing to lose.
    pub(super) fn is_there(folder: &Folder) -> Result<Option<bool>, TakeError> {
        let bytes = folder.read(NAME)?.filter(|bytes| !bytes.is_empty());
        let says_so = |bytes: Vec<u8>| {
            let format = format!("\"{}\"", Self::FORMAT);
            bytes.windows(format.len()).take(100).any(|window| window == format.as_bytes())
        };
        Ok(bytes.map(says_so))
    }

    pub(super) fn read(folder: &Folder) -> Result<Self, TakeError> {
        let not_a_take = |cause: String| TakeError::NotATake { path: folder.path().into(), cause };
        let bytes = folder.read(NAME)?.ok_or_else(|| not_a_take(format!("it has no {NAME}")))?;
        let path = folder.place(NAME)?;
        let head: Head = serde_json::from_slice(&bytes).map_err(|error| match Self::is_there(folder) {
            Ok(Some(true)) => TakeError::damaged(&path, error),
            _ => not_a_take(format!("its {NAME} is not one of a take ({error})")),
        })?;
        if head.format != Self::FORMAT {
            return Err(not_a_take(format!("its {NAME} is of the format `{}`", head.format.escape_debug())));
        }
        if !(Self::OLDEST..=Self::VERSION).contains(&head.version) {
            return Err(TakeError::Version { path, found: head.version });
        }
        let text = std::str::from_utf8(&bytes).map_err(|error| TakeError::damaged(&path, error))?;
        if !PAGE.holds(text) {
            return Err(TakeError::damaged(&path, "its checksum does not fit"));
        }
        let manifest: Self = serde_json::from_str(text).map_err(|error| TakeError::damaged(&path, error))?;
        // Names of files are made from it, and numbers from it are relied on.
        manifest
            .scene
            .validate()
            .map_err(|fault| TakeError::damaged(&path, format!("its scene is not valid: {fault}")))?;
        Ok(manifest)
    }

    /// Writes the file; [`Folder::sync`] is left to the caller.
    pub(super) fn write(&self, folder: &Folder) -> Result<(), TakeError> {
        let text =
            serde_json::to_string_pretty(self).map_err(|error| TakeError::damaged(&folder.path().join(NAME), error))?;
        Ok(folder.write(NAME, PAGE.seal(&text).as_bytes())?)
    }

    /// Removes the file.
    pub(super) fn remove(folder: &Folder) -> Result<(), TakeError> {
        Ok(folder.remove(NAME)?)
    }
}
