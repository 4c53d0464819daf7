//! What loads, supports and velocities reach: bodies of several parts, and edges that are drawn.
#![allow(clippy::unwrap_used, clippy::panic)]

use fissure_scene::{Curve, Formulation, Load, LoadError, LoadKind, Scene, Selection, Vector};
use fissure_sim::Simulation;
use std::ops::ControlFlow;

/// A scene of a drawing 100 m wide, its centre at (0, 0), one metre a unit.
fn scene(inner: &str, rest: &str) -> Result<Scene, LoadError> {
    let folder = tempfile::tempdir().unwrap();
    let svg = format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='-50 -50 100 100'>\n{inner}\n</svg>");
    std::fs::write(folder.path().join("d.svg"), svg).unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, format!("[drawing]\nfile = 'd.svg'\nwidth = 100\n{rest}")).unwrap();
    fissure_scene::load(&path, &[])
}

fn body(id: &str) -> String {
    format!("[[body]]\nname = '{id}'\nmaterial = 'pmma'\nshape = {{ svg = '{id}' }}\n")
}

/// Total momentum after the first frame, and the time for which loads have pushed until then. Velocities are half a
/// step behind or ahead, so the time is measured: by a force of 1 N/m on everything.
fn momentum(scene: &Scene, formulation: Formulation) -> (Vector, f64) {
    let after_a_frame = |loads: Vec<Load>| {
        let mut scene = Scene { loads, ..scene.clone() };
        scene.solver.formulation = formulation;
        let mut simulation = Simulation::new(&scene).unwrap();
        simulation.advance(&mut |_| ControlFlow::Continue(())).unwrap();
        simulation.momenta().0
    };
    let unit = LoadKind::Force(Vector::x());
    let pushed = after_a_frame(vec![Load { selection: Selection::All, kind: unit, curve: Curve::default() }]);
    (after_a_frame(scene.loads.clone()), (pushed - after_a_frame(Vec::new())).x)
}

const TWO: &str = "<path id='b' d='M-20 -5H-10V5H-20Z M10 -10H25V10H10Z'/>";
const COARSE: &str = "[grid]\nparticle_spacing = 1\n[frames]\nrange = '1-2'\nrate = 2000\n";

/// Truth: impulse is momentum. A force on a body of two parts is one force, shared by their volumes; on one part, that
/// part's.
#[test]
fn a_force_on_a_body_of_two_parts_is_one_force() {
    for formulation in [Formulation::Total, Formulation::Updated] {
        for (name, parts) in [("b", vec![0, 1]), ("b.2", vec![1])] {
            let load = format!("[[load]]\nselect = {{ body = '{name}' }}\nforce = [3e3, -1e3]\n");
            let scene = scene(TWO, &(body("b") + &load + COARSE)).unwrap();
            assert_eq!(scene.loads[0].selection, Selection::Bodies(parts.clone()));
            let (momentum, time) = momentum(&scene, formulation);
            assert!((momentum - Vector::new(3e3, -1e3) * time).norm() < 1e-6 * momentum.norm(), "{name}: {momentum}");
        }
    }
}

