//! Drawings that run without a scene file: the real binary, real files.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{folder_with, said};
use fissure_scene::{LoadKind, Take};
use tempfile::TempDir;

/// A plate with a crack from its left side: a layer by its label, an id in another case, a guide with a number.
const PLATE: &str =
    "<svg xmlns='http://www.w3.org/2000/svg' xmlns:inkscape='http://www.inkscape.org/namespaces/inkscape'
  width='200mm' height='150mm' viewBox='0 0 200 150'>
  <g id='layer1' inkscape:label='BODY'><path id='path1' d='M0 0H200V120H0Z M120 40h20v20h-20z' fill-rule='evenodd'/></g>
  <path id='Crack' d='M-5 70 L50 62' stroke='red'/>
  <path inkscape:label='guide 1' d='M50 62 L200 60' fill='none' stroke='red'/>
  <rect id='collider_2' x='0' y='140' width='200' height='9'/>
</svg>";

/// Coarse and short, so that it runs in a moment.
const QUICK: [&str; 4] = ["--set", "grid.particle_spacing=0.008", "--set", "frames.range=1-3"];

fn folder(drawing: &str) -> TempDir {
    folder_with("plate.svg", drawing)
}

fn run<'a>(arguments: &[&'a str]) -> Vec<&'a str> {
    ["run", "plate.svg", "--material", "glass", "--thickness", "0.05"]
        .into_iter()
        .chain(arguments.iter().copied())
        .collect()
}

/// Truth: the drawing. Names in any case, on elements and on layers, are what they say; the scene that is printed and
/// written is the one that runs, and gives the same take.
#[test]
fn a_drawing_runs_and_its_scene_gives_the_same_take() {
    let folder = folder(PLATE);
    let (exit, _, told) = said(folder.path(), &run(&QUICK));
    assert_eq!(exit, 0, "{told}");
    let text = std::fs::read_to_string(folder.path().join("out/plate/scene.toml")).unwrap();
    assert!(told.contains(&text), "{told}");
    let scene = fissure_scene::load(&folder.path().join("out/plate/scene.toml"), &[]).unwrap();
    assert_eq!(
        (scene.bodies.len(), scene.cracks.len(), scene.colliders.len(), scene.loads.len()),
        (1, 1, 1, 2),
        "{text}"
    );
    assert!((scene.bodies[0].region.area() - (0.2 * 0.12 - 0.02 * 0.02)).abs() < 1e-6);
    assert!(!scene.cracks[0].start_live && scene.cracks[0].end_live && scene.cracks[0].end_guide.is_some(), "{text}");
    assert_eq!((scene.name.as_str(), scene.output.thickness), ("plate", 0.05));
    let forces: Vec<_> = scene
        .loads
        .iter()
        .map(|load| match load.kind {
            LoadKind::Force(force) => force,
            _ => panic!("{text}"),
        })
        .collect();
    assert!(forces[0] == -forces[1] && forces[0].y > 0.0 && forces[0].x == 0.0, "{text}");
    // The same once more from the scene, into another folder.
    let scene = [&["run", "out/plate/scene.toml", "--output", "again"], &QUICK[..]].concat();
    let (exit, _, told) = said(folder.path(), &scene);
    assert_eq!(exit, 0, "{told}");
    let meshes = |root: &str| {
        let files = std::fs::read_dir(folder.path().join(root)).unwrap().map(|entry| entry.unwrap().path());
        let mut meshes: Vec<_> = files.filter(|file| file.extension().is_some_and(|e| e == "glb")).collect();
        meshes.sort();
        meshes.into_iter().map(|file| std::fs::read(file).unwrap()).collect::<Vec<_>>()
    };
    let made = meshes("out/plate");
    assert!(made.len() >= 3 && made == meshes("again"));
}

