//! Pictures of frames: drawn, written, and laid together.

use crate::args::PictureKind;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report::Report;
use crate::workers::contain;
use fissure_files::Folder;
use fissure_post::{PostOptions, post_frame};
use fissure_preview::{
    Animation, Detail, EncodeError, EncodedFrame, Kind, PackedFrame, Picture, PreviewOptions, Series, Survey,
    contact_sheet, draw_frame, is_ours, page, sheet_frames, tile_options,
};
use fissure_scene::{Frame, Part, Scene};
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// Draws frames; shared by all workers.
#[derive(Debug)]
pub(crate) struct Pictures<'a> {
    scene: &'a Scene,
    folder: &'a Folder,
    kinds: &'a [PictureKind],
    survey: &'a Survey,
    options: PreviewOptions,
    meshes: PostOptions,
    /// The frames of the contact sheet.
    on_sheet: Vec<i64>,
    report: &'a Report,
    outcome: Mutex<Outcome>,
}

/// What became of the frames so far.
#[derive(Debug, Default)]
struct Outcome {
    tiles: BTreeMap<i64, Picture>,
    animated: BTreeMap<i64, EncodedFrame>,
    packed: BTreeMap<i64, PackedFrame>,
    drawn: usize,
    failed: Vec<i64>,
    worst: Option<Exit>,
}

/// What is kept of a frame until all are there.
struct Kept {
    tile: Option<Picture>,
    animated: Option<EncodedFrame>,
    packed: Option<PackedFrame>,
}

impl<'a> Pictures<'a> {
    /// Pictures of the frames `numbers` of a scene that `survey` has seen.
    pub(crate) fn new(
        scene: &'a Scene,
        folder: &'a Folder,
        kinds: &'a [PictureKind],
        numbers: &[i64],
        survey: &'a Survey,
        options: PreviewOptions,
        report: &'a Report,
    ) -> Self {
        let parts = vec![Part::Cracked, Part::Collider];
        let meshes = PostOptions { parts, ..PostOptions::from(&scene.output) };
        let on_sheet = if kinds.contains(&PictureKind::Sheet) { sheet_frames(numbers) } else { Vec::new() };
        Self { scene, folder, kinds, survey, options, meshes, on_sheet, report, outcome: Mutex::default() }
    }

    /// That no file that will be written replaces one that Fissure has not made.
    ///
    /// # Errors
    /// Names the first that would.
    pub(crate) fn replace_nothing_foreign(&self, numbers: &[i64]) -> Result<(), Failure> {
        let mut files = Vec::new();
        for kind in self.kinds {
            match kind {
                PictureKind::Frames => {
                    files.extend(numbers.iter().map(|&number| (Kind::Png, frame_name(self.scene, number))))
                }
                PictureKind::Sheet => files.push((Kind::Png, sheet_name(self.scene))),
                PictureKind::Gif => files.push((Kind::Gif, animation_name(self.scene))),
                PictureKind::Page => files.push((Kind::Html, page_name(self.scene))),
            }
        }
        for (kind, name) in files {
            if self.folder.read(&name)?.is_some_and(|there| !is_ours(kind, &there)) {
                let message = format!("`{}` was not made by Fissure, and is kept", self.folder.place(&name)?.display());
                return Err(Failure::new(Exit::File, message, "move it away, or name another folder with `--output`"));
            }
        }
        Ok(())
    }

    /// Draws the frame that `get` gives. A failure is reported at once and remembered; the other frames go on.
    pub(crate) fn make(&self, number: i64, get: impl FnOnce() -> Result<Frame, Failure>) {
        let made = contain(|| self.draw(number, &get()?));
        let mut outcome = self.outcome.lock().unwrap_or_else(PoisonError::into_inner);
        match made {
            Ok(Kept { tile, animated, packed }) => {
                outcome.drawn += 1;
                outcome.tiles.extend(tile.map(|tile| (number, tile)));
                outcome.animated.extend(animated.map(|frame| (number, frame)));
                outcome.packed.extend(packed.map(|frame| (number, frame)));
            }
            Err(failure) => {
                outcome.failed.push(number);
                outcome.worst.get_or_insert(failure.exit);
                self.report.error(&failure.during(format!("no picture of frame {number}")));
            }
        }
    }

