//! What the program says before it runs: warnings, and what `--strict` makes of them.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::process::{Command, Output};
use tempfile::TempDir;

/// A plate whose crack is 6 m long, pulled hard; with a spacing of 1 m the crack is 3 cells long.
const PLATE: &str = r#"
[[body]]
name = "plate"
material = "pmma"
shape = { rectangle = { min = [-10.0, -10.0], max = [10.0, 10.0] } }

[[crack]]
name = "notch"
line = [[0.0, 10.5], [0.0, 4.0]]

[[load]]
select = { edge = "left" }
force = [-20e6, 0.0]

[[load]]
select = { edge = "right" }
force = [20e6, 0.0]

[grid]
particle_spacing = 1.0

[frames]
range = "1-3"
rate = 1000.0
"#;

/// What `fissure COMMAND scene.toml ARGUMENTS` says of a scene: exit code, standard output, standard error.
fn said(scene: &str, command: &str, arguments: &[&str]) -> (i32, String, String) {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
    let Output { status, stdout, stderr } = Command::new(env!("CARGO_BIN_EXE_fissure"))
        .current_dir(folder.path())
        .args([command, "scene.toml"])
        .args(arguments)
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (status.code().unwrap(), text(stdout), text(stderr))
}

#[test]
fn a_warning_shows_its_line_and_only_strict_makes_it_count() {
    for command in ["check", "run", "sim"] {
        let (exit, _, told) = said(PLATE, command, &[]);
        assert_eq!(exit, 0, "{told}");
        for words in ["3.0 cells long", "scene.toml:9:1", "grid.particle_spacing"] {
            assert_eq!(told.matches(words).count(), 1, "{command}: {words}\n{told}");
        }
        assert_eq!(said(PLATE, command, &["--strict"]).0, 2);
        let fine = ["--strict", "--set", "grid.particle_spacing=0.25", "--set", "frames.range=1-2"];
        let (exit, _, told) = said(PLATE, command, &fine);
        assert!(exit == 0 && !told.contains("warning") && !told.contains('⚠'), "{told}");
    }
    let (exit, _, told) = said(PLATE, "check", &["--log", "json", "--strict"]);
    let lines: Vec<serde_json::Value> = told.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!((exit, lines.len()), (2, 2), "{told}");
    assert_eq!(lines[0]["event"], "warning");
    assert_eq!((&lines[0]["file"], &lines[0]["line"]), (&"scene.toml".into(), &9.into()));
    assert!(lines[0]["remedy"].as_str().unwrap().contains("0.375 m"), "{told}");
    assert_eq!((&lines[1]["event"], &lines[1]["exit"]), (&"error".into(), &2.into()));
}
