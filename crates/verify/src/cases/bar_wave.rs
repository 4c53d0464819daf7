//! Waves along a bar that cannot widen: c = √((λ+2μ)/ρ).
//!
//! Standing: a bar of a quarter wavelength, held at one end, stretched and let go; the speed is that of its first mode,
//! projected on its shape. Travelling: a stress σ steps up on the free end of a bar; behind the front the stress is σ
//! and the particle speed σ/(ρc) (closed form); reflected from the fixed end, the stress doubles. Means are taken ten
//! cells away from fronts and ends. Cells are counted along the wavelength of the standing wave.

use crate::case::{Case, Options};
use crate::problem::{LINEAR_YOUNG, Problem, linear_material, rectangle};
use crate::report::Tally;
use fissure_scene::{BoxSide, Curve, Frame, LoadKind, PlaneState, Selection, Vector};
use fissure_sim::{Elastic, SimulationError};
use std::f64::consts::FRAC_PI_2;

pub(crate) const CASE: Case = Case::new(
    "bar-wave",
    "speed, stress and particle velocity of waves along a bar",
    ("in a wavelength", 20.0),
    compute,
);

/// σ [Pa].
const TRACTION: f64 = 1e-6 * LINEAR_YOUNG;
/// Length of the bar for travelling waves, in cells.
const LENGTH: f64 = 100.0;

/// A bar `length` cells long, held on its left, pulled on its right with a factor over time.
fn bar(length: f64, curve: Curve) -> Problem {
    let edge = |side| Selection::Edge { side, bodies: None };
    let strip = rectangle((0.0, 0.0), (length, 4.0));
    Problem::new("bar-wave", strip, linear_material(), PlaneState::Strain, 1.0)
        .support(Selection::All, [None, Some(0.0)])
        .support(edge(BoxSide::Left), [Some(0.0), None])
        .load(edge(BoxSide::Right), LoadKind::Traction(Vector::new(TRACTION, 0.0)), curve)
}

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let material = linear_material();
    let speed = Elastic::new(&material, PlaneState::Strain).dilatational_wave_speed();
    for cells in [options.cells_or(CASE.cells.1), 2.0 * options.cells_or(CASE.cells.1)] {
        standing((0.25 * cells).round(), speed, tally)?;
    }
    tally.say("travelling");
    // While the wave has gone 0.8 lengths, then while its reflection has gone half the way back.
    let time = 1.5 * LENGTH / speed;
    let mut placed = tally.set_up(&bar(LENGTH, Curve::default()).until(time, 15))?;
    let particle_speed = TRACTION / (material.density * speed);
    let (mut behind, mut front) = ((f64::NAN, f64::NAN), f64::NAN);
    tally.run_frames(&mut placed, |now| {
        let frame = now.frame();
        if frame.number == 8 {
            behind = means(&frame, [0.2 * LENGTH + 10.0, LENGTH - 10.0]);
            // The front is where the momentum says it is: all of it moves at the particle speed.
            let mean = frame.particles.velocity.iter().map(|v| v.x).sum::<f64>() / frame.particles.len() as f64;
            front = LENGTH * mean / particle_speed / frame.time;
        }
    })?;
    tally.relative("stress behind the front", "Pa", behind.0, TRACTION, 0.01);
    tally.relative("particle speed behind the front", "m/s", behind.1, particle_speed, 0.01);
    tally.relative("speed of the front", "m/s", front, speed, 0.01);
    let (stress, _) = means(&placed.now().frame(), [10.0, 0.5 * LENGTH - 10.0]);
    tally.relative("stress behind the reflected front", "Pa", stress, 2.0 * TRACTION, 0.01);
    Ok(())
}

/// Speed of the wave that stands in a bar `length` cells long, a quarter of its wavelength.
fn standing(length: f64, speed: f64, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    tally.say(&format!("standing, {length} cells"));
    let period = 4.0 * length / speed;
    let release = Curve { points: vec![(0.0, 1.0), (0.05 * period, 0.0)] };
    let mut placed = tally.rest(&bar(length, release).until(4.0 * period, 400))?;
    let mut crossings = Vec::new();
    let mut last: Option<(f64, f64)> = None;
    tally.run_frames(&mut placed, |now| {
        let p = now.frame().particles;
        let stretch = |(rest, now): (&fissure_scene::Point, &fissure_scene::Point)| {
            (FRAC_PI_2 * rest.x / length).sin() * (now.x - rest.x)
        };
        let amplitude: f64 = p.rest.iter().zip(&p.position).map(stretch).sum();
        if let Some((time, before)) = last
            && (before < 0.0) != (amplitude < 0.0)
        {
            crossings.push(time + (now.time() - time) * before / (before - amplitude));
        }
        last = Some((now.time(), amplitude));
    })?;
    let found = match crossings.as_slice() {
        [first, .., last] => 2.0 * length * (crossings.len() - 1) as f64 / (last - first),
        _ => f64::NAN,
    };
    let target = (4.0 * length >= 20.0).then_some(0.01);
    tally.relative(format!("speed of a wave of {} cells", 4.0 * length), "m/s", found, speed, target);
    Ok(())
}

/// Mean stress along the bar and mean velocity [m/s] of the particles between two places.
fn means(frame: &Frame, between: [f64; 2]) -> (f64, f64) {
    let p = &frame.particles;
    let (mut stress, mut velocity, mut count) = (0.0, 0.0, 0.0);
    for k in 0..p.len() {
        if (between[0]..=between[1]).contains(&p.rest[k].x) {
            stress += p.cauchy_stress[k].m11;
            velocity += p.velocity[k].x;
            count += 1.0;
        }
    }
    (stress / count, velocity / count)
}
