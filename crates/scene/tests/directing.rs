//! What directs cracks: guides in time, speed, branching, other materials, painted toughness, flaws.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use common::{Folder, PLATE, paint, scene_with};
use fissure_plane::{Point, segment_distance};
use fissure_scene::{BranchKind, Branching, End, LoadErrorKind, Scene, ToughnessKind, load, material_presets};
use png::{BitDepth, ColorType};

fn plate(rest: &str) -> Scene {
    scene_with(&format!("{PLATE}{rest}"), None, &[]).unwrap()
}

/// Truth: frame n shows the time (n - first) / rate.
#[test]
fn keyframes_count_frames() {
    let scene = plate(
        "[[crack]]\nname = 'notch'\nline = [[-10, 0], [-5, 0]]\nguide = 'path'\n\
         [[guide]]\nname = 'path'\nline = [[-5, 0], [10, 0]]\nstrength = 0.5\nkeyframes = [[11, 0], [31, 0.75], [41, 0.75]]\n\
         [growth]\nspeed_limit = 0.5\nspeed_keyframes = [[1, 2], [21, 0]]\n\
         [frames]\nrange = '1-48'\nrate = 100\n",
    );
    let guide = scene.cracks[0].end_guide.as_ref().unwrap();
    assert_eq!(guide.strength, 0.5);
    assert_eq!(guide.schedule.points, [(0.1, 0.0), (0.3, 0.75), (0.4, 0.75)]);
    assert!((guide.schedule.value(scene.frames.time(21)) - 0.375).abs() < 1e-12);
    assert_eq!(scene.growth.speed_curve.value(scene.frames.time(11)), 1.0);
    let scene = plate(
        "[[crack]]\nline = [[-10, 0], [-5, 0]]\nguide = 'path'\n[[guide]]\nname = 'path'\nline = [[-5, 0], [10, 0]]\n",
    );
    let guide = scene.cracks[0].end_guide.as_ref().unwrap();
    assert_eq!((guide.strength, guide.schedule.points.len(), scene.growth.speed_curve.points.len()), (1.0, 0, 0));
}

/// Truth: at half the time a rise that is slow at first has come a quarter of its way, and one that is slow at last
/// three quarters, in every list of keyframes; the way of a support is the sum of its speeds.
#[test]
fn every_list_of_keyframes_may_be_eased() {
    let scene = plate(
        "[[crack]]\nname = 'notch'\nline = [[-10, 0], [-5, 0]]\nguide = 'path'\n\
         [[guide]]\nname = 'path'\nline = [[-5, 0], [10, 0]]\nkeyframes = [[1, 0], [41, 1]]\nease = 'in'\n\
         [growth]\nspeed_keyframes = [[1, 0], [41, 1]]\nspeed_ease = 'out'\n\
         [frames]\nrange = '1-48'\nrate = 100\n\
         [[load]]\nforce = [1, 0]\ncurve = [[0, 0], [0.4, 1]]\nease = 'in'\n\
         [[support]]\ndisplacement_x = 0.1\ncurve = [[0, 0], [0.4, 1]]\nease = 'out'\n\
         [[collider]]\nshape = { disc = { center = [0, 30], radius = 1 } }\nease = 'in-out'\n\
         keyframes = [{ time = 0 }, { time = 0.4, position = [0, -4], angle = 40 }]\n",
    );
    let guide = scene.cracks[0].end_guide.as_ref().unwrap();
    assert_eq!([guide.schedule.value(0.2), scene.growth.speed_curve.value(0.2)], [0.25, 0.75]);
    assert_eq!(scene.loads[0].curve.value(0.2), 0.25);
    let support = &scene.supports[0];
    let way = support.curve.mean(0.0, 0.2) * 0.2 * support.velocity[0].unwrap();
    assert!((way - 0.075).abs() < 1e-6, "{way}");
    let after = |time: f64| scene.colliders[0].keyframes.iter().find(|k| (k.0 - time).abs() < 1e-12).unwrap().1;
    let [quarter, half] = [0.1, 0.2].map(after);
    assert!((quarter.position.y - (30.0 - 4.0 * 0.15625)).abs() < 1e-12, "{quarter:?}");
    assert!((half.position.y - 28.0).abs() < 1e-12 && (half.angle - 20_f64.to_radians()).abs() < 1e-12, "{half:?}");
}

