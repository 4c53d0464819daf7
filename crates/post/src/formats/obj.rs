//! Wavefront OBJ, and the materials that all frames share.

use super::numbers::join;
#[cfg(feature = "files")]
use super::palette::color_and_roughness;
use super::{FileFormat, FormatError, Shot, origin_line, sequence_name};
use crate::mesh::{Content, Mesh};
use crate::packed::{Convention, compact, pack};
use crate::slot::Slot;
use fissure_scene::{Part, UpAxis};
use std::fmt::Write;

/// Wavefront OBJ: y up, as its importers take it; one object per mesh, one material per slot.
pub(crate) struct WavefrontObj;

/// The format knows no velocities.
const CONVENTION: Convention = Convention { up: UpAxis::Y, time_scale: 1.0 };

impl FileFormat for WavefrontObj {
    fn extension(&self, _: Part) -> &'static str {
        "obj"
    }

    fn frame(&self, shot: &Shot<'_>) -> Result<Vec<u8>, FormatError> {
        let library = sequence_name(&shot.scene.name, shot.part);
        let mut text = format!("# {}\nmtllib {library}.mtl\n", origin_line(shot.provenance));
        let mut count = Count::default();
        for mesh in shot.objects {
            let _ = writeln!(text, "o {}", mesh.name);
            if mesh.content == Content::Points {
                points(&mut text, mesh, &mut count);
            } else {
                Slot::ALL.into_iter().for_each(|slot| triangles(&mut text, mesh, slot, &mut count));
            }
        }
        Ok(text.into_bytes())
    }

    /// The materials.
    #[cfg(feature = "files")]
    fn companions(&self, listing: &super::Listing<'_>) -> Vec<(String, Vec<u8>)> {
        let mut text = format!("# {}\n", listing.tool);
        for slot in Slot::ALL {
            let ([r, g, b], roughness) = color_and_roughness(slot);
            // `Pr`, the roughness, is read by programs that know physically based materials; others take `Ns`, of
            // which 2/r⁴ − 2 looks as rough (Walter et al. 2007, with the roughness squared as glTF has it).
            let exponent = 2.0 / roughness.powi(4) - 2.0;
            let _ = writeln!(text, "newmtl {}\nKd {r} {g} {b}\nKs 0.04 0.04 0.04", slot.name());
            let _ = writeln!(text, "Ns {exponent:.1}\nPr {roughness}\nillum 2");
        }
        vec![(format!("{}.mtl", listing.name), text.into_bytes())]
    }

    /// The comment in the first line.
    #[cfg(feature = "files")]
    fn maker(&self, bytes: &[u8]) -> Option<String> {
        bytes.starts_with(b"# ").then(|| super::after_mark(bytes, "# ")).flatten()
    }
}

/// How many vertices are in the file so far: they are counted from 1 through the whole of it.
#[derive(Default)]
struct Count {
    /// Positions.
    positions: u32,
    /// Texture coordinates, and normals.
    corners: u32,
}

fn points(text: &mut String, mesh: &Mesh, count: &mut Count) {
    for vertex in &mesh.vertices {
        row(text, "v", pack(vertex, CONVENTION).position);
    }
    for _ in &mesh.vertices {
        count.positions += 1;
        let _ = writeln!(text, "p {}", count.positions);
    }
}

fn triangles(text: &mut String, mesh: &Mesh, slot: Slot, count: &mut Count) {
    let (vertices, triangles) = compact(mesh, mesh.slot(slot), CONVENTION);
    if triangles.is_empty() {
        return;
    }
    for vertex in &vertices {
        row(text, "v", vertex.position);
    }
    for vertex in &vertices {
        row(text, "vt", vertex.texture);
    }
    for vertex in &vertices {
        row(text, "vn", vertex.normal);
    }
    let _ = writeln!(text, "usemtl {}", slot.name());
    for triangle in triangles {
        let corner = |i: u32| {
            let (position, corner) = (count.positions + i + 1, count.corners + i + 1);
            format!("{position}/{corner}/{corner}")
        };
        row(text, "f", triangle.map(corner));
    }
    count.positions += vertices.len() as u32;
    count.corners += vertices.len() as u32;
}

fn row<T: std::fmt::Display>(text: &mut String, keyword: &str, values: impl IntoIterator<Item = T>) {
    text.push_str(keyword);
    text.push(' ');
    join(text, values, " ");
    text.push('\n');
}
