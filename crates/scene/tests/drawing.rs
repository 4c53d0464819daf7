//! SVG drawings: groups, transforms, units, text, paint that hides, and mistakes in them.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use fissure_scene::{LoadError, LoadErrorKind, Point, Scene, load};

fn load_drawing(svg: &str, drawing: &str, rest: &str) -> Result<Scene, LoadError> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("d.svg"), svg).unwrap();
    let scene = folder.path().join("scene.toml");
    std::fs::write(&scene, format!("[drawing]\nfile = 'd.svg'\n{drawing}\n{rest}")).unwrap();
    load(&scene, &[])
}

fn body(id: &str) -> String {
    format!("[[body]]\nname = 'b'\nmaterial = 'pmma'\nshape = {{ svg = '{id}' }}\n")
}

fn svg(head: &str, inner: &str) -> String {
    format!("<svg xmlns='http://www.w3.org/2000/svg' {head}>\n{inner}\n</svg>")
}

fn assert_near(a: Point, b: (f64, f64), tolerance: f64) {
    assert!((a - Point::new(b.0, b.1)).norm() <= tolerance, "{a} is not {b:?}");
}

/// Truth: the transforms, applied by hand. Single precision of the drawing: 1e-6 of its size.
#[test]
fn group_transforms_and_the_scale_apply() {
    let drawing = svg(
        "viewBox='0 0 200 100'",
        "<g id='all' transform='translate(100 50)'><g transform='rotate(90) scale(2)'>
         <rect id='r' x='5' y='0' width='10' height='5'/></g></g>",
    );
    // (5, 0)..(15, 5), doubled, turned by 90 degrees (x, y) -> (-y, x): x from -10 to 0, y from 10 to 30, y down.
    for id in ["r", "all"] {
        let scene = load_drawing(&drawing, "width = 20", &body(id)).unwrap();
        let (low, high) = scene.bodies[0].region.bounds();
        assert_near(low, (-1.0, -3.0), 2e-5);
        assert_near(high, (0.0, -1.0), 2e-5);
        assert!((scene.bodies[0].region.area() - 2.0).abs() < 1e-4);
    }
    let scene = load_drawing(&drawing, "metres_per_unit = 1\norigin = 'corner'", &body("r")).unwrap();
    assert_near(scene.bodies[0].region.bounds().0, (90.0, 20.0), 2e-4);
    let scene = load_drawing(&drawing, "metres_per_unit = 1\norigin = [100, 50]", &body("r")).unwrap();
    assert_near(scene.bodies[0].region.bounds().0, (-10.0, -30.0), 2e-4);
}

/// Truth: 10 mm are 0.01 m, whatever the viewBox counts in.
#[test]
fn physical_units_need_no_scale() {
    for (head, side) in
        [("width='100mm' height='100mm'", "10mm"), ("width='10cm' height='10cm' viewBox='0 0 1000 1000'", "100")]
    {
        let drawing = svg(head, &format!("<rect id='r' width='{side}' height='{side}'/>"));
        let scene = load_drawing(&drawing, "", &body("r")).unwrap();
        let (low, high) = scene.bodies[0].region.bounds();
        assert_near(low, (-0.05, 0.04), 1e-7);
        assert_near(high, (-0.04, 0.05), 1e-7);
    }
    let drawing = svg("viewBox='0 0 1 1'", "<rect id='r' width='1' height='1'/>");
    let told = load_drawing(&drawing, "", &body("r")).unwrap_err().to_string();
    assert!(told.contains("d.svg") && told.contains("no physical size") && told.contains("width = ..."), "{told}");
}

/// Truth: pi r^2, and the fill rules. The ring is the same path in both cases; only the rule differs.
#[test]
fn curves_holes_and_fill_rules() {
    let ring = "M10 0A10 10 0 1 1 -10 0A10 10 0 1 1 10 0ZM5 0A5 5 0 1 1 -5 0A5 5 0 1 1 5 0Z";
    let pi = std::f64::consts::PI;
    for (rule, holes, area) in [("evenodd", 1, 75.0 * pi), ("nonzero", 0, 100.0 * pi)] {
        let drawing = svg("viewBox='-20 -20 40 40'", &format!("<path id='p' fill-rule='{rule}' d='{ring}'/>"));
        let region = &load_drawing(&drawing, "width = 40", &body("p")).unwrap().bodies[0].region;
        assert_eq!(region.holes.len(), holes);
        assert!((region.area() / area - 1.0).abs() < 3e-3, "{} {area}", region.area());
    }
}

