//! glTF documents in the making.

use super::FormatError;
use super::palette::color_and_roughness;
use crate::history::History;
use crate::mesh::{Content, Mesh};
use crate::packed::{Convention, PackedVertex, compact, pack};
use crate::provenance::Provenance;
use crate::slot::Slot;
use fissure_scene::{Attribute, UpAxis};
use gltf::binary::{Glb, Header};
use gltf::json::accessor::{ComponentType, GenericComponentType, Type};
use gltf::json::buffer::Target;
use gltf::json::material::{PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::{Checked::Valid, USize64};
use gltf::json::{
    self as json, Accessor, Asset, Buffer, Extras, Index, Material, Node, Root, Scene, Value, buffer, serialize,
};
use serde::Serialize;
use std::collections::BTreeMap;

/// `asset.generator` of a GLB file: magic, version, length; then length, type and text of the JSON chunk.
#[cfg(feature = "files")]
pub(super) fn made_by(bytes: &[u8]) -> Option<String> {
    #[derive(serde::Deserialize)]
    struct Document {
        asset: Maker,
    }
    #[derive(serde::Deserialize)]
    struct Maker {
        generator: String,
    }
    let (head, rest) = bytes.split_first_chunk::<12>()?;
    let (length, rest) = rest.split_first_chunk::<4>()?;
    let text = rest.strip_prefix(b"JSON")?.get(..u32::from_le_bytes(*length) as usize)?;
    let document: Document = json::deserialize::from_slice(text).ok()?;
    head.starts_with(b"glTF").then_some(document.asset.generator)
}

/// What a whole object has in common; importers make it properties of the object.
#[derive(Serialize)]
pub(super) struct ObjectExtras {
    /// Fragment number of the simulation, or index of the crack or collider.
    pub(super) piece: u32,
}

/// `value` as extras.
fn extras(value: &impl Serialize) -> Result<Extras, FormatError> {
    Ok(Some(json::deserialize::from_str(&serialize::to_string(value)?)?))
}

/// A document in the making.
///
/// There is one custom attribute, and no second may be added: Blender 5.0.1 keeps them in a set without an order, takes
/// one for another from primitive to primitive, and fails where their widths differ.
pub(super) struct Document {
    convention: Convention,
    pub(super) root: Root,
    binary: Vec<u8>,
    materials: BTreeMap<Slot, Index<Material>>,
}

impl Document {
    /// An empty one; `time_scale` seconds of simulated time pass in one that velocities are for.
    pub(super) fn new(time_scale: f64) -> Self {
        let convention = Convention { up: UpAxis::Y, time_scale };
        Self { convention, root: Root::default(), binary: Vec::new(), materials: BTreeMap::new() }
    }

    /// Adds `mesh` with its node; a mesh without vertices adds nothing, the format has no empty meshes.
    pub(super) fn node(&mut self, mesh: &Mesh) -> Result<Option<Index<Node>>, FormatError> {
        self.node_named(mesh, mesh.name.clone(), &ObjectExtras { piece: mesh.piece })
    }

    /// As [`Document::node`], with a name and extras of one's own.
    pub(super) fn node_named(
        &mut self,
        mesh: &Mesh,
        name: String,
        about: &impl Serialize,
    ) -> Result<Option<Index<Node>>, FormatError> {
        let primitives = self.primitives(mesh);
        if primitives.is_empty() {
            return Ok(None);
        }
        let named = Some(name.clone());
        let mesh = json::Mesh { extensions: None, extras: None, name: named, primitives, weights: None };
        let mesh = Some(self.root.push(mesh));
        Ok(Some(self.root.push(Node { mesh, name: Some(name), extras: extras(about)?, ..Node::default() })))
    }

    /// The file, with a scene of `nodes`; `about` it goes into the extras of the asset.
    ///
    /// # Errors
    /// When the file would be larger than the 4 GiB of the format.
    pub(super) fn finish(
        mut self,
        mut nodes: Vec<Index<Node>>,
        provenance: &Provenance,
        about: &impl Serialize,
    ) -> Result<Vec<u8>, FormatError> {
        let generator = Some(provenance.tool.clone());
        self.root.asset = Asset { generator, extras: extras(about)?, ..Asset::default() };
        if nodes.is_empty() {
            // Readers differ in what they make of a file without a scene or of a scene without nodes; three.js and the
            // crate `gltf` fail. All of them know a node without a mesh.
            nodes.push(self.root.push(Node { name: Some("nothing".to_owned()), ..Node::default() }));
        }
        let scene = Scene { extensions: None, extras: None, name: Some(provenance.scene.clone()), nodes };
        self.root.scene = Some(self.root.push(scene));
        if !self.binary.is_empty() {
            let length = USize64::from(self.binary.len());
            self.root.push(Buffer { byte_length: length, name: None, uri: None, extensions: None, extras: None });
        }
        container(serialize::to_vec(&self.root)?, self.binary)
    }

    fn primitives(&mut self, mesh: &Mesh) -> Vec<Primitive> {
        if mesh.content == Content::Points {
            let vertices: Vec<_> = mesh.vertices.iter().map(|v| pack(v, self.convention)).collect();
            let attributes = self.common_attributes(&vertices);
            let primitive = Primitive { mode: Valid(Mode::Points), ..primitive(attributes) };
            return if vertices.is_empty() { Vec::new() } else { vec![primitive] };
        }
        let used = Slot::ALL.into_iter().filter(|slot| !mesh.slot(*slot).is_empty());
        used.map(|slot| self.triangles(mesh, slot)).collect()
    }

    fn triangles(&mut self, mesh: &Mesh, slot: Slot) -> Primitive {
        let (vertices, triangles) = compact(mesh, mesh.slot(slot), self.convention);
        let mut attributes = self.common_attributes(&vertices);
        let normals = vertices.iter().map(|v| v.normal);
        let normals = self.floats(normals, vertices.len(), Type::Vec3);
        // Texture coordinates of the format count downwards.
        let texture = vertices.iter().map(|v| [v.texture[0], 1.0 - v.texture[1]]);
        let texture = self.floats(texture, vertices.len(), Type::Vec2);
        attributes.insert(Valid(Semantic::Normals), normals);
        attributes.insert(Valid(Semantic::TexCoords(0)), texture);
        if let Some(size) = mesh.texture_size {
            let metres = vertices.iter().map(|v| v.metres(size)).map(|[u, v]| [u, 1.0 - v]);
            let metres = self.floats(metres, vertices.len(), Type::Vec2);
            attributes.insert(Valid(Semantic::TexCoords(1)), metres);
        }
        if slot == Slot::Inside && !mesh.attributes.is_empty() {
            // As wide as the velocity: Blender 5.0 fails in half of its processes on two attributes of different width.
            let number = |history: &History, attribute: Attribute| {
                if mesh.attributes.contains(&attribute) { history.number(attribute) } else { 0.0 }
            };
            let crack = vertices.iter().map(|v| Attribute::ALL.map(|attribute| number(&v.history, attribute)));
            let crack = self.floats(crack, vertices.len(), Type::Vec3);
            attributes.insert(Valid(Semantic::Extras("CRACK".to_owned())), crack);
        }
        let indices = triangles.iter().map(|triangle| triangle.map(u32::to_le_bytes));
        let target = Some(Target::ElementArrayBuffer);
        let indices = self.accessor(indices, 3 * triangles.len(), Type::Scalar, ComponentType::U32, target);
        let material = self.material(slot);
        Primitive { indices: Some(indices), material: Some(material), ..primitive(attributes) }
    }

    /// Attributes that triangles and points have.
    fn common_attributes(&mut self, vertices: &[PackedVertex]) -> Attributes {
        let mut attributes = Attributes::new();
        let positions = self.floats(vertices.iter().map(|v| v.position), vertices.len(), Type::Vec3);
        let bound = |pick: fn(f32, f32) -> f32, start: f32| {
            let all = vertices.iter().fold([start; 3], |b, v| std::array::from_fn(|i| pick(b[i], v.position[i])));
            Some(Value::from(all.to_vec()))
        };
        if let Some(accessor) = self.root.accessors.get_mut(positions.value()) {
            accessor.min = bound(f32::min, f32::INFINITY);
            accessor.max = bound(f32::max, f32::NEG_INFINITY);
        }
        attributes.insert(Valid(Semantic::Positions), positions);
        let velocity = self.floats(vertices.iter().map(|v| v.velocity), vertices.len(), Type::Vec3);
        attributes.insert(Valid(Semantic::Extras("VELOCITY".to_owned())), velocity);
        attributes
    }

    fn floats<const N: usize>(
        &mut self,
        values: impl Iterator<Item = [f32; N]>,
        count: usize,
        kind: Type,
    ) -> Index<Accessor> {
        let numbers = values.map(|values| values.map(f32::to_le_bytes));
        self.accessor(numbers, count, kind, ComponentType::F32, Some(Target::ArrayBuffer))
    }

    /// Numbers of an animation: rising times, from the least to the greatest.
    pub(super) fn times(&mut self, times: &[f32]) -> Index<Accessor> {
        let accessor = self.keys(times, times.len(), Type::Scalar);
        if let Some(described) = self.root.accessors.get_mut(accessor.value()) {
            described.min = times.first().map(|&t| Value::from(vec![t]));
            described.max = times.last().map(|&t| Value::from(vec![t]));
        }
        accessor
    }

    /// Numbers of an animation: so many values of one kind.
    pub(super) fn keys(&mut self, values: &[f32], count: usize, kind: Type) -> Index<Accessor> {
        self.accessor(values.iter().map(|value| [value.to_le_bytes()]), count, kind, ComponentType::F32, None)
    }

    /// Appends numbers with a view and an accessor of their own. All have four bytes, so all stay aligned.
    fn accessor<const N: usize>(
        &mut self,
        numbers: impl Iterator<Item = [[u8; 4]; N]>,
        count: usize,
        kind: Type,
        component: ComponentType,
        target: Option<Target>,
    ) -> Index<Accessor> {
        let begin = self.binary.len();
        self.binary.reserve(16 * count);
        numbers.for_each(|numbers| self.binary.extend_from_slice(numbers.as_flattened()));
        let view = self.root.push(buffer::View {
            buffer: Index::new(0),
            byte_length: USize64::from(self.binary.len() - begin),
            byte_offset: Some(USize64::from(begin)),
            byte_stride: None,
            name: None,
            target: target.map(Valid),
            extensions: None,
            extras: None,
        });
        self.root.push(Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: USize64::from(count),
            component_type: Valid(GenericComponentType(component)),
            extensions: None,
            extras: None,
            type_: Valid(kind),
            min: None,
            max: None,
            name: None,
            normalized: false,
            sparse: None,
        })
    }

    fn material(&mut self, slot: Slot) -> Index<Material> {
        let root = &mut self.root;
        *self.materials.entry(slot).or_insert_with(|| root.push(material(slot)))
    }
}

