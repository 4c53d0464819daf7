//! Scenes as users write them: what loads, and what each mistake is told.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{Folder, PLATE, paint, scene_with};
use fissure_scene::{
    BoxSide, ColliderShape, Kernel, LoadErrorKind, LoadKind, Point, Scene, Selection, SolverPreset, Transfer, load,
    load_with_warnings, schema, solver_preset, template,
};
use std::path::PathBuf;

#[test]
fn the_template_loads() {
    let scene = scene_with(template(), None, &[]).unwrap();
    assert_eq!(scene.bodies[0].name, "plate");
    assert_eq!((scene.particle_spacing, scene.cell_size), (0.25, 0.5));
    assert_eq!((scene.cracks[0].start_live, scene.cracks[0].end_live), (false, true));
    assert_eq!((scene.frames.first, scene.frames.last, scene.frames.rate), (1, 48, 2400.0));
    // The mouth is a corner of the outline to the bit.
    assert!(scene.bodies[0].region.exterior.contains(&scene.cracks[0].points[0]));
    assert_eq!(scene.loads[0].selection, Selection::Edge { side: BoxSide::Top, bodies: None });
    assert_eq!(scene.hash.len(), 64);
}

/// Truth: what the comments of the template offer can be taken out of them.
#[test]
fn the_templates_comments_load() {
    let open = |block: &str| {
        let all_comment = block.lines().all(|line| line.starts_with("# "));
        let offered = ["# [[region]]", "# [[toughness]]", "# [[guide]]", "# [[flaws]]"]
            .iter()
            .any(|head| block.starts_with(head));
        assert_eq!(offered, all_comment && block.starts_with("# [["), "{block}");
        if offered { block.lines().map(|line| &line[2..]).collect::<Vec<_>>().join("\n") } else { block.to_owned() }
    };
    let text = template().split("\n\n").map(open).collect::<Vec<_>>().join("\n\n");
    let text = ["# guide =", "# branching =", "# speed_keyframes ="].iter().fold(text, |text, key| {
        assert!(text.contains(key), "{key}");
        text.replace(key, &key[2..])
    });
    let folder = Folder::new(&text, None);
    paint(&folder.file("toughness.png"), png::ColorType::Grayscale, png::BitDepth::Eight, 4, &[0; 16]);
    let scene = load(&folder.path(), &[]).unwrap();
    assert_eq!((scene.bodies[0].inclusions.len(), scene.toughness.len(), scene.cracks.len()), (1, 1, 21));
    assert_eq!(scene.cracks[0].end_guide.as_ref().unwrap().schedule.points.len(), 2);
    assert!(scene.growth.branching.is_some() && scene.growth.speed_curve.points.len() == 2);
}

#[test]
fn defaults_yield_to_the_file_and_the_file_to_overrides() {
    let scene = scene_with(PLATE, None, &[]).unwrap();
    let (solver, growth) = solver_preset(SolverPreset::Standard);
    assert_eq!((scene.solver, scene.growth), (solver, growth));
    assert_eq!((scene.particle_spacing, scene.output.thickness), (20.0 / 128.0, 2.0));

    let text = format!("{PLATE}[solver]\npreset = 'thesis'\ncourant = 0.5\ntransfer = {{ flip = 0.9 }}\n");
    let scene =
        scene_with(&text, None, &["solver.courant=0.25", "body.plate.material=glass", "growth.bending=2"]).unwrap();
    assert_eq!(scene.solver.kernel, Kernel::Cubic);
    assert_eq!(scene.solver.transfer, Transfer::Flip(0.9));
    assert_eq!((scene.solver.courant, scene.growth.bending), (0.25, 2.0));
    assert_eq!(scene.materials[scene.bodies[0].material].young_modulus, 70e9);

    // Overrides are part of the hash.
    let folder = Folder::new(PLATE, None);
    let hash = |set: &[String]| load(&folder.path(), set).unwrap().hash;
    assert_ne!(hash(&[]), hash(&["gravity=[0, -9.81]".into()]));
    assert_eq!(hash(&[]), hash(&[]));
}

#[test]
fn materials_build_on_each_other() {
    let text = format!(
        "{PLATE}[[material]]\nname = 'pmma'\ndensity = 1000\n[[material]]\nname = 'ice'\nbase = 'pmma'\nplasticity = {{ hardening = 5 }}\n"
    );
    let scene = scene_with(&text, None, &["body.plate.material=ice", "material.glass.density=9"]).unwrap();
    let ice = &scene.materials[scene.bodies[0].material];
    assert_eq!((ice.density, ice.young_modulus), (1000.0, 2.94e9));
    assert_eq!(ice.plasticity.unwrap().hardening, 5.0);
    assert_eq!(ice.plasticity.unwrap().critical_stretch, 7.5e-3);
    assert_eq!(scene.materials.iter().find(|m| m.name == "glass").unwrap().density, 9.0);
}

