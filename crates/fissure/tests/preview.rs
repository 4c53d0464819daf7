//! `fissure preview`: pictures of runs. Truth: what other readers find in them, and geometry.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{assert_same_files, files, folder_with, names, said};
use std::io::Cursor;
use std::path::Path;
use tempfile::TempDir;

/// A plate of 2 m by 1 m with a square hole of .4 m and a notch, pulled for three frames.
const SCENE: &str = r#"
name = "plate"
plane = "stress"

[[body]]
name = "plate"
material = "glass"
shape = { polygon = { exterior = [[0, 0], [2, 0], [2, 1], [0, 1]], holes = [[[1.2, 0.3], [1.6, 0.3], [1.6, 0.7], [1.2, 0.7]]] } }

[[crack]]
name = "notch"
line = [[0.5, 1.1], [0.5, 0.7]]

[[load]]
select = { edge = "left" }
force = [-1e3, 0.0]

[grid]
particle_spacing = 0.05

[frames]
range = "1-3"
rate = 20000.0

[output]
thickness = 0.1
"#;

/// A folder with a run of the plate in `out/plate`.
fn run() -> TempDir {
    let folder = folder_with("plate.toml", SCENE);
    let (code, _, told) = said(folder.path(), &["sim", "plate.toml", "--quiet"]);
    assert_eq!(code, 0, "{told}");
    folder
}

#[track_caller]
fn preview(folder: &Path, arguments: &[&str]) -> String {
    let (code, _, told) = said(folder, &[&["preview", "out/plate"], arguments].concat());
    assert_eq!(code, 0, "{told}");
    told
}

/// Width, height and pixels of a PNG file.
fn pixels(path: &Path) -> (usize, usize, Vec<[u8; 3]>) {
    let mut reader = png::Decoder::new(Cursor::new(std::fs::read(path).unwrap())).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    assert_eq!(info.color_type, png::ColorType::Rgb);
    let pixels = bytes[..info.buffer_size()].chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
    (info.width as usize, info.height as usize, pixels)
}

#[test]
fn frames_a_sheet_and_an_animation_are_made() {
    let folder = run();
    let told = preview(folder.path(), &[]);
    assert!(told.contains("3 pictures, a contact sheet, an animation") && told.contains("preview"), "{told}");
    let made: Vec<String> = names(&folder.path().join("out/plate/preview"));
    let expected = ["plate.0001.png", "plate.0002.png", "plate.0003.png", "plate.gif", "plate_sheet.png"];
    assert_eq!(made.iter().filter(|name| !name.ends_with(".lock")).collect::<Vec<_>>(), expected);
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let animation = std::fs::read(folder.path().join("out/plate/preview/plate.gif")).unwrap();
    let mut decoder = options.read_info(Cursor::new(animation)).unwrap();
    let (width, height, _) = pixels(&folder.path().join("out/plate/preview/plate.0001.png"));
    assert_eq!((usize::from(decoder.width()), usize::from(decoder.height())), (width, height));
    assert!(height % 2 == 0, "films want even numbers");
    let mut delays = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        delays.push(frame.delay);
    }
    assert_eq!(delays, [4, 4, 100], "24 frames per second in hundredths");
}

/// Truth: 2 m² less the hole, over the square of the width; the view from the front keeps lengths.
#[test]
fn what_is_filled_has_the_area_of_the_body() {
    let folder = run();
    preview(folder.path(), &["--frames", "1", "--pictures", "frames", "--size", "800"]);
    let (width, _, pixels) = pixels(&folder.path().join("out/plate/preview/plate.0001.png"));
    // The header and the scale of lengths are ink on paper; the body is neither.
    let is_body = |[r, g, b]: &[u8; 3]| *b > *r && *r > 120 && *r < 200 && *g > *r && *g < 220;
    let rows: Vec<usize> = pixels.chunks(width).map(|row| row.iter().filter(|p| is_body(p)).count()).collect();
    let across = *rows.iter().max().unwrap() as f64;
    let area = rows.iter().sum::<usize>() as f64 / (across / 2.0).powi(2);
    assert!((area / 1.84 - 1.0).abs() < 0.02, "{area} m²");
}

