//! Universal Scene Description as text: a file per frame, and a stage that plays them all.
//!
//! The stage holds the objects of all frames and takes their values from the files of the frames as *value clips*, so
//! that each frame is written once, whichever comes first, and a reader has one in memory at a time. A file of a frame
//! is a stage by itself, too. Objects have one mesh for each material: subsets of faces that change from frame to frame
//! are read by few importers.

use super::numbers::{join, join_tuples};
use super::palette::color_and_roughness;
use super::{FileFormat, FormatError, Shot, origin_line, sequence_name};
use crate::mesh::{Content, Mesh};
use crate::packed::{Convention, PackedVertex, compact, pack};
use crate::slot::Slot;
use fissure_scene::{Attribute, FrameSettings, Part, UpAxis};
use std::collections::BTreeSet;
use std::fmt::Write;

/// USD as text: y up, metres, a time code per frame.
pub(crate) struct UsdText;

impl FileFormat for UsdText {
    fn extension(&self, _: Part) -> &'static str {
        "usda"
    }

    fn frame(&self, shot: &Shot<'_>) -> Result<Vec<u8>, FormatError> {
        let number = shot.provenance.frame;
        let root = identifier(&sequence_name(&shot.scene.name, shot.part));
        let mut text = header(&origin_line(shot.provenance), Some(&root), [number; 2], &shot.scene.frames);
        let _ = writeln!(text, "def Xform \"{root}\"\n{{");
        let (mut names, mut is_solid) = (BTreeSet::new(), false);
        for mesh in shot.objects {
            is_solid |= mesh.content != Content::Points;
            let name = unused(identifier(&mesh.name), &mut names);
            let place = Place { root: &root, name: &name, number, convention: shot.played(UpAxis::Y) };
            object(&mut text, mesh, place, shot.scene.particle_spacing);
        }
        if is_solid {
            materials(&mut text, &root);
        }
        text.push_str("}\n");
        Ok(text.into_bytes())
    }

    /// The stage that plays all frames, and the list of what its clips hold.
    #[cfg(feature = "files")]
    fn companions(&self, listing: &super::Listing<'_>) -> Vec<(String, Vec<u8>)> {
        stage::companions(listing)
    }

    /// The `doc` of the file.
    #[cfg(feature = "files")]
    fn maker(&self, bytes: &[u8]) -> Option<String> {
        bytes.starts_with(b"#usda 1.0\n").then(|| super::after_mark(bytes, "doc = \"")).flatten()
    }
}

/// Where an object is written.
#[derive(Clone, Copy)]
struct Place<'a> {
    /// Name of what holds all objects.
    root: &'a str,
    /// Its name in the file.
    name: &'a str,
    /// Frame number, which is the time code.
    number: i64,
    /// y up, velocities per second of playback.
    convention: Convention,
}

/// What a file begins with; it plays the frames `first` to `last`.
fn header(origin: &str, root: Option<&str>, [first, last]: [i64; 2], frames: &FrameSettings) -> String {
    let mut text = format!("#usda 1.0\n(\n    doc = \"{}\"\n", origin.replace(['"', '\\', '\n', '\r'], " "));
    if let Some(root) = root {
        let _ = writeln!(text, "    defaultPrim = \"{root}\"");
    }
    let rate = frames.playback;
    let _ = writeln!(text, "    metersPerUnit = 1\n    upAxis = \"Y\"");
    let _ = writeln!(text, "    startTimeCode = {first}\n    endTimeCode = {last}");
    let _ = writeln!(text, "    timeCodesPerSecond = {rate}\n    framesPerSecond = {rate}\n)\n");
    text
}

/// One object as it is in one frame.
fn object(text: &mut String, mesh: &Mesh, place: Place<'_>, particle_spacing: f64) {
    let Place { root, name, number, convention } = place;
    let _ = writeln!(text, "    def Xform \"{name}\" (\n        displayName = \"{}\"\n    )\n    {{", mesh.name);
    let _ = writeln!(text, "        custom int piece = {}", mesh.piece);
    if mesh.content == Content::Points {
        let vertices: Vec<_> = mesh.vertices.iter().map(|v| pack(v, convention)).collect();
        let _ = writeln!(text, "        def Points \"{name}_points\"\n        {{");
        motion(text, &vertices, number);
        samples(text, "float[] widths", number, |t| join(t, vertices.iter().map(|_| particle_spacing as f32), ", "));
        text.push_str("        }\n");
    }
    for slot in Slot::ALL {
        let (vertices, triangles) = compact(mesh, mesh.slot(slot), convention);
        if triangles.is_empty() {
            continue;
        }
        mesh_opening(text, &format!("{name}_{}", slot.name()), slot, root);
        if let Some(size) = mesh.texture_size {
            text.push_str(METRES);
            let metres = vertices.iter().map(|v| v.metres(size));
            samples(text, "texCoord2f[] primvars:st1", number, |t| join_tuples(t, metres));
        }
        for &attribute in mesh.attributes.iter().filter(|_| slot == Slot::Inside) {
            text.push_str(&declared(attribute));
            let name = format!("float[] primvars:{}", attribute.name());
            samples(text, &name, number, |t| join(t, vertices.iter().map(|v| v.history.number(attribute)), ", "));
        }
        motion(text, &vertices, number);
        samples(text, "normal3f[] normals", number, |t| join_tuples(t, vertices.iter().map(|v| v.normal)));
        samples(text, "texCoord2f[] primvars:st", number, |t| join_tuples(t, vertices.iter().map(|v| v.texture)));
        samples(text, "int[] faceVertexCounts", number, |t| join(t, triangles.iter().map(|_| 3), ", "));
        samples(text, "int[] faceVertexIndices", number, |t| join(t, triangles.iter().flatten(), ", "));
        text.push_str("        }\n");
    }
    text.push_str("    }\n");
}

