//! A block on an incline that is part of another body: it holds below the angle of friction and slides above it.
//!
//! Block of 0.2 m × 0.12 m, E = 10 MPa, ρ = 1000 kg/m³, under gravity, set down without weight at time zero: it comes
//! to bear in the first instants. Reference: Coulomb's law, acceleration g (sin α − μ cos α), fitted to its way; where
//! tan α is below μ, none. Cells are counted over the height of the block.

use crate::case::{Case, Options};
use crate::problem::{Problem, material, rectangle};
use crate::report::{Expected, Tally};
use fissure_scene::{Body, PlaneState, Point, Selection, Vector};
use fissure_sim::SimulationError;

pub(crate) const CASE: Case =
    Case::new("incline", "a block on an incline with friction", ("over the height of the block", 6.0), compute);

const GRAVITY: f64 = 9.81;
const HEIGHT: f64 = 0.12;
/// [s].
const TIME: f64 = 0.4;

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cell_size = HEIGHT / options.cells_or(CASE.cells.1);
    for (degrees, friction) in [(20.0_f64, 0.2), (10.0, 0.1), (30.0, 0.4), (20.0, 0.6)] {
        let of = format!("at {degrees}°, μ {friction}");
        tally.say(&of);
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let turned = |mut region: fissure_scene::Region| {
            region
                .exterior
                .iter_mut()
                .for_each(|p| *p = Point::new(p.x * cosine - p.y * sine, p.x * sine + p.y * cosine));
            region
        };
        let matter = material(1e7, 0.3, 1000.0, 1e30);
        let slope = turned(rectangle((-1.0, -0.15), (0.6, 0.0)));
        let mut problem = Problem::new("incline", slope, matter, PlaneState::Strain, cell_size)
            .support(Selection::Bodies(vec![0]), [Some(0.0); 2])
            .until(TIME, 20);
        let block = turned(rectangle((0.1, 0.0), (0.3, HEIGHT)));
        let first = &problem.scene.bodies[0];
        let block = Body { name: "block".into(), region: block, ..first.clone() };
        problem.scene.bodies.push(block);
        problem.scene.gravity = Vector::new(0.0, -GRAVITY);
        problem.scene.contact.friction = friction;
        let mut placed = tally.set_up(&problem)?;
        let down = Vector::new(-cosine, -sine);
        let mut ways: Vec<(f64, f64)> = Vec::new();
        tally.run_frames(&mut placed, |now| {
            let particles = now.frame().particles;
            let own = (0..particles.body.len()).filter(|&p| particles.body[p] == 1);
            let moved = |p: usize| (particles.position[p] - particles.rest[p]).dot(&down);
            let (sum, count) = own.fold((0.0, 0.0), |(sum, count), p| (sum + moved(p), count + 1.0));
            ways.push((now.time(), sum / count));
        })?;
        let expected = GRAVITY * (sine - friction * cosine);
        if expected > 0.0 {
            tally.relative(format!("acceleration {of}"), "m/s²", acceleration(&ways), expected, 0.02);
        } else {
            let way = 1e3 * ways.last().map_or(0.0, |(_, way)| *way);
            tally.bound(format!("way {of}"), "mm", way, Expected::AtMost(0.2));
        }
    }
    Ok(())
}

/// The acceleration of the parabola through time zero that comes nearest to all ways from there on, (s, m), with a
/// velocity at time zero: what the first instants have given.
fn acceleration(ways: &[(f64, f64)]) -> f64 {
    // Normal equations of s = v t + a t²/2.
    let sum = |of: fn(f64, f64) -> f64| ways.iter().map(|&(t, s)| of(t, s)).sum::<f64>();
    let (tt, th, hh) = (sum(|t, _| t * t), sum(|t, _| 0.5 * t.powi(3)), sum(|t, _| 0.25 * t.powi(4)));
    let (ts, hs) = (sum(|t, s| t * s), sum(|t, s| 0.5 * t * t * s));
    (tt * hs - th * ts) / (tt * hh - th * th)
}
