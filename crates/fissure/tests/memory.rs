//! Memory: what is told is what is taken, and what does not fit is refused before it begins.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{fissure, folder_with, run};
use std::process::{Command, Output};
use std::time::{Duration, Instant};

/// A plate of 1 m × 1 m that flies, in three frames.
fn plate(formulation: &str, spacing: f64, more: &str) -> String {
    format!(
        r#"
[[body]]
name = "plate"
material = "glass"
shape = {{ rectangle = {{ min = [0.0, 0.0], max = [1.0, 1.0] }} }}
velocity = [0.0, 1.0]
{more}
[solver]
formulation = "{formulation}"

[grid]
particle_spacing = {spacing}

[frames]
range = "1-3"
rate = 1e5
"#
    )
}

/// Truth: no machine has the memory of a hundred million particles here; the answer comes before anything is laid or
/// written.
#[test]
fn a_run_that_does_not_fit_is_refused_at_once() {
    let folder = folder_with("scene.toml", &plate("total", 4e-5, ""));
    for command in ["check", "run"] {
        let start = Instant::now();
        let Output { status, stderr, .. } = run(folder.path(), &[command, "scene.toml"]);
        let said = String::from_utf8(stderr).unwrap();
        assert_eq!(status.code(), Some(2), "{said}");
        assert!(said.contains("625000000 particles need about") && said.contains("m fits"), "{said}");
        assert!(start.elapsed() < Duration::from_secs(2));
        assert!(!folder.path().join("out").exists());
    }
}

/// Truth: the limit that the shell sets.
#[cfg(unix)]
#[test]
fn a_limit_of_the_shell_is_kept() {
    let folder = folder_with("scene.toml", &plate("total", 1e-3, ""));
    let line = format!("ulimit -v 400000; exec '{}' run scene.toml", env!("CARGO_BIN_EXE_fissure"));
    let Output { status, stderr, .. } =
        Command::new("sh").current_dir(folder.path()).args(["-c", &line]).output().unwrap();
    let said = String::from_utf8(stderr).unwrap();
    assert_eq!(status.code(), Some(2), "{said}");
    let free = said.split_once("more than the ").and_then(|(_, rest)| rest.split_once(" MiB that are free"));
    // The program itself and its threads have some of the 390 MiB.
    assert!(free.is_some_and(|(free, _)| free.parse::<u64>().unwrap() < 350), "{said}");
}

/// Truth: the largest memory that the system has seen the run take.
#[cfg(target_os = "linux")]
#[test]
fn the_memory_that_is_told_is_taken() {
    let crack = "[[crack]]\nname = \"c\"\nline = [[-0.1, 0.503], [0.6, 0.713]]\n";
    let surface = "[take]\nparticles = \"surface\"\n";
    let none = "[take]\nparticles = \"none\"\n";
    let collider = "[[collider]]\nname = \"floor\"\nshape = { half_plane = { point = [0.0, -1.0] } }\n";
    for (formulation, spacing, more) in [
        ("total", 0.01, ""),
        ("total", 0.004, ""),
        ("updated", 0.004, ""),
        ("total", 0.005, crack),
        ("updated", 0.005, crack),
        ("total", 0.005, collider),
        ("total", 0.002, surface),
        ("total", 0.002, none),
        ("updated", 0.002, none),
    ] {
        let folder = folder_with("scene.toml", &plate(formulation, spacing, more));
        let Output { stdout, stderr, .. } = run(folder.path(), &["check", "scene.toml", "--log", "json"]);
        let told: serde_json::Value = serde_json::from_slice(&stdout).unwrap_or_else(|_| panic!("{stderr:?}"));
        let told = told["memory_bytes"].as_f64().unwrap() / 1024.0;
        // Frames that wait for a busy machine add to it: the least of a few runs is what is needed.
        let run = || fissure(folder.path(), &["run", "scene.toml", "--threads", "2", "--quiet", "--overwrite"]).spawn();
        let mut most = f64::INFINITY;
        for _ in 0..12 {
            most = most.min(most_memory(run().unwrap()));
            if most < 1.1 * told {
                break;
            }
        }
        assert!((told / most - 1.0).abs() < 0.15, "{formulation} {spacing} {more}: told {told} kB, taken {most} kB");
    }
}

/// The most memory that a process has taken till its end [kB].
#[cfg(target_os = "linux")]
fn most_memory(mut process: std::process::Child) -> f64 {
    let status = format!("/proc/{}/status", process.id());
    let mut most = 0.0_f64;
    while process.try_wait().unwrap().is_none() {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let now = line.and_then(|line| line.trim().trim_end_matches(" kB").parse().ok());
        most = most.max(now.unwrap_or(0.0));
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(process.wait().unwrap().success());
    most
}
