//! Stress that motions cause: supports that move, things that meet, bodies that spin. Bounds from above, roughly.

use super::samples::Samples;
use super::width::width;
use crate::formulation::impact_speed;
use crate::material::elastic::Elastic;
use fissure_scene::{InitialVelocity, Point, Scene, Selection, Support, Vector};

/// Times at which motions are looked at.
const TIMES: u32 = 32;

/// Stress in a body that motions may cause within all frames [Pa].
pub(super) fn stress_of_motions(scene: &Scene, samples: &Samples, elastic: &[Elastic], body: usize) -> f64 {
    let b = &scene.bodies[body];
    let materials = || b.inclusions.iter().map(|i| i.material).chain([b.material]);
    let stiffest = materials().map(|m| elastic[m].effective_modulus).fold(0.0, f64::max);
    // ρ c: what a speed is worth in stress.
    let impedance = materials().map(|m| elastic[m].density * elastic[m].dilatational_wave_speed()).fold(0.0, f64::max);
    let density = materials().map(|m| elastic[m].density).fold(0.0, f64::max);
    let end = scene.frames.time(scene.frames.last);
    let (low, high) = b.region.bounds();
    let size = (high - low).norm();
    let mut strain = 0.0_f64;
    let mut speed = 0.0_f64;
    let here = |support: usize| -> Option<Point> {
        let places: Vec<Point> = samples.supports[support].iter().filter(|p| p.0 == body).map(|p| p.1).collect();
        let sum: Vector = places.iter().map(|p| p.coords).sum();
        (!places.is_empty()).then(|| Point::from(sum / places.len() as f64))
    };
    let held: Vec<(&Support, Point)> =
        scene.supports.iter().enumerate().filter_map(|(i, s)| Some((s, here(i)?))).collect();
    for (i, &(a, at)) in held.iter().enumerate() {
        for axis in 0..2 {
            let Some(v) = a.velocity[axis] else { continue };
            let curve = a
                .curve
                .points
                .iter()
                .map(|p| p.1.abs())
                .fold(if a.curve.points.is_empty() { 1.0 } else { 0.0 }, f64::max);
            speed = speed.max(v.abs() * curve);
            for &(b, to) in &held[..i] {
                let Some(w) = b.velocity[axis] else { continue };
                let apart = greatest_difference(a, v, b, w, end);
                let distance = (to - at).norm().max(0.05 * size);
                let along = ((to - at)[axis] / distance).abs();
                // What moves across a beam bends it.
                let bent = 6.0 * width(&scene.bodies[body].region) / distance * (1.0 - along);
                strain = strain.max(apart / distance * (along + bent));
            }
        }
    }
    let spin = b.velocities.iter().map(|v| v.angular_velocity.abs()).fold(0.0, f64::max);
    // What moves as a whole is strained only where something holds it.
    let is_whole = |v: &InitialVelocity| matches!(v.selection, Selection::All | Selection::Bodies(_));
    let parts = b.velocities.iter().filter(|v| !held.is_empty() || !is_whole(v));
    speed = speed.max(parts.map(|v| v.velocity.norm()).fold(0.0, f64::max));
    if !scene.colliders.is_empty() || scene.bodies.len() > 1 {
        // How far what meets can push is its way; nothing is known of where, so all of it counts.
        let meeting = impact_speed(scene);
        speed = speed.max(meeting);
        strain += meeting * end / width(&b.region);
    }
    stiffest * strain + 2.0 * impedance * speed + density * (spin * size).powi(2)
}

/// How far two supports that move at `v` and `w` [m/s] times their curves come apart until `end` [s], at most [m].
fn greatest_difference(a: &Support, v: f64, b: &Support, w: f64, end: f64) -> f64 {
    let step = end / f64::from(TIMES);
    let mut apart = 0.0_f64;
    let mut most = 0.0_f64;
    for k in 0..TIMES {
        let middle = (f64::from(k) + 0.5) * step;
        apart += (v * a.curve.value(middle) - w * b.curve.value(middle)) * step;
        most = most.max(apart.abs());
    }
    most
}
