//! The program as its users meet it: the real binary, real files, exit codes and messages.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{assert_same_files, files, fissure, folder_with, names, run};
use fissure_tests::program::PLATE;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A folder to work in, with the scene `plate.toml`.
fn workplace() -> TempDir {
    folder_with("plate.toml", PLATE)
}

/// Exit code and everything that was said.
fn result(output: &Output) -> (i32, String) {
    let text = String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
    (output.status.code().unwrap_or(-1), text)
}

#[track_caller]
fn expect(output: &Output, code: i32) -> String {
    let (found, text) = result(output);
    assert!(!text.contains("panicked"), "{text}");
    assert_eq!(found, code, "{text}");
    text
}

// What is asked for is there.

#[test]
fn a_new_scene_checks_and_runs() {
    let folder = TempDir::new().unwrap();
    expect(&run(folder.path(), &["new", "mine"]), 0);
    let text = expect(&run(folder.path(), &["check", "mine/scene.toml"]), 0);
    for word in ["particles", "cells", "time step", "steps", "formulation", "expected time", "expected memory"] {
        assert!(text.contains(word), "{word} is missing:\n{text}");
    }
    assert_eq!(names(folder.path()), ["mine/scene.schema.json", "mine/scene.toml"], "check writes nothing");
    expect(
        &run(folder.path(), &["run", "mine/scene.toml", "--frames", "1-2", "--set", "grid.particle_spacing=0.5"]),
        0,
    );
    assert!(folder.path().join("out/mine/mine.0002.glb").is_file(), "{:?}", names(folder.path()));
}

#[test]
fn new_never_writes_over_a_scene() {
    let folder = workplace();
    expect(&run(folder.path(), &["new", "."]), 0);
    std::fs::write(folder.path().join("scene.toml"), "mine").unwrap();
    assert!(expect(&run(folder.path(), &["new"]), 3).contains("scene.toml"));
    assert_eq!(std::fs::read(folder.path().join("scene.toml")).unwrap(), b"mine");
}

/// A disk that takes no byte more: files may not grow, and the signal that would tell so is ignored.
#[cfg(unix)]
fn on_a_full_disk(folder: &Path, arguments: &str) -> Output {
    let command = format!("trap '' XFSZ; ulimit -f 0; exec {} {arguments}", env!("CARGO_BIN_EXE_fissure"));
    Command::new("bash").args(["-c", &command]).current_dir(folder).output().unwrap()
}

#[cfg(unix)]
#[test]
fn a_new_scene_on_a_full_disk_leaves_nothing() {
    let folder = TempDir::new().unwrap();
    let text = expect(&on_a_full_disk(folder.path(), "new mine"), 3);
    assert!(text.contains("mine/scene.toml") && text.contains("free some space"), "{text}");
    assert_eq!(names(folder.path()), [""; 0]);
    expect(&run(folder.path(), &["new", "mine"]), 0);
}

