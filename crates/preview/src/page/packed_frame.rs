//! The meshes of a frame as the page holds them: a few bytes per vertex.
//!
//! All numbers are little-endian. A frame begins with the number of its objects, u32; then for each:
//!
//! ```text
//! u32   0 a fragment, 1 a collider
//! u32   its number
//! u32   length of its name in bytes, then these, and zeros to a multiple of 4
//! f32   low corner x, y, z of the box around it, then the steps x, y, z of its grid [m]
//! u32   vertices, triangles outside, triangles inside
//! u16   all x, all y, all z: steps from the low corner, each less the one before; zeros to a multiple of 4
//! i8    all x, all y, all z of the normals, in 127ths; zeros to a multiple of 4
//! u32   three vertices for each triangle, those outside first, each less the one before
//! ```
//! Differences wrap around. What neighbours in space are often neighbours in the list, so differences are small, and
//! deflate (RFC 1951) makes little of them.

use fissure_post::{FrameMeshes, Mesh, Slot};
use fissure_scene::{Frame, Part};
use flate2::Compression;
use flate2::write::DeflateEncoder;
use std::io::{self, Write};

/// Steps of the grid across an object: what 16 bits hold.
const STEPS: f64 = 65535.0;

/// A frame as the page holds it.
#[derive(Debug, Clone, PartialEq)]
pub struct PackedFrame {
    pub(crate) number: i64,
    pub(crate) time: f64,
    pub(crate) triangles: usize,
    /// Half the largest step of a fragment's grid: how far a vertex is from where it is [m].
    pub(crate) rounding: f64,
    /// Deflated.
    pub(crate) bytes: Vec<u8>,
}

impl PackedFrame {
    /// Packs the meshes of a frame, of the parts [`Part::Cracked`] and [`Part::Collider`].
    ///
    /// # Errors
    /// When there is no memory.
    pub fn new(frame: &Frame, meshes: &FrameMeshes) -> io::Result<Self> {
        let objects: Vec<(u32, &Mesh)> = meshes
            .parts
            .iter()
            .filter(|(part, _)| matches!(part, Part::Cracked | Part::Collider))
            .flat_map(|(part, meshes)| meshes.iter().map(|mesh| (u32::from(*part == Part::Collider), mesh)))
            .filter(|(_, mesh)| !mesh.vertices.is_empty())
            .collect();
        let (mut plain, mut rounding) = (Vec::new(), 0.0_f64);
        plain.extend((objects.len() as u32).to_le_bytes());
        for &(kind, mesh) in &objects {
            let step = object(&mut plain, kind, mesh);
            if kind == 0 {
                rounding = rounding.max(0.5 * step);
            }
        }
        let mut encoder = DeflateEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(&plain)?;
        let triangles = objects.iter().map(|(_, mesh)| mesh.triangle_count()).sum();
        Ok(Self { number: frame.number, time: frame.time, triangles, rounding, bytes: encoder.finish()? })
    }
}

/// Adds an object; gives the largest step of its grid [m].
fn object(bytes: &mut Vec<u8>, kind: u32, mesh: &Mesh) -> f64 {
    let name = mesh.name.as_bytes();
    words(bytes, [kind, mesh.piece, name.len() as u32]);
    bytes.extend(name);
    pad(bytes);
    let of_axis = |axis: usize| mesh.vertices.iter().map(move |vertex| vertex.position[axis]);
    let low = [0, 1, 2].map(|axis| of_axis(axis).fold(f64::INFINITY, f64::min));
    let steps = [0, 1, 2].map(|axis| (of_axis(axis).fold(f64::NEG_INFINITY, f64::max) - low[axis]) / STEPS);
    low.iter().chain(&steps).for_each(|&value| bytes.extend((value as f32).to_le_bytes()));
    let triangles = Slot::ALL.map(|slot| mesh.slot(slot).len() as u32);
    words(bytes, [mesh.vertices.len() as u32, triangles[0], triangles[1]]);
    for axis in 0..3 {
        let mut before = 0_u16;
        for value in of_axis(axis) {
            let at = if steps[axis] > 0.0 { ((value - low[axis]) / steps[axis]).round() as u16 } else { 0 };
            bytes.extend(at.wrapping_sub(before).to_le_bytes());
            before = at;
        }
    }
    pad(bytes);
    for axis in 0..3 {
        bytes.extend(mesh.vertices.iter().map(|vertex| ((127.0 * vertex.normal[axis]).round() as i8).cast_unsigned()));
    }
    pad(bytes);
    let mut before = 0_u32;
    for vertex in Slot::ALL.iter().flat_map(|&slot| mesh.slot(slot)).flatten() {
        bytes.extend(vertex.wrapping_sub(before).to_le_bytes());
        before = *vertex;
    }
    steps.into_iter().fold(0.0, f64::max)
}

