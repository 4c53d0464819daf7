//! Binary little-endian PLY.

use super::{FileFormat, FormatError, Shot, has};
use crate::mesh::{Content, Mesh};
use crate::packed::{Convention, PackedVertex, compact, pack};
use crate::provenance::Provenance;
use crate::slot::Slot;
use fissure_scene::{Attribute, Part};
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
    let groups: Vec<Group<'_>> = meshes.iter().flat_map(|mesh| groups(mesh, convention)).collect();
    let vertices = groups.iter().map(|group| group.vertices.len()).sum();
    let faces = groups.iter().map(|group| group.triangles.len()).sum();
    let mut names = if points_only { POINT_PROPERTIES.to_vec() } else { MESH_PROPERTIES.to_vec() };
    names.extend(METRES.iter().filter(|_| metres));
    let attributes: Vec<Attribute> = Attribute::ALL.into_iter().filter(|a| has(meshes, *a)).collect();
    names.extend(attributes.iter().map(|attribute| attribute.name()));
    let mut header = Header::new();
    header.encoding = Encoding::BinaryLittleEndian;
    header.comments = comments(provenance);
    let floats = names.iter().map(|name| PropertyDef::new((*name).to_owned(), Scalar(ScalarType::Float)));
    header.elements.add(element("vertex", vertices, floats));
    if !points_only {
        let indices = PropertyDef::new("vertex_indices".to_owned(), List(ScalarType::UChar, ScalarType::Int));
        header.elements.add(element("face", faces, std::iter::once(indices)));
    }
    let mut written = Vec::with_capacity(1024 + 4 * names.len() * vertices + FACE * faces);
    Writer::<DefaultElement>::new().write_header(&mut written, &header)?;
    groups.iter().for_each(|group| group.add_vertices(points_only, metres, &attributes, &mut written));
    let mut first = 0;
    for group in &groups {
        group.add_faces(first, &mut written);
        first += group.vertices.len() as u32;
    }
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

/// Bytes of a triangle: its number of corners, and these.
const FACE: usize = 13;

/// The vertices and triangles of one slot of a mesh: vertices belong to one slot only.
struct Group<'a> {
    mesh: &'a Mesh,
    slot: Slot,
    vertices: Vec<PackedVertex>,
    triangles: Vec<[u32; 3]>,
}

/// Those of a mesh; points have no triangles.
fn groups(mesh: &Mesh, convention: Convention) -> Vec<Group<'_>> {
    if mesh.content == Content::Points {
        let vertices = mesh.vertices.iter().map(|vertex| pack(vertex, convention)).collect();
        return vec![Group { mesh, slot: Slot::Outside, vertices, triangles: Vec::new() }];
    }
    let group = |slot| {
        let (vertices, triangles) = compact(mesh, mesh.slot(slot), convention);
        Group { mesh, slot, vertices, triangles }
    };
    Slot::ALL.map(group).into()
}

impl Group<'_> {
    /// Adds the bytes of the vertices: without normals, texture coordinates and slots where there are `points_only`,
    /// with a second set of texture coordinates in `metres`, and `attributes`.
    fn add_vertices(&self, points_only: bool, metres: bool, attributes: &[Attribute], written: &mut Vec<u8>) {
        let (piece, slot) = (self.mesh.piece as f32, f32::from(self.slot as u8));
        let mut floats =
            |values: &[f32]| values.iter().for_each(|value| written.extend_from_slice(&value.to_le_bytes()));
        for vertex in &self.vertices {
            floats(&vertex.position);
            if !points_only {
                floats(&vertex.normal);
                floats(&vertex.texture);
            }
            floats(&vertex.velocity);
            floats(&[piece]);
            if !points_only {
                floats(&[slot]);
            }
            if metres {
                floats(&vertex.metres(self.mesh.texture_size.unwrap_or(1.0)));
            }
            attributes.iter().for_each(|attribute| floats(&[vertex.history.number(*attribute)]));
        }
    }

    /// Adds the bytes of the triangles; `first` is the number of the first vertex.
    fn add_faces(&self, first: u32, written: &mut Vec<u8>) {
        for triangle in &self.triangles {
            written.push(3);
            triangle.iter().for_each(|i| written.extend_from_slice(&(first + i).to_le_bytes()));
        }
    }
}
