//! Cracks that are told where, when and how fast to go.

use crate::common::{add_crack, plate, pull, rectangle, run};
use fissure_scene::{
    BranchKind, Branching, CrackEnd, Curve, End, Frame, Guide, GuideBranch, Inclusion, Point, Region, Scene, TipState,
    ToughnessKind, ToughnessPatch, Vector,
};
use fissure_sim::{Elastic, Simulation};

/// Where the crack begins and its tip is at first [m].
const MOUTH: [f64; 2] = [0.0, 10.03];
const TIP: [f64; 2] = [4.03, 10.03];

/// A plate of 20 m with a straight edge crack, pulled well beyond its toughness. Frames are a fifth of the time a wave
/// takes across.
fn pulled() -> Scene {
    let mut scene = plate([20.0, 20.0], 0.5, 4e-3);
    scene.materials[0].fracture_toughness = 2e6;
    add_crack(&mut scene, &[MOUTH, TIP]);
    pull(&mut scene, 1e6);
    scene
}

/// A path from the tip upwards at 45 degrees.
fn guide(strength: f64, schedule: &[(f64, f64)]) -> Guide {
    Guide {
        name: "path".into(),
        points: vec![Point::from(TIP), Point::new(10.03, 16.03)],
        strength,
        schedule: Curve { points: schedule.to_vec() },
        branches: Vec::new(),
    }
}

fn after(scene: &Scene, frames: usize) -> Frame {
    run(&mut Simulation::new(scene).unwrap(), frames).unwrap()
}

/// Slope of the new part of the first crack at its first two metres [rad].
fn slope(frame: &Frame) -> f64 {
    let from = Point::from(TIP);
    let far = frame.cracks[0].rest.iter().find(|p| p.x > TIP[0] && (**p - from).norm() > 2.0).unwrap();
    (far.y - from.y).atan2(far.x - from.x)
}

/// Truth: the ends of the blend. Without strength a guide changes nothing; with all of it the path is the drawn one;
/// between, between.
#[test]
fn a_guide_turns_the_crack_by_its_strength() {
    let free = after(&pulled(), 12);
    let mut scene = pulled();
    let guided = |strength: f64| {
        scene.cracks[0].end_guide = Some(guide(strength, &[]));
        after(&scene, 12)
    };
    let by = [0.0, 0.5, 1.0].map(guided);
    assert_eq!(by[0].cracks[0].rest, free.cracks[0].rest);
    let [unguided, half, whole] = by.each_ref().map(|frame| slope(frame).to_degrees());
    assert!((whole - 45.0).abs() < 1e-6, "{whole}");
    // By a tenth of what is between them at least.
    let part = (half - unguided) / (whole - unguided);
    assert!((0.1..0.9).contains(&part), "{unguided} {half} {whole}");
}

/// Truth: the schedule, to within an increment; and nothing more without load.
#[test]
fn a_schedule_says_when() {
    let mut scene = pulled();
    scene.loads.clear();
    let rate = scene.frames.rate;
    scene.cracks[0].end_guide = Some(guide(1.0, &[(2.0 / rate, 0.0), (12.0 / rate, 0.5)]));
    let mut simulation = Simulation::new(&scene).unwrap();
    let increment = scene.growth.increment * scene.cell_size;
    let length = 6.0 * 2.0_f64.sqrt();
    for frame in 1..=15 {
        let now = run(&mut simulation, 1).unwrap();
        let grown = now.tips[0].length - (TIP[0] - MOUTH[0]);
        let asked = length * 0.05 * f64::from((frame - 2).clamp(0, 10));
        assert!((grown - asked).abs() <= increment + 1e-9, "frame {frame}: {grown} instead of {asked}");
    }
    assert!(
        (simulation.frame().tips[0].length - (TIP[0] - MOUTH[0]) - 0.5 * length).abs() < 1e-6,
        "ends where it says"
    );
}

