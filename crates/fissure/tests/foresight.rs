//! What the program says before it runs: warnings, and what `--strict` makes of them.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::folder_with;
use fissure_tests::program::PLATE;
use tempfile::TempDir;

/// What `fissure COMMAND scene.toml ARGUMENTS` says of a scene: exit code, standard output, standard error.
fn said(scene: &str, command: &str, arguments: &[&str]) -> (i32, String, String) {
    let folder = folder_with("scene.toml", scene);
    common::said(folder.path(), &[&[command, "scene.toml"], arguments].concat())
}

#[test]
fn a_warning_shows_its_line_and_only_strict_makes_it_count() {
    // The crack is 6 m long and a cell 2 m; all else is far away.
    let wide = PLATE.replace("min = [-10.0, -10.0], max = [10.0, 10.0]", "min = [-20.0, -20.0], max = [20.0, 10.0]");
    let plate = wide.replace("1-12", "1-3");
    for command in ["check", "run", "sim"] {
        let (exit, _, told) = said(&plate, command, &[]);
        assert_eq!(exit, 0, "{told}");
        for words in ["3.0 cells long", "scene.toml:9:1", "grid.particle_spacing"] {
            assert_eq!(told.matches(words).count(), 1, "{command}: {words}\n{told}");
        }
        assert_eq!(said(&plate, command, &["--strict"]).0, 2);
        let fine = ["--strict", "--set", "grid.particle_spacing=0.25", "--set", "frames.range=1-2"];
        let (exit, _, told) = said(&plate, command, &fine);
        assert!(exit == 0 && !told.contains('⚠'), "{told}");
    }
    let (exit, _, told) = said(&plate, "check", &["--log", "json", "--strict"]);
    let lines: Vec<serde_json::Value> = told.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!((exit, lines.len()), (2, 2), "{told}");
    assert_eq!(lines[0]["event"], "warning");
    assert_eq!((&lines[0]["file"], &lines[0]["line"]), (&"scene.toml".into(), &9.into()));
    assert!(lines[0]["remedy"].as_str().unwrap().contains("0.375 m"), "{told}");
    assert_eq!((&lines[1]["event"], &lines[1]["exit"]), (&"error".into(), &2.into()));
}

/// The plate with a fine grid and without its loads; nothing is said of it once something loads it.
const BARE: &str = r#"
[[body]]
name = "plate"
material = "pmma"
shape = { rectangle = { min = [-10.0, -10.0], max = [10.0, 10.0] } }

[[crack]]
name = "notch"
line = [[0.0, 10.5], [0.0, 4.0]]

[grid]
particle_spacing = 0.3125

[frames]
range = "1-12"
rate = 1000.0
"#;

/// A pair of loads that pull the plate apart, in N/m.
fn pulled(force: &str) -> String {
    let load = |side, sign| format!("[[load]]\nselect = {{ edge = \"{side}\" }}\nforce = [{sign}{force}, 0.0]\n");
    format!("{BARE}{}{}", load("left", "-"), load("right", ""))
}

/// Truth: the construction of each scene. Every warning comes once, with its value and line, and the sound scene has
/// none.
#[test]
fn what_will_go_wrong_is_said_with_value_and_line() {
    let (exit, _, told) = said(&pulled("20e6"), "check", &["--strict"]);
    assert_eq!(exit, 0, "{told}");
    let flying = format!("{BARE}[[initial_velocity]]\nselect = {{ body = \"plate\" }}\nvelocity = [20.0, 0.0]\n");
    // What is stopped at an edge is loaded by that.
    let stopped = format!("{flying}[[support]]\nselect = {{ edge = \"left\" }}\nfix = \"both\"\n");
    let (exit, _, told) = said(&stopped, "check", &["--strict"]);
    assert_eq!(exit, 0, "{told}");
    let soft = "[[material]]\nname = \"pmma\"\nyoung_modulus = 2.94\n";
    let narrow = pulled("20e6")
        .replace("[10.0, 10.0]", "[-8.0, 10.0]")
        .replace("[[0.0, 10.5], [0.0, 4.0]]", "[[-9.0, 10.5], [-9.0, 4.0]]");
    for (scene, words) in [
        (BARE.to_owned(), &["nothing loads the scene", "scene.toml:2:1"][..]),
        (flying, &["about 0 % of its toughness", "add a load, a support that moves", "scene.toml:7:1"]),
        (pulled("0.0"), &["its forces are 0", "scene.toml:17:1"]),
        (pulled("20e3"), &["of its toughness at most", "multiply the loads by", "scene.toml:17:1"]),
        (pulled("20e6") + soft, &["Young's modulus 2.94e0 Pa", "more than 0.1", "scene.toml:25:17"]),
        (pulled("1e12"), &["load 1 makes stresses of about", "scene.toml:17:1", "multiply the load by"]),
        (pulled("20e6").replace("rate = 1000.0", "rate = 24.0"), &["within 0.", "frames.rate", "scene.toml:16:8"]),
        (narrow, &["3.2 cells wide", "scene.toml:5:1"]),
        (
            pulled("20e6").replace("[0.0, 4.0]]", "[0.0, -7.0]]"),
            &["4.8 cells to the outline", "scene.toml:9:1", "0.187 m or less"],
        ),
    ] {
        let (exit, _, told) = said(&scene, "check", &["--strict"]);
        assert_eq!(exit, 2, "{words:?}\n{told}");
        for word in words {
            assert_eq!(told.matches(word).count(), 1, "{word}\n{told}");
        }
    }
}