#[test]
fn threads_change_no_bit_and_each_coloring_and_theme_differs() {
    let folder = run();
    preview(folder.path(), &["--output", "one", "--threads", "1", "--color", "stress"]);
    preview(folder.path(), &["--output", "two", "--threads", "2", "--color", "stress"]);
    assert_same_files(&folder.path().join("one"), &folder.path().join("two"));
    let looks = [&[][..], &["--color", "stress"], &["--color", "speed"], &["--theme", "dark"], &["--pitch", "-20"]];
    let mut seen = Vec::new();
    for look in looks {
        preview(folder.path(), &[&["--output", "look", "--frames", "3", "--pictures", "frames"], look].concat());
        let bytes = std::fs::read(folder.path().join("look/plate.0003.png")).unwrap();
        assert!(!seen.contains(&bytes), "{look:?}");
        seen.push(bytes);
    }
}

/// Truth: what is in one piece has nothing to be moved away from. The closed notch, .3 of the 1 m that the plate is
/// high, is a line in the picture.
#[test]
fn what_is_still_whole_is_shown_with_its_cracks_where_fragments_are_to_be_moved_apart() {
    let folder = folder_with("plate.toml", &SCENE.replace("[output]", "[output]\nexplode = { factor = 0.5 }"));
    let (code, _, told) = said(folder.path(), &["sim", "plate.toml", "--quiet"]);
    assert_eq!(code, 0, "{told}");
    preview(folder.path(), &["--frames", "3", "--pictures", "frames", "--size", "800"]);
    let (width, _, pixels) = pixels(&folder.path().join("out/plate/preview/plate.0003.png"));
    let is_red = |[r, g, b]: &[u8; 3]| i32::from(*r) > i32::from(*g).max(i32::from(*b)) + 40;
    let rows = pixels.chunks(width).filter(|row| row.iter().any(is_red)).count();
    assert!(rows > 60, "{rows} rows");
}

/// Truth: the scene. A cut at x = 1 m parts the plate, and its left half has a closed notch at x = .5 m, .3 m deep:
/// shown apart, by much or little, the notch is a line in the middle of that half, with its tip marked.
#[test]
fn closed_cracks_and_tips_go_with_the_fragments_that_are_moved_apart() {
    let cut = "\n[[crack]]\nname = \"cut\"\nline = [[1.0, -0.1], [1.0, 1.1]]\n";
    for factor in [0.5, 0.1] {
        let explode = format!("[output]\nexplode = {{ factor = {factor} }}");
        let folder = folder_with("plate.toml", &(SCENE.replace("[output]", &explode) + cut));
        let (code, _, told) = said(folder.path(), &["sim", "plate.toml", "--quiet"]);
        assert_eq!(code, 0, "{told}");
        preview(folder.path(), &["--frames", "1", "--pictures", "frames", "--size", "800"]);
        let (width, _, pixels) = pixels(&folder.path().join("out/plate/preview/plate.0001.png"));
        let is_red = |[r, g, b]: &[u8; 3]| i32::from(*r) > i32::from(*g).max(i32::from(*b)) + 40;
        let in_the_middle = |row: &&[[u8; 3]]| {
            let left = row.iter().position(|pixel| *pixel != row[0]);
            let reds: Vec<usize> = (0..width).filter(|&x| is_red(&row[x])).collect();
            let (Some(left), Some(&notch)) = (left, reds.first()) else { return false };
            let cut = reds.iter().find(|&&x| x > notch + 20);
            cut.is_some_and(|&cut| (cut - notch).abs_diff(notch - left) < 8)
        };
        let rows = pixels.chunks(width).filter(in_the_middle).count();
        assert!(rows > 60, "{rows} rows at {factor}");
        // The tip of the notch is marked at its lower end.
        let (last, row) = pixels.chunks(width).enumerate().rfind(|(_, row)| in_the_middle(row)).unwrap();
        let notch = (0..width).find(|&x| is_red(&row[x])).unwrap();
        let is_tip = |x: usize, y: usize| pixels[y * width + x] == [200, 20, 40];
        let marks: Vec<(usize, usize)> = (last - 20..last + 20)
            .flat_map(|y| (notch - 20..notch + 20).map(move |x| (x, y)))
            .filter(|&(x, y)| is_tip(x, y))
            .collect();
        let mean = marks.iter().map(|mark| mark.0 as f64).sum::<f64>() / marks.len() as f64;
        assert!(marks.len() > 20 && (mean - notch as f64).abs() < 4.0, "{mean} of {} at {factor}", marks.len());
    }
}