#[test]
fn everything_inline_is_understood() {
    let text = format!(
        r#"{PLATE}
velocity = [1, 2]
angular_velocity = 3
[[collider]]
name = "floor"
shape = {{ half_plane = {{ point = [0, -12], normal = [0, 2] }} }}
contact = "slip"
friction = inf
keyframes = [{{ time = 0 }}, {{ time = 1, position = [0, 3], angle = 90 }}]
[[collider]]
shape = {{ polygon = [[20, 0], [22, 0], [22, 2], [20, 2]] }}
[[load]]
select = {{ near = [[0, 0]], radius = 1 }}
per_point = [{{ at = [0, 0], force = [1, 0] }}]
[contact]
friction = 0.3
pairs = [{{ materials = ["glass", "snow"], friction = inf }}]
[[support]]
select = {{ edge = "left", body = "plate" }}
fix = "x"
[[support]]
velocity_y = -2.0
curve = [[0, 0], [1, 1]]
[[initial_velocity]]
select = {{ region = {{ circle = {{ radius = 2 }} }} }}
velocity = [0, 1]
"#
    );
    let scene = scene_with(&text, None, &["solver.time_step=1e-6", "frames.range=1001-1010"]).unwrap();
    let floor = &scene.colliders[0];
    assert_eq!(floor.shape, ColliderShape::HalfPlane { normal: fissure_scene::Vector::y() });
    assert_eq!(floor.keyframes[1].1.position, Point::new(0.0, -9.0));
    assert_eq!(floor.keyframes[1].1.angle, std::f64::consts::FRAC_PI_2);
    assert_eq!(floor.friction, f64::INFINITY);
    assert_eq!(scene.colliders[1].keyframes[0].1.position, Point::new(21.0, 1.0));
    assert_eq!(scene.colliders[1].name, "collider-2");
    assert!(matches!(scene.loads[0].kind, LoadKind::PerPoint(ref f) if f.len() == 1));
    let index = |name: &str| scene.materials.iter().position(|m| m.name == name).unwrap();
    let [glass, snow] = scene.contact.pairs[0].materials;
    assert_eq!([glass, snow], ["glass", "snow"].map(index));
    assert_eq!(scene.contact.friction_between(snow, glass), f64::INFINITY);
    assert_eq!(scene.contact.friction_between(glass, glass), 0.3);
    assert_eq!(scene.supports[0].velocity, [Some(0.0), None]);
    assert_eq!(scene.supports[1].velocity, [None, Some(-2.0)]);
    assert_eq!(scene.bodies[0].velocities.len(), 2);
    assert!(scene.bodies[0].velocities[0].center.coords.norm() < 1e-12);
    assert_eq!(scene.solver.time_step, Some(1e-6));
    assert_eq!((scene.frames.first, scene.frames.count()), (1001, 10));
    // A take keeps the scene as JSON, infinite friction included.
    let json = serde_json::to_string(&scene).unwrap();
    assert_eq!(serde_json::from_str::<Scene>(&json).unwrap(), scene);
}

const LINE: &str = "[[crack]]\nname = 'notch'\nline = [[-10, 0], [-5, 0]]\n";

#[test]
fn cracks_are_cut_at_the_outline_and_guides_at_the_tip() {
    let text = format!(
        "{PLATE}[[crack]]\nname = 'notch'\nline = {{ points = [[-13, 1], [-5, 0]] }}\nguide = 'path'\n\
         [[guide]]\nname = 'path'\nline = [[-13, 1], [-9, 0.5], [-5, 0], [0, 2], [10, 0]]\n"
    );
    let scene = scene_with(&text, None, &[]).unwrap();
    let crack = &scene.cracks[0];
    assert_eq!(crack.points[0].x, -10.0);
    assert!((crack.points[0].y - 0.625).abs() < 1e-12);
    assert!(scene.bodies[0].region.exterior.contains(&crack.points[0]));
    assert_eq!(scene.bodies[0].region.exterior.len(), 5);
    let guide = crack.end_guide.as_ref().unwrap();
    assert_eq!(guide.points, [(-5.0, 0.0), (0.0, 2.0), (10.0, 0.0)].map(|(x, y)| Point::new(x, y)));
    assert!(scene_with(&format!("{PLATE}{LINE}"), None, &["crack.0.tips=both"]).is_err());
    assert!(!scene_with(&format!("{PLATE}{LINE}"), None, &["crack.notch.tips=none"]).unwrap().cracks[0].end_live);
}