/// Truth: the construction. Both lines are shown, and no smaller step is advised.
#[test]
fn what_contradicts_itself_is_refused_with_both_lines() {
    let supports = "[[support]]\nselect = { edge = \"left\" }\nvelocity_x = 1.0\n[[support]]\nvelocity_x = -1.0\n";
    let buried =
        "gravity = [0, -9.81]\n[[collider]]\nname = \"floor\"\nshape = { half_plane = { point = [0.0, -5.0] } }\n";
    for (scene, words) in [
        (format!("{BARE}{supports}"), &["supports 1 and 2 hold the same material", "1 and -1 m/s along x"][..]),
        (buried.to_owned() + BARE, &["body `plate` is inside collider `floor`", "5.000 m deep"]),
    ] {
        for command in ["check", "run"] {
            let (exit, _, told) = said(&scene, command, &[]);
            assert_eq!(exit, 2, "{told}");
            assert!(words.iter().all(|word| told.contains(word)) && !told.contains("courant"), "{told}");
            // A label under each of two lines.
            assert!(told.matches("──").count() >= 2, "{told}");
        }
    }
    let (exit, _, told) = said(&format!("{BARE}{supports}"), "check", &["--log", "json"]);
    let line: serde_json::Value = serde_json::from_str(told.lines().last().unwrap()).unwrap();
    assert_eq!((exit, &line["line"], &line["other_line"]), (2, &20.into(), &17.into()), "{told}");
}

#[test]
fn a_load_beyond_measure_is_named_as_the_cause() {
    let (exit, _, told) = said(&pulled("1e12"), "sim", &[]);
    assert_eq!(exit, 4, "{told}");
    let failure = &told[told.find("failed at t").unwrap()..];
    assert!(failure.contains("load 1 makes stresses") && !failure.contains("courant"), "{told}");
}

#[test]
fn a_selection_that_meets_nothing_shows_its_line() {
    let scene = format!("{BARE}[[load]]\nforce = [0, 1e6]\nselect = {{ near = [[50, 0]], radius = 0.5 }}\n");
    let (exit, _, told) = said(&scene, "check", &[]);
    assert_eq!(exit, 2, "{told}");
    for words in ["load 1 selects no particle", "4.0", "scene.toml:19:1", "make `radius` at least"] {
        assert!(told.contains(words), "{words}\n{told}");
    }
}

/// Truth: the run itself; nothing in it grows.
#[test]
fn a_run_in_which_no_crack_moves_says_how_near_one_came() {
    let (exit, _, told) = said(&pulled("2e6"), "sim", &[]);
    assert_eq!(exit, 0, "{told}");
    assert_eq!(told.matches("no crack moved: at most").count(), 1, "{told}");
    let (_, _, told) = said(&pulled("40e6"), "sim", &[]);
    assert!(!told.contains("no crack moved"), "{told}");
}

/// Truth: the estimate is made of counts, so the same scene has the same to the last byte.
#[test]
fn an_estimate_is_the_same_every_time() {
    let scene = format!("name = \"plate\"\n{}", pulled("20e6"));
    let first = said(&scene, "check", &["--log", "json"]).1;
    assert!((0..4).all(|_| said(&scene, "check", &["--log", "json"]).1 == first), "{first}");
    // Soft material that leaves the range of the total formulation in mid-run, as it may, is no reason to fail.
    let jelly = "gravity = [0, -9.81]\n[[body]]\nname = \"disc\"\nmaterial = \"jello\"\nshape = { circle = { center = [0, 55], radius = 50 } }\n\
                 [[collider]]\nshape = { half_plane = { point = [0, 0] } }\n[grid]\nparticle_spacing = 2.0\n[solver]\nformulation = \"total\"\non_distortion = \"switch\"\n";
    assert_eq!(said(jelly, "check", &[]).0, 0);
}

