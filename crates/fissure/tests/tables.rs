//! `fissure sim --tables`. Truth: closed forms, conservation laws, and a run that was never interrupted.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{folder_with, names, said};
use std::path::Path;

/// A plate of 2 m by 2 m with a notch of .8 m, pulled apart at both sides until the notch has run some way.
const PLATE: &str = r#"
name = "plate"
plane = "stress"

[[body]]
name = "plate"
material = "glass"
shape = { rectangle = { min = [0, 0], max = [2, 2] } }

[[crack]]
name = "notch"
line = [[1.0, 2.1], [1.0, 1.2]]

[[support]]
select = { edge = "left" }
velocity_x = -0.02

[[support]]
select = { edge = "right" }
velocity_x = 0.02

[grid]
particle_spacing = 0.05

[solver]
damping = 200.0

[frames]
range = "1-9"
rate = 1500.0
"#;

/// A body that flies freely and is damped.
const FLIGHT: &str = r#"
name = "flight"

[[body]]
name = "body"
material = "glass"
shape = { rectangle = { min = [0, 0], max = [1, 1] } }
velocity = [3.0, 4.0]

[grid]
particle_spacing = 0.1

[solver]
damping = 50.0

[frames]
range = "1-5"
rate = 500.0
"#;

/// The columns `wanted` of a table.
fn columns<const N: usize>(path: &Path, wanted: [&str; N]) -> Vec<[f64; N]> {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let places = wanted.map(|name| head.iter().position(|column| *column == name).unwrap());
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        places.map(|place| cells[place].parse().unwrap())
    };
    lines.map(row).collect()
}

#[track_caller]
fn sim(folder: &Path, scene: &str, more: &[&str]) {
    let (code, _, told) = said(folder, &[&["sim", scene, "--quiet"], more].concat());
    assert_eq!(code, 0, "{told}");
}

/// Truth: the closed form T₀ (1 − exp(−2 c t)) of what damping takes from a body in free flight, and that nothing else
/// takes anything.
#[test]
fn damping_takes_what_it_should() {
    let folder = folder_with("flight.toml", FLIGHT);
    sim(folder.path(), "flight.toml", &["--tables=energy"]);
    let place = folder.path().join("out/flight");
    let rows = columns(&place.join("flight.energy.csv"), ["time", "kinetic", "damping", "rest"]);
    let first = rows[0][1];
    assert!(rows.len() > 9 && (first / (0.5 * 25.0 * 2500.0) - 1.0).abs() < 1e-9, "{} {first}", rows.len());
    for [time, _, damping, rest] in rows {
        let expected = first * -(-2.0 * 50.0 * time).exp_m1();
        // The first step begins with the velocities of half a step later: 1.6e-3 of the energy is counted too much.
        assert!((damping - expected).abs() < 2e-3 * first, "{time}: {damping} instead of {expected}");
        assert!(rest.abs() < 2e-3 * first, "{time}: {rest}");
    }
    assert_eq!(names(&place).iter().filter(|name| name.ends_with(".csv") && !name.contains(".take")).count(), 1);
}

/// Truth: work is force times way; energy is conserved; J does not depend on the contour; the tables of a run in two
/// parts are those of one; a run without tables leaves none of an earlier one.
#[test]
fn tables_of_a_plate_add_up() {
    let folder = folder_with("plate.toml", PLATE);
    let place = folder.path().join("out/plate");
    sim(folder.path(), "plate.toml", &["--tables", "--frames", "1-4"]);
    sim(folder.path(), "plate.toml", &["--tables"]);
    let columns_of = |kind: &str| place.join(format!("plate.{kind}.csv"));

    let supports = columns(&columns_of("supports"), ["support", "displacement_x", "force_x", "work"]);
    for support in [0.0, 1.0] {
        let rows: Vec<&[f64; 4]> = supports.iter().filter(|row| row[0] == support).collect();
        // But for the jerk at the start, in which the material comes to the speed of the support.
        for pair in rows.windows(2) {
            let done = pair[1][2] * (pair[1][1] - pair[0][1]);
            assert!((done - (pair[1][3] - pair[0][3])).abs() < 1e-9 * pair[1][3], "{pair:?}");
        }
        let way = rows[rows.len() - 1][1];
        assert!((way.abs() - 0.02 * 8.0 / 1500.0).abs() < 1e-12, "{way}");
    }

    let energy = columns(&columns_of("energy"), ["external_work", "crack", "damping", "rest"]);
    let [given, crack, damping, _] = energy[energy.len() - 1];
    assert!(crack > 0.1 * given && damping > 0.0, "{given} {crack} {damping}");
    for [_, _, _, rest] in &energy {
        assert!(rest.abs() < 0.02 * given, "{rest} of {given}");
    }

    let looks = columns(&columns_of("looks"), ["time", "length", "j_integral"]);
    let contours =
        columns(&columns_of("contours"), ["time", "length", "cells", "j_domain", "j_contour", "j_contour_inertia"]);
    let settled = |row: &&[f64; 6]| row[1] < 0.81 && row[0] > 3.5e-4 && row[2] > 2.5;
    let mut seen = 0;
    for [time, _, cells, domain, _, with_inertia] in contours.iter().filter(settled) {
        let Some([.., j]) = looks.iter().find(|look| look[0] == *time) else { continue };
        assert!((domain / j - 1.0).abs() < 0.05, "{cells} cells at {time}: {domain}, {j}");
        assert!((with_inertia / j - 1.0).abs() < 0.15, "{cells} cells at {time}: {with_inertia}, {j}");
        seen += 1;
    }
    assert!(seen > 10, "{seen}");

    let (code, _, told) = said(folder.path(), &["preview", "out/plate", "--html", "--quiet"]);
    assert_eq!(code, 0, "{told}");
    let page = std::fs::read_to_string(place.join("preview/plate.html")).unwrap();
    for part in [r#""name":"support 1, x""#, r#""cells":4.0"#, r#""rest":[0.0"#] {
        assert!(page.contains(part), "{part}");
    }

    sim(folder.path(), "plate.toml", &["--tables", "--output", "whole"]);
    for kind in ["looks", "contours", "energy", "supports"] {
        let name = format!("plate.{kind}.csv");
        let [parts, whole] =
            [place.clone(), folder.path().join("whole")].map(|at| std::fs::read(at.join(&name)).unwrap());
        assert!(parts == whole, "{name}");
    }
    sim(folder.path(), "plate.toml", &["--overwrite", "--frames", "1-2"]);
    assert!(!columns_of("energy").exists() && !columns_of("contours").exists());
}