/// Truth: the drawing and the schedules. A branch begins at the point of its guide, as its trunk has passed, and is as
/// long as its own schedule says, to within an increment; a crack that is drawn to the guide opens into the trunk; and
/// the mirror image does the same.
#[test]
fn branches_begin_where_and_when_their_guides_say() {
    for up in [1.0, -1.0] {
        let mut scene = pulled();
        scene.loads.clear();
        let frame = 1.0 / scene.frames.rate;
        let from = Point::from(TIP);
        let place = |along: f64| from + Vector::new(along, 0.0);
        add_crack(&mut scene, &[[TIP[0] + 2.1, TIP[1]], [TIP[0] + 3.1, TIP[1] - 2.0 * up]]);
        scene.cracks[1].start_live = false;
        scene.cracks[1].end_live = false;
        let path = |points: Vec<Point>, schedule: &[(f64, f64)], branches| Guide {
            name: "path".into(),
            points,
            strength: 1.0,
            schedule: Curve { points: schedule.to_vec() },
            branches,
        };
        let rise = [(0.0, 0.0), (8.0 * frame, 1.0)];
        let side = path(vec![place(5.0), place(8.0) + Vector::new(0.0, 4.0 * up)], &rise, Vec::new());
        let drawn = GuideBranch { point: 1, kind: BranchKind::Drawn { crack: 1, end: End::Start } };
        let kind = BranchKind::Begins { guide: side, delay: 2.0 * frame, from_passing: true };
        let points = vec![place(0.0), place(2.1), place(5.0), place(9.0)];
        let schedule = [(frame, 0.0), (10.0 * frame, 1.0)];
        scene.cracks[0].end_guide = Some(path(points, &schedule, vec![drawn, GuideBranch { point: 2, kind }]));
        let mut simulation = Simulation::new(&scene).unwrap();
        let increment = scene.growth.increment * scene.cell_size;
        let passed = 6.0;
        for number in 1..=18 {
            let now = run(&mut simulation, 1).unwrap();
            let at = f64::from(number);
            let asked = 5.0 * ((at - passed - 2.0) / 8.0).clamp(0.0, 1.0);
            let grown = now.tips.iter().find(|tip| tip.crack == 2).map_or(0.0, |tip| tip.length);
            assert!((grown - asked).abs() <= 2.0 * increment, "frame {number}: {grown} instead of {asked}");
            let joins = if at < 1.0 + 9.0 * 2.1 / 9.0 { CrackEnd::Tip } else { CrackEnd::Junction { crack: 0 } };
            if (at - 3.1).abs() > 0.5 {
                assert_eq!(now.cracks[1].start, joins, "frame {number}");
            }
        }
        let last = simulation.frame();
        assert_eq!((last.cracks[2].rest[0], last.cracks[2].start), (place(5.0), CrackEnd::Junction { crack: 0 }));
        assert!(last.cracks[0].rest.contains(&place(5.0)) && last.cracks[0].rest.contains(&place(2.1)));
    }
}

/// Truth: counting. A crack that runs across one from edge to edge leaves four pieces, wherever they meet; without
/// being told to it ends there, and there are three.
#[test]
fn a_crack_runs_across_another_when_it_is_told_to() {
    for (shift, lean) in [(0.0, 0.0), (0.13, 0.4), (0.25, -0.3), (0.5, 0.1)] {
        for crosses in [true, false] {
            let mut scene = plate([6.0, 6.0], 0.5, 4e-3);
            add_crack(&mut scene, &[[3.0 + shift - lean, 0.0], [3.0 + shift + lean, 6.0]]);
            add_crack(&mut scene, &[[0.0, 3.03], [1.0, 3.03]]);
            let frame = 1.0 / scene.frames.rate;
            let points = vec![Point::new(1.0, 3.03), Point::new(6.5, 3.03)];
            let schedule = Curve { points: vec![(0.0, 0.0), (4.0 * frame, 1.0)] };
            scene.cracks[1].end_guide =
                Some(Guide { name: "path".into(), points, strength: 1.0, schedule, branches: Vec::new() });
            scene.cracks[1].crosses = crosses;
            let mut simulation = Simulation::new(&scene).unwrap();
            let mut fragments = run(&mut simulation, 6).unwrap().particles.piece.clone();
            fragments.sort_unstable();
            fragments.dedup();
            assert_eq!(fragments.len(), if crosses { 4 } else { 3 }, "shift {shift}, lean {lean}");
        }
    }
}