/// A notch whose guide runs right along y = 0, with other guides and cracks.
fn tree(rest: &str) -> Result<Scene, fissure_scene::LoadError> {
    let trunk = "[grid]\nparticle_spacing = 0.2\n[frames]\nrange = '1-48'\nrate = 100\n\
         [[crack]]\nname = 'notch'\nline = [[-10, 0], [-5, 0]]\nguide = 'trunk'\n\
         [[guide]]\nname = 'trunk'\nline = [[-5, 0], [8, 0]]\nkeyframes = [[1, 0], [41, 1]]\n";
    scene_with(&format!("{PLATE}{trunk}{rest}"), None, &[])
}

/// Truth: the drawing. A guide that nobody refers to, with either end on another one or a little beside it, leaves that
/// one at a point that both have; so do branches of branches, and a crack opens where it ends on one.
#[test]
fn guides_that_begin_on_others_are_their_branches() {
    for (line, beside) in [("[[2, 0.05], [4, 3]]", 0.0), ("[[4, 3], [2, -0.05]]", 0.0), ("[[2, 0], [4, 3]]", 0.0)] {
        let rest = format!(
            "[[guide]]\nname = 'side'\nline = {line}\ndelay = 2\nduration = 10\n\
             [[guide]]\nname = 'twig'\nline = [[3, 1.5], [5, 1.5]]\nbranch_of = 'side'\n\
             [[crack]]\nname = 'drawn'\nline = [[-1, 0.05], [-2, -3]]\n"
        );
        let scene = tree(&rest).unwrap();
        let trunk = scene.cracks[0].end_guide.as_ref().unwrap();
        let places: Vec<Point> = trunk.branches.iter().map(|branch| trunk.points[branch.point]).collect();
        assert_eq!(places, [Point::new(-1.0, beside), Point::new(2.0, beside)]);
        let BranchKind::Drawn { crack: 1, end: End::Start } = trunk.branches[0].kind else { panic!("{trunk:?}") };
        let drawn = &scene.cracks[1];
        assert_eq!((drawn.points[0], drawn.start_live, drawn.end_live), (places[0], false, true));
        let BranchKind::Begins { guide: side, delay, from_passing } = &trunk.branches[1].kind else {
            panic!("{trunk:?}")
        };
        assert_eq!((side.points[0], *delay, *from_passing), (places[1], 0.02, true));
        assert_eq!(side.schedule.points, [(0.0, 0.0), (0.1, 1.0)]);
        let [twig] = side.branches.as_slice() else { panic!("{side:?}") };
        assert!((side.points[twig.point] - Point::new(3.0, 1.5)).norm() < 0.05, "{side:?}");
    }
}

/// Truth: what is wrong, named with its line and a remedy.
#[test]
fn branches_that_lead_nowhere_are_refused() {
    let side = |rest: &str| format!("[[guide]]\nname = 'side'\n{rest}\n");
    for (rest, words) in [
        (side("line = [[2, 1], [4, 3]]\nbranch_of = 'trunk'"), ["`side`", "1 m away"]),
        (side("line = [[2, 0], [4, 3]]\nbranch_of = 'tronk'"), ["`tronk`", "did you mean `trunk`?"]),
        (side("line = [[-5, 0], [4, 3]]\nbranch_of = 'trunk'"), ["`side`", "where that begins"]),
        (side("line = [[2, 1], [4, 3]]\nduration = 3"), ["", ""]),
        (side("line = [[2, 0], [4, 3]]\nduration = -3"), ["duration", "-3"]),
        (side("line = [[2, 0], [4, 3]]\nduration = 3\nkeyframes = [[1, 0]]"), ["both `keyframes`", "`duration`"]),
        (
            format!(
                "{}[[guide]]\nname = 'twig'\nline = [[3, 2], [4, 4]]\nbranch_of = 'side'\n",
                side("line = [[3, 1], [3, 3]]")
            ),
            ["`twig`", "no crack follows"],
        ),
    ] {
        match tree(&rest) {
            Err(error) => {
                assert!(words.iter().all(|word| !word.is_empty() && error.to_string().contains(word)), "{error}")
            }
            Ok(_) => assert_eq!(words, ["", ""], "{rest}"),
        }
    }
    let own = plate_error(
        "[[crack]]\nline = [[-10, 0], [-5, 0]]\nguide = 'g'\n[[guide]]\nname = 'g'\nline = [[-5, 0], [8, 0]]\ndelay = 1\n",
    );
    assert!(own.contains("`delay`") && own.contains("no branch"), "{own}");
}

