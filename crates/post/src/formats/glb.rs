//! Binary glTF 2.0: y up, one node per mesh, one primitive per material slot.

use super::palette::color_and_roughness;
use super::{FileFormat, FormatError, Shot};
use crate::mesh::{Content, Mesh};
use crate::packed::{Convention, PackedVertex, compact, pack};
use crate::provenance::Provenance;
use crate::slot::Slot;
use fissure_scene::{Part, UpAxis};
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

/// The bytes of a GLB file with `meshes`.
///
/// Attributes: `POSITION`, `NORMAL`, `TEXCOORD_0` and `_VELOCITY` [m per second of
/// playback], of which `time_scale` seconds of simulated time pass in one; points have no normals and texture
/// coordinates. What a whole object has in common, its `piece`, is in the extras of its node. Materials: `outside` and
/// `inside`, those that are used. `asset.extras` says where the file comes from. No meshes give a scene with one node
/// without a mesh.
///
/// There is one custom attribute, and no second may be added: Blender 5.0.1 keeps them in a set without an order, takes
/// one for another from primitive to primitive, and fails where their widths differ.
///
/// # Errors
/// When the file would be larger than the 4 GiB of the format.
fn bytes(meshes: &[Mesh], provenance: &Provenance, time_scale: f64) -> Result<Vec<u8>, FormatError> {
    let mut document = Document::new(time_scale);
    let mut nodes = Vec::new();
    for mesh in meshes {
        nodes.extend(document.node(mesh)?);
    }
    let Document { mut root, binary, .. } = document;
    root.asset = asset(provenance)?;
    let has_meshes = !nodes.is_empty();
    if !has_meshes {
        // Readers differ in what they make of a file without a scene or of a scene without nodes; three.js and the
        // crate `gltf` fail. All of them know a node without a mesh.
        nodes.push(root.push(Node { name: Some("nothing".to_owned()), ..Node::default() }));
    }
    let scene = Scene { extensions: None, extras: None, name: Some(provenance.scene.clone()), nodes };
    root.scene = Some(root.push(scene));
    if has_meshes {
        let length = USize64::from(binary.len());
        root.push(Buffer { byte_length: length, name: None, uri: None, extensions: None, extras: None });
    }
    container(serialize::to_vec(&root)?, binary)
}

/// Binary glTF.
pub(crate) struct BinaryGltf;

impl FileFormat for BinaryGltf {
    fn extension(&self, _: Part) -> &'static str {
        "glb"
    }

    fn frame(&self, shot: &Shot<'_>) -> Result<Vec<u8>, FormatError> {
        bytes(shot.objects, shot.provenance, shot.scene.frames.time_scale())
    }

    /// `asset.generator`: magic, version, length; then length, type and text of the JSON chunk.
    #[cfg(feature = "files")]
    fn maker(&self, bytes: &[u8]) -> Option<String> {
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
}

/// What a whole object has in common; importers make it properties of the object.
#[derive(Serialize)]
struct ObjectExtras {
    /// Fragment number of the simulation, or index of the crack or collider.
    piece: u32,
}

/// `value` as extras.
fn extras(value: &impl Serialize) -> Result<Extras, FormatError> {
    Ok(Some(json::deserialize::from_str(&serialize::to_string(value)?)?))
}

fn asset(provenance: &Provenance) -> Result<Asset, FormatError> {
    Ok(Asset { generator: Some(provenance.tool.clone()), extras: extras(provenance)?, ..Asset::default() })
}

/// A document in the making.
struct Document {
    convention: Convention,
    root: Root,
    binary: Vec<u8>,
    materials: BTreeMap<Slot, Index<Material>>,
}

impl Document {
    fn new(time_scale: f64) -> Self {
        let convention = Convention { up: UpAxis::Y, time_scale };
        Self { convention, root: Root::default(), binary: Vec::new(), materials: BTreeMap::new() }
    }

    /// Adds `mesh` with its node; a mesh without vertices adds nothing, the format has no empty meshes.
    fn node(&mut self, mesh: &Mesh) -> Result<Option<Index<Node>>, FormatError> {
        let primitives = self.primitives(mesh);
        if primitives.is_empty() {
            return Ok(None);
        }
        let mesh_index = self.root.push(json::Mesh {
            extensions: None,
            extras: None,
            name: Some(mesh.name.clone()),
            primitives,
            weights: None,
        });
        Ok(Some(self.root.push(Node {
            mesh: Some(mesh_index),
            name: Some(mesh.name.clone()),
            extras: extras(&ObjectExtras { piece: mesh.piece })?,
            ..Node::default()
        })))
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
        let normals = vertices.iter().flat_map(|v| v.normal);
        let normals = self.floats(normals, vertices.len(), Type::Vec3);
        // Texture coordinates of the format count downwards.
        let texture = vertices.iter().flat_map(|v| [v.texture[0], 1.0 - v.texture[1]]);
        let texture = self.floats(texture, vertices.len(), Type::Vec2);
        attributes.insert(Valid(Semantic::Normals), normals);
        attributes.insert(Valid(Semantic::TexCoords(0)), texture);
        let indices = triangles.iter().flatten().flat_map(|i| i.to_le_bytes()).collect();
        let indices =
            self.accessor(indices, 3 * triangles.len(), Type::Scalar, ComponentType::U32, Target::ElementArrayBuffer);
        let material = self.material(slot);
        Primitive { indices: Some(indices), material: Some(material), ..primitive(attributes) }
    }

    /// Attributes that triangles and points have.
    fn common_attributes(&mut self, vertices: &[PackedVertex]) -> Attributes {
        let mut attributes = Attributes::new();
        let positions = self.floats(vertices.iter().flat_map(|v| v.position), vertices.len(), Type::Vec3);
        let bound = |pick: fn(f32, f32) -> f32, start: f32| {
            let all = vertices.iter().fold([start; 3], |b, v| std::array::from_fn(|i| pick(b[i], v.position[i])));
            Some(Value::from(all.to_vec()))
        };
        if let Some(accessor) = self.root.accessors.get_mut(positions.value()) {
            accessor.min = bound(f32::min, f32::INFINITY);
            accessor.max = bound(f32::max, f32::NEG_INFINITY);
        }
        attributes.insert(Valid(Semantic::Positions), positions);
        let velocity = self.floats(vertices.iter().flat_map(|v| v.velocity), vertices.len(), Type::Vec3);
        attributes.insert(Valid(Semantic::Extras("VELOCITY".to_owned())), velocity);
        attributes
    }

    fn floats(&mut self, values: impl Iterator<Item = f32>, count: usize, kind: Type) -> Index<Accessor> {
        let bytes = values.flat_map(f32::to_le_bytes).collect();
        self.accessor(bytes, count, kind, ComponentType::F32, Target::ArrayBuffer)
    }

    /// Appends `bytes` with a view and an accessor of their own. All components have four bytes, so all stay aligned.
    fn accessor(
        &mut self,
        bytes: Vec<u8>,
        count: usize,
        kind: Type,
        component: ComponentType,
        target: Target,
    ) -> Index<Accessor> {
        let view = self.root.push(buffer::View {
            buffer: Index::new(0),
            byte_length: USize64::from(bytes.len()),
            byte_offset: Some(USize64::from(self.binary.len())),
            byte_stride: None,
            name: None,
            target: Some(Valid(target)),
            extensions: None,
            extras: None,
        });
        self.binary.extend(bytes);
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