/// Truth: the construction. Everything that takes a name takes that of the whole and that of a part.
#[test]
fn the_name_of_a_body_means_all_its_parts() {
    let rest = body("b")
        + "angular_velocity = 2\nvelocity = [1, 0]\n\
           [[support]]\nselect = { body = 'b' }\nfix = 'x'\n\
           [[support]]\nselect = { body = 'b', edge = 'top' }\nfix = 'x'\n\
           [[support]]\nselect = { body = 'b.1', edge = 'top' }\nfix = 'x'\n\
           [[initial_velocity]]\nselect = { body = 'b' }\nvelocity = [0, 1]\n\
           [[initial_velocity]]\nselect = { body = 'b.2' }\nvelocity = [0, 1]\n\
           [[region]]\nbody = 'b'\nmaterial = 'glass'\nshape = { rectangle = { min = [-50, -50], max = [50, 0] } }\n\
           [[toughness]]\nbody = 'b'\nfactor = 2\nshape = { rectangle = { min = [-50, -50], max = [50, 0] } }\n\
           [[crack]]\nbody = 'b'\nline = [[-21, 0], [-15, 0]]\n\
           [[crack]]\nbody = 'b.2'\nline = [[9, 0], [15, 0]]\n";
    let scene = scene(TWO, &rest).unwrap();
    let names: Vec<&str> = scene.bodies.iter().map(|b| b.name.as_str()).collect();
    assert_eq!(names, ["b.1", "b.2"]);
    assert_eq!(scene.supports[0].selection, Selection::Bodies(vec![0, 1]));
    assert!(matches!(&scene.supports[1].selection, Selection::Edge { bodies: Some(b), .. } if b == &[0, 1]));
    assert!(matches!(&scene.supports[2].selection, Selection::Edge { bodies: Some(b), .. } if b == &[0]));
    assert_eq!((scene.bodies[0].velocities.len(), scene.bodies[1].velocities.len()), (2, 3));
    // They turn about their common centre of area: (100 * -15 + 300 * 17.5) / 400.
    for body in &scene.bodies {
        assert!((body.velocities[0].center.coords - Vector::new(9.375, 0.0)).norm() < 1e-4);
        assert_eq!(body.inclusions.len(), 1);
    }
    assert_eq!(scene.toughness.len(), 2);
    assert_eq!((scene.cracks[0].body, scene.cracks[1].body), (0, 1));
    // Only the higher part reaches the top of both; each has a top of its own.
    let simulation = Simulation::new(&scene).unwrap();
    let rows = |selection: &Selection| {
        let Selection::Edge { bodies: Some(bodies), .. } = selection else { panic!() };
        bodies.len()
    };
    assert!(simulation.particles() > 0 && rows(&scene.supports[1].selection) == 2);
}

/// Truth: the fault names both, and its line.
#[test]
fn names_that_collide_are_refused() {
    let other = |name: &str| {
        format!(
            "[[body]]\nname = '{name}'\nmaterial = 'pmma'\nshape = {{ circle = {{ center = [40, 0], radius = 2 }} }}\n"
        )
    };
    for (name, words) in [("b.2", ["`b`", "2 parts", "`b.2`"]), ("b", ["two", "`b`", "name"])] {
        for text in [body("b") + &other(name), other(name) + &body("b")] {
            let error = scene(TWO, &text).unwrap_err();
            words.iter().for_each(|word| assert!(error.to_string().contains(word), "{error}"));
            assert!(error.line().is_some());
        }
    }
    assert!(scene(TWO, &(body("b") + &other("c"))).is_ok());
    let told =
        scene(TWO, &(body("b") + "[[support]]\nselect = { body = 'b.3' }\nfix = 'x'\n")).unwrap_err().to_string();
    assert!(told.contains("`b.3`") && told.contains("did you mean `b."), "{told}");
}