/// The scene, an override, the kind of error, the line it is shown at, and words that message and remedy must have.
type Mistake = (String, &'static str, LoadErrorKind, Option<usize>, &'static [&'static str]);

#[test]
fn every_mistake_is_told_with_line_value_and_remedy() {
    use LoadErrorKind::Scene;
    let body = "[[body]]\nname = 'a'\nmaterial = 'pmma'\n";
    let plate = |rest: &str| format!("{PLATE}{rest}");
    let own = |rest: &str| format!("{body}{rest}");
    let guide = |line: &str| format!("{PLATE}{LINE}guide = 'path'\n[[guide]]\nname = 'path'\nline = {line}\n");
    #[rustfmt::skip]
    let cases: Vec<Mistake> = vec![
        ("[[body]\n".into(), "", Scene, Some(1), &["TOML"]),
        (plate("[solver]\npresett = 'thesis'\n"), "", Scene, Some(6), &["unknown key `presett`", "`solver`", "did you mean `preset`?"]),
        (plate("[solver]\npreset = 'thesiss'\n"), "", Scene, Some(6), &["thesiss", "did you mean `thesis`?"]),
        (plate(""), "solver.presett=thesis", Scene, Some(1), &["unknown key `presett`", "did you mean `preset`?", "--set"]),
        (plate(""), "body.plat.material=glass", Scene, Some(1), &["no item `plat`", "did you mean `plate`?"]),
        (plate(""), "crack.0.tips=both", Scene, Some(1), &["`crack`", "0 items"]),
        (plate(""), "nonsense", Scene, Some(1), &["no `=`", "--set"]),
        (plate("[frames]\nrate = 'fast'\n"), "", Scene, Some(6), &["frames.rate", "fast"]),
        ("name = 'x'\n".into(), "", Scene, None, &["no body", "[[body]]"]),
        ("[[body]]\nname = 'a'\nmaterial = 'pmma'\n".into(), "", Scene, Some(1), &["lacks the key `shape`"]),
        (own("shape = { rectangle = { min = [0, 0, 0], max = [1, 1] } }\n"), "", Scene, Some(4), &["body[0].shape.rectangle.min", "[0, 0, 0]", "two numbers"]),
        (own("shape = { rectangle = { min = [1, 0], max = [0, 1] } }\n"), "", Scene, Some(4), &["[1.0, 0.0]", "lower left"]),
        (own("shape = { circle = { radius = -2 } }\n"), "", Scene, Some(4), &["radius", "-2", "above 0"]),
        (own("shape = { circle = { radius = nan } }\n"), "", Scene, Some(4), &["radius", "NaN"]),
        (own("shape = { polygon = [[0, 0], [2, 2], [2, 0], [0, 2]] }\n"), "", Scene, Some(4), &["`a`", "crosses", "(1, 1)"]),
        (own("shape = { polygon = [[0, 0], [2, 2]] }\n"), "", Scene, Some(4), &["2 corners", "at least 3"]),
        (own("shape = { polygon = [[0, 0], [2, 2], [4, 4]] }\n"), "", Scene, Some(4), &["no area"]),
        (own("shape = { polygon = [[0, 0], [2, 0], [inf, 4]] }\n"), "", Scene, Some(4), &["inf", "finite"]),
        (own("shape = { polygon = { exterior = [[0, 0], [4, 0], [0, 4]], holes = [[[5, 5], [6, 5], [5, 6]]] } }\n"), "", Scene, Some(4), &["hole", "(5,"]),
        (own("shape = { svg = 'a' }\n"), "", Scene, Some(4), &["drawing"]),
        (plate(""), "body.plate.material=plastic", Scene, Some(1), &["`plastic`", "`pmma`"]),
        (plate("[[material]]\nname = 'x'\nyoung_modulus = 1e9\n"), "", Scene, Some(5), &["`x`", "poisson_ratio", "base"]),
        (plate("[[material]]\nname = 'pmma'\nyoung_modulus = -1e9\n"), "", Scene, Some(7), &["Young", "`pmma`", "-1000000000", "above 0"]),
        (plate("[[material]]\nname = 'pmma'\ndensity = nan\n"), "", Scene, Some(7), &["density", "NaN"]),
        (plate("[[material]]\nname = 'pmma'\npoisson_ratio = 0.5\n"), "", Scene, Some(7), &["0.5", "below 0.5"]),
        (plate("[[material]]\nname = 'a'\nbase = 'b'\n[[material]]\nname = 'b'\nbase = 'a'\n"), "", Scene, None, &["circle"]),
        (plate("[output]\nthickness = 0\n"), "", Scene, Some(6), &["thickness", "0", "above 0"]),
        (plate("[output]\nthickness = -1\n"), "", Scene, Some(6), &["-1"]),
        (plate("[grid]\nparticle_spacing = 30\n"), "", Scene, Some(6), &["30", "`plate`", "20", "at most 5 m"]),
        (plate("[grid]\nparticle_spacing = 0\n"), "", Scene, Some(6), &["spacing", "above 0"]),
        (plate("[grid]\nparticle_spacing = 1e-9\n"), "", Scene, Some(6), &["0.000000001", "usual"]),
        (plate("[frames]\nrate = 0\n"), "", Scene, Some(6), &["rate", "0"]),
        (plate("[frames]\nfirst = 5\nlast = 4\n"), "", Scene, Some(7), &["4", "5"]),
        (plate("[frames]\nrange = '1..4'\n"), "", Scene, Some(6), &["1..4", "1-48"]),
        (plate("[solver]\ncourant = 1.5\n"), "", Scene, Some(6), &["1.5", "at most 1"]),
        (plate("[[load]]\nforce = [1, 0]\ncurve = [[0, 0], [2, 1], [1, 0]]\n"), "", Scene, Some(7), &["rise", "1 s", "2 s"]),
        (plate("[[load]]\ntraction = [1, 0]\n"), "", Scene, Some(6), &["edge"]),
        (plate("[[load]]\nforce = [1, 0]\ntraction = [1, 0]\n"), "", Scene, Some(5), &["exactly one"]),
        (plate("[[load]]\nselect = { near = [[0, 0]], radius = 1 }\npressure = 1\n"), "", Scene, Some(6), &["acts on edges", "points", "`region`"]),
        (plate("[[load]]\nselect = { edge = 'left' }\npressure = nan\n"), "", Scene, Some(7), &["the pressure", "NaN"]),
        (plate("[[load]]\nselect = { edge = 'left' }\npressure = 1\ntraction = [1, 0]\n"), "", Scene, Some(5), &["exactly one", "`pressure`"]),
        (plate("[[load]]\nselect = { crack = 'crack-2' }\npressure = 1\n[[crack]]\nline = [[-10, 0], [-5, 0]]\n"), "", Scene, Some(6), &["no crack `crack-2`", "did you mean `crack-1`?"]),
        (plate("[[load]]\nselect = { crack = 'c' }\npressure = 1\n"), "", Scene, Some(6), &["no crack `c`", "there are none"]),
        (plate("[[load]]\nselect = { crack = 'c', edge = 'left' }\npressure = 1\n"), "", Scene, Some(6), &["cannot combine `crack` and `edge`"]),
        (plate("[[support]]\nselect = { crack = 'c' }\nfix = 'x'\n"), "", Scene, Some(6), &["`c`", "only a load with a `pressure`"]),
        (plate("[[support]]\nselect = { body = 'plat' }\nfix = 'x'\n"), "", Scene, Some(6), &["`plat`", "did you mean `plate`?"]),
        (plate("[[collider]]\nshape = { disc = { center = [0, 0], radius = 0 } }\n"), "", Scene, Some(6), &["radius", "collider-1"]),
        (plate("[[collider]]\nshape = { disc = { center = [0, 0], radius = 1 } }\nkeyframes = [{ time = 1 }, { time = 1 }]\n"), "", Scene, Some(7), &["rise"]),
        (plate("[[body]]\nname = 'b'\nmaterial = 'pmma'\nshape = { circle = { radius = 1 } }\n"), "", Scene, Some(8), &["overlaps", "`plate`", "`b`"]),
        (plate("[[body]]\nname = 'plate'\nmaterial = 'pmma'\nshape = { circle = { center = [30, 0], radius = 1 } }\n"), "", Scene, Some(6), &["two", "`plate`"]),
        (plate("[[crack]]\nline = [[20, 0], [30, 0]]\n"), "", Scene, Some(6), &["`crack-1`", "(20, 0)", "outside"]),
        (plate("[[crack]]\nline = [[1, 1], [1, 1]]\n"), "", Scene, Some(6), &["zero length", "(1, 1)"]),
        (plate("[[crack]]\nline = [[0, 0], [2, 2], [2, 0], [0, 2]]\n"), "", Scene, Some(6), &["crosses itself", "(1, 1)"]),
        (plate("[[crack]]\nline = [[0, 0], [nan, 2]]\n"), "", Scene, Some(6), &["NaN"]),
        (plate("[[crack]]\nline = [[-10, 0], [-5, 0]]\ntips = 'start'\n"), "", Scene, Some(7), &["start", "outline", "(-10, 0)"]),
        (plate("[[crack]]\nline = [[-5, 0], [5, 0]]\n[[crack]]\nline = [[0, -5], [0, 5]]\n"), "", Scene, Some(8), &["crack-1", "crack-2", "(0, 0)"]),
        (plate(&format!("{LINE}guide = 'pth'\n[[guide]]\nname = 'path'\nline = [[-5, 0], [10, 0]]\n")), "", Scene, Some(8), &["`pth`", "did you mean `path`?"]),
        (guide("[[-3, 0], [10, 0]]"), "", Scene, Some(11), &["does not start at the tip", "(-5, 0)", "2 m away"]),
        (guide("[[-10, 5], [-5, 0], [10, 0]]"), "", Scene, Some(11), &["leaves the crack"]),
        (guide("[[-5, 0], [10, 0]]\nstrength = 1.5"), "", Scene, Some(12), &["strength", "`path`", "1.5", "0 to 1"]),
        (guide("[[-5, 0], [10, 0]]\nkeyframes = [[1, 0], [1, 1]]"), "", Scene, Some(12), &["frames", "`path`", "1 comes after 1", "each frame once"]),
        (guide("[[-5, 0], [10, 0]]\nkeyframes = [[1, 0.5], [2, 0.25]]"), "", Scene, Some(12), &["goes back", "0.25", "0.5"]),
        (guide("[[-5, 0], [10, 0]]\nkeyframes = [[1, 0], [2, 1.25]]"), "", Scene, Some(12), &["fraction", "1.25", "0 to 1"]),
        (guide("[[-5, 0], [10, 0]]\nkeyframe = [[1, 0]]"), "", Scene, Some(12), &["`keyframe`", "did you mean `keyframes`?"]),
        (plate("[growth]\nspeed_keyframes = [[1, 1], [2, -1]]\n"), "", Scene, Some(6), &["speed limit", "-1", "at least 0"]),
        (plate("[growth]\nspeed_limit = 0.5\nspeed_keyframes = [[1, 1], [2, 3]]\n"), "", Scene, Some(7), &["3", "1.5 Rayleigh", "at most 2"]),
        (plate("[growth]\nspeed_keyframes = [[2, 1], [1, 1]]\n"), "", Scene, Some(6), &["frames", "1 comes after 2"]),
        (plate("[growth]\nbranching = 'yes'\n"), "", Scene, Some(6), &["growth.branching", "true, false or a table"]),
        (plate("[growth]\nbranching = { release_rate = 3 }\n"), "", Scene, Some(6), &["unknown key `release_rate`", "did you mean `release_ratio`?"]),
        (plate("[growth.branching]\nrelease_ratio = 1\n"), "", Scene, Some(6), &["release_ratio", "1", "above 1"]),
        (plate("[growth.branching]\nhalf_angle = 95\n"), "", Scene, Some(6), &["half_angle", "95", "below 90"]),
        (plate("[growth.branching]\nspacing = 0\n"), "", Scene, Some(6), &["spacing", "0", "above 0"]),
        (plate("[[material]]\nname = 'pmma'\nlimiting_speed = 0\n"), "", Scene, Some(7), &["speed", "`pmma`", "0", "above 0"]),
        (plate("[[region]]\nmaterial = 'glas'\nshape = { circle = { radius = 1 } }\n"), "", Scene, Some(6), &["`glas`", "did you mean `glass`?"]),
        (plate("[[region]]\nbody = 'plat'\nmaterial = 'glass'\nshape = { circle = { radius = 1 } }\n"), "", Scene, Some(6), &["`plat`", "did you mean `plate`?"]),
        (plate("[[region]]\nmaterial = 'glass'\nshape = { circle = { center = [30, 0], radius = 1 } }\n"), "", Scene, Some(7), &["does not overlap any body", "move"]),
        (plate("[[region]]\nmaterial = 'glass'\nshape = { polygon = [[0, 0], [2, 2], [2, 0], [0, 2]] }\n"), "", Scene, Some(7), &["region", "crosses", "(1, 1)"]),
        (plate("[[toughness]]\nfactor = 2\n"), "", Scene, Some(5), &["neither `shape` nor `image`"]),
        (plate("[[toughness]]\nshape = { circle = { radius = 1 } }\n"), "", Scene, Some(5), &["lacks its factor"]),
        (plate("[[toughness]]\nshape = { circle = { radius = 1 } }\nfactor = 0\n"), "", Scene, Some(7), &["factor", "0", "above 0"]),
        (plate("[[toughness]]\nshape = { circle = { radius = 1 } }\nfactor = 2\nblack = 1\n"), "", Scene, Some(8), &["`black` belongs to an `image`"]),
        (plate("[[toughness]]\nshape = { circle = { center = [0, 30], radius = 1 } }\nfactor = 2\n"), "", Scene, Some(6), &["does not overlap"]),
        (plate("[[flaws]]\nlength = 1\n"), "", Scene, Some(5), &["exactly one", "`density`", "`count`"]),
        (plate("[[flaws]]\nlength = 1\ncount = 2\ndensity = 1\n"), "", Scene, Some(7), &["exactly one"]),
        (plate("[[flaws]]\ncount = 2\n"), "", Scene, Some(5), &["lacks the key `length`"]),
        (plate("[[flaws]]\nlength = -1\ncount = 2\n"), "", Scene, Some(6), &["length", "-1", "above 0"]),
        (plate("[[flaws]]\nlength = 1\nlength_spread = 1\ncount = 2\n"), "", Scene, Some(7), &["spread", "below 1"]),
        (plate("[[flaws]]\nlength = 1\ncount = 2\nmargin = 0\n"), "", Scene, Some(8), &["margin", "0", "above 0"]),
        (plate("[[flaws]]\nlength = 1\ncount = -2\n"), "", Scene, Some(7), &["flaws[0].count", "-2"]),
        (plate("[[flaws]]\nlength = 1\ndensity = 1e-4\n"), "", Scene, Some(7), &["no flaw", "400 m²", "0.0025"]),
        (plate("[[flaws]]\nlength = 1\ndensity = 1e9\n"), "", Scene, Some(7), &["400000000000 flaws", "at most 10000"]),
        (plate("[[flaws]]\nlength = 5\ncount = 500\n"), "", Scene, Some(7), &["of 500 flaws fit", "at most `count = ", "`margin` (0.625 m)"]),
        (plate("[[flaws]]\nlength = 30\ndensity = 0.1\n"), "", Scene, Some(7), &["only 0 of 40", "make `length` (30 m)"]),
        (plate("[[flaws]]\nlength = 1\ncount = 2\nshape = { circle = { center = [30, 0], radius = 1 } }\n"), "", Scene, Some(8), &["no body reaches"]),
        (plate("[[flaws]]\nlength = 1\ncount = 2\n[[crack]]\nname = 'flaws-1.2'\nline = [[-10, 0], [-5, 0]]\n"), "", Scene, Some(5), &["two", "`flaws-1.2`"]),
        (plate("[[crack]]\nline = [[-10, 0], [5, 0]]\n[[crack]]\nline = [[0, -5], [0, 5]]\n"), "", Scene, Some(8), &["`crack-2` meets crack `crack-1` at (0, 0)", "end on"]),
        (plate("[[crack]]\nline = [[-5, 0], [5, 0]]\n[[crack]]\nline = [[0, 0], [0, 5]]\ntips = 'both'\n"), "", Scene, Some(9), &["the start of crack `crack-2`", "on another crack"]),
        (plate("[[crack]]\nline = [[-5, 0], [5, 0]]\n[[crack]]\nline = [[5, 0], [5, 5]]\n"), "", Scene, Some(8), &["meets", "draw them as one"]),
        (plate("[[flaws]]\nlength = 1\ncount = 2\nlive = 'both'\n"), "", Scene, Some(8), &["unknown key `live`"]),
    ];
    let mut wrong = Vec::new();
    for (text, set, kind, line, words) in cases {
        let overrides: Vec<&str> = if set.is_empty() { vec![] } else { vec![set] };
        let Err(error) = scene_with(&text, None, &overrides) else {
            wrong.push(format!("accepted: {text}"));
            continue;
        };
        let told = error.to_string();
        let missing: Vec<_> = words.iter().filter(|word| !told.contains(**word)).collect();
        let shown = error.source_text.as_deref().and_then(|t| t.get(error.span.clone().unwrap_or(0..0)));
        if error.kind != kind
            || (line.is_some() && error.line() != line)
            || !missing.is_empty()
            || error.remedy.len() < 6
            || shown.is_none()
        {
            wrong.push(format!(
                "{told}\nlacks {missing:?}, is {:?} at line {:?}, not {line:?}, of\n{text}",
                error.kind,
                error.line()
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_missing_file_is_named() {
    let error = load(&PathBuf::from("no/such/scene.toml"), &[]).unwrap_err();
    assert_eq!(error.kind, LoadErrorKind::InputFile);
    assert!(error.to_string().contains("no/such/scene.toml"), "{error}");
}

/// Truth: the keys the template uses are in the schema, with descriptions.
#[test]
fn the_schema_describes_every_key() {
    let schema = schema();
    for table in ["body", "crack", "load", "grid", "frames", "output", "solver"] {
        assert!(schema["properties"][table]["description"].is_string(), "{table}");
    }
    let definitions = schema["$defs"].as_object().unwrap();
    assert!(definitions.len() > 20);
    for (name, definition) in definitions {
        let Some(properties) = definition["properties"].as_object() else { continue };
        assert_eq!(definition["additionalProperties"], serde_json::json!(false), "{name}");
        for (key, property) in properties {
            assert!(property["description"].is_string(), "{name}.{key} has no description");
        }
    }
}

const HOLED: &str = "[[body]]\nname = 'plate'\nmaterial = 'pmma'\nshape = { polygon = { exterior = [[-10, -10], [10, -10], [10, 10], [-10, 10]], \
                     holes = [[[-2, -2], [2, -2], [2, 2], [-2, 2]]] } }\n";

/// Truth: the construction. A line across a hole gives a crack on both sides of it, with mouths in the corners made for
/// them; keys of tips and guides mean the ends of the line.
#[test]
fn a_crack_across_a_hole_is_its_pieces() {
    let crack = |line: &str, rest: &str| {
        let guide = "[[guide]]\nname = 'path'\nline = [[6, 1], [8, 3]]\n";
        scene_with(&format!("{HOLED}[[crack]]\nname = 'c'\nline = {line}\n{rest}\n{guide}"), None, &[])
    };
    let scene = crack("[[-11, 1], [6, 1]]", "guide = 'path'").unwrap();
    let found: Vec<_> = scene.cracks.iter().map(|c| (c.name.as_str(), c.start_live, c.end_live)).collect();
    assert_eq!(found, [("c.1", false, false), ("c.2", false, true)]);
    let points = |list: &[(f64, f64)]| list.iter().map(|&(x, y)| Point::new(x, y)).collect::<Vec<_>>();
    assert_eq!(scene.cracks[0].points, points(&[(-10.0, 1.0), (-2.0, 1.0)]));
    assert_eq!(scene.cracks[1].points, points(&[(2.0, 1.0), (6.0, 1.0)]));
    let region = &scene.bodies[0].region;
    for mouth in [scene.cracks[0].points[0], scene.cracks[0].points[1], scene.cracks[1].points[0]] {
        assert!(region.rings().any(|ring| ring.contains(&mouth)));
    }
    assert_eq!(scene.cracks[1].end_guide.as_ref().unwrap().points.len(), 2);
    // Both ends live: which of them `guide` means has to be said.
    let told = crack("[[-6, 1], [6, 1]]", "guide = 'path'").unwrap_err().to_string();
    assert!(told.contains("exactly one live tip"), "{told}");
    let both = crack("[[-6, 1], [6, 1]]", "guide_end = 'path'").unwrap();
    assert!(both.cracks[0].start_live && both.cracks[1].end_guide.is_some());
    // The start is cut off at the outline, so it is no tip.
    assert!(crack("[[-11, 1], [6, 1]]", "tips = 'both'").unwrap_err().to_string().contains("outline"));
    assert_eq!(crack("[[-11, 1], [6, 1]]", "tips = 'none'").unwrap().cracks.iter().filter(|c| c.end_live).count(), 0);
    // Out of the outline and in again.
    let again = crack("[[0, 4], [12, 4], [12, 6], [0, 6]]", "").unwrap();
    assert_eq!(
        again.cracks.iter().map(|c| (c.start_live, c.end_live)).collect::<Vec<_>>(),
        [(true, false), (false, true)]
    );
    // Along the edge of the hole: two pieces that open into its corners. Tangent to a corner: apart from each other.
    assert_eq!(crack("[[-6, 2], [6, 2]]", "").unwrap().cracks[1].points[0], Point::new(2.0, 2.0));
    let tangent = crack("[[-2, 6], [6, -2]]", "").unwrap();
    assert_eq!(tangent.cracks.len(), 2);
    assert_ne!(tangent.cracks[0].points.last(), tangent.cracks[1].points.first());
    // A name that a piece would share with another crack is refused.
    let other = "[[crack]]\nname = 'c.2'\nline = [[-6, -5], [6, -5]]";
    assert!(crack("[[-11, 1], [6, 1]]", other).unwrap_err().to_string().contains("`c.2`"));
}

/// Truth: the construction. Without a name the line is a crack in every body it runs through, in the order of the line.
#[test]
fn a_crack_runs_through_several_bodies() {
    let right =
        "[[body]]\nname = 'right'\nmaterial = 'glass'\nshape = { rectangle = { min = [10, -10], max = [30, 10] } }\n";
    let load =
        |body: &str| scene_with(&format!("{PLATE}{right}[[crack]]\n{body}line = [[20, 5], [0, 5]]\n"), None, &[]);
    let cracks: Vec<_> = load("").unwrap().cracks.iter().map(|c| (c.body, c.start_live, c.end_live)).collect();
    assert_eq!(cracks, [(1, true, false), (0, false, true)]);
    let only = load("body = 'plate'\n").unwrap();
    assert_eq!((only.cracks.len(), only.cracks[0].body, only.cracks[0].name.as_str()), (1, 0, "crack-1"));
}

/// Truth: the drawing, with a guide that begins 1 m beside another one, and one that begins on it.
#[test]
fn guides_that_nothing_follows_are_told_of() {
    let text = "[[body]]\nname = 'plate'\nmaterial = 'pmma'\nshape = { rectangle = { min = [-10, -10], max = [10, 10] } }\n\
        [grid]\nparticle_spacing = 0.25\n\
        [[crack]]\nline = [[-10, 0], [-5, 0]]\nguide = 'trunk'\n\
        [[guide]]\nname = 'trunk'\nline = [[-5, 0], [8, 0]]\n\
        [[guide]]\nname = 'side'\nline = [[2, 1], [4, 3]]\n\
        [[guide]]\nname = 'twig'\nline = [[4, 0], [6, 3]]\n";
    let loaded = load_with_warnings(&Folder::new(text, None).path(), &[]).unwrap();
    let told: Vec<_> = loaded.warnings.iter().filter(|w| w.message.contains("no crack follows")).collect();
    assert_eq!(told.len(), 1);
    assert!(told[0].message.contains("`side`: it ends 1 m from the nearest one, `trunk`"), "{}", told[0].message);
}

/// Truth: the construction, two cracks that leave 6 mm of a plate of particles of 20 mm, none when one ends on the
/// other, at the outline or as a tip.
#[test]
fn a_bridge_without_a_particle_is_warned_of() {
    let told = |second: &str, tips: &str| {
        let text = format!(
            "[[body]]\nname = 'plate'\nmaterial = 'pmma'\nshape = {{ rectangle = {{ min = [0, 0], max = [1, 1] }} }}\n\
             [grid]\nparticle_spacing = 0.02\n\
             [[crack]]\nname = 'left'\nline = [[-0.1, 0.5], [0.497, 0.5]]\ntips = '{tips}'\n\
             [[crack]]\nname = 'right'\nline = [{second}]\ntips = 'none'\n"
        );
        let loaded = load_with_warnings(&Folder::new(&text, None).path(), &[]).unwrap();
        let about = |w: &fissure_scene::Warning| w.message.contains("no particle lies between");
        loaded.warnings.iter().filter(|w| about(w)).map(|w| w.message.clone()).collect::<Vec<_>>()
    };
    let both = told("[0.503, 0.5], [1.1, 0.5]", "none");
    assert_eq!(both.len(), 2, "{both:?}");
    assert!(both[0].contains("`left`") && both[0].contains("6.00e-3 m from crack `right`"), "{}", both[0]);
    assert_eq!(told("[0.503, 0.5], [1.1, 0.5]", "end").len(), 1);
    assert_eq!(told("[0.3, 0.5], [0.3, 1.1]", "none"), Vec::<String>::new());
    assert_eq!(told("[0.54, 0.5], [1.1, 0.5]", "none"), Vec::<String>::new());
}

/// Truth: the construction, two plates of 10 mm joined by a neck of 0.4 mm at a spacing of 1 mm.
#[test]
fn a_narrow_neck_is_warned_of_with_its_line() {
    let outline = "[0, 0], [10, 0], [10, 4.8], [20, 4.8], [20, 0], [30, 0], [30, 10], [20, 10], [20, 5.2], [10, 5.2], [10, 10], [0, 10]";
    let text = format!(
        "[[body]]\nname = 'plates'\nmaterial = 'pmma'\nshape = {{ polygon = [{outline}] }}\n[grid]\nparticle_spacing = 1\n"
    );
    let folder = Folder::new(&text, None);
    let loaded = load_with_warnings(&folder.path(), &[]).unwrap();
    let warning = loaded.warnings.iter().find(|w| w.message.contains("body `plates`")).expect("a warning");
    for words in ["0.4 m wide", "0.40 particle spacings"] {
        assert!(warning.message.contains(words), "{}", warning.message);
    }
    assert!(warning.remedy.contains("0.2 m or less"), "{}", warning.remedy);
    assert_eq!(loaded.place(&warning.path).line(), Some(4));
}

/// Truth: the way over time, by the integral of the velocity, at its points and between them.
#[test]
fn a_displacement_is_a_velocity_over_time() {
    let of = |keys: &str| scene_with(&format!("{PLATE}[[support]]\n{keys}\n"), None, &[]);
    let scene = of("displacement_x = 0.5\ncurve = [[0.25, 0], [0.5, 1], [1.5, -1], [2, -1]]").unwrap();
    let support = &scene.supports[0];
    assert_eq!(support.velocity[1], None);
    for (time, way) in [(0.25, 0.0), (0.3, 0.1), (0.5, 0.5), (1.0, 0.0), (1.5, -0.5), (9.0, -0.5)] {
        let found = support.velocity[0].unwrap() * support.curve.mean(0.0, time) * time;
        assert!((found - way).abs() < 1e-6, "{found} at {time}");
    }
    for (keys, words) in [
        ("displacement_x = 0.5", "would be a jump"),
        ("displacement_x = 0.5\ncurve = [[0, 0.1], [1, 1]]", "begins at a factor of 0.1"),
        ("displacement_x = 0.5\ncurve = [[0, 0], [1e-9, 1]]", "highest speed on the way"),
        ("displacement_x = 0.5\nvelocity_y = 1\ncurve = [[0, 0], [1, 1]]", "both a velocity and a displacement"),
        ("displacement_x = 0.5\nfix = 'y'\ncurve = [[0, 0], [1, 1]]", "both `fix` and"),
    ] {
        let told = of(keys).unwrap_err().to_string();
        assert!(told.contains(words), "{told}");
    }
}
