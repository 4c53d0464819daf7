//! Files read back by other readers.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{halves, options};
use fissure_files::Folder;
use fissure_post::{
    FileRecord, FrameMeshes, History, Manifest, Mesh, PostOptions, Sequences, Slot, WriteError, encode, post_frame,
    write_companions, write_frame,
};
use fissure_scene::{Attribute, Cut, Format, Frame, Part, Roughness, Scene, UpAxis, Vector};
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};
use std::collections::BTreeSet;

/// A frame with its meshes, and the scene that it is of.
struct Sample {
    scene: Scene,
    frame: Frame,
    meshes: FrameMeshes,
}

impl Sample {
    fn write(&self, folder: &Folder, formats: &[Format]) -> Result<Vec<FileRecord>, WriteError> {
        write_frame(folder, &self.scene, &self.frame, &self.meshes, formats)
    }
}

fn sample(number: i64) -> Sample {
    let (mut scene, mut frame) = halves(20.0, [(0.0, Vector::zeros()), (0.3, Vector::new(3.0, 0.5))]);
    frame.number = number;
    let mut options = options(&scene);
    options.parts = vec![Part::Cracked, Part::Particles, Part::Collider];
    scene.name = "glass".into();
    // Shown at half the speed.
    scene.frames.rate = 2.0 * scene.frames.playback;
    let meshes = post_frame(&scene, &frame, &options).unwrap();
    Sample { scene, frame, meshes }
}

#[test]
fn a_glb_file_holds_what_the_mesh_holds() {
    let folder = tempfile::tempdir().unwrap();
    let sample = sample(1);
    let records = sample.write(&Folder::new(folder.path()), &[Format::Glb]).unwrap();
    let names: Vec<&str> = records.iter().map(|r| r.file.as_str()).collect();
    assert_eq!(names, ["glass.0001.glb", "glass_particles.0001.glb", "glass_collider.0001.glb"]);

    let extras = |node: &gltf::Node<'_>| -> serde_json::Value {
        serde_json::from_str(node.extras().as_ref().unwrap().get()).unwrap()
    };
    let (document, buffers, _) = gltf::import(&records[0].path).unwrap();
    let meshes = &sample.meshes.parts[0].1;
    assert_eq!(document.nodes().count(), meshes.len());
    for (node, mesh) in document.nodes().zip(meshes) {
        assert_eq!(node.name(), Some(mesh.name.as_str()));
        assert_eq!(extras(&node), serde_json::json!({ "piece": mesh.piece }));
        let primitives: Vec<_> = node.mesh().unwrap().primitives().collect();
        assert_eq!(primitives.len(), 2);
        for (primitive, (slot, triangles)) in primitives.iter().zip(["outside", "inside"].iter().zip(&mesh.triangles)) {
            assert_eq!(primitive.material().name(), Some(*slot));
            let reader = primitive.reader(|b| Some(&buffers[b.index()]));
            let positions: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
            let normals: Vec<[f32; 3]> = reader.read_normals().unwrap().collect();
            let textures: Vec<[f32; 2]> = reader.read_tex_coords(0).unwrap().into_f32().collect();
            let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
            assert_eq!(indices.len(), 3 * triangles.len());
            for (&read, &made) in indices.iter().zip(triangles.iter().flatten()) {
                let vertex = &mesh.vertices[made as usize];
                assert_eq!(positions[read as usize], vertex.position.map(|x| x as f32));
                assert_eq!(normals[read as usize], vertex.normal.map(|x| x as f32));
                let [u, v] = vertex.texture.map(|x| x as f32);
                assert_eq!(textures[read as usize], [u, 1.0 - v]);
            }
            let attributes: BTreeSet<String> = primitive.attributes().map(|(s, _)| s.to_string()).collect();
            // One custom attribute at most: two of different width are more than Blender 5.0.1 can read.
            let expected = ["NORMAL", "POSITION", "TEXCOORD_0", "_VELOCITY"].map(str::to_owned);
            assert_eq!(attributes, BTreeSet::from(expected));
        }
    }
    let origin = document.into_json().asset.extras.unwrap();
    assert!(origin.get().contains("\"scene_hash\":\"0000"), "{origin:?}");

    let (document, _, _) = gltf::import(&records[1].path).unwrap();
    let primitive = document.meshes().next().unwrap().primitives().next().unwrap();
    assert_eq!(primitive.mode(), gltf::mesh::Mode::Points);
    let pieces: Vec<_> = document.nodes().map(|node| extras(&node)["piece"].clone()).collect();
    assert_eq!(pieces, [0, 1]);
    // A part without anything: readers still find a scene and a node.
    let (document, _, _) = gltf::import(&records[2].path).unwrap();
    assert_eq!(document.default_scene().unwrap().nodes().count(), 1);
    assert_eq!(document.meshes().count(), 0);
}