fn plate_error(rest: &str) -> String {
    scene_with(&format!("{PLATE}{rest}"), None, &[]).unwrap_err().to_string()
}

#[test]
fn branching_is_off_on_or_told() {
    let branching = |rest: &str| plate(&format!("[grid]\nparticle_spacing = 0.25\n[growth]\n{rest}")).growth.branching;
    assert_eq!((branching(""), branching("branching = false\n")), (None, None));
    let usual = Branching { release_ratio: 3.0, half_angle: 27_f64.to_radians(), spacing: 6.0 };
    assert_eq!(branching("branching = true\n"), Some(usual));
    let told = Branching { half_angle: 20_f64.to_radians(), spacing: 1.0, ..usual };
    assert_eq!(branching("branching = { half_angle = 20, spacing = 1 }\n"), Some(told));
}

#[test]
fn regions_change_the_material_and_the_later_one_holds() {
    let scene = plate(
        "[[material]]\nname = 'slow'\nbase = 'glass'\nlimiting_speed = 1500\n\
         [[region]]\nmaterial = 'glass'\nshape = { rectangle = { min = [0, -20], max = [20, 20] } }\n\
         [[region]]\nbody = 'plate'\nmaterial = 'slow'\nshape = { circle = { radius = 2 } }\n",
    );
    let at = |x, y| scene.materials[scene.bodies[0].material_at(Point::new(x, y))].name.as_str();
    assert_eq!([at(-5.0, 0.0), at(5.0, 0.0), at(1.0, 0.0), at(-1.0, 0.0)], ["pmma", "glass", "slow", "slow"]);
    let slow = scene.materials.iter().find(|m| m.name == "slow").unwrap();
    assert_eq!((slow.limiting_speed, slow.young_modulus), (Some(1500.0), 70e9));
    // A region of snow makes the scene one that flows, as a body of snow does.
    let snow = plate("[[region]]\nmaterial = 'snow'\nshape = { circle = { radius = 2 } }\n");
    assert_eq!(snow.solver.kernel, fissure_scene::updated_kernel());
    for material in material_presets() {
        assert!(scene_with(PLATE, None, &[&format!("body.plate.material={}", material.name)]).is_ok());
    }
}

/// Truth: the picture as an eye sees it: left is left, the top row is the highest y; where patches overlap they
/// multiply.
#[test]
fn pictures_lie_on_bodies_the_right_way_up() {
    let folder = Folder::new(
        &format!(
            "{PLATE}[[toughness]]\nimage = 'paint.png'\nblack = 0.5\nwhite = 2.5\n\
             [[toughness]]\nbody = 'plate'\nshape = {{ circle = {{ center = [-5, 5], radius = 1 }} }}\nfactor = 3\n"
        ),
        None,
    );
    let at = |x, y| load(&folder.path(), &[]).unwrap().toughness_factor(0, Point::new(x, y));
    let paint =
        |color, depth, columns, samples: &[u8]| paint(&folder.file("paint.png"), color, depth, columns, samples);
    paint(ColorType::Grayscale, BitDepth::Eight, 2, &[255, 0, 51, 102]);
    // Centres of the pixels of a plate from -10 to 10: 255 and 0 above, 51 and 102 below.
    let expected = [(5.0, 5.0, 0.5), (-5.0, -5.0, 0.9), (5.0, -5.0, 1.3), (-5.0, 5.0, 3.0 * 2.5), (0.0, -5.0, 1.1)];
    for (x, y, factor) in expected {
        assert!((at(x, y) - factor).abs() < 1e-14, "{x} {y}: {} for {factor}", at(x, y));
    }
    // The same in 16 bits and in colour; transparent is white.
    paint(ColorType::Grayscale, BitDepth::Sixteen, 2, &[255, 255, 0, 0, 51, 51, 102, 102]);
    assert!(expected.iter().all(|&(x, y, factor)| (at(x, y) - factor).abs() < 1e-14));
    paint(ColorType::Rgb, BitDepth::Eight, 1, &[255, 0, 0]);
    assert!((at(0.0, 0.0) - (0.5 + 2.0 * 0.2126)).abs() < 1e-14);
    paint(ColorType::GrayscaleAlpha, BitDepth::Eight, 1, &[0, 0]);
    assert_eq!(at(0.0, 0.0), 2.5);
    paint(ColorType::Rgba, BitDepth::Eight, 1, &[0, 0, 0, 51]);
    assert!((at(0.0, 0.0) - (0.5 + 2.0 * 0.8)).abs() < 1e-14);
    // Two bits a pixel: 0, 1/3, 2/3, 1.
    paint(ColorType::Grayscale, BitDepth::Two, 1, &[0b0100_0000]);
    assert!((at(0.0, 0.0) - (0.5 + 2.0 / 3.0)).abs() < 1e-14);
}