/// Truth: the limits themselves. Averaged over a frame a tip never runs faster than the scene or the material lets it.
#[test]
fn tips_keep_to_their_speed_limits() {
    let mut scene = pulled();
    let rayleigh = Elastic::new(&scene.materials[0], scene.plane).rayleigh_wave_speed();
    let fastest = |scene: &Scene| {
        let mut simulation = Simulation::new(scene).unwrap();
        (0..10).map(|_| run(&mut simulation, 1).unwrap().tips[0].speed).fold(0.0, f64::max)
    };
    let step = scene.growth.increment * scene.cell_size * scene.frames.rate;
    scene.materials[0].limiting_speed = Some(0.2 * rayleigh);
    let found = fastest(&scene);
    assert!(found > 0.1 * rayleigh && found <= 0.2 * rayleigh + step, "{found} of {rayleigh}");
    scene.growth.speed_curve = Curve { points: vec![(0.0, 0.0)] };
    assert_eq!(fastest(&scene), 0.0, "a factor of 0 holds all tips");
}

/// A tough band stops a crack that it meets, a weak one lets it through.
#[test]
fn toughness_varies_in_space() {
    let end_in = |factor: f64| {
        let mut scene = pulled();
        let region = rectangle([8.0, 0.0], [10.0, 20.0]);
        scene.toughness = vec![ToughnessPatch { body: None, kind: ToughnessKind::Region { region, factor } }];
        after(&scene, 14).cracks[0].rest.iter().map(|p| p.x).fold(0.0, f64::max)
    };
    let stopped = end_in(1e3);
    let increment = pulled().growth.increment * pulled().cell_size;
    assert!((7.4..=8.0 + increment).contains(&stopped), "stopped at {stopped}");
    assert!(end_in(0.9) > 12.0);
}

/// Truth: statics in series. Half of a bar is twice as stiff: under the same pull it stretches half as much, and the
/// crack in a stiff strip opens less.
#[test]
fn an_inclusion_has_its_own_stiffness() {
    let mut scene = plate([4.0, 20.0], 0.5, 4e-3);
    let mut stiff = scene.materials[0].clone();
    stiff.young_modulus *= 2.0;
    stiff.name = "stiffer".into();
    scene.materials.push(stiff);
    scene.bodies[0].inclusions = vec![Inclusion { region: rectangle([-1.0, 10.0], [5.0, 21.0]), material: 1 }];
    pull(&mut scene, 1e6);
    let mut simulation = Simulation::new(&scene).unwrap();
    simulation.relax(1e-10, 20_000).unwrap();
    let particles = simulation.frame().particles;
    let stretch = |low: f64| {
        let inside = |p: &Point| (low..low + 4.0).contains(&p.y);
        let values: Vec<f64> = particles
            .rest
            .iter()
            .zip(&particles.deformation_gradient)
            .filter(|(p, _)| inside(p))
            .map(|(_, f)| f.m22 - 1.0)
            .collect();
        values.iter().sum::<f64>() / values.len() as f64
    };
    let ratio = stretch(3.0) / stretch(13.0);
    assert!((ratio - 2.0).abs() < 0.02, "{ratio}");
}

