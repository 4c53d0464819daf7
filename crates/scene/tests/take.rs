//! Takes: frames come back bit for bit, equal frames give equal bytes, and damage is told.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::take::{frame, listing, provenance, scene};
use fissure_files::Folder;
use fissure_scene::*;

#[test]
fn frames_come_back_bit_for_bit() {
    // Takes of older versions do not say how cracks formed and what particles weigh.
    let mut older = frame(3);
    older.cracks[0].formed = None;
    older.particles.mass = None;
    for frame in [frame(3), older, Frame::default()] {
        let at_rest = ParticlesAtRest::of(&frame.particles);
        let kept_apart = ParticlesAtRest::from_bytes(&at_rest.to_bytes().unwrap()).unwrap();
        assert_eq!(kept_apart, at_rest);
        for known in [None, Some(&kept_apart)] {
            let bytes = frame_to_bytes(&frame, Precision::Double, known).unwrap();
            assert_eq!(bytes, frame_to_bytes(&frame.clone(), Precision::Double, known).unwrap());
            let back = frame_from_bytes(&bytes, known).unwrap();
            assert_eq!(back, frame);
            // Also the sign of zero, which `==` does not see.
            assert_eq!(frame_to_bytes(&back, Precision::Double, known).unwrap(), bytes);
            for cut in [0, 7, bytes.len() / 2, bytes.len() - 1] {
                assert!(frame_from_bytes(&bytes[..cut], known).is_err());
            }
        }
    }
    let mut uneven = frame(1);
    uneven.particles.body.pop();
    let fault = FrameFault::UnequalLengths { part: FramePart::Particles, lengths: vec![5, 4, 5, 5, 5, 5, 5, 5, 5] };
    assert_eq!(frame_to_bytes(&uneven, Precision::Double, None), Err(FrameFileError::Frame(fault)));
}

/// What particles are at rest is written once; a frame that has others says so itself, and so does one that differs in
/// the last bit.
#[test]
fn what_never_changes_is_written_once() {
    let folder = tempfile::tempdir().unwrap();
    let mut frames: Vec<Frame> = (1..=4).map(frame).collect();
    let x = &mut frames[2].particles.rest[4].x;
    *x = f64::from_bits(x.to_bits() + 1);
    frames[3].particles = ParticleFrame::default();
    let mut writer = TakeWriter::open(&Folder::new(folder.path()), &scene(), provenance(), 9).unwrap().writer;
    frames.iter().for_each(|frame| writer.write_frame(frame, None).unwrap());
    let take = Take::open(folder.path()).unwrap();
    for frame in &frames {
        assert_eq!(take.frame(frame.number).unwrap(), *frame);
    }
    let has_rest = |number: i64| {
        let bytes = std::fs::read(folder.path().join(format!("frame.{number:04}.safetensors"))).unwrap();
        bytes.windows(14).any(|window| window == b"particles.rest")
    };
    assert_eq!([1, 2, 3, 4].map(has_rest), [false, false, true, true]);
}

/// Writes the frames of `numbers` into a new take; the last one with its state.
fn take_of(folder: &Folder, numbers: std::ops::RangeInclusive<i64>) {
    let last = *numbers.end();
    let opened = TakeWriter::open(folder, &scene(), provenance(), last).unwrap();
    assert_eq!(opened.start, Start::First);
    let mut writer = opened.writer;
    for number in numbers {
        let state = format!("state {number}");
        writer.write_frame(&frame(number), (number == last).then_some(state.as_bytes())).unwrap();
    }
}

/// Truth: what was written, and in which order things are on the disk.
#[test]
fn a_take_is_read_as_it_was_written() {
    let folder = tempfile::tempdir().unwrap();
    take_of(&Folder::new(folder.path()), 1..=4);
    let take = Take::open(folder.path()).unwrap();
    assert_eq!((take.scene(), take.frame_numbers()), (&scene(), vec![1, 2, 3, 4]));
    assert_eq!(take.frame(3).unwrap(), frame(3));
    assert!(!take.is_complete() && take.remarks().unwrap().is_empty());
    assert_eq!(listing(folder.path()).len(), 4 + 7);
    let energy = std::fs::read_to_string(folder.path().join("energy.csv")).unwrap();
    assert_eq!(energy.lines().count(), 5);
}

