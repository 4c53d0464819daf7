#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

use super::*;
use crate::solver::Snapshot;
use crate::test_scenes::{add_body, add_crack, always, free_body, rectangle, set_motion};
use fissure_plane::{Matrix, Point, Vector};
use fissure_scene::{BoxSide, CrackEnd, End, Kernel, Load, LoadKind, Plasticity, Selection, Support, TipDivision};

const KERNELS: [Kernel; 4] = [Kernel::Bilinear, Kernel::Gimp, Kernel::Quadratic, Kernel::Cubic];
const TRANSFERS: [Transfer; 5] =
    [Transfer::Pic, Transfer::Flip(1.0), Transfer::Flip(0.95), Transfer::Apic, Transfer::Xpic];

struct Run {
    solver: Updated,
    cracks: Cracks,
    time: f64,
}

impl Run {
    fn new(scene: &Scene) -> Self {
        let particles = Particles::fill(scene).unwrap();
        let cracks = Cracks::of_scene(scene);
        Self { solver: Updated::new(scene, Arc::new(particles), &cracks).unwrap(), cracks, time: 0.0 }
    }

    fn steps(&mut self, count: usize, time_step: f64) {
        for _ in 0..count {
            self.solver.step(&self.cracks, self.time, time_step, &mut |_| ()).unwrap();
            self.time += time_step;
        }
    }

    fn momentum(&self) -> Vector {
        self.solver.momenta().0
    }

    /// Around the origin.
    fn angular_momentum(&self) -> f64 {
        self.solver.momenta().1
    }

    fn largest_stress(&self) -> f64 {
        self.solver.setup.particles.frame(&self.solver).cauchy_stress.iter().fold(0.0, |a, s| a.max(s.norm()))
    }
}

/// Velocities at the nodes of `lattice` that differ from node to node and by `seed`; x and y apart.
pub(super) fn waves(lattice: &Lattice, seed: f64) -> [Vec<f64>; 2] {
    [seed, seed + 1.0].map(|seed| (0..lattice.grid.len()).map(|i| (seed * (i as f64 + 1.0)).sin()).collect())
}

/// Nodes with velocities of all kinds but the remapped ones.
pub(super) fn waving(lattice: &Lattice) -> Nodes {
    let [before, after, smoothed, gain] = [0.3, 0.7, 1.1, 1.9].map(|seed| waves(lattice, seed));
    Nodes { before, after, smoothed, gain, ..Nodes::default() }
}

/// Truth: statics. Shear along all four edges of a plate, whose edges lie anywhere between particles, turns nothing.
#[test]
fn tractions_that_balance_turn_nothing() {
    let (traction, width, height) = (3.0, 1.33, 0.91);
    let mut scene = free_body(rectangle([0.02, 0.05], [0.02 + width, 0.05 + height]), 0.1);
    scene.solver.kernel = Kernel::Quadratic;
    scene.solver.transfer = Transfer::Apic;
    let along = [
        (BoxSide::Top, [traction, 0.0]),
        (BoxSide::Bottom, [-traction, 0.0]),
        (BoxSide::Right, [0.0, traction]),
        (BoxSide::Left, [0.0, -traction]),
    ];
    for (side, [x, y]) in along {
        scene.loads.push(Load {
            selection: Selection::Edge { side, bodies: None },
            kind: LoadKind::Traction(Vector::new(x, y)),
            curve: always(),
        });
    }
    let mut run = Run::new(&scene);
    let time_step = 0.2 * run.solver.stable_time_step();
    run.steps(4, time_step);
    let given = traction * width * height * 4.0 * time_step;
    assert!(run.momentum().norm() < 1e-12 * given && run.angular_momentum().abs() < 1e-3 * given);
    assert!(run.solver.energies().kinetic > 0.0);
}

/// A body without cracks whose particles are off their lattice, move at random and are strained, on the grid of its
/// next step.
pub(super) fn shaken(kernel: Kernel) -> (Setup, Points, Lattice) {
    let mut scene = free_body(rectangle([0.0, 0.0], [2.0, 1.0]), 0.05);
    (scene.solver.kernel, scene.solver.transfer) = (kernel, Transfer::Apic);
    let mut run = Run::new(&scene);
    let mut count = 0.0;
    let mut next = || {
        count += 1.0;
        (12.9898_f64 * count).sin()
    };
    for (point, affine) in run.solver.points.point.iter_mut().zip(&mut run.solver.points.affine) {
        point.position += 0.02 * Vector::new(next(), next());
        point.velocity = Vector::new(next(), next());
        point.elastic_gradient = 0.1 * Matrix::new(next(), next(), next(), next());
        *affine = Matrix::new(next(), next(), next(), next());
    }
    run.solver.lay_grid(&run.cracks, 0.0).unwrap();
    let Updated { setup, points, lattice, .. } = run.solver;
    (setup, points, lattice)
}

