//! What suites across crates share: the examples as scenes, runs, paths, and the program as a process.

pub mod fuzz;
pub mod program;

use fissure_scene::{Frame, LoadError, Point, Scene};
use fissure_sim::{Simulation, SimulationError};
use std::ops::ControlFlow;
use std::path::Path;

/// The scene of an example with overrides.
///
/// # Errors
/// As [`fissure_scene::load`].
pub fn example(name: &str, overrides: &[&str]) -> Result<Scene, LoadError> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples").join(name).join("scene.toml");
    fissure_scene::load(&path, &overrides.iter().map(|s| s.to_string()).collect::<Vec<_>>())
}

/// Runs a scene to its last frame and gives that.
///
/// # Errors
/// As [`Simulation::advance`].
pub fn last_frame(scene: &Scene) -> Result<Frame, SimulationError> {
    let mut simulation = Simulation::new(scene)?;
    while !simulation.is_finished() {
        simulation.advance(&mut |_| ControlFlow::Continue(()))?;
    }
    Ok(simulation.frame())
}

/// Distance from a point to an open polyline [m].
pub fn distance(point: Point, line: &[Point]) -> f64 {
    line.windows(2)
        .map(|w| {
            let along = w[1] - w[0];
            let t = ((point - w[0]).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            (point - (w[0] + along * t)).norm()
        })
        .fold(f64::INFINITY, f64::min)
}