/// Truth: what the writer says that it holds, in full and half as many bytes.
#[test]
fn a_take_of_single_precision_is_read_as_it_is_held() {
    let bytes_of = |precision: Precision| {
        let folder = tempfile::tempdir().unwrap();
        let mut scene = scene();
        scene.take.precision = precision;
        let mut writer = TakeWriter::open(&Folder::new(folder.path()), &scene, provenance(), 9).unwrap().writer;
        let held = writer.held(frame(1));
        assert_eq!(held == frame(1), precision == Precision::Double);
        writer.write_frame(&held, None).unwrap();
        let take = Take::open(folder.path()).unwrap();
        assert_eq!(take.frame(1).unwrap(), held);
        take.frames()[0].files[0].bytes
    };
    // Twelve numbers of each of five particles, up to digits of offsets in the header.
    let less = bytes_of(Precision::Double) - bytes_of(Precision::Single);
    assert!(less.abs_diff(5 * 12 * 4) < 64, "{less}");
}

/// What is made of particles is refused where the take will have none, with the key that asks for it.
#[test]
fn what_is_made_of_particles_needs_them() {
    type Change = fn(&mut OutputSettings);
    let changes: [(&str, HeldParticles, Change); 5] = [
        ("output.parts", HeldParticles::Surface, |o| o.parts.push(Part::Particles)),
        ("output.formats", HeldParticles::Surface, |o| o.formats.push(Format::GlbRigid)),
        ("output.explode", HeldParticles::Surface, |o| o.explode = Some(Curve { points: vec![(0.0, 1.0)] })),
        ("output.cap_size", HeldParticles::Full, |o| o.surfaces.cap_size = Some(1.0)),
        ("output.cut", HeldParticles::Full, |o| o.surfaces.cut = Cut::Rest),
    ];
    for (key, least, change) in changes {
        for particles in [HeldParticles::None, HeldParticles::Surface, HeldParticles::Full] {
            let mut scene = scene();
            scene.take.particles = particles;
            scene.validate().unwrap();
            change(&mut scene.output);
            let refused = scene.validate().err().map(|fault| fault.path.to_string());
            assert_eq!(refused, (particles < least).then(|| key.to_owned()), "{particles:?}");
        }
    }
}

/// A scene that computes the same goes on in the same take, whose meshes follow the scene as it is now.
#[test]
fn what_the_frames_do_not_depend_on_may_change() {
    let folder = tempfile::tempdir().unwrap();
    let inside = Folder::new(folder.path());
    take_of(&inside, 1..=3);
    let mut edited = scene();
    edited.output.thickness = 7.0;
    edited.output.formats = vec![Format::Ply];
    edited.bodies[0].name = "pane".into();
    edited.frames.last = 3;
    edited.hash = edited.simulation_hash();
    assert_eq!(edited.hash, scene().hash);
    let opened = TakeWriter::open(&inside, &edited, provenance(), 3).unwrap();
    assert_eq!((opened.start, opened.remarks), (Start::Complete, vec![]));
    let take = Take::open(folder.path()).unwrap();
    assert_eq!((take.scene(), take.is_complete()), (&edited, true));
    // Longer: it goes on where it stopped.
    edited.frames.last = 9;
    let opened = TakeWriter::open(&inside, &edited, provenance(), 9).unwrap();
    assert_eq!(opened.start, Start::At(SavedState { frame: 3, bytes: b"state 3".to_vec() }));

    type Change = fn(&mut Scene);
    let changes: [(&str, Change); 7] = [
        ("growth", |s| s.growth.bending = 2.0),
        ("material", |s| s.materials[0].density *= 1.0 + f64::EPSILON),
        ("rate", |s| s.frames.rate = 25.0),
        ("first frame", |s| s.frames.first = 0),
        ("crack", |s| s.cracks[0].points[0].x += 1e-9),
        ("friction", |s| s.solver.crack_friction = 0.5),
        ("precision", |s| s.take.precision = Precision::Single),
    ];
    for (what, change) in changes {
        let mut other = scene();
        change(&mut other);
        other.hash = other.simulation_hash();
        let before = listing(folder.path());
        let error = TakeWriter::open(&inside, &other, provenance(), 9).unwrap_err();
        assert!(matches!(error, TakeError::OtherScene { .. }), "{what}: {error}");
        assert_eq!(before, listing(folder.path()), "{what}");
    }
}

