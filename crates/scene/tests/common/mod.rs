//! Scenes in folders of their own.
#![allow(dead_code, unreachable_pub, clippy::unwrap_used)]

pub mod take;

use fissure_scene::{Region, Scene, ToughnessKind, ToughnessPatch, load};
use png::{BitDepth, ColorType};
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::TempDir;

/// A folder with a scene and, if given, a drawing beside it.
pub struct Folder(TempDir);

impl Folder {
    pub fn new(scene: &str, drawing: Option<&str>) -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        std::fs::write(folder.path(), scene).unwrap();
        if let Some(svg) = drawing {
            std::fs::write(folder.0.path().join("drawing.svg"), svg).unwrap();
        }
        folder
    }
    pub fn path(&self) -> PathBuf {
        self.file("scene.toml")
    }
    pub fn file(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
}

pub fn scene_with(text: &str, drawing: Option<&str>, set: &[&str]) -> Result<Scene, fissure_scene::LoadError> {
    let folder = Folder::new(text, drawing);
    load(&folder.path(), &set.iter().map(|s| s.to_string()).collect::<Vec<_>>())
}

pub const PLATE: &str =
    "[[body]]\nname = 'plate'\nmaterial = 'pmma'\nshape = { rectangle = { min = [-10, -10], max = [10, 10] } }\n";

/// Writes a PNG of so many `columns` from samples as its file holds them; of as many rows as they fill.
pub fn paint(path: &Path, color: ColorType, depth: BitDepth, columns: usize, samples: &[u8]) {
    let bytes_per_row = (columns * color.samples() * depth as usize).div_ceil(8);
    let rows = samples.len() / bytes_per_row;
    let mut encoder = png::Encoder::new(std::fs::File::create(path).unwrap(), columns as u32, rows as u32);
    encoder.set_color(color);
    encoder.set_depth(depth);
    encoder.write_header().unwrap().write_image_data(samples).unwrap();
}

/// The regions of the element `b` of the drawing `svg`, which is 100 m wide, at a particle spacing of 1 m.
///
/// They are those of a tougher place in a large plate, which may have parts of any size.
pub fn regions_of(svg: &str) -> Vec<Region> {
    let text = "[drawing]\nfile = 'drawing.svg'\nwidth = 100\n[grid]\nparticle_spacing = 1\n\
                [[body]]\nname = 'plate'\nmaterial = 'pmma'\nshape = { rectangle = { min = [-200, -200], max = [200, 200] } }\n\
                [[toughness]]\nshape = { svg = 'b' }\nfactor = 2\n";
    let patches = scene_with(text, Some(svg), &[]).unwrap().toughness;
    let region = |patch: ToughnessPatch| match patch.kind {
        ToughnessKind::Region { region, .. } => Some(region),
        ToughnessKind::Image(_) => None,
    };
    patches.into_iter().filter_map(region).collect()
}

/// How long the processor has worked for this thread: unlike the time of the clock it does not grow with what else the
/// machine does.
pub fn work() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec.unsigned_abs(), time.tv_nsec.unsigned_abs() as u32)
}