/// Truth: impulse is momentum, and the length of the edge. A traction on a drawn edge gives what the same traction
/// gives on the same edge by name, at any place and turn.
#[test]
fn a_traction_on_a_drawn_edge_is_that_on_the_same_edge_by_name() {
    let load = |select: &str, [x, y]: [f64; 2]| {
        body("b") + &format!("[[load]]\nselect = {{ {select} }}\ntraction = [{x}, {y}]\n") + COARSE
    };
    let plate = "<rect id='b' x='-12' y='-7' width='24' height='14'/>";
    for formulation in [Formulation::Total, Formulation::Updated] {
        let by_name = scene(plate, &load("edge = 'top'", [1e3, 5e3])).unwrap();
        let (named, time) = momentum(&by_name, formulation);
        assert!((named - Vector::new(1e3, 5e3) * (24.0 * time)).norm() < 1e-9 * named.norm());
        for (turn, x, y) in
            [(0.0_f64, 0.0, 0.0), (17.0, 3.3, -1.2), (90.0, 0.1, 0.2), (-135.0, 5.0, 5.0), (211.7, -7.7, 4.1)]
        {
            // SVG turns clockwise on y down: what is 'top' there is at y = -7.
            let inner = format!(
                "<g transform='translate({x} {y}) rotate({turn})'>{plate}<line id='edge' x1='12' y1='-7' x2='-12' y2='-7'/></g>"
            );
            let rotation = turned(-turn.to_radians());
            let traction = rotation(Vector::new(1e3, 5e3));
            let drawn = scene(&inner, &load("svg = 'edge'", [traction.x, traction.y])).unwrap();
            let (found, time_too) = momentum(&drawn, formulation);
            assert!((time - time_too).abs() < 1e-9 * time);
            assert!((found - rotation(named)).norm() < 1e-5 * named.norm(), "{turn}: {found} {}", rotation(named));
        }
    }
}

fn turned(angle: f64) -> impl Fn(Vector) -> Vector {
    move |v| Vector::new(angle.cos() * v.x - angle.sin() * v.y, angle.sin() * v.x + angle.cos() * v.y)
}

/// Truth: rigid motion. Material held along a drawn edge of a turned plate stays; a force there, or a velocity, reaches
/// it.
#[test]
fn a_drawn_edge_is_held_pushed_and_moved() {
    let inner = "<g transform='rotate(30)'><rect id='b' x='-12' y='-7' width='24' height='14'/>
        <polyline id='corner' points='0,-7 12,-7 12,7'/><circle id='spot' r='3'/><path id='across' d='M-20 0H20'/></g>";
    let rest = |rest: &str| body("b") + rest + COARSE;
    let held =
        scene(inner, &rest("[[support]]\nselect = { svg = 'corner' }\nvelocity_x = 1\nvelocity_y = 0\n")).unwrap();
    let Selection::Outline(stretches) = &held.supports[0].selection else { panic!() };
    assert!((stretches.iter().map(|s| (s.to - s.from).norm()).sum::<f64>() - 26.0).abs() < 1e-4);
    for formulation in [Formulation::Total, Formulation::Updated] {
        assert!(momentum(&held, formulation).0.x > 0.0);
        for select in ["svg = 'corner'", "svg = 'spot'", "svg = 'corner', body = 'b'"] {
            let load = format!("[[load]]\nselect = {{ {select} }}\nforce = [0, 5e3]\n");
            let (found, time) = momentum(&scene(inner, &rest(&load)).unwrap(), formulation);
            assert!((found - Vector::new(0.0, 5e3 * time)).norm() < 1e-9 * found.norm(), "{select}");
        }
        // Such a jump of the velocity needs shorter steps.
        let moving = "[[initial_velocity]]\nselect = { svg = 'corner' }\nvelocity = [0, 2]\n[solver]\ncourant = 0.1\n";
        let moved = scene(inner, &rest(moving)).unwrap();
        let (found, _) = momentum(&moved, formulation);
        // The layer is one particle thick: 26 m x 1 m of 1190 kg/m³ at 2 m/s, as far as the lattice is even.
        assert!((found.y / (26.0 * 1190.0 * 2.0) - 1.0).abs() < 0.15, "{found}");
    }
    let told = scene(inner, &rest("[[support]]\nselect = { svg = 'across' }\nfix = 'x'\n")).unwrap_err().to_string();
    assert!(told.contains("`across`") && told.contains("selects no edge") && told.contains("40 m long"), "{told}");
    let both = scene(inner, &rest("[[support]]\nselect = { svg = 'spot', edge = 'top' }\nfix = 'x'\n")).unwrap_err();
    assert!(both.to_string().contains("`edge` and `svg`"), "{both}");
}