#[test]
fn a_ply_file_holds_what_the_mesh_holds() {
    let folder = tempfile::tempdir().unwrap();
    let sample = sample(1);
    assert_eq!(sample.meshes.up, UpAxis::Z);
    let records = sample.write(&Folder::new(folder.path()), &[Format::Ply]).unwrap();
    let bytes = std::fs::read(&records[0].path).unwrap();
    let ply = Parser::<DefaultElement>::new().read_ply(&mut bytes.as_slice()).unwrap();
    let (vertices, faces) = (&ply.payload["vertex"], &ply.payload["face"]);
    let float = |vertex: &DefaultElement, name: &str| match vertex[name] {
        Property::Float(x) => x,
        _ => panic!("{name} is not a float"),
    };
    let mut row = 0;
    for mesh in &sample.meshes.parts[0].1 {
        for (slot, triangles) in [0.0, 1.0].into_iter().zip(&mesh.triangles) {
            for triangle in triangles {
                let Property::ListInt(read) = &faces[row]["vertex_indices"] else { panic!("not a list") };
                row += 1;
                for (&read, &made) in read.iter().zip(triangle) {
                    let (vertex, made) = (&vertices[read as usize], &mesh.vertices[made as usize]);
                    let three = |names: [&str; 3]| names.map(|n| float(vertex, n));
                    // z up: the drawing stands upright, its front faces −y.
                    let turned = |[x, y, z]: [f64; 3]| [x as f32, -z as f32, y as f32];
                    assert_eq!(three(["x", "y", "z"]), turned(made.position));
                    assert_eq!(three(["nx", "ny", "nz"]), turned(made.normal));
                    assert_eq!(three(["vx", "vy", "vz"]), turned(made.velocity.map(|v| 0.5 * v)));
                    assert_eq!([float(vertex, "s"), float(vertex, "t")], made.texture.map(|x| x as f32));
                    assert_eq!([float(vertex, "piece"), float(vertex, "slot")], [mesh.piece as f32, slot]);
                }
            }
        }
    }
    assert_eq!(row, faces.len());
    assert!(ply.header.comments.iter().any(|c| c.contains(&"0".repeat(64))));
}

/// Truth: what has not moved is as large in texture coordinates in metres as it is, side by side of all triangles.
#[test]
fn texture_coordinates_in_metres_are_as_long_as_the_sides() {
    let folder = tempfile::tempdir().unwrap();
    let mut sample = sample(1);
    let options = PostOptions { uv_in_metres: true, ..options(&sample.scene) };
    sample.meshes = post_frame(&sample.scene, &sample.frame, &options).unwrap();
    let records = sample.write(&Folder::new(folder.path()), &[Format::Glb, Format::Ply]).unwrap();
    let is_as_long = |places: [[f32; 3]; 3], metres: [[f32; 2]; 3]| {
        let length = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f32>().sqrt();
        // Each coordinate is rounded to half a unit in its last place.
        let largest = places.iter().flatten().chain(metres.iter().flatten()).fold(0.0, |a: f32, x| a.max(x.abs()));
        (0..3).all(|k| {
            let next = (k + 1) % 3;
            (length(&places[k], &places[next]) - length(&metres[k], &metres[next])).abs() < 4.0 * f32::EPSILON * largest
        })
    };
    let (document, buffers, _) = gltf::import(&records[0].path).unwrap();
    let still = document.nodes().find(|node| node.name() == Some("plate_piece_0000")).unwrap();
    let mut count = 0;
    for primitive in still.mesh().unwrap().primitives() {
        let reader = primitive.reader(|b| Some(&buffers[b.index()]));
        let positions: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
        let metres: Vec<[f32; 2]> = reader.read_tex_coords(1).unwrap().into_f32().collect();
        let indices: Vec<usize> = reader.read_indices().unwrap().into_u32().map(|i| i as usize).collect();
        for t in indices.chunks(3) {
            assert!(is_as_long([0, 1, 2].map(|k| positions[t[k]]), [0, 1, 2].map(|k| metres[t[k]])));
            count += 1;
        }
    }
    assert_eq!(count, sample.meshes.parts[0].1[0].triangle_count());
    let bytes = std::fs::read(&records[1].path).unwrap();
    let ply = Parser::<DefaultElement>::new().read_ply(&mut bytes.as_slice()).unwrap();
    let floats = |vertex: &DefaultElement, names: &[&str]| -> Vec<f32> {
        let float = |name: &&str| if let Property::Float(x) = vertex[*name] { x } else { f32::NAN };
        names.iter().map(float).collect()
    };
    for face in ply.payload["face"].iter().take(count) {
        let Property::ListInt(corners) = &face["vertex_indices"] else { panic!("not a list") };
        let vertices = [0, 1, 2].map(|k| &ply.payload["vertex"][corners[k] as usize]);
        let places = vertices.map(|v| floats(v, &["x", "y", "z"]).try_into().unwrap());
        assert!(is_as_long(places, vertices.map(|v| floats(v, &["s1", "t1"]).try_into().unwrap())));
    }
}