#[test]
fn pictures_are_part_of_the_scene() {
    let folder = Folder::new(&format!("{PLATE}[[toughness]]\nimage = 'paint.png'\nmin = [0, 0]\n"), None);
    let paint = |grey: u8| {
        let samples: Vec<u8> = (0..900 * 600).map(|k| if k % 900 < 450 { grey } else { 255 }).collect();
        paint(&folder.file("paint.png"), ColorType::Grayscale, BitDepth::Eight, 900, &samples);
        load(&folder.path(), &[]).unwrap()
    };
    let (black, again, dark) = (paint(0), paint(0), paint(1));
    assert_eq!(black, again);
    assert_ne!(black.hash, dark.hash);
    // The rectangle of 10 m holds 64 particle spacings; pixels are no finer, and sharp edges stay within one.
    let ToughnessKind::Image(image) = &black.toughness[0].kind else { unreachable!() };
    assert_eq!((image.columns, image.rows, image.max), (64, 64, Point::new(10.0, 10.0)));
    let at = |x| black.toughness_factor(0, Point::new(x, 5.0));
    assert_eq!([at(-0.1), at(0.0), at(4.9), at(5.1), at(10.0)], [1.0, 0.2, 0.2, 1.0, 1.0]);
    let json = serde_json::to_string(&black).unwrap();
    assert_eq!(serde_json::from_str::<Scene>(&json).unwrap(), black);
}

#[test]
fn pictures_that_cannot_be_used_are_named() {
    let told = |file: Option<&[u8]>, rest: &str| {
        let folder = Folder::new(&format!("{PLATE}[[toughness]]\nimage = 'paint.png'\n{rest}"), None);
        paint(&folder.file("paint.png"), ColorType::Grayscale, BitDepth::Eight, 1, &[0]);
        match file {
            None => std::fs::remove_file(folder.file("paint.png")).unwrap(),
            Some([]) => {}
            Some(bytes) => std::fs::write(folder.file("paint.png"), bytes).unwrap(),
        }
        let error = load(&folder.path(), &[]).unwrap_err();
        (error.kind, error.line(), error.to_string())
    };
    // The head of a picture of 100,000 by 100,000 pixels.
    let mut vast = Vec::new();
    let mut encoder = png::Encoder::new(&mut vast, 100_000, 100_000);
    encoder.set_color(ColorType::Rgba);
    encoder.write_header().unwrap().write_chunk(png::chunk::IDAT, &[0]).unwrap();
    type Mistake<'a> = (Option<&'a [u8]>, &'a str, LoadErrorKind, Option<usize>, &'a str);
    let mistakes: [Mistake<'_>; 10] = [
        (None, "", LoadErrorKind::InputFile, None, "cannot read the image"),
        (Some(b"<svg/>"), "", LoadErrorKind::InputFile, None, "not a PNG image"),
        (Some(&vast), "", LoadErrorKind::InputFile, None, "100000 x 100000 pixels"),
        (Some(b"\x89PNG\r\n\x1a\n\0\0"), "", LoadErrorKind::InputFile, None, "not a PNG image"),
        (Some(b""), "black = 0\n", LoadErrorKind::Scene, Some(7), "the factor of black is 0; it must be above 0"),
        (Some(b""), "white = -1\n", LoadErrorKind::Scene, Some(7), "the factor of white is -1"),
        (
            Some(b""),
            "min = [20, 0]\n",
            LoadErrorKind::Scene,
            Some(7),
            "min = [20, 0] is not below and left of max = [10, 10]",
        ),
        (Some(b""), "max = [nan, 0]\n", LoadErrorKind::Scene, Some(7), "`max` is NaN"),
        (Some(b""), "factor = 2\n", LoadErrorKind::Scene, Some(7), "`factor` belongs to a `shape`"),
        (
            Some(b""),
            "shape = { circle = { radius = 1 } }\n",
            LoadErrorKind::Scene,
            Some(6),
            "both a `shape` and an `image`",
        ),
    ];
    for (file, rest, kind, line, words) in mistakes {
        let (told_kind, told_line, message) = told(file, rest);
        assert!(
            told_kind == kind && told_line == line && message.contains(words),
            "{message} ({told_line:?}) for {words}"
        );
        assert!(message.contains("paint.png") == (kind == LoadErrorKind::InputFile) || line.is_some(), "{message}");
    }
}