/// A plate of 1.6 m × 1 m with a kinked crack from its left edge, all of it beside grid lines.
fn cracked_plate(spacing: f64) -> Scene {
    let mut scene = free_body(rectangle([0.0, 0.0], [1.6, 1.0]), spacing);
    add_crack(&mut scene, &[[0.0, 0.53], [0.41, 0.51], [0.83, 0.61]]);
    scene
}

/// A crack that is torn over more cells than there are particles to divide ends the run: filed in full it takes all
/// memory.
#[test]
fn a_crack_that_is_torn_far_apart_is_told() {
    let mut run = Run::new(&cracked_plate(0.05));
    run.solver.faces.cracks[0].position[1] = Point::new(3e4, -2e4);
    // Growing rebuilds the division before the next step looks.
    let cracks = run.cracks.clone();
    run.solver.recut(&cracks, &[]);
    let found = run.solver.step(&cracks, 0.0, 1e-9, &mut |_| ());
    assert!(
        matches!(&found, Err(SimulationError::Unstable { cause, .. }) if cause.contains("a crack apart")),
        "{found:?}"
    );
}

/// Truth: Newton's first law. Stresses are started by a velocity field that is not uniform; 40 steps of at most 1e3
/// additions per node keep 1e-12.
#[test]
fn momentum_is_conserved_by_every_kernel_and_transfer_across_a_crack() {
    for kernel in KERNELS {
        for transfer in TRANSFERS {
            for tip_division in [TipDivision::LineCrossing, TipDivision::PartlyCut] {
                let mut scene = cracked_plate(0.05);
                scene.solver.kernel = kernel;
                scene.solver.transfer = transfer;
                scene.solver.tip_division = tip_division;
                set_motion(&mut scene, Selection::All, [0.3, -0.2], 0.4, [0.2, 0.9]);
                set_motion(&mut scene, Selection::Region(rectangle([0.0, 0.0], [0.8, 0.5])), [0.1, 0.3], 0.0, [0.0; 2]);
                let mut run = Run::new(&scene);
                let before = run.momentum();
                let time_step = 0.4 * run.solver.stable_time_step();
                run.steps(40, time_step);
                let error = (run.momentum() - before).norm() / before.norm();
                assert!(error < 1e-12, "{kernel:?} {transfer:?} {tip_division:?}: {error:e}");
                assert!(run.largest_stress() > 1e-3, "the test has stresses");
            }
        }
    }
}

/// Truth: partition of unity across crack fields: the mass on the grid is that of the particles, and a uniform velocity
/// is gathered as such.
#[test]
fn weights_add_up_to_one_across_a_crack() {
    for kernel in KERNELS {
        for tip_division in [TipDivision::LineCrossing, TipDivision::PartlyCut] {
            let mut scene = cracked_plate(0.05);
            scene.solver.kernel = kernel;
            scene.solver.tip_division = tip_division;
            set_motion(&mut scene, Selection::All, [3.0, -2.0], 0.0, [0.0; 2]);
            let mut run = Run::new(&scene);
            run.steps(1, 1e-4);
            let solver = &run.solver;
            assert!(solver.lattice.fields.further_count() > 10 && solver.lattice.stencils.rows() > 20);
            let (grid, particles): (f64, f64) =
                (solver.nodes.mass.iter().sum(), solver.setup.particles.mass.iter().sum());
            assert!((grid / particles - 1.0).abs() < 1e-13);
            for point in &solver.points.point {
                assert!((point.velocity - Vector::new(3.0, -2.0)).norm() < 1e-13);
                // Gradients of weights add up to zero: no strain, up to round-off of v Δt/h.
                assert!(point.elastic_gradient.norm() < 1e-15 * 100.0);
            }
        }
    }
}

/// Truth: a free body keeps its angular momentum. APIC promises it with stresses (B-splines); FLIP as long as no stress
/// acts.
#[test]
fn angular_momentum_is_conserved() {
    for kernel in [Kernel::Quadratic, Kernel::Cubic] {
        for (transfer, stiff) in [(Transfer::Apic, true), (Transfer::Flip(1.0), false)] {
            for tip_division in [TipDivision::LineCrossing, TipDivision::PartlyCut] {
                let mut scene = cracked_plate(0.05);
                scene.solver.kernel = kernel;
                scene.solver.transfer = transfer;
                scene.solver.tip_division = tip_division;
                if !stiff {
                    scene.materials[0].young_modulus = 1e-20;
                    // An impulse between fields keeps the angular momentum of the grid, not that of FLIP's particles.
                    scene.solver.crack_contact = false;
                }
                set_motion(&mut scene, Selection::All, [0.0, 0.0], 1.5, [0.8, 0.5]);
                let mut run = Run::new(&scene);
                let before = run.angular_momentum();
                let time_step = if stiff { 0.4 * run.solver.stable_time_step() } else { 1e-3 };
                run.steps(60, time_step);
                let error = run.angular_momentum() / before - 1.0;
                assert!(error.abs() < 1e-12, "{kernel:?} {transfer:?} {tip_division:?}: {error:e}");
            }
        }
    }
}