/// A tip with energy for two divides: two live tips, apart by twice the half angle, no two divisions nearer than told.
#[test]
fn an_overdriven_tip_divides() {
    let mut scene = pulled();
    scene.materials[0].fracture_toughness = 1e6;
    let half_angle = 0.5;
    scene.growth.branching = Some(Branching { release_ratio: 2.0, half_angle, spacing: 6.0 });
    let frame = after(&scene, 8);
    assert!(frame.cracks.len() >= 2, "{} cracks", frame.cracks.len());
    assert!(frame.tips.len() >= 2);
    assert!(frame.tips.iter().any(|t| t.state == TipState::Growing || t.state == TipState::LeftBody));
    let twin = &frame.cracks[1].rest;
    let trunk = &frame.cracks[0].rest;
    let at = trunk.iter().position(|p| *p == twin[0]).expect("the twin begins on the trunk");
    let (left, right) = (trunk[at + 1] - trunk[at], twin[1] - twin[0]);
    assert!((right.perp(&left).atan2(right.dot(&left)) - 2.0 * half_angle).abs() < 1e-9);
    // A closed form for nothing: only that every number is one.
    assert!(frame.particles.position.iter().all(|p| p.x.is_finite() && p.y.is_finite()));
}

/// Truth: a straight run. A weak band at 30 degrees to the crack is followed as if drawn; without it the crack runs
/// straight.
#[test]
fn cracks_seek_what_is_weak() {
    let mut scene = pulled();
    let along = Vector::new(30.0_f64.to_radians().cos(), 30.0_f64.to_radians().sin());
    let across = Vector::new(-along.y, along.x) * (0.75 * scene.cell_size);
    let (start, end) = (Point::from(TIP) - along * scene.cell_size, Point::from(TIP) + along * 12.0);
    let exterior = vec![start - across, end - across, end + across, start + across];
    let region = Region { exterior, holes: Vec::new() };
    scene.toughness = vec![ToughnessPatch { body: None, kind: ToughnessKind::Region { region, factor: 0.25 } }];
    let frame = after(&scene, 10);
    let path = &frame.cracks[0].rest;
    assert!(path.last().unwrap().x > TIP[0] + 5.0, "stopped at {:?}", path.last());
    let off = path.iter().filter(|p| (TIP[0] + 1.0..TIP[0] + 5.0).contains(&p.x));
    let worst = off.map(|p| (p - Point::from(TIP)).perp(&along).abs()).fold(0.0, f64::max);
    assert!(worst < 1.5 * scene.cell_size, "{worst} m off the middle of the band");
}

/// Truth: symmetry. Before a tough disc in the middle of its way a crack has as much to its left as to its right; it
/// turns to the right when all is tough farther to the left, and to the left in the mirror image, by the same path.
#[test]
fn cracks_pass_tough_places_on_the_freer_side() {
    let [above, below] = [1.0, -1.0].map(|up| {
        let mut scene = pulled();
        let at = |x: f64, y: f64| Point::new(x, 10.0 + up * (y - 10.0));
        scene.cracks[0].points.iter_mut().for_each(|p| *p = at(p.x, p.y));
        let disc = (0..32).map(|k| std::f64::consts::TAU * f64::from(k) / 32.0);
        let disc = disc.map(|angle| at(7.0 + 1.5 * angle.cos(), TIP[1] + 1.5 * angle.sin())).collect();
        let wall = vec![at(4.6, 10.4), at(9.0, 10.4), at(9.0, 12.0), at(4.6, 12.0)];
        let tough = |exterior: Vec<Point>| {
            let region = Region { exterior, holes: Vec::new() };
            ToughnessPatch { body: None, kind: ToughnessKind::Region { region, factor: 20.0 } }
        };
        scene.toughness = vec![tough(disc), tough(wall)];
        after(&scene, 30).cracks[0].rest.clone()
    });
    let lowest = above.iter().filter(|p| p.x < 8.5).map(|p| p.y).fold(f64::INFINITY, f64::min);
    assert!(above.last().unwrap().x > 8.5, "{:?}", above.last());
    assert!(lowest < 9.0, "{lowest}");
    assert_eq!(above.len(), below.len());
    let worst = above.iter().zip(&below).map(|(a, b)| (a.x - b.x).hypot(a.y + b.y - 20.0)).fold(0.0, f64::max);
    assert!(worst < 1e-6, "{worst} m apart");
}
