//! Takes: frames come back bit for bit, equal frames give equal bytes, and damage is told.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use fissure_scene::*;
use std::path::Path;

fn scene() -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pull.toml");
    std::fs::write(&path, template()).unwrap();
    load(&path, &["solver.crack_friction=inf".into()]).unwrap()
}

fn provenance() -> Provenance {
    Provenance { tool_version: "0.1.0".into(), seed: 7 }
}

/// A frame in which every number differs, some of them hard to write as text.
fn frame(number: i64) -> Frame {
    let mut count = 0.0;
    let mut next = || {
        count += 1.0;
        (number as f64 + 0.1) / 3.0 * count
    };
    let n = 5;
    let point = |f: &mut dyn FnMut() -> f64| Point::new(f(), f());
    let mut points = |m: usize| (0..m).map(|_| point(&mut next)).collect::<Vec<_>>();
    let vectors = |p: Vec<Point>| p.into_iter().map(|p| p.coords).collect::<Vec<_>>();
    let matrices = |p: Vec<Point>| p.into_iter().map(|p| Matrix::new(p.x, p.y, -p.x, 2.0 * p.y)).collect::<Vec<_>>();
    Frame {
        number,
        time: number as f64 / 3.0,
        particles: ParticleFrame {
            id: (0..n as u32).collect(),
            body: vec![0; n],
            piece: vec![u32::MAX; n],
            rest: points(n),
            position: points(n),
            velocity: vectors(points(n)),
            deformation_gradient: matrices(points(n)),
            cauchy_stress: matrices(points(n)),
        },
        outlines: [3, 0, 4]
            .into_iter()
            .enumerate()
            .map(|(ring, m)| OutlineFrame {
                body: 0,
                ring: ring as u32,
                rest: points(m),
                position: points(m),
                velocity: vectors(points(m)),
            })
            .collect(),
        cracks: vec![CrackFrame {
            crack: 0,
            body: 0,
            rest: points(3),
            above: points(3),
            below: points(3),
            above_velocity: vectors(points(3)),
            below_velocity: vectors(points(3)),
            start: CrackEnd::Mouth,
            end: CrackEnd::Junction { crack: 4 },
        }],
        tips: vec![TipRecord {
            crack: 0,
            end: End::End,
            state: TipState::GuideEnded,
            position: Point::new(-0.0, f64::MIN_POSITIVE),
            direction: 0.1,
            j_integral: 0.2,
            mode_1: 1e6,
            mode_2: -1e-300,
            kink_angle: 0.3,
            equivalent: 0.4,
            fracture_toughness: 0.5,
            speed: 0.6,
            length: 0.7,
            contour_radius: 0.8,
            radius_shrunk: true,
        }],
        energies: Energies { kinetic: 1.0, strain: 2.0, external_work: 3.0, crack: 4.0 },
        colliders: vec![Pose { position: Point::new(1.0, 2.0), angle: 0.25 }],
    }
}

fn listing(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap())
        .map(|e| (e.file_name().into_string().unwrap(), std::fs::read(e.path()).unwrap()))
        .collect();
    files.sort();
    files
}

#[test]
fn frames_come_back_bit_for_bit() {
    for frame in [frame(3), Frame::default()] {
        let bytes = frame_to_bytes(&frame).unwrap();
        assert_eq!(bytes, frame_to_bytes(&frame.clone()).unwrap());
        let back = frame_from_bytes(&bytes).unwrap();
        assert_eq!(back, frame);
        // Also the sign of zero, which `==` does not see.
        assert_eq!(frame_to_bytes(&back).unwrap(), bytes);
        for cut in [0, 7, bytes.len() / 2, bytes.len() - 1] {
            assert!(frame_from_bytes(&bytes[..cut]).is_err());
        }
    }
    let mut uneven = frame(1);
    uneven.particles.body.pop();
    assert!(frame_to_bytes(&uneven).unwrap_err().contains("lengths"));
}

