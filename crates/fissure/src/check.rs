//! `fissure check`

use crate::args::CheckArguments;
use crate::drawn::Wanted;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::progress::{duration, seconds};
use crate::report::{self, Report};
use crate::scene_file;
use fissure_plane::{Point, polyline_length};
use fissure_scene::{Part, Scene};
use fissure_sim::{Estimate, Limit, Simulation, dispensable};

/// Validates a scene and prints what it will cost.
pub(crate) fn check(arguments: &CheckArguments, report: &Report) -> Result<Exit, Failure> {
    let wanted = Wanted { thickness: arguments.thickness, written: false, output: None };
    let file = scene_file::read(&arguments.scene, &wanted, report)?;
    let scene = file.scene();
    let estimate = Simulation::estimate(scene).map_err(|error| file.show(error.into()))?;
    let spare = dispensable(scene, &estimate);
    report::print(&if report.is_json() { json(scene, &estimate, &spare) } else { text(scene, &estimate, &spare) })?;
    Ok(Exit::Done)
}

fn text(scene: &Scene, estimate: &Estimate, spare: &[String]) -> String {
    let frames = &scene.frames;
    let seconds_in_all = expected_seconds(scene, estimate);
    let rows = [
        ("scene", scene.name.clone()),
        ("bodies", scene.bodies.len().to_string()),
        ("cracks", scene.cracks.len().to_string()),
        ("particles", format!("{}, {} m apart", estimate.particles, rounded(scene.particle_spacing, 6))),
        ("cells", format!("{}, {} m wide", estimate.cells, rounded(scene.cell_size, 6))),
        ("formulation", estimate.formulation.clone()),
        ("time step", format!("{} (stable up to {})", seconds(estimate.time_step), seconds(estimate.stable_time_step))),
        ("steps", estimate.steps.to_string()),
        ("frames", format!("{}-{}, showing {}", frames.first, frames.last, seconds(frames.time(frames.last)))),
        ("accuracy", accuracy(scene, estimate)),
        ("crack growth", format!("about {} m expected", rounded(estimate.growth.max(0.0), 2))),
        (
            "expected time",
            format!(
                "about {} in all, {} of it for the solver, most of that {}",
                duration(seconds_in_all),
                duration(estimate.seconds),
                most_of_time(estimate)
            ),
        ),
        (
            "expected memory",
            format!("{:.0} MiB for the run, meshes included", estimate.memory as f64 / (1024.0 * 1024.0)),
        ),
    ];
    let spare = spare.iter().map(|what| ("could do without", what.clone()));
    rows.into_iter().chain(spare).map(|(name, value)| format!("{name:<16} {value}\n")).collect()
}

/// "highest K within 2.5 %, limited by crack `notch`: 4.0 cells to its tip".
fn accuracy(scene: &Scene, estimate: &Estimate) -> String {
    let Some(accuracy) = estimate.accuracy else { return "no tip waits for its K".into() };
    let (name, cells) = (&scene.cracks[accuracy.crack].name, accuracy.cells);
    let limit = match accuracy.limit {
        Limit::Crack => format!("crack `{name}`: {cells:.1} cells to a tip"),
        Limit::Room => format!("what is near a tip of crack `{name}`: {cells:.1} cells away"),
        Limit::Waves => format!("loads that come at once, on crack `{name}`: {cells:.1} cells to a tip"),
    };
    format!("highest K within {} %, limited by {limit}", rounded(100.0 * accuracy.error, 2))
}

/// What most of the solver's time goes into.
fn most_of_time(estimate: &Estimate) -> &'static str {
    let parts = &estimate.parts;
    let named = [
        (parts.motion, "for motion"),
        (parts.looks, "for looks at tips"),
        (parts.growth, "for growth"),
        (parts.frames, "for the start and frames"),
    ];
    named.into_iter().fold((0.0, ""), |most, part| if part.0 > most.0 { part } else { most }).1
}

/// Wall time of `fissure run` [s].
pub(crate) fn expected_seconds(scene: &Scene, estimate: &Estimate) -> f64 {
    estimate.seconds + seconds_of_meshes(scene, estimate)
}

/// `value` with so many digits.
fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.0$e}", digits - 1).parse().unwrap_or(value)
}

fn json(scene: &Scene, estimate: &Estimate, spare: &[String]) -> String {
    let value = serde_json::json!({
        "scene": scene.name,
        "hash": scene.hash,
        "bodies": scene.bodies.len(),
        "cracks": scene.cracks.len(),
        "particles": estimate.particles,
        "particle_spacing": scene.particle_spacing,
        "cells": estimate.cells,
        "cell_size": scene.cell_size,
        "formulation": estimate.formulation,
        "time_step": estimate.time_step,
        "stable_time_step": estimate.stable_time_step,
        "steps": estimate.steps,
        "first_frame": scene.frames.first,
        "last_frame": scene.frames.last,
        "growth": estimate.growth,
        "highest_k_error": estimate.accuracy.map(|accuracy| accuracy.error),
        "highest_k_limit": estimate.accuracy.map(|accuracy| format!("{:?}", accuracy.limit).to_lowercase()),
        "could_do_without": spare,
        "solver_seconds": estimate.seconds,
        "motion_seconds": estimate.parts.motion,
        "look_seconds": estimate.parts.looks,
        "growth_seconds": estimate.parts.growth,
        "seconds": expected_seconds(scene, estimate),
        "memory_bytes": estimate.memory,
    });
    format!("{value}\n")
}

/// Wall time that making and writing the meshes of one point of outlines and cracks takes, per frame and format [s];
/// measured with the 13 examples.
const SECONDS_PER_POINT: f64 = 5e-6;

/// Wall time for the meshes of all frames [s]: it goes with the points of outlines and cracks.
fn seconds_of_meshes(scene: &Scene, estimate: &Estimate) -> f64 {
    let closed =
        |ring: &[Point]| polyline_length(ring) + ring.first().zip(ring.last()).map_or(0.0, |(a, b)| (a - b).norm());
    let outlines: f64 = scene.bodies.iter().flat_map(|body| body.region.rings().map(closed)).sum();
    let drawn: f64 = scene.cracks.iter().map(|crack| polyline_length(&crack.points)).sum();
    let increment = scene.growth.increment * scene.cell_size;
    // Cracks are there for a part of the frames only.
    let points = outlines / scene.particle_spacing + (drawn + 0.7 * estimate.growth) / increment;
    let particles = if scene.output.parts.contains(&Part::Particles) { estimate.particles as f64 } else { 0.0 };
    SECONDS_PER_POINT * (points + particles) * scene.frames.count() as f64 * scene.output.formats.len() as f64
}
