//! What the transfers of the updated formulation lose: a standing wave, a wave front, a spin, a hard throw.
//!
//! - Standing wave: a free bar of two wavelengths that cannot widen, V cos(2πx/λ) at first; this mode of a free bar
//!   keeps its energy for ever (closed form). Looked at is the mean loss over four periods.
//! - Front: a stress σ steps up on the free end of a bar and runs along it; behind it the stress is σ (closed form).
//!   Noise is the root mean square of what differs from it ten cells and more behind the front and before the end.
//! - Spin: a square turns at a rim speed of 1 % of c_d through a quarter turn; its angular momentum stays.
//! - Throw: a square of jelly (E = 50 kPa, ν = .3, 1000 kg/m³) is thrown into the corner of two walls at 10 m/s, which
//!   is more than its wave speed; it has to come back, with no more energy than it had.
//!
//! Cells are counted along the shortest of the standing waves; the others are twice and four times as long.

use crate::case::{Case, Options};
use crate::problem::{LINEAR_YOUNG, Problem, linear_material, material, rectangle};
use crate::report::{Expected, Tally};
use fissure_scene::{
    BoxSide, Collider, ColliderShape, Contact, Curve, Formulation, Frame, InitialVelocity, Kernel, LoadKind,
    PlaneState, Point, Pose, Selection, Transfer, Vector,
};
use fissure_sim::{Elastic, SimulationError};
use std::f64::consts::TAU;
use std::ops::ControlFlow;

pub(crate) const CASE: Case = Case::new(
    "transfers",
    "what the transfers of the updated formulation lose and add",
    ("in the shortest wave", 10.0),
    compute,
);

/// Largest velocity of a standing wave by c_d: small strains.
const SPEED: f64 = 1e-6;
/// σ [Pa].
const TRACTION: f64 = 1e-6 * LINEAR_YOUNG;

/// What is compared: the default, which has targets, and beside it the other transfers; name, and transfer unless it is
/// the default.
const TRANSFERS: [(&str, Option<Transfer>); 5] = [
    (DEFAULT, None),
    ("APIC", Some(Transfer::Apic)),
    ("FLIP", Some(Transfer::Flip(1.0))),
    ("XPIC", Some(Transfer::Xpic)),
    ("PIC", Some(Transfer::Pic)),
];
const DEFAULT: &str = "default";

/// The target of the default; the other transfers have none.
fn of_default(name: &str, within: f64) -> Option<f64> {
    (name == DEFAULT).then_some(within)
}

fn updated(mut problem: Problem, transfer: Option<Transfer>) -> Problem {
    let solver = &mut problem.scene.solver;
    solver.formulation = Formulation::Updated;
    solver.kernel = Kernel::Quadratic;
    solver.transfer = transfer.unwrap_or(solver.transfer);
    problem
}

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let shortest = options.cells_or(CASE.cells.1).round();
    for (name, transfer) in TRANSFERS {
        for (waves, within) in [(1.0, 0.04), (2.0, 0.005), (4.0, 0.001)] {
            let cells = waves * shortest;
            tally.say(&format!("{name}, standing wave of {cells} cells"));
            let lost = standing(transfer, cells, tally)?;
            let quantity = format!("energy lost per period, wave of {cells} cells, {name}");
            tally.absolute(quantity, "", lost, 0.0, of_default(name, within));
        }
        tally.say(&format!("{name}, front"));
        front(name, transfer, tally)?;
        tally.say(&format!("{name}, spin"));
        spin(name, transfer, tally)?;
        tally.say(&format!("{name}, throw"));
        throw(name, transfer, tally)?;
    }
    if options.places > 1 {
        tally.note(
            "Waves keep their length in metres wherever they lie: with cells larger by 4 % that of 20 cells has 19.2, and what is lost goes with the third power of that.",
        );
    }
    Ok(())
}

/// Wave speed along a bar that cannot widen [m/s].
fn wave_speed() -> f64 {
    Elastic::new(&linear_material(), PlaneState::Strain).dilatational_wave_speed()
}

/// A bar `length` cells long that cannot widen.
fn bar(name: &str, length: f64) -> Problem {
    let strip = rectangle((0.0, 0.0), (length, 4.0));
    Problem::new(name, strip, linear_material(), PlaneState::Strain, 1.0).support(Selection::All, [None, Some(0.0)])
}

