//! Mirror images and quarter turns of a scene give mirror images and quarter turns of its results, to round-off.

use crate::placed::Placed;
use crate::placement::Placement;
use crate::problem::{Problem, linear_material, material, rectangle};
use fissure_scene::{BoxSide, Branching, Frame, PlaneState, Point, Vector};
use fissure_sim::SimulationError;

/// A plate of 16 by 16 cells around the origin, so that its lattice is the same after mirrors and quarter turns, pulled
/// and sheared at once; its crack runs from the left edge.
fn plate(from: f64, tip: (f64, f64), contact: bool) -> Problem {
    let square = rectangle((-8.0, -8.0), (8.0, 8.0));
    let mut problem = Problem::new("symmetry", square, linear_material(), PlaneState::Strain, 1.0)
        .traction(BoxSide::Top, 100.0, 1e3)
        .traction(BoxSide::Bottom, -100.0, -1e3)
        .crack(&[(-8.0, from), tip], [false, true])
        .until(0.2, 2);
    problem.scene.solver.crack_contact = contact;
    problem
}

/// K_I, K_II [Pa·√m] after the waves have crossed the plate some ten times, and the velocities of the particles by
/// their place.
fn result(problem: &Problem, placement: Placement) -> Result<([f64; 2], Vec<Vector>), SimulationError> {
    let mut placed = Placed::new(&problem.scene, placement)?;
    while !placed.is_finished() {
        placed.advance()?;
    }
    let (tip, particles) = (placed.now().tips()[0], placed.now().frame().particles);
    let quarters = |p: &Point| [p.y, p.x].map(|x| (4.0 * x).round() as i32);
    let mut moving: Vec<_> = particles.rest.iter().map(quarters).zip(particles.velocity).collect();
    moving.sort_by_key(|(place, _)| *place);
    Ok(([tip.mode_1, tip.mode_2], moving.into_iter().map(|(_, velocity)| velocity).collect()))
}

/// Whether two results agree to round-off, which grows over some 300 steps.
fn agree(one: &([f64; 2], Vec<Vector>), other: &([f64; 2], Vec<Vector>)) -> bool {
    let amplitude = one.0[0].hypot(one.0[1]);
    let fastest = one.1.iter().map(|v| v.norm()).fold(0.0, f64::max);
    one.0.iter().zip(other.0).all(|(a, b)| (a - b).abs() <= 1e-11 * amplitude)
        && one.1.iter().zip(&other.1).all(|(a, b)| (a - b).norm() <= 1e-11 * fastest)
}

/// Truth: symmetry. The crack lies along a grid line with its tip on a node, on a particle's column and between, off
/// all lines, and across them.
#[test]
fn mirrors_and_quarter_turns_are_exact() -> Result<(), SimulationError> {
    let cracks =
        [(0.0, (-1.0, 0.0)), (0.0, (-0.75, 0.0)), (0.0, (-0.7, 0.0)), (0.3, (-0.7, 0.3)), (0.37, (-0.97, 3.1))];
    for (from, tip) in cracks {
        for contact in [false, true] {
            let problem = plate(from, tip, contact);
            let natural = result(&problem, Placement::NATURAL)?;
            for (mirror, quarters) in [(false, 1), (false, 2), (true, 0), (true, 1)] {
                let turned = result(&problem, Placement::by_right_angles(mirror, quarters))?;
                assert!(
                    agree(&natural, &turned),
                    "tip {tip:?}, {contact}, {mirror}, {quarters}: {:?} {:?}",
                    natural.0,
                    turned.0
                );
            }
        }
    }
    Ok(())
}

/// Particles on a crack belong to its upper side, which a mirror changes and a turn does not.
#[test]
fn quarter_turns_are_exact_on_particles() -> Result<(), SimulationError> {
    let problem = plate(0.25, (-1.0, 0.25), false);
    let natural = result(&problem, Placement::NATURAL)?;
    for quarters in 1..4 {
        assert!(agree(&natural, &result(&problem, Placement::by_right_angles(false, quarters))?), "{quarters}");
    }
    Ok(())
}