/// Truth: the first line of the scene names, relative to itself, a file that holds what `schema` prints.
#[test]
fn a_new_scene_names_the_schema_beside_it() {
    let folder = workplace();
    expect(&run(folder.path(), &["new", "mine"]), 0);
    let scene = std::fs::read_to_string(folder.path().join("mine/scene.toml")).unwrap();
    let named = scene.lines().next().unwrap().strip_prefix("#:schema ").unwrap();
    let schema = folder.path().join("mine").join(named);
    assert_eq!(std::fs::read(&schema).unwrap(), run(folder.path(), &["schema"]).stdout);
    // An older schema is made anew; a file of another kind is kept, and nothing is written beside it.
    std::fs::remove_file(folder.path().join("mine/scene.toml")).unwrap();
    std::fs::write(&schema, r#"{ "title": "Fissure scene" }"#).unwrap();
    expect(&run(folder.path(), &["new", "mine"]), 0);
    assert_eq!(std::fs::read(&schema).unwrap(), run(folder.path(), &["schema"]).stdout);
    std::fs::remove_file(folder.path().join("mine/scene.toml")).unwrap();
    std::fs::write(&schema, "years of work").unwrap();
    assert!(expect(&run(folder.path(), &["new", "mine"]), 3).contains("scene.schema.json"));
    assert_eq!(files(&folder.path().join("mine")).into_values().collect::<Vec<_>>(), [b"years of work"]);
}

#[test]
fn sim_then_post_gives_the_files_of_run() {
    let folder = workplace();
    expect(&run(folder.path(), &["run", "plate.toml", "--output", "a", "--formats", "glb,ply"]), 0);
    expect(&run(folder.path(), &["sim", "plate.toml", "--output", "b"]), 0);
    assert!(names(&folder.path().join("b")).iter().all(|name| name.starts_with("plate.take")));
    expect(&run(folder.path(), &["post", "b/plate.take", "--formats", "glb,ply"]), 0);
    assert_same_files(&folder.path().join("a"), &folder.path().join("b"));
    assert_eq!(names(&folder.path().join("a")).iter().filter(|name| name.ends_with(".glb")).count(), 12);
}

#[test]
fn post_sets_the_output_as_run_does() {
    let folder = workplace();
    let set = ["--set", "output.opening.least=0.01", "--set", "output.uv_in_metres=true", "--formats", "glb"];
    expect(&run(folder.path(), &[&["run", "plate.toml", "--output", "a"], &set[..]].concat()), 0);
    expect(&run(folder.path(), &["sim", "plate.toml", "--output", "b"]), 0);
    expect(&run(folder.path(), &[&["post", "b"], &set[..]].concat()), 0);
    let meshes = |name: &str| {
        let mut meshes = files(&folder.path().join(name));
        meshes.retain(|path, _| path.extension().is_some_and(|extension| extension == "glb"));
        meshes
    };
    assert!(meshes("a") == meshes("b") && meshes("a").len() == 12);
    let refused = expect(&run(folder.path(), &["post", "b", "--set", "grid.cell_size=1"]), 2);
    assert!(refused.contains("`grid.cell_size`") && refused.contains("--set output."), "{refused}");
}

#[test]
fn frames_are_chosen_and_the_simulation_goes_no_further() {
    let folder = workplace();
    expect(&run(folder.path(), &["run", "plate.toml", "--frames", "1-7x3", "--formats", "ply"]), 0);
    let written = names(folder.path());
    let meshes: Vec<_> = written.iter().filter(|name| name.ends_with(".ply")).collect();
    assert_eq!(meshes, ["out/plate/plate.0001.ply", "out/plate/plate.0004.ply", "out/plate/plate.0007.ply"]);
    assert!(!written.iter().any(|name| name.contains("0008")), "{written:?}");
    // The rest, later.
    expect(&run(folder.path(), &["run", "plate.toml", "--formats", "ply"]), 0);
    assert_eq!(names(folder.path()).iter().filter(|name| name.ends_with(".ply")).count(), 12);
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let folder = workplace();
    expect(&run(folder.path(), &["run", "plate.toml", "--output", "one", "--threads", "1"]), 0);
    expect(&run(folder.path(), &["run", "plate.toml", "--output", "two", "--threads", "2"]), 0);
    assert_same_files(&folder.path().join("one"), &folder.path().join("two"));
}

#[test]
fn the_log_for_programs_is_one_object_per_line() {
    let folder = workplace();
    let output = run(folder.path(), &["run", "plate.toml", "--log", "json"]);
    expect(&output, 0);
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(text.contains("\"event\":\"progress\""), "{text}");
    for line in text.lines() {
        let value: serde_json::Value = serde_json::from_str(line).unwrap_or_else(|e| panic!("{line}: {e}"));
        assert!(value["event"].is_string(), "{line}");
    }
    let output = run(folder.path(), &["check", "nothing.toml", "--log", "json"]);
    let value: serde_json::Value = serde_json::from_slice(&output.stderr).unwrap();
    assert_eq!((value["event"].as_str(), value["exit"].as_i64()), (Some("error"), Some(3)));
    let output = run(folder.path(), &["check", "plate.toml", "--log", "json"]);
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(value["particles"].as_i64(), Some(400));
}

/// Truth: the same rows as text and as Markdown, each with its target; what cannot be run is told before anything runs.
#[test]
fn verify_prints_what_a_case_found_beside_what_it_should() {
    let folder = workplace();
    let list = expect(&run(folder.path(), &["verify", "--list"]), 0);
    assert!(list.lines().any(|line| line.starts_with("three-holes ")), "{list}");
    let text = expect(&run(folder.path(), &["verify", "free-flight", "--cells", "5"]), 0);
    let table = expect(&run(folder.path(), &["verify", "free-flight", "--cells", "5", "--markdown"]), 0);
    for row in ["change of momentum, relative", "change of energy, relative"] {
        let of = |output: &str| output.lines().find(|line| line.contains(row)).map(|line| line.contains(": yes"));
        assert_eq!((of(&text), of(&table)), (Some(true), Some(true)), "{text}{table}");
    }
    assert!(text.contains(" particles at most, ") && table.contains("## `free-flight`"), "{text}{table}");
    for (arguments, words) in [
        (&["verify"][..], "no case named"),
        (&["verify", "free-fligth"], "there is no case `free-fligth`"),
        (&["verify", "free-flight", "--cells", "nan"], "the cells must be 4 to 1024"),
    ] {
        let told = expect(&run(folder.path(), arguments), 2);
        assert!(told.contains(words), "{told}");
    }
}

/// Truth: what does not depend on cells is the same with all, and what is said is also written.
#[test]
fn converge_holds_three_resolutions_against_each_other() {
    let folder = workplace();
    let arguments = ["converge", "plate.toml", "--set", "growth.enabled=false", "--csv", "tables/c.csv"];
    let text = expect(&run(folder.path(), &arguments), 0);
    assert!(text.contains("highest K_I before it grows") && !text.contains("begins to grow"), "{text}");
    let table = std::fs::read_to_string(folder.path().join("tables/c.csv")).unwrap();
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    assert!(rows.iter().all(|row| row.len() == 9), "{table}");
    let spacings: Vec<f64> = rows[1][2..5].iter().map(|cell| cell.parse().unwrap()).collect();
    assert_eq!((spacings[0] / spacings[1], spacings[1] / spacings[2]), (2.0, 2.0));
    let told = expect(&run(folder.path(), &["converge", "plate.toml", "--ratio", "1"]), 2);
    assert!(told.contains("the ratio must be 1.2 to 4"), "{told}");
    // What was written before is written anew; what others wrote is left alone, before anything is computed.
    std::fs::write(folder.path().join("drawn.svg"), "<svg/>").unwrap();
    for (files, words) in [
        (["--csv", "plate.toml", "--quiet"].as_slice(), "would write over a file that"),
        (&["--csv", "tables/c.csv", "--svg", "drawn.svg"], "would write over a file that"),
        (&["--svg", "tables"], "would write over a folder"),
        (&["--svg", "a", "--csv", "a"], "are one file, `a`"),
    ] {
        let told = expect(&run(folder.path(), &[&["converge", "plate.toml"], files].concat()), 2);
        assert!(told.contains(words), "{told}");
    }
    let drawn = std::fs::read_to_string(folder.path().join("drawn.svg")).unwrap();
    assert_eq!(drawn, "<svg/>");
}

#[test]
fn quiet_says_nothing_when_all_is_well() {
    let folder = workplace();
    let output = run(
        folder.path(),
        &["run", "plate.toml", "--quiet", "--set", "grid.particle_spacing=0.375", "--frames", "1-3"],
    );
    assert_eq!(expect(&output, 0), "");
}

/// Truth: the shells themselves, where they are installed; each script speaks of every command.
#[test]
fn shells_read_their_completions() {
    let folder = workplace();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = expect(&run(folder.path(), &["completions", shell]), 0);
        for word in ["new", "check", "verify", "completions", "overwrite"] {
            assert!(script.contains(word), "{shell}: {word} is missing");
        }
        let file = folder.path().join(shell);
        std::fs::write(&file, script).unwrap();
        // `-n`: read, do not run. Shells without it, or that are not here, are not asked.
        if ["bash", "zsh", "fish"].contains(&shell)
            && let Ok(output) = Command::new(shell).arg("-n").arg(&file).output()
        {
            assert!(output.status.success(), "{shell}: {}", String::from_utf8_lossy(&output.stderr));
        }
    }
    // What bash offers after a word, asked as bash asks.
    let ask = "source ./bash; COMP_WORDS=(fissure run --formats ''); COMP_CWORD=3; _fissure fissure '' --formats; echo ${COMPREPLY[*]}";
    let output = Command::new("bash").args(["-c", ask]).current_dir(folder.path()).output().unwrap();
    assert_eq!(
        String::from_utf8_lossy(&output.stdout).trim(),
        "glb ply obj usda vtk svg glb_sequence glb_rigid",
        "{output:?}"
    );
    assert!(expect(&run(folder.path(), &["completions", "cmd"]), 2).contains("powershell"));
}