/// Whatever cannot go on is told and stays as it is; what was begun anew on purpose replaces what is of a take and no
/// more.
#[test]
fn what_cannot_go_on_is_told_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    let inside = Folder::new(folder.path());
    take_of(&inside, 1..=3);
    std::fs::write(folder.path().join("thesis.txt"), "years of work").unwrap();
    std::fs::write(folder.path().join("frame.0002.txt"), "years of work").unwrap();
    std::fs::write(folder.path().join("frame.0077.safetensors"), "years of work").unwrap();
    let whole = listing(folder.path());
    let refused = |what: &str, provenance: Provenance, words: &[&str]| {
        let before = listing(folder.path());
        let error = TakeWriter::open(&inside, &scene(), provenance, 9).unwrap_err();
        let told = format!("{error}; {}", error.remedy());
        words.iter().for_each(|word| assert!(told.contains(word), "{what}: `{word}` is missing in: {told}"));
        assert_eq!(before, listing(folder.path()), "{what}");
    };
    let newer = Provenance { tool_version: "0.2.0".into(), ..provenance() };
    refused("another version", newer.clone(), &["0.1.0", "0.2.0", "--overwrite"]);
    // With nothing left to compute any version will do.
    assert_eq!(TakeWriter::open(&inside, &scene(), newer, 3).unwrap().start, Start::Complete);

    let state = inside.read("state.bin").unwrap().unwrap();
    for (what, bytes) in [
        ("cut off", &state[..state.len() - 1]),
        ("shorter than its head", &state[..20]),
        ("empty", b""),
        ("not one of ours", b"PK\x03\x04 a zip file"),
    ] {
        inside.write("state.bin", bytes).unwrap();
        refused(what, provenance(), &["state.bin", "damaged", "remove the state", "--overwrite"]);
        // When nothing is to be computed it is told, and does no harm.
        let opened = TakeWriter::open(&inside, &scene(), provenance(), 3).unwrap();
        assert_eq!(opened.start, Start::Complete, "{what}");
        assert!(matches!(opened.remarks[..], [Remark::UnusableState(_)]), "{what}");
    }
    let list = inside.read("frames.jsonl").unwrap().unwrap();
    let first = list.iter().position(|&byte| byte == b'\n').unwrap() + 1;
    inside.write("state.bin", &state).unwrap();
    inside.write("frames.jsonl", &list[..first]).unwrap();
    refused("a state newer than the frames", provenance(), &["frame 3", "holds frame 1", "remove the state"]);
    inside.write("frames.jsonl", &list[first..]).unwrap();
    refused("a list without its first line", provenance(), &["frames.jsonl", "damaged", "frame 2"]);
    inside.write("frames.jsonl", &list).unwrap();
    assert_eq!(whole, listing(folder.path()));

    let mut writer = TakeWriter::replace(&inside, &scene(), provenance()).unwrap();
    let names: Vec<_> = listing(folder.path()).into_iter().map(|(name, _)| name).collect();
    let begun = [
        "energy.csv",
        "frame.0002.txt",
        "frame.0077.safetensors",
        "frames.jsonl",
        "manifest.json",
        "supports.csv",
        "thesis.txt",
        "tips.csv",
    ];
    assert_eq!(names, begun);
    // Nor is a file replaced that is no frame.
    std::fs::write(folder.path().join("frame.0001.safetensors"), "years of work").unwrap();
    assert!(matches!(writer.write_frame(&frame(1), None), Err(TakeError::Foreign { .. })));
}

