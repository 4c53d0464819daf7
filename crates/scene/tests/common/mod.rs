//! Scenes in folders of their own.
#![allow(dead_code, unreachable_pub, clippy::unwrap_used)]

use fissure_scene::{Scene, load};
use png::{BitDepth, ColorType};
use std::path::{Path, PathBuf};
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