/// Truth: one page of the program and of each command, with the words of `--help`; the same pages replace themselves.
#[test]
fn manual_pages_are_written_whole() {
    let folder = workplace();
    for _ in 0..2 {
        expect(&run(folder.path(), &["man", "share/man1"]), 0);
    }
    let pages = names(&folder.path().join("share/man1"));
    let help = expect(&run(folder.path(), &["--help"]), 0);
    let commands = help.lines().skip_while(|line| !line.starts_with("Commands:")).skip(1).map_while(|line| {
        let word = line.strip_prefix("  ")?.split_whitespace().next()?;
        Some(word.to_owned())
    });
    let expected: std::collections::BTreeSet<String> =
        commands.filter(|c| c != "help").map(|c| format!("fissure-{c}.1")).chain(["fissure.1".to_owned()]).collect();
    assert!(expected.len() > 8 && pages.iter().eq(&expected), "{pages:?} instead of {expected:?}");
    let page = std::fs::read_to_string(folder.path().join("share/man1/fissure-run.1")).unwrap();
    assert!(page.starts_with(".ie") || page.contains(".TH"), "{page}");
    assert!(page.contains("overwrite") && page.contains("Example"), "{page}");
    let told = expect(&run(folder.path(), &["man", "plate.toml/man1"]), 3);
    assert!(told.contains("plate.toml/man1"), "{told}");
}

#[cfg(unix)]
#[test]
fn a_reader_that_goes_away_is_no_error() {
    let folder = workplace();
    let command = format!("{} schema | head -c 1; exit ${{PIPESTATUS[0]}}", env!("CARGO_BIN_EXE_fissure"));
    let output = Command::new("bash").args(["-c", &command]).current_dir(folder.path()).output().unwrap();
    assert_eq!((output.status.code(), output.stderr.len()), (Some(0), 0), "{output:?}");
}

// Interruption.

