//! Writes sample frames as GLB and PLY with their manifest, for checks with other programs:
//! `cargo run -p fissure-post --example sample_files -- FOLDER`.

#[path = "../tests/common/mod.rs"]
mod common;

use common::{Opened, frame, halves, options, scene, square};
use fissure_files::Folder;
use fissure_post::{Manifest, post_frame, write_frame};
use fissure_scene::{CrackEnd, Format, Frame, Part, Point, Region, Scene, Vector};
use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = Folder::new(PathBuf::from(std::env::args_os().nth(1).ok_or("usage: sample_files FOLDER")?));
    folder.make()?;
    let mut manifest = Manifest::default();
    let mut provenance = None;
    for (i, (scene, mut frame)) in samples().into_iter().enumerate() {
        frame.number = 1 + i as i64;
        let mut options = options(&scene);
        options.parts = vec![Part::Cracked, Part::Body, Part::Faces, Part::Collider, Part::Particles];
        let meshes = post_frame(&scene, &frame, &options)?;
        manifest.add(write_frame(&folder, &scene, &frame, &meshes, &[Format::Glb, Format::Ply])?);
        provenance = Some(meshes.provenance);
    }
    if let Some(provenance) = provenance {
        manifest.write(&folder, &provenance)?;
    }
    Ok(())
}

fn samples() -> Vec<(Scene, Frame)> {
    let mut samples = Vec::new();
    // Whole; edge crack closed and open; in the sizes of a chip, a plate and a quarry.
    for size in [1e-3, 20.0, 1e4] {
        let region = square(size);
        for opening in [None, Some(0.0), Some(-1e-6), Some(1e-7), Some(1e-2)] {
            let cracks: Vec<Opened> = opening.into_iter().map(|o| edge_crack(size, o * size)).collect();
            samples.push((scene(region.clone()), frame(&region, 4, &cracks)));
        }
    }
    samples.push(halves(20.0, [(0.0, Vector::zeros()), (0.3, Vector::new(3.0, 0.5))]));
    // Two lenses that touch in a point.
    let region = square(20.0);
    let lens = |y: f64, down: f64, up: f64| Opened {
        rest: (0..=2).map(|i| Point::new(6.0 + 4.0 * f64::from(i), y)).collect(),
        above: vec![Vector::zeros(), Vector::new(0.0, up), Vector::zeros()],
        below: vec![Vector::zeros(), Vector::new(0.0, -down), Vector::zeros()],
        start: CrackEnd::Tip,
        end: CrackEnd::Tip,
    };
    samples.push((scene(region.clone()), frame(&region, 4, &[lens(9.0, 0.5, 1.0), lens(11.0, 1.0, 0.5)])));
    // A ring, cracked.
    let circle = |radius: f64, sense: f64| -> Vec<Point> {
        let corner = |i: usize| {
            let (sin, cos) = (sense * std::f64::consts::TAU * i as f64 / 96.0).sin_cos();
            Point::new(radius * cos, radius * sin)
        };
        (0..96).map(corner).collect()
    };
    let region = Region { exterior: circle(3.0, 1.0), holes: vec![circle(1.0, -1.0)] };
    let rest = (0..=6).map(|i| Point::new(1.2 + 0.25 * f64::from(i), 0.1 * f64::from(i % 2))).collect();
    let crack = Opened::symmetric(rest, &[0.0, 0.02, 0.05, 0.06, 0.05, 0.02, 0.0], CrackEnd::Tip, CrackEnd::Tip);
    samples.push((scene(region.clone()), frame(&region, 1, &[crack])));
    samples
}

fn edge_crack(size: f64, opening: f64) -> Opened {
    let rest =
        (0..=8).map(|i| Point::new(0.08 * size * f64::from(i), size * (0.5 + 0.01 * f64::from(i % 3)))).collect();
    let profile: Vec<f64> = (0..=8).map(|i| opening * (1.0 - 0.125 * f64::from(i)).sqrt()).collect();
    Opened::symmetric(rest, &profile, CrackEnd::Mouth, CrackEnd::Tip)
}
