//! `manifest.json`: what a take is.

use super::{TakeError, files};
use crate::scene::Scene;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// What a take is, as written to `manifest.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Always [`Manifest::FORMAT`].
    pub format: String,
    /// Version of the format.
    pub version: u64,
    /// Version of the program that wrote it.
    pub tool_version: String,
    /// Hash of the scene file, the overrides and the drawing.
    pub scene_hash: String,
    /// Seed of everything random.
    pub seed: u64,
    /// Whether all frames of the scene are there.
    pub complete: bool,
    /// The frames there are, by rising number.
    pub frames: Vec<FrameEntry>,
    /// The whole scene, every choice made.
    pub scene: Scene,
}

/// One frame of a take.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FrameEntry {
    /// Frame number.
    pub number: i64,
    /// Time [s].
    pub time: f64,
    /// File name within the take.
    pub file: String,
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
    /// Version of the format that this program reads and writes.
    pub const VERSION: u64 = 1;

    pub(crate) fn new(scene: &Scene, provenance: Provenance) -> Self {
        Self {
            format: Self::FORMAT.into(),
            version: Self::VERSION,
            tool_version: provenance.tool_version,
            scene_hash: scene.hash.clone(),
            seed: provenance.seed,
            complete: false,
            frames: Vec::new(),
            scene: scene.clone(),
        }
    }

    pub(crate) fn path(folder: &Path) -> PathBuf {
        folder.join("manifest.json")
    }

    pub(crate) fn read(folder: &Path) -> Result<Self, TakeError> {
        let path = Self::path(folder);
        let bytes = std::fs::read(&path).map_err(|cause| match cause.kind() {
            std::io::ErrorKind::NotFound => {
                TakeError::NotATake { path: folder.into(), cause: "it has no manifest.json".into() }
            }
            _ => TakeError::io("read", &path)(cause),
        })?;
        let head: Head = serde_json::from_slice(&bytes).map_err(|e| TakeError::NotATake {
            path: path.clone(),
            cause: format!("its manifest is not one of a take ({e})"),
        })?;
        if head.format != Self::FORMAT {
            return Err(TakeError::NotATake { path, cause: format!("its format is `{}`", head.format) });
        }
        if head.version != Self::VERSION {
            return Err(TakeError::Version { path, found: head.version });
        }
        let manifest: Self = serde_json::from_slice(&bytes).map_err(|e| TakeError::damaged(&path, e))?;
        // Names are joined to the folder: they must stay in it.
        if let Some(entry) = manifest.frames.iter().find(|f| f.file != file_name(f.number)) {
            return Err(TakeError::damaged(&path, format!("frame {} is in a file `{}`", entry.number, entry.file)));
        }
        Ok(manifest)
    }

    pub(crate) fn write(&self, folder: &Path) -> Result<(), TakeError> {
        let path = Self::path(folder);
        let mut bytes = serde_json::to_vec_pretty(self).map_err(|e| TakeError::damaged(&path, e))?;
        bytes.push(b'\n');
        files::write_whole(&path, &bytes)
    }
}

/// Name of the file of a frame: `frame.0001.safetensors`.
pub(crate) fn file_name(number: i64) -> String {
    format!("frame.{number:04}.safetensors")
}
