//! What a crack takes that an impact drives as fast as waves: G_c for its length, and no more.
//!
//! The example `drop-pmma` without its limit of speed: a disc 100 m across of PMMA (E = 2.94 GPa, ν = 0.3, ρ = 1190
//! kg/m³, K_Ic = 1.2 MPa√m), plane strain, falls onto a floor at 9.6 m/s; a crack runs up from a notch of 16 m at its
//! lowest point, driven by thousands of G_c. Reference: the energy balance, energy taken = ∫ G_c da (Griffith 1921), as
//! a tip that runs at c_R takes nothing else (Freund 1990, section 6.4). Where it runs at the end, under the pressure
//! at the top, chance decides. Cells are counted over the diameter.

use crate::case::{Case, Options};
use crate::problem::{Problem, disc, material};
use crate::report::{Expected, Tally};
use fissure_scene::{Collider, ColliderShape, Contact, InitialVelocity, PlaneState, Point, Pose, Selection, Vector};
use fissure_sim::{Elastic, SimulationError};

pub(crate) const CASE: Case = Case::new(
    "dropped-disc",
    "energy taken by a crack that an impact drives against G_c for its length",
    ("over the diameter", 50.0),
    compute,
);

const RADIUS: f64 = 50.0;
const TOUGHNESS: f64 = 1.2e6;
/// [m/s]
const SPEED: f64 = 9.6;

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cell_size = 2.0 * RADIUS / options.cells_or(CASE.cells.1);
    let pmma = material(2.94e9, 0.3, 1190.0, TOUGHNESS);
    let critical = TOUGHNESS * TOUGHNESS / Elastic::new(&pmma, PlaneState::Strain).effective_modulus;
    let mut problem = Problem::new("dropped-disc", disc(RADIUS), pmma, PlaneState::Strain, cell_size)
        .crack(&[(0.0, -RADIUS - 1.0), (0.0, -RADIUS + 16.0)], [false, true])
        .growing()
        .until(0.45, 90);
    problem.scene.bodies[0].velocities.push(InitialVelocity {
        selection: Selection::All,
        velocity: Vector::new(0.0, -SPEED),
        angular_velocity: 0.0,
        center: Point::origin(),
    });
    problem.scene.colliders.push(Collider {
        name: "floor".into(),
        shape: ColliderShape::HalfPlane { normal: Vector::new(0.0, 1.0) },
        keyframes: vec![(0.0, Pose { position: Point::new(0.0, -RADIUS - 0.01), angle: 0.0 })],
        contact: Contact::Separate,
        friction: 0.3,
    });
    let mut placed = tally.set_up(&problem)?;
    let drawn = placed.now().tips()[0].length;
    let held = placed.now().energies().kinetic;
    let (mut fastest, mut gained) = (0.0_f64, f64::NEG_INFINITY);
    tally.run_frames(&mut placed, |now| {
        let energies = now.energies();
        fastest = fastest.max(now.tips()[0].speed);
        let balance = energies.kinetic + energies.strain + energies.crack - energies.external_work;
        gained = gained.max(balance / held - 1.0);
    })?;
    let (tip, taken) = (placed.now().tips()[0], placed.now().energies().crack);
    tally.bound("length grown over the radius", "", (tip.length - drawn) / RADIUS, Expected::AtLeast(1.0));
    let price = critical * (tip.length - drawn);
    tally.relative("energy taken by ∫G_c da", "", taken / price, 1.0, 0.02);
    tally.bound("energy gained at most", "%", 100.0 * gained, Expected::AtMost(0.5));
    tally.bound("highest speed of the tip, mean over a frame", "m/s", fastest, Expected::AtLeast(800.0));
    Ok(())
}
