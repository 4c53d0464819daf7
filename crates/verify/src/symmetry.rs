//! Mirror images and quarter turns of a scene give mirror images and quarter turns of its results, to round-off.

use crate::placed::Placed;
use crate::placement::Placement;
use crate::problem::{Problem, linear_material, rectangle};
use fissure_scene::{BoxSide, PlaneState, Point, Vector};
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