/// Truth: the drawing. Only the free end of the bar of a T can grow, and the two ends of its trunk.
#[test]
fn a_crack_may_end_on_another() {
    let scene = plate("[[crack]]\nline = [[0.001, 0], [0, 5]]\n[[crack]]\nline = [[-5, 0], [5, 0]]\n");
    let live: Vec<_> = scene.cracks.iter().map(|crack| [crack.start_live, crack.end_live]).collect();
    assert_eq!(live, [[false, true], [true, true]]);
    assert_eq!(scene.cracks[0].points[0], scene.cracks[1].points[1]);
    assert!((scene.cracks[0].points[0] - Point::new(0.001, 0.0)).norm() < 1e-12);
}

/// Truth: brute force over all pairs; what a flaw must not touch was measured independently of how it was placed.
#[test]
fn flaws_become_cracks_apart_from_all_others() {
    let text = "[[crack]]\nname = 'notch'\nline = [[-10, 0], [-5, 0]]\n\
                [[flaws]]\ndensity = 0.1\nlength = 1.2\nlength_spread = 0.5\n\
                [[flaws]]\nname = 'upright'\ncount = 7\nlength = 2\nangle = 90\nseed = 5\ntips = 'none'\nmargin = 0.2\n\
                shape = { rectangle = { min = [5, -10], max = [10, 10] } }\n";
    let scene = plate(text);
    assert_eq!(scene.cracks.len(), 1 + 40 + 7);
    assert_eq!([scene.cracks[1].name.as_str(), &scene.cracks[47].name], ["flaws-1.1", "upright.7"]);
    assert!(scene.cracks[1].start_live && scene.cracks[1].end_live && !scene.cracks[47].start_live);
    for (i, crack) in scene.cracks.iter().enumerate().skip(1) {
        let [a, b] = crack.points[..] else { unreachable!() };
        let margin = if i <= 40 { 0.625 } else { 0.2 };
        for other in &scene.cracks[..i] {
            let distance = segment_distance(a, b, other.points[0], other.points[1]);
            assert!(distance >= margin, "{} and {}: {distance}", crack.name, other.name);
        }
        assert!([a, b].iter().all(|p| p.coords.amax() <= 10.0 - margin), "{}", crack.name);
        if i > 40 {
            assert!((a.x - b.x).abs() < 1e-12 && (b.y - a.y - 2.0).abs() < 1e-12 && a.x > 5.0, "{:?}", crack.points);
        }
    }
    let cracks = |seed: &str| scene_with(&format!("{PLATE}{text}"), None, &[seed]).unwrap().cracks;
    assert_eq!(cracks("flaws.0.seed=0"), scene.cracks);
    assert_ne!(cracks("flaws.0.seed=1")[1].points, scene.cracks[1].points);
    assert_ne!(cracks("flaws.0.seed=5")[1].points, cracks("flaws.0.seed=5")[41].points);
}
