//! Meshes of frames: made, written and listed.

use crate::args::MeshArguments;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::report::Report;
use crate::workers::contain;
use fissure_files::Folder;
use fissure_post::{
    Manifest, PostError, PostOptions, Provenance, Sequences, WriteError, post_frame, write_companions, write_frame,
};
use fissure_scene::{Format, Frame, Scene, SceneFault, Take};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// That each format shows something of the parts, in what is meant to be written, and that the take has the particles
/// for it.
///
/// # Errors
/// Names the format that does not, or what lacks particles.
pub(crate) fn must_show(scene: &Scene, typed: &MeshArguments) -> Result<(), Failure> {
    let mut output = scene.output.clone();
    output.formats = formats(scene, typed).to_vec();
    if !typed.parts.is_empty() {
        output.parts.clone_from(&typed.parts);
    }
    if let Some(cut) = typed.cut {
        output.surfaces.cut = cut;
    }
    let lacking = |fault: SceneFault| Failure::new(Exit::Usage, fault.message, fault.remedy);
    scene.take.particles.must_do_for(&output).map_err(lacking)?;
    let parts = &output.parts;
    let is_empty = |format: &&Format| !parts.iter().any(|&part| format.shows(part));
    let Some(format) = formats(scene, typed).iter().find(is_empty) else { return Ok(()) };
    let message = format!("the format `{}` shows none of the parts that are asked for", format.name());
    Err(Failure::new(Exit::Usage, message, "add the part `cracked`, or leave the format out"))
}

/// The formats as typed, or else as in the scene.
fn formats<'a>(scene: &'a Scene, typed: &'a MeshArguments) -> &'a [Format] {
    if typed.formats.is_empty() { &scene.output.formats } else { &typed.formats }
}

/// Makes the meshes of frames; shared by all workers.
#[derive(Debug)]
pub(crate) struct Mesher<'a> {
    scene: &'a Scene,
    folder: Folder,
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
    ///
    /// # Errors
    /// When the folder holds a list of meshes that Fissure has not made.
    pub(crate) fn new(
        scene: &'a Scene,
        folder: &Folder,
        typed: &MeshArguments,
        report: &'a Report,
    ) -> Result<Self, Failure> {
        let mut options = PostOptions::from(&scene.output);
        if let Some(thickness) = typed.thickness {
            options.thickness = thickness;
        }
        if let Some(up) = typed.up {
            options.up = up;
        }
        if let Some(cut) = typed.cut {
            options.cut = cut;
        }
        if !typed.parts.is_empty() {
            options.parts.clone_from(&typed.parts);
        }
        let manifest = Manifest::read(folder, &scene.name, &scene.hash)?;
        let outcome = Mutex::new(Outcome { manifest, ..Outcome::default() });
        Ok(Self { scene, folder: folder.clone(), options, formats: formats(scene, typed).to_vec(), report, outcome })
    }

    /// Makes and writes the meshes of the frame that `get` gives. A failure is reported at once and remembered; the
    /// other frames go on.
    pub(crate) fn make(&self, number: i64, get: impl FnOnce() -> Result<Frame, Failure>) {
        let made = contain(|| {
            let frame = get()?;
            let meshes = post_frame(self.scene, &frame, &self.options)?;
            let records = write_frame(&self.folder, self.scene, &frame, &meshes, &self.formats)?;
            Ok((records, meshes.provenance))
        });
        let mut outcome = self.outcome();
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

    /// Makes the files of the whole sequence: of the frames `numbers` of `take`, which rise. Nothing is written when
    /// the user asks to stop or a frame fails: a file of an earlier run stays as it is until the new one is whole.
    pub(crate) fn make_sequences(&self, take: &Take, numbers: &[i64], interrupt: &Interrupt) {
        let mut sequences = Sequences::new(self.scene, &self.options.parts, &self.formats);
        if sequences.is_empty() {
            return;
        }
        let made = contain(|| {
            for &number in numbers {
                if interrupt.is_set() {
                    return Ok(());
                }
                let frame = take.frame(number)?;
                let meshes = post_frame(self.scene, &frame, &self.options)?;
                sequences.add(&frame, &meshes)?;
                self.outcome().provenance = Some(meshes.provenance);
            }
            Ok(sequences.write(&self.folder, &mut self.outcome().manifest)?)
        });
        if let Err(failure) = made {
            self.outcome().worst.get_or_insert(failure.exit);
            self.report.error(&failure.during("no file of the whole sequence".to_owned()));
        }
    }

    fn outcome(&self) -> MutexGuard<'_, Outcome> {
        self.outcome.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes the list of all meshes.
    ///
    /// # Errors
    /// When frames failed, or the list cannot be written.
    pub(crate) fn finish(self) -> Result<(), Failure> {
        let mut outcome = self.outcome.into_inner().unwrap_or_else(PoisonError::into_inner);
        if let Some(provenance) = &outcome.provenance {
            write_companions(&self.folder, self.scene, &provenance.tool, &mut outcome.manifest)?;
            outcome.manifest.write(&self.folder, provenance)?;
        }
        let Some(exit) = outcome.worst else { return Ok(()) };
        let mut frames = outcome.failed;
        if frames.is_empty() {
            let remedy = "the files of its frames are there: when the reason above is gone, run `fissure post`";
            return Err(Failure::new(exit, "the file of the whole sequence is missing", remedy));
        }
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

impl From<PostError> for Failure {
    fn from(error: PostError) -> Self {
        let exit = match error {
            PostError::Option { .. } => Exit::Usage,
            PostError::Inconsistent { .. } => Exit::File,
            _ => Exit::Numerical,
        };
        Self::of(exit, error)
    }
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        Self::new(Exit::File, error.to_string(), error.remedy())
    }
}
