//! Files of whole sequences, made frame by frame.

use crate::formats::{Sequence, file_format, sequence, sequence_name};
use crate::manifest::Manifest;
use crate::post::FrameMeshes;
use crate::record::SequenceRecord;
use crate::write::write;
use crate::write_error::WriteError;
use fissure_files::Folder;
use fissure_scene::{Format, Frame, Part, Scene};

/// The files in the making of all parts and of all formats that make one file of a whole sequence.
pub struct Sequences<'a> {
    scene: &'a Scene,
    files: Vec<InMaking>,
}

/// One of them.
struct InMaking {
    part: Part,
    format: Format,
    file: Box<dyn Sequence>,
    /// Numbers of the frames in it.
    frames: Vec<i64>,
}

impl<'a> Sequences<'a> {
    /// Files that hold no frames yet, of those of `formats` that make one file of a whole sequence.
    pub fn new(scene: &'a Scene, parts: &[Part], formats: &[Format]) -> Self {
        let of_part = |part: Part| {
            let shown = formats.iter().filter(move |format| format.shows(part));
            shown
                .filter_map(move |&format| Some(InMaking { part, format, file: sequence(format)?, frames: Vec::new() }))
        };
        Self { scene, files: parts.iter().copied().flat_map(of_part).collect() }
    }

    /// Whether there is nothing to make.
    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// Adds a frame; they come by rising number.
    ///
    /// # Errors
    /// When a format cannot hold it.
    pub fn add(&mut self, frame: &Frame, meshes: &FrameMeshes) -> Result<(), WriteError> {
        for shot in meshes.shots(self.scene, frame) {
            for file in self.files.iter_mut().filter(|file| file.part == shot.part) {
                let name = file.name(self.scene);
                file.file.add(&shot).map_err(|cause| WriteError::Format { file: name, cause })?;
                file.frames.push(frame.number);
            }
        }
        Ok(())
    }

    /// Writes the files into `folder`, whole or not at all, and lists them in `manifest`.
    ///
    /// # Errors
    /// At the first file that cannot be written.
    pub fn write(self, folder: &Folder, manifest: &mut Manifest) -> Result<(), WriteError> {
        for in_making in self.files {
            let (file, part, format) = (in_making.name(self.scene), in_making.part, in_making.format);
            let (Some(&first), Some(&last)) = (in_making.frames.first(), in_making.frames.last()) else { continue };
            let frames = in_making.frames.len();
            let cause = |cause| WriteError::Format { file: file.clone(), cause };
            write(folder, &file, format, &in_making.file.finish().map_err(cause)?)?;
            manifest.add_sequence(SequenceRecord { file, part, format, first, last, frames });
        }
        Ok(())
    }
}

impl InMaking {
    fn name(&self, scene: &Scene) -> String {
        format!("{}.{}", sequence_name(&scene.name, self.part), file_format(self.format).extension(self.part))
    }
}