#[test]
fn a_resumed_take_equals_an_uninterrupted_one() {
    let scene = scene();
    let (whole, broken) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let mut writer = TakeWriter::create(whole.path(), &scene, provenance()).unwrap();
    (1..=4).for_each(|n| writer.write_frame(&frame(n)).unwrap());
    writer.write_state(b"state 4", 4).unwrap();
    writer.finish().unwrap();

    let mut writer = TakeWriter::create(broken.path(), &scene, provenance()).unwrap();
    (1..=2).for_each(|n| writer.write_frame(&frame(n)).unwrap());
    writer.write_state(b"state 2", 2).unwrap();
    writer.write_frame(&frame(3)).unwrap();
    drop(writer);
    // As if the power went off in the middle of a row.
    let tips = broken.path().join("tips.csv");
    let text = std::fs::read_to_string(&tips).unwrap();
    std::fs::write(&tips, &text[..text.len() - 5]).unwrap();

    let (mut writer, state) = TakeWriter::resume(broken.path(), &scene, provenance()).unwrap();
    assert_eq!(state, Some(SavedState { frame: 2, bytes: b"state 2".to_vec() }));
    assert_eq!(Take::open(broken.path()).unwrap().frame_numbers(), [1, 2]);
    (3..=4).for_each(|n| writer.write_frame(&frame(n)).unwrap());
    writer.write_state(b"state 4", 4).unwrap();
    writer.finish().unwrap();
    assert_eq!(listing(whole.path()), listing(broken.path()));

    let take = Take::open(whole.path()).unwrap();
    assert!(take.is_complete());
    assert_eq!(take.scene(), &scene);
    assert_eq!(take.frame(3).unwrap(), frame(3));
    assert_eq!(listing(whole.path()).len(), 4 + 4);
    let energy = std::fs::read_to_string(whole.path().join("energy.csv")).unwrap();
    assert_eq!(energy.lines().count(), 5);
}

#[test]
fn without_a_usable_state_a_take_begins_anew() {
    let scene = scene();
    let folder = tempfile::tempdir().unwrap();
    let mut writer = TakeWriter::create(folder.path(), &scene, provenance()).unwrap();
    writer.write_frame(&frame(1)).unwrap();
    writer.write_state(b"state", 1).unwrap();
    let state = folder.path().join("state.bin");
    let mut bytes = std::fs::read(&state).unwrap();
    bytes.pop();
    std::fs::write(&state, bytes).unwrap();
    assert!(Take::open(folder.path()).unwrap().state().unwrap_err().to_string().contains("state.bin"));
    let (_, saved) = TakeWriter::resume(folder.path(), &scene, provenance()).unwrap();
    assert_eq!(saved, None);
    assert!(Take::open(folder.path()).unwrap().frame_numbers().is_empty());
    assert!(!folder.path().join("frame.0001.safetensors").exists());

    let mut other = scene.clone();
    other.growth.bending = 2.0;
    let error = TakeWriter::resume(folder.path(), &other, provenance()).unwrap_err();
    assert!(matches!(error, TakeError::OtherScene { .. }), "{error}");
}

/// Each mistake names the file and a remedy.
#[test]
fn damage_is_told() {
    let scene = scene();
    let folder = tempfile::tempdir().unwrap();
    let told = |error: TakeError, words: &[&str]| {
        let told = error.to_string();
        words.iter().for_each(|word| assert!(told.contains(word), "`{word}` is missing in: {told}"));
    };
    told(Take::open(&folder.path().join("none")).unwrap_err(), &["none", "not a take", "fissure"]);
    let mut writer = TakeWriter::create(folder.path(), &scene, provenance()).unwrap();
    writer.write_frame(&frame(1)).unwrap();
    let take = Take::open(folder.path()).unwrap();
    told(take.frame(9).unwrap_err(), &["no frame 9", "1 to 1"]);
    let file = folder.path().join("frame.0001.safetensors");
    let bytes = std::fs::read(&file).unwrap();
    std::fs::write(&file, &bytes[..bytes.len() - 9]).unwrap();
    told(take.frame(1).unwrap_err(), &["frame.0001", "damaged", "again"]);
    std::fs::remove_file(&file).unwrap();
    told(take.frame(1).unwrap_err(), &["frame.0001", "cannot read"]);

    let manifest = folder.path().join("manifest.json");
    let text = std::fs::read_to_string(&manifest).unwrap();
    std::fs::write(&manifest, text.replacen("\"version\": 1", "\"version\": 99", 1)).unwrap();
    told(Take::open(folder.path()).unwrap_err(), &["manifest.json", "version 99", "version 1"]);
    std::fs::write(&manifest, text.replace("frame.0001", "../../frame.0001")).unwrap();
    told(Take::open(folder.path()).unwrap_err(), &["damaged", "../../frame"]);
    std::fs::write(&manifest, "{\"name\": \"a web page\"}").unwrap();
    told(Take::open(folder.path()).unwrap_err(), &["not a take"]);
    // A folder with somebody else's manifest is not written to.
    told(TakeWriter::create(folder.path(), &scene, provenance()).unwrap_err(), &["not a take"]);
    // A file where the folder should be.
    told(TakeWriter::create(&manifest, &scene, provenance()).unwrap_err(), &["manifest.json", "choose another"]);
}
