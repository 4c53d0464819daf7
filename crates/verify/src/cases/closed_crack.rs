//! Centre crack that is pressed together and sheared, with friction: what its faces hand on does not load its tips.
//!
//! Square plate of width 4 a around a crack of half length a. The tractions on its sides are those of a uniform stress
//! with the pressure p = 2τ on the crack and the shear τ along it. The pressure passes through the closed crack as if
//! it were not there. Where the faces slide, friction carries the uniform shear μ p across; what is left is the plate
//! under the shear τ − μ p alone: whatever the geometry, K_II = (1 − μ p/τ) times its value without pressure and
//! contact, K_I = 0, and J = K_II²/E'. (Superposition; for the infinite plate K_II = (τ − μ p) √(π a).)
//!
//! Without pressure the faces slide along each other and just touch: in shear alone nothing opens or presses, and K_I
//! and K_II are those of faces that may go through each other.
//!
//! Friction remembers, so the pressure comes first and the shear rises slowly and damped. Cells are counted along half
//! the crack.

use crate::case::{Case, Options};
use crate::placed::Placed;
use crate::placement::Placement;
use crate::problem::{Problem, linear_material, rectangle};
use crate::report::Tally;
use fissure_scene::{BoxSide, Curve, LoadKind, PlaneState, Selection, Vector};
use fissure_sim::{Elastic, SimulationError};
use std::ops::ControlFlow;

pub(crate) const CASE: Case = Case::new(
    "closed-crack",
    "K_II, K_I and J of a crack pressed together and sheared, with and without friction",
    ("along half the crack", 12.0),
    compute,
)
.family_cells(6.0);

/// τ [Pa].
const SHEAR: f64 = 1e3;
/// p [Pa].
const PRESSURE: f64 = 2e3;
/// Turn of the crack [°] and coefficients of friction. At 0.5 the faces would stick.
const VARIANTS: [(f64, &[f64]); 2] = [(0.0, &[0.0, 0.4]), (30.0, &[0.0, 0.2, 0.4])];

/// How the faces meet.
#[derive(Clone, Copy)]
enum Faces {
    /// Nothing presses, and they may go through each other.
    Apart,
    /// Nothing presses, but they may not, and slide without friction.
    Touching,
    /// Pressed together, with a coefficient of friction.
    Pressed(f64),
}

/// The shear rises within so many times a shear wave takes across the plate; the pressure before, and coming to rest
/// after, take a quarter of that.
const RISE: f64 = 40.0;

/// The plate with `cells` cells (of one metre) along half a crack that is turned by some degrees.
fn problem(degrees: f64, cells: f64, faces: Faces) -> Problem {
    let width = 4.0 * cells;
    let crossing = width / elastic().shear_wave_speed();
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let (x, y) = (2.0 * cells, 2.0 * cells);
    let (dx, dy) = (cells * cosine, cells * sine);
    let square = rectangle((0.0, 0.0), (width, width));
    let rise = RISE * crossing;
    let mut problem = Problem::new("closed-crack", square, linear_material(), PlaneState::Strain, 1.0)
        .crack(&[(x - dx, y - dy), (x + dx, y + dy)], [true, true])
        .until(1.5 * rise, 10);
    let solver = &mut problem.scene.solver;
    solver.area_term = false;
    // Slow beside the rise, strong beside the vibrations of the plate.
    solver.damping = 2.0 / crossing;
    let ramp = |from: f64, to: f64| Curve { points: vec![(from, 0.0), (to, 1.0)] };
    let (normal, along) = (Vector::new(-sine, cosine), Vector::new(cosine, sine));
    let shear = along * normal.transpose();
    let mut stresses = vec![((shear + shear.transpose()) * SHEAR, ramp(0.25 * rise, 1.25 * rise))];
    match faces {
        Faces::Apart => solver.crack_contact = false,
        Faces::Touching => solver.crack_friction = 0.0,
        Faces::Pressed(friction) => {
            solver.crack_friction = friction;
            stresses.push((normal * normal.transpose() * -PRESSURE, ramp(0.0, 0.25 * rise)));
        }
    }
    let sides = [
        (BoxSide::Right, 1.0, 0.0),
        (BoxSide::Left, -1.0, 0.0),
        (BoxSide::Top, 0.0, 1.0),
        (BoxSide::Bottom, 0.0, -1.0),
    ];
    for (stress, curve) in stresses {
        for (side, x, y) in sides {
            let traction = LoadKind::Traction(stress * Vector::new(x, y));
            problem = problem.load(Selection::Edge { side, bodies: None }, traction, curve.clone());
        }
    }
    problem
}