/// Truth: translation through many cells leaves no stress and moves cracks, faces and outlines by v t.
#[test]
fn rigid_translation_is_exact() {
    for kernel in KERNELS {
        for transfer in TRANSFERS {
            let mut scene = cracked_plate(0.05);
            scene.solver.kernel = kernel;
            scene.solver.transfer = transfer;
            let v = Vector::new(7.0, -3.0);
            set_motion(&mut scene, Selection::All, v.into(), 0.0, [0.0; 2]);
            let mut run = Run::new(&scene);
            run.steps(120, 5e-4);
            assert!(run.largest_stress() < 1e-9, "{kernel:?} {transfer:?}: {} {}", run.largest_stress(), run.time);
            let way = v * run.time;
            let crack = &run.solver.crack_frames(&run.cracks)[0];
            for (now, rest) in crack.above.iter().chain(&crack.below).zip(crack.rest.iter().chain(&crack.rest)) {
                assert!((now - rest - way).norm() < 1e-11);
            }
            let outline = &run.solver.outline_frames()[0];
            for (now, rest) in outline.position.iter().zip(&outline.rest) {
                assert!((now - rest - way).norm() < 1e-11, "{kernel:?} {transfer:?}: {rest} by {}", now - rest - way);
            }
        }
    }
}

/// Truth: the two vertices of the outline at a mouth are the end points of the faces, to the bit, also when the crack
/// has opened.
#[test]
fn outline_and_faces_share_their_end_points() {
    let mut scene = cracked_plate(0.05);
    set_motion(&mut scene, Selection::Region(rectangle([0.0, 0.5], [1.6, 1.0])), [0.0, 1.0], 0.0, [0.0; 2]);
    set_motion(&mut scene, Selection::Region(rectangle([0.0, 0.0], [1.6, 0.5])), [0.0, -1.0], 0.0, [0.0; 2]);
    let mut run = Run::new(&scene);
    run.steps(40, 0.5 * run.solver.stable_time_step());
    let crack = &run.solver.crack_frames(&run.cracks)[0];
    assert_eq!(crack.start, CrackEnd::Mouth);
    let opening = crack.above[0] - crack.below[0];
    assert!(opening.y > 0.01, "{opening}");
    assert_eq!(crack.above.last(), crack.below.last());
    let outline = &run.solver.outline_frames()[0];
    let at = outline.position.iter().position(|p| *p == crack.above[0]).unwrap();
    assert_eq!(outline.position[at + 1], crack.below[0]);
    assert_eq!((outline.rest[at], outline.rest[at + 1]), (crack.rest[0], crack.rest[0]));
}

/// Truth: the front of a step in a bar with held sides (uniaxial strain) has gone c_d t; found where the velocity is
/// half the step's.
#[test]
fn a_wave_runs_at_the_dilatational_speed() {
    for (kernel, transfer) in
        [(Kernel::Cubic, Transfer::Apic), (Kernel::Quadratic, Transfer::Flip(1.0)), (Kernel::Bilinear, Transfer::Xpic)]
    {
        let mut scene = free_body(rectangle([0.0, 0.0], [4.0, 0.2]), 0.0125);
        scene.solver.kernel = kernel;
        scene.solver.transfer = transfer;
        let push = 1e-4;
        scene.supports.push(Support {
            selection: Selection::Edge { side: BoxSide::Left, bodies: None },
            velocity: [Some(push), None],
            curve: always(),
        });
        scene.supports.push(Support { selection: Selection::All, velocity: [None, Some(0.0)], curve: always() });
        let mut run = Run::new(&scene);
        let c = run.solver.setup.elastic[0].dilatational_wave_speed();
        let time_step = 0.5 * run.solver.stable_time_step();
        let front = |run: &Run| {
            let fast = run.solver.points.point.iter().filter(|p| p.velocity.x > 0.5 * push);
            fast.map(|p| p.position.x).fold(0.0, f64::max)
        };
        // The held edge starts the wave over some steps; from then on only its speed counts.
        run.steps((1.0 / c / time_step) as usize, time_step);
        let (place, time) = (front(&run), run.time);
        run.steps((2.5 / c / time_step) as usize, time_step);
        let speed = (front(&run) - place) / (run.time - time);
        // Places are known to a particle spacing, 0.5 % of the way; transfers smear the front.
        assert!((speed / c - 1.0).abs() < 0.02, "{kernel:?} {transfer:?}: {speed} is not {c}");
    }
}

