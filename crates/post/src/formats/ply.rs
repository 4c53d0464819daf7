//! Binary little-endian PLY.

use super::{FileFormat, FormatError, Shot};
use crate::mesh::{Content, Mesh};
use crate::packed::{Convention, PackedVertex, compact, pack};
use crate::provenance::Provenance;
use crate::slot::Slot;
use fissure_scene::Part;
use ply_rs_bw::ply::{
    Addable, DefaultElement, ElementDef, Encoding, Header, PropertyDef, PropertyType::List, PropertyType::Scalar,
    ScalarType,
};
use ply_rs_bw::writer::Writer;

/// Vertex properties of triangle meshes, all `float`, by the names that programs look for.
const MESH_PROPERTIES: [&str; 13] = ["x", "y", "z", "nx", "ny", "nz", "s", "t", "vx", "vy", "vz", "piece", "slot"];
/// Those of the second set of texture coordinates.
const METRES: [&str; 2] = ["s1", "t1"];
/// Vertex properties of points.
const POINT_PROPERTIES: [&str; 7] = ["x", "y", "z", "vx", "vy", "vz", "piece"];

/// The bytes of a PLY file with all `meshes`.
///
/// Piece number and slot (0 outside, 1 inside) are properties of the vertices, not of the faces: meshio 5.3.5 cannot
/// read binary files with face properties. Comments say where the file comes from.
///
/// # Errors
/// When the writer refuses, which for a buffer in memory means a mistake of ours.
fn bytes(meshes: &[Mesh], provenance: &Provenance, convention: Convention) -> Result<Vec<u8>, FormatError> {
    let points_only = !meshes.is_empty() && meshes.iter().all(|m| m.content == Content::Points);
    let metres = meshes.iter().any(|mesh| mesh.texture_size.is_some());
    let mut rows = Rows { points_only, metres, ..Rows::default() };
    meshes.iter().for_each(|mesh| rows.add(mesh, convention));
    let mut names = if points_only { POINT_PROPERTIES.to_vec() } else { MESH_PROPERTIES.to_vec() };
    names.extend(METRES.iter().filter(|_| rows.metres));
    let mut header = Header::new();
    header.encoding = Encoding::BinaryLittleEndian;
    header.comments = comments(provenance);
    let floats = names.iter().map(|name| PropertyDef::new((*name).to_owned(), Scalar(ScalarType::Float)));
    header.elements.add(element("vertex", rows.vertex_count, floats));
    if !points_only {
        let indices = PropertyDef::new("vertex_indices".to_owned(), List(ScalarType::UChar, ScalarType::Int));
        header.elements.add(element("face", rows.face_count, std::iter::once(indices)));
    }
    let mut written = Vec::with_capacity(1024 + rows.vertices.len() + rows.faces.len());
    Writer::<DefaultElement>::new().write_header(&mut written, &header)?;
    written.extend(rows.vertices);
    written.extend(rows.faces);
    Ok(written)
}

fn element(name: &str, count: usize, properties: impl Iterator<Item = PropertyDef>) -> ElementDef {
    let mut element = ElementDef::new(name.to_owned());
    element.count = count;
    properties.for_each(|property| element.properties.add(property));
    element
}

/// Binary PLY.
pub(crate) struct Polygons;

impl FileFormat for Polygons {
    fn extension(&self, _: Part) -> &'static str {
        "ply"
    }

    fn frame(&self, shot: &Shot<'_>) -> Result<Vec<u8>, FormatError> {
        bytes(shot.objects, shot.provenance, shot.played(shot.up))
    }

    /// The first comment of the header.
    #[cfg(feature = "files")]
    fn maker(&self, bytes: &[u8]) -> Option<String> {
        let mut lines = bytes.strip_prefix(b"ply\n")?.split(|&byte| byte == b'\n');
        let comment =
            lines.by_ref().take_while(|line| *line != b"end_header").find_map(|l| l.strip_prefix(b"comment "));
        Some(String::from_utf8_lossy(comment?).into_owned())
    }
}

/// One line each; a line break in a name would end the comment.
fn comments(provenance: &Provenance) -> Vec<String> {
    let Provenance { tool, scene, scene_hash, frame, time } = provenance;
    let lines = [tool.clone(), format!("scene {scene} {scene_hash}"), format!("frame {frame} time {time}")];
    lines.map(|line| line.replace(['\r', '\n'], " ")).to_vec()
}

/// The bytes of both elements.
#[derive(Default)]
struct Rows {
    /// Whether vertices have no normals, texture coordinates and slots.
    points_only: bool,
    /// Whether they have a second set of texture coordinates, in metres.
    metres: bool,
    vertices: Vec<u8>,
    vertex_count: usize,
    faces: Vec<u8>,
    face_count: usize,
}

impl Rows {
    /// Adds vertices and faces of `mesh`; the vertices of each slot are its own, so that each has one slot.
    fn add(&mut self, mesh: &Mesh, convention: Convention) {
        if mesh.content == Content::Points {
            mesh.vertices.iter().for_each(|vertex| self.vertex(&pack(vertex, convention), mesh, 0));
            return;
        }
        for slot in Slot::ALL {
            let first = self.vertex_count as u32;
            let (vertices, triangles) = compact(mesh, mesh.slot(slot), convention);
            vertices.iter().for_each(|vertex| self.vertex(vertex, mesh, slot as u8));
            for triangle in &triangles {
                self.faces.push(3);
                triangle.iter().for_each(|i| self.faces.extend((first + i).to_le_bytes()));
            }
            self.face_count += triangles.len();
        }
    }

    fn vertex(&mut self, vertex: &PackedVertex, mesh: &Mesh, slot: u8) {
        let mut floats = |values: &[f32]| values.iter().for_each(|value| self.vertices.extend(value.to_le_bytes()));
        floats(&vertex.position);
        if !self.points_only {
            floats(&vertex.normal);
            floats(&vertex.texture);
        }
        floats(&vertex.velocity);
        floats(&[mesh.piece as f32]);
        if !self.points_only {
            floats(&[f32::from(slot)]);
        }
        if self.metres {
            floats(&vertex.metres(mesh.texture_size.unwrap_or(1.0)));
        }
        self.vertex_count += 1;
    }
}