fn words(bytes: &mut Vec<u8>, words: [u32; 3]) {
    words.iter().for_each(|word| bytes.extend(word.to_le_bytes()));
}

/// Zeros to a multiple of 4.
fn pad(bytes: &mut Vec<u8>) {
    bytes.resize(bytes.len().next_multiple_of(4), 0);
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use fissure_post::{Content, History, Vertex};
    use flate2::read::DeflateDecoder;
    use std::io::Read;

    /// A mesh far from the origin whose vertices and triangles jump about.
    fn mesh() -> Mesh {
        let vertex = |i: usize| {
            let part = |factor: f64| (i as f64 * factor).fract();
            let angle = std::f64::consts::TAU * part(0.37);
            Vertex {
                position: [100.0 + part(0.754_877), -3.0 * part(0.569_84), 0.05 * (-1.0_f64).powi(i as i32)],
                normal: [angle.cos(), angle.sin(), 0.0],
                texture: [0.0; 2],
                velocity: [0.0; 3],
                history: History::default(),
            }
        };
        let triangle = |i: u32| [(i * 7) % 50, (i * 13 + 1) % 50, (i * 29 + 2) % 50];
        Mesh {
            name: "plate_piece_0007".to_owned(),
            piece: 7,
            content: Content::Surface,
            texture_size: None,
            attributes: Vec::new(),
            vertices: (0..50).map(vertex).collect(),
            triangles: [(0..40).map(triangle).collect(), (40..60).map(triangle).collect()],
        }
    }

    /// Truth: the mesh that was packed, read by the layout in the module's documentation.
    #[test]
    fn a_mesh_comes_back_within_its_rounding() {
        let mesh = mesh();
        let mut plain = Vec::new();
        let step = object(&mut plain, 0, &mesh);
        let word = |at: usize| u32::from_le_bytes(plain[at..at + 4].try_into().unwrap());
        let real = |at: usize| f64::from(f32::from_bits(word(at)));
        assert_eq!((word(0), word(4), &plain[12..28]), (0, 7, "plate_piece_0007".as_bytes()));
        assert_eq!((word(52), word(56), word(60)), (50, 40, 20));
        for axis in 0..3 {
            let mut at = 0_u16;
            for (i, vertex) in mesh.vertices.iter().enumerate() {
                let place = 64 + 2 * (50 * axis + i);
                at = at.wrapping_add(u16::from_le_bytes([plain[place], plain[place + 1]]));
                let value = real(28 + 4 * axis) + real(40 + 4 * axis) * f64::from(at);
                // Single precision rounds the corner at 100 m by 4e-6 m.
                assert!((value - vertex.position[axis]).abs() < 0.51 * step + 4e-6, "{axis} {i}");
                let normal = f64::from(plain[64 + 300 + 50 * axis + i].cast_signed()) / 127.0;
                assert!((normal - vertex.normal[axis]).abs() < 0.5 / 127.0 + 1e-12);
            }
        }
        let mut before = 0_u32;
        let corners: Vec<u32> = (64 + 300 + 152..plain.len()).step_by(4).map(word).collect();
        let corners: Vec<u32> = corners
            .into_iter()
            .map(|step| {
                before = before.wrapping_add(step);
                before
            })
            .collect();
        assert_eq!(corners, mesh.all_triangles().flatten().collect::<Vec<_>>());
    }

    #[test]
    fn a_frame_inflates_to_its_objects() {
        let provenance = fissure_post::Provenance {
            tool: String::new(),
            scene: String::new(),
            scene_hash: String::new(),
            frame: 3,
            time: 0.5,
        };
        let parts =
            vec![(Part::Cracked, vec![mesh(), mesh()]), (Part::Faces, vec![mesh()]), (Part::Collider, vec![mesh()])];
        let meshes = FrameMeshes {
            provenance,
            up: fissure_scene::UpAxis::Z,
            thickness: 0.1,
            bevel: 0.0,
            roughness: 0.0,
            moves: std::collections::BTreeMap::new(),
            parts,
        };
        let packed = PackedFrame::new(&Frame { number: 3, time: 0.5, ..Frame::default() }, &meshes).unwrap();
        let mut plain = Vec::new();
        DeflateDecoder::new(packed.bytes.as_slice()).read_to_end(&mut plain).unwrap();
        assert_eq!((plain[0], packed.number, packed.triangles), (3, 3, 180));
        assert!(packed.rounding > 2e-5 && packed.rounding < 2.5e-5, "{}", packed.rounding);
        assert!(packed.bytes.len() < plain.len());
    }
}