/// Truth: what a particle of snow does in a step is `plastic_step` applied to its trial F_E; F_E F_P keeps the whole
/// deformation.
#[test]
fn plastic_flow_keeps_the_whole_deformation() {
    let snow = Plasticity { critical_compression: 2.5e-2, critical_stretch: 7.5e-3, hardening: 10.0 };
    let mut scene = free_body(rectangle([0.0, 0.0], [0.8, 0.8]), 0.05);
    scene.solver.transfer = Transfer::Apic;
    let elastic = Run::new(&scene);
    assert!(elastic.solver.points.plastic.is_empty(), "an elastic scene pays nothing");
    scene.materials[0].plasticity = Some(snow);
    // Stretches by 10 % of a second's rate of 20/s, with hardly any stress to stop it.
    scene.materials[0].young_modulus = 1e-6;
    let mut run = Run::new(&scene);
    for point in &mut run.solver.points.point {
        point.velocity = Vector::new(20.0 * point.position.x, 0.0);
    }
    for c in &mut run.solver.points.affine {
        *c = Matrix::new(20.0, 0.0, 0.0, 0.0);
    }
    run.steps(10, 1e-3);
    // ẋ = 20 x (fixed in the material): x = X (1 + 20 t).
    let frame = run.solver.setup.particles.frame(&run.solver);
    let middle = frame.rest.iter().position(|x| (x - Point::new(0.425, 0.425)).norm() < 1e-9).unwrap();
    let exact = Matrix::new(1.0 + 20.0 * run.time, 0.0, 0.0, 1.0);
    assert!((frame.deformation_gradient[middle] - exact).norm() < 1e-3, "{}", frame.deformation_gradient[middle]);
    let h = run.solver.points.point[middle].elastic_gradient;
    assert!((h.m11 - 7.5e-3).abs() < 1e-12 && h.m22.abs() < 1e-12, "{h}");
    let part = run.solver.points.plastic[middle];
    assert!((part.hardening - (10.0 * (1.0 - part.gradient.determinant())).exp()).abs() < 1e-12);
}

/// Two halves of a body with a crack all through it that move at ±1 m/s along y.
fn halves(towards: f64) -> Run {
    let mut scene = free_body(rectangle([0.0, 0.0], [0.8, 1.6]), 0.05);
    scene.solver.transfer = Transfer::Flip(1.0);
    add_crack(&mut scene, &[[0.0, 0.83], [0.8, 0.83]]);
    set_motion(&mut scene, Selection::Region(rectangle([0.0, 0.83], [0.8, 1.6])), [0.0, -towards], 0.0, [0.0; 2]);
    set_motion(&mut scene, Selection::Region(rectangle([0.0, 0.0], [0.8, 0.83])), [0.0, towards], 0.0, [0.0; 2]);
    let mut run = Run::new(&scene);
    let time_step = 0.3 * run.solver.stable_time_step();
    // Until a wave has gone some cells.
    run.steps((0.3 / 36.7 / time_step) as usize, time_step);
    run
}

/// Kinetic and strain energy [J/m].
fn energies(solver: &Updated) -> f64 {
    let energies = solver.energies();
    energies.kinetic + energies.strain
}

impl Run {
    fn mean_velocity(&self, keep: impl Fn(Point) -> bool) -> Vector {
        let s = &self.solver;
        let (mut sum, mut count) = (Vector::zeros(), 0.0);
        for (point, rest) in s.points.point.iter().zip(&s.setup.particles.rest) {
            if keep(*rest) {
                sum += point.velocity;
                count += 1.0;
            }
        }
        sum / count
    }
}

/// Truth: halves pressed together stop at their faces (symmetric impact); halves that part do not feel each other.
#[test]
fn contact_transmits_pushes_and_not_pulls() {
    let near_above = |p: Point| p.y > 0.83 && p.y < 0.98 && (p.x - 0.4).abs() < 0.2;
    let pressed = halves(1.0);
    assert!(pressed.mean_velocity(near_above).y.abs() < 0.1, "{}", pressed.mean_velocity(near_above));
    // 17 and 15 rows of 16 particles.
    assert!((pressed.momentum().y - 2.0 * 16.0 * 0.05 * 0.05).abs() < 1e-12);
    let crack = &pressed.solver.crack_frames(&pressed.cracks)[0];
    let middle = crack.above.len() / 2;
    assert!((crack.above[middle] - crack.below[middle]).y.abs() < 0.1 * 2.0 * pressed.time);
    let parted = halves(-1.0);
    for point in &parted.solver.points.point {
        assert!((point.velocity.y.abs() - 1.0).abs() < 1e-9, "{}", point.velocity);
    }
    let crack = &parted.solver.crack_frames(&parted.cracks)[0];
    assert!(((crack.above[middle] - crack.below[middle]).y - 2.0 * parted.time).abs() < 1e-9);
}