/// Paint does not matter: cracks are drawn as unfilled strokes, guides are hidden, bodies have no fill.
#[test]
fn invisible_elements_work() {
    let drawing = svg(
        "viewBox='0 0 20 20'",
        "<style>.hidden { display: none }</style>
         <rect id='plate' width='20' height='20' fill='none' opacity='0'/>
         <line id='notch' x1='0' y1='10' x2='5' y2='10' stroke='none'/>
         <g style='display:none'><path id='path' class='hidden' d='M5 10 C 10 5, 10 15, 20 10' fill='none'/></g>",
    );
    let rest = format!(
        "{}[[crack]]\nline = {{ svg = 'notch' }}\nguide = 'g'\n[[guide]]\nname = 'g'\nline = {{ svg = 'path' }}\n",
        body("plate")
    );
    let scene = load_drawing(&drawing, "width = 20", &rest).unwrap();
    let crack = &scene.cracks[0];
    assert_near(crack.points[0], (-10.0, 0.0), 1e-5);
    assert_near(crack.points[1], (-5.0, 0.0), 1e-5);
    assert!(crack.end_live && !crack.start_live);
    let guide = crack.end_guide.as_ref().unwrap();
    assert_eq!(guide.points[0], crack.points[1]);
    assert!(guide.points.len() > 8);
}

/// Truth: letters. "B" has two holes, "i" is two bodies; the font that comes with Fissure has both.
#[test]
fn text_becomes_bodies() {
    let drawing =
        svg("viewBox='0 0 100 100'", "<text id='t' x='10' y='80' font-family='No Such Font' font-size='60'>Bi</text>");
    let scene = load_drawing(&drawing, "width = 1", &body("t")).unwrap();
    let names: Vec<_> = scene.bodies.iter().map(|b| b.name.as_str()).collect();
    assert_eq!(names, ["b.1", "b.2", "b.3"]);
    let mut holes: Vec<_> = scene.bodies.iter().map(|b| b.region.holes.len()).collect();
    holes.sort_unstable();
    assert_eq!(holes, [0, 0, 2]);
    // A crack finds its letter by itself.
    let b = scene.bodies.iter().find(|b| b.region.holes.len() == 2).unwrap();
    let (low, high) = b.region.bounds();
    let y = 0.98 * low.y + 0.02 * high.y;
    let crack = format!("[[crack]]\nbody = 'b'\nline = [[{}, {y}], [{}, {y}]]\n", low.x - 0.01, 0.5 * (low.x + high.x));
    let scene = load_drawing(&drawing, "width = 1", &format!("{}{crack}", body("t"))).unwrap();
    assert_eq!(scene.bodies[scene.cracks[0].body].region.holes.len(), 2);
}

#[test]
fn mistakes_in_drawings_are_told() {
    use LoadErrorKind::{InputFile, Scene};
    let inner = "<rect id='plate' width='10' height='10'/><path id='open' d='M0 0H5V5'/><path id='bow' d='M0 0L5 5V0L0 5Z'/>
        <defs><linearGradient id='grad'/></defs><g id='pair'><rect width='5' height='5'/><rect x='3' width='5' height='5'/></g>
        <text id='empty'/><line id='dot' x1='1' y1='1' x2='1' y2='1'/><path id='two' d='M1 1H2M3 3H4'/>";
    let drawing = svg("viewBox='0 0 20 20'", inner);
    let cases: [(&str, LoadErrorKind, &[&str]); 7] = [
        ("plat", Scene, &["d.svg", "`plat`", "did you mean `plate`?"]),
        ("open", Scene, &["`open`", "open", "(-10, 10)", "(-5, 5)", "Z"]),
        ("bow", Scene, &["`bow`", "crosses", "(-7.5, 7.5)"]),
        ("grad", Scene, &["`grad`", "<linearGradient>", "d.svg:3"]),
        ("pair", Scene, &["`pair`", "touches", "unite"]),
        ("empty", Scene, &["text `empty`", "font = "]),
        ("dot", Scene, &["`dot`"]),
    ];
    for (id, kind, words) in cases {
        let error = load_drawing(&drawing, "width = 20", &body(id)).unwrap_err();
        let told = error.to_string();
        assert_eq!((error.kind, error.line()), (kind, Some(7)), "{told}");
        words.iter().for_each(|word| assert!(told.contains(word), "`{word}` is missing in: {told}"));
    }
    for (id, words) in [("plate", ["`plate`", "closed"]), ("two", ["`two`", "2 lines"])] {
        let rest = format!("{}[[crack]]\nline = {{ svg = '{id}' }}\n", body("plate"));
        let told = load_drawing(&drawing, "width = 20", &rest).unwrap_err().to_string();
        words.iter().for_each(|word| assert!(told.contains(word), "{told}"));
    }
    let error = load_drawing("<svg>\n<rect></svg>", "width = 1", &body("plate")).unwrap_err();
    assert_eq!((error.kind, error.line()), (InputFile, Some(2)), "{error}");
    assert!(error.to_string().contains("d.svg:2"), "{error}");
    let error = load_drawing(&drawing, "width = 1\nfont = 'none.ttf'", &body("plate")).unwrap_err();
    assert!(error.kind == InputFile && error.to_string().contains("none.ttf"), "{error}");
}