/// Frames that are there already are computed again and compared, those that are missing come back.
#[test]
fn frames_that_are_missing_come_back_and_others_are_compared() {
    let folder = tempfile::tempdir().unwrap();
    let inside = Folder::new(folder.path());
    take_of(&inside, 1..=4);
    let whole = listing(folder.path());
    inside.remove("frame.0002.safetensors").unwrap();
    let opened = TakeWriter::open(&inside, &scene(), provenance(), 4).unwrap();
    assert_eq!((opened.start, opened.remarks), (Start::First, vec![Remark::MissingFrame(2)]));
    let mut writer = opened.writer;
    let mut other = frame(1);
    other.energies.kinetic = 7.0;
    let error = writer.write_frame(&other, None).unwrap_err();
    assert!(matches!(error, TakeError::OtherFrame { number: 1, .. }), "{error}");
    // A changed file of a frame that is computed again is mended.
    let mut bytes = inside.read("frame.0001.safetensors").unwrap().unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    inside.write("frame.0001.safetensors", &bytes).unwrap();
    for number in 1..=4 {
        let state = format!("state {number}");
        writer.write_frame(&frame(number), (number == 4).then_some(state.as_bytes())).unwrap();
    }
    assert_eq!(whole, listing(folder.path()));
}

/// Flips bits all over every file of a take. Truth: reading tells of each, and reading what is whole tells of nothing.
#[test]
fn every_flipped_bit_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let inside = Folder::new(folder.path());
    take_of(&inside, 1..=2);
    let noticed = || {
        let Ok(take) = Take::open(folder.path()) else { return true };
        let frames = take.frame_numbers().into_iter().all(|number| take.frame(number).is_ok());
        !frames || take.frame_numbers() != [1, 2] || !take.remarks().unwrap().is_empty()
    };
    assert!(!noticed());
    for (name, bytes) in listing(folder.path()) {
        // Every bit of the beginning and of the end, and some 400 between.
        let bits = 8 * bytes.len();
        let between = (64 * 8..bits.saturating_sub(64 * 8)).step_by((bits / 400).max(1) | 1);
        let ends = (0..bits.min(64 * 8)).chain(bits.saturating_sub(64 * 8)..bits);
        for bit in ends.chain(between) {
            let mut flipped = bytes.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            std::fs::write(folder.path().join(&name), flipped).unwrap();
            assert!(noticed(), "{name}, bit {bit} of {bits}");
        }
        std::fs::write(folder.path().join(&name), bytes).unwrap();
    }
}

/// Tables hold nothing that is not in the frames.
#[test]
fn torn_and_changed_tables_are_made_anew() {
    let folder = tempfile::tempdir().unwrap();
    let inside = Folder::new(folder.path());
    take_of(&inside, 1..=3);
    let whole = listing(folder.path());
    for name in ["tips.csv", "energy.csv", "supports.csv"] {
        let text = inside.read(name).unwrap().unwrap();
        let mut changed = text.clone();
        changed[text.len() / 2] ^= 1;
        let longer = [&text[..], b"4,1e0,"].concat();
        for (what, bytes) in
            [("torn", &text[..text.len() - 3]), ("empty", b""), ("changed", &changed), ("longer", &longer)]
        {
            inside.write(name, bytes).unwrap();
            let opened = TakeWriter::open(&inside, &scene(), provenance(), 3).unwrap();
            let told = if what == "longer" { vec![] } else { vec![Remark::TableMadeAnew(name)] };
            assert_eq!((opened.start, opened.remarks), (Start::Complete, told), "{what}");
            assert_eq!(whole, listing(folder.path()), "{what}");
        }
        inside.remove(name).unwrap();
        TakeWriter::open(&inside, &scene(), provenance(), 3).unwrap();
        assert_eq!(whole, listing(folder.path()), "missing");
    }
}

