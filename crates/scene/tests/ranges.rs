//! Numbers that no scene can mean: refused with value, line and range. Scenes of every honest size: loaded.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{Folder, PLATE, paint, scene_with, work};
use fissure_scene::{LoadErrorKind, load};
use std::time::Duration;

/// A square as a drawing.
const SQUARE: &str =
    r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 2 2"><rect id="s" width="2" height="2"/></svg>"#;

/// Truth: the number is in the message, the line is where it stands, and the range is told.
#[test]
fn numbers_out_of_range_are_told() {
    let drawing = |scale: &str| {
        format!(
            "[drawing]\nfile = 'drawing.svg'\n{scale}\n[[body]]\nname = 'a'\nmaterial = 'pmma'\nshape = {{ svg = 's' }}\n"
        )
    };
    let rectangle = |low: &str, high: &str| {
        format!("[[body]]\nname = 'a'\nmaterial = 'pmma'\n[body.shape.rectangle]\nmin = {low}\nmax = {high}\n")
    };
    let plate = |rest: &str| format!("{PLATE}{rest}");
    let collider = "[[collider]]\nshape = { disc = { center = [0, 20], radius = 1 } }\n";
    #[rustfmt::skip]
    let cases: Vec<(String, usize, &[&str])> = vec![
        (drawing("metres_per_unit = 1e155"), 3, &["1e155", "from 1e-12 to 1000000000 m"]),
        (drawing("metres_per_unit = 1e16"), 3, &["1e16", "from 1e-12"]),
        (drawing("metres_per_unit = 9e8\norigin = 'corner'"), 8, &["`s`", "1800000000"]),
        (drawing("width = 1e-300"), 3, &["1e-300", "from 1e-12"]),
        (plate("[grid]\nparticle_spacing = 1e-20\n"), 6, &["1e-20", "from 1e-12"]),
        (plate("[grid]\nparticle_spacing = 1e-200\n"), 6, &["1e-200", "from 1e-12"]),
        (plate("[grid]\ncell_size = 1e200\n"), 6, &["1e200"]),
        (rectangle("[0, 0]", "[1e30, 1e30]"), 6, &["1e30", "finite: from -1000000000"]),
        (rectangle("[1e30, 0]", "[2e30, 1]"), 5, &["1e30"]),
        (rectangle("[0, 0]", "[1e-30, 1e-30]"), 1, &["1e-30", "box around all bodies"]),
        (rectangle("[1e9, 1e9]", "[1.0001e9, 1.0001e9]"), 6, &["1000100000"]),
        (rectangle("[5e8, 5e8]", "[500000010, 500000010]"), 4, &["`a`", "500000000 m away", "single precision", "steps of", "move the scene"]),
        (rectangle("[1e5, 0]", "[100001, 1]"), 4, &["single precision", "move"]),
        (plate("[[toughness]]\nshape = { rectangle = { min = [-1e154, -1e154], max = [1e154, 1e154] } }\nfactor = 2\n"), 6, &["-1e154"]),
        (plate("[[toughness]]\nshape = { rectangle = { min = [-1e20, -1e20], max = [1e20, 1e20] } }\nfactor = 2\n"), 6, &["-1e20", "finite"]),
        (plate("[[toughness]]\nshape = { circle = { radius = 1 } }\nfactor = 1e300\n"), 7, &["factor", "1e300"]),
        (plate(&format!("{collider}keyframes = [{{ time = 0 }}, {{ time = 1e-45, position = [1, 0] }}]\n")), 7, &["1e-45", "from 1e-15"]),
        (plate(&format!("{collider}keyframes = [{{ time = 0 }}, {{ time = 1e-9, position = [1, 0] }}]\n")), 7, &["velocity", "collider-1", "999999999", "1000000 m/s"]),
        (plate(&format!("{collider}keyframes = [{{ time = 0 }}, {{ time = 1e-12, angle = 1e5 }}]\n")), 7, &["rotation", "rad/s"]),
        (plate(&format!("{collider}keyframes = [{{ time = 1e300 }}]\n")), 7, &["1e300", "1000000000 s"]),
        (plate("[[material]]\nname = 'pmma'\nyoung_modulus = 2.94e20\n"), 7, &["Young", "2.94e20", "1e15 Pa"]),
        (plate("[[material]]\nname = 'pmma'\ndensity = 1e-30\n"), 7, &["1e-30", "kg/m³"]),
        (plate("[[material]]\nname = 'pmma'\nfracture_toughness = 1e-300\n"), 7, &["1e-300"]),
        (plate("[[material]]\nname = 'pmma'\nplasticity = { hardening = 1e9 }\n"), 7, &["hardening", "1000000000", "100"]),
        (plate("velocity = [1e200, 0]\n"), 5, &["velocity", "1e200", "m/s"]),
        (plate("angular_velocity = 1e200\n"), 5, &["1e200", "rad/s"]),
        (plate("[[load]]\nforce = [1e300, 0]\n"), 6, &["1e300", "N/m"]),
        (plate("[[load]]\nforce = [1, 0]\ncurve = [[0, 0], [1, 1e300]]\n"), 7, &["1e300"]),
        (plate("[[load]]\nforce = [1, 0]\ncurve = [[0, 0], [1e300, 1]]\n"), 7, &["time", "1e300"]),
        (plate("[[support]]\nvelocity_x = 1e30\n"), 6, &["1e30"]),
        (plate("[frames]\nrate = 1e300\n"), 6, &["1e300"]),
        (plate("[output]\nroughness = { amplitude = 1e3 }\n"), 6, &["1000 m", "half a cell", "at most"]),
        (plate("[output]\nroughness = { amplitude = 0.01, length = 0.03 }\n"), 6, &["0.03 m", "steep", "at least 0.04"]),
        (plate("[output]\nroughness = { amplitude = 1e-6 }\n"), 6, &["too many", "at least"]),
        (plate("[output]\nwall_step = 3\n"), 6, &["`wall_step` is 3", "at most 2 cells"]),
        (plate("[output]\nbevel = 1e3\n"), 6, &["1000 m", "quarter of a cell", "at most"]),
        (plate("[output]\nbevel = 1e-3\nroughness = { seed = 1 }\n"), 6, &["`roughness`", "0.001", "one of the two"]),
        (plate("[frames]\nrange = '10-100000000000'\n"), 6, &["frames, at most 1000000", "at most 1000000"]),
        (plate("[frames]\nfirst = 0\nlast = 9223372036854775807\n"), 7, &["frames", "at most 1000000"]),
        (plate("[frames]\nlast = 900000\nrate = 1e-6\n"), 6, &["time of the last frame"]),
        (plate("[frames]\nlast = 900000\n[grid]\nparticle_spacing = 0.001\n"), 6, &["particles in all frames"]),
        (plate("[solver]\ndamping = 1e300\n"), 6, &["1e300"]),
        (plate("[solver]\ntime_step = 1e-300\n"), 6, &["1e-300"]),
        (plate("[solver]\nj_radius = 1e300\n"), 6, &["1e300"]),
        (plate("[growth]\nincrement = 1e-300\n"), 6, &["1e-300"]),
        (plate("[output]\nthickness = 1e300\n"), 6, &["1e300"]),
        (plate("[output]\nthickness = 1e-40\n"), 6, &["1e-40"]),
        (format!("gravity = [0, -1e300]\n{PLATE}"), 1, &["-1e300"]),
        (plate("[[flaws]]\nlength = 1e300\ncount = 1\n"), 6, &["1e300"]),
        (plate("[[flaws]]\nlength = 1\ncount = 1\nangle_spread = -1\n"), 8, &["-1", "at least 0"]),
    ];
    let mut wrong = Vec::new();
    for (text, line, words) in cases {
        let start = work();
        let Err(error) = scene_with(&text, Some(SQUARE), &[]) else {
            wrong.push(format!("accepted: {text}"));
            continue;
        };
        let told = error.to_string();
        let missing: Vec<_> = words.iter().filter(|word| !told.contains(**word)).collect();
        let is_late = work() - start > Duration::from_secs(2);
        if !missing.is_empty() || error.line() != Some(line) || error.kind != LoadErrorKind::Scene || is_late {
            wrong.push(format!("{told}\nlacks {missing:?}, or is not at line {line}, of\n{text}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Truth: these are bodies of the world, each with the times and materials of its own size.
#[test]
fn honest_sizes_load() {
    // Side [m], frames per second, Young's modulus [Pa], density [kg/m³], toughness [Pa √m].
    for (side, rate, young, density, toughness) in [
        (1e-6, 1e12, 1.2e12, 3515.0, 5e6), // a grain of diamond
        (1e-3, 1e9, 70e9, 2500.0, 0.75e6), // a chip of glass
        (1.0, 24.0, 1.4e5, 400.0, 1e3),    // a snowball
        (1.0, 1e-3, 1e3, 1000.0, 1e1),     // jelly over hours
        (1e6, 1.0, 70e9, 2700.0, 1e30),    // a mountain that does not break
    ] {
        let text = format!(
            "[[material]]\nname = 'm'\nyoung_modulus = {young:e}\npoisson_ratio = 0.3\ndensity = {density:e}\nfracture_toughness = {toughness:e}\n\
             [[body]]\nname = 'a'\nmaterial = 'm'\nshape = {{ rectangle = {{ min = [0, 0], max = [{side:e}, {side:e}] }} }}\n\
             [[crack]]\nline = [[0, {middle:e}], [{middle:e}, {middle:e}]]\n[frames]\nrate = {rate:e}\n",
            middle = side / 2.0
        );
        let scene = scene_with(&text, None, &[]).unwrap_or_else(|error| panic!("{side} m: {error}"));
        assert_eq!(scene.cracks.len(), 1);
    }
}

/// Truth: the count is in the message, and the refusal is quick.
#[test]
fn counts_are_bounded() {
    let many = |item: &str, count: usize| item.repeat(count);
    let corners = |count: usize| {
        let corner = |i: usize| {
            let (sine, cosine) = (std::f64::consts::TAU * i as f64 / count as f64).sin_cos();
            format!("[{cosine:.9}, {sine:.9}],")
        };
        (0..count).map(corner).collect::<String>()
    };
    let polygon = format!("[[body]]\nname = 'a'\nmaterial = 'pmma'\nshape = {{ polygon = [{}] }}\n", corners(100_001));
    let keyframes = (0..100_001).map(|i| format!("{{ time = {i} }},")).collect::<String>();
    let cases = [
        (polygon, "100001 corners"),
        (format!("{PLATE}{}", many("[[load]]\nforce = [0, 1]\n", 10_001)), "10001 items"),
        (format!("{PLATE}{}", many("[[crack]]\nline = [[0, 0], [1, 0]]\n", 10_001)), "10001 items"),
        (
            format!(
                "{PLATE}[[collider]]\nshape = {{ disc = {{ center = [0, 20], radius = 1 }} }}\nkeyframes = [{keyframes}]\n"
            ),
            "100001 keyframes",
        ),
        (format!("{PLATE}{}", many("[[flaws]]\nlength = 1e-3\ncount = 6000\nmargin = 1e-3\n", 2)), "12000 items"),
        (format!("{PLATE}#{}", many("x", 9 << 20)), "at most 8388608 (8 MiB)"),
        (format!("{PLATE}x = {}{}", many("[", 1000), many("]", 1000)), "recurs"),
        (format!("{PLATE}x{} = 1", many(".x", 1000)), "recurs"),
    ];
    for (text, words) in cases {
        let start = work();
        let told = scene_with(&text, None, &[]).expect_err(words).to_string();
        assert!(told.contains(words), "{told:.300} lacks {words}");
        assert!(work() - start < Duration::from_secs(2), "{words}: {:?}", work() - start);
    }
}

/// Truth: the header says how many pixels there are before any is decoded; a file that ends early, or is no file, says
/// so.
#[test]
fn images_are_bounded_and_whole() {
    let folder = Folder::new(&format!("{PLATE}[[toughness]]\nimage = 'a.png'\n"), None);
    let told = || load(&folder.path(), &[]).unwrap_err().to_string();
    paint(&folder.file("a.png"), png::ColorType::Grayscale, png::BitDepth::One, 16_000, &vec![0; 2_000 * 1_100]);
    assert!(told().contains("16000 x 1100 pixels, at most 16777216"), "{}", told());
    paint(&folder.file("a.png"), png::ColorType::Rgba, png::BitDepth::Sixteen, 16, &[9; 16 * 16 * 8]);
    assert!(load(&folder.path(), &[]).is_ok());
    let bytes = std::fs::read(folder.file("a.png")).unwrap();
    for length in 0..bytes.len() {
        std::fs::write(folder.file("a.png"), &bytes[..length]).unwrap();
        // What comes after the pixels is not needed.
        assert!(length + 16 > bytes.len() || told().contains("not a PNG"), "{length}");
    }
    std::fs::remove_file(folder.file("a.png")).unwrap();
    std::fs::create_dir(folder.file("a.png")).unwrap();
    assert!(told().contains("it is a folder; name a regular file"), "{}", told());
    let scene = format!("{PLATE}{}", "[[toughness]]\nimage = 'b.png'\n".repeat(3));
    let folder = Folder::new(&scene, None);
    paint(&folder.file("b.png"), png::ColorType::Grayscale, png::BitDepth::One, 4096, &vec![0; 512 * 4096]);
    let error = load(&folder.path(), &[]).unwrap_err().to_string();
    assert!(error.contains("4096 x 4096 pixels, at most 0"), "{error}");
}
