//! Whether what is said of a scene before it runs holds: the error of K, and the time.
//!
//! Scenes are [plates](plate) that no table was made from. Their error is asked for and held against the same plate in
//! much smaller cells; their time is asked for and held against what the run takes.

mod plate;

use crate::cpu_time::cpu_time;
use crate::placed::Placed;
use crate::placement::Placement;
use fissure_scene::{Scene, Wish};
use fissure_sim::{DialError, Limit, Simulation, SimulationError};
use plate::Random;
use std::ops::ControlFlow;

/// Errors and times [s] that are asked for: from and to.
const ERRORS: [f64; 2] = [0.015, 0.08];
const BUDGETS: [f64; 2] = [0.5, 3.0];
/// The reference has cells so many times smaller than those that were chosen, ...
const FINER: f64 = 2.5;
/// ... but so many along the plate's width of 1 m at least and at most.
const REFERENCE_CELLS: [f64; 2] = [80.0, 130.0];
/// Tips that feel less than this part of what the one with the highest K does do not count.
const COUNTS: f64 = 0.3;
/// Frames of a run that is timed.
const FRAMES: u32 = 24;

/// What was said and found of one plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DialTrial {
    /// Error of K that was asked for, that was said of the spacing chosen, and that was found [–].
    pub error: [f64; 3],
    /// What the error was said to be due to.
    pub limit: Limit,
    /// Cells along the plate's width for that.
    pub cells: f64,
    /// Time that was asked for, that was said of the spacing chosen, and that was found [s].
    pub seconds: [f64; 3],
    /// Particles for that.
    pub particles: usize,
}

/// Tries plate number `index` of the family `seed`.
///
/// # Errors
/// When the solver fails, or nothing gives what was asked for.
pub fn dial_trial(seed: u64, index: usize) -> Result<DialTrial, DialError> {
    let mut random = Random::of(seed, index);
    let scene = plate::plate(&mut random);
    let placement = Placement::draw(seed, index + 1).at_own_spacing();
    let asked = random.logarithmic(ERRORS);
    let budget = random.logarithmic(BUDGETS);
    let toughness = random.logarithmic([0.3, 1.2]);

    let spacing = Simulation::spacing_for(&scene, Wish::Accuracy(asked), &|_, e| e.seconds)?;
    let chosen = with_spacing(&scene, spacing);
    let said = Simulation::estimate(&chosen)?.accuracy.ok_or(DialError::NoTip)?;
    let found = highest(&chosen, placement)?;
    let [fewest, most] = REFERENCE_CELLS;
    let fine = 0.5 / (0.5 * FINER / spacing).clamp(fewest, most);
    let reference = highest(&with_spacing(&scene, fine), placement)?;
    let top = reference.iter().copied().fold(0.0, f64::max);
    let errors = found.iter().zip(&reference).filter(|(_, exact)| **exact > COUNTS * top);
    let error = errors.map(|(found, exact)| (found / exact - 1.0).abs()).fold(0.0, f64::max);

    let mut growing = scene;
    growing.growth.enabled = true;
    growing.materials[0].fracture_toughness = toughness * top;
    let spacing = Simulation::spacing_for(&growing, Wish::Budget(budget), &|_, e| e.seconds)?;
    let timed = with_spacing(&growing, spacing);
    let estimate = Simulation::estimate(&timed)?;
    Ok(DialTrial {
        error: [asked, said.error, error],
        limit: said.limit,
        cells: 1.0 / chosen.cell_size,
        seconds: [budget, estimate.seconds, seconds_of(&timed)?],
        particles: estimate.particles,
    })
}

/// The same with other particles and cells.
fn with_spacing(scene: &Scene, spacing: f64) -> Scene {
    Scene { particle_spacing: spacing, cell_size: 2.0 * spacing, ..scene.clone() }
}

/// Highest K, of both modes together, of each tip until the end [Pa·√m].
fn highest(scene: &Scene, placement: Placement) -> Result<Vec<f64>, SimulationError> {
    let mut placed = Placed::new(scene, placement)?;
    let mut highest = vec![0.0_f64; placed.now().tips().len()];
    while !placed.is_finished() {
        placed.advance_observed(&mut |now| {
            for (most, tip) in highest.iter_mut().zip(now.tips()) {
                *most = most.max(tip.mode_1.hypot(tip.mode_2));
            }
            ControlFlow::Continue(())
        })?;
    }
    Ok(highest)
}

/// Time that a run takes, its frames and states in memory [s].
fn seconds_of(scene: &Scene) -> Result<f64, SimulationError> {
    let start = cpu_time();
    let mut simulation = Simulation::new(scene)?;
    while !simulation.is_finished() {
        simulation.advance(&mut |_| ControlFlow::Continue(()))?;
        simulation.save()?;
        simulation.frame();
    }
    Ok((cpu_time() - start).as_secs_f64())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// Truth: the same plates in much smaller cells. Times are left to the chart: they depend on the machine.
    #[test]
    fn errors_are_not_worse_than_said() {
        for index in [3, 5, 8] {
            let trial = dial_trial(11, index).unwrap();
            let [asked, said, found] = trial.error;
            assert!(said <= asked && found <= said, "{trial:?}");
        }
    }
}