/// Sends `signal` to `child` as soon as the file `sign` is there.
fn signal_when(child: &std::process::Child, sign: &Path, signal: &str) {
    let start = Instant::now();
    while !sign.exists() {
        assert!(start.elapsed() < Duration::from_secs(60), "{} never came", sign.display());
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
}

/// A run long enough to be interrupted, into the folder `output`: a third of a second on a fast machine, while a signal
/// takes some milliseconds to arrive.
fn long(output: &str) -> [&str; 6] {
    ["run", "plate.toml", "--set", "grid.particle_spacing=0.15", "--output", output]
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_resumes_to_the_same_bytes() {
    let folder = workplace();
    expect(&run(folder.path(), &long("whole")), 0);
    let mut interrupts = 0;
    let frame = |number: usize| folder.path().join(format!("parts/plate.take/frame.{number:04}.safetensors"));
    for _ in 0..3 {
        // A frame of this run, not of the one before: until it is there the program may not be listening yet.
        let Some(next) = (1..=12).find(|&number| !frame(number).exists()) else { break };
        let child =
            fissure(folder.path(), &long("parts")).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        signal_when(&child, &frame(next), "-INT");
        let output = child.wait_with_output().unwrap();
        if output.status.code() == Some(75) {
            interrupts += 1;
            let text = expect(&output, 75);
            assert!(text.contains("fissure run plate.toml --set grid.particle_spacing=0.15 --output parts"), "{text}");
        } else {
            expect(&output, 0);
        }
        // The take is readable and every mesh is complete, as another run of the program shows.
        expect(&run(folder.path(), &["post", "parts/plate.take", "--output", "again"]), 0);
        let again = files(&folder.path().join("again"));
        for (name, bytes) in files(&folder.path().join("parts")) {
            if name.extension().is_some_and(|e| e == "glb" || e == "ply") {
                assert!(again[&name] == bytes, "{} differs", name.display());
            }
        }
    }
    assert!(interrupts > 0, "the scene is too short to be interrupted");
    // A busy machine may bring a signal so late that the take has come to its end.
    let told = if frame(12).exists() { "holds all frames" } else { "resuming `parts/plate.take` after frame" };
    let text = expect(&run(folder.path(), &long("parts")), 0);
    assert!(text.contains(told), "{text}");
    assert_same_files(&folder.path().join("whole"), &folder.path().join("parts"));
}

#[cfg(unix)]
#[test]
fn a_killed_run_resumes_to_the_same_bytes() {
    let folder = workplace();
    expect(&run(folder.path(), &long("whole")), 0);
    let mut child = fissure(folder.path(), &long("parts")).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    signal_when(&child, &folder.path().join("parts/plate.take/frame.0002.safetensors"), "-KILL");
    assert_eq!(child.wait().unwrap().code(), None, "the scene is too short to be killed");
    expect(&run(folder.path(), &long("parts")), 0);
    let leftovers = |name: &String| name.ends_with("part");
    assert!(!names(&folder.path().join("parts")).iter().any(leftovers), "{:?}", names(&folder.path().join("parts")));
    assert_same_files(&folder.path().join("whole"), &folder.path().join("parts"));
}

// Takes that are there.

#[test]
fn a_take_of_another_scene_is_kept_unless_told_otherwise() {
    let folder = workplace();
    expect(&run(folder.path(), &["sim", "plate.toml", "--frames", "1-2"]), 0);
    let before = files(folder.path());
    let other = ["sim", "plate.toml", "--frames", "1-2", "--set", "body.plate.material=glass"];
    let text = expect(&run(folder.path(), &other), 2);
    assert!(text.contains("plate.take") && text.contains("--overwrite") && text.contains("--output"), "{text}");
    assert!(files(folder.path()) == before);
    expect(&run(folder.path(), &[&other[..], &["--overwrite"]].concat()), 0);
    assert!(files(folder.path()) != before);
}

#[test]
fn overwrite_removes_the_meshes_of_the_run_before_and_nothing_else() {
    let folder = workplace();
    expect(&run(folder.path(), &["run", "plate.toml", "--frames", "1-4", "--formats", "glb", "--preview"]), 0);
    let drawn = ["plate.0004.png", "plate_sheet.png", "plate.gif", "plate.html"]
        .map(|name| format!("out/plate/preview/{name}"));
    assert!(drawn.iter().all(|name| names(folder.path()).contains(name)), "{:?}", names(folder.path()));
    for precious in ["plate.0099.glb", "plate.take/thesis.txt", "preview/plate.0099.png", "preview/plate.1.png"] {
        std::fs::write(folder.path().join("out/plate").join(precious), "years of work").unwrap();
    }
    let again = ["run", "plate.toml", "--frames", "1-2", "--formats", "ply", "--overwrite"];
    expect(&run(folder.path(), &again), 0);
    let left = names(folder.path());
    assert!(!left.contains(&"out/plate/plate.0001.glb".to_owned()), "{left:?}");
    assert!(!left.contains(&"out/plate/plate.take/frame.0003.safetensors".to_owned()), "{left:?}");
    assert!(drawn.iter().all(|name| !left.contains(name)), "{left:?}");
    for precious in ["plate.0099.glb", "plate.take/thesis.txt", "preview/plate.0099.png", "preview/plate.1.png"] {
        assert_eq!(std::fs::read(folder.path().join("out/plate").join(precious)).unwrap(), b"years of work");
    }
}

/// A flipped bit in the state. Truth: the files as they were, until `--overwrite` asks for others.
#[test]
fn a_damaged_state_stops_and_loses_nothing() {
    let folder = workplace();
    expect(&run(folder.path(), &["sim", "plate.toml", "--frames", "1-4"]), 0);
    let state = folder.path().join("out/plate/plate.take/state.bin");
    let mut bytes = std::fs::read(&state).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 16;
    std::fs::write(&state, bytes).unwrap();
    let before = files(folder.path());
    let text = expect(&run(folder.path(), &["run", "plate.toml"]), 3);
    assert!(["state.bin", "damaged", "remove the state", "--overwrite"].iter().all(|w| text.contains(w)), "{text}");
    assert!(files(folder.path()) == before);
    // As the message says: the same frames come out, and the take goes on.
    std::fs::remove_file(&state).unwrap();
    let text = expect(&run(folder.path(), &["sim", "plate.toml"]), 0);
    assert!(text.contains("computed again"), "{text}");
    expect(&run(folder.path(), &["sim", "plate.toml", "--output", "whole"]), 0);
    assert_same_files(&folder.path().join("out/plate"), &folder.path().join("whole"));
}

/// A flipped bit in a frame. Truth: it is named, and comes back as it was.
#[test]
fn a_damaged_frame_is_named_and_comes_back() {
    let folder = workplace();
    expect(&run(folder.path(), &["run", "plate.toml", "--frames", "1-4", "--formats", "ply"]), 0);
    let whole = files(folder.path());
    let frame = folder.path().join("out/plate/plate.take/frame.0003.safetensors");
    let mut bytes = std::fs::read(&frame).unwrap();
    let last = bytes.len() - 1;
    bytes[last] ^= 1;
    std::fs::write(&frame, bytes).unwrap();
    let text = expect(&run(folder.path(), &["post", "out/plate/plate.take", "--formats", "ply"]), 3);
    assert!(text.contains("frame.0003.safetensors") && text.contains("damaged") && text.contains("remove"), "{text}");
    std::fs::remove_file(&frame).unwrap();
    expect(&run(folder.path(), &["run", "plate.toml", "--frames", "1-4", "--formats", "ply"]), 0);
    assert!(files(folder.path()) == whole);
}

/// What the frames do not depend on may change: the meshes follow, the frames stay as they are.
#[test]
fn an_edited_output_makes_meshes_anew_and_simulates_nothing() {
    let folder = workplace();
    expect(&run(folder.path(), &["run", "plate.toml", "--formats", "ply"]), 0);
    let take = folder.path().join("out/plate/plate.take");
    let written = |name: &str| std::fs::metadata(take.join(name)).unwrap().modified().unwrap();
    let before = written("frame.0012.safetensors");
    let edited = PLATE
        .replace("thickness = 2.0", "thickness = 3.5\nformats = [\"ply\"]")
        .replace("[output]", "# thicker\n[output]");
    std::fs::write(folder.path().join("plate.toml"), edited).unwrap();
    let text = expect(&run(folder.path(), &["run", "plate.toml"]), 0);
    assert!(text.contains("holds all frames"), "{text}");
    let listed = |manifest: &str| {
        let text = std::fs::read_to_string(folder.path().join(manifest)).unwrap();
        let list: serde_json::Value = serde_json::from_str(&text).unwrap();
        let files = list["files"].as_array().unwrap().clone();
        assert!(files.iter().all(|file| file["thickness"] == 3.5), "{text}");
        files.len()
    };
    assert_eq!(listed("out/plate/manifest.json"), 12);
    assert_eq!(written("frame.0012.safetensors"), before);
    // The take knows, too.
    expect(&run(folder.path(), &["post", "out/plate/plate.take", "--output", "again"]), 0);
    assert_eq!(listed("again/manifest.json"), 12);
    // A longer range goes on where the take stops, a shorter one is there already.
    for (range, told) in [("1-14", "after frame 12"), ("1-5", "holds all frames up to 5")] {
        let text = expect(&run(folder.path(), &["run", "plate.toml", "--set", &format!("frames.range={range}")]), 0);
        assert!(text.contains(told), "{text}");
    }
    expect(&run(folder.path(), &["sim", "plate.toml", "--set", "frames.range=1-14", "--output", "whole"]), 0);
    let name = "plate.take/frame.0014.safetensors";
    let frame = |root: &str| std::fs::read(folder.path().join(root).join(name)).unwrap();
    assert!(frame("out/plate") == frame("whole"));
}

/// Two processes in one folder. Truth: the files of a run that was alone.
#[cfg(unix)]
#[test]
fn a_second_process_is_kept_out_and_readers_are_not() {
    let folder = workplace();
    expect(&run(folder.path(), &long("whole")), 0);
    let mut child = fissure(folder.path(), &long("parts")).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let sign = folder.path().join("parts/plate.take/frame.0002.safetensors");
    // Stopped, it keeps what it has for as long as this takes.
    signal_when(&child, &sign, "-STOP");
    let process = format!("process {} (`fissure run", child.id());
    for arguments in [&long("parts")[..], &["post", "parts/plate.take"]] {
        let text = expect(&run(folder.path(), arguments), 3);
        assert!(text.contains(&process) && text.contains("--output"), "{text}");
    }
    expect(&run(folder.path(), &["post", "parts/plate.take", "--output", "read"]), 0);
    assert!(folder.path().join("read/plate.0001.glb").exists());
    assert!(Command::new("kill").args(["-CONT", &child.id().to_string()]).status().unwrap().success());
    assert!(child.wait().unwrap().success());
    assert_same_files(&folder.path().join("whole"), &folder.path().join("parts"));

    // A lock ends with its owner.
    let mut child = fissure(folder.path(), &long("dead")).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    signal_when(&child, &folder.path().join("dead/plate.take/.fissure.lock"), "-KILL");
    child.wait().unwrap();
    expect(&run(folder.path(), &long("dead")), 0);
    assert_same_files(&folder.path().join("whole"), &folder.path().join("dead"));
}

/// A request to stop as soon as the program can hear it, long before the first frame.
#[cfg(target_os = "linux")]
#[test]
fn an_early_interrupt_is_told_as_one() {
    let folder = workplace();
    for _ in 0..10 {
        let child = fissure(folder.path(), &long("out")).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let status = format!("/proc/{}/status", child.id());
        let catches_interrupts = || {
            let status = std::fs::read_to_string(&status).unwrap_or_default();
            let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap_or_default();
            u64::from_str_radix(caught.trim(), 16).is_ok_and(|signals| signals & 2 != 0)
        };
        while !catches_interrupts() {
            std::thread::yield_now();
        }
        assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
        let text = expect(&child.wait_with_output().unwrap(), 75);
        assert!(text.contains("interrupted"), "{text}");
    }
    expect(&run(folder.path(), &long("out")), 0);
}

/// A folder in which a death came before the first file.
#[test]
fn an_empty_take_begins() {
    let folder = workplace();
    std::fs::create_dir_all(folder.path().join("out/plate/plate.take")).unwrap();
    expect(&run(folder.path(), &["sim", "plate.toml", "--frames", "1-2"]), 0);
    let text = expect(&run(folder.path(), &["post", "out/plate/plate.take", "--frames", "1-3"]), 2);
    assert!(text.contains("frame 3") && text.contains("1-2"), "{text}");
}

/// A disk that is full from the start, and then is not. Truth: the files of a run on a disk with space.
#[cfg(unix)]
#[test]
fn a_run_on_a_full_disk_goes_on_when_there_is_space() {
    let folder = workplace();
    let text = expect(&on_a_full_disk(folder.path(), "run plate.toml"), 3);
    assert!(text.contains("plate.take") && text.contains("free some space"), "{text}");
    expect(&run(folder.path(), &["run", "plate.toml"]), 0);
    expect(&run(folder.path(), &["run", "plate.toml", "--output", "whole"]), 0);
    assert_same_files(&folder.path().join("out/plate"), &folder.path().join("whole"));
}

/// More threads than the system has room for.
#[cfg(unix)]
#[test]
fn threads_without_room_are_told() {
    let folder = workplace();
    let command = format!("ulimit -v 1000000; exec {} run plate.toml --threads 1000", env!("CARGO_BIN_EXE_fissure"));
    let output = Command::new("bash").args(["-c", &command]).current_dir(folder.path()).output().unwrap();
    let text = expect(&output, 2);
    assert!(text.contains("1000 threads") && text.contains("--threads"), "{text}");
    assert_eq!(names(folder.path()), ["plate.toml"]);
}

/// A list of somebody else's where the list of meshes goes: told before anything is computed, and kept.
#[test]
fn a_manifest_of_others_is_kept() {
    let folder = workplace();
    expect(&run(folder.path(), &["sim", "plate.toml", "--frames", "1-2"]), 0);
    let theirs = folder.path().join("out/plate/manifest.json");
    std::fs::write(&theirs, "{\"name\": \"a web page\", \"files\": [{\"file\": \"plate.toml\"}]}").unwrap();
    let before = files(folder.path());
    for arguments in
        [&["run", "plate.toml"][..], &["run", "plate.toml", "--overwrite"], &["post", "out/plate/plate.take"]]
    {
        let text = expect(&run(folder.path(), arguments), 3);
        assert!(text.contains("out/plate/manifest.json") && text.contains("--output"), "{text}");
        assert!(files(folder.path()) == before, "{arguments:?}");
    }
}

#[test]
fn a_folder_that_is_no_take_is_left_alone() {
    let folder = workplace();
    let manifest = folder.path().join("out/plate/plate.take/manifest.json");
    std::fs::create_dir_all(manifest.parent().unwrap()).unwrap();
    std::fs::write(&manifest, "{\"years\": 3}").unwrap();
    for arguments in [&["sim", "plate.toml"][..], &["sim", "plate.toml", "--overwrite"]] {
        assert!(expect(&run(folder.path(), arguments), 3).contains("not a take"));
    }
    assert_eq!(names(&folder.path().join("out")), ["plate/plate.take/manifest.json"]);
}

/// Truth: the folders. What reads takes says of any other folder that it is none, and which ones around it hold one; it
/// says nothing of writing.
#[test]
fn a_folder_without_a_take_is_told_with_what_to_name() {
    let folder = workplace();
    expect(&run(folder.path(), &["sim", "plate.toml"]), 0);
    std::fs::create_dir_all(folder.path().join("out/plate/pictures")).unwrap();
    std::fs::create_dir_all(folder.path().join("empty")).unwrap();
    for command in ["preview", "post"] {
        for (named, remedy) in
            [("out", "`out/plate`"), ("out/plate/pictures", "`out/plate`"), ("empty", "`fissure run`")]
        {
            let told = expect(&run(folder.path(), &[command, named]), 3);
            assert!(told.contains(&format!("the folder `{named}` is no take")) && told.contains(remedy), "{told}");
            assert!(!told.contains("--output") && !told.contains("write"), "{told}");
        }
    }
}

#[test]
fn a_take_of_another_version_is_named() {
    let folder = workplace();
    expect(&run(folder.path(), &["sim", "plate.toml", "--frames", "1-2"]), 0);
    let manifest = folder.path().join("out/plate/plate.take/manifest.json");
    let mut value: serde_json::Value = serde_json::from_slice(&std::fs::read(&manifest).unwrap()).unwrap();
    value["version"] = 999.into();
    std::fs::write(&manifest, value.to_string()).unwrap();
    for arguments in [&["post", "out/plate/plate.take"][..], &["sim", "plate.toml"]] {
        let text = expect(&run(folder.path(), arguments), 3);
        assert!(text.contains("999") && text.contains("manifest.json"), "{text}");
    }
}

// Bad input: a clear message, the right code, nothing written.

/// Bad input and what must be said about it.
struct Bad {
    what: &'static str,
    /// Replaced in the scene: (what, by what).
    edit: (&'static str, &'static str),
    drawing: &'static str,
    arguments: &'static [&'static str],
    code: i32,
    says: &'static [&'static str],
}

