//! What a simulation is at, for whoever times it. The solver itself has no clock.

use super::Simulation;
use std::fmt;

/// A part of the work of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Forces, motion, contact.
    Motion,
    /// J and K at tips.
    Looks,
    /// Decisions of tips, and cutting anew where they have grown.
    Growth,
    /// What is done between steps: limits, energies, fragments, and whatever the caller does.
    Between,
}

/// Who is told; nobody by default.
#[derive(Default)]
pub(super) struct StageWatch(Option<Box<dyn FnMut(Stage) + Send>>);

impl fmt::Debug for StageWatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("StageWatch").field(&self.0.is_some()).finish()
    }
}

impl StageWatch {
    pub(super) fn enter(&mut self, stage: Stage) {
        if let Some(watch) = &mut self.0 {
            watch(stage);
        }
    }
}

impl Simulation {
    /// From now on `watch` is told whenever another stage begins.
    pub fn watch_stages(&mut self, watch: Box<dyn FnMut(Stage) + Send>) {
        self.stages = StageWatch(Some(watch));
    }
}