/// Truth: a turn by a right angle of a cracked body at rest relative to itself brings no contact: the places at rest
/// that both sides see at a node are the same.
#[test]
fn a_turned_body_is_not_in_contact_with_itself() {
    let mut scene = free_body(rectangle([0.0, 0.0], [1.6, 1.0]), 0.05);
    add_crack(&mut scene, &[[0.0, 0.53], [0.83, 0.61]]);
    let run = Run::new(&scene);
    let mut solver = run.solver;
    let turn = Matrix::new(0.0, -1.0, 1.0, 0.0);
    for point in &mut solver.points.point {
        point.position = Point::from(turn * point.position.coords);
        point.elastic_gradient = turn - Matrix::identity();
    }
    for crack in &mut solver.faces.cracks {
        for p in crack.position.iter_mut().chain(crack.faces.iter_mut().flatten()) {
            *p = Point::from(turn * p.coords);
        }
    }
    let mut closed = 0;
    // A gap and an overlap of 1e-6 m, much less than the 0.1 m between the particles on the two sides: above is −x
    // after the turn.
    for (shift, expected) in [(-1e-6, false), (1e-6, true)] {
        let mut shifted =
            Updated::restore(&scene, solver.setup.particles.clone(), &run.cracks, &solver.save().unwrap()).unwrap();
        for p in 0..shifted.setup.particles.len() {
            let rest = shifted.setup.particles.rest[p];
            if rest.y > 0.53 + rest.x * (0.08 / 0.83) {
                shifted.points.point[p].position.x += shift;
            }
        }
        shifted.lay_grid(&run.cracks, 0.0).unwrap();
        let pairs = shifted.overlaps().len();
        closed += usize::from(expected && pairs > 0);
        assert_eq!(pairs > 0, expected, "{pairs} pairs at {shift}");
    }
    assert_eq!(closed, 1);
}

/// Truth: growing a crack touches no particle; the new point lies where the material there is.
#[test]
fn growth_keeps_momentum_and_follows_the_material() {
    let mut scene = cracked_plate(0.05);
    scene.solver.transfer = Transfer::Apic;
    set_motion(&mut scene, Selection::All, [5.0, 0.0], 3.0, [0.8, 0.5]);
    let mut run = Run::new(&scene);
    run.steps(100, 0.4 * run.solver.stable_time_step());
    let before = run.momentum();
    let target = Point::new(0.93, 0.62);
    run.cracks.grow(TipId::new(0, End::End), &[target]);
    let (solver, cracks) = (&mut run.solver, &run.cracks);
    solver.recut(cracks, &[TipId::new(0, End::End)]);
    assert_eq!(run.momentum(), before);
    let frame = run.solver.setup.particles.frame(&run.solver);
    let near = (0..frame.len())
        .min_by(|&a, &b| (frame.rest[a] - target).norm().total_cmp(&(frame.rest[b] - target).norm()))
        .unwrap();
    let expected = frame.position[near] + frame.deformation_gradient[near] * (target - frame.rest[near]);
    let (tip, _) = run.solver.tip_now(&run.cracks, TipId::new(0, End::End));
    assert!((tip - expected).norm() < 0.02 * scene.cell_size, "{tip} {expected}");
    run.steps(20, 0.4 * run.solver.stable_time_step());
    assert!((run.momentum() - before).norm() < 1e-12 * before.norm());
}

/// A scene in which everything acts at once.
fn busy_scene() -> Scene {
    let mut scene = cracked_plate(0.0125);
    scene.solver.transfer = Transfer::Flip(0.95);
    scene.solver.tip_division = TipDivision::PartlyCut;
    scene.gravity = Vector::new(0.0, -9.8);
    scene.loads.push(Load {
        selection: Selection::Edge { side: BoxSide::Top, bodies: None },
        kind: LoadKind::Traction(Vector::new(1.0, 20.0)),
        curve: always(),
    });
    scene.supports.push(Support {
        selection: Selection::Edge { side: BoxSide::Bottom, bodies: None },
        velocity: [Some(0.1), Some(0.0)],
        curve: always(),
    });
    scene.colliders.push(fissure_scene::Collider {
        name: "disc".into(),
        shape: fissure_scene::ColliderShape::Disc { radius: 0.3 },
        keyframes: vec![(0.0, fissure_scene::Pose { position: Point::new(1.8, 0.3), angle: 0.0 })],
        contact: fissure_scene::Contact::Separate,
        friction: 0.2,
    });
    scene.materials[0].plasticity =
        Some(Plasticity { critical_compression: 2.5e-2, critical_stretch: 7.5e-3, hardening: 10.0 });
    scene
}

#[test]
fn a_saved_state_goes_on_bit_for_bit() {
    let scene = busy_scene();
    let mut run = Run::new(&scene);
    let time_step = 0.3 * run.solver.stable_time_step();
    run.steps(15, time_step);
    let bytes = run.solver.save().unwrap();
    let restored = Updated::restore(&scene, Arc::new(Particles::fill(&scene).unwrap()), &run.cracks, &bytes).unwrap();
    let mut other = Run { solver: restored, cracks: run.cracks.clone(), time: run.time };
    run.steps(15, time_step);
    other.steps(15, time_step);
    assert_eq!(run.solver.save().unwrap(), other.solver.save().unwrap());
    assert!(Updated::restore(&scene, Arc::new(Particles::fill(&scene).unwrap()), &run.cracks, &bytes[..99]).is_err());
}

