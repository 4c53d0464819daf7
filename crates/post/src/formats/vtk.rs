//! VTK's XML files: `.vtp` for surfaces, `.vtu` for particles, `.pvd` for the list of them with their times.
//!
//! Arrays are appended as they are (`encoding="raw"`), each behind its length: exact, and nothing to decode.

use super::numbers::xml_comment;
use super::{FileFormat, FormatError, Shot, has, origin_line};
use crate::mesh::Mesh;
use crate::packed::{Convention, compact};
use crate::slot::Slot;
use fissure_scene::{Attribute, Matrix, Part, Point, UpAxis, Vector};
use std::fmt::Write;

/// VTK's XML files.
pub(crate) struct VtkXml;

/// As engineers expect: as it is drawn, velocities per second of simulated time.
const CONVENTION: Convention = Convention { up: UpAxis::Y, time_scale: 1.0 };

impl FileFormat for VtkXml {
    fn extension(&self, part: Part) -> &'static str {
        if part == Part::Particles { "vtu" } else { "vtp" }
    }

    fn frame(&self, shot: &Shot<'_>) -> Result<Vec<u8>, FormatError> {
        Ok(if shot.part == Part::Particles { particles(shot) } else { surfaces(shot) })
    }

    /// The list.
    #[cfg(feature = "files")]
    fn companions(&self, listing: &super::Listing<'_>) -> Vec<(String, Vec<u8>)> {
        let mut text = format!("<?xml version=\"1.0\"?>\n{}\n", xml_comment(listing.tool));
        text.push_str("<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n");
        for record in listing.records {
            let (time, file) = (record.time, super::numbers::xml(&record.file));
            let _ = writeln!(text, "<DataSet timestep=\"{time}\" part=\"0\" file=\"{file}\"/>");
        }
        text.push_str("</Collection>\n</VTKFile>\n");
        vec![(format!("{}.pvd", listing.name), text.into_bytes())]
    }

    /// The comment in the second line.
    #[cfg(feature = "files")]
    fn maker(&self, bytes: &[u8]) -> Option<String> {
        bytes.starts_with(b"<?xml version=\"1.0\"?>\n<!-- ").then(|| super::after_mark(bytes, "<!-- ")).flatten()
    }
}

/// A file in the making: its XML, and the arrays behind it.
struct Document {
    text: String,
    data: Vec<u8>,
}

impl Document {
    fn new(kind: &str, shot: &Shot<'_>) -> Self {
        let origin = xml_comment(&origin_line(shot.provenance));
        let mut text = format!("<?xml version=\"1.0\"?>\n{origin}\n");
        let _ = writeln!(
            text,
            "<VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<{kind}>"
        );
        let mut document = Self { text, data: Vec::new() };
        document.group("FieldData", |d| {
            d.declare("Float64", "TimeValue", "NumberOfTuples=\"1\"", shot.frame.time.to_le_bytes().to_vec());
        });
        document
    }

    /// Opens a piece with so many points and `cells`, attributes that count them.
    fn piece(&mut self, points: usize, cells: &str) {
        let _ = writeln!(self.text, "<Piece NumberOfPoints=\"{points}\" {cells}>");
    }

    fn group(&mut self, name: &str, add: impl FnOnce(&mut Self)) {
        let tag = name.split(' ').next().unwrap_or(name);
        let _ = writeln!(self.text, "<{name}>");
        add(self);
        let _ = writeln!(self.text, "</{tag}>");
    }

    /// Adds an array whose rows have the named components; none: a plain number each.
    fn array<N: Number, const C: usize>(
        &mut self,
        name: &str,
        components: [&str; C],
        rows: impl Iterator<Item = [N; C]>,
    ) {
        // Of a plain number meshio makes a table of one column where the one component is told.
        let mut shape = if C == 1 { String::new() } else { format!("NumberOfComponents=\"{C}\"") };
        for (i, component) in components.iter().enumerate().filter(|(_, component)| !component.is_empty()) {
            let _ = write!(shape, " ComponentName{i}=\"{component}\"");
        }
        self.declare(N::KIND, name, &shape, rows.flatten().flat_map(N::bytes).collect());
    }

    fn declare(&mut self, kind: &str, name: &str, shape: &str, bytes: Vec<u8>) {
        let offset = self.data.len();
        let _ = writeln!(
            self.text,
            "<DataArray type=\"{kind}\" Name=\"{name}\" {shape} format=\"appended\" offset=\"{offset}\"/>"
        );
        self.data.extend((bytes.len() as u64).to_le_bytes());
        self.data.extend(bytes);
    }

    fn finish(mut self, kind: &str) -> Vec<u8> {
        let _ = write!(self.text, "</Piece>\n</{kind}>\n<AppendedData encoding=\"raw\">\n_");
        let mut bytes = self.text.into_bytes();
        bytes.append(&mut self.data);
        bytes.extend(b"\n</AppendedData>\n</VTKFile>\n");
        bytes
    }
}

/// A number as VTK names and stores it.
trait Number: Copy {
    const KIND: &'static str;
    fn bytes(self) -> Vec<u8>;
}

impl Number for f32 {
    const KIND: &'static str = "Float32";
    fn bytes(self) -> Vec<u8> {
        self.to_le_bytes().to_vec()
    }
}