/// Truth: the same bytes as with the files named themselves.
#[test]
fn a_folder_stands_for_the_scene_or_the_take_in_it() {
    let folder = TempDir::new().unwrap();
    let fissure = |arguments: &[&str]| common::said(folder.path(), arguments);
    std::fs::create_dir(folder.path().join("mine")).unwrap();
    assert_eq!(fissure(&["run", "mine"]).0, 3, "there is none");
    std::fs::write(folder.path().join("mine/scene.toml"), pulled("20e6")).unwrap();
    let (exit, _, told) = fissure(&["run", "mine", "--frames", "1-2"]);
    assert_eq!(exit, 0, "{told}");
    let mesh = folder.path().join("out/mine/mine.0002.glb");
    let bytes = std::fs::read(&mesh).unwrap();
    std::fs::remove_file(&mesh).unwrap();
    let (exit, _, told) = fissure(&["post", "out/mine"]);
    assert_eq!(exit, 0, "{told}");
    assert!(std::fs::read(&mesh).unwrap() == bytes);
    // A file that is no TOML can be read; it is the scene that is wrong.
    std::fs::write(folder.path().join("mine/scene.toml"), "[[body]\n").unwrap();
    assert_eq!(fissure(&["check", "mine"]).0, 2);
    assert_eq!(fissure(&["check", "none.toml"]).0, 3);
}

/// Truth: the same scene with the spacing written down. What is chosen is said, keeps the error or the time that was
/// asked for, and is what the run has; what is not to be had is refused with what is.
#[test]
fn accuracy_and_budget_choose_the_spacing() {
    let plate = format!("name = \"plate\"\n{PLATE}");
    let said_by = |more: &[&str]| said(&plate, "check", &[&["--log", "json"], more].concat());
    let (code, text, told) = said_by(&["--accuracy", "3%"]);
    assert_eq!(code, 0, "{told}");
    let found: serde_json::Value = serde_json::from_str(&text).unwrap();
    let number = |key: &str| found[key].as_f64().unwrap();
    let spacing = number("particle_spacing");
    assert!(told.contains(&format!("chosen: grid.particle_spacing={spacing:?}")), "{told}");
    assert!(number("highest_k_error") <= 0.03 && number("highest_k_error") > 0.027, "{text}");
    let written = format!("grid.particle_spacing={spacing:?}");
    assert_eq!(said_by(&["--set", &written]).1, text);

    let (code, text, told) = said_by(&["--budget", "3s"]);
    assert_eq!(code, 0, "{told}");
    let found: serde_json::Value = serde_json::from_str(&text).unwrap();
    let seconds = found["seconds"].as_f64().unwrap();
    assert!(seconds < 3.1 && seconds > 2.0, "{text}");

    for (wish, word) in [(["--accuracy", "0.01%"], "ask for 1.00 % or more"), (["--budget", "0.001s"], "the coarsest")]
    {
        let (code, _, told) = said_by(&wish);
        assert!(code == 2 && told.contains(word), "{code} {told}");
    }
    let (code, _, told) = said_by(&["--accuracy", "3%", "--budget", "3s"]);
    assert!(code == 2 && told.contains("cannot be used with"), "{told}");
}

/// Truth: the flags. A key of the scene says the same as its flag, yields to it, and is shown with its line where it is
/// not to be had.
#[test]
fn keys_of_the_scene_choose_the_spacing_as_flags_do() {
    let bare = format!("name = \"plate\"\n{}", pulled("20e6"));
    let spacing = "particle_spacing = 0.3125";
    assert!(bare.contains(spacing), "{bare}");
    let with = |key: &str| bare.replace(spacing, key);
    let (none, all) = (with(""), ["--log", "json"]);
    for (key, flag) in [("accuracy = \"3%\"", ["--accuracy", "3%"]), ("budget = \"3s\"", ["--budget", "3s"])] {
        let by_flag = said(&none, "check", &[&all[..], &flag].concat());
        assert_eq!(by_flag.0, 0, "{}", by_flag.2);
        assert_eq!(said(&with(key), "check", &all), by_flag);
        assert_eq!(said(&with("accuracy = \"9%\""), "check", &[&all[..], &flag].concat()), by_flag);
    }
    for (keys, words) in [
        ("accuracy = \"0.01%\"", &["scene.toml:13:12", "ask for 1.00 % or more"][..]),
        ("budget = \"1ms\"", &["scene.toml:13:10", "`budget` cannot be `1ms`", "such as 30s, 5min or 2h"]),
        ("budget = 30", &["scene.toml:13:10", "is 30, but it takes text in quotes", "\"30s\""]),
        ("accuracy = \"2%\"\nbudget = \"9s\"", &["scene.toml:13:12", "both `accuracy` and `budget`"]),
        ("accuracy = \"2%\"\nparticle_spacing = 0.1", &["scene.toml:13:12", "leave `particle_spacing` out"]),
        ("budget = \"9s\"\ncell_size = 0.1", &["scene.toml:13:10", "leave `cell_size` out"]),
    ] {
        let (code, _, told) = said(&with(keys), "check", &[]);
        assert_eq!(code, 2, "{told}");
        assert!(words.iter().all(|word| told.contains(word)), "{words:?}\n{told}");
    }
    let (code, _, told) = said(&with("budget = \"9s\""), "check", &["--set", "grid.particle_spacing=0.5"]);
    assert!(code == 0 && !told.contains("chosen"), "{told}");
}
