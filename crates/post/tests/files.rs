//! Files read back by other readers.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{halves, options};
use fissure_post::{FrameMeshes, Manifest, post_frame, write_frame};
use fissure_scene::{Format, Part, UpAxis, Vector};
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};
use std::collections::BTreeSet;

fn sample(number: i64) -> FrameMeshes {
    let (scene, mut frame) = halves(20.0, [(0.0, Vector::zeros()), (0.3, Vector::new(3.0, 0.5))]);
    frame.number = number;
    let mut options = options(&scene);
    options.parts = vec![Part::Cracked, Part::Particles, Part::Collider];
    post_frame(&scene, &frame, &options).unwrap()
}

#[test]
fn a_glb_file_holds_what_the_mesh_holds() {
    let folder = tempfile::tempdir().unwrap();
    let sample = sample(1);
    let records = write_frame(folder.path(), "glass", &sample, &[Format::Glb]).unwrap();
    let names: Vec<&str> = records.iter().map(|r| r.file.as_str()).collect();
    assert_eq!(names, ["glass.0001.glb", "glass_particles.0001.glb", "glass_collider.0001.glb"]);

    let extras = |node: &gltf::Node<'_>| -> serde_json::Value {
        serde_json::from_str(node.extras().as_ref().unwrap().get()).unwrap()
    };
    let (document, buffers, _) = gltf::import(&records[0].path).unwrap();
    let meshes = &sample.parts[0].1;
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
    assert_eq!(sample.up, UpAxis::Z);
    let records = write_frame(folder.path(), "glass", &sample, &[Format::Ply]).unwrap();
    let bytes = std::fs::read(&records[0].path).unwrap();
    let ply = Parser::<DefaultElement>::new().read_ply(&mut bytes.as_slice()).unwrap();
    let (vertices, faces) = (&ply.payload["vertex"], &ply.payload["face"]);
    let float = |vertex: &DefaultElement, name: &str| match vertex[name] {
        Property::Float(x) => x,
        _ => panic!("{name} is not a float"),
    };
    let mut row = 0;
    for mesh in &sample.parts[0].1 {
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
                    assert_eq!(three(["vx", "vy", "vz"]), turned(made.velocity));
                    assert_eq!([float(vertex, "s"), float(vertex, "t")], made.texture.map(|x| x as f32));
                    assert_eq!([float(vertex, "piece"), float(vertex, "slot")], [mesh.piece as f32, slot]);
                }
            }
        }
    }
    assert_eq!(row, faces.len());
    assert!(ply.header.comments.iter().any(|c| c.contains(&"0".repeat(64))));
}

#[test]
fn the_manifest_does_not_depend_on_the_order_of_the_frames() {
    let folder = tempfile::tempdir().unwrap();
    let text = |order: [i64; 3]| {
        let mut manifest = Manifest::default();
        for number in order {
            manifest.add(write_frame(folder.path(), "glass", &sample(number), &[Format::Glb, Format::Ply]).unwrap());
        }
        std::fs::read_to_string(manifest.write(folder.path(), &sample(1).provenance).unwrap()).unwrap()
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
    let left =
        std::fs::read_dir(folder.path()).unwrap().filter(|e| e.as_ref().unwrap().path().extension().unwrap() == "part");
    assert_eq!(left.count(), 0);
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let missing = tempfile::tempdir().unwrap().path().join("missing");
    let error = write_frame(&missing, "glass", &sample(1), &[Format::Glb]).unwrap_err();
    assert_eq!(error.path, missing.join("glass.0001.glb"));
    assert!(error.to_string().contains("glass.0001.glb: "), "{error}");
}