#[test]
fn one_and_two_threads_give_the_same_bytes() {
    let scene = busy_scene();
    let states = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut run = Run::new(&scene);
            assert!(run.solver.setup.particles.len() > setup::PARALLEL_PARTICLES, "the threads have something to do");
            let time_step = 0.3 * run.solver.stable_time_step();
            run.steps(20, time_step);
            run.solver.save().unwrap()
        })
    });
    assert!(states[0] == states[1]);
}

/// Truth: energy. A cracked plate that vibrates, at rest and in flight through the cells, gains none below the stable
/// step; at twice the step it blows up (the bilinear kernel's bound is measured in flight with FLIP and is wider at
/// rest).
#[test]
fn the_stable_step_is_stable_and_twice_it_is_not() {
    for kernel in KERNELS {
        for (speed, factor) in [(0.0, 0.95), (5.0, 0.95), (0.0, 2.0)] {
            let mut scene = cracked_plate(0.05);
            scene.solver.kernel = kernel;
            scene.solver.transfer = Transfer::Flip(1.0);
            let left = Selection::Region(rectangle([0.0, 0.0], [0.8, 1.0]));
            set_motion(&mut scene, Selection::All, [speed, 0.3 * speed], 0.0, [0.0; 2]);
            set_motion(&mut scene, left, [0.1, 0.02], 0.0, [0.0; 2]);
            let mut run = Run::new(&scene);
            let energy = |run: &Run| energies(&run.solver);
            let first = energy(&run);
            let mut failed = false;
            for _ in 0..400 {
                let time_step = factor * run.solver.stable_time_step();
                failed = run.solver.step(&run.cracks, run.time, time_step, &mut |_| ()).is_err();
                run.time += time_step;
                if failed {
                    break;
                }
            }
            let growth = energy(&run) / first;
            if factor < 1.0 {
                assert!(!failed && growth < 1.01, "{kernel:?} at {speed} m/s: energy times {growth}");
            } else if kernel != Kernel::Bilinear {
                assert!(failed || growth > 10.0, "{kernel:?}: {growth}");
            }
        }
    }
}

/// Whether a square of `count` by `count` particles in cells of 0.1 m, at `place` of a cell [cells] and turned by
/// `angle` [rad], that trembles goes on as it is, in steps of so many times the stable one.
fn is_calm(scene: &Scene, count: usize, (place, angle): ([f64; 2], f64), factor: f64) -> bool {
    let mut scene = scene.clone();
    let side = 0.05 * count as f64;
    scene.bodies[0].region = rectangle([0.0, 0.0], [side, side]);
    let mut run = Run::new(&scene);
    let turn = nalgebra::Rotation2::new(angle);
    for (k, point) in run.solver.points.point.iter_mut().enumerate() {
        let noise = |salt: f64| 1e-7 * (12.9898 * (k as f64 + 1.0) * salt).sin();
        point.position = turn * (point.position - Vector::new(0.025, 0.025)) + 0.1 * Vector::from(place);
        point.elastic_gradient = Matrix::new(noise(1.0), noise(2.0), noise(3.0), noise(5.0));
    }
    // Without turns.
    let strain = |run: &Run| -> f64 {
        let points = run.solver.points.point.iter();
        points.map(|point| (point.elastic_gradient + point.elastic_gradient.transpose()).norm_squared()).sum()
    };
    let first = strain(&run);
    let time_step = factor * run.solver.stable_time_step();
    for _ in 0..600 {
        if run.solver.step(&run.cracks, run.time, time_step, &mut |_| ()).is_err() {
            return false;
        }
        run.time += time_step;
    }
    strain(&run) < 1e3 * first
}

/// Truth: the eigenvalues of one particle. Shards of 1 to 9 particles tremble as they did below the stable step,
/// wherever they are; above it one that is alone explodes where it is stiffest.
#[test]
fn the_stable_step_is_that_of_a_particle_alone() {
    let transfers = TRANSFERS.into_iter().chain([Transfer::Aflip]);
    for (transfer, poisson_ratio) in transfers.flat_map(|transfer| [0.3, -0.6].map(|ratio| (transfer, ratio))) {
        for kernel in [Kernel::Gimp, Kernel::Quadratic, Kernel::Cubic] {
            let mut scene = free_body(rectangle([0.0, 0.0], [1.0, 1.0]), 0.05);
            scene.materials[0].poisson_ratio = poisson_ratio;
            (scene.solver.kernel, scene.solver.transfer) = (kernel, transfer);
            for k in 0..42 {
                let random = |salt: f64| (43.7585 * (f64::from(k) + salt)).sin().abs();
                let place = [random(0.1), random(0.7)];
                let count = 1 + k as usize % 3;
                let said = format!("{kernel:?}, {transfer:?}, ν {poisson_ratio}, {count} at {place:?}");
                assert!(is_calm(&scene, count, (place, 2.0 * random(0.4)), 0.99), "{said}");
            }
            let explodes = |k: u32| !is_calm(&scene, 1, ([f64::from(k) / 64.0 + 1e-3; 2], 0.0), 1.03);
            assert!((0..64).any(explodes), "{kernel:?}, {transfer:?}, ν {poisson_ratio} is stable beyond the limit");
        }
    }
}