/// The second set of texture coordinates, in metres.
const METRES: &str =
    "            texCoord2f[] primvars:st1 (\n                interpolation = \"vertex\"\n            )\n";

/// An attribute of crack walls without its values.
fn declared(attribute: Attribute) -> String {
    let name = attribute.name();
    format!("            float[] primvars:{name} (\n                interpolation = \"vertex\"\n            )\n")
}

/// The beginning of the mesh `name` with what does not change from frame to frame.
fn mesh_opening(text: &mut String, name: &str, slot: Slot, root: &str) {
    let slot = slot.name();
    let _ = write!(
        text,
        "        def Mesh \"{name}\" (\n            prepend apiSchemas = [\"MaterialBindingAPI\"]\n        )\n        {{
            uniform token subdivisionScheme = \"none\"
            rel material:binding = </{root}/materials/{slot}>
            normal3f[] normals (\n                interpolation = \"vertex\"\n            )
            texCoord2f[] primvars:st (\n                interpolation = \"vertex\"\n            )\n"
    );
}

/// Positions, velocities, and the box around the positions.
fn motion(text: &mut String, vertices: &[PackedVertex], number: i64) {
    let bound = |pick: fn(f32, f32) -> f32, start: f32| {
        vertices.iter().fold([start; 3], |b, v| std::array::from_fn(|i| pick(b[i], v.position[i])))
    };
    let extent = [bound(f32::min, f32::INFINITY), bound(f32::max, f32::NEG_INFINITY)];
    let extent = extent.into_iter().filter(|_| !vertices.is_empty());
    samples(text, "float3[] extent", number, |t| join_tuples(t, extent));
    samples(text, "point3f[] points", number, |t| join_tuples(t, vertices.iter().map(|v| v.position)));
    samples(text, "vector3f[] velocities", number, |t| join_tuples(t, vertices.iter().map(|v| v.velocity)));
}

/// An attribute with one time sample, an array.
fn samples(text: &mut String, attribute: &str, number: i64, values: impl FnOnce(&mut String)) {
    let _ = write!(text, "            {attribute}.timeSamples = {{\n                {number}: [");
    values(text);
    text.push_str("],\n            }\n");
}

/// The materials of both slots.
fn materials(text: &mut String, root: &str) {
    text.push_str("    def Scope \"materials\"\n    {\n");
    for slot in Slot::ALL {
        let ([r, g, b], roughness) = color_and_roughness(slot);
        let slot = slot.name();
        let _ = write!(
            text,
            "        def Material \"{slot}\"\n        {{
            token outputs:surface.connect = </{root}/materials/{slot}/surface.outputs:surface>
            def Shader \"surface\"\n            {{
                uniform token info:id = \"UsdPreviewSurface\"
                color3f inputs:diffuseColor = ({r}, {g}, {b})
                float inputs:roughness = {roughness}
                float inputs:metallic = 0
                token outputs:surface\n            }}\n        }}\n"
        );
    }
    text.push_str("    }\n");
}

/// `name` as an identifier: letters, digits and `_`, no digit first.
fn identifier(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let name: String = name.chars().map(plain).collect();
    if name.starts_with(|c: char| c.is_ascii_digit()) { format!("_{name}") } else { name }
}

/// `name`, or the first of `name_2`, `name_3`, ... that is not among `names` yet; it is then.
fn unused(name: String, names: &mut BTreeSet<String>) -> String {
    let numbered = (2..).map(|number: u32| format!("{name}_{number}"));
    let free = std::iter::once(name.clone()).chain(numbered).find(|name| !names.contains(name)).unwrap_or(name.clone());
    names.insert(free.clone());
    free
}

/// The stage over all frames.
#[cfg(feature = "files")]
mod stage {
    use super::*;
    use crate::formats::Listing;
    use crate::record::ObjectRecord;
    use fissure_scene::OutputSettings;
    use std::collections::BTreeMap;