/// Truth: closed form. The crack of the sample runs straight on from its mouth at a steady speed under a K_I that rises
/// with the way; walls say the same at every vertex, however they are cut and shaped, in each format.
#[test]
fn crack_walls_tell_how_they_came_about() {
    let (mut scene, mut frame) = halves(20.0, [(0.0, Vector::zeros()), (0.3, Vector::new(3.0, 0.5))]);
    frame.time = 0.5;
    // Points are 2.5 m apart, one per .01 s, with 1 MPa √m more at each.
    let told = |way: f64| [0.5 - 0.01 * way / 2.5, way, 1e6 * way / 2.5];
    scene.output.attributes = Attribute::ALL.into();
    let plain = options(&scene);
    let roughness = Some(Roughness { amplitude: 0.02, length: 0.5, seed: 1 });
    let ways = [
        plain.clone(),
        PostOptions { cut: Cut::Rest, ..plain.clone() },
        PostOptions { roughness, ..plain.clone() },
        PostOptions { bevel: 0.02, ..plain.clone() },
        PostOptions { parts: vec![Part::Faces], ..plain.clone() },
    ];
    for options in ways {
        let meshes = post_frame(&scene, &frame, &options).unwrap();
        for mesh in &meshes.parts[0].1 {
            let walls: BTreeSet<u32> = mesh.slot(Slot::Inside).iter().flatten().copied().collect();
            for (i, vertex) in (0..).zip(&mesh.vertices) {
                let History { age, mouth_distance, mode_1 } = vertex.history;
                let found = [age, mouth_distance, mode_1];
                let expected = if walls.contains(&i) { told(20.0 * vertex.texture[0]) } else { [0.0; 3] };
                let is_close = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-9 * (1.0 + b.abs());
                assert!(found.iter().zip(&expected).all(is_close), "{}: {found:?} {expected:?}", mesh.name);
            }
            assert!(walls.len() > 8);
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let meshes = post_frame(&scene, &frame, &plain).unwrap();
    let expected: Vec<[f32; 3]> = {
        let of = |mesh: &Mesh| {
            let mut seen = BTreeSet::new();
            let used = mesh.slot(Slot::Inside).iter().flatten().filter(|i| seen.insert(**i)).copied();
            let number = |i: u32| {
                let History { age, mouth_distance, mode_1 } = mesh.vertices[i as usize].history;
                [age, mouth_distance, mode_1].map(|x| x as f32)
            };
            used.collect::<Vec<_>>().into_iter().map(number).collect::<Vec<_>>()
        };
        meshes.parts[0].1.iter().flat_map(of).collect()
    };
    let sample = Sample { scene, frame, meshes };
    let formats = [Format::Glb, Format::Ply, Format::Usda, Format::Vtk];
    let records = sample.write(&Folder::new(folder.path()), &formats).unwrap();
    let (document, buffers, _) = gltf::import(&records[0].path).unwrap();
    let mut found: Vec<[f32; 3]> = Vec::new();
    for primitive in document.meshes().flat_map(|mesh| mesh.primitives().collect::<Vec<_>>()) {
        if let Some(accessor) = primitive.get(&gltf::Semantic::Extras("CRACK".into())) {
            found.extend(gltf::accessor::Iter::<[f32; 3]>::new(accessor, |b| Some(&buffers[b.index()])).unwrap());
        }
    }
    assert_eq!(found, expected);
    let bytes = std::fs::read(&records[1].path).unwrap();
    let ply = Parser::<DefaultElement>::new().read_ply(&mut bytes.as_slice()).unwrap();
    let float = |vertex: &DefaultElement, name: &str| if let Property::Float(x) = vertex[name] { x } else { f32::NAN };
    let names = Attribute::ALL.map(Attribute::name);
    let [walls, others]: [Vec<&DefaultElement>; 2] =
        [1.0, 0.0].map(|slot| ply.payload["vertex"].iter().filter(|v| float(v, "slot") == slot).collect());
    let found: Vec<[f32; 3]> = walls.iter().map(|v| names.map(|name| float(v, name))).collect();
    assert_eq!(found, expected);
    assert!(others.iter().all(|v| names.map(|name| float(v, name)) == [0.0; 3]));
    for record in &records[2..] {
        let text = String::from_utf8_lossy(&std::fs::read(&record.path).unwrap()).into_owned();
        assert!(names.iter().all(|name| text.contains(name)), "{}", record.file);
    }
}

/// Truth: what is asked for, and what is known.
#[test]
fn attributes_are_there_where_they_are_asked_for_and_known() {
    let (scene, mut frame) = halves(20.0, [(0.0, Vector::zeros()), (0.3, Vector::new(3.0, 0.5))]);
    let asked = PostOptions { attributes: vec![Attribute::Mode1, Attribute::Mode1], ..options(&scene) };
    let of = |frame: &Frame, options: &PostOptions| {
        post_frame(&scene, frame, options).unwrap().parts[0].1[0].attributes.clone()
    };
    assert_eq!(of(&frame, &options(&scene)), []);
    assert_eq!(of(&frame, &asked), [Attribute::Mode1]);
    frame.cracks[0].formed = None;
    assert_eq!(of(&frame, &asked), []);
}

/// Truth: the frame, whose particles have 7 kg per metre of thickness, and the thickness that is asked for, .3 m in the
/// scene. A frame that knows no mass has none.
#[test]
fn particles_of_vtk_files_weigh_as_much_as_the_body_is_thick() {
    let mut sample = sample(1);
    sample.frame.particles.mass = Some(vec![7.0; sample.frame.particles.len()]);
    let of = |sample: &Sample, thickness: f64| {
        let options = PostOptions { thickness, parts: vec![Part::Particles], ..options(&sample.scene) };
        let meshes = post_frame(&sample.scene, &sample.frame, &options).unwrap();
        let shot = meshes.shots(&sample.scene, &sample.frame).next().unwrap();
        encode(Format::Vtk, &shot).unwrap()
    };
    for thickness in [0.3, 2.0] {
        let bytes = of(&sample, thickness);
        let text = String::from_utf8_lossy(&bytes);
        let (_, after) = text.split_once("Name=\"mass\"").unwrap();
        let offset: usize = after.split('"').nth(3).unwrap().parse().unwrap();
        let mark = b"<AppendedData encoding=\"raw\">\n_";
        let data = bytes.windows(mark.len()).position(|w| w == mark).unwrap() + mark.len() + offset;
        let number = |k: usize| f64::from_le_bytes(bytes[data + 8 * k + 8..][..8].try_into().unwrap());
        let masses: Vec<f64> = (0..sample.frame.particles.len()).map(number).collect();
        assert_eq!(masses, vec![7.0 * thickness; masses.len()]);
    }
    sample.frame.particles.mass = None;
    assert!(!String::from_utf8_lossy(&of(&sample, 1.0)).contains("mass"));
}

#[test]
fn the_manifest_does_not_depend_on_the_order_of_the_frames() {
    let folder = tempfile::tempdir().unwrap();
    let inside = Folder::new(folder.path());
    let text = |order: [i64; 3]| {
        let mut manifest = Manifest::default();
        for number in order {
            manifest.add(sample(number).write(&inside, &[Format::Glb, Format::Ply]).unwrap());
        }
        std::fs::read_to_string(manifest.write(&inside, &sample(1).meshes.provenance).unwrap()).unwrap()
    };
    let written = text([1, 2, 10]);
    assert_eq!(written, text([10, 1, 2]));
    let value: serde_json::Value = serde_json::from_str(&written).unwrap();
    let files = value["files"].as_array().unwrap();
    assert_eq!(files.len(), 3 * 3 * 2);
    let frames: Vec<i64> = files.iter().map(|f| f["frame"].as_i64().unwrap()).collect();
    assert!(frames.is_sorted(), "{frames:?}");
    assert_eq!(files[0]["file"], "glass.0001.glb");
    assert!((files[0]["volume"].as_f64().unwrap() - files[0]["area"].as_f64().unwrap() * 0.3).abs() < 1e-4);
    // Nothing half-written stays behind.
    assert_eq!(inside.names().unwrap().len(), files.len() + 1);
}

/// Truth: the options. What cracks have no part in has neither, and nothing is said of what there is none of.
#[test]
fn the_manifest_tells_of_bevels_and_roughness() {
    let folder = tempfile::tempdir().unwrap();
    let rough = Roughness { amplitude: 0.01, length: 0.1, seed: 1 };
    for (bevel, roughness, expected) in
        [(0.0, None, [None, None]), (0.02, None, [Some(0.02), None]), (0.0, Some(rough), [None, Some(0.01)])]
    {
        let mut sample = sample(1);
        let parts = vec![Part::Cracked, Part::Particles];
        let options = PostOptions { bevel, roughness, parts, ..options(&sample.scene) };
        sample.meshes = post_frame(&sample.scene, &sample.frame, &options).unwrap();
        let records = sample.write(&Folder::new(folder.path()), &[Format::Glb]).unwrap();
        let told = |record: &FileRecord| {
            let value = serde_json::to_value(record).unwrap();
            ["bevel", "roughness"].map(|key| value.get(key).map(|number| number.as_f64().unwrap()))
        };
        assert_eq!(records.iter().map(told).collect::<Vec<_>>(), [expected, [None, None]]);
    }
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let missing = tempfile::tempdir().unwrap().path().join("missing");
    let error = sample(1).write(&Folder::new(&missing), &[Format::Glb]).unwrap_err();
    let WriteError::File(told) = &error else { panic!("{error}") };
    assert_eq!(told.path, missing.join("glass.0001.glb"));
    assert!(error.to_string().contains("glass.0001.glb`: "), "{error}");
}

/// Files that somebody else made, under the names that ours would have.
#[test]
fn files_of_others_are_neither_replaced_nor_removed() {
    let folder = tempfile::tempdir().unwrap();
    let inside = Folder::new(folder.path());
    let sample = sample(1);
    let formats = [Format::Glb, Format::Ply];
    let mut manifest = Manifest::default();
    manifest.add(sample.write(&inside, &formats).unwrap());
    manifest.write(&inside, &sample.meshes.provenance).unwrap();
    let listed = inside.read("manifest.json").unwrap().unwrap();

    // Ours are replaced, and so is what a power cut leaves of them.
    for left in [&[][..], &[0; 512]] {
        inside.write("glass.0001.ply", left).unwrap();
        sample.write(&inside, &formats).unwrap();
        assert!(inside.read("glass.0001.ply").unwrap().unwrap().starts_with(b"ply"));
    }

    // As another program would save them again.
    let mut glb = inside.read("glass.0001.glb").unwrap().unwrap();
    while let Some(at) = glb.windows(8).position(|w| w == b"fissure ") {
        glb[at..at + 8].copy_from_slice(b"Blender ");
    }
    let ply = b"ply\nformat ascii 1.0\ncomment made by hand\nend_header\ncomment fissure 1\n".to_vec();
    for (name, theirs) in
        [("glass.0001.glb", glb), ("glass.0001.ply", ply), ("glass_particles.0001.ply", b"x".to_vec())]
    {
        let ours = inside.read(name).unwrap().unwrap();
        inside.write(name, &theirs).unwrap();
        let error = sample.write(&inside, &formats).unwrap_err();
        assert!(matches!(&error, WriteError::Foreign { path } if path.ends_with(name)), "{error}");
        Manifest::remove_meshes(&inside, "glass").unwrap();
        assert_eq!(inside.read(name).unwrap().unwrap(), theirs);
        assert_eq!(inside.names().unwrap(), [name]);
        inside.write(name, &ours).unwrap();
        sample.write(&inside, &formats).unwrap();
        inside.write("manifest.json", &listed).unwrap();
    }

    // A list that was made to reach elsewhere, or to name what is not of this scene, removes nothing there.
    let above = tempfile::tempdir().unwrap();
    let ours = inside.read("glass.0001.glb").unwrap().unwrap();
    std::fs::create_dir(above.path().join("meshes")).unwrap();
    std::fs::write(above.path().join("evil.0001.glb"), &ours).unwrap();
    let meshes = Folder::new(above.path().join("meshes"));
    meshes.write("other.0001.glb", &ours).unwrap();
    for name in ["../evil.0001.glb", "other.0001.glb"] {
        let steered = String::from_utf8(listed.clone()).unwrap().replace("glass.0001.glb", name);
        meshes.write("manifest.json", steered.as_bytes()).unwrap();
        Manifest::remove_meshes(&meshes, "glass").unwrap();
        assert!(above.path().join("evil.0001.glb").exists() && meshes.names().unwrap() == ["other.0001.glb"]);
    }

    // A list that is not ours.
    for theirs in ["{\"name\": \"a web page\"}", "{\"tool\": \"webpack\", \"files\": []}", "[]", "\0"] {
        meshes.write("manifest.json", theirs.as_bytes()).unwrap();
        assert!(Manifest::remove_meshes(&meshes, "glass").is_err() && Manifest::read(&meshes, "glass", "").is_err());
        assert!(manifest.write(&meshes, &sample.meshes.provenance).is_err(), "{theirs}");
        assert_eq!(meshes.read("manifest.json").unwrap().unwrap(), theirs.as_bytes());
    }
}

/// All formats alike: a file of ours is replaced and removed, one of others is neither, and what goes with a sequence
/// is there.
#[test]
fn every_format_knows_its_own_files() {
    let folder = tempfile::tempdir().unwrap();
    let inside = Folder::new(folder.path());
    let samples = [sample(1), sample(12)];
    let write = || {
        let mut manifest = Manifest::default();
        for sample in &samples {
            manifest.add(sample.write(&inside, &Format::ALL)?);
        }
        write_companions(&inside, &samples[0].scene, &samples[0].meshes.provenance.tool, &mut manifest)?;
        let scene = &samples[0].scene;
        let mut sequences = Sequences::new(scene, &[Part::Cracked, Part::Particles], &Format::ALL);
        for sample in &samples {
            sequences.add(&sample.frame, &sample.meshes)?;
        }
        sequences.write(&inside, &mut manifest)?;
        manifest.write(&inside, &samples[0].meshes.provenance)
    };
    write().unwrap();
    write().unwrap();
    let names = inside.names().unwrap();
    // Three parts in two frames; the SVG shows one of them.
    let frames = |extension: &str| names.iter().filter(|name| name.ends_with(&format!("1.{extension}"))).count();
    assert_eq!(["glb", "ply", "obj", "usda", "vtp", "vtu", "svg"].map(frames), [3, 3, 3, 3, 2, 1, 1]);
    for name in [
        "glass.usda",
        "glass.clips.usda",
        "glass_particles.pvd",
        "glass.mtl",
        "glass_collider.usda",
        "glass_particles.glb",
        "glass.rigid.glb",
    ] {
        assert!(names.iter().any(|n| n == name), "{name} among {names:?}");
    }
    for name in names.iter().filter(|name| *name != "manifest.json") {
        let ours = inside.read(name).unwrap().unwrap();
        // What another program would have written instead.
        let theirs: Vec<u8> = String::from_utf8_lossy(&ours).replace("fissure ", "another ").into_bytes();
        inside.write(name, &theirs).unwrap();
        let error = write().unwrap_err();
        assert!(matches!(&error, WriteError::Foreign { path } if path.ends_with(name)), "{name}: {error}");
        inside.write(name, &ours).unwrap();
    }
    write().unwrap();
    inside.write("glass.mtl", b"newmtl brick").unwrap();
    Manifest::remove_meshes(&inside, "glass").unwrap();
    assert_eq!(inside.names().unwrap(), ["glass.mtl"]);
}