/// A plate of glass, symmetric about the x axis, that is pulled apart until its crack divides: an edge crack, or one
/// with two tips in the middle of the plate. `half_height` in cells.
fn dividing(half_height: f64, has_two_tips: bool) -> Problem {
    let h = 1e-3;
    let plate = rectangle((-0.02, -half_height * h), (0.02, half_height * h));
    let glass = material(72e9, 0.3333, 2440.0, 0.523e6);
    let (from, to) = if has_two_tips { (-0.0063, 0.0063) } else { (-0.02, -0.006) };
    let mut problem = Problem::new("division", plate, glass, PlaneState::Stress, h)
        .crack(&[(from, 0.0), (to, 0.0)], [has_two_tips, true])
        .traction(BoxSide::Top, 0.0, 3e6)
        .traction(BoxSide::Bottom, 0.0, -3e6)
        .growing()
        .until(13e-6, 13);
    problem.scene.solver.time_step = Some(7e-8);
    problem.scene.growth.branching = Some(Branching { release_ratio: 2.0, half_angle: 0.47, spacing: 0.05 });
    problem
}

/// A moment of a run: the tips [m], and the velocities of the particles [m/s] in the order of their places.
struct Moving {
    tips: Vec<Point>,
    velocities: Vec<Vector>,
}

/// How the frames of a run go; with `flip` those of its image in the x axis.
fn course(problem: &Problem, placement: Placement, flip: bool) -> Result<Vec<Moving>, SimulationError> {
    let (sign, h) = (if flip { -1.0 } else { 1.0 }, problem.scene.cell_size);
    let place = |p: &Point| [sign * p.y, p.x].map(|x| (4.0 * x / h).round() as i32);
    let mut placed = Placed::new(&problem.scene, placement)?;
    let mut course = Vec::new();
    while !placed.is_finished() {
        placed.advance()?;
        let Frame { particles, tips, .. } = placed.now().frame();
        let tips = tips.iter().map(|tip| Point::new(tip.position.x, sign * tip.position.y)).collect();
        let image = particles.velocity.iter().map(|v| Vector::new(v.x, sign * v.y));
        let mut moving: Vec<_> = particles.rest.iter().map(place).zip(image).collect();
        moving.sort_by_key(|(place, _)| *place);
        course.push(Moving { tips, velocities: moving.into_iter().map(|(_, velocity)| velocity).collect() });
    }
    Ok(course)
}

/// How far two courses are apart at most, of tips in cells of size `h` [m], of velocities as a part of the fastest.
fn apart(one: &[Moving], other: &[Moving], h: f64) -> f64 {
    let mut most = 0.0_f64;
    for (a, b) in one.iter().zip(other) {
        assert_eq!((a.tips.len(), a.velocities.len()), (b.tips.len(), b.velocities.len()));
        let fastest = a.velocities.iter().map(|v| v.norm()).fold(f64::MIN_POSITIVE, f64::max);
        for (tips, others) in [(&a.tips, &b.tips), (&b.tips, &a.tips)] {
            let to_nearest = |tip: &Point| others.iter().map(|other| (tip - other).norm() / h).fold(f64::MAX, f64::min);
            most = tips.iter().map(to_nearest).fold(most, f64::max);
        }
        most = a.velocities.iter().zip(&b.velocities).map(|(a, b)| (a - b).norm() / fastest).fold(most, f64::max);
    }
    most
}

/// Truth: symmetry. Branches of a crack along an axis of symmetry grow as each other's images, and the same in the
/// scene turned and mirrored. The axis lies on a row of nodes and midway between two.
#[test]
fn growth_and_divisions_are_symmetric() -> Result<(), SimulationError> {
    for (half_height, has_two_tips) in [(16.0, false), (16.5, false), (16.0, true), (16.5, true)] {
        let problem = dividing(half_height, has_two_tips);
        let h = problem.scene.cell_size;
        let natural = course(&problem, Placement::NATURAL, false)?;
        let last = natural.last().map(|moving| moving.tips.len());
        assert_eq!(last, Some(if has_two_tips { 4 } else { 2 }), "tips after the divisions");
        let image = apart(&natural, &course(&problem, Placement::NATURAL, true)?, h);
        assert!(image < 1e-10, "{half_height} {has_two_tips}: the branches are {image:e} apart");
        for (mirror, quarters) in [(false, 1), (true, 0)] {
            let placement = Placement::by_right_angles(mirror, quarters);
            let turned = apart(&natural, &course(&problem, placement, false)?, h);
            assert!(turned < 1e-10, "{half_height} {has_two_tips} {mirror} {quarters}: {turned:e}");
        }
    }
    Ok(())
}