const FINE: Bad = Bad { what: "", edit: ("", ""), drawing: "", arguments: &["run", "plate.toml"], code: 2, says: &[] };
const NOTCH: &str = "line = [[0.0, 10.5], [0.0, 4.0]]";
const SHAPE: &str = "shape = { rectangle = { min = [-10.0, -10.0], max = [10.0, 10.0] } }";
const DRAWN: &str = "shape = { svg = \"plate\" }\n[drawing]\nfile = \"drawing.svg\"\nwidth = 20.0";

const TABLE: &[Bad] = &[
    Bad { what: "missing scene", arguments: &["run", "no.toml"], code: 3, says: &["no.toml"], ..FINE },
    Bad { what: "malformed TOML", edit: ("[grid]", "[grid"), says: &["plate.toml", ":19:"], ..FINE },
    Bad { what: "unknown key", edit: ("thickness", "thicknes"), says: &["thicknes", "`thickness`"], ..FINE },
    Bad { what: "unknown material", edit: ("\"pmma\"", "\"pmme\""), says: &["pmme", "`pmma`"], ..FINE },
    Bad { what: "missing drawing", edit: (SHAPE, DRAWN), code: 3, says: &["drawing.svg"], ..FINE },
    Bad { what: "malformed SVG", edit: (SHAPE, DRAWN), drawing: "<svg><rect", code: 3, says: &["drawing.svg"], ..FINE },
    Bad {
        what: "unknown id",
        edit: (SHAPE, DRAWN),
        drawing: r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 20 20"><rect id="plane" width="20" height="20"/></svg>"#,
        says: &["`plate`", "`plane`"],
        ..FINE
    },
    Bad {
        what: "outline without area",
        edit: (SHAPE, DRAWN),
        drawing: r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 20 20"><path id="plate" d="M0 0 H20 H5"/></svg>"#,
        says: &["plate", "no area"],
        ..FINE
    },
    Bad {
        what: "self-crossing outline",
        edit: (SHAPE, "shape = { polygon = [[-10, -10], [20, 20], [20, -10], [-10, 20], [-20, 0]] }"),
        says: &["plate", "(5, 5)"],
        ..FINE
    },
    Bad { what: "crack outside", edit: (NOTCH, "line = [[30, 0], [31, 0]]"), says: &["notch", "outside"], ..FINE },
    Bad { what: "crack of zero length", edit: (NOTCH, "line = [[0, 4], [0, 4]]"), says: &["notch", "length"], ..FINE },
    Bad {
        what: "crack crossing itself",
        edit: (NOTCH, "line = [[0, 0], [4, 0], [4, 2], [2, -2]]"),
        says: &["notch", "(3, 0)"],
        ..FINE
    },
    Bad {
        what: "guide away from the tip",
        edit: (
            NOTCH,
            "line = [[0.0, 10.5], [0.0, 4.0]]\nguide = \"path\"\n[[guide]]\nname = \"path\"\nline = [[5, 0], [5, -10]]",
        ),
        says: &["path", "(5, 0)"],
        ..FINE
    },
    Bad {
        what: "negative material",
        arguments: &["run", "plate.toml", "--set", "material.pmma.density=-1"],
        says: &["density", "-1"],
        ..FINE
    },
    Bad {
        what: "NaN material",
        arguments: &["run", "plate.toml", "--set", "material.pmma.young_modulus=nan"],
        says: &["young_modulus", "NaN"],
        ..FINE
    },
    Bad { what: "zero thickness", edit: ("thickness = 2.0", "thickness = 0.0"), says: &["thickness", "0"], ..FINE },
    Bad {
        what: "zero thickness typed",
        arguments: &["run", "plate.toml", "--thickness", "0"],
        says: &["--thickness", "0"],
        ..FINE
    },
    Bad {
        what: "spacing larger than the body",
        arguments: &["run", "plate.toml", "--set", "grid.particle_spacing=50"],
        says: &["particle_spacing", "50"],
        ..FINE
    },
    Bad {
        what: "more particles than memory",
        arguments: &["run", "plate.toml", "--set", "grid.particle_spacing=1e-5"],
        says: &["particle_spacing"],
        ..FINE
    },
    Bad {
        what: "time step above the limit",
        arguments: &["run", "plate.toml", "--set", "solver.time_step=1"],
        says: &["time step", "limit"],
        ..FINE
    },
    Bad {
        what: "override without value",
        arguments: &["run", "plate.toml", "--set", "growth.bending"],
        says: &["growth.bending", "="],
        ..FINE
    },
    Bad {
        what: "frames that are none",
        arguments: &["run", "plate.toml", "--frames", "9-1"],
        says: &["--frames", "9-1"],
        ..FINE
    },
    Bad {
        what: "frames outside the scene",
        arguments: &["run", "plate.toml", "--frames", "100-200"],
        says: &["100-200", "1-12"],
        ..FINE
    },
    Bad {
        what: "frames beyond the end",
        arguments: &["run", "plate.toml", "--frames", "10-20"],
        says: &["10-20", "frame 20", "1-12"],
        ..FINE
    },
    Bad {
        what: "a name that leads elsewhere",
        edit: ("\n[[body]]", "name = \"../evil\"\n[[body]]"),
        says: &["plate.toml:1:", "../evil", "name = "],
        ..FINE
    },
    Bad {
        what: "a name with a line break",
        arguments: &["run", "plate.toml", "--set", "name=\"a\\nb\""],
        says: &["a\\nb", "plain file name"],
        ..FINE
    },
    Bad {
        what: "unknown format",
        arguments: &["run", "plate.toml", "--formats", "fbx"],
        says: &["fbx", "glb"],
        ..FINE
    },
    Bad {
        what: "a format that shows none of the parts",
        arguments: &["run", "plate.toml", "--formats", "svg", "--parts", "particles"],
        says: &["svg", "cracked"],
        ..FINE
    },
    Bad {
        what: "an opening with a factor and keyframes",
        arguments: &["check", "plate.toml", "--set", "output.opening={factor=2,keyframes=[[1,0]]}"],
        says: &["factor", "keyframes", "output.opening"],
        ..FINE
    },
    Bad {
        what: "keyframes of explode that go back",
        arguments: &["check", "plate.toml", "--set", "output.explode={keyframes=[[9,0],[3,1]]}"],
        says: &["do not rise", "sort them by frame"],
        ..FINE
    },
    Bad {
        what: "a format in the scene that shows none of its parts",
        arguments: &["check", "plate.toml", "--set", "output.formats=[\"svg\"]", "--set", "output.parts=[\"faces\"]"],
        says: &["svg", "cracked", "output.formats"],
        ..FINE
    },
    Bad {
        what: "output that cannot be written",
        arguments: &["run", "plate.toml", "--output", "plate.toml/out"],
        code: 3,
        says: &["plate.toml/out", "--output"],
        ..FINE
    },
    Bad { what: "no take", arguments: &["post", "no.take"], code: 3, says: &["no folder `no.take`"], ..FINE },
    Bad { what: "a file for a take", arguments: &["post", "plate.toml"], code: 3, says: &["plate.toml"], ..FINE },
];

#[test]
fn bad_input_is_named_and_leaves_nothing_behind() {
    let mut wrong = Vec::new();
    for bad in TABLE {
        let folder = TempDir::new().unwrap();
        assert!(PLATE.contains(bad.edit.0), "{}: nothing to replace", bad.what);
        let scene = if bad.edit.0.is_empty() { PLATE.to_owned() } else { PLATE.replace(bad.edit.0, bad.edit.1) };
        std::fs::write(folder.path().join("plate.toml"), scene).unwrap();
        if !bad.drawing.is_empty() {
            std::fs::write(folder.path().join("drawing.svg"), bad.drawing).unwrap();
        }
        let before = files(folder.path());
        let (code, text) = result(&run(folder.path(), bad.arguments));
        let unsaid: Vec<_> = bad.says.iter().filter(|word| !text.contains(**word)).collect();
        if code != bad.code || !unsaid.is_empty() || text.contains("panicked") {
            wrong.push(format!("{}: code {code} instead of {}, unsaid {unsaid:?}:\n{text}", bad.what, bad.code));
        } else if files(folder.path()) != before || folder.path().join("out").exists() {
            wrong.push(format!("{}: left {:?}", bad.what, names(folder.path())));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}