/// Truth: the promise. The drawing run again leaves an edited scene as it is, with or without `--overwrite`, and says
/// what to run; an untouched one follows the drawing.
#[test]
fn an_edited_scene_is_kept() {
    let folder = folder(PLATE);
    let sim = |more: &[&str]| {
        let all = [&["sim", "plate.svg", "--material", "glass"], &QUICK[..], more].concat();
        said(folder.path(), &all)
    };
    let path = folder.path().join("out/plate/scene.toml");
    assert_eq!(sim(&[]).0, 0);
    let made = std::fs::read_to_string(&path).unwrap();
    std::fs::write(folder.path().join("plate.svg"), PLATE.replace("L50 62", "L70 62")).unwrap();
    let (exit, _, told) = sim(&["--overwrite"]);
    assert_eq!(exit, 0, "{told}");
    let followed = std::fs::read_to_string(&path).unwrap();
    assert_ne!(made, followed);
    for edited in [followed.replace("glass", "pmma"), String::new(), "# mine".to_owned()] {
        std::fs::write(&path, &edited).unwrap();
        for more in [&[][..], &["--overwrite"]] {
            let (exit, _, told) = sim(more);
            assert_eq!(exit, 2, "{told}");
            assert!(told.contains("was changed") && told.contains("fissure run out/plate/scene.toml --set"), "{told}");
            assert_eq!(std::fs::read_to_string(&path).unwrap(), edited);
        }
    }
    // Edited, it simulates anew: another material is another take.
    std::fs::write(&path, followed.replace("glass", "pmma")).unwrap();
    let (exit, _, told) = said(folder.path(), &[&["sim", "out/plate/scene.toml", "--overwrite"], &QUICK[..]].concat());
    assert_eq!(exit, 0, "{told}");
    let take = Take::open(&folder.path().join("out/plate/plate.take")).unwrap();
    assert_eq!(take.scene().materials[take.scene().bodies[0].material].name, "pmma");
}

/// Truth: by hand. Of two guides that begin near one tip the nearer one leads it; the other one ends short of both,
/// which is told with its name, instead of a scene that cannot be read.
#[test]
fn a_tip_follows_the_nearest_of_two_guides() {
    let twig = "<path id='guide_2' d='M150 100 L90 66'/></svg>";
    for drawing in [PLATE.replace("</svg>", twig), PLATE.replace("guide 1", "guide 3").replace("</svg>", twig)] {
        let folder = folder(&drawing);
        let (exit, _, told) =
            said(folder.path(), &["check", "plate.svg", "--material", "glass", "--thickness", "0.05"]);
        assert_eq!(exit, 0, "{told}");
        assert!(told.contains("no crack follows guide") && told.contains("from the nearest one"), "{told}");
        let keys = told.lines().filter(|line| line.starts_with("guide_end = ")).count();
        assert_eq!(keys, 1, "{told}");
    }
}

/// Truth: the drawings. Without names a lone shape is the body and gets a notch; `check` writes nothing.
#[test]
fn an_icon_is_a_body_with_a_notch() {
    let star = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 16 16'><path d='M8 1 10 6 15 6.5 11 10 12 15 8 12.3 4 15 5 10 1 6.5 6 6Z'/></svg>";
    let folder = folder(star);
    let (exit, _, told) = said(folder.path(), &["check", "plate.svg", "--material", "pmma", "--width", "0.1"]);
    assert_eq!(exit, 0, "{told}");
    assert!(told.contains("this notch starts one") && told.contains("svg = \"*\""), "{told}");
    assert!(!folder.path().join("out").exists());
}

/// Truth: the drawings. An open line that nothing stands for is told with its line, and does not pass where warnings
/// count: one without a name, one with another name where a notch is made, and one that became a part of the body.
/// Closed ones, and other names beside a crack, are told by the scene only.
#[test]
fn an_open_line_that_is_no_crack_is_told() {
    let line = "<path d='M0 20H9' stroke='red' fill='none'/>";
    let crack = "<path id='crack' d='M0 9H9'/>";
    for (body, lines, words) in [
        ("id='body'", line.to_owned(), &["<path> in line 3", "without id and label", "a notch", "the id `crack`"][..]),
        ("id='body'", format!("{crack}{line}"), &["<path> in line 3", "not used"]),
        (
            "id='body'",
            "<polyline id='a' points='0,20 5 20, 9,21'/><line/>".into(),
            &["<polyline> in line 3", "`a`", "1 more"],
        ),
        ("", "<line x1='0' y1='20' x2='9' y2='20' stroke='red'/>".into(), &["<line> in line 3", "part of the body"]),
        ("id='body'", format!("{crack}<path id='a' d='M0 20H9'/>"), &[]),
        ("id='body'", "<path d='M0 20H9V30Z'/><path d='M0 20H9V30L0 20'/><polyline points='0,2 5,2 0,2'/>".into(), &[]),
        ("", "<circle r='9'/>".into(), &[]),
    ] {
        let svg = "<svg xmlns='http://www.w3.org/2000/svg' width='40mm' viewBox='0 0 40 40'>";
        let folder = folder(&format!("{svg}\n<rect {body} width='40' height='40'/>\n{lines}</svg>"));
        let arguments = ["check", "plate.svg", "--material", "glass", "--log", "json"];
        let (exit, _, told) = said(folder.path(), &arguments);
        assert_eq!(exit, 0, "{told}");
        let warnings: Vec<&str> =
            told.lines().filter(|l| l.contains("\"warning\"") && l.contains("the open <")).collect();
        assert_eq!(warnings.len(), usize::from(!words.is_empty()), "{told}");
        words.iter().for_each(|word| assert!(warnings[0].contains(word), "{word}: {told}"));
        if !words.is_empty() {
            assert_eq!(said(folder.path(), &[&arguments[..], &["--strict"]].concat()).0, 2);
        }
    }
}

