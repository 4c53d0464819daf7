//! Stress in a spinning disc.
//!
//! Radius a, rim speed 0.5 % of c_d, spun up at once: the disc breathes about its stretched state, so stress is
//! averaged over many breaths, with a window that falls to zero at both ends. Reference (closed form): σ_r + σ_t =
//! ρω²/8 [2(3+ν) a² − 4(1+ν) r²] in plane stress; plane strain by ν → ν/(1−ν).
//! Compared is its mean over the particles within a/2. Cells are counted over the radius.

use crate::case::{Case, Options};
use crate::problem::{Problem, disc, material};
use crate::report::{Expected, Tally};
use fissure_scene::{InitialVelocity, PlaneState, Point, Selection, Vector};
use fissure_sim::{Elastic, SimulationError};
use std::f64::consts::TAU;

pub(crate) const CASE: Case = Case::new(
    "spinning-disc",
    "stress in a spinning disc and its angular momentum",
    ("over the radius", 20.0),
    compute,
)
.family_cells(10.0);

const POISSON: f64 = 0.3;
const DENSITY: f64 = 1000.0;

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cells = options.cells_or(CASE.cells.1).round();
    for (plane, poisson) in [(PlaneState::Stress, POISSON), (PlaneState::Strain, POISSON / (1.0 - POISSON))] {
        let name = if plane == PlaneState::Stress { "plane stress" } else { "plane strain" };
        tally.say(name);
        let material = material(1e9, POISSON, DENSITY, 1e30);
        let speed = Elastic::new(&material, plane).dilatational_wave_speed();
        let spin = 0.005 * speed;
        // Some 20 breaths.
        let time = 60.0 / speed;
        let mut problem = Problem::new("spinning-disc", disc(1.0), material, plane, 1.0 / cells).until(time, 400);
        problem.scene.bodies[0].velocities.push(InitialVelocity {
            selection: Selection::All,
            velocity: Vector::zeros(),
            angular_velocity: spin,
            center: Point::origin(),
        });
        let mut placed = tally.set_up(&problem)?;
        let before = placed.now().momenta().1;
        let (mut sum, mut weights, mut reference) = (0.0, 0.0, 0.0);
        tally.run_frames(&mut placed, |now| {
            let window = 1.0 - (TAU * now.time() / time).cos();
            let particles = now.frame().particles;
            let (mut mean, mut exact, mut count) = (0.0, 0.0, 0.0);
            for (place, stress) in particles.rest.iter().zip(&particles.cauchy_stress) {
                let square = place.coords.norm_squared();
                if square < 0.25 {
                    mean += stress.trace();
                    exact += DENSITY * spin * spin / 8.0 * (2.0 * (3.0 + poisson) - 4.0 * (1.0 + poisson) * square);
                    count += 1.0;
                }
            }
            sum += window * mean / count;
            weights += window;
            reference = exact / count;
        })?;
        tally.relative(format!("mean of σ_r + σ_t within a/2, {name}"), "Pa", sum / weights, reference, 0.02);
        let turned = (placed.now().momenta().1 / before - 1.0).abs();
        tally.bound(format!("change of angular momentum, relative, {name}"), "", turned, Expected::AtMost(1e-11));
    }
    Ok(())
}
