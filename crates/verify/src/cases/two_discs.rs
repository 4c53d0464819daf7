//! Two equal discs that meet head on, bounce and exchange their velocities.
//!
//! Radius 10 mm, E = 10 MPa, ν = 0.33, ρ = 1500 kg/m³, 4.08 m/s each, 2 mm apart; the line of their centres lies at 0,
//! 30 and 45 degrees to the grid. Reference: conservation of momentum; what speed they lose goes on as vibration, some
//! 3 % of it at this speed. Cells are counted over a diameter.

use crate::case::{Case, Options};
use crate::problem::{Problem, disc, material};
use crate::report::{Expected, Tally};
use fissure_scene::{Body, InitialVelocity, PlaneState, Point, Selection, Vector};
use fissure_sim::SimulationError;

pub(crate) const CASE: Case =
    Case::new("two-discs", "speed that two discs exchange, and their momentum", ("over a diameter", 40.0), compute)
        .family_cells(20.0);

const RADIUS: f64 = 0.01;
/// Half the distance between the surfaces [m].
const APART: f64 = 0.001;
/// [m/s].
const SPEED: f64 = 4.08;

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cells = options.cells_or(CASE.cells.1);
    for degrees in [0.0_f64, 30.0, 45.0] {
        tally.say(&format!("{degrees} degrees"));
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let along = Vector::new(cosine, sine);
        let soft = material(10e6, 0.33, 1500.0, 1e30);
        let mut problem = Problem::new("two-discs", disc(RADIUS), soft, PlaneState::Strain, 2.0 * RADIUS / cells);
        let first = &problem.scene.bodies[0];
        let moved = |name: &str, side: f64| {
            let mut body = Body { name: name.into(), ..first.clone() };
            body.region.exterior.iter_mut().for_each(|p| *p += along * (side * (RADIUS + APART)));
            body.velocities.push(InitialVelocity {
                selection: Selection::All,
                velocity: along * (-side * SPEED),
                angular_velocity: 0.0,
                center: Point::origin(),
            });
            body
        };
        problem.scene.bodies = vec![moved("left", -1.0), moved("right", 1.0)];
        let problem = problem.until(0.002, 4);
        let mut placed = tally.set_up(&problem)?;
        // What one of them has.
        let scale = std::f64::consts::PI * RADIUS * RADIUS * 1500.0 * SPEED;
        let before = placed.now().momenta();
        tally.run_frames(&mut placed, |_| ())?;
        let after = placed.now().momenta();
        let (linear, angular) = (after.0 - before.0, after.1 - before.1);
        let particles = placed.now().frame().particles;
        let mean = |body: u32| {
            let own = (0..particles.body.len()).filter(|&p| particles.body[p] == body);
            let (sum, count) =
                own.fold((0.0, 0.0), |(sum, count), p| (sum + particles.velocity[p].dot(&along), count + 1.0));
            sum / count
        };
        let exchanged = 100.0 * (mean(1) - mean(0)) / (2.0 * SPEED);
        tally.bound(format!("speed exchanged at {degrees}°"), "%", exchanged, Expected::Between(96.0, 100.0));
        tally.bound(
            format!("change of momentum at {degrees}°, relative"),
            "",
            linear.norm() / scale,
            Expected::AtMost(1e-12),
        );
        let spin = angular.abs() / (scale * RADIUS);
        tally.bound(format!("change of angular momentum at {degrees}°, relative"), "", spin, Expected::AtMost(1e-4));
    }
    Ok(())
}