    /// The stage and the manifest of its clips.
    ///
    /// What a clip does not hold, because its frame has no such object, is taken from the manifest: nothing.
    pub(super) fn companions(listing: &Listing<'_>) -> Vec<(String, Vec<u8>)> {
        let root = identifier(listing.name);
        let objects = objects(listing);
        let output = &listing.scene.output;
        let stage = format!("{}.usda", listing.name);
        let clips = format!("{}.clips.usda", listing.name);
        let frames = listing.records.iter().map(|record| record.frame);
        let ends = [frames.clone().min().unwrap_or_default(), frames.max().unwrap_or_default()];
        let origin = format!("{}, scene {} {}", listing.tool, listing.scene.name, listing.scene.hash);

        let mut text = header(&origin, Some(&root), ends, &listing.scene.frames);
        let _ = writeln!(text, "def Xform \"{root}\" (\n    clips = {{\n        dictionary default = {{");
        text.push_str("            asset[] assetPaths = [");
        join(&mut text, listing.records.iter().map(|record| format!("@./{}@", record.file)), ", ");
        let _ = write!(text, "]\n            asset manifestAssetPath = @./{clips}@");
        let _ = write!(text, "\n            string primPath = \"/{root}\"\n            double2[] active = [");
        join_tuples(&mut text, listing.records.iter().zip(0..).map(|(record, clip)| [record.frame, clip]));
        text.push_str("]\n            double2[] times = [");
        join_tuples(&mut text, listing.records.iter().map(|record| [record.frame; 2]));
        text.push_str("]\n        }\n    }\n)\n{\n");
        declare(&mut text, &root, &objects, Declared::InStage, output);
        if objects.values().any(|object| !object.materials.is_empty()) {
            materials(&mut text, &root);
        }
        text.push_str("}\n");

        let mut manifest = header(&origin, Some(&root), ends, &listing.scene.frames);
        let _ = writeln!(manifest, "over \"{root}\"\n{{");
        declare(&mut manifest, &root, &objects, Declared::InManifest, output);
        manifest.push_str("}\n");
        vec![(stage, text.into_bytes()), (clips, manifest.into_bytes())]
    }

    /// All objects of all frames with all materials that they have in any, by their names in the files.
    fn objects(listing: &Listing<'_>) -> BTreeMap<String, ObjectRecord> {
        let mut objects = BTreeMap::<String, ObjectRecord>::new();
        for record in listing.records {
            let mut names = BTreeSet::new();
            for object in &record.objects {
                let name = unused(identifier(&object.name), &mut names);
                let known = objects.entry(name).or_insert_with(|| object.clone());
                for material in &object.materials {
                    if !known.materials.contains(material) {
                        known.materials.push(material.clone());
                    }
                }
            }
        }
        objects
    }

    /// Where attributes are declared.
    #[derive(Clone, Copy, PartialEq)]
    enum Declared {
        /// Without values: one of the stage itself would be stronger than those of the clips.
        InStage,
        /// With the values that hold where a clip has none.
        InManifest,
    }

    /// Declares all attributes of all objects that change from frame to frame, by `output` also
    /// those that are not always there.
    fn declare(
        text: &mut String,
        root: &str,
        objects: &BTreeMap<String, ObjectRecord>,
        declared: Declared,
        output: &OutputSettings,
    ) {
        let metres = output.surfaces.uv_in_metres;
        let attributes = |slot: Slot| {
            let asked = move |attribute: &Attribute| slot == Slot::Inside && output.attributes.contains(attribute);
            Attribute::ALL.into_iter().filter(asked)
        };
        let empty = if declared == Declared::InManifest { " = []" } else { "" };
        let specifier = if declared == Declared::InManifest { "over" } else { "def" };
        let moving = ["float3[] extent", "point3f[] points", "vector3f[] velocities"];
        for (name, object) in objects {
            if declared == Declared::InStage {
                let _ = writeln!(text, "    def Xform \"{name}\" (\n        displayName = \"{}\"\n    )", object.name);
                let _ = writeln!(text, "    {{\n        custom int piece = {}", object.piece);
            } else {
                let _ = writeln!(text, "    over \"{name}\"\n    {{");
            }
            if object.materials.is_empty() {
                let _ = writeln!(text, "        {specifier} Points \"{name}_points\"\n        {{");
                for attribute in moving.iter().chain(&["float[] widths"]) {
                    let _ = writeln!(text, "            {attribute}{empty}");
                }
                text.push_str("        }\n");
            }
            for slot in Slot::ALL.into_iter().filter(|slot| object.materials.iter().any(|m| m == slot.name())) {
                if declared == Declared::InStage {
                    mesh_opening(text, &format!("{name}_{}", slot.name()), slot, root);
                    text.push_str(if metres { METRES } else { "" });
                    attributes(slot).for_each(|attribute| text.push_str(&super::declared(attribute)));
                } else {
                    let _ = writeln!(text, "        over \"{name}_{}\"\n        {{", slot.name());
                    text.push_str("            normal3f[] normals = []\n            texCoord2f[] primvars:st = []\n");
                    text.push_str(if metres { "            texCoord2f[] primvars:st1 = []\n" } else { "" });
                    for attribute in attributes(slot) {
                        let _ = writeln!(text, "            float[] primvars:{} = []", attribute.name());
                    }
                }
                for attribute in moving.iter().chain(&["int[] faceVertexCounts", "int[] faceVertexIndices"]) {
                    let _ = writeln!(text, "            {attribute}{empty}");
                }
                text.push_str("        }\n");
            }
            text.push_str("    }\n");
        }
    }
}