    fn draw(&self, number: i64, frame: &Frame) -> Result<Kept, Failure> {
        let meshes = post_frame(self.scene, frame, &self.meshes)?;
        let draw = |options: &PreviewOptions, detail| {
            draw_frame(self.scene, frame, &meshes, self.survey, options, detail).map_err(Failure::from)
        };
        let wanted = |kind| self.kinds.contains(&kind);
        let mut animated = None;
        if wanted(PictureKind::Frames) || wanted(PictureKind::Gif) {
            let picture = draw(&self.options, Detail::Full)?;
            if wanted(PictureKind::Frames) {
                // Pictures can be made again: nobody waits for the disk.
                self.folder.write_unsynced(&frame_name(self.scene, number), &picture.to_png(&self.scene.hash)?)?;
            }
            if wanted(PictureKind::Gif) {
                animated = Some(EncodedFrame::new(&picture)?);
            }
        }
        let tile = self
            .on_sheet
            .contains(&number)
            .then(|| draw(&tile_options(&self.options, self.on_sheet.len()), Detail::Tile));
        let packed = wanted(PictureKind::Page).then(|| PackedFrame::new(frame, &meshes)).transpose();
        let packed = packed.map_err(|error| Failure::of(Exit::File, error))?;
        Ok(Kept { tile: tile.transpose()?, animated, packed })
    }

    /// Writes what is made of several frames, and says what was written.
    ///
    /// # Errors
    /// When frames failed, or a file cannot be written.
    pub(crate) fn finish(self, series: &Series) -> Result<String, Failure> {
        let outcome = self.outcome.into_inner().unwrap_or_else(PoisonError::into_inner);
        let told: Vec<String> = self.kinds.iter().map(|kind| kind.told(outcome.drawn)).collect();
        if !outcome.tiles.is_empty() {
            let tiles: Vec<Picture> = outcome.tiles.into_values().collect();
            let sheet = contact_sheet(self.scene, &tiles, self.survey, &self.options)?;
            self.folder.write(&sheet_name(self.scene), &sheet.to_small_png(&self.scene.hash)?)?;
        }
        if !outcome.animated.is_empty() {
            let animation = Animation::new(outcome.animated.into_values().collect());
            self.folder.write(&animation_name(self.scene), &animation.to_gif(self.scene.frames.playback)?)?;
        }
        if !outcome.packed.is_empty() {
            let packed: Vec<PackedFrame> = outcome.packed.into_values().collect();
            let page = page(self.scene, &packed, series, self.options.theme)
                .map_err(|error| Failure::of(Exit::File, error))?;
            if page.shown < page.of {
                self.report.note(&format!(
                    "the page shows {} of {} frames, so that it does not become too large for a browser; `--frames` says which to choose from",
                    page.shown, page.of
                ));
            }
            self.folder.write(&page_name(self.scene), page.html.as_bytes())?;
        }
        self.folder.sync()?;
        let Some(exit) = outcome.worst else { return Ok(told.join(", ")) };
        let mut frames = outcome.failed;
        frames.sort_unstable();
        let list: Vec<_> = frames.iter().take(10).map(i64::to_string).collect();
        let more = if frames.len() > list.len() { ", ..." } else { "" };
        let message = format!("{} frames have no picture: {}{more}", frames.len(), list.join(", "));
        Err(Failure::new(exit, message, "see the reasons above; `--frames` leaves frames out"))
    }
}

/// Removes pictures of a run of `scene` that lie in `folder` and that say themselves that Fissure made them. All other
/// files stay.
///
/// # Errors
/// When the folder cannot be read, or a file cannot be removed.
pub(crate) fn remove_pictures(folder: &Folder, scene: &Scene) -> Result<(), Failure> {
    let kind = |name: &str| {
        let number = name.strip_prefix(&format!("{}.", scene.name)).and_then(|rest| rest.strip_suffix(".png"));
        let is_frame = number.is_some_and(|number| number.parse().is_ok_and(|n| frame_name(scene, n) == name));
        match name {
            _ if is_frame || name == sheet_name(scene) => Some(Kind::Png),
            _ if name == animation_name(scene) => Some(Kind::Gif),
            _ if name == page_name(scene) => Some(Kind::Html),
            _ => None,
        }
    };
    for name in folder.names()? {
        if let Some(kind) = kind(&name)
            && folder.read(&name)?.is_some_and(|there| is_ours(kind, &there))
        {
            folder.remove(&name)?;
        }
    }
    Ok(())
}

fn frame_name(scene: &Scene, number: i64) -> String {
    format!("{}.{number:04}.png", scene.name)
}

fn sheet_name(scene: &Scene) -> String {
    format!("{}_sheet.png", scene.name)
}

fn animation_name(scene: &Scene) -> String {
    format!("{}.gif", scene.name)
}

fn page_name(scene: &Scene) -> String {
    format!("{}.html", scene.name)
}

impl From<EncodeError> for Failure {
    fn from(error: EncodeError) -> Self {
        match error {
            EncodeError::TooLarge { .. } => Self::new(Exit::Usage, error.to_string(), "lower `--size`"),
            _ => Self::of(Exit::File, error),
        }
    }
}