/// Each mistake names the file and a remedy.
#[test]
fn damage_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let inside = Folder::new(folder.path());
    let told = |error: TakeError, words: &[&str]| {
        let told = format!("{error}; {}", error.remedy());
        words.iter().for_each(|word| assert!(told.contains(word), "`{word}` is missing in: {told}"));
    };
    told(Take::open(&folder.path().join("none")).unwrap_err(), &["none", "not a take", "fissure"]);
    take_of(&inside, 1..=1);
    let take = Take::open(folder.path()).unwrap();
    told(take.frame(9).unwrap_err(), &["no frame 9", "holds frame 1"]);
    let file = folder.path().join("frame.0001.safetensors");
    let bytes = std::fs::read(&file).unwrap();
    std::fs::write(&file, &bytes[..bytes.len() - 9]).unwrap();
    told(take.frame(1).unwrap_err(), &["frame.0001", "damaged", "again"]);
    std::fs::remove_file(&file).unwrap();
    told(take.frame(1).unwrap_err(), &["frame.0001", "missing", "again"]);

    let manifest = folder.path().join("manifest.json");
    let text = std::fs::read_to_string(&manifest).unwrap();
    std::fs::write(&manifest, text.replacen("\"version\": 5", "\"version\": 99", 1)).unwrap();
    told(Take::open(folder.path()).unwrap_err(), &["manifest.json", "version 99", "versions 3 to 5", "--overwrite"]);
    std::fs::write(&manifest, text.replacen("\"seed\": 7", "\"seed\": 8", 1)).unwrap();
    told(Take::open(folder.path()).unwrap_err(), &["manifest.json", "checksum", "--overwrite"]);
    std::fs::write(&manifest, "{\"name\": \"a web page\"}").unwrap();
    told(Take::open(folder.path()).unwrap_err(), &["not a take"]);
    // A folder with somebody else's manifest is not written to, nor one with a table of somebody else.
    type Open = fn(&Folder) -> Result<(), TakeError>;
    let ways: [Open; 2] = [
        |f| TakeWriter::open(f, &scene(), provenance(), 9).map(drop),
        |f| TakeWriter::replace(f, &scene(), provenance()).map(drop),
    ];
    for open in ways {
        told(open(&inside).unwrap_err(), &["not a take", "--output"]);
        let other = tempfile::tempdir().unwrap();
        std::fs::write(other.path().join("tips.csv"), "years of work").unwrap();
        told(open(&Folder::new(other.path())).unwrap_err(), &["tips.csv", "in the way"]);
        assert_eq!(listing(other.path()).len(), 1);
    }
    // A file where the folder should be.
    told(
        TakeWriter::open(&Folder::new(&manifest), &scene(), provenance(), 9).unwrap_err(),
        &["manifest.json", "another place"],
    );
}

/// A manifest that was made to steer who reads it out of the folder, its checksum right.
#[test]
fn a_take_cannot_reach_out_of_its_folder() {
    for name in
        ["../evil", "/x", "..", ".", "", " ", "a\nb", "a/b", "a\\b", "CON", "nul.txt", "com1", "a.", "a ", "a:b"]
    {
        let mut steered = scene();
        steered.name = name.into();
        let folder = tempfile::tempdir().unwrap();
        let inside = Folder::new(folder.path());
        TakeWriter::open(&inside, &steered, provenance(), 1).unwrap();
        let error = Take::open(folder.path()).unwrap_err().to_string();
        assert!(error.contains("manifest.json") && error.contains("name"), "{name:?}: {error}");
    }
    for name in ["plate", "plate-2", "Größe 3", "com", "console", "a.b", ".hidden", &"x".repeat(120)] {
        let mut fine = scene();
        fine.name = name.into();
        assert_eq!(fine.validate(), Ok(()), "{name}");
    }
    let mut long = scene();
    long.name = "x".repeat(121);
    assert!(long.validate().is_err());
}
