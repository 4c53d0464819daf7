//! Binary little-endian PLY.

use super::{FileFormat, FormatError, Shot};
use crate::mesh::{Content, Mesh};
use crate::packed::{Convention, PackedVertex, compact, pack};
use crate::provenance::Provenance;
use crate::slot::Slot;
use fissure_scene::Part;
use ply_rs_bw::ply::{
    Addable, ElementDef, Encoding, Ply, PropertyAccess, PropertyDef, PropertyType::List, PropertyType::Scalar,
    ScalarType,
};
use ply_rs_bw::writer::Writer;

/// Vertex properties of triangle meshes, all `float`, by the names that programs look for.
const MESH_PROPERTIES: [&str; 13] = ["x", "y", "z", "nx", "ny", "nz", "s", "t", "vx", "vy", "vz", "piece", "slot"];
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
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for mesh in meshes {
        add_rows(mesh, convention, &mut vertices, &mut faces);
    }

    let mut ply = Ply::<Row>::new();
    ply.header.encoding = Encoding::BinaryLittleEndian;
    ply.header.comments = comments(provenance);
    let mut vertex = ElementDef::new("vertex".to_owned());
    let names: &[&str] = if points_only { &POINT_PROPERTIES } else { &MESH_PROPERTIES };
    for name in names {
        vertex.properties.add(PropertyDef::new((*name).to_owned(), Scalar(ScalarType::Float)));
    }
    ply.header.elements.add(vertex);
    ply.payload.insert("vertex".to_owned(), vertices);
    if !points_only {
        let mut face = ElementDef::new("face".to_owned());
        let indices = PropertyDef::new("vertex_indices".to_owned(), List(ScalarType::UChar, ScalarType::Int));
        face.properties.add(indices);
        ply.header.elements.add(face);
        ply.payload.insert("face".to_owned(), faces);
    }
    let mut written = Vec::new();
    Writer::new().write_ply(&mut written, &mut ply)?;
    Ok(written)
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

/// Adds vertices and faces of `mesh`; the vertices of each slot are its own, so that each has one slot.
fn add_rows(mesh: &Mesh, convention: Convention, vertices: &mut Vec<Row>, faces: &mut Vec<Row>) {
    let piece = mesh.piece as f32;
    if mesh.content == Content::Points {
        vertices.extend(mesh.vertices.iter().map(|v| Row::Vertex { vertex: pack(v, convention), piece, slot: 0.0 }));
        return;
    }
    for slot in Slot::ALL {
        let first = vertices.len() as i32;
        let (of_slot, triangles) = compact(mesh, mesh.slot(slot), convention);
        let slot = f32::from(slot as u8);
        vertices.extend(of_slot.into_iter().map(|vertex| Row::Vertex { vertex, piece, slot }));
        faces.extend(triangles.iter().map(|t| Row::Face(t.map(|i| first + i as i32))));
    }
}

/// A row of either element.
enum Row {
    Vertex { vertex: PackedVertex, piece: f32, slot: f32 },
    Face([i32; 3]),
}

impl PropertyAccess for Row {
    fn new() -> Self {
        Self::Face([0; 3])
    }

    fn get_float(&self, name: &str) -> Option<f32> {
        let Self::Vertex { vertex, piece, slot } = self else { return None };
        Some(match name {
            "x" => vertex.position[0],
            "y" => vertex.position[1],
            "z" => vertex.position[2],
            "nx" => vertex.normal[0],
            "ny" => vertex.normal[1],
            "nz" => vertex.normal[2],
            "s" => vertex.texture[0],
            "t" => vertex.texture[1],
            "vx" => vertex.velocity[0],
            "vy" => vertex.velocity[1],
            "vz" => vertex.velocity[2],
            "piece" => *piece,
            "slot" => *slot,
            _ => return None,
        })
    }

    fn get_list_int(&self, name: &str) -> Option<&[i32]> {
        match self {
            Self::Face(indices) if name == "vertex_indices" => Some(indices),
            _ => None,
        }
    }
}