type Attributes = BTreeMap<json::validation::Checked<Semantic>, Index<Accessor>>;

fn primitive(attributes: Attributes) -> Primitive {
    Primitive {
        attributes,
        extensions: None,
        extras: None,
        indices: None,
        material: None,
        mode: Valid(Mode::Triangles),
        targets: None,
    }
}

fn material(slot: Slot) -> Material {
    let ([red, green, blue], roughness) = color_and_roughness(slot);
    Material {
        name: Some(slot.name().to_owned()),
        pbr_metallic_roughness: PbrMetallicRoughness {
            base_color_factor: PbrBaseColorFactor([red, green, blue, 1.0]),
            metallic_factor: StrengthFactor(0.0),
            roughness_factor: StrengthFactor(roughness),
            ..PbrMetallicRoughness::default()
        },
        ..Material::default()
    }
}

/// Joins the two chunks of a GLB file; one without `binary` has no second chunk.
fn container(document: Vec<u8>, binary: Vec<u8>) -> Result<Vec<u8>, FormatError> {
    let chunk = |data: &[u8]| if data.is_empty() { 0 } else { 8 + data.len().next_multiple_of(4) };
    let length = 12 + chunk(&document) + chunk(&binary);
    // `Glb::to_vec` lets lengths beyond 32 bits wrap around.
    let length = u32::try_from(length).map_err(|_| FormatError::TooLarge(length))?;
    let bin = (!binary.is_empty()).then_some(binary.into());
    Ok(Glb { header: Header { magic: *b"glTF", version: 2, length }, json: document.into(), bin }.to_vec()?)
}