/// K_II of a crack along the grid with so many cells along half of it that is pressed together, by what it is without
/// pressure and contact: as computed at a place, and as it should be. For the first of its tips.
pub(crate) fn mode_2_of_pressed(
    cells: f64,
    friction: f64,
    placement: Placement,
) -> Result<(f64, f64), SimulationError> {
    let mode_2 = |faces| {
        let mut placed = Placed::new(&problem(0.0, cells, faces).scene, placement)?;
        while !placed.is_finished() {
            placed.advance()?;
        }
        Ok::<f64, SimulationError>(placed.now().tips()[0].mode_2)
    };
    Ok((mode_2(Faces::Pressed(friction))? / mode_2(Faces::Apart)?, 1.0 - friction * PRESSURE / SHEAR))
}

fn elastic() -> Elastic {
    Elastic::new(&linear_material(), PlaneState::Strain)
}

/// What is left at rest.
struct Rest {
    /// K_I, K_II and J of the two tips.
    tips: [[f64; 3]; 2],
    /// By how much the faces overlap where they do most [m].
    overlap: f64,
}

fn rest(problem: &Problem, tally: &mut Tally<'_>) -> Result<Rest, SimulationError> {
    let mut placed = tally.set_up(problem)?;
    tally.run(&mut placed, |_, _| ControlFlow::Continue(()))?;
    let frame = placed.now().frame();
    let tips = &frame.tips;
    let tips = [0, 1].map(|t| [tips[t].mode_1, tips[t].mode_2, tips[t].j_integral]);
    let faces = &frame.cracks[0];
    let along = (faces.rest[faces.rest.len() - 1] - faces.rest[0]).normalize();
    let opening = faces.above.iter().zip(&faces.below).map(|(above, below)| along.perp(&(above - below)));
    Ok(Rest { tips, overlap: opening.fold(0.0, |most, opening| most.max(-opening)) })
}

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cells = options.cells_or(CASE.cells.1).round();
    // What the pressure would open in the infinite plate if it pulled.
    let closure = 4.0 * PRESSURE * cells / elastic().effective_modulus;
    for (degrees, frictions) in VARIANTS {
        tally.say(&format!("crack at {degrees}°, apart"));
        let apart = rest(&problem(degrees, cells, Faces::Apart), tally)?.tips;
        let shear = 0.5 * (apart[0][1] + apart[1][1]);
        let energy = shear * shear / elastic().effective_modulus;
        let of = format!("crack at {degrees}°, shear alone");
        tally.say(&of);
        let touching = rest(&problem(degrees, cells, Faces::Touching), tally)?.tips;
        for ([mode_1, mode_2, _], end) in touching.iter().zip(["start", "end"]) {
            tally.absolute(format!("K_II/K_II apart, {of}, {end}"), "", mode_2 / shear, 1.0, 0.03);
            tally.absolute(format!("K_I/K_II apart, {of}, {end}"), "", mode_1 / shear, 0.0, 0.01);
        }
        for &friction in frictions {
            let of = format!("crack at {degrees}°, μ {friction}");
            tally.say(&of);
            let left = 1.0 - friction * PRESSURE / SHEAR;
            let found = rest(&problem(degrees, cells, Faces::Pressed(friction)), tally)?;
            tally.absolute(format!("overlap of the faces/(4 p a/E'), {of}"), "", found.overlap / closure, 0.0, 0.01);
            for ([mode_1, mode_2, j], end) in found.tips.iter().zip(["start", "end"]) {
                tally.absolute(format!("K_II/K_II apart, {of}, {end}"), "", mode_2 / shear, left, 0.03);
                tally.absolute(format!("K_I/K_II apart, {of}, {end}"), "", mode_1 / shear, 0.0, 0.01);
                tally.absolute(format!("J/J apart, {of}, {end}"), "", j / energy, left * left, 0.03);
            }
        }
    }
    Ok(())
}
