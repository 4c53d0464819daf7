//! Reading a take, also while it is being written.

use super::list::{self, FrameEntry};
use super::remark::Remark;
use super::tables::TABLES;
use super::{Manifest, ParticlesAtRest, TakeError, frame_file, state};
use crate::frame::Frame;
use crate::scene::Scene;
use fissure_files::Folder;
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// A take on disk, as it was when it was opened.
#[derive(Debug, Clone)]
pub struct Take {
    folder: Folder,
    manifest: Manifest,
    entries: Vec<FrameEntry>,
    /// What particles are at rest, once it has been read.
    at_rest: Arc<OnceLock<Option<ParticlesAtRest>>>,
}

impl Take {
    /// Opens the take in a folder of this machine.
    ///
    /// # Errors
    /// When there is none, it is of another version, or its manifest or its list of frames is damaged.
    pub fn open(folder: &Path) -> Result<Self, TakeError> {
        Self::read(&Folder::new(folder))
    }

    /// Opens the take in `folder`.
    ///
    /// # Errors
    /// As [`Take::open`].
    pub fn read(folder: &Folder) -> Result<Self, TakeError> {
        let manifest = Manifest::read(folder)?;
        let entries = list::read(folder, manifest.scene.frames.first)?.entries;
        Ok(Self { folder: folder.clone(), manifest, entries, at_rest: Arc::default() })
    }

    /// The scene it was made from.
    pub fn scene(&self) -> &Scene {
        &self.manifest.scene
    }

    /// What it is.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// Whether it says how cracks formed: takes of older versions do not.
    pub fn tells_how_cracks_formed(&self) -> bool {
        self.manifest.version >= Manifest::HISTORY
    }

    /// The frames there are, by rising number.
    pub fn frames(&self) -> &[FrameEntry] {
        &self.entries
    }

    /// Whether all frames of the scene are there.
    pub fn is_complete(&self) -> bool {
        self.entries.last().is_some_and(|last| last.number >= self.scene().frames.last)
    }

    /// Numbers of the frames there are, rising.
    pub fn frame_numbers(&self) -> Vec<i64> {
        self.entries.iter().map(|entry| entry.number).collect()
    }

    /// One frame, bit for bit as it was written.
    ///
    /// # Errors
    /// When there is no such frame, or its file is missing, cut off or changed.
    pub fn frame(&self, number: i64) -> Result<Frame, TakeError> {
        match self.entries.binary_search_by_key(&number, |entry| entry.number) {
            Ok(at) => frame_file::read(&self.folder, &self.entries[at], self.at_rest()?),
            Err(_) => {
                let have = list::in_words(&self.entries);
                Err(TakeError::NoFrame { path: self.folder.path().into(), number, have })
            }
        }
    }

    /// What the particles of all frames are at rest; none where each frame says so itself.
    fn at_rest(&self) -> Result<Option<&ParticlesAtRest>, TakeError> {
        if let Some(known) = self.at_rest.get() {
            return Ok(known.as_ref());
        }
        let read = frame_file::read_at_rest(&self.folder, &self.entries)?;
        Ok(self.at_rest.get_or_init(|| read).as_ref())
    }

    /// What is wrong with the files that no frame needs: the tables and the saved state.
    ///
    /// # Errors
    /// When one cannot be read at all.
    pub fn remarks(&self) -> Result<Vec<Remark>, TakeError> {
        let mut remarks = Vec::new();
        for table in TABLES {
            let text = self.folder.read(table.name)?.unwrap_or_default();
            if table.sound_length(&text, &self.entries).is_none() {
                remarks.push(Remark::DamagedTable(table.name));
            }
        }
        match state::read(&self.folder) {
            Err(error @ TakeError::DamagedState { .. }) => remarks.push(Remark::UnusableState(error.to_string())),
            other => drop(other?),
        }
        Ok(remarks)
    }
}

#[cfg(all(test, feature = "load"))]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::list::FileEntry;
    use super::super::sealed::PAGE;
    use super::super::{Provenance, TakeWriter, frame_to_bytes};
    use super::*;
    use crate::frame::ParticleFrame;
    use crate::take_settings::Precision;
    use fissure_plane::{Matrix, Point, Vector};

    /// Truth: version 3 as it was: every frame says itself what its particles are at rest, and there is no file of it.
    #[test]
    fn takes_of_the_version_before_are_read_but_not_gone_on_with() {
        let place = tempfile::tempdir().unwrap();
        let scene_file = place.path().join("scene.toml");
        std::fs::write(&scene_file, crate::template()).unwrap();
        let scene = crate::load(&scene_file, &[]).unwrap();
        let folder = Folder::new(place.path().join("old.take"));
        let particles = ParticleFrame {
            id: vec![0],
            body: vec![0],
            piece: vec![2],
            rest: vec![Point::new(1.0, 2.0)],
            mass: None,
            position: vec![Point::new(1.5, 2.0)],
            velocity: vec![Vector::zeros()],
            deformation_gradient: vec![Matrix::identity()],
            cauchy_stress: vec![Matrix::zeros()],
        };
        let frame = Frame { number: 1, particles, ..Frame::default() };
        let provenance = Provenance { tool_version: "0.1.0".into(), seed: 0 };
        TakeWriter::replace(&folder, &scene, provenance.clone()).unwrap().write_frame(&frame, None).unwrap();

        let bytes = frame_to_bytes(&frame, Precision::Double, None).unwrap();
        folder.write("frame.0001.safetensors", &bytes).unwrap();
        folder.remove("particles.safetensors").unwrap();
        let mut entry = list::read(&folder, 1).unwrap().entries.remove(0);
        entry.files = vec![FileEntry::new("frame.0001.safetensors", &bytes)];
        list::write(&folder, &[entry]).unwrap();
        let manifest = Manifest { version: 3, ..Manifest::new(&scene, provenance.clone()) };
        let text = serde_json::to_string_pretty(&manifest).unwrap();
        folder.write("manifest.json", PAGE.seal(&text).as_bytes()).unwrap();

        assert_eq!(Take::read(&folder).unwrap().frame(1).unwrap(), frame);
        let error = TakeWriter::open(&folder, &scene, provenance, 9).unwrap_err();
        assert!(matches!(error, TakeError::Version { found: 3, .. }), "{error}");
        assert!(error.to_string().contains("version 3") && error.remedy().contains("--overwrite"), "{error}");
    }
}