/// Part of its energy that a standing wave of so many cells loses in a period.
fn standing(transfer: Option<Transfer>, cells: f64, tally: &mut Tally<'_>) -> Result<f64, SimulationError> {
    let (length, speed) = (2.0 * cells, wave_speed());
    let mut problem = updated(bar("standing", length), transfer);
    for column in 0..(2.0 * length) as u32 {
        let left = 0.5 * f64::from(column);
        let velocity = SPEED * speed * (TAU * (left + 0.25) / cells).cos();
        problem.scene.bodies[0].velocities.push(InitialVelocity {
            selection: Selection::Region(rectangle((left, -1.0), (left + 0.5, 5.0))),
            velocity: Vector::new(velocity, 0.0),
            angular_velocity: 0.0,
            center: Point::origin(),
        });
    }
    // Energies of the solver are half a step apart and ripple: means over the first and over the last period.
    let period = cells / speed;
    let mut placed = tally.set_up(&problem.until(5.0 * period, 5))?;
    let (mut sums, mut counts) = ([0.0; 2], [0.0; 2]);
    tally.run(&mut placed, |now, _| {
        let last = now.time() > 4.0 * period;
        if last || now.time() < period {
            let energies = now.energies();
            sums[usize::from(last)] += energies.kinetic + energies.strain;
            counts[usize::from(last)] += 1.0;
        }
        ControlFlow::Continue(())
    })?;
    Ok((1.0 - sums[1] / counts[1] / (sums[0] / counts[0])) / 4.0)
}

/// Length of the bar with a front, in cells.
const LENGTH: f64 = 100.0;

fn front(name: &str, transfer: Option<Transfer>, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let pull = Selection::Edge { side: BoxSide::Right, bodies: None };
    let load = LoadKind::Traction(Vector::new(TRACTION, 0.0));
    let problem = updated(bar("front", LENGTH), transfer).load(pull, load, Curve::default());
    let mut placed = tally.set_up(&problem.until(0.8 * LENGTH / wave_speed(), 1))?;
    tally.run(&mut placed, |_, _| ControlFlow::Continue(()))?;
    let noise = noise(&placed.now().frame(), [0.2 * LENGTH + 10.0, LENGTH - 10.0]);
    tally.absolute(format!("noise of stress behind a front, {name}"), "", noise, 0.0, of_default(name, 0.06));
    Ok(())
}

/// Root mean square of σ₁₁/σ − 1 of the particles between two places.
fn noise(frame: &Frame, between: [f64; 2]) -> f64 {
    let p = &frame.particles;
    let inside = p.rest.iter().zip(&p.cauchy_stress).filter(|(x, _)| (between[0]..=between[1]).contains(&x.x));
    let errors: Vec<f64> = inside.map(|(_, stress)| (stress.m11 / TRACTION - 1.0).powi(2)).collect();
    (errors.iter().sum::<f64>() / errors.len() as f64).sqrt()
}

fn spin(name: &str, transfer: Option<Transfer>, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let square = rectangle((0.0, 0.0), (10.0, 10.0));
    let mut problem = updated(Problem::new("spin", square, linear_material(), PlaneState::Strain, 1.0), transfer);
    let rate = 0.01 * wave_speed() / 5.0;
    problem.scene.bodies[0].velocities.push(InitialVelocity {
        selection: Selection::All,
        velocity: Vector::zeros(),
        angular_velocity: rate,
        center: Point::new(5.0, 5.0),
    });
    let mut placed = tally.set_up(&problem.until(0.25 * TAU / rate, 4))?;
    let before = placed.now().momenta().1;
    tally.run(&mut placed, |_, _| ControlFlow::Continue(()))?;
    let lost = 1.0 - placed.now().momenta().1 / before;
    let quantity = format!("angular momentum lost in a quarter turn, {name}");
    tally.absolute(quantity, "", lost, 0.0, of_default(name, 1e-3));
    Ok(())
}

fn throw(name: &str, transfer: Option<Transfer>, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let jelly = material(5e4, 0.3, 1000.0, 1e30);
    let square = rectangle((0.02, 0.02), (0.22, 0.22));
    let mut problem = updated(Problem::new("throw", square, jelly, PlaneState::Strain, 0.01), transfer);
    let speed = 10.0;
    problem.scene.bodies[0].velocities.push(InitialVelocity {
        selection: Selection::All,
        velocity: Vector::new(-speed, -speed) * 0.5_f64.sqrt(),
        angular_velocity: 0.0,
        center: Point::origin(),
    });
    for normal in [Vector::new(1.0, 0.0), Vector::new(0.0, 1.0)] {
        problem.scene.colliders.push(wall(normal));
    }
    let mut placed = tally.set_up(&problem.until(0.2, 20))?;
    let before = placed.now().energies().kinetic;
    tally.run(&mut placed, |_, _| ControlFlow::Continue(()))?;
    let held = (placed.now().energies().kinetic + placed.now().energies().strain) / before;
    tally.bound(format!("energy after a throw into a corner, by that before, {name}"), "", held, Expected::AtMost(1.0));
    Ok(())
}

/// A fixed half plane through the origin that does not stick.
fn wall(normal: Vector) -> Collider {
    Collider {
        name: "wall".into(),
        shape: ColliderShape::HalfPlane { normal },
        keyframes: vec![(0.0, Pose { position: Point::origin(), angle: 0.0 })],
        contact: Contact::Separate,
        friction: 0.0,
    }
}