/// Truth: the drawings. Of two bodies with a crack each, both are pulled apart.
#[test]
fn each_cracked_body_is_pulled() {
    let two = "<svg xmlns='http://www.w3.org/2000/svg' width='300mm' viewBox='0 0 300 160'>
        <rect id='body 1' x='10' y='10' width='120' height='140'/><circle id='Body_2' cx='220' cy='80' r='65'/>
        <g id='Cracks'><path id='left' d='M8 80H45'/><path id='right' d='M220 10V50'/></g><rect id='other' width='3' height='3'/></svg>";
    let folder = folder(two);
    let (exit, _, told) = said(folder.path(), &["check", "plate.svg", "--material", "glass"]);
    assert_eq!(exit, 0, "{told}");
    for (words, count) in
        [("[[body]]", 2), ("[[crack]]", 2), ("[[load]]", 4), ("not used: `other`", 1), ("nothing loads", 0)]
    {
        assert_eq!(told.matches(words).count(), count, "{words}: {told}");
    }
}

/// What is missing or does not go together is told with what there is and what to do, and nothing is written.
#[test]
fn drawings_that_do_not_say_enough_are_told() {
    let svg = |inner: &str| {
        format!("<svg xmlns='http://www.w3.org/2000/svg' width='160mm' viewBox='0 0 160 160'>{inner}</svg>")
    };
    let squares = svg("<rect id='one' width='40' height='40'/><rect id='two' x='80' width='40' height='40'/>");
    let aside = svg("<rect id='body' width='40' height='40'/><path id='crack-1' d='M90 0V40'/>");
    let nameless =
        svg("<rect id='body' width='40' height='40'/><g id='cracks'><path d='M0 9H9'/><path d='M0 20H9'/></g>");
    let closed = svg("<rect id='body' width='40' height='40'/><path id='crack' d='M0 9H9V20Z'/>");
    let pixels = PLATE.replace("width='200mm' height='150mm'", "");
    let glass = ["--material", "glass"];
    for (drawing, arguments, exit, words) in [
        (PLATE, &[][..], 2, &["--material NAME", "pmma"][..]),
        (PLATE, &["--material", "glas"], 2, &["no material `glas`", "`glass`"]),
        (&pixels, &glass, 2, &["no physical size", "--width 0.2"]),
        (&squares, &glass, 2, &["`body`", "`one`, `two`", "plate.svg"]),
        (&aside, &glass, 2, &["`crack-1` lies in no body"]),
        (&nameless, &glass, 2, &["neither id nor label", "line 1"]),
        (&closed, &glass, 2, &["`crack`", "is closed"]),
        ("<svg", &glass, 3, &["not valid SVG"]),
        (PLATE, &["--material", "glass", "--width", "0"], 2, &["--width"]),
    ] {
        let folder = folder(drawing);
        let (code, _, told) = said(folder.path(), &[&["run", "plate.svg"], arguments].concat());
        assert_eq!(code, exit, "{told}");
        words.iter().for_each(|word| assert!(told.contains(word), "{word}: {told}"));
        assert!(!folder.path().join("out").exists());
    }
    let folder = folder(PLATE);
    std::fs::write(folder.path().join("scene.toml"), "").unwrap();
    let (code, _, told) = said(folder.path(), &["run", "scene.toml", "--material", "glass"]);
    assert!(code == 2 && told.contains("`--material` is for drawings"), "{told}");
    assert_eq!(said(folder.path(), &["run", "missing.svg", "--material", "glass"]).0, 3);
}