impl Number for f64 {
    const KIND: &'static str = "Float64";
    fn bytes(self) -> Vec<u8> {
        self.to_le_bytes().to_vec()
    }
}

impl Number for i64 {
    const KIND: &'static str = "Int64";
    fn bytes(self) -> Vec<u8> {
        self.to_le_bytes().to_vec()
    }
}

impl Number for u32 {
    const KIND: &'static str = "UInt32";
    fn bytes(self) -> Vec<u8> {
        self.to_le_bytes().to_vec()
    }
}

impl Number for u8 {
    const KIND: &'static str = "UInt8";
    fn bytes(self) -> Vec<u8> {
        vec![self]
    }
}

/// No names for components.
const SCALAR: [&str; 1] = [""];
const VECTOR: [&str; 3] = ["x", "y", "z"];

/// All triangles of all objects; vertices of each slot are its own.
fn surfaces(shot: &Shot<'_>) -> Vec<u8> {
    let (mut vertices, mut triangles, mut cells) = (Vec::new(), Vec::new(), Vec::new());
    let slots = |mesh: &'_ Mesh| Slot::ALL.map(|slot| (slot, compact(mesh, mesh.slot(slot), CONVENTION)));
    for mesh in shot.objects {
        for (slot, (own, of_slot)) in slots(mesh) {
            let first = vertices.len() as i64;
            vertices.extend(own);
            cells.extend(of_slot.iter().map(|_| (mesh.piece, slot as u8)));
            triangles.extend(of_slot.iter().map(|t| t.map(|i| first + i64::from(i))));
        }
    }
    let mut document = Document::new("PolyData", shot);
    document.piece(vertices.len(), &format!("NumberOfPolys=\"{}\"", triangles.len()));
    document.group("Points", |d| d.array("Points", VECTOR, vertices.iter().map(|v| v.position)));
    document.group("PointData Normals=\"normal\" TCoords=\"texture\" Vectors=\"velocity\"", |d| {
        d.array("normal", VECTOR, vertices.iter().map(|v| v.normal));
        d.array("texture", ["s", "t"], vertices.iter().map(|v| v.texture));
        d.array("velocity", VECTOR, vertices.iter().map(|v| v.velocity));
        for attribute in Attribute::ALL.into_iter().filter(|attribute| has(shot.objects, *attribute)) {
            d.array(attribute.name(), SCALAR, vertices.iter().map(|v| [v.history.number(attribute)]));
        }
    });
    document.group("CellData Scalars=\"piece\"", |d| {
        d.array("piece", SCALAR, cells.iter().map(|cell| [cell.0]));
        d.array("slot", SCALAR, cells.iter().map(|cell| [cell.1]));
    });
    document.group("Polys", |d| {
        d.array("connectivity", SCALAR, triangles.iter().flatten().map(|&i| [i]));
        d.array("offsets", SCALAR, (1..=triangles.len() as i64).map(|i| [3 * i]));
    });
    document.finish("PolyData")
}

/// The particles in double precision, in the order of the take, with all that it says of them.
fn particles(shot: &Shot<'_>) -> Vec<u8> {
    /// `vtkVertex`.
    const VERTEX: u8 = 1;
    let particles = &shot.frame.particles;
    let count = particles.len();
    let mut document = Document::new("UnstructuredGrid", shot);
    document.piece(count, &format!("NumberOfCells=\"{count}\""));
    let places = |points: &'_ [Point]| points.iter().map(|p| [p.x, p.y, 0.0]).collect::<Vec<_>>();
    let vectors = |vectors: &'_ [Vector]| vectors.iter().map(|v| [v.x, v.y, 0.0]).collect::<Vec<_>>();
    document.group("Points", |d| d.array("Points", VECTOR, places(&particles.position).into_iter()));
    document.group("PointData Vectors=\"velocity\"", |d| {
        let number = |values: &'_ [u32]| values.iter().map(|&v| [v]).collect::<Vec<_>>().into_iter();
        d.array("id", SCALAR, number(&particles.id));
        d.array("body", SCALAR, number(&particles.body));
        d.array("piece", SCALAR, number(&particles.piece));
        // Of the body as thick as it is shown; takes of older versions do not know it.
        if let Some(mass) = &particles.mass {
            d.array("mass", SCALAR, mass.iter().map(|per_thickness| [per_thickness * shot.thickness]));
        }
        d.array("rest", VECTOR, places(&particles.rest).into_iter());
        d.array("velocity", VECTOR, vectors(&particles.velocity).into_iter());
        let all = |f: &Matrix| [f[(0, 0)], f[(0, 1)], f[(1, 0)], f[(1, 1)]];
        d.array("deformation_gradient", ["xx", "xy", "yx", "yy"], particles.deformation_gradient.iter().map(all));
        // What the take has: stress in the plane, symmetric.
        let symmetric = |s: &Matrix| [s[(0, 0)], s[(1, 1)], 0.5 * (s[(0, 1)] + s[(1, 0)])];
        d.array("cauchy_stress", ["xx", "yy", "xy"], particles.cauchy_stress.iter().map(symmetric));
    });
    document.group("Cells", |d| {
        d.array("connectivity", SCALAR, (0..count as i64).map(|i| [i]));
        d.array("offsets", SCALAR, (1..=count as i64).map(|i| [i]));
        d.array("types", SCALAR, (0..count).map(|_| [VERTEX]));
    });
    document.finish("UnstructuredGrid")
}