#[test]
fn a_picture_of_others_is_kept_and_ours_are_replaced() {
    let folder = run();
    let all = ["--output", "pictures", "--html", "--pictures", "frames,sheet,gif"];
    preview(folder.path(), &all);
    preview(folder.path(), &all);
    for theirs in ["plate.gif", "plate_sheet.png", "plate.0002.png", "plate.html"] {
        let path = folder.path().join("pictures").join(theirs);
        let ours = std::fs::read(&path).unwrap();
        std::fs::write(&path, "years of work").unwrap();
        let before = files(folder.path());
        let (code, _, told) = said(folder.path(), &[&["preview", "out/plate"], &all[..]].concat());
        assert!(code == 3 && told.contains(theirs) && told.contains("--output"), "{code} {told}");
        assert!(files(folder.path()) == before);
        std::fs::write(&path, ours).unwrap();
    }
}

/// A page that holds all it needs: nothing in it asks for another file.
#[test]
fn the_page_is_one_file_and_a_run_makes_it_too() {
    let folder = run();
    let told = preview(folder.path(), &["--html"]);
    assert!(told.contains("wrote a page into"), "{told}");
    let page = std::fs::read_to_string(folder.path().join("out/plate/preview/plate.html")).unwrap();
    for asks in ["<link", " src=", "import(", "fetch(", "XMLHttpRequest"] {
        let own = page.replace(include_str!("../../../assets/three/three.bundle.min.js"), "");
        assert!(!own.contains(asks), "{asks}");
    }
    let (code, _, told) = said(folder.path(), &["run", "plate.toml", "--output", "again", "--preview"]);
    assert!(code == 0 && told.contains("fissure preview again"), "{told}");
    let again = std::fs::read_to_string(folder.path().join("again/preview/plate.html")).unwrap();
    assert!(again == page);
    assert!(folder.path().join("again/preview/plate_sheet.png").is_file());
}

#[test]
fn wrong_input_is_named() {
    let folder = run();
    let cases: [(&[&str], i32, &[&str]); 7] = [
        (&["out/plate", "--frames", "2-9"], 2, &["frame 9", "1-3"]),
        (&["out/plate", "--size", "12"], 2, &["160..=4096"]),
        (&["out/plate", "--yaw", "90"], 2, &["-80 to 80"]),
        (&["out/plate", "--color", "heat"], 2, &["fragment", "stress", "speed"]),
        (&["out/plate", "--pictures", "film"], 2, &["frames", "sheet", "gif"]),
        (&["nowhere"], 3, &["nowhere"]),
        (&["plate.toml"], 3, &["plate.toml"]),
    ];
    for (arguments, exit, words) in cases {
        let (code, _, told) = said(folder.path(), &[&["preview"], arguments].concat());
        assert_eq!(code, exit, "{told}");
        for word in words {
            assert!(told.contains(word), "{word} is missing: {told}");
        }
    }
    assert!(!folder.path().join("out/plate/preview").exists());
}