/// Truth: energy, as above, with a tip at every kind of place between two columns of particles: fields of next to no
/// mass beside it.
#[test]
fn a_tip_anywhere_leaves_the_stable_step_stable() {
    for kernel in [Kernel::Gimp, Kernel::Quadratic, Kernel::Cubic] {
        let mut worst = 0.0_f64;
        for behind in [1e-13, 1e-3, 0.03, 0.2, 0.5, 0.9] {
            for height in [0.513, 0.525] {
                let mut scene = free_body(rectangle([0.0, 0.0], [1.6, 1.0]), 0.05);
                // Particles stand at x = 0.825; their domains begin at 0.8.
                add_crack(&mut scene, &[[0.0, height], [0.8 + 0.05 * behind, height]]);
                scene.solver.kernel = kernel;
                scene.solver.transfer = Transfer::Flip(1.0);
                scene.solver.tip_division = TipDivision::PartlyCut;
                scene.solver.crack_contact = false;
                let upper = Selection::Region(rectangle([0.0, 0.5], [0.8, 1.0]));
                set_motion(&mut scene, upper, [0.02, 0.1], 0.0, [0.0; 2]);
                let mut run = Run::new(&scene);
                let energy = |run: &Run| energies(&run.solver);
                let first = energy(&run);
                let time_step = 0.95 * run.solver.stable_time_step();
                for _ in 0..200 {
                    if run.solver.step(&run.cracks, run.time, time_step, &mut |_| ()).is_err() {
                        worst = f64::INFINITY;
                        break;
                    }
                    run.time += time_step;
                }
                worst = worst.max(energy(&run) / first);
            }
        }
        assert!(worst < 1.01, "{kernel:?}: energy times {worst}");
    }
}

/// Particle-steps per second on one thread, printed: `cargo test --release -p fissure-sim rates -- --ignored
/// --nocapture`.
#[test]
#[ignore = "takes time and wants a quiet machine"]
fn rates() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    for cracked in [false, true] {
        for kernel in KERNELS {
            for transfer in [Transfer::Pic, Transfer::Flip(1.0), Transfer::Apic, Transfer::Xpic] {
                let mut scene = free_body(rectangle([0.0, 0.0], [2.0, 1.0]), 0.005);
                scene.solver.kernel = kernel;
                scene.solver.transfer = transfer;
                if cracked {
                    let points: Vec<[f64; 2]> = (0..=200).map(|k| [0.005 * f64::from(k), 0.503]).collect();
                    add_crack(&mut scene, &points);
                }
                set_motion(&mut scene, Selection::All, [0.01, 0.0], 0.01, [1.0, 0.5]);
                let mut run = Run::new(&scene);
                let time_step = 0.5 * run.solver.stable_time_step();
                pool.install(|| {
                    run.steps(2, time_step);
                    let start = std::time::Instant::now();
                    run.steps(12, time_step);
                    let rate = 12.0 * run.solver.setup.particles.len() as f64 / start.elapsed().as_secs_f64();
                    println!("crack {cracked}, {kernel:?}, {transfer:?}: {:.1} M/s", 1e-6 * rate);
                });
            }
        }
    }
}

/// Truth: the construction. Two plates have the nodes of one twice, also while one flies away from the other.
#[test]
fn nodes_go_with_the_material_wherever_it_flies() {
    let mut scene = free_body(rectangle([0.0, 0.0], [4.0, 4.0]), 0.125);
    let mut alone = Run::new(&scene);
    alone.solver.lay_grid(&alone.cracks, 0.0).unwrap();
    add_body(&mut scene, [100.0, 70.0]);
    let mut both = Run::new(&scene);
    for _ in 0..4 {
        both.solver.lay_grid(&both.cracks, 0.0).unwrap();
        let (nodes, once) = (both.solver.lattice.grid.len(), alone.solver.lattice.grid.len());
        assert!(nodes < 2 * once + 300, "{nodes} {once}");
        let count = both.solver.points.point.len();
        both.solver.points.point[count / 2..].iter_mut().for_each(|p| p.position += Vector::new(1e4, 3e4 + 0.1));
    }
}

