//! Meshes of frames: made, written and listed.

use crate::args::MeshArguments;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report::Report;
use crate::workers::contain;
use fissure_post::{Manifest, PostError, PostOptions, Provenance, WriteError, post_frame, write_frame};
use fissure_scene::{Format, Frame, Scene};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Makes the meshes of frames; shared by all workers.
#[derive(Debug)]
pub(crate) struct Mesher<'a> {
    scene: &'a Scene,
    folder: PathBuf,
    options: PostOptions,
    formats: Vec<Format>,
    report: &'a Report,
    outcome: Mutex<Outcome>,
}

/// What became of the frames so far.
#[derive(Debug, Default)]
struct Outcome {
    manifest: Manifest,
    provenance: Option<Provenance>,
    failed: Vec<i64>,
    worst: Option<Exit>,
}

impl<'a> Mesher<'a> {
    /// Meshes as the scene says, except for what was typed.
    pub(crate) fn new(scene: &'a Scene, folder: &Path, typed: &MeshArguments, report: &'a Report) -> Self {
        let mut options = PostOptions::from(&scene.output);
        if let Some(thickness) = typed.thickness {
            options.thickness = thickness;
        }
        if let Some(up) = typed.up {
            options.up = up;
        }
        if !typed.parts.is_empty() {
            options.parts.clone_from(&typed.parts);
        }
        let formats = if typed.formats.is_empty() { &scene.output.formats } else { &typed.formats };
        Self { scene, folder: folder.to_owned(), options, formats: formats.clone(), report, outcome: Mutex::default() }
    }

    /// Makes and writes the meshes of the frame that `get` gives. A failure is reported at once and remembered; the other frames go on.
    pub(crate) fn make(&self, number: i64, get: impl FnOnce() -> Result<Frame, Failure>) {
        let made = contain(|| {
            let meshes = post_frame(self.scene, &get()?, &self.options)?;
            let records = write_frame(&self.folder, &self.scene.name, &meshes, &self.formats)?;
            Ok((records, meshes.provenance))
        });
        let mut outcome = self.outcome.lock().unwrap_or_else(PoisonError::into_inner);
        match made {
            Ok((records, provenance)) => {
                outcome.manifest.add(records);
                outcome.provenance = Some(provenance);
            }
            Err(failure) => {
                outcome.failed.push(number);
                outcome.worst.get_or_insert(failure.exit);
                self.report.error(&failure.during(format!("no mesh of frame {number}")));
            }
        }
    }

    /// Writes the list of all meshes.
    ///
    /// # Errors
    /// When frames failed, or the list cannot be written.
    pub(crate) fn finish(self) -> Result<(), Failure> {
        let outcome = self.outcome.into_inner().unwrap_or_else(PoisonError::into_inner);
        if let Some(provenance) = &outcome.provenance {
            outcome.manifest.write(&self.folder, provenance)?;
        }
        let Some(exit) = outcome.worst else { return Ok(()) };
        let mut frames = outcome.failed;
        frames.sort_unstable();
        let list: Vec<_> = frames.iter().take(10).map(i64::to_string).collect();
        let more = if frames.len() > list.len() { ", ..." } else { "" };
        Err(Failure::new(
            exit,
            format!("{} frames have no mesh: {}{more}", frames.len(), list.join(", ")),
            "the take holds them: when the reason above is gone, `fissure post` makes the meshes without simulating again",
        ))
    }
}

/// Removes the meshes that the manifest in `folder` lists, and the manifest; other files stay.
pub(crate) fn remove(folder: &Path) -> Result<(), Failure> {
    let path = folder.join("manifest.json");
    let Ok(text) = std::fs::read(&path) else { return Ok(()) };
    let manifest: serde_json::Value = serde_json::from_slice(&text).unwrap_or_default();
    let files = manifest["files"].as_array().into_iter().flatten().filter_map(|record| record["file"].as_str());
    // A manifest that was tampered with must not reach files elsewhere.
    let plain = |name: &&str| Path::new(name).file_name().is_some_and(|file| file == *name);
    for file in files.filter(plain).map(|name| folder.join(name)).chain([path.clone()]) {
        match std::fs::remove_file(&file) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                return Err(Failure::file("remove", &file, &error));
            }
            _ => {}
        }
    }
    Ok(())
}

impl From<PostError> for Failure {
    fn from(error: PostError) -> Self {
        let exit = match error {
            PostError::Option { .. } => Exit::Usage,
            PostError::Inconsistent { .. } => Exit::File,
            _ => Exit::Numerical,
        };
        Self { exit, message: error.to_string(), remedy: None, snippet: None }
    }
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        Self::new(
            Exit::File,
            error.to_string(),
            "free some space or fix the permissions, or choose another folder with --output",
        )
    }
}
