//! `fissure check`

use crate::args::CheckArguments;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::progress::{duration, seconds};
use crate::report::{self, Report};
use crate::scene_file;
use fissure_scene::Scene;
use fissure_sim::{Estimate, Simulation};

/// Validates a scene and prints what it will cost.
pub(crate) fn check(arguments: &CheckArguments, report: &Report) -> Result<Exit, Failure> {
    let scene = scene_file::read(&arguments.scene, report)?;
    let estimate = Simulation::estimate(&scene)?;
    report::print(&if report.is_json() { json(&scene, &estimate) } else { text(&scene, &estimate) })?;
    Ok(Exit::Done)
}

fn text(scene: &Scene, estimate: &Estimate) -> String {
    let frames = &scene.frames;
    let rows = [
        ("scene", scene.name.clone()),
        ("bodies", scene.bodies.len().to_string()),
        ("cracks", scene.cracks.len().to_string()),
        ("particles", format!("{}, {} m apart", estimate.particles, scene.particle_spacing)),
        ("cells", format!("{}, {} m wide", estimate.cells, scene.cell_size)),
        ("formulation", estimate.formulation.clone()),
        ("time step", format!("{} (stable up to {})", seconds(estimate.time_step), seconds(estimate.stable_time_step))),
        ("steps", estimate.steps.to_string()),
        ("frames", format!("{}-{}, showing {}", frames.first, frames.last, seconds(frames.time(frames.last)))),
        ("expected time", format!("{} for the solver", duration(estimate.seconds))),
        (
            "expected memory",
            format!("{:.0} MiB for the run, meshes included", estimate.memory as f64 / (1024.0 * 1024.0)),
        ),
    ];
    rows.iter().map(|(name, value)| format!("{name:<16} {value}\n")).collect()
}

fn json(scene: &Scene, estimate: &Estimate) -> String {
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
        "seconds": estimate.seconds,
        "memory_bytes": estimate.memory,
    });
    format!("{value}\n")
}