/// Truth: brute force. A body at rest that a support holds, and one that flies past: each node's particles are those
/// whose lowest node it is, in every step.
#[test]
fn particles_are_sorted_by_where_they_are() {
    let mut scene = free_body(rectangle([0.0, 0.0], [1.0, 1.0]), 0.0625);
    scene.supports.push(Support { selection: Selection::Bodies(vec![0]), velocity: [Some(0.0); 2], curve: always() });
    add_body(&mut scene, [2.0, 0.0]);
    // Not along the grid, and turning.
    set_motion(&mut scene, Selection::All, [3.0, 1.0], 0.5, [2.5, 0.5]);
    scene.bodies[1].velocities = std::mem::take(&mut scene.bodies[0].velocities);
    let mut run = Run::new(&scene);
    let time_step = 0.5 * run.solver.stable_time_step();
    for _ in 0..60 {
        run.steps(1, time_step);
        run.solver.lay_grid(&run.cracks, run.time).unwrap();
        let (lattice, points) = (&run.solver.lattice, &run.solver.points.point);
        for node in 0..lattice.grid.len() {
            for &p in lattice.order.of_nodes(node..node + 1) {
                let lowest = lattice.stencil(points[p as usize].position).first;
                assert_eq!(lattice.order.place[p as usize], lowest);
                assert_eq!(lattice.order.node[p as usize] as usize, node, "particle {p}");
            }
        }
        assert_eq!(lattice.order.of_nodes(0..lattice.grid.len()).len(), points.len());
    }
}

/// Truth: the drawing, and Newton. Wherever in the cells of a square a support lies that has only one of its particles,
/// or two such supports in one: what is there moves as it says, and the square takes up the momentum that it gives.
#[test]
fn a_support_of_one_particle_holds_it() {
    let speed = 0.3;
    for kernel in KERNELS {
        for (at, other) in [(0.9, None), (2.6, None), (5.1, Some(1.2)), (6.3, Some(5.8))] {
            let mut scene = free_body(rectangle([0.1, 0.2], [8.0, 8.1]), 0.5);
            (scene.solver.kernel, scene.solver.transfer) = (kernel, Transfer::Aflip);
            let particles = Particles::fill(&scene).unwrap();
            let nearest = |x: f64| {
                let away = |place: &&Point| (*place - Point::new(x, x)).norm();
                *particles.rest.iter().min_by(|a, b| away(a).total_cmp(&away(b))).unwrap()
            };
            let places: Vec<Point> = [Some(at), other].into_iter().flatten().map(nearest).collect();
            let selection = Selection::Near { points: places.clone(), radius: 0.01 };
            scene.supports.push(Support { selection, velocity: [Some(speed), None], curve: always() });
            let mut solver = Run::new(&scene).solver;
            solver.lay_grid(&Cracks::of_scene(&scene), 0.0).unwrap();
            solver.move_nodes(0.0, 1e-3);
            solver.constrain_nodes(0.0, 1e-3);
            for (p, point) in
                solver.points.point.iter().enumerate().filter(|(_, point)| places.contains(&point.position))
            {
                let found = solver.source().gather_one(p, point).velocity;
                assert!((found - Vector::new(speed, 0.0)).norm() < 1e-6, "{kernel:?} {at}: {found}");
            }
            let momentum: f64 = solver.nodes.mass.iter().zip(&solver.nodes.after[0]).map(|(m, v)| m * v).sum();
            let impulse = solver.reactions[0].impulse[0];
            assert!(impulse > 0.0 && (momentum / impulse - 1.0).abs() < 1e-9, "{momentum} {impulse}");
        }
    }
}

/// Truth: a hair changes little. A strained plate whose outermost particles have come a hair over a line of nodes lets
/// go at the same speed as where they have come farther: no particle turns or strains more than ten times as fast.
#[test]
fn a_particle_that_has_just_entered_a_cell_is_not_thrown_about() {
    let fastest = |transfer, beyond: f64| {
        let mut scene = free_body(rectangle([0.0, 0.0], [2.0, 2.0]), 0.25);
        (scene.solver.kernel, scene.solver.transfer) = (Kernel::Bilinear, transfer);
        let mut run = Run::new(&scene);
        run.solver.lay_grid(&run.cracks, 0.0).unwrap();
        let (origin, h) = (run.solver.lattice.grid.origin.x, scene.cell_size);
        let last = run.solver.points.point.iter().fold(0.0, |most: f64, point| most.max(point.position.x));
        let over = ((last - origin) / h).rem_euclid(1.0);
        for point in &mut run.solver.points.point {
            point.position.x += (1.0 + beyond - over) * h;
            point.elastic_gradient.m11 = 1e-4;
        }
        let time_step = 0.5 * run.solver.stable_time_step();
        run.steps(1, time_step);
        run.solver.points.affine.iter().map(Matrix::norm).fold(0.0, f64::max)
    };
    for transfer in [Transfer::Apic, Transfer::Aflip] {
        let [near, far] = [1e-6, 0.3].map(|beyond| fastest(transfer, beyond));
        assert!(far > 0.0 && near < 10.0 * far, "{transfer:?}: {near} and {far}");
    }
}
